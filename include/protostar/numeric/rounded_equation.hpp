// Equations of surfaces in double, with bounds of their errors, and what these tell about the roots.
//
// T is the number of one line, double, or the doubles of several lines, which are rounded alike; M is a truth
// value, or one for each line. Hence each of several lines has the roots that it has alone, to the last bit.
// A line in doubt needs more digits (surface.hpp). docs/derivations.md derives the bounds, in units of
// u = 2^-53.
#pragma once

#include <cmath>
#include <type_traits>

#include "../interval.hpp"
#include "../vec3.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Line in doubles, with upper bounds for the error of each.
///
/// A number x with an error e is given the size |x| + 2^53 e, so that its error is at most u of its size. A
/// bound for exact numbers holds if their magnitudes are replaced by sizes, and one unit of u is added for
/// each.
struct RoundedLine {
  Point origin{0};
  Vec3 direction{0};
  Vec3 origin_error{0}, direction_error{0};
};

/// Returns the sizes of a vector that differs from the origin of some rays by exact numbers: its magnitudes,
/// plus 2^53 times the errors of the origin if the rays have errors, as a RoundedLine has.
[[nodiscard, gnu::always_inline]] inline auto origin_sizes(const auto& rays, const auto& v) {
  if constexpr (requires { rays.origin_error; })
    return abs(v) + 0x1p53 * rays.origin_error;
  else
    return abs(v);
}

/// Returns the sizes of the direction of some rays.
[[nodiscard, gnu::always_inline]] inline auto direction_sizes(const auto& rays) {
  if constexpr (requires { rays.direction_error; })
    return abs(rays.direction) + 0x1p53 * rays.direction_error;
  else
    return abs(rays.direction);
}

/// Equation slope · t = height, so that t = height / slope. For a plane, height is distance − normal · origin
/// and slope is normal · direction; for a quadratic equation without its root 0 they are 2 b and A.
template <class T, class M>
struct RoundedLinear {
  T height, slope;
  M misses, crosses;  ///< true if the line surely misses or surely crosses the surface
  M is_certain;       ///< true if height / slope is as accurate as Roots requires

  [[nodiscard, gnu::always_inline]] const M& surely_misses() const { return misses; }
};
template <class H, class T, class M>
RoundedLinear(H, T, M, M, M) -> RoundedLinear<T, M>;

/// Equation A t² − 2 b t + c = 0 with A > 0: b is −½ of the usual coefficient of t, and D = b² − A c is ¼ of
/// the usual discriminant. C is double if all lines share their origin, and hence c; otherwise it is T. If E
/// is infinite, nothing is certain. If is_of_sphere is true, the errors of A, b and c are at most 3u A,
/// 4u √(A w) and 7u w, as those of a sphere. For other surfaces A and b may be what is left of larger terms.
template <class T, class C, bool is_of_sphere = false>
struct RoundedQuadratic {
  T A, b;
  C c, w;  ///< w is the sum of the magnitudes of the terms of c
  T D, E;  ///< D = b² − A c has an error of at most E

  [[nodiscard, gnu::always_inline]] auto surely_misses() const { return D < -E; }

  /// Returns the equation A t = 2 b of the other root of a line that starts on the surface, where c and one
  /// root are 0. The root is certain if b² > 2^12 E; otherwise the line is in doubt, and never surely misses.
  /// The error of b is at most 7u (for quadrics 9u) of the sum of the magnitudes of its terms, and that sum
  /// is below 2^24 √E.
  [[nodiscard, gnu::always_inline]] auto without_root_at_0() const {
    const auto is_certain = b * b > 0x1p12 * E;
    using M = std::remove_const_t<decltype(is_certain)>;
    return RoundedLinear<T, M>{2 * b, A, M(false), is_certain, is_certain};
  }
};

/// Returns the equation of one line whose A, b and c are off by at most the given errors besides.
///
/// D is then off by no more than what is added to E. |c| > 2^-18 w makes the error of c less than 2^-34 |c|,
/// and that of A is less than 2^-34 A, or nothing is certain. q² ≥ √D |q| > 2^31 E and b² > 2^12 E make the
/// error of b less than 2^-33 of q and of b (docs/derivations.md, Instances).
[[nodiscard]] inline RoundedQuadratic<double, double> with_errors(const auto& quadratic, double A_error,
                                                                  double b_error, double c_error) {
  const auto& [A, b, c, w, D, E] = quadratic;
  RoundedQuadratic<double, double> e{A, b, c, w, D, E};
  const double size = std::abs(e.b) * b_error + std::abs(e.c) * A_error + (e.A + A_error) * c_error;
  e.E = e.A > 0x1p34 * A_error ? e.E + 2 * size + 0x1p54 * b_error * b_error : infinity;
  e.w += 0x1p52 * c_error;
  return e;
}

namespace detail {

/// Roots of a RoundedQuadratic without cancellation: q is the one of b ± √D that does not cancel. One root is
/// q/A, and the other c/q, since their product is c/A.
template <class T, class M>
struct CertifiedQuotient {
  T q;
  M certain;  ///< true if q/A and c/q are as accurate as Roots requires
};

/// Returns q, and whether q/A and c/q are certified. The error of c is below 2^-32 |c| for |c| > 2^-18 w. For
/// D > 4E the error of √D is at most E/(1.86 √D), since the true D is at least ¾ of this one: below 2^-31.8
/// |q| here. |c| > 2^-18 w also makes |q| larger than 2^-10 √(A w), so the error of b, 4u √(A w), is
/// negligible. D > 4E holds as well: √D > 2^31 E/|q|, where |q| ≤ 2 √(A w) and E ≥ 2^-48 A w, hence D > 2^12
/// E.
template <class T, class C, bool is_of_sphere>
[[nodiscard, gnu::always_inline]] inline auto certified_quotient(
    const RoundedQuadratic<T, C, is_of_sphere>& e) {
  using std::abs, std::copysign, std::sqrt;
  const T root = sqrt(e.D);
  const T q = e.b + copysign(root, e.b);
  const auto certain = root * abs(q) > 0x1p31 * e.E && abs(e.c) > 0x1p-18 * e.w;
  return CertifiedQuotient<T, std::remove_const_t<decltype(certain)>>{q, certain};
}

}  // namespace detail

/// Roots of several lines with one surface, or of one line, as quotients that near() and far() divide. They
/// are valid where `meets` is true. A line that neither meets the surface nor is in doubt has no root, or is
/// not active.
template <class T, class M>
struct RootsOfEach {
  M meets, in_doubt;
  T near_over = 1.0, near_under = 1.0, far_over = near_over, far_under = near_under;
  int count = 2;  ///< 1 or 2; if 1, near and far are equal

  [[nodiscard]] T near() const { return near_over / near_under; }
  [[nodiscard]] T far() const { return far_over / far_under; }
};

/// Returns the roots of the active lines, near before far.
template <class T, class L, class M>
[[nodiscard, gnu::always_inline]] inline RootsOfEach<T, M> roots_of_each(const RoundedLinear<T, L>& e,
                                                                         const M& active) {
  const M meets = active && e.crosses && e.is_certain;
  return {.meets = meets,
          .in_doubt = active && !e.misses && !meets,
          .near_over = e.height,
          .near_under = e.slope,
          .count = 1};
}
template <class T, class C, bool is_of_sphere, class M>
[[nodiscard, gnu::always_inline]] inline RootsOfEach<T, M> roots_of_each(
    const RoundedQuadratic<T, C, is_of_sphere>& e, const M& active) {
  const M open = active && !e.surely_misses();
  if (!any(open)) return {.meets = open, .in_doubt = open};
  const T c(e.c);
  const auto [q, certain] = detail::certified_quotient(e);
  const M meets = open && certain;
  // b and q have the same sign. Certified roots are so far apart that rounding does not change their order.
  const auto backwards = q < 0.0;
  return {.meets = meets,
          .in_doubt = open && !meets,
          .near_over = select(backwards, q, c),
          .near_under = select(backwards, e.A, q),
          .far_over = select(backwards, c, q),
          .far_under = select(backwards, q, e.A)};
}

/// First root in t > 0 of several lines, or of one line.
template <class T, class M>
struct FirstRootOfEach {
  T t;
  M is_there, in_doubt;  ///< if neither, there is no root in t > 0
  M is_far = false;      ///< true if it is the second root of its line
};

/// Returns the first root in t > 0 of the active lines.
template <class T, class L, class M>
[[nodiscard, gnu::always_inline]] inline FirstRootOfEach<T, M> first_root_of_each(
    const RoundedLinear<T, L>& e, const M& active) {
  const M meets = active && e.crosses && e.is_certain;
  const T t = e.height / e.slope;
  return {.t = t, .is_there = meets && t > 0.0 && t < infinity, .in_doubt = active && !e.misses && !meets};
}

/// Returns the first root in t > 0 of the active lines. Signs decide which root that is, so that one division
/// is enough. From outside, where c > 0, it is c/q if b > 0, and a surface behind the origin, where b < 0,
/// costs no square root; if lines start at one point outside, as camera rays mostly do, this holds for all of
/// them.
template <class T, class C, bool is_of_sphere, class M>
[[nodiscard, gnu::always_inline]] inline FirstRootOfEach<T, M> first_root_of_each(
    const RoundedQuadratic<T, C, is_of_sphere>& e, const M& active) {
  using std::sqrt;
  T t = infinity;
  M is_there = false, in_doubt = false;
  if (const M open = active && !e.surely_misses(); any(open)) {
    const auto set = [&](const T& root, const M& certain, const M& recedes) {
      t = root;
      is_there = open && certain && !recedes && t > 0.0 && t < infinity;
      in_doubt = open && !certain && !(recedes && e.D > 4 * e.E);
    };
    const auto is_outside = e.c > 0x1p-18 * e.w;
    constexpr bool is_shared = std::is_same_v<decltype(is_outside), const bool>;  // by all lines
    if (is_shared && any(is_outside)) {
      if (std::is_same_v<T, double> && any(e.b < 0.0)) {
        set(infinity, false, true);
      } else {
        const T root = sqrt(e.D), q = e.b + root;
        set(T(e.c) / q, root * q > 0x1p31 * e.E && e.b >= 0.0, e.b < 0.0);
      }
    } else {
      const auto [q, certain] = detail::certified_quotient(e);
      const M is_q_over_A = M(!is_outside) && q >= 0.0;
      set(select(is_q_over_A, q, T(e.c)) / select(is_q_over_A, e.A, q), certain, M(is_outside) && q < 0.0);
    }
  }
  return {.t = t, .is_there = is_there, .in_doubt = in_doubt, .is_far = M(e.c < 0.0)};
}

/// Lines that cross a surface in 0 < t < 1 or in t > 0, and lines in doubt.
template <class M>
struct CrossedByEach {
  M crossed, in_doubt;
};

/// Returns which of the active lines cross the surface in 0 < t < 1 if they are segments, else in t > 0. For
/// segments, t = height / slope is compared without a division. Its relative error is at most 2^-30 where it
/// is certain, and then slope is so large that the products are rounded by 2^-53 of themselves at most.
template <class T, class L, class M>
[[nodiscard, gnu::always_inline]] inline CrossedByEach<M> crossed_by_each(const RoundedLinear<T, L>& e,
                                                                          const M& active,
                                                                          bool are_segments) {
  using std::abs;
  if (!are_segments) {
    const auto root = first_root_of_each(e, active);
    return {.crossed = root.is_there, .in_doubt = root.in_doubt};
  }
  const M meets = active && e.crosses && e.is_certain;
  const T size = abs(e.slope), height = select(e.slope < 0.0, -e.height, e.height);
  const M before_end = height < (1 - 0x1p-29) * size;
  const M behind_end = height > (1 + 0x1p-29) * size;
  return {.crossed = meets && before_end && height > 0.0,
          .in_doubt = active && !e.misses && !(meets && (before_end || behind_end))};
}

/// Returns which of the active lines cross a surface in 0 < t < 1 if they are segments, else in t > 0: by
/// signs alone, without a root or a division, but for segments if the equation is not that of a sphere.
///
/// If D > 4E and |c| > 2^-18 w, a line meets the sphere, and the computed c has the sign of the exact one,
/// since its error is at most 7u w. If also c > 0, the computed b has the sign of the exact one: |b| is then
/// larger than 2^-24 √(A w), and its error is at most 4u √(A w). This holds for other surfaces, too: |b| is
/// then larger than 2^-24 of the sum of the magnitudes of its terms.
///
/// For segments of other surfaces, roots are compared with 1, which they are on the right side of if they are
/// 2^-29 away from it: where A cancels, 2^-49 (A + w) below is no bound of the error of f.
///
/// At t = 1 the equation has the value f = A − 2b + c, and half its slope is A − b. The errors of A, b, c are
/// at most 3u A, 4u √(A w) ≤ 2u (A + w) and 7u w, those of the two operations at most 4u (A + w) together, so
/// f and A − b are accurate to 15u (A + w) < 2^-49 (A + w). A line that meets the sphere is inside it between
/// its roots: from outside, it gets there if it ends inside, or else if its nearest point to the center comes
/// before its end.
template <class T, class C, bool is_of_sphere, class M>
[[nodiscard, gnu::always_inline]] inline CrossedByEach<M> crossed_by_each(
    const RoundedQuadratic<T, C, is_of_sphere>& e, const M& active, bool are_segments) {
  using std::abs;
  if constexpr (!is_of_sphere)
    if (are_segments) {
      const RootsOfEach<T, M> roots = roots_of_each(e, active);
      const T near = roots.near(), far = roots.far();
      const auto has_root_before = [&](double end) -> M {
        return roots.meets && ((near > 0.0 && near < end) || (far > 0.0 && far < end));
      };
      const M crossed = has_root_before(1 - 0x1p-29);
      return {.crossed = crossed, .in_doubt = roots.in_doubt || (has_root_before(1 + 0x1p-29) && !crossed)};
    }
  const M open = active && !e.surely_misses();
  if (!any(open)) return {.crossed = open, .in_doubt = open};
  const M meets = open && e.D > 4 * e.E && abs(e.c) > 0x1p-18 * e.w;
  const auto approaches = e.b > 0.0;
  const auto starts_outside = e.c > 0.0;
  if (!are_segments) return {.crossed = meets && (approaches || !starts_outside), .in_doubt = open && !meets};
  const auto f = e.A - 2 * e.b + e.c, slope = e.A - e.b, error = 0x1p-49 * (e.A + e.w);
  const auto ends_outside = (f > error), ends_inside = (f < -error), recedes = (slope > error);
  const M sure = meets && (ends_inside ||
                           (ends_outside && (!starts_outside || !approaches || recedes || slope < -error)));
  const M crossed = sure && ((starts_outside && approaches && (ends_inside || recedes)) ||
                             (!starts_outside && ends_outside));
  return {.crossed = crossed, .in_doubt = open && !sure};
}

/// Returns the certified roots of one line, or in_doubt() if double does not decide.
[[nodiscard, gnu::always_inline]] inline Roots roots_of(const auto& e, const auto& in_doubt) {
  const auto roots = roots_of_each(e, true);
  if (roots.in_doubt) return in_doubt();
  if (!roots.meets) return {};
  return roots.count == 1 ? Roots{roots.near()} : Roots{roots.near(), roots.far()};
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Crossings of a line with a sphere: their existence is exact, and t is certified (Roots; §2.2.4, A.1.1).
//
// With l = center − origin, a point origin + t·d of the line is on the sphere if |t·d − l|² = r², that is
//   A t² − 2 b t + c = 0   with   A = d·d,  b = d·l,  c = l·l − r².
// A line that starts on the sphere has c = 0 by definition, whatever its digits say; its roots are 0 and
// 2b/A, and only the second is a crossing other than the start.
//
// Double nearly always decides; if its error bound does not allow it, the same equation is evaluated without
// rounding. docs/numerics.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <cmath>
#include <optional>
#include <type_traits>

#include "../vec3.hpp"
#include "equation.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the equation in numbers of type T, with l = weight · center − origin, so that no division is
/// needed.
template <class T>
[[nodiscard]] QuadraticEquation<T> sphere_equation(const LineOf<T>& line, const Point& center,
                                                   double radius) {
  const VectorOf<T> l = line.weight * given<T>(center) - line.origin;
  const T r = line.weight * Given<T>(radius);
  return {.A = dot(line.direction, line.direction), .b = dot(line.direction, l), .c = dot(l, l) - r * r};
}

namespace detail {

/// Returns the roots without rounding, for lines that double does not decide: all, or only 2b/A if the line
/// starts on the sphere (leaves). If a number is not finite or the direction is 0, there are none.
[[nodiscard, gnu::cold, gnu::noinline]] inline Roots exact_sphere_roots(const Point& origin,
                                                                        const Vec3& direction,
                                                                        const Point& center, double radius,
                                                                        bool leaves) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(center) || !std::isfinite(radius) ||
      direction == Vec3{0})
    return {};
  ++fallbacks.exact;
  const auto equation = sphere_equation(line_of<ExactNumber>(origin, direction), center, radius);
  return leaves ? roots_of(equation.without_root_at_0()) : roots_of(equation);
}

/// Margin added to the error of a discriminant, or of b: more than all underflows together, of 2^-1075 (4A +
/// 3|c| + 6|b| + 2), wherever A < 2^150 and rounding is not larger still.
inline constexpr double underflow = 0x1p-900;

/// Tests whether the square of a direction neither underflows nor takes products with it out of the range of
/// double.
template <class T>
[[nodiscard, gnu::always_inline]] inline auto in_range(const T& A) {
  return 0x1p-150 < A && A < 0x1p150;
}

/// Upper limit for the error of a discriminant; below it, all products of the discriminant are far from
/// overflow.
inline constexpr double overflow = 0x1p900;

}  // namespace detail

/// Line, or several lines, with the terms that their equations with all spheres have in common.
template <class O, class V>
struct SphereLine {
  using T = std::remove_cvref_t<decltype(V::x)>;

  const O& origin;
  const V& direction;
  T A;
  T scale;  ///< scale of errors, 2^20 A; infinite if A is not in range, so that nothing is certain

  [[gnu::always_inline]] SphereLine(const O& from, const V& along)
      : origin(from),
        direction(along),
        A(dot(along, along)),
        scale(select(detail::in_range(A), 0x1p20 * A, T(infinity))) {}
};

namespace detail {

/// Equation in double. T is the number type: double, or the doubles of several lines or of several spheres at
/// once, which are rounded alike. C is double if lines share their origin, since c and w are one number then.
template <class T, class C>
struct RoundedSphereEquation {
  T A, b;
  C c, w;  ///< w = |l|² + r²
  T D, E;  ///< D = b² − A c has an error of at most E

  [[nodiscard, gnu::always_inline]] auto surely_misses() const { return D < -E; }

  /// Returns true if the line certainly starts outside the sphere and leads away from its center, so that it
  /// has no root above 0. The errors of b and c are those in surely_meets; underflow affects neither
  /// comparison.
  [[nodiscard, gnu::always_inline]] auto surely_recedes() const {
    return in_range(A) && c > 0x1p-50 * w && w > 0x1p-900 && b < 0.0 && b * b > 0x1p-100 * (A * w);
  }

  /// Returns true if the line certainly meets the sphere and b and c certainly have their computed signs: the
  /// error of c is at most 7u w, and that of b at most 4u √(A w), while c > 0 and D > 4E make |b| larger than
  /// 2^-24 √(A w). For c < 0, the sign of b does not matter.
  [[nodiscard, gnu::always_inline]] auto surely_meets() const {
    using std::abs;
    return D > 4 * E && abs(c) > 0x1p-18 * w;
  }
};

/// Returns an upper bound for the error of D, which is below 21u A w < 2^-48 A w, underflow apart. The
/// product is 2^20 A w, so it is infinite before b², A c or a part of them overflows.
[[nodiscard, gnu::always_inline]] inline auto error_of_D(const auto& scale, const auto& w) {
  return 0x1p-68 * (scale * w) + underflow;
}

template <class O, class V>
[[nodiscard, gnu::always_inline]] inline auto rounded_sphere_equation(const SphereLine<O, V>& line,
                                                                      const auto& center,
                                                                      const auto& radius) {
  const auto l = center - line.origin;
  const auto b = dot(line.direction, l);
  const auto ll = dot(l, l);
  const auto rr = radius * radius;
  const auto c = ll - rr, w = ll + rr;
  using T = std::remove_const_t<decltype(b)>;
  return RoundedSphereEquation<T, std::remove_const_t<decltype(c)>>{
      .A = line.A, .b = b, .c = c, .w = w, .D = b * b - line.A * c, .E = error_of_D(line.scale, w)};
}

/// Roots of a RoundedSphereEquation without cancellation: q is the one of b ± √D that does not cancel. One
/// root is q/A, and the other c/q, since their product is c/A.
template <class T, class M>
struct CertifiedQuotient {
  T q;
  M certain;  ///< true if q/A and c/q are as accurate as Roots requires
};

/// Returns q, and whether q/A and c/q are certified. The error of c is below 2^-32 |c| for |c| > 2^-18 w. For
/// D > 4E the error of √D is at most E/(1.86 √D), since the true D is at least ¾ of this one: below 2^-31.8
/// |q| here. |c| > 2^-18 w also makes |q| larger than 2^-10 √(A w), so the error of b, 4u √(A w), is
/// negligible. D > 4E holds as well: √D > 2^31 E/|q|, where |q| ≤ 2 √(A w) and E ≥ 2^-48 A w, hence D > 2^12
/// E. (With another E, as in Lagrange's form, D > 4E must be tested.)
template <class T, class C>
[[nodiscard, gnu::always_inline]] inline auto certified_quotient(const RoundedSphereEquation<T, C>& e) {
  using std::abs, std::copysign, std::sqrt;
  const T root = sqrt(e.D);
  const T q = e.b + copysign(root, e.b);
  const auto certain = root * abs(q) > 0x1p31 * e.E && abs(e.c) > 0x1p-18 * e.w;
  return CertifiedQuotient<T, std::remove_const_t<decltype(certain)>>{q, certain};
}

/// Returns the certified roots of a line that starts next to the sphere, where nothing but c cancels; empty
/// if in doubt. In double-double, the error of c is at most 16u² w, below 2^-32 |c| for |c| > 2^-70 w. The
/// rest is as in certified_quotient: |q| is larger than 2^-9 √(A w), since |q|² ≥ √D |q| > 2^31 E, so the
/// errors of b and √D do not need a large c. For w > 2^-900, underflow does not matter.
[[nodiscard, gnu::noinline, gnu::cold]] inline std::optional<Roots> roots_next_to_sphere(
    const Point& origin, const Vec3& direction, const Point& center, double radius) {
  const auto e = rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  if (!(e.D > 4 * e.E && e.w > 0x1p-900)) return std::nullopt;
  const double root = std::sqrt(e.D), q = e.b + std::copysign(root, e.b);
  if (!(root * std::abs(q) > 0x1p31 * e.E)) return std::nullopt;
  DoubleDouble c = -two_product(radius, radius);
  for (int i = 0; i < 3; ++i) {
    const DoubleDouble l = two_sum(center[i], -origin[i]);
    c = c + l * l;
  }
  if (!(std::abs(c.hi) > 0x1p-70 * e.w)) return std::nullopt;
  return roots_from(e.A, c.hi, q);
}

/// Returns the certified roots if b² − A c is in doubt: by Lagrange's form, a refined c, or without rounding.
[[nodiscard, gnu::noinline, gnu::cold]] inline Roots sphere_roots_in_doubt(Point origin, Vec3 direction,
                                                                           Point center, double radius) {
  const Vec3 l = center - origin;
  const double A = dot(direction, direction), b = dot(direction, l), ll = dot(l, l), rr = radius * radius;
  if (in_range(A)) {
    // By Lagrange's identity D = A r² − |l × d|², which does not cancel if the center is far away. For a line
    // that meets the sphere, its error is at most 9u A r s + 15u² A s², s = |l| + r; for one that misses, the
    // computed D is no larger than that.
    const Vec3 moment = cross(l, direction);
    const double r = std::abs(radius), size = std::sqrt(ll) + r;
    const double D = A * rr - dot(moment, moment);
    const double E = 0x1p-49 * A * size * (r + 0x1p-45 * size) + underflow;
    if (E < overflow) {
      if (D < -E) return {};
      const RoundedSphereEquation<double, double> e{
          .A = A, .b = b, .c = ll - rr, .w = ll + rr, .D = D, .E = E};
      if (D > 4 * E)
        if (const auto [q, certain] = certified_quotient(e); certain) return roots_from(e.A, e.c, q);
    }
  }
  if (const auto roots = roots_next_to_sphere(origin, direction, center, radius)) return *roots;
  return exact_sphere_roots(origin, direction, center, radius, false);
}

}  // namespace detail

/// Returns the certified roots.
[[nodiscard, gnu::always_inline]] inline Roots sphere_roots(const Point& origin, const Vec3& direction,
                                                            const Point& center, double radius) {
  const auto equation = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  if (equation.surely_misses()) return {};
  if (const auto [q, certain] = detail::certified_quotient(equation); certain)
    return roots_from(equation.A, equation.c, q);
  return detail::sphere_roots_in_doubt(origin, direction, center, radius);
}

/// Returns the roots of a line whose numbers are rounded, certified; empty if double does not decide. See
/// certified_quotient.
///
/// With the sizes of RoundedLine for those of o and d, and l_size = |l| + o_size, the errors are: l 2u of
/// l_size, b 6u of d_size · l_size, c 9u of w = l_size² + r², A 5u of d_size² and D 28u d_size² w, which for
/// a line that is not rounded is 21u. Hence E is large enough, and with c accurate to 2^-31.8, t is accurate
/// to 2^-30.6.
[[nodiscard]] inline std::optional<Roots> rounded_sphere_roots(const RoundedLine& line, const Point& center,
                                                               double radius) {
  const Vec3 l = center - line.origin, l_size = abs(l) + line.origin_size(), d_size = line.direction_size();
  const double A = dot(line.direction, line.direction), b = dot(line.direction, l), rr = radius * radius;
  const double A_size = dot(d_size, d_size), w = dot(l_size, l_size) + rr;
  if (!detail::in_range(A_size)) return std::nullopt;
  const detail::RoundedSphereEquation<double, double> e{.A = A,
                                                        .b = b,
                                                        .c = dot(l, l) - rr,
                                                        .w = w,
                                                        .D = b * b - A * (dot(l, l) - rr),
                                                        .E = detail::error_of_D(0x1p20 * A_size, w)};
  if (e.surely_misses()) return Roots{};
  if (!(A > 0x1p-18 * A_size)) return std::nullopt;  // otherwise A is accurate to 2^-32
  if (const auto [q, certain] = detail::certified_quotient(e); certain) return roots_from(A, e.c, q);
  return std::nullopt;
}

/// Returns true if a line certainly has no root above 0, by signs alone.
[[nodiscard]] inline bool sphere_surely_behind(const Point& origin, const Vec3& direction,
                                               const Point& center, double radius) {
  return detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius).surely_recedes();
}

/// Returns the first root in t > 0, if double decides which one it is. Signs decide that, so a sphere behind
/// the origin costs no square root, and another one only one division.
[[nodiscard, gnu::always_inline]] inline FirstRoot first_sphere_root(const SphereLine<Point, Vec3>& line,
                                                                     const Point& center, double radius) {
  const auto e = detail::rounded_sphere_equation(line, center, radius);
  if (e.surely_misses()) return {};
  const double least = 0x1p-18 * e.w;
  if (e.c > least) {
    if (e.b < 0) return {.known = e.D > 4 * e.E ? FirstRoot::Known::no_root : FirstRoot::Known::undecided};
    const double root = std::sqrt(e.D), q = e.b + root;
    if (root * q > 0x1p31 * e.E) return {.known = FirstRoot::Known::root, .t = e.c / q, .root = 0};
  } else if (e.c < -least) {
    if (const auto [q, certain] = detail::certified_quotient(e); certain)
      return {.known = FirstRoot::Known::root, .t = q < 0 ? e.c / q : q / e.A, .root = 1};
  }
  return {.known = FirstRoot::Known::undecided};
}

/// Returns the first root in t > 0 of several lines at once, for the active lanes (active). If they start at
/// one point outside the sphere, as camera rays mostly do, it is c/q for all of them.
[[nodiscard, gnu::always_inline]] inline auto first_sphere_root_of_each(const auto& origin,
                                                                        const auto& direction,
                                                                        const Point& center, double radius,
                                                                        const auto& active) {
  using std::sqrt;
  const auto e = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using T = std::remove_const_t<decltype(e.b)>;
  using M = std::remove_cvref_t<decltype(active)>;
  FirstRootOfEach<T, M> first{.t = infinity, .is_there = false, .in_doubt = false};
  const M open = active && !e.surely_misses();
  if (!any(open)) return first;
  const auto find = [&](const T& t, const M& certain, const M& recedes) {
    first.t = t;
    first.is_there = open && certain && !recedes && t > 0.0 && t < infinity;
    first.in_doubt = open && !certain && !(recedes && e.D > 4 * e.E);
  };
  const auto is_outside = e.c > 0x1p-18 * e.w;
  if constexpr (std::is_same_v<decltype(is_outside), const bool>)
    if (is_outside) {
      const T root = sqrt(e.D), q = e.b + root;
      find(e.c / q, root * q > 0x1p31 * e.E && e.b >= 0.0, e.b < 0.0);
      return first;
    }
  const auto [q, certain] = detail::certified_quotient(e);
  const M is_far = M(!is_outside) && q >= 0.0;
  find(select(is_far, q, T(e.c)) / select(is_far, e.A, q), certain, is_outside && q < 0.0);
  return first;
}

/// Returns the roots of several lines at once, in the order near, far, for the active lanes (active). If
/// double decides, the numbers are the same as from sphere_roots. Directions are vectors of lanes; the origin
/// is one point, or one in each lane.
[[nodiscard, gnu::always_inline]] inline auto sphere_roots_of_each(const auto& origin, const auto& direction,
                                                                   const Point& center, double radius,
                                                                   const auto& active) {
  const auto equation = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using T = std::remove_const_t<decltype(equation.A)>;
  using M = std::remove_cvref_t<decltype(active)>;
  const M open = active && !equation.surely_misses();
  const T A = equation.A, c(equation.c);
  if (!any(open))
    return RootsOfEach<T, M>{.near_over = c,
                             .near_under = c,
                             .far_over = c,
                             .far_under = c,
                             .meets = open,
                             .in_doubt = open,
                             .count = 2};
  const auto [q, certain] = detail::certified_quotient(equation);
  const M meets = open && certain;
  // b and q have the same sign. Certified roots are so far apart that rounding does not change their order.
  const auto backwards = q < 0.0;
  return RootsOfEach<T, M>{.near_over = select(backwards, q, c),
                           .near_under = select(backwards, A, q),
                           .far_over = select(backwards, c, q),
                           .far_under = select(backwards, q, A),
                           .meets = meets,
                           .in_doubt = open && !meets,
                           .count = 2};
}

/// Returns which of several lines certainly cross the sphere in t > 0, by signs alone, without computing a
/// root.
[[nodiscard, gnu::always_inline]] inline auto sphere_crossed_by_each(const auto& origin,
                                                                     const auto& direction,
                                                                     const Point& center, double radius,
                                                                     const auto& active) {
  const auto equation = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using M = std::remove_cvref_t<decltype(active)>;
  const M open = active && !equation.surely_misses();
  const M sure = open && equation.surely_meets();
  return CrossedByEach<M>{.crossed = sure && (equation.b > 0.0 || equation.c < 0.0),
                          .in_doubt = open && !sure};
}

/// Returns which of several lines certainly cross the sphere in 0 < t < 1, by signs alone, without computing
/// a root.
///
/// At t = 1 the equation has the value f = A − 2b + c, and half its slope is A − b. The errors of A, b, c are
/// at most 3u A, 4u √(A w) ≤ 2u (A + w) and 7u w, those of the two operations at most 4u (A + w) together, so
/// f and A − b are accurate to 15u (A + w) < 2^-49 (A + w). A line that meets the sphere is inside it between
/// its roots: from outside, it gets there if it ends inside, or else if its nearest point to the center comes
/// before its end.
[[nodiscard, gnu::always_inline]] inline auto sphere_crossed_by_segments(const auto& origin,
                                                                         const auto& direction,
                                                                         const Point& center, double radius,
                                                                         const auto& active) {
  const auto e = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using M = std::remove_cvref_t<decltype(active)>;
  const M open = active && !e.surely_misses();
  if (!any(open)) return CrossedByEach<M>{.crossed = open, .in_doubt = open};
  const auto f = e.A - 2 * e.b + e.c, slope = e.A - e.b, error = 0x1p-49 * (e.A + e.w);
  const auto starts_outside = e.c > 0.0;
  const auto ends_outside = f > error, ends_inside = f < -error;
  const auto approaches = e.b > 0.0, recedes = slope > error;
  const M sure =
      open && e.surely_meets() &&
      (ends_inside || (ends_outside && (!starts_outside || !approaches || recedes || slope < -error)));
  const M crossed = sure && ((starts_outside && approaches && (ends_inside || recedes)) ||
                             (!starts_outside && ends_outside));
  return CrossedByEach<M>{.crossed = crossed, .in_doubt = open && !sure};
}

namespace detail {

/// Equation of a line that starts on the sphere, with the root 2b/A. certain: b is accurate enough for it, as
/// its error is at most 4u |d||l|, hence below 2^-32 |b|.
template <class T, class M>
struct RoundedLeavingEquation {
  T A, b;
  M certain;
};

[[nodiscard, gnu::always_inline]] inline auto rounded_leaving_equation(const auto& origin,
                                                                       const auto& direction,
                                                                       const Point& center, double radius) {
  using std::abs;
  const auto l = center - origin;
  const auto size = abs(l.x) + abs(l.y) + abs(l.z) + std::abs(radius);
  const auto sum = abs(direction.x) + abs(direction.y) + abs(direction.z);
  const auto A = dot(direction, direction), b = dot(direction, l);
  const auto certain = abs(b) > 0x1p-19 * sum * size + underflow && abs(b) < overflow && in_range(A);
  return RoundedLeavingEquation<std::remove_const_t<decltype(A)>, std::remove_const_t<decltype(certain)>>{
      A, b, certain};
}

}  // namespace detail

/// Returns the certified root, other than t = 0, of a line that starts on the sphere.
[[nodiscard]] inline Roots sphere_root_leaving(const Point& origin, const Vec3& direction,
                                               const Point& center, double radius) {
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  if (certain) return Roots{2 * b / A};
  return detail::exact_sphere_roots(origin, direction, center, radius, true);
}

/// Returns true if a line that starts on the sphere certainly has no root above 0.
[[nodiscard]] inline bool left_sphere_surely_behind(const Point& origin, const Vec3& direction,
                                                    const Point& center, double radius) {
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  return certain && b < 0;
}

/// Returns the roots other than t = 0 of several lines that start on the sphere, for the active lanes
/// (active); see sphere_roots_of_each.
[[nodiscard, gnu::always_inline]] inline auto sphere_root_leaving_of_each(const auto& origin,
                                                                          const auto& direction,
                                                                          const Point& center, double radius,
                                                                          const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  using T = std::remove_cvref_t<decltype(b)>;
  const T over = 2 * b;
  return RootsOfEach<T, M>{.near_over = over,
                           .near_under = A,
                           .far_over = over,
                           .far_under = A,
                           .meets = active && certain,
                           .in_doubt = active && !certain,
                           .count = 1};
}

/// Returns which of several lines that start on the sphere certainly cross it in t > 0, or in 0 < t < 1: the
/// root 2b/A has the sign of b, and is below 1 if 2b < A. Both are accurate to 2^-31 of themselves.
[[nodiscard, gnu::always_inline]] inline auto left_sphere_crossed_by_each(const auto& origin,
                                                                          const auto& direction,
                                                                          const Point& center, double radius,
                                                                          const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  return CrossedByEach<M>{.crossed = active && certain && b > 0.0, .in_doubt = active && !certain};
}
[[nodiscard, gnu::always_inline]] inline auto left_sphere_crossed_by_segments(
    const auto& origin, const auto& direction, const Point& center, double radius, const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  const auto over = 2 * b;
  const auto before_end = over < (1 - 0x1p-29) * A;
  const auto behind_end = over > (1 + 0x1p-29) * A;
  const M sure = active && certain && (b < 0.0 || before_end || behind_end);
  return CrossedByEach<M>{.crossed = sure && b > 0.0 && before_end, .in_doubt = active && !sure};
}

}  // namespace protostar::inline PROTOSTAR_ABI

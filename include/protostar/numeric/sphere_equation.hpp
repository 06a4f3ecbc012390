// Equation of a line and a sphere, without rounding and in double with a bound of its error (§2.2.4, A.1.1).
//
// With l = center − origin, a point origin + t·d of the line is on the sphere if |t·d − l|² = r², that is
//   A t² − 2 b t + c = 0   with   A = d·d,  b = d·l,  c = l·l − r².
// A line that starts on the sphere has c = 0 by definition, whatever its digits say; its roots are 0 and
// 2b/A, and only the second is a crossing other than the start.
//
// docs/derivations.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <cmath>
#include <type_traits>

#include "../interval.hpp"
#include "../vec3.hpp"
#include "equation.hpp"

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

}  // namespace protostar::inline PROTOSTAR_ABI

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
#include <optional>
#include <type_traits>

#include "../interval.hpp"
#include "../vec3.hpp"
#include "double_double.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Margin added to the error of a discriminant: more than all underflows together, of 2^-1075 (4A + 3|c| +
/// 6|b| + 2), wherever A < 2^150 and rounding is not larger still.
inline constexpr double underflow = 0x1p-900;

/// Tests whether the square of a direction neither underflows nor takes products with it out of the range of
/// double.
template <class T>
[[nodiscard, gnu::always_inline]] inline auto in_range(const T& A) {
  return 0x1p-150 < A && A < 0x1p150;
}

/// Returns an upper bound for the error of D, which is below 21u A w < 2^-48 A w, underflow apart. The
/// product is 2^20 A w, so it is infinite before b², A c or a part of them overflows. It is infinite also if
/// A is not in range.
template <class T>
[[nodiscard, gnu::always_inline]] inline T error_of_D(const T& A, const auto& w) {
  return 0x1p-68 * (select(in_range(A), 0x1p20 * A, T(infinity)) * w) + underflow;
}

}  // namespace detail

/// Returns the equation in double, of one or more lines and one or more spheres.
[[nodiscard, gnu::always_inline]] inline auto sphere_equation(const auto& rays, const auto& center,
                                                              const auto& radius) {
  const auto l = center - rays.origin;
  const auto A = dot(rays.direction, rays.direction);
  const auto b = dot(rays.direction, l);
  const auto ll = dot(l, l);
  const auto rr = radius * radius;
  const auto c = ll - rr, w = ll + rr;
  using T = std::remove_const_t<decltype(b)>;
  return RoundedQuadratic<T, std::remove_const_t<decltype(c)>>{
      .A = A, .b = b, .c = c, .w = w, .D = b * b - A * c, .E = detail::error_of_D(T(A), w)};
}

/// Returns the equation without rounding, with l = weight · center − origin, so that no division is needed.
[[nodiscard]] inline ExactQuadratic sphere_equation(const ExactLine& line, const Point& center,
                                                    double radius) {
  const ExactVector l = line.weight * exact_vector(center) - line.origin;
  const ExactNumber r = line.weight * radius;
  return {.A = dot(line.direction, line.direction), .b = dot(line.direction, l), .c = dot(l, l) - r * r};
}

/// Returns the equation of a line whose numbers are rounded. With errors o_error and d_error, A is off by
/// d_error · (2 |d| + d_error), b by d_error · (|l| + o_error) + |d| · o_error, and c by o_error · (2 |l| +
/// o_error).
[[nodiscard]] inline RoundedQuadratic<double, double> sphere_equation(const RoundedLine& line,
                                                                      const Point& center, double radius) {
  const Vec3 l = abs(center - line.origin), d = abs(line.direction), &o_error = line.origin_error,
             &d_error = line.direction_error;
  return with_errors(sphere_equation<RoundedLine>(line, center, radius), dot(d_error, 2.0 * d + d_error),
                     dot(d_error, l + o_error) + dot(d, o_error), dot(o_error, 2.0 * l + o_error));
}

/// Tests whether a line certainly starts outside the sphere and leads away from its center, so that it has no
/// root above 0. The errors of b and c are at most 4u √(A w) and 7u w; underflow affects neither comparison.
template <class T, class C>
[[nodiscard, gnu::always_inline]] inline auto surely_recedes(const RoundedQuadratic<T, C>& e) {
  return detail::in_range(e.A) && e.c > 0x1p-50 * e.w && e.w > 0x1p-900 && e.b < 0.0 &&
         e.b * e.b > 0x1p-100 * (e.A * e.w);
}

/// Returns the certified roots of a line that starts close to the sphere, where c alone cancels, by c in
/// double-double; std::nullopt if that does not decide.
[[nodiscard, gnu::noinline, gnu::cold]] inline std::optional<Roots> refined_sphere_roots(const auto& ray,
                                                                                         const Point& center,
                                                                                         double radius) {
  const auto e = sphere_equation(ray, center, radius);
  // In double-double, the error of c is at most 16u² w, below 2^-32 |c|
  // for |c| > 2^-70 w. The rest is as in certified_quotient: |q| is larger than 2^-9 √(A w), since |q|² ≥ √D
  // |q| > 2^31 E, so the errors of b and √D do not need a large c. For w > 2^-900, underflow does not matter.
  if (!(e.D > 4 * e.E && e.w > 0x1p-900)) return std::nullopt;
  const double root = std::sqrt(e.D), q = e.b + std::copysign(root, e.b);
  if (!(root * std::abs(q) > 0x1p31 * e.E)) return std::nullopt;
  DoubleDouble c = -two_product(radius, radius);
  for (int i = 0; i < 3; ++i) {
    const DoubleDouble l = two_sum(center[i], -ray.origin[i]);
    c = c + l * l;
  }
  if (!(std::abs(c.hi) > 0x1p-70 * e.w)) return std::nullopt;
  return roots_from(e.A, c.hi, q);
}

}  // namespace protostar::inline PROTOSTAR_ABI

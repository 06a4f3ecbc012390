// Crossings of a line with a sphere: their existence is exact, and t is certified (Roots; §2.2.4, A.1.1).
//
// Double nearly always decides; if its error bound does not allow it, the same equation is evaluated without
// rounding (sphere_equation.hpp). docs/derivations.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <cmath>
#include <optional>

#include "../interval.hpp"
#include "../vec3.hpp"
#include "double_double.hpp"
#include "equation.hpp"
#include "roots.hpp"
#include "sphere_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

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

}  // namespace protostar::inline PROTOSTAR_ABI

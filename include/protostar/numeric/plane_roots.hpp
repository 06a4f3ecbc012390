// Crossing of a line with a plane, certified (Roots).
//
// A point origin + t·d of the line is on the plane normal · x = distance for t = (distance − normal·origin) /
// normal·d. Double nearly always decides; if its error bound does not allow it, both parts are evaluated
// without rounding.
#pragma once

#include <cmath>
#include <type_traits>

#include "../vec3.hpp"
#include "equation.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the equation in numbers of type T.
template <class T>
[[nodiscard]] LinearEquation<T> plane_equation(const LineOf<T>& line, const Vec3& normal, double distance) {
  const auto n = given<T>(normal);
  return {.height = line.weight * Given<T>(distance) - dot(n, line.origin), .slope = dot(n, line.direction)};
}

namespace detail {

/// Returns the root without rounding, for lines that double does not decide. If a number is not finite, there
/// is none.
[[nodiscard, gnu::noinline, gnu::cold]] inline Roots plane_roots_in_doubt(const Point& origin,
                                                                          const Vec3& direction,
                                                                          const Vec3& normal,
                                                                          double distance) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(normal) || !std::isfinite(distance))
    return {};
  ++fallbacks.exact;
  return roots_of(plane_equation(line_of<ExactNumber>(origin, direction), normal, distance));
}

}  // namespace detail

namespace detail {

/// Numerator and denominator of t in double; certain: both are accurate enough.
///
/// Their errors are at most 4u and 3u (u = 2^-53) of the sums of the magnitudes of their terms. Above 2^-19
/// of these sums, each is accurate to 2^-32; in the given range, underflow is negligible.
template <class H, class S, class M>
struct RoundedPlaneEquation {
  H height;
  S slope;
  M certain;
};

[[nodiscard, gnu::always_inline]] inline auto rounded_plane_equation(const auto& origin,
                                                                     const auto& direction,
                                                                     const Vec3& normal, double distance) {
  using std::abs;
  const auto height = distance - dot(normal, origin);
  const auto slope = dot(normal, direction);
  const auto heights = std::abs(distance) + dot(abs(normal), abs(origin));
  const auto slopes = dot(abs(normal), abs(direction));
  const auto certain = abs(height) > 0x1p-19 * heights && abs(slope) > 0x1p-19 * slopes &&
                       0x1p-900 < heights && heights < 0x1p900 && 0x1p-900 < slopes && slopes < 0x1p900;
  return RoundedPlaneEquation<std::remove_const_t<decltype(height)>, std::remove_const_t<decltype(slope)>,
                              std::remove_const_t<decltype(certain)>>{height, slope, certain};
}

}  // namespace detail

/// Returns the certified root.
[[nodiscard, gnu::always_inline]] inline Roots plane_roots(const Point& origin, const Vec3& direction,
                                                           const Vec3& normal, double distance) {
  const auto [height, slope, certain] = detail::rounded_plane_equation(origin, direction, normal, distance);
  if (certain) return Roots{height / slope};
  return detail::plane_roots_in_doubt(origin, direction, normal, distance);
}

/// Returns the roots of several lines at once, for the active lanes; see sphere_roots_of_each.
[[nodiscard, gnu::always_inline]] inline auto plane_roots_of_each(const auto& origin, const auto& direction,
                                                                  const Vec3& normal, double distance,
                                                                  const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [height, slope, certain] = detail::rounded_plane_equation(origin, direction, normal, distance);
  using T = std::remove_cvref_t<decltype(slope)>;
  return linear_roots_of_each<T, M>(height, slope, active, certain, false);
}

}  // namespace protostar::inline PROTOSTAR_ABI

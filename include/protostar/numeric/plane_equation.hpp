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
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the equation in numbers of type T.
template <class T>
[[nodiscard]] LinearEquation<T> plane_equation(const LineOf<T>& line, const Vec3& normal, double distance) {
  const auto n = given<T>(normal);
  return {.height = line.weight * Given<T>(distance) - dot(n, line.origin), .slope = dot(n, line.direction)};
}

/// Returns the equation in double, of one or more lines.
///
/// The errors of height and slope are at most 4u and 3u (u = 2^-53) of the sums of the magnitudes of their
/// terms. Above 2^-19 of these sums, each is accurate to 2^-32; in the given range, underflow is negligible.
[[nodiscard, gnu::always_inline]] inline auto plane_equation(const auto& origin, const auto& direction,
                                                             const Vec3& normal, double distance) {
  using std::abs;
  const auto height = distance - dot(normal, origin);
  const auto slope = dot(normal, direction);
  const auto heights = std::abs(distance) + dot(abs(normal), abs(origin));
  const auto slopes = dot(abs(normal), abs(direction));
  const auto certain = abs(height) > 0x1p-19 * heights && abs(slope) > 0x1p-19 * slopes &&
                       0x1p-900 < heights && heights < 0x1p900 && 0x1p-900 < slopes && slopes < 0x1p900;
  return RoundedLinear{height, slope, std::remove_const_t<decltype(certain)>(false), certain, certain};
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Crossings of a line with a disk: their existence is exact, and t is certified (Roots).
//
// With w = position − origin, a point origin + t·d of the line is in the disk's plane for t = n·w / n·d.
// Relative to the disk's center it is there at
//   t·d − w = ((n·w) d − (n·d) w) / n·d = v / n·d   with   v = n × (d × w),
// and in the disk if |v| ≤ radius · |n·d|. Double nearly always decides; if its error bound does not allow
// it, everything is evaluated without rounding. docs/derivations.md derives the bounds.
#pragma once

#include <cmath>
#include <optional>
#include <type_traits>

#include "../vec3.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the equation in numbers of type T, with w = weight · position − origin.
template <class T>
[[nodiscard]] LinearEquation<T> disk_equation(const LineOf<T>& line, const Point& position,
                                              const Vec3& normal, double radius) {
  const VectorOf<T> n = vector_of<T>(normal), w = line.weight * given<T>(position) - line.origin,
                    v = cross(n, cross(line.direction, w));
  LinearEquation<T> e{.height = dot(n, w), .slope = dot(n, line.direction), .is_on_surface = std::nullopt};
  const T reach = line.weight * Given<T>(radius) * e.slope;
  if (const auto inside = sign_of(reach * reach - dot(v, v))) e.is_on_surface = *inside >= 0;
  return e;
}

/// Returns the equation in double, of one or more lines. With u = 2^-53, and N, W, D the sums of the
/// magnitudes of the components of n, w and d:
///
/// - height and slope have errors of at most 4u and 3u of the sums of the magnitudes of their terms. Above
///   2^-19 of these sums, t is accurate to 2^-30.
/// - |v| has an error of at most 7.5u N D W, and radius · |slope| one of 4u N D radius. Comparing them has an
///   error of at most 7.5u N D (W + radius); E is 8u of it. A line found to be outside misses regardless of
///   the sign of the slope.
///
/// In the given range, underflow is negligible and nothing overflows.
[[nodiscard, gnu::always_inline]] inline auto disk_equation(const auto& origin, const auto& direction,
                                                            const Point& position, const Vec3& normal,
                                                            double radius) {
  using std::abs, std::sqrt;
  const auto sum_of_sizes = [](const auto& v) { return abs(v.x) + abs(v.y) + abs(v.z); };
  const auto w = position - origin;
  const double N = sum_of_sizes(normal);
  const auto W = sum_of_sizes(w);
  const auto D = sum_of_sizes(direction);
  const auto in_range = 0x1p-100 < N && N < 0x1p100 && 0x1p-100 < D && D < 0x1p100 && W < 0x1p100 &&
                        0x1p-200 < radius && radius < 0x1p100;

  const auto height = dot(normal, w);
  const auto slope = dot(normal, direction);
  const auto heights = dot(abs(normal), abs(w));
  const auto slopes = dot(abs(normal), abs(direction));
  const auto certain = abs(height) > 0x1p-19 * heights && abs(slope) > 0x1p-19 * slopes &&
                       heights > 0x1p-800 && slopes > 0x1p-800;

  const auto m = cross(direction, w);
  const std::remove_const_t<decltype(m)> v{normal.y * m.z - normal.z * m.y, normal.z * m.x - normal.x * m.z,
                                           normal.x * m.y - normal.y * m.x};
  const auto from_center = sqrt(dot(v, v));
  const auto reach = radius * abs(slope);
  const auto E = 0x1p-50 * N * D * (W + radius);
  const auto misses = in_range && from_center > reach + E,
             meets = in_range && from_center < reach - E && certain;
  return RoundedLinear{height, slope, misses, meets, meets};
}

}  // namespace protostar::inline PROTOSTAR_ABI

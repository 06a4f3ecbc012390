// Solid angles that maps of the unit square cover, by differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <protostar/vec3.hpp>

/// Number that is off by at most an error.
struct Estimated {
  double value = 0, error = 0;

  /// Tests whether the number may be 1, and cannot be off by a thousandth.
  bool is_one() const { return std::abs(value - 1) <= error && error < 0x1p-10; }
};

/// Returns the solid angle per area of the unit square to which a map takes (u, v), times the density that it
/// names: 1 for the density of the map. `direction(u, v)` is off by some roundings of 2^-53.
///
/// The derivative by u is (8 (d(h) − d(−h)) − (d(2h) − d(−2h)))/12h, with an error c h⁴ that grows to 16
/// times as much for steps of 2h. The difference of the results by both steps hence is 15 times the error,
/// and is taken for it, as c may vary. Rounding adds 1.5 errors of a direction over h to each derivative. h
/// is 2^-10 of the distance to the border, where maps may have no derivatives: h⁴ and the roundings count
/// alike.
Estimated times_density(const auto& direction, double density, double u, double v, double roundings) {
  const double h = 0x1p-10 * std::min({u, 1 - u, v, 1 - v});
  using protostar::Vec3;
  const Vec3 middle = direction(u, v);
  double scale = 0;
  const auto solid_angle = [&](double step) {
    const auto derivative = [&](double along_u, double along_v) {
      const auto difference = [&](double by) {
        return direction(u + by * along_u, v + by * along_v) - direction(u - by * along_u, v - by * along_v);
      };
      return (8.0 * difference(step) - difference(2 * step)) / (12 * step);
    };
    const Vec3 du = derivative(1, 0), dv = derivative(0, 1);
    scale = length(du) + length(dv);
    return std::abs(dot(cross(du, dv), middle));
  };
  const double wide = solid_angle(2 * h), narrow = solid_angle(h);
  const double rounding = 1.5 * roundings * 0x1p-53 / h * scale;
  return {.value = narrow * density, .error = (std::abs(wide - narrow) + rounding) * density};
}

/// Tests whether concentric maps bend next to (u, v), within the steps of times_density.
inline bool is_at_diagonal(double u, double v) {
  const double h = 0x1p-10 * std::min({u, 1 - u, v, 1 - v});
  return std::min(std::abs(u - v), std::abs(u + v - 1)) < 8 * h;
}

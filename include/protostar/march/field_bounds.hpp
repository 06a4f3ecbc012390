// Box of a marched field: its requirements, and a lower bound of the distance to the surface inside it.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "../bounds.hpp"
#include "../magnitude.hpp"
#include "../shown.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Returns the largest side of a box. Throws std::invalid_argument unless all coordinates are within ±2^400
/// and all sides are from 2^-400 to 2^400 (magnitude.hpp).
[[nodiscard]] inline double largest_side(const Bounds& bounds) {
  for (int k = 0; k < 3; ++k) {
    const double low = bounds.min[k], high = bounds.max[k];
    if (is_coordinate(low) && is_coordinate(high) && is_size(high - low)) continue;
    throw std::invalid_argument("Marched: bounds." + std::string(1, "xyz"[k]) + " goes from " + shown(low) +
                                " to " + shown(high) + "; both must be " + coordinate_rule +
                                ", and the second must be larger than the first, by a number " + size_rule);
  }
  const Vec3 size = bounds.max - bounds.min;
  return std::max({size.x, size.y, size.z});
}

/// Returns a box that is larger by a margin ≥ 0 on each of its six sides, rounded to nearest.
[[nodiscard]] inline Bounds widened(const Bounds& bounds, double margin) {
  return {bounds.min - Vec3(margin), bounds.max + Vec3(margin)};
}

/// Returns a lower bound of the distance from a point to the surface of a field, up to rounding errors of
/// double: |f| / Λ with the sign of f = value(q), for a field with the Lipschitz constant Λ = `lipschitz`.
/// Only the part of the surface inside a box counts. A point p outside of the box has a nearest point q in
/// it, and for each s in the box |p − s|² ≥ |p − q|² + |q − s|², since the angle at q is 90° or more. Hence
/// the bound at q and the distance |p − q| are the legs of a right triangle, whose hypotenuse is the bound at
/// p. A constant field, whose Λ may be 0, has a surface everywhere or nowhere: the bound is 0, or infinite.
[[nodiscard]] double distance_bound(const Point& p, const Bounds& box, double lipschitz, const auto& value) {
  Point q = p;
  for (int k = 0; k < 3; ++k) q[k] = std::clamp(p[k], box.min[k], box.max[k]);
  const double gap = length(p - q), f = value(q), bound = f == 0 ? 0 : f / lipschitz;
  return gap == 0 ? bound : std::sqrt(gap * gap + std::max(bound, 0.0) * std::max(bound, 0.0));
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

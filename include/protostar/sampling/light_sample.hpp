// A direction to a light, as the views of lights draw it.
#pragma once

#include <limits>

#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Direction from a point to a light that was drawn by chance.
struct LightSample {
  Vec3 direction{0, 0, 1};  ///< a unit vector
  double distance = 0;      ///< to the light along the direction, in scene units
  /// Probability per solid angle, in 1/steradian. Infinite if the light covers no solid angle, since the
  /// point is in its plane or the angle is too small for the digits of a view; the light then adds
  /// radiance/density = 0.
  double density = std::numeric_limits<double>::infinity();
};

namespace detail {

/// Returns the distance along a unit direction to a light in a plane. `height` is the distance of the plane,
/// `cosine` that of the direction's angle to the plane's normal, and no point of the light is farther away
/// than `farthest`, which limits the result at grazing angles. The quotient has a relative error of a few
/// u/cosine.
[[nodiscard]] inline double distance_to_plane(double height, double cosine, double farthest) {
  return height < cosine * farthest ? height / cosine : farthest;
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

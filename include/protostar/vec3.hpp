// Points, directions and colors: the tutorial's vec3 (§2.2.1), which here is GLM's.
//
// Geometry is double, color is float. GLM brings the operators of §2.2.1, componentwise and with a scalar,
// and dot(u, v), cross(u, v), length(v) and normalize(v), which are found without a prefix.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A direction or a difference of points, in scene units.
using Vec3 = glm::dvec3;

/// A place, in scene units.
using Point = Vec3;

/// Red, green and blue: linear light, or the share of light that a surface reflects. 0 is black; there is no
/// upper limit.
using Color = glm::vec3;

/// Whether no component is infinite or not a number.
inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Whether every channel is a finite number and none is negative: what a power or a surface's color has to
/// be.
inline bool is_light(const Color& c) {
  return c.r >= 0 && c.g >= 0 && c.b >= 0 && std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Surface coordinates u and v that several kinds of surfaces share.
#pragma once

#include <cmath>
#include <numbers>

#include "../normals.hpp"
#include "../numeric/scale.hpp"
#include "../numeric/trigonometry.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the unit vector along v, of any length; (0, 0, 1) if v is 0, as for a surface without a normal at
/// a point, or if the digits of the point do not determine it.
[[nodiscard]] inline Vec3 unit_along(const Vec3& v) {
  return v == Vec3{0} ? Vec3{0, 0, 1} : normalize(of_moderate_size(v));
}

/// Returns a unit direction as longitude and latitude: u = ½ + the angle of (z, x)/2π and v = the angle from
/// the y axis/π, both from 0 to 1.
[[nodiscard]] inline Uv direction_uv(const Vec3& direction) {
  const double pi = std::numbers::pi;
  return {0.5 + arc_tangent(direction.x, direction.z) / (2 * pi), arc_cosine(direction.y) / pi};
}

/// Returns two unit vectors that span the plane of a unit normal n: e1 along a × n, where a is the coordinate
/// axis on which n is smallest in magnitude, the first of equals, and e2 = n × e1.
[[nodiscard]] inline Tangents plane_tangents(const Vec3& normal) {
  const Vec3 size = abs(normal);
  const Vec3 axis = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                    : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                         : Vec3{0, 0, 1};
  const Vec3 e1 = normalize(cross(axis, normal));
  return {e1, cross(normal, e1)};
}

/// Returns the components of p along plane_tangents.
template <class P>
[[nodiscard]] auto plane_uv(const Vec3& normal, const P& p) {
  const auto [e1, e2] = plane_tangents(normal);
  return uv_of(dot(e1, p), dot(e2, p));
}

/// Returns the directions in which direction_uv moves a direction: towards greater longitude, and down.
[[nodiscard]] inline Tangents direction_tangents(const Vec3& direction) {
  const Vec3 around{direction.z, 0, -direction.x};
  return {around, cross(around, direction)};
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Surface normals and shading normals: what a normal map changes at a hit, and what it leaves.
//
// A normal map stores directions in tangent space: x along the surface's u, z along its normal n, and y at a
// right angle to both, on the side to which v grows. With the direction t = ∂p/∂u − (n·∂p/∂u) n, made a unit
// vector, and b = ±n × t, the shading normal is that of x t + y b + z n. The frame is orthonormal also where
// u and v are oblique, and it is mirrored where u or v is.
#pragma once

#include <cmath>

#include "numeric/scale.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Directions, of any length, in which a point of a surface moves as u grows and v stays, and as v grows and
/// u stays: multiples of ∂p/∂u and ∂p/∂v by a positive number. Both are 0 where u and v do not tell, as at
/// the pole of a sphere.
struct Tangents {
  Vec3 u{0}, v{0};
};

/// Returns the unit normal that a normal map's direction, of any length, stands for on a surface with this
/// unit normal. It is the surface's own where x and y are 0, and where the tangents span no plane.
[[nodiscard]] inline Vec3 out_of_tangent_space(const Vec3& direction, const Vec3& normal,
                                               const Tangents& tangents) {
  const Vec3 d = of_moderate_size(direction), across = cross(normal, of_moderate_size(tangents.u));
  const double side = dot(across, of_moderate_size(tangents.v));
  if ((d.x == 0 && d.y == 0) || side == 0) return normal;
  const Vec3 b = normalize(side > 0 ? across : -across);
  const Vec3 t = normalize(cross(across, normal));  // (n × u) × n = u − (n·u) n for a unit vector n
  return normalize(d.x * t + d.y * b + d.z * normal);
}

/// Unit normals at a hit, or at those of a packet, all on one side of the surface.
///
/// The surface's own normal decides about sides: which side a ray comes from, whether a light is in front,
/// where a mirrored or refracted ray may lead. The shading normal, which a normal map tilts, decides how much
/// light is reflected, and where to. Without a normal map they are the same.
template <class V>
struct Normals {
  V surface, shading;
  bool is_mapped = false;  ///< true if the material has a normal map

  /// Returns the normals on the side that a ray of this direction comes from.
  [[nodiscard]] Normals facing(const V& direction) const {
    const auto is_outside = dot(surface, direction) <= 0.0;
    const V n = select(is_outside, surface, -surface);
    if (is_mapped) [[unlikely]]
      return {n, select(is_outside, shading, -shading), true};
    return {n, n};
  }

  /// Takes the normals on the other side.
  void turn() { surface *= -1.0, shading *= -1.0; }

  /// Returns n·l for the shading normal n and the vector l to a light; 0 if the light is behind the surface,
  /// which it does not shine through, however the shading normal is tilted.
  [[nodiscard]] auto height(const V& to_light) const {
    const auto n_l = dot(shading, to_light);
    if (is_mapped) [[unlikely]]
      return select(dot(surface, to_light) > 0.0, n_l, 0.0 * n_l);
    return n_l;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

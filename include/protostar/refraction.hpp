// Directions of light behind mirrors and smooth boundaries of glass, and how much goes which way.
#pragma once

#include <cmath>
#include <type_traits>

#include "normals.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns d, seen in a mirror with this unit normal.
template <class V>
[[nodiscard]] V reflected(const V& d, const V& normal) {
  return d - 2 * dot(normal, d) * normal;
}

/// Refracted direction, if light passes a surface.
template <class V, class Answer>
struct Refraction {
  Answer passes;  ///< if false, all light is reflected
  V direction;    ///< not a number if it does not pass
};

/// Returns the unit direction d after it has passed a surface whose unit normal faces it (n·d ≤ 0), by
/// Snell's law: the sine of its angle to the normal is ratio times as large as before, ratio being the index
/// of refraction before the surface over that behind it. Light passes if there is such an angle.
template <class V, class Number>
[[nodiscard]] auto refracted(const V& d, const V& normal, const Number& ratio) {
  using std::sqrt;
  const auto cosine = -dot(normal, d);
  const auto square = 1 - ratio * ratio * (1 - cosine * cosine);  // square of the cosine behind the surface
  const auto passes = square >= 0.0;
  return Refraction<V, std::remove_const_t<decltype(passes)>>{
      passes, ratio * d + (ratio * cosine - sqrt(square)) * normal};
}

/// Returns the normal by which a ray of this direction is mirrored and refracted: the shading normal, or the
/// surface's own where the shading normal would mirror the ray into the surface.
template <class V>
[[nodiscard]] V mirroring_normal(const Normals<V>& facing, const V& direction) {
  if (!facing.is_mapped) return facing.shading;
  const auto leads_away = dot(facing.surface, reflected(direction, facing.shading)) > 0.0;
  return select(leads_away, facing.shading, facing.surface);
}

/// Returns the share of unpolarized light that a smooth boundary reflects (Fresnel's equations), from the
/// cosines of the angles to the normal before the boundary and behind it, which Snell's law connects: ratio
/// is the index of refraction before the boundary over that behind it. The rest passes.
[[nodiscard]] inline double fresnel_reflectance(double before, double behind, double ratio) {
  if (!(before > 0)) return 1;
  const double across = (ratio * before - behind) / (ratio * before + behind);
  const double along = (before - ratio * behind) / (before + ratio * behind);
  return (across * across + along * along) / 2;
}

}  // namespace protostar::inline PROTOSTAR_ABI

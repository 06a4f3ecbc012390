// Irradiance of a hit from one light, 0 where the light is occluded (§2.3.2).
#pragma once

#include "../light.hpp"
#include "../ray.hpp"
#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns V · E for a light: E is its irradiance of the surface at the hit, and V, the visibility, is 1 if
/// nothing is between, else 0. A light behind the surface has E = 0, and no shadow ray is traced to it.
template <class Hit>
[[nodiscard]] typename Hit::Light visible_irradiance(const auto& scene, const Hit& hit, const Light& light) {
  const auto to_light = light.towards(hit.point());
  const auto height = dot(hit.facing_normal(), to_light);
  const auto in_front = height > 0.0;
  if (!any(in_front)) return typename Hit::Light(0);
  // The direction is not normalized: a light at a finite distance is at t = 1, and occluders lie in (0, 1);
  // for a light in a direction, they lie in (0, ∞).
  const auto visible =
      in_front && !scene.occluded(masked(in_front, hit.leave(to_light)), light.occlusion_range());
  if (!any(visible)) return typename Hit::Light(0);
  return select(visible, light.received(to_light, height), typename Hit::Light(0));
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Shows diffuse surfaces under the lights of the scene, with shadows: Appel's picture (§2.3.2, Fig. 20).
#pragma once

#include "first_hit.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of diffuse surfaces with shadows: their radiance towards the ray's origin, from the lights that
/// are not occluded. The sky, or black, if there is no hit.
struct ShadowIntegrator : FirstHit<ShadowIntegrator> {
  using TakesPackets = ShadowIntegrator;  ///< takes packets as well as rays (accel/packet.hpp)

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    const auto point = hit.point();
    const auto normal = hit.facing_normal();
    typename Hit::Light irradiance(ambient_of(scene));
    for (const Light& light : scene.lights()) {
      const auto to_light = light.towards(point);
      const auto height = dot(normal, to_light);
      const auto in_front = height > 0.0;
      if (!any(in_front)) continue;  // a light behind the surface needs no shadow ray
      // The shadow ray is not normalized: it is at a near light for t = 1, so occluders lie in (0, 1).
      const auto visible = in_front && !scene.occluded(only(in_front, hit.leave(to_light)), light.way());
      if (!any(visible)) continue;
      irradiance += select(visible, light.received(to_light, height), typename Hit::Light(0));
    }
    return held(hit.color() * irradiance);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

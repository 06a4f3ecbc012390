// Shows diffuse surfaces under the lights of the scene, without shadows (§2.3.2, Figs. 14 and 15).
#pragma once

#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of diffuse surfaces without shadows: their radiance towards the ray's origin is the color times
/// the irradiance of all lights on the side that the ray sees. The sky, or black, if there is no hit. Nothing
/// occludes a light.
struct DiffuseIntegrator : FirstHit<DiffuseIntegrator> {
  using TakesPackets = DiffuseIntegrator;  ///< takes packets as well as rays (accel/packet.hpp)

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    typename Hit::Light irradiance(ambient_of(scene));
    for (const Light& light : scene.lights()) {
      const auto to_light = light.towards(hit.point());
      irradiance += light.received(to_light, hit.height(to_light));
    }
    return clamped(hit.color() * irradiance);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

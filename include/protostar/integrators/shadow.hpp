// Shows diffuse surfaces under the lights of the scene, with shadows: Appel's picture (§2.3.2, Fig. 20).
#pragma once

#include "../light.hpp"
#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of diffuse surfaces with shadows: the color times the ambient irradiance and that of all lights
/// that are not occluded. The color stands for albedo/π (docs/errata.md). The sky, or black, if there is no
/// hit.
struct ShadowIntegrator : FirstHit<ShadowIntegrator> {
  using TakesPackets = ShadowIntegrator;  ///< takes packets as well as rays (accel/packet.hpp)

  /// Returns the radiance of a hit, with channels that are finite floats; of a HitPacket, for each of its
  /// rays. The scene says which points are occluded from a light.
  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    typename Hit::Light irradiance(ambient_of(scene));
    for (const Light& light : scene.lights()) irradiance += visible_irradiance(scene, hit, light);
    return clamped(hit.color() * irradiance);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

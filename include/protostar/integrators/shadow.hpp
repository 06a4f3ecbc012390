// Shows diffuse surfaces under the lights of the scene, with shadows: Appel's picture (§2.3.2, Fig. 20).
#pragma once

#include "../light.hpp"
#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of diffuse surfaces with shadows: a hit has the radiance of its color times the irradiance, of
/// the ambient light and of all lights that are not occluded. The color stands for albedo/π (docs/errata.md).
/// A ray without a hit has the radiance of the environment, else of the sky, else black.
struct ShadowIntegrator : FirstHit<ShadowIntegrator> {
  /// Says that it takes packets as well as rays. It names its own type: one that derives from it, and may
  /// have another shade, takes none until it says so (PacketIntegrator).
  using TakesPackets = ShadowIntegrator;

  /// Returns the radiance of a hit, with channels that are finite floats: a Color, or for a HitPacket the
  /// Colors of its rays (Hit::Light). A light counts if it is on the side that the ray comes from, and
  /// scene.occluded finds nothing on the shadow ray to it.
  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    typename Hit::Light irradiance(ambient_of(scene));
    for (const Light& light : scene.lights()) irradiance += visible_irradiance(scene, hit, light);
    return clamped(hit.color() * irradiance);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

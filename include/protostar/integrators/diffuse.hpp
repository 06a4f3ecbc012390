// Diffuse surfaces under the lights of the scene, without shadows (§2.3.2, Figs. 14 and 15).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The light that a diffuse surface sends towards the ray's origin: its color times the irradiance of all
/// lights on the side that the ray sees; the sky, or black, where there is nothing. Nothing hides a light.
struct DiffuseIntegrator {
  using TakesPackets = DiffuseIntegrator;  ///< of rays, as well as single ones (accel/packet.hpp)

  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit, scene) : background(ray, scene);
  }

  template <class R>
  [[nodiscard]] typename R::Light background(const R& ray, const auto& scene) const {
    return sky_of(ray, scene, Color{0});
  }

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    const auto point = hit.point();
    const auto normal = hit.facing_normal();
    typename Hit::Light irradiance(ambient_of(scene));
    for (const Light& light : scene.lights()) irradiance += light.irradiance(point, normal);
    return held(hit.color() * irradiance);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

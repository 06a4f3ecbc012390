// Diffuse surfaces under the lights of the scene, with shadows: Appel's picture (§2.3.2, Fig. 20).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The light that a diffuse surface sends towards the ray's origin, from the lights that it can see; black
/// where there is nothing.
struct ShadowIntegrator {
  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit, scene) : Color{0};
  }

  [[nodiscard]] Color shade(const Intersection& hit, const Traceable auto& scene) const {
    const Point point = hit.point();
    const Vec3 normal = hit.facing_normal();
    Color irradiance{0};
    for (const PointLight& light : scene.lights()) {
      const Color unhindered = light.irradiance(point, normal);
      if (unhindered == Color{0}) continue;  // a light behind the surface needs no shadow ray
      // The shadow ray is not normalized: it is at the light for t = 1, so occluders lie in (0, 1).
      const Ray shadow_ray = hit.leave(light.position - point);
      if (!scene.occluded(shadow_ray, Interval{0, 1})) irradiance += unhindered;
    }
    return hit.color() * irradiance;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

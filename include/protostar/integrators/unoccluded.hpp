// Shows diffuse surfaces in the light of surfaces that emit it, without shadows and without noise.
#pragma once

#include "../area_lights.hpp"
#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of soft light in closed form: the radiance of a hit is
///   L_e + ρ/π · Σ E
/// with its emission L_e, its color as the albedo ρ, and the irradiance E of each light: the ambient ones,
/// those at a point or in a direction, and the area lights, by the formulas of irradiance.hpp. Nothing
/// occludes a light, so that no ray is traced but the camera's, and nothing is drawn by chance. The sky, or
/// black, if there is no hit.
struct UnoccludedIntegrator : FirstHit<UnoccludedIntegrator> {
  AreaLights lights;

  /// Prepares the lights of a scene; pictures of that scene can then be drawn.
  template <Surface... S>
  explicit UnoccludedIntegrator(const Scene<S...>& scene) : lights(scene) {}

  /// Throws std::logic_error if the scene is not the one of the lights.
  [[nodiscard]] Color shade(const Intersection& hit, const auto& scene) const {
    lights.require(scene);
    const Material& material = hit.material();
    const Color albedo = hit.color();
    if (is_black(albedo)) return material.emission;
    Color light = ambient_of(scene);
    for (const Light& one : scene.lights()) {
      const Vec3 to_light = one.towards(hit.point());
      light += one.received(to_light, hit.height(to_light));
    }
    light *= to_float(1 / std::numbers::pi);
    for (const AreaLight& one : lights.lights())
      light += one.emission() * to_float(one.unoccluded_irradiance(hit) / std::numbers::pi);
    return clamped(material.emission + albedo * clamped(light));
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

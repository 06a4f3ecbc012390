// Shows diffuse surfaces in the light of surfaces that emit it, without shadows and without noise.
#pragma once

#include <numbers>

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
  /// Says that camera rays may be traced in packets (accel/packet_integrator.hpp). It names its own type.
  using ShadesEachHit = UnoccludedIntegrator;

  AreaLights lights;

  /// Prepares the lights of a scene; pictures of that scene can then be drawn.
  template <Surface... S>
  explicit UnoccludedIntegrator(const Scene<S...>& scene) : lights(scene) {}

  /// Throws std::logic_error if the scene is not the one of the lights.
  [[nodiscard]] Color shade(const Intersection& hit, const auto& scene) const {
    return lights.matte_radiance(
        hit, scene,
        [&](const Light& one) {
          const Vec3 to_light = one.towards(hit.point());
          return one.received(to_light, hit.height(to_light));
        },
        [&](const AreaLight& one) { return one.unoccluded_irradiance(hit) / std::numbers::pi; });
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

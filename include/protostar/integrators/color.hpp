// Shows surfaces in their flat colors (§2.3.2, Fig. 11).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that returns the color of the closest hit, unlit; the sky, or black, if there is none.
struct ColorIntegrator {
  using TakesPackets = ColorIntegrator;    ///< takes packets as well as rays (accel/packet.hpp)
  using ShadesAnywhere = ColorIntegrator;  ///< has shade_anywhere, for surfaces without a texture

  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit, scene) : background(ray, scene);
  }

  template <class R>
  [[nodiscard]] typename R::Light background(const R& ray, const auto& scene) const {
    return sky_of(ray, scene, Color{0});
  }

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto&) const {
    return hit.color();
  }

  /// Returns the radiance of any hit on a surface without a texture.
  [[nodiscard]] Color shade_anywhere(const Material& material) const { return material.diffuse; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

// The flat colors of what is seen (§2.3.2, Fig. 11).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Shows each surface in its color, unlit; the sky, or black, where there is nothing.
struct ColorIntegrator {
  using TakesPackets = ColorIntegrator;    ///< of rays, as well as single ones (accel/packet.hpp)
  using ShadesAnywhere = ColorIntegrator;  ///< by shade_anywhere, where there is no texture

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

  /// The same of a surface without a texture, wherever a ray meets it.
  [[nodiscard]] Color shade_anywhere(const Material& material) const { return material.diffuse; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

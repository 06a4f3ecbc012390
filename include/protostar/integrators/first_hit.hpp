// Base of integrators that shade the closest hit.
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Supplies radiance and background to an integrator that derives from it and has shade(hit, scene): the
/// radiance of a ray is that of its closest hit.
template <class Integrator>
struct FirstHit {
  /// Returns shade(hit, scene) of the closest hit, or background(ray, scene) if there is none.
  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto& integrator = static_cast<const Integrator&>(*this);
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? integrator.shade(*hit, scene) : integrator.background(ray, scene);
  }

  /// Returns the radiance of a ray that hits nothing: the sky's, or black.
  template <class R>
  [[nodiscard]] typename R::Light background(const R& ray, const auto& scene) const {
    return sky_of(ray, scene, Color{0});
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

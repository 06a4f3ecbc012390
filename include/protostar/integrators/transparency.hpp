// Shows surfaces as colored glass that does not bend the light (§2.3.2, Figs. 16–19).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that filters background light, the sky's or white, by the color of every surface that the ray
/// crosses, on its way in and on its way out. The ray is never restarted: one pass over the surfaces finds
/// all hits, so the work grows with their number and not with its square, and there is no limit to them. The
/// product is taken in the order of the surfaces.
struct TransparencyIntegrator {
  using TakesPackets = TransparencyIntegrator;      ///< takes packets as well as rays (accel/packet.hpp)
  using AsksForCrossings = TransparencyIntegrator;  ///< asks for crossings and the sky only

  template <class R = Ray>
  [[nodiscard]] typename R::Light radiance(const R& ray, const auto& scene) const {
    typename R::Light light = sky_of(ray, scene, Color{1});
    scene.crossings(ray, Interval{}, [&](const auto& crossing) { light *= crossing.color(); });
    // An infinite product that then meets black, 0 · ∞, is NaN and becomes black.
    const auto number = [](auto x) { return select(x > 0.0f, x, decltype(x)(0)); };
    return clamped(typename R::Light{number(light.r), number(light.g), number(light.b)});
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

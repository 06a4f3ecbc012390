// Shows surfaces white and the rest black (§2.3.2).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that returns white for a ray with any hit, else black; it does not ask for the closest hit.
struct BinaryIntegrator {
  using TakesPackets = BinaryIntegrator;        ///< takes packets as well as rays (accel/packet.hpp)
  using ShadesWithoutPoint = BinaryIntegrator;  ///< needs no point of a hit

  template <class R = Ray>
  [[nodiscard]] typename R::Light radiance(const R& ray, const auto& scene) const {
    return select(scene.occluded(ray, Interval{}), Color{1}, Color{0});
  }

  /// Returns the radiance of a ray with a hit; background returns that of a ray without one. Tiles call these
  /// two, as they find out what pixels see before they ask an integrator (accel/tile_renderer.hpp).
  [[nodiscard]] Color shade(const auto&, const auto&) const { return Color{1}; }
  [[nodiscard]] Color background(const auto&, const auto&) const { return Color{0}; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

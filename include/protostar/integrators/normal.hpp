// Shows the normals of surfaces as colors (§2.3.2, Fig. 10).
#pragma once

#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that maps the unit shading normal, on the surface's outside, from [−1, 1]³ to [0, 1]³, with x,
/// y and z to red, green and blue; black if there is no hit. Without a normal map it is the surface's normal.
struct NormalIntegrator : FirstHit<NormalIntegrator> {
  using TakesPackets = NormalIntegrator;  ///< takes packets as well as rays (accel/packet.hpp)

  [[nodiscard]] Color background(const auto&, const auto&) const { return Color{0}; }

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto&) const {
    return typename Hit::Light(0.5 * hit.normal() + 0.5);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

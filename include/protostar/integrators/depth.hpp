// Shows the reciprocal distance of surfaces (§2.3.2, Fig. 9).
#pragma once

#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that returns 1/t of the closest hit, with t the distance in scene units for rays of unit
/// direction; black if there is none, as for a surface infinitely far away.
struct DepthIntegrator : FirstHit<DepthIntegrator> {
  using TakesPackets = DepthIntegrator;  ///< takes packets as well as rays (accel/packet.hpp)

  [[nodiscard]] Color background(const auto&, const auto&) const { return Color{0}; }

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto&) const {
    return clamped(typename Hit::Light(to_float(1 / hit.t)));  // the reciprocal may exceed the largest float
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

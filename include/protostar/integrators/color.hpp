// Shows surfaces in their flat colors (§2.3.2, Fig. 11).
#pragma once

#include "../render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that returns the color of the closest hit, unlit; the sky, or black, if there is none.
struct ColorIntegrator : FirstHit<ColorIntegrator> {
  using TakesPackets = ColorIntegrator;        ///< takes packets as well as rays (accel/packet.hpp)
  using ShadesWithoutPoint = ColorIntegrator;  ///< needs no point of a hit, unless there is a texture

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto&) const {
    return hit.color();
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

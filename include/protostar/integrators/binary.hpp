// White where there is a surface, black where there is none (§2.3.2).
#pragma once

#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Shows whether a ray meets anything at all, so it does not even ask what is first.
struct BinaryIntegrator {
  using TakesPackets = BinaryIntegrator;  ///< of rays, as well as single ones (accel/packet.hpp)

  template <class R = Ray>
  [[nodiscard]] typename R::Light radiance(const R& ray, const auto& scene) const {
    return select(scene.occluded(ray, Interval{}), Color{1}, Color{0});
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

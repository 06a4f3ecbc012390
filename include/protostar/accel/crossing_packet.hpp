// Packets of camera rays of which float tells all that they cross.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "../ray.hpp"
#include "../simd/simd.hpp"
#include "candidates.hpp"
#include "packet.hpp"
#include "pixel_rays.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Camera rays through the pixels of a packet, of which float tells all that they cross. Their directions are
/// not computed until a ray is asked for.
struct CrossingPacket {
  using Light = Colors;

  /// Surface, by its index in the scene's order, and lanes in which a ray crosses it on its way in and out.
  struct Crossed {
    std::int32_t place;
    Bits lanes;
  };

  std::span<const Crossed> crossed;
  int first_lane;  ///< lane of `crossed` that is the first of this packet
  const PixelRays& rays;
  int x, y;  ///< first pixel
  LaneMask active = true;

  [[nodiscard]] Ray operator[](int lane) const {
    return Ray{rays.camera().position, rays.directions(x, y)[lane]};
  }
};
/// Lists the surfaces that rays of a block cross; returns false if float is not sure, or if the color of one
/// differs from point to point: has_texture(index).
[[nodiscard, gnu::always_inline]] inline bool find_crossed(const WideVectors& directions,
                                                           const Candidates& candidates,
                                                           const auto& has_texture,
                                                           std::vector<CrossingPacket::Crossed>& crossed) {
  crossed.clear();
  for (int k = 0; k < candidates.size(); ++k) {
    const CandidateSphere sphere = candidates.sphere(k);
    const SpherePass passed = pass(sphere, directions);
    const Bits maybe = bits(passed.maybe());
    if (maybe == 0) continue;
    if (maybe != (bits(passed.surely()) & maybe) || has_texture(candidates.place(k))) return false;
    crossed.push_back({candidates.place(k), maybe});
  }
  return true;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Packets of camera rays that wait for their colors.
#pragma once

#include <array>
#include <cstddef>

#include "../image.hpp"
#include "../simd/simd.hpp"
#include "packet.hpp"
#include "packet_pixels.hpp"
#include "pixel_rays.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Packets of a part of a tile that wait for their colors. All of a part go through one step after the other:
/// directions, closest hits, colors. The latencies of their square roots and divisions overlap, and what
/// memory has to fetch for a packet is on its way while others go on.
template <class Closest>
struct WaitingPackets {
  std::size_t count = 0;
  std::array<PacketStart, most_packets> start;
  std::array<PacketRays, most_packets> rays;
  std::array<Closest, most_packets> closest;  ///< closest hits; of a packet not yet tested, what it sees
  std::array<bool, most_packets> is_tested;

  /// Adds a packet that sees this, and returns its rays, which have to be found.
  PacketRays& add(int x, int y, const Indices& seen) {
    start[count] = {x, y}, closest[count].index = seen, is_tested[count] = false;
    return rays[count++];
  }

  /// Finds the closest hits of the k-th packet, which sees this, and prefetches the materials if they may be
  /// anywhere in memory.
  [[gnu::always_inline]] void test(std::size_t k, const Indices& seen, const PixelRays& rays_of,
                                   const Tile& part, const auto& view, int i, bool prefetches) {
    const auto [x, y] = start[k];
    view.set_first_pixel(x, y, i);
    closest[k] = view.closest(rays_of.packet(part, x, y, i, rays[k]), seen);
    is_tested[k] = true;
    if (prefetches) view.prefetch_materials(closest[k]);
  }

  /// Finds the closest hits of packets from the first on that are not tested; or only of those with a ray in
  /// doubt, which is tested with all of the view's candidates.
  [[gnu::flatten, gnu::noinline]] void test_from(std::size_t first, bool only_in_doubt,
                                                 const PixelRays& rays_of, const Tile& part, const auto& view,
                                                 int i, bool prefetches) {
    for (std::size_t k = first; k < count; ++k) {
      const Indices seen = closest[k].index;
      if (!is_tested[k] && (!only_in_doubt || any(seen == Indices(is_in_doubt))))
        test(k, seen, rays_of, part, view, i, prefetches);
    }
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

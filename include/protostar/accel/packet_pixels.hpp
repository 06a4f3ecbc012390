// Pixels of the packets of a tile: which there are, and how their colors are written into an image.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "../image.hpp"
#include "../sampling/exact_lanes.hpp"
#include "../sampling/sample_target.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "packet.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// First pixel of a packet.
struct PacketStart {
  int x, y;
};

/// Calls visit(i, x, y) for the packets of a tile, the i-th of which begins at pixel (x, y).
inline void each_packet(const Tile& tile, const auto& visit) {
  std::size_t i = 0;
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; x += double_lanes) visit(i++, x, y);
}

/// Calls visit(block) for the blocks of rays of a part of a tile, row by row: as far as their pixels are in
/// it.
inline void each_block(const Tile& part, const auto& visit) {
  for (int y = part.y0; y < part.y1; y += RayBlock::height)
    for (int x = part.x0; x < part.x1; x += RayBlock::width)
      visit(Tile{x, y, std::min(x + RayBlock::width, part.x1), std::min(y + RayBlock::height, part.y1)});
}

/// Largest number of packets in a part of a tile.
inline constexpr std::size_t most_packets = 16 * ((16 + double_lanes - 1) / double_lanes);

/// Exact sums of the colors of a packet's pixels.
struct PacketSums {
  ExactLanes<double_lanes> r, g, b;

  /// Returns which packet of a tile begins at pixel (x, y), as each_packet counts them.
  static std::size_t index(const Tile& tile, int x, int y) {
    const int in_row = (tile.width() + double_lanes - 1) / double_lanes;
    return static_cast<std::size_t>((y - tile.y0) * in_row + (x - tile.x0) / double_lanes);
  }

  void add(const Colors& colors) { r.add(colors.r), g.add(colors.g), b.add(colors.b); }

  /// Returns the mean of so many colors.
  [[nodiscard]] Colors mean(std::uint32_t count) const {
    return {r.mean(count), g.mean(count), b.mean(count)};
  }

  /// Returns the sum in a lane.
  [[nodiscard]] ExactColorSum operator[](int lane) const { return {{r[lane], g[lane], b[lane]}}; }
};

/// Prefetches the pixels of a packet, which will be set after other work.
inline void prefetch_packet(Image& image, const Tile& tile, int x, int y) {
  const auto* const pixels = reinterpret_cast<const char*>(&image(x, y));
  const auto bytes = sizeof(Color) * static_cast<std::size_t>(std::min(double_lanes, tile.x1 - x));
  prefetch_to_write(pixels), prefetch_to_write(pixels + bytes - 1);
}

/// Sets the colors of a packet's pixels, as far as these are in the tile. The packet begins at pixel (x, y).
inline void set_packet(Image& image, const Tile& tile, int x, int y, const Colors& colors) {
  Color* const pixels = &image(x, y);
  const int count = std::min(double_lanes, tile.x1 - x);
  if (count == double_lanes) return store_in_turn(pixels, colors.r, colors.g, colors.b);
  Color all[double_lanes];
  store_in_turn(all, colors.r, colors.g, colors.b);
  std::copy_n(all, count, pixels);
}

/// Gives the sums of so many samples of a packet's pixels, which are their sum number `which`, to the target.
inline void give_packet(const protostar::detail::SampleTarget& target, const Tile& tile, int x, int y,
                        const PacketSums& sums, int which, std::uint32_t count) {
  if (target.image()) return set_packet(*target.image(), tile, x, y, sums.mean(count));
  for (int k = 0; k < std::min(double_lanes, tile.x1 - x); ++k)
    target.sums(x + k, y).add_sum(static_cast<std::uint32_t>(which), sums[k], count);
}

/// Gives all pixels of a tile one color.
inline void fill_tile(Image& image, const Tile& tile, const Color& color) {
  Color some[float_lanes];
  std::fill_n(some, float_lanes, color);
  for (int y = tile.y0; y < tile.y1; ++y) {
    Color *to = &image(tile.x0, y), *const end = to + tile.width();
    for (; end - to >= float_lanes; to += float_lanes) std::memcpy(to, some, sizeof(some));
    std::copy_n(some, end - to, to);
  }
}

/// Gives all samples of a tile's pixels one light.
inline void give_tile(const protostar::detail::SampleTarget& target, const PixelGrid& pixels,
                      const Tile& tile, const Color& light) {
  if (target.image()) return fill_tile(*target.image(), tile, pixels.mean_of_equal(light));
  const PixelSums sums = pixels.sums_of_equal(light);
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) target.sums(x, y) += sums;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

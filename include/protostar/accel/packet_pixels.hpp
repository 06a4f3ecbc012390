// Pixels of the packets of a tile: which there are, and how their colors are written into an image.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "../image.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "packet.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Calls visit(i, x, y) for the packets of a tile, the i-th of which begins at pixel (x, y).
inline void each_packet(const Tile& tile, const auto& visit) {
  std::size_t i = 0;
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; x += double_lanes) visit(i++, x, y);
}

/// Writes the colors of a packet that begins at pixel (x, y), as far as its pixels are in the tile.
inline void write_packet(Image& image, const Tile& tile, int x, int y, const Colors& colors) {
  static_assert(sizeof(Color) == 3 * sizeof(float));
  Color* const pixels = &image(x, y);
  if (x + double_lanes <= tile.x1) return store_in_turn(pixels, colors.r, colors.g, colors.b);
  for (int i = 0; x + i < tile.x1; ++i) pixels[i] = {colors.r[i], colors.g[i], colors.b[i]};
}

/// Colors of a packet, one pixel after the other.
using PacketOfColors = std::array<Color, double_lanes>;
[[nodiscard]] inline PacketOfColors pixels_of(const Colors& colors) {
  PacketOfColors pixels;
  for (int i = 0; i < double_lanes; ++i)
    pixels[static_cast<std::size_t>(i)] = {colors.r[i], colors.g[i], colors.b[i]};
  return pixels;
}
inline void write_packet(Image& image, const Tile& tile, int x, int y, const PacketOfColors& colors) {
  Color* const pixels = &image(x, y);
  if (x + double_lanes <= tile.x1)
    std::copy(colors.begin(), colors.end(), pixels);
  else
    std::copy_n(colors.begin(), tile.x1 - x, pixels);
}

/// Prefetches, for writing, the pixels of a packet a few rows below. Rows of a tile are too short for the
/// processor to foresee where the next one is.
inline void prefetch_below(Image& image, const Tile& tile, int x, int y) {
  constexpr int rows = 4;
  if (y + rows >= tile.y1) return;
  Color* const pixels = &image(x, y + rows);
  prefetch_to_write(pixels);
  prefetch_to_write(pixels + std::min(double_lanes, tile.x1 - x) - 1);
  keep_calls();
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Pixels of the packets of a tile: which there are, and how their colors are written into an image.
#pragma once

#include <algorithm>
#include <cstddef>

#include "../image.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "packet.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

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

/// Writes the colors of a packet that begins at pixel (x, y), as far as its pixels are in the tile.
inline void write_packet(Image& image, const Tile& tile, int x, int y, const Colors& colors) {
  static_assert(sizeof(Color) == 3 * sizeof(float));
  Color* const pixels = &image(x, y);
  if (x + double_lanes <= tile.x1) return store_in_turn(pixels, colors.r, colors.g, colors.b);
  for (int i = 0; x + i < tile.x1; ++i) pixels[i] = {colors.r[i], colors.g[i], colors.b[i]};
}

/// Gives all pixels of a tile one color.
inline void fill_tile(Image& image, const Tile& tile, const Color& color) {
  const Color* const first = std::fill_n(&image(tile.x0, tile.y0), tile.width(), color) - tile.width();
  for (int y = tile.y0 + 1; y < tile.y1; ++y) std::copy_n(first, tile.width(), &image(tile.x0, y));
}

/// Returns the colors of the pixels of a packet, as far as they are in the tile.
[[nodiscard]] inline Colors colors_of(const Image& image, const Tile& tile, int x, int y) {
  Colors colors(Color{0});
  for (int i = 0; i < std::min(double_lanes, tile.x1 - x); ++i) colors.set(i, image(x + i, y));
  return colors;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

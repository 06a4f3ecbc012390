// Pixels of the packets of a tile: which there are, and how their colors are written into an image.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "../image.hpp"
#include "../simd/prefetch.hpp"
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

/// Writes the colors of a block of rays, given by lanes, as far as its pixels are in a tile: `block`.
[[gnu::always_inline]] inline void write_block(Image& image, const Tile& block, const WideFloats& r,
                                               const WideFloats& g, const WideFloats& b) {
  constexpr int width = RayBlock::width;
  using Row = Lanes<float, width>;
  float reds[float_lanes], greens[float_lanes], blues[float_lanes];
  r.store(reds), g.store(greens), b.store(blues);
  for (int y = block.y0, first = 0; y < block.y1; ++y, first += width) {
    Color* const pixels = &image(block.x0, y);
    if (block.width() == width)
      store_in_turn(pixels, Row::load(reds + first), Row::load(greens + first), Row::load(blues + first));
    else
      for (int i = 0; i < block.width(); ++i)
        pixels[i] = {reds[first + i], greens[first + i], blues[first + i]};
  }
}

/// Colors of a row of a block, one pixel after the other.
using RowOfColors = std::array<Color, RayBlock::width>;
[[gnu::always_inline]] inline void write_rows(Image& image, const Tile& block, const RowOfColors& colors) {
  for (int y = block.y0; y < block.y1; ++y)
    if (block.width() == RayBlock::width)
      std::memcpy(static_cast<void*>(&image(block.x0, y)), &colors, sizeof(colors));
    else
      std::copy_n(colors.begin(), block.width(), &image(block.x0, y));
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

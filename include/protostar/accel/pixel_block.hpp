// Blocks of a tile's pixels, in which triangles are rasterized.
#pragma once

#include <algorithm>
#include <cstddef>

#include "../simd/simd.hpp"
#include "screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// One number for each pixel of a block.
using Pixels = Lanes<float, float_lanes>;

/// Neighboring pixels, as many as a vector holds, in a rectangle: a small triangle covers few blocks.
struct PixelBlock {
  static constexpr int width = std::min(4, float_lanes), height = float_lanes / width;

  static constexpr int side = 64;  ///< largest width and height, in pixels, of a tile that can be rasterized
  static constexpr std::size_t in_tile = std::size_t{side / width} * (side / height);

  /// Returns the index of a tile's block that contains the pixel (x, y).
  static std::size_t index(int x, int y) {
    return static_cast<std::size_t>(side / width * (y / height) + x / width);
  }

  /// Returns each pixel's column in the block; down() returns its row.
  static Pixels across() {
    return Pixels::of_each([](int lane) { return static_cast<float>(lane % width); });
  }
  static Pixels down() {
    return Pixels::of_each([](int lane) { return static_cast<float>(lane / width); });
  }

  /// Returns the pixels of the block at (x, y) that are in a box. Precondition: it is one of those that
  /// all_of visits.
  static Bits inside(const BoxOnScreen& box, int x, int y) {
    return columns(box.x0 - x, box.x1 - x) & rows(box.y0 - y, box.y1 - y);
  }

  /// Returns true if visit(x, y) is true for all blocks of a box; stops at the first that is false.
  static bool all_of(const BoxOnScreen& box, const auto& visit) {
    for (int y = box.y0 / height * height; y < box.y1; y += height)
      for (int x = box.x0 / width * width; x < box.x1; x += width)
        if (!visit(x, y)) return false;
    return true;
  }

 private:
  /// Returns the pixels of the columns, or rows, in [from, to).
  static Bits columns(int from, int to) {
    constexpr Bits of_each_row = first_bits(float_lanes) / first_bits(width);
    return of_each_row * (first_bits(std::min(to, width)) & ~first_bits(std::max(from, 0)));
  }
  static Bits rows(int from, int to) {
    return first_bits(width * std::min(to, height)) & ~first_bits(width * std::max(from, 0));
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

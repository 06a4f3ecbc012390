// Which pixels of a tile meet any of many triangles, where nobody asks which, or where: neither order nor
// distance counts then, and two bits are enough for a pixel: whether it surely is covered, and whether it may
// be.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "pixel_block.hpp"
#include "triangles_in_front.hpp"
#include "triangles_on_screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// The pixels of a tile of at most PixelBlock::side a side.
class Coverage {
 public:
  /// The pixels of a row, beginning with the first. Those in doubt may be surely covered as well.
  struct Row {
    std::uint64_t surely = 0, in_doubt = 0;
  };
  [[nodiscard]] const Row& row(int y) const { return rows_[static_cast<std::size_t>(y)]; }

  void clear() { rows_.fill({}); }

  /// Whether all pixels of a box are surely covered.
  [[nodiscard]] bool hides(const BoxOnScreen& box) const {
    const std::uint64_t columns = ~std::uint64_t{0} >> (PixelBlock::side - (box.x1 - box.x0)) << box.x0;
    for (int y = box.y0; y < box.y1; ++y)
      if ((columns & ~row(y).surely) != 0) return false;
    return true;
  }

  /// Covers what the i-th of some triangles covers.
  void add(const TrianglesOnScreen& triangles, std::size_t i) {
    constexpr float e = TrianglesOnScreen::error_of_sides;
    const bool is_sure = (triangles.is_signed >> i & 1) != 0;  // and so in front of the eye
    triangles.each_block(i, [&](int x, int y, const Pixels& inside, auto&&) {
      add_block(x, y, is_sure ? bits(inside > Pixels(e)) : 0, bits(inside >= Pixels(-e)));
    });
  }

  /// Covers what some triangles cover.
  void add(const TrianglesInFront& triangles, Bits some) {
    const Bits small = some & triangles.are_small();
    triangles.each_small(small, [&](int x, int y, Bits surely, Bits maybe) {
      add_rows<TrianglesInFront::small, TrianglesInFront::small>(x, y, surely, maybe);
    });
    for (Bits large = some & ~small; large != 0; large &= large - 1)
      triangles.each_block(std::countr_zero(large),
                           [&](int x, int y, Bits surely, Bits maybe) { add_block(x, y, surely, maybe); });
  }

 private:
  void add_block(int x, int y, Bits surely, Bits maybe) {
    add_rows<PixelBlock::width, PixelBlock::height>(x, y, surely, maybe);
  }

  /// Adds pixels from (x, y) on to the right and down, row by row.
  template <int width, int height>
  void add_rows(int x, int y, Bits surely, Bits maybe) {
    const auto add = [&](std::uint64_t Row::*to, std::uint64_t pixels) {
      for (int row = 0; row < height; ++row, pixels >>= width)
        rows_[static_cast<std::size_t>(y + row)].*to |= (pixels & first_bits(width)) << x;
    };
    add(&Row::surely, surely);
    if (surely != maybe) add(&Row::in_doubt, maybe);  // for nearly all they are the same
  }

  static_assert(PixelBlock::side == 64);  // as many as a row has bits
  /// Rows of a block that begins in the last one.
  static constexpr int below = std::max(TrianglesInFront::small, PixelBlock::height) - 1;
  std::array<Row, PixelBlock::side + below> rows_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

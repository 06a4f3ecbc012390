// Pixels of a tile that any of many triangles covers, if it is not asked which, or at what distance. Order
// does not count then, and two bits are enough for a pixel: one if it surely is covered, one if it may be.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "pixel_block.hpp"
#include "triangles_in_front.hpp"
#include "triangles_on_screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Covered pixels of a tile of at most PixelBlock::side a side.
class Coverage {
 public:
  /// Pixels of a row, beginning with the first. Pixels in doubt may be surely covered as well.
  struct Row {
    std::uint64_t surely = 0, in_doubt = 0;
  };
  [[nodiscard]] Row row(int y) const {
    return {surely_[static_cast<std::size_t>(y)], in_doubt_[static_cast<std::size_t>(y)]};
  }

  void clear() { surely_.fill(0), in_doubt_.fill(0); }

  /// Returns true if all pixels of a box are surely covered.
  [[nodiscard]] bool hides(const BoxOnScreen& box) const {
    const std::uint64_t columns = ~std::uint64_t{0} >> (PixelBlock::side - (box.x1 - box.x0)) << box.x0;
    for (int y = box.y0; y < box.y1; ++y)
      if ((columns & ~surely_[static_cast<std::size_t>(y)]) != 0) return false;
    return true;
  }

  /// Rasterizes the i-th of `triangles`.
  void add(const TrianglesOnScreen& triangles, std::size_t i) {
    constexpr float e = TrianglesOnScreen::error_of_sides;
    const bool is_sure = (triangles.is_signed >> i & 1) != 0;  // hence in front of the eye
    triangles.each_block(i, [&](int x, int y, const Pixels& inside, auto&&) {
      add_block(x, y, is_sure ? bits(inside > Pixels(e)) : 0, bits(inside >= Pixels(-e)));
    });
  }

  /// Rasterizes the triangles with a bit in `some`.
  void add(const TrianglesInFront& triangles, Bits some) {
    using Covered = TrianglesInFront::Covered;
    const Covered block = triangles.small_in_one_block(some);
    if (block.maybe != 0) add_rows<Covered::side, Covered::side>(block.x, block.y, block.surely, block.maybe);
    for (Bits others = some & ~block.triangles; others != 0; others &= others - 1)
      triangles.each_block(std::countr_zero(others),
                           [&](int x, int y, Bits surely, Bits maybe) { add_block(x, y, surely, maybe); });
  }

 private:
  using Rows = std::array<std::uint64_t, PixelBlock::side + TrianglesInFront::Covered::side - 1>;

  void add_block(int x, int y, Bits surely, Bits maybe) {
    add_rows<PixelBlock::width, PixelBlock::height>(x, y, surely, maybe);
  }

  /// Adds pixels of a block from (x, y) on, row by row.
  template <int width, int height>
  void add_rows(int x, int y, std::uint64_t surely, std::uint64_t maybe) {
    const auto add = [&](Rows& rows, std::uint64_t pixels) {
      std::uint64_t* const first = &rows[static_cast<std::size_t>(y)];
      for (int row = 0; row < height; ++row, pixels >>= width)
        first[row] |= (pixels & first_bits(width)) << x;
    };
    add(surely_, surely);
    if (surely != maybe) add(in_doubt_, maybe);  // equal for nearly all
  }

  static_assert(PixelBlock::side == 64);  // bits of a row
  static_assert(PixelBlock::height <= TrianglesInFront::Covered::side);
  Rows surely_, in_doubt_;  ///< with room for blocks that begin in the last row
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

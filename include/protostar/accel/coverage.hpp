// Which pixels of a tile meet any of many triangles, where nobody asks which, or where: neither order nor
// distance counts then, and two bits are enough for a pixel: whether it surely is covered, and whether it may
// be.
#pragma once

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
  [[nodiscard]] Row row(int y) const {
    return {surely_[static_cast<std::size_t>(y)], in_doubt_[static_cast<std::size_t>(y)]};
  }

  void clear() { surely_.fill(0), in_doubt_.fill(0); }

  /// Whether all pixels of a box are surely covered.
  [[nodiscard]] bool hides(const BoxOnScreen& box) const {
    const std::uint64_t columns = ~std::uint64_t{0} >> (PixelBlock::side - (box.x1 - box.x0)) << box.x0;
    for (int y = box.y0; y < box.y1; ++y)
      if ((columns & ~surely_[static_cast<std::size_t>(y)]) != 0) return false;
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

  /// Adds pixels from (x, y) on to the right and down, row by row.
  template <int width, int height>
  void add_rows(int x, int y, std::uint64_t surely, std::uint64_t maybe) {
    const auto add = [&](Rows& rows, std::uint64_t pixels) {
      std::uint64_t* const first = &rows[static_cast<std::size_t>(y)];
      for (int row = 0; row < height; ++row, pixels >>= width)
        first[row] |= (pixels & first_bits(width)) << x;
    };
    add(surely_, surely);
    if (surely != maybe) add(in_doubt_, maybe);  // for nearly all they are the same
  }

  static_assert(PixelBlock::side == 64);  // as many as a row has bits
  static_assert(PixelBlock::height <= TrianglesInFront::Covered::side);
  Rows surely_, in_doubt_;  ///< with room for blocks that begin in the last row
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

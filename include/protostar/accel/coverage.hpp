// Which pixels of a tile meet any of many triangles, where nobody asks which, or where: neither order nor
// distance counts then, and two bits are enough for a pixel: whether it surely is covered, and whether it may
// be.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "triangles_on_screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// The pixels of a tile of at most PixelBlock::side a side.
class Coverage {
 public:
  void clear() { surely_.fill(0), maybe_.fill(0); }

  /// Whether all pixels of a box are surely covered.
  [[nodiscard]] bool hides(const BoxOnScreen& box) const {
    return PixelBlock::all_of(box, [&](int x, int y) {
      return (PixelBlock::inside(box, x, y) & ~Bits{surely_[PixelBlock::index(x, y)]}) == 0;
    });
  }

  /// Covers what the i-th of some triangles covers.
  void add(const TrianglesOnScreen& triangles, std::size_t i) {
    constexpr float e = TrianglesOnScreen::error_of_sides;
    const bool is_sure = (triangles.is_signed >> i & 1) != 0;  // and so in front of the eye
    triangles.each_block(i, [&](int x, int y, const Pixels& inside, auto&&) {
      add_to(surely_[PixelBlock::index(x, y)], is_sure ? bits(inside > Pixels(e)) : 0);
      add_to(maybe_[PixelBlock::index(x, y)], bits(inside >= Pixels(-e)));
    });
  }

  /// Once all are added: the pixels of a row, beginning with the first.
  struct Row {
    std::uint64_t surely = 0, in_doubt = 0;
  };
  [[nodiscard]] Row row(int y) const {
    Row row;
    for (int x = 0; x < PixelBlock::side; x += PixelBlock::width) {
      const auto of_block = [&](const Blocks& blocks) {
        return std::uint64_t{blocks[PixelBlock::index(x, y)] >> y % PixelBlock::height * PixelBlock::width &
                             first_bits(PixelBlock::width)}
               << x;
      };
      row.surely |= of_block(surely_), row.in_doubt |= of_block(maybe_);
    }
    row.in_doubt &= ~row.surely;
    return row;
  }

 private:
  using Blocks = std::array<std::uint16_t, PixelBlock::in_tile>;

  static void add_to(std::uint16_t& block, Bits some) { block = static_cast<std::uint16_t>(block | some); }

  Blocks surely_, maybe_;  ///< a bit of each pixel
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

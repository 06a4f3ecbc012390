// Triangles in front of the eye, and not far beside a tile: the pixels of the tile that they cover.
//
// In the coordinates of accel/screen.hpp, a corner is seen at (X/Z, Y/Z), and the sides of a triangle on the
// picture are the lines between its corners. Here positions are counted from the tile's first pixel, which is
// no more than T from its middle. Let Z > 0 and the positions within 7T of there, as they are computed. Then
// |X/Z| and |Y/Z| are at most 8T and, for p = X e1 + Y e2 + Z e3, |p|/Z < (1 + 2^-13) 8 longest, if
// γ · 8 longest < 2^-15; hence the true Z, which differs by less than γ|p|/T, is positive. Positions are off
// by less than (2γ + 7T γ/T) |p|/Z, as X and its offset to the first pixel, up to T times Z, are off by γ|p|
// each; and by their own roundings, which are a small part of γ|p|/Z:
//
//   E = 10 γ · 8 longest < 2^-11.6
//
// and less than 2^-11 as floats, as PixelsBetween requires.
//
// From here on in float, with u = 2^-24. Corners are counted from the triangle's own first pixel, from which
// they are no more than its size L, width plus height, and 1 pixel: they are off by less than E + (L + 1) u.
// Pixels are within R = L + 7 of corners, as the first and the last are no more than 2^-10 beyond the
// triangle, and the pixels of a block 3 more, in x and y; the rest is more than the error of L. Therefore
// side(p, q) = (q − p) × (pixel − p) is off by less than 4R (E + (L + 1) u); its coefficients, with products
// that sum up to L R, take 3u L R, the last being made of the first two as they are; and at most 6 sums,
// below 2 L R, take 12u L R. In all, that is less than R (4E + 19u (L + 1)), and with room for the rounding
// of the bound itself
//
//   error = R (4E + 32u (L + 1))
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "packet.hpp"
#include "pixel_block.hpp"
#include "screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Pixels that some triangles cover, as many triangles as a vector holds.
class TrianglesInFront {
 public:
  /// Map from corners to their positions, in pixels from the tile's first.
  struct Places {
    Point eye;
    Vec3 ahead, across, down;
    Doubles farthest;   ///< largest |x| and |y| of a known position; negative if none is
    int width, height;  ///< pixels of the tile
    float error;        ///< E

    explicit Places(const Screen& screen)
        : eye(screen.eye),
          ahead(screen.scale * screen.ahead),
          across(screen.scale * screen.across - screen.left * ahead),
          down(screen.scale * screen.down - screen.top * ahead),
          width(screen.width),
          height(screen.height) {
      const double off = screen.uncertainty * 8 * screen.longest;
      farthest = off < 0x1p-15 ? 7 * screen.reach : -1;
      error = static_cast<float>(10 * off);
    }

    struct Place {
      Doubles x, y;
      Chosen is_near;  ///< if false, the position is not known
    };
    [[nodiscard]] Place operator()(const Vectors& corner) const {
      const Vectors p = corner - Vectors(eye);
      const Doubles z = dot(p, Vectors(ahead)), k = 1 / z, x = k * dot(p, Vectors(across)),
                    y = k * dot(p, Vectors(down));
      return {x, y, z > 0x1p-900 && abs(x) <= farthest && abs(y) <= farthest};
    }
  };

  using Wholes = Lanes<std::int32_t, double_lanes>;

  /// A linear function of a pixel's position from the triangle's first pixel on.
  struct Side {
    Floats x, y, one;
  };

  Bits in_tile;           ///< triangles that may be in any pixel of the tile
  Bits known;             ///< near triangles whose orientation is sure; the members below are valid for these
  Wholes x0, x1, y0, y1;  ///< pixels of the tile: from, and to before
  Side sides[3];          ///< positive inside
  Floats error;           ///< error of the sides

  TrianglesInFront(const Places& places, const std::array<Vectors, 3>& corners) {
    const Places::Place a = places(corners[0]), b = places(corners[1]), c = places(corners[2]);
    const Chosen is_near = a.is_near && b.is_near && c.is_near;
    const Floats left = to_float(min(a.x, min(b.x, c.x))), right = to_float(max(a.x, max(b.x, c.x))),
                 top = to_float(min(a.y, min(b.y, c.y))), bottom = to_float(max(a.y, max(b.y, c.y)));
    const PixelsBetween<double_lanes> columns(left, right, places.width), rows(top, bottom, places.height);
    in_tile = bits(columns.any && rows.any) | bits(!is_near);
    x0 = columns.first, x1 = columns.end, y0 = rows.first, y1 = rows.end;

    struct Point2 {
      Floats x, y;
    };
    const auto from_first_pixel = [left_of_it = to_double(x0),
                                   above_it = to_double(y0)](const Places::Place& place) {
      return Point2{to_float(place.x - left_of_it), to_float(place.y - above_it)};
    };
    const Point2 p[] = {from_first_pixel(a), from_first_pixel(b), from_first_pixel(c)};
    const Floats size = (right - left) + (bottom - top);
    error = (size + Floats(7.0f)) * (Floats(4 * places.error) + Floats(0x1p-19f) * (size + Floats(1.0f)));
    const Floats area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    known = bits(is_near) & bits(abs(area) > error);  // a sum of products like a side
    const Floats turn = copysign(Floats(1.0f), area);
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 &from = p[k], &to = p[(k + 1) % 3];
      Side& side = sides[k];
      side.x = turn * (from.y - to.y), side.y = turn * (to.x - from.x);
      side.one = -(side.x * from.x) - side.y * from.y;
    }
  }

  /// Pixels of a block, row by row, that some triangles cover.
  struct Covered {
    static constexpr int side = 8;

    Bits triangles;
    int x, y;  ///< first pixel of the block
    std::uint64_t surely, maybe;
  };

  /// Rasterizes the triangles of `some` that are small, at most 4 × 4 pixels, and in one block, which begins
  /// at the least x0 and the least y0 of the small ones. All of `some` must be known, and in the tile.
  [[nodiscard]] Covered small_in_one_block(Bits some) const {
    constexpr int small = 4;
    const Wholes width = x1 - x0, height = y1 - y0;
    some &= bits(width <= Wholes(small) && height <= Wholes(small));
    if (some == 0) return {};
    // Pixel by pixel of all triangles, each from its first on. Pixels beyond a triangle to the right are left
    // out, since in the block they might be at the left of the next row; pixels below it stay in their
    // column.
    Wholes surely = 0, maybe = 0;
    std::array<Floats, 3> from{sides[0].one, sides[1].one, sides[2].one};
    for (int y = 0; (bits(height > Wholes(y)) & some) != 0; ++y) {
      std::array<Floats, 3> at = from;
      for (int x = 0;; ++x) {
        const auto is_there = mask_for<float>(width > Wholes(x));
        if ((bits(is_there) & some) == 0) break;
        const Floats inside = min(min(at[0], at[1]), at[2]);
        const Wholes pixel = std::int32_t{1} << (Covered::side * y + x);
        surely = select(is_there && inside > error, surely | pixel, surely);
        maybe = select(is_there && inside >= -error, maybe | pixel, maybe);
        for (std::size_t k = 0; k < 3; ++k) at[k] += sides[k].x;
      }
      for (std::size_t k = 0; k < 3; ++k) from[k] += sides[k].y;
    }
    const auto first = [of_some = mask_of<std::int32_t, double_lanes>(some)](const Wholes& pixels) {
      return smallest(select(of_some, pixels, PixelBlock::side));
    };
    const int x = first(x0), y = first(y0);
    some &= bits(x1 <= Wholes(x + Covered::side) && y1 <= Wholes(y + Covered::side));
    const auto chosen = mask_of<double, double_lanes>(some);
    const auto place =
        select(chosen, widened(Wholes(Covered::side) * (y0 - Wholes(y)) + (x0 - Wholes(x))), 0);
    const auto of_all = [&](const Wholes& pixels) {
      return static_cast<std::uint64_t>(bits_of_any(select(chosen, widened(pixels) << place, 0)));
    };
    return {some, x, y, of_all(surely), of_all(maybe)};
  }

  /// Calls visit(x, y, surely, maybe) for the blocks of the i-th triangle, with the pixels in the order of
  /// PixelBlock.
  void each_block(int i, const auto& visit) const {
    const auto inside_block = [&](const Side& side) {
      return Pixels(side.x[i]) * PixelBlock::across() + Pixels(side.y[i]) * PixelBlock::down();
    };
    const Pixels in_block[3] = {inside_block(sides[0]), inside_block(sides[1]), inside_block(sides[2])};
    const Pixels e = error[i];
    const int width = x1[i] - x0[i], height = y1[i] - y0[i];
    for (int y = 0; y < height; y += PixelBlock::height)
      for (int x = 0; x < width; x += PixelBlock::width) {
        const auto at = [&](std::size_t k) {
          const Side& side = sides[k];
          return in_block[k] + Pixels(side.x[i] * static_cast<float>(x) +
                                      (side.y[i] * static_cast<float>(y) + side.one[i]));
        };
        const Pixels inside = min(min(at(0), at(1)), at(2));
        visit(x0[i] + x, y0[i] + y, bits(inside > e), bits(inside >= -e));
      }
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

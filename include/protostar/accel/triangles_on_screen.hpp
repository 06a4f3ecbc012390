// Triangles on the picture around a tile: the pixels that may see them, the sides of their edges, and their
// nearness.
//
// In the coordinates of accel/screen.hpp, for a triangle a, b, c
//
//   side(p, q) = (X_p − x Z_p) (Y_q − y Z_q) − (Y_p − y Z_p) (X_q − x Z_q)
//
// tells on which side D(x, y) passes an edge (numeric/planar_equation.hpp, up to a factor that is the same
// for all), and the ray crosses the plane at o + D/k with k = (side(a, b) + side(b, c) + side(c, a)) / det(a,
// b, c): the larger k, the nearer. Sides and k are linear in x and y; pixels are tested against these
// functions in float. With L = |X| + |Y| + T |Z|, the errors in double are less than
//
//   w = 8γ (|p| L_q + |q| L_p)                                for a side
//   e = 12γ (|a| L_b L_c + L_a |b| L_c + L_a L_b |c|) / T     for det, a sum of products
//
// Roundings in computing the functions themselves are a small part of these, as L ≤ 2^42 γ|p|. Sides are
// divided by their largest size M in the tile and, if e < |det|/2, by the sign of det, which makes all
// positive inside.
//
// In float, with u = 2^-24, a pixel is given by the first of its block, which is in the tile, and up to 2T
// from there: the terms of a side sum up to no more than 3, at the first of the block to no more than 1.
// Rounding takes 3u for coefficients, 2u for x and y, 4u and 3u for the products and sums of the two parts
// and 1u for the last sum: 13u, and if w ≤ 2^-23 M, less than 2^-20 in all. An edge with a larger w is left
// out, as if it was passed on either side. If e < |det|/2, k is off by less than 2 (Σw + K e) / |det| plus
// 2^-20 K, K being its largest size in the tile; if not, or beyond the range of float, nothing is known of k.
// If all vertices are surely in front, Z > 2^12 γ|p|, their positions are good to 2^-11 of a pixel; the
// triangle is in no pixel beyond these, and k is between the least and the largest 1/Z, which are good to
// 2^-11 of themselves.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "packet.hpp"
#include "pixel_block.hpp"
#include "screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Some triangles, in the form against which pixels are tested.
class TrianglesOnScreen {
 public:
  /// Error of the sides: a pixel is surely inside a triangle if it is inside by more than this, and surely
  /// outside if by less than the negative of it.
  static constexpr float error_of_sides = 0x1p-20f;

  Bits in_tile;    ///< triangles that may be in any pixel of the tile
  Bits is_signed;  ///< triangles whose sides are positive inside, where k > 0; signs of others are not known

  /// Prepares some triangles for a tile.
  TrianglesOnScreen(const Screen& screen, const std::array<Vectors, 3>& corners)
      : left_(static_cast<float>(screen.left)), top_(static_cast<float>(screen.top)) {
    const auto corner = [&](const Vectors& p) {
      return Corner(screen, Doubles(screen.scale) * (p - Vectors(screen.eye)));
    };
    const Corner a = corner(corners[0]), b = corner(corners[1]), c = corner(corners[2]);
    const double gamma = screen.uncertainty, T = screen.reach;
    const auto line = [](const Corner& p, const Corner& q) {
      return Linear{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
    };
    const Linear ab = line(a, b), bc = line(b, c), ca = line(c, a);
    const Doubles det = bc.x * a.x + bc.y * a.y + bc.one * a.z;
    const Doubles e =
        12 * gamma / T *
        (a.size * b.extent * c.extent + a.extent * b.size * c.extent + a.extent * b.extent * c.size);
    const LaneMask faces = e < 0.5 * abs(det) && abs(det) > 0x1p-900;
    const Doubles turn = select(faces, det, 1.0);
    is_signed = bits(faces);
    const LaneMask in_front = a.is_in_front && b.is_in_front && c.is_in_front;
    Doubles off = 0.0;
    const auto turned = [&](const Linear& s, const Corner& p, const Corner& q) {
      const Doubles w = 8 * gamma * (p.size * q.extent + q.size * p.extent), M = s.most(T);
      off = off + w;
      const LaneMask known = w <= 0x1p-23 * M && M > 0x1p-900;
      return select(known, copysign(1 / M, turn), Doubles(0.0)) * s;
    };
    edge_[0] = turned(ab, a, b), edge_[1] = turned(bc, b, c), edge_[2] = turned(ca, c, a);

    const Doubles za = 1 / a.z, zb = 1 / b.z, zc = 1 / c.z;
    const Doubles of_det = 1 / det;
    const Linear nearness_at = of_det * (ab + bc + ca);
    const Doubles K = nearness_at.most(T), uncertain = 2 * (off + K * e) * abs(of_det) + 0x1p-20 * K;
    const LaneMask known = faces && uncertain < 0x1p60 && K < 0x1p60 && K > 0x1p-60;
    nearness_ = Linear{select(known, nearness_at.x, 0.0), select(known, nearness_at.y, 0.0),
                       select(known, nearness_at.one, 0.0)};
    to_float(select(known, uncertain, Doubles(infinity))).store(error_.data());
    const Doubles farthest = min(za, min(zb, zc)), nearest = max(za, max(zb, zc));
    to_float(select(in_front, min((1 - 0x1p-11) * farthest, 0x1p100), 0.0)).store(least_.data());
    to_float(select(in_front && nearest < 0x1p100, (1 + 0x1p-11) * nearest, infinity)).store(most_.data());

    const auto pixels = [&](Doubles u, Doubles v, Doubles w, double start, int count) {
      return PixelsBetween<double_lanes>(to_float(select(in_front, min(u, min(v, w)) - start, 0.0)),
                                         to_float(select(in_front, max(u, max(v, w)) - start, count)), count);
    };
    const auto x = pixels(a.x * za, b.x * zb, c.x * zc, screen.left, screen.width),
               y = pixels(a.y * za, b.y * zb, c.y * zc, screen.top, screen.height);
    in_tile = bits(x.any && y.any);
    x.first.store(x0_.data()), x.end.store(x1_.data()), y.first.store(y0_.data()), y.end.store(y1_.data());
  }

  /// Lower and upper bounds of k at which the pixels of a block cross a plane.
  struct Nearness {
    Pixels least, most;
  };

  /// Calls visit(x, y, inside, nearness) for the blocks of pixels that the i-th triangle may be in: `inside`
  /// is how far each pixel of the block at (x, y) is inside, give or take error_of_sides, and nearness()
  /// returns the bounds of k.
  [[gnu::always_inline]] void each_block(std::size_t i, const auto& visit) const {
    const auto inside_block = [&](const LinearInFloat& f) {
      return Pixels(f.x[i]) * PixelBlock::across() + Pixels(f.y[i]) * PixelBlock::down();
    };
    const Pixels ab = inside_block(edge_[0]), bc = inside_block(edge_[1]), ca = inside_block(edge_[2]),
                 k = inside_block(nearness_);
    const int x0 = x0_[i] / PixelBlock::width * PixelBlock::width,
              y0 = y0_[i] / PixelBlock::height * PixelBlock::height;
    const int x1 = x1_[i], y1 = y1_[i];
    const bool has_sign = (is_signed >> i & 1) != 0;
    // One loop, since the number of blocks is hard to predict.
    for (int x = x0, y = y0; y < y1;) {
      const float across = left_ + static_cast<float>(x), down = top_ + static_cast<float>(y);
      const auto at = [&](const LinearInFloat& f) {
        return Pixels(f.x[i] * across + (f.y[i] * down + f.one[i]));
      };
      const Pixels of_ab = ab + at(edge_[0]), of_bc = bc + at(edge_[1]), of_ca = ca + at(edge_[2]);
      Pixels inside = min(min(of_ab, of_bc), of_ca);
      if (!has_sign)  // inside if all are positive or all negative
        inside = max(inside, min(min(-of_ab, -of_bc), -of_ca));
      visit(x, y, inside, [&] {
        const Pixels nearness = k + at(nearness_), error = error_[i];
        return Nearness{max(nearness - error, Pixels(least_[i])), min(nearness + error, Pixels(most_[i]))};
      });
      const bool is_last = x + PixelBlock::width >= x1;
      x = is_last ? x0 : x + PixelBlock::width;
      y += is_last ? PixelBlock::height : 0;
    }
  }

 private:
  /// A linear function of x and y.
  struct Linear {
    Doubles x, y, one;

    friend Linear operator+(const Linear& a, const Linear& b) {
      return {a.x + b.x, a.y + b.y, a.one + b.one};
    }
    friend Linear operator*(Doubles f, const Linear& a) { return {f * a.x, f * a.y, f * a.one}; }
    /// Returns its largest size in a tile.
    [[nodiscard]] Doubles most(double reach) const { return reach * (abs(x) + abs(y)) + abs(one); }
  };
  struct LinearInFloat {
    std::array<float, double_lanes> x, y, one;

    LinearInFloat() = default;
    LinearInFloat(const Linear& a) {
      to_float(a.x).store(x.data()), to_float(a.y).store(y.data()), to_float(a.one).store(one.data());
    }
  };

  /// Points on the screen, given in box space from the eye.
  struct Corner {
    Doubles x, y, z, size, extent;  ///< X, Y, Z, |p| and L
    LaneMask is_in_front;           ///< surely

    Corner(const Screen& screen, const Vectors& p)
        : x(dot(p, Vectors(screen.across))),
          y(dot(p, Vectors(screen.down))),
          z(dot(p, Vectors(screen.ahead))),
          size(abs(p.x) + abs(p.y) + abs(p.z)),
          extent(abs(x) + abs(y) + screen.reach * abs(z)),
          is_in_front(z > 0x1p12 * screen.uncertainty * size && z > 0x1p-900) {}
  };

  LinearInFloat edge_[3], nearness_{};
  std::array<float, double_lanes> error_, least_, most_;      ///< error of k, and its range
  std::array<std::int32_t, double_lanes> x0_, x1_, y0_, y1_;  ///< pixels of the tile: from, and to before
  float left_, top_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

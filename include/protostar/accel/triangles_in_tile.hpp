// What the pixels of a tile see first of many triangles: these are drawn into the tile, and each pixel keeps
// the nearest.
//
// The rays of a pinhole at o lead along D(x, y) = x e1 + y e2 + e3, x and y being pixels from the tile's
// middle and e3 the direction there. By the dual basis e1*, e2*, e3* a vertex, from o, has the coordinates
// (X, Y, Z), and is seen at (X/Z, Y/Z). Of a triangle a, b, c
//
//   side(p, q) = (X_p − x Z_p) (Y_q − y Z_q) − (Y_p − y Z_p) (X_q − x Z_q)
//
// tells on which side of an edge D leads past (numeric/triangle_roots.hpp, but for a factor that is the same
// for all), and the plane is met at o + D/k with k = (side(a, b) + side(b, c) + side(c, a)) / det(a, b, c):
// the larger k, the nearer. Sides and k are linear in x and y: that is what pixels are tried against, in
// float.
//
// What is worked out for a triangle is in double. The volume of e1, e2, e3, as unit vectors, is above 1/16,
// so that their roundings, those of the dual basis, and those of the rays' directions are below 2^-42 of the
// products of lengths. Let γ be 2^-42 (|e1*| + |e2*| + T |e3*|), the tile being in |x|, |y| ≤ T. Then X, Y
// and T Z of a vertex p are off by less than γ|p|. With L = |X| + |Y| + T |Z|,
//
//   a side is off by less than               w = 8γ (|p| L_q + |q| L_p)
//   det, which is a sum of products, T times  e = 12γ (|a| L_b L_c + L_a |b| L_c + L_a L_b |c|)
//
// of which their own roundings are a small part, as L ≤ 2^42 γ|p|. Sides are divided by their largest size M
// in the tile. In float they are off by 2^-24 for coefficients, x and y, products and twice for sums: 6 of
// 2^-24, and if w ≤ 2^-22 M, by less than 2^-20 in all. An edge with a larger w is left out, as if it was
// passed on either side. If e < |det|/2, k is off by less than 2 (Σw + K e) / |det| and 2^-20 K, K being its
// largest size in the tile; if not, or beyond what float holds, nothing is known of it. Where all vertices
// are surely in front, Z > 2^12 γ|p|, their places are good to 2^-11 of a pixel; the triangle is in no pixel
// beyond these, and k is between the least and the largest 1/Z, which are good to 2^-11 of themselves.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "packet.hpp"
#include "tile.hpp"
#include "triangle_tree.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// The picture of a pinhole around a tile: what turns points, in box space, into X, Y and Z.
struct Screen {
  bool usable = false;
  Point eye{0}, eye_in_box_space{0};
  double scale = 1;           ///< of box space
  Vec3 across, down, ahead;   ///< the dual basis
  double reach, uncertainty;  ///< T and γ
  double longest;             ///< no direction is longer
  double left, top;           ///< x and y of the sample in the tile's first pixel
  double pixels_of_all;       ///< about as many take all triangles, or a ball of radius √3 in box space

  Screen(const PixelRays& rays, int sample, const Tile& tile, const BoxSpace& space)
      : eye(rays.camera().position), eye_in_box_space(space(eye)), scale(space.scale) {
    const auto& [x0, y0, x1, y1] = tile;
    const PixelGrid& pixels = rays.pixels();
    const Camera& camera = rays.camera();
    const double half_width = 0.5 * tile.width(), half_height = 0.5 * tile.height();
    const Vec3 e1 = (pixels.u(x1, 0) - pixels.u(x0, 0)) / tile.width() * camera.right,
               e2 = (pixels.v(y1, 0) - pixels.v(y0, 0)) / tile.height() * camera.up,
               e3 = pixels.u(x0, half_width) * camera.right + pixels.v(y0, half_height) * camera.up +
                    camera.forward;
    const double sizes = length(e1) * length(e2) * length(e3), volume = dot(cross(e1, e2), e3);
    const auto is_moderate = [](double x) { return 0x1p-100 < x && x < 0x1p100; };
    // What e3 is made of is not much larger, so that its rounding is that of its length.
    const double parts = length(pixels.u(x0, half_width) * camera.right) +
                         length(pixels.v(y0, half_height) * camera.up) + length(camera.forward);
    usable = rays.is_pinhole() && parts < 0x1p5 * length(e3) && is_moderate(length(e1)) &&
             is_moderate(length(e2)) && is_moderate(length(e3)) && std::abs(volume) > 0x1p-4 * sizes &&
             length(eye_in_box_space) < 0x1p40 && 0x1p-500 < scale && scale < 0x1p500;
    across = cross(e2, e3) / volume, down = cross(e3, e1) / volume, ahead = cross(e1, e2) / volume;
    reach = std::max(half_width, half_height);
    longest = length(e3) + reach * (length(e1) + length(e2));
    uncertainty = 0x1p-42 * (length(across) + length(down) + reach * length(ahead));
    pixels_of_all = std::numbers::pi * 3 / dot(eye_in_box_space, eye_in_box_space) * dot(e3, e3) /
                    (length(e1) * length(e2));
    left = pixels.sample(sample).x - half_width, top = pixels.sample(sample).y - half_height;
  }
};

/// What the pixels of a tile see first of the triangles of a tree.
class TrianglesInTile {
 public:
  /// Draws a tile of at most 64 × 64 pixels, as the rays through a sample of each see it. If that is not
  /// possible, or triangles are so small that rays are sooner followed, nothing is drawn: that is known
  /// before for all of them, or while it is tried, for those of this tile.
  void draw(const TriangleTree& tree, const PixelRays& rays, int sample, const Frustum& frustum,
            const Tile& tile) {
    tree_ = &tree;
    tile_ = tile;
    const Screen screen(rays, sample, tile, tree.space());
    usable_ = screen.usable && tree.has_all() && tile.width() <= side && tile.height() <= side &&
              static_cast<double>(tree.size()) <= most_a_pixel * screen.pixels_of_all;
    if (!usable_) return;
    far_.fill(0), near_.fill(0), other_.fill(0), nearest_.fill(0), drawn_.clear();
    int left = most_tried_a_pixel * tile.width() * tile.height();  // boxes and triangles
    tree.each_leaf_ahead(
        frustum.side, screen.ahead, [&](const Bounds& box) { return --left < 0 || is_hidden(screen, box); },
        [&](Leaf leaf) {
          left -= static_cast<int>(leaf.count);
          for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
            const auto corners = tree.leaves().corners(leaf, i);
            const Shapes shapes(screen, corners, tile);
            const Planes planes(screen, corners);
            for (std::uint32_t k = 0; k < double_lanes && i + k < leaf.count; ++k)
              if (draw_one(shapes, planes.floor[k], k, static_cast<std::int32_t>(drawn_.size())))
                drawn_.push_back(planes.plane(k, TriangleLeaves::place(leaf, i + k)));
          }
        });
    usable_ = left >= 0;
  }

  [[nodiscard]] bool is_drawn() const { return usable_; }

  /// What the rays of a packet, from a pixel on to the right, surely see first: which triangle, for t() and
  /// part(). Where it is no more than possible that they see any, they are in doubt.
  struct Seen {
    Chosen met, in_doubt;
    Indices which = -1;
  };
  [[nodiscard, gnu::always_inline]] Seen seen(const Chosen& wanted, int x, int y) const {
    const std::size_t at = index(x - tile_.x0, y - tile_.y0);
    const Floats far = Floats::load(&far_[at]), other = Floats::load(&other_[at]);
    const Chosen met = wanted && mask_for<double>(other < far);
    return {.met = met,
            .in_doubt = wanted && mask_for<double>(far <= other && other > Floats(0.0f)),
            .which = Indices::of_each(
                [&](int lane) { return std::int64_t{nearest_[at + static_cast<std::size_t>(lane)]}; })};
  }

  /// Where some rays cross what they see.
  [[nodiscard, gnu::always_inline]] Doubles t(const Indices& which, const Chosen& met,
                                              const Vectors& d) const {
    // Where there is none it is any other.
    const auto any_lane = std::countr_zero(bits(met)) % double_lanes;
    std::array<const Plane*, double_lanes> planes;
    for (int lane = 0; lane < double_lanes; ++lane)
      planes[static_cast<std::size_t>(lane)] =
          &drawn_[static_cast<std::size_t>(which[(bits(met) >> lane & 1) != 0 ? lane : any_lane])];
    const auto numbers = [&](double Plane::*number) {
      return Doubles::of_each([&](int lane) { return planes[static_cast<std::size_t>(lane)]->*number; });
    };
    return numbers(&Plane::height) /
           dot(Vectors{numbers(&Plane::x), numbers(&Plane::y), numbers(&Plane::z)}, d);
  }

  /// The number of a triangle that is seen.
  [[nodiscard]] int part(std::int64_t which) const {
    return static_cast<int>(tree_->leaves().number(drawn_[static_cast<std::size_t>(which)].place));
  }

 private:
  /// With so many triangles a pixel, or so many boxes and triangles that are tried, they are about as soon
  /// drawn as rays are followed (the pictures of tests/bench/bench_meshes.cpp).
  static constexpr int most_a_pixel = 8, most_tried_a_pixel = 32;

  using Row = Lanes<float, float_lanes>;
  static constexpr float infinite = std::numeric_limits<float>::infinity();

  using Place = TriangleLeaves::Place;

  /// What t of a ray from the eye to a triangle is worked out from: height / n·d.
  struct Plane {
    double x, y, z, height;
    Place place;
  };

  /// Of some triangles. In the way and with the bounds of rounded_triangle_equation, t is certain where
  /// |n·d| > 2^-18 of the sizes of its terms, which sum up to no more than the largest of those of n times
  /// |d|₁, d being a unit vector: 2^-17 of that largest covers √3 and what is rounded here. As the plane is
  /// met at o + D/k in box space, n·D is height · k · scale, and |D| at most `longest`.
  struct Planes {
    std::array<double, double_lanes> x, y, z, height;
    std::array<float, double_lanes> floor;  ///< above this k, t is certain

    Planes(const Screen& screen, const std::array<Vectors, 3>& corners) {
      const auto& [a, b, c] = corners;
      const auto sum_of_sizes = [](const Vectors& v) { return abs(v.x) + abs(v.y) + abs(v.z); };
      const Vectors u = b - a, v = c - a, w = a - Vectors(screen.eye), n = cross(u, v), p = abs(u),
                    q = abs(v), terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
      const Doubles U = sum_of_sizes(u), V = sum_of_sizes(v), W = sum_of_sizes(w), height_of = dot(n, w),
                    heights = dot(terms, abs(w));
      const Chosen known = U > 0x1p-200 && U < 0x1p200 && V > 0x1p-200 && V < 0x1p200 && W < 0x1p200 &&
                           abs(height_of) > 0x1p-18 * heights && heights > 0x1p-800;
      const Doubles least = max(0x1p-17 * max(terms.x, max(terms.y, terms.z)), 0x1p-500);
      n.x.store(x.data()), n.y.store(y.data()), n.z.store(z.data()), height_of.store(height.data());
      const Doubles floor_of = least * (screen.longest / screen.scale) / abs(height_of);
      to_float(select(known && floor_of < 0x1p100, floor_of, Doubles(infinity))).store(floor.data());
    }

    [[nodiscard]] Plane plane(std::size_t k, Place place) const {
      return {x[k], y[k], z[k], height[k], place};
    }
  };

  /// A linear function of x and y.
  struct Linear {
    Doubles x, y, one;

    friend Linear operator+(const Linear& a, const Linear& b) {
      return {a.x + b.x, a.y + b.y, a.one + b.one};
    }
    friend Linear operator*(Doubles f, const Linear& a) { return {f * a.x, f * a.y, f * a.one}; }
    /// Its largest size in a tile.
    [[nodiscard]] Doubles most(double reach) const { return reach * (abs(x) + abs(y)) + abs(one); }
  };
  struct LinearInFloat {
    std::array<float, double_lanes> x, y, one;

    LinearInFloat() = default;
    LinearInFloat(const Linear& a) {
      to_float(a.x).store(x.data()), to_float(a.y).store(y.data()), to_float(a.one).store(one.data());
    }
  };

  /// Some points on the screen, given where they are in box space, from the eye.
  struct Corner {
    Doubles x, y, z, size, extent;  ///< X, Y, Z, |p| and L
    Chosen is_in_front;             ///< for sure

    Corner(const Screen& screen, const Vectors& p)
        : x(dot(p, Vectors(screen.across))),
          y(dot(p, Vectors(screen.down))),
          z(dot(p, Vectors(screen.ahead))),
          size(abs(p.x) + abs(p.y) + abs(p.z)),
          extent(abs(x) + abs(y) + screen.reach * abs(z)),
          is_in_front(z > 0x1p12 * screen.uncertainty * size) {}
  };

  /// Some triangles, as pixels are tried against them.
  struct Shapes {
    LinearInFloat side[3], nearness;
    std::array<float, double_lanes> error, least, most;  ///< of k: how far it may be off, and its range
    std::array<int, double_lanes> x0, x1, y0, y1;        ///< the pixels of the tile from, and to before

    Shapes(const Screen& screen, const std::array<Vectors, 3>& corners, const Tile& tile) {
      const auto corner = [&](const Vectors& p) {
        return Corner(screen, Doubles(screen.scale) * (p - Vectors(screen.eye)));
      };
      const Corner a = corner(corners[0]), b = corner(corners[1]), c = corner(corners[2]);
      const double gamma = screen.uncertainty, T = screen.reach;
      Doubles off = 0.0;
      int edge = 0;
      const auto line = [&](const Corner& p, const Corner& q) {
        const Linear s{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
        const Doubles w = 8 * gamma * (p.size * q.extent + q.size * p.extent), M = s.most(T);
        off = off + w;
        side[edge++] = select(w <= 0x1p-22 * M && M > 0x1p-900, 1 / M, Doubles(0.0)) * s;
        return s;
      };
      const Linear ab = line(a, b), bc = line(b, c), ca = line(c, a);
      const Doubles det = bc.x * a.x + bc.y * a.y + bc.one * a.z;
      const Doubles e =
          12 * gamma / T *
          (a.size * b.extent * c.extent + a.extent * b.size * c.extent + a.extent * b.extent * c.size);
      const Linear nearness_at = (1 / det) * (ab + bc + ca);
      const Doubles K = nearness_at.most(T), uncertain = 2 * (off + K * e) / abs(det) + 0x1p-20 * K;
      const Chosen known = e < 0.5 * abs(det) && uncertain < 0x1p60 && K < 0x1p60 && K > 0x1p-60;
      nearness = Linear{select(known, nearness_at.x, 0.0), select(known, nearness_at.y, 0.0),
                        select(known, nearness_at.one, 0.0)};
      to_float(select(known, uncertain, Doubles(infinity))).store(error.data());

      const Chosen in_front = a.is_in_front && b.is_in_front && c.is_in_front;
      const Doubles za = 1 / a.z, zb = 1 / b.z, zc = 1 / c.z;
      const Doubles farthest = min(za, min(zb, zc)), nearest = max(za, max(zb, zc));
      to_float(select(in_front, min((1 - 0x1p-11) * farthest, 0x1p100), 0.0)).store(least.data());
      to_float(select(in_front && nearest < 0x1p100, (1 + 0x1p-11) * nearest, infinity)).store(most.data());

      // Pixels whose middles are from low to high.
      const auto pixels = [&](Doubles u, Doubles v, Doubles w, double start, int size, auto& first,
                              auto& end) {
        const double count = size;
        const Doubles low = min(u, min(v, w)) - start - 0x1p-10, high = max(u, max(v, w)) - start + 0x1p-10;
        const auto in_tile = [&](Doubles x) {  // a number, whatever x is
          return max(Doubles(0.0), min(Doubles(count), x));
        };
        std::array<double, double_lanes> from, to;
        select(in_front, in_tile(low), 0.0).store(from.data());
        select(in_front, in_tile(high + 1), count).store(to.data());
        for (std::size_t k = 0; k < from.size(); ++k) {
          const int whole = static_cast<int>(from[k]);
          first[k] = whole + (whole < from[k] ? 1 : 0);
          end[k] = static_cast<int>(to[k]);
        }
      };
      pixels(a.x * za, b.x * zb, c.x * zc, screen.left, tile.width(), x0, x1);
      pixels(a.y * za, b.y * zb, c.y * zc, screen.top, tile.height(), y0, y1);
      left = static_cast<float>(screen.left), top = static_cast<float>(screen.top);
    }

    float left, top;
  };

  [[nodiscard]] static std::size_t index(int x, int y) { return static_cast<std::size_t>(side * y + x); }

  /// Whether no pixel can see anything in a box of box space, given what they see already.
  [[nodiscard]] bool is_hidden(const Screen& screen, const Bounds& box) const {
    const Point from = box.min - screen.eye_in_box_space, to = box.max - screen.eye_in_box_space;
    Doubles nearest = infinity, left = infinity, right = -infinity, top = infinity, bottom = -infinity;
    for (int first = 0; first < 8; first += double_lanes) {
      const auto numbers = [&](int axis) {
        return Doubles::of_each([&](int lane) { return (first + lane) >> axis & 1 ? to[axis] : from[axis]; });
      };
      const Vectors corner{numbers(0), numbers(1), numbers(2)};
      const Corner p(screen, corner);
      if (any(!p.is_in_front)) return false;
      const Doubles x = p.x / p.z, y = p.y / p.z;
      nearest = min(nearest, p.z);
      left = min(left, x), right = max(right, x);
      top = min(top, y), bottom = max(bottom, y);
    }
    const auto first = [](double place, double start) {
      return static_cast<int>(std::ceil(std::clamp<double>(place - start - 0x1p-10, 0, side)));
    };
    const auto end = [](double place, double start, int count) {
      return static_cast<int>(std::clamp(place - start + 0x1p-10 + 1, 0.0, static_cast<double>(count)));
    };
    const double most = (1 + 0x1p-11) / -largest(-nearest);
    if (!(most < 0x1p100)) return false;
    const Row limit = static_cast<float>((1 + 0x1p-20) * most);
    const int x0 = first(-largest(-left), screen.left), x1 = end(largest(right), screen.left, tile_.width());
    const int y1 = end(largest(bottom), screen.top, tile_.height());
    for (int y = first(-largest(-top), screen.top); y < y1; ++y)
      for (int x = x0; x < x1; x += float_lanes)
        if ((bits(Row::load(&far_[index(x, y)]) <= limit) & first_bits(x1 - x)) != 0) return false;
    return true;
  }

  /// Of each pixel, what may be seen of the triangles so far: one that surely is in front of all but those
  /// that may be as near as `other`.
  bool draw_one(const Shapes& shapes, float floor, std::size_t i, std::int32_t which) {
    constexpr float e = 0x1p-20f;
    const Row error = shapes.error[i], least = shapes.least[i], most = shapes.most[i];
    // Vectors begin at multiples of their size: what was just stored can be loaded at once.
    Bits has = 0;
    const int x0 = shapes.x0[i] / float_lanes * float_lanes, x1 = shapes.x1[i];
    for (int y = shapes.y0[i]; y < shapes.y1[i]; ++y) {
      const float down = shapes.top + static_cast<float>(y);
      for (int x = x0; x < x1; x += float_lanes) {
        const Row across = iota<float, float_lanes>() + Row(shapes.left + static_cast<float>(x));
        const auto at_pixels = [&](const LinearInFloat& f) {
          return Row(f.x[i]) * across + Row(f.y[i] * down + f.one[i]);
        };
        const Row ab = at_pixels(shapes.side[0]), bc = at_pixels(shapes.side[1]),
                  ca = at_pixels(shapes.side[2]), nearness = at_pixels(shapes.nearness);
        const Row largest = max(max(ab, bc), ca), smallest = min(min(ab, bc), ca);
        const Row near = min(nearness + error, most), far = max(nearness - error, least);
        const std::size_t at = index(x, y);
        const Row known = Row::load(&far_[at]), before = Row::load(&near_[at]);
        const auto seen = !(largest > Row(e) && smallest < Row(-e)) && near >= known && near > Row(0.0f);
        const auto surely = seen && (smallest > Row(e) || largest < Row(-e)) && far > max(known, floor);
        has |= bits(surely);
        max(Row::load(&other_[at]), select(surely, before, select(seen, near, 0.0f))).store(&other_[at]);
        select(surely, far, known).store(&far_[at]);
        select(surely, near, before).store(&near_[at]);
        using Whole = Lanes<std::int32_t, float_lanes>;
        select(surely, Whole(which), Whole::load(&nearest_[at])).store(&nearest_[at]);
      }
    }
    return has != 0;
  }

  static constexpr int side = 64;
  template <class T>
  using OfPixels = std::array<T, side * side + float_lanes>;  // room for what a vector reads behind the last

  const TriangleTree* tree_ = nullptr;
  Tile tile_{};
  bool usable_ = false;
  alignas(64) OfPixels<float> far_, near_;  ///< between which k of the nearest is; 0 where there is none
  alignas(64) OfPixels<float> other_;       ///< the largest k that any other may have
  alignas(64) OfPixels<std::int32_t> nearest_;
  std::vector<Plane> drawn_;  ///< what nearest_ counts
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

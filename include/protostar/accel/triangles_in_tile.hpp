// What the pixels of a tile see first of many triangles: these are drawn into the tile, and each pixel keeps
// the nearest.
//
// In the coordinates of accel/screen.hpp, of a triangle a, b, c
//
//   side(p, q) = (X_p − x Z_p) (Y_q − y Z_q) − (Y_p − y Z_p) (X_q − x Z_q)
//
// tells on which side of an edge D(x, y) leads past (numeric/triangle_roots.hpp, but for a factor that is the
// same for all), and the plane is met at o + D/k with k = (side(a, b) + side(b, c) + side(c, a)) / det(a, b,
// c): the larger k, the nearer. Sides and k are linear in x and y: that is what pixels are tried against, in
// float. With L = |X| + |Y| + T |Z|, in double
//
//   a side is off by less than               w = 8γ (|p| L_q + |q| L_p)
//   det, which is a sum of products, T times  e = 12γ (|a| L_b L_c + L_a |b| L_c + L_a L_b |c|)
//
// of which their own roundings are a small part, as L ≤ 2^42 γ|p|. Sides are divided by their largest size M
// in the tile, and if e < |det|/2 by the sign of det, so that all are positive inside.
//
// In float, with u = 2^-24, a pixel is at the first of its block, which is in the tile, and up to 2T from
// there: the terms of a side sum up to no more than 3, those at the first of the block to no more than 1.
// Rounding takes 3u for coefficients, 2u for x and y, 4u and 3u for the products and sums of the two parts
// and 1u for the last sum: 13u, and if w ≤ 2^-23 M, less than 2^-20 in all. An edge with a larger w is left
// out, as if it was passed on either side. If e < |det|/2, k is off by less than 2 (Σw + K e) / |det| and
// 2^-20 K, K being its largest size in the tile; if not, or beyond what float holds, nothing is known of it.
// Where all vertices are surely in front, Z > 2^12 γ|p|, their places are good to 2^-11 of a pixel; the
// triangle is in no pixel beyond these, and k is between the least and the largest 1/Z, which are good to
// 2^-11 of themselves.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "packet.hpp"
#include "screen.hpp"
#include "tile.hpp"
#include "triangle_tree.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// What the pixels of a tile see first of the triangles of a tree.
class TrianglesInTile {
 public:
  /// Draws a tile of at most 64 × 64 pixels, as the rays through a sample of each see it. If that is not
  /// possible, or triangles are so small that rays are sooner followed, nothing is drawn: that is known
  /// before for all of them, or while it is tried, for those of this tile. What t() and part() tell is worked
  /// out only if it is asked.
  void draw(const TriangleTree& tree, const PixelRays& rays, int sample, const Frustum& frustum,
            const Tile& tile, Asked asked) {
    tree_ = &tree;
    tile_ = tile;
    const Screen screen(rays, sample, tile, tree.space());
    usable_ = screen.usable && tree.has_all() && tile.width() <= side && tile.height() <= side &&
              static_cast<double>(tree.size()) <= most_a_pixel * screen.pixels_of_all;
    if (!usable_) return;
    clear();
    int budget = most_tried_a_pixel * tile.width() * tile.height();  // boxes and triangles
    tree.each_leaf_ahead(
        frustum.side, [&](const Node& node) { return BoxesOnScreen(screen, node); },
        [&](const BoxOnScreen& box) { return --budget < 0 || is_hidden(box); },
        [&](Leaf leaf) {
          budget -= static_cast<int>(leaf.count);
          for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
            const auto corners = tree.leaves().corners(leaf, i);
            const Shapes shapes(screen, corners);
            Bits some = shapes.in_tile & first_bits(static_cast<int>(leaf.count - i));
            if (some == 0) continue;
            const auto first = static_cast<std::int32_t>(drawn_.size() * double_lanes);
            Floats floors = 0.0f;
            if (asked == Asked::where)
              floors = drawn_.emplace_back(screen, corners, leaf, i).floors(screen, corners);
            for (; some != 0; some &= some - 1) {
              const int k = std::countr_zero(some);
              draw_one(shapes, floors[k], static_cast<std::size_t>(k), first + k);
            }
          }
        });
    usable_ = budget >= 0;
    if (usable_) decide();
  }

  [[nodiscard]] bool is_drawn() const { return usable_; }

  /// What the rays of a packet, from a pixel on to the right, surely see first: which triangle, for t() and
  /// part(). Where it is no more than possible that they see any, they are in doubt.
  struct Seen {
    Chosen met, in_doubt;
    Indices which = -1;
  };
  [[nodiscard, gnu::always_inline]] Seen seen(const Chosen& wanted, int x, int y) const {
    const Indices which =
        widened(Lanes<std::int32_t, double_lanes>::load(&seen_[index(x - tile_.x0, y - tile_.y0)]));
    const Chosen doubtful = mask_for<double>(which == Indices(in_doubt)),
                 none = mask_for<double>(which == Indices(nothing));
    return {.met = wanted && !doubtful && !none, .in_doubt = wanted && doubtful, .which = which};
  }

  /// Where some rays cross what they see.
  [[nodiscard, gnu::always_inline]] Doubles t(const Indices& which, const Chosen& met,
                                              const Vectors& d) const {
    const double* planes[double_lanes];
    const auto any_lane = std::countr_zero(bits(met)) % double_lanes;  // for those that see none
    std::int64_t numbers[double_lanes];
    select(met, which, Indices(which[any_lane])).store(numbers);
    for (std::size_t lane = 0; lane < double_lanes; ++lane) {
      const auto one = static_cast<std::size_t>(numbers[lane]);
      planes[lane] = &drawn_[one / double_lanes].numbers[one % double_lanes];
    }
    const auto number = [&](std::size_t k) {
      return Doubles::of_each([&](int lane) { return planes[lane][k * double_lanes]; });
    };
    return number(3) / dot(Vectors{number(0), number(1), number(2)}, d);
  }

  /// The number of a triangle that is seen.
  [[nodiscard]] int part(std::int64_t which) const {
    const Planes& planes = drawn_[static_cast<std::size_t>(which / double_lanes)];
    const auto i = planes.first + static_cast<std::uint32_t>(which % double_lanes);
    return static_cast<int>(tree_->leaves().number(TriangleLeaves::place(planes.leaf, i)));
  }

 private:
  /// With so many triangles a pixel, or so many boxes and triangles that are tried, they are about as soon
  /// drawn as rays are followed (the pictures of tests/bench/bench_meshes.cpp).
  static constexpr int most_a_pixel = 8, most_tried_a_pixel = 32;

  static constexpr int side = 64;  ///< pixels of a tile that can be drawn
  static constexpr std::int32_t nothing = -1,
                                in_doubt = -2;  ///< what is seen, beside the number of a triangle

  using Pixels = Lanes<float, float_lanes>;
  using Whole = Lanes<std::int32_t, float_lanes>;

  /// Neighboring pixels, as many as a vector holds: a small triangle is in few blocks.
  struct alignas(4 * sizeof(Pixels)) Block {
    static constexpr int width = std::min(4, float_lanes), height = float_lanes / width;

    float far[float_lanes], near[float_lanes];  ///< between which k of the nearest is
    float other[float_lanes];                   ///< the largest k that any other may have
    std::int32_t nearest[float_lanes];

    /// How far each pixel is from the first.
    static Pixels across() {
      return Pixels::of_each([](int lane) { return static_cast<float>(lane % width); });
    }
    static Pixels down() {
      return Pixels::of_each([](int lane) { return static_cast<float>(lane / width); });
    }

    /// The pixels of the columns, or rows, from one on to before another.
    static Bits columns(int from, int to) {
      constexpr Bits of_each_row = first_bits(float_lanes) / first_bits(width);
      return of_each_row * (first_bits(std::min(to, width)) & ~first_bits(std::max(from, 0)));
    }
    static Bits rows(int from, int to) {
      return first_bits(width * std::min(to, height)) & ~first_bits(width * std::max(from, 0));
    }
  };

  /// Of some triangles, what t of a ray from the eye is worked out from: height / n·d.
  struct Planes {
    double numbers[4 * double_lanes];  ///< all n.x, all n.y, all n.z, and the heights
    Leaf leaf;
    std::uint32_t first;

    Planes(const Screen& screen, const std::array<Vectors, 3>& corners, Leaf of, std::uint32_t i)
        : leaf(of), first(i) {
      const Vectors normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
      normal.x.store(numbers), normal.y.store(numbers + double_lanes),
          normal.z.store(numbers + 2 * double_lanes);
      dot(normal, corners[0] - Vectors(screen.eye)).store(numbers + 3 * double_lanes);
    }

    /// Above these k, t is certain. In the way and with the bounds of rounded_triangle_equation, it is where
    /// |n·d| > 2^-18 of the sizes of its terms, which sum up to no more than the largest of those of n times
    /// |d|₁, d being a unit vector: 2^-17 of that largest covers √3 and what is rounded here. As the plane is
    /// met at o + D/k in box space, n·D is height · k · scale, and |D| at most `longest`.
    [[nodiscard]] Floats floors(const Screen& screen, const std::array<Vectors, 3>& corners) const {
      const auto& [a, b, c] = corners;
      const auto sum_of = [](const Vectors& v) { return v.x + v.y + v.z; };
      const Vectors p = abs(b - a), q = abs(c - a), w = abs(a - Vectors(screen.eye)),
                    terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
      const Doubles U = sum_of(p), V = sum_of(q), heights = dot(terms, w),
                    height = Doubles::load(numbers + 3 * double_lanes);
      const Chosen known = U > 0x1p-200 && U < 0x1p200 && V > 0x1p-200 && V < 0x1p200 &&
                           sum_of(w) < 0x1p200 && abs(height) > 0x1p-18 * heights && heights > 0x1p-800;
      const Doubles least = max(0x1p-17 * max(terms.x, max(terms.y, terms.z)), 0x1p-500),
                    floor = least * (screen.longest / screen.scale) / abs(height);
      return to_float(select(known && floor < 0x1p100, floor, Doubles(infinity)));
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
          is_in_front(z > 0x1p12 * screen.uncertainty * size && z > 0x1p-900) {}
  };

  /// Some triangles, as pixels are tried against them.
  struct Shapes {
    LinearInFloat edge[3], nearness;
    std::array<float, double_lanes> error, least, most;     ///< of k: how far it may be off, and its range
    std::array<std::int32_t, double_lanes> x0, x1, y0, y1;  ///< the pixels of the tile from, and to before
    Bits in_tile;                                           ///< those that may be in any
    Bits is_signed;  ///< those whose sides are positive inside; of others it is not known

    Shapes(const Screen& screen, const std::array<Vectors, 3>& corners) {
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
      const Chosen faces = e < 0.5 * abs(det) && abs(det) > 0x1p-900;
      const Doubles turn = select(faces, det, 1.0);
      is_signed = bits(faces);
      Doubles off = 0.0;
      const auto turned = [&](const Linear& s, const Corner& p, const Corner& q) {
        const Doubles w = 8 * gamma * (p.size * q.extent + q.size * p.extent), M = s.most(T);
        off = off + w;
        const Chosen known = w <= 0x1p-23 * M && M > 0x1p-900;
        return select(known, copysign(1 / M, turn), Doubles(0.0)) * s;
      };
      edge[0] = turned(ab, a, b), edge[1] = turned(bc, b, c), edge[2] = turned(ca, c, a);
      const Doubles of_det = 1 / det;
      const Linear nearness_at = of_det * (ab + bc + ca);
      const Doubles K = nearness_at.most(T), uncertain = 2 * (off + K * e) * abs(of_det) + 0x1p-20 * K;
      const Chosen known = faces && uncertain < 0x1p60 && K < 0x1p60 && K > 0x1p-60;
      nearness = Linear{select(known, nearness_at.x, 0.0), select(known, nearness_at.y, 0.0),
                        select(known, nearness_at.one, 0.0)};
      to_float(select(known, uncertain, Doubles(infinity))).store(error.data());

      const Chosen in_front = a.is_in_front && b.is_in_front && c.is_in_front;
      const Doubles za = 1 / a.z, zb = 1 / b.z, zc = 1 / c.z;
      const Doubles farthest = min(za, min(zb, zc)), nearest = max(za, max(zb, zc));
      to_float(select(in_front, min((1 - 0x1p-11) * farthest, 0x1p100), 0.0)).store(least.data());
      to_float(select(in_front && nearest < 0x1p100, (1 + 0x1p-11) * nearest, infinity)).store(most.data());

      const auto pixels = [&](Doubles u, Doubles v, Doubles w, double start, int count) {
        return PixelsBetween<double_lanes>(to_float(select(in_front, min(u, min(v, w)) - start, 0.0)),
                                           to_float(select(in_front, max(u, max(v, w)) - start, count)),
                                           count);
      };
      const auto x = pixels(a.x * za, b.x * zb, c.x * zc, screen.left, screen.width),
                 y = pixels(a.y * za, b.y * zb, c.y * zc, screen.top, screen.height);
      in_tile = bits(x.any && y.any);
      x.first.store(x0.data()), x.end.store(x1.data()), y.first.store(y0.data()), y.end.store(y1.data());
      left = static_cast<float>(screen.left), top = static_cast<float>(screen.top);
    }

    float left, top;
  };

  [[nodiscard]] static std::size_t index(int x, int y) { return static_cast<std::size_t>(side * y + x); }
  [[nodiscard]] static std::size_t index_of_block(int x, int y) {
    return static_cast<std::size_t>(side / Block::width * (y / Block::height) + x / Block::width);
  }
  [[nodiscard]] Block& block(int x, int y) { return blocks_[index_of_block(x, y)]; }
  [[nodiscard]] const Block& block(int x, int y) const { return blocks_[index_of_block(x, y)]; }

  void clear() {
    Block empty;
    // What is compared with the least float above 0 is compared with 0 as well.
    std::ranges::fill(empty.far, std::numeric_limits<float>::denorm_min());
    std::ranges::fill(empty.near, 0.0f), std::ranges::fill(empty.other, 0.0f);
    std::ranges::fill(empty.nearest, nothing);
    for (int y = 0; y < tile_.height(); y += Block::height)
      std::fill_n(&block(0, y), (tile_.width() + Block::width - 1) / Block::width, empty);
    drawn_.clear();
  }

  /// Whether no pixel can see anything in a box, given what they see already.
  [[nodiscard]] bool is_hidden(const BoxOnScreen& box) const {
    const Pixels nearest = box.nearest;
    for (int y = box.y0 / Block::height * Block::height; y < box.y1; y += Block::height)
      for (int x = box.x0 / Block::width * Block::width; x < box.x1; x += Block::width)
        if ((bits(Pixels::load(block(x, y).far) <= nearest) & Block::columns(box.x0 - x, box.x1 - x) &
             Block::rows(box.y0 - y, box.y1 - y)) != 0)
          return false;
    return true;
  }

  /// Of each pixel, what may be seen of the triangles so far: one that surely is in front of all but those
  /// that may be as near as `other`.
  void draw_one(const Shapes& shapes, float floor, std::size_t i, std::int32_t which) {
    constexpr float e = 0x1p-20f;
    const auto inside_block = [&](const LinearInFloat& f) {
      return Pixels(f.x[i]) * Block::across() + Pixels(f.y[i]) * Block::down();
    };
    const Pixels ab = inside_block(shapes.edge[0]), bc = inside_block(shapes.edge[1]),
                 ca = inside_block(shapes.edge[2]), k = inside_block(shapes.nearness);
    const Pixels error = shapes.error[i], least = shapes.least[i], most = shapes.most[i];
    const int x0 = shapes.x0[i] / Block::width * Block::width,
              y0 = shapes.y0[i] / Block::height * Block::height;
    const int x1 = shapes.x1[i], y1 = shapes.y1[i];
    const bool is_signed = (shapes.is_signed >> i & 1) != 0;
    // In one loop, as how many blocks there are is hard to foresee.
    for (int x = x0, y = y0; y < y1;) {
      const float across = shapes.left + static_cast<float>(x), down = shapes.top + static_cast<float>(y);
      const auto at = [&](const LinearInFloat& f) {
        return Pixels(f.x[i] * across + (f.y[i] * down + f.one[i]));
      };
      const Pixels of_ab = ab + at(shapes.edge[0]), of_bc = bc + at(shapes.edge[1]),
                   of_ca = ca + at(shapes.edge[2]), nearness = k + at(shapes.nearness);
      Pixels inside = min(min(of_ab, of_bc), of_ca);
      if (!is_signed)  // where all are positive or all negative
        inside = max(inside, min(min(-of_ab, -of_bc), -of_ca));
      const Pixels near = min(nearness + error, most), far = max(nearness - error, least);
      Block& pixels = block(x, y);
      const Pixels known = Pixels::load(pixels.far), before = Pixels::load(pixels.near);
      const auto maybe = inside >= Pixels(-e) && near >= known,
                 surely = inside > Pixels(e) && far > max(known, floor);
      max(Pixels::load(pixels.other), select(surely, before, select(maybe, near, 0.0f))).store(pixels.other);
      select(surely, far, known).store(pixels.far);
      select(surely, near, before).store(pixels.near);
      select(surely, Whole(which), Whole::load(pixels.nearest)).store(pixels.nearest);
      const bool is_last = x + Block::width >= x1;
      x = is_last ? x0 : x + Block::width;
      y += is_last ? Block::height : 0;
    }
  }

  /// Writes down what each pixel sees.
  void decide() {
    for (int y = 0; y < tile_.height(); y += Block::height)
      for (int x = 0; x < tile_.width(); x += Block::width) {
        const Block& pixels = block(x, y);
        std::int32_t seen[float_lanes];
        select(Pixels::load(pixels.other) < Pixels::load(pixels.far), Whole::load(pixels.nearest),
               Whole(in_doubt))
            .store(seen);
        for (int row = 0; row < Block::height; ++row)
          std::memcpy(&seen_[index(x, y + row)], seen + row * Block::width, sizeof(*seen) * Block::width);
      }
  }

  const TriangleTree* tree_ = nullptr;
  Tile tile_{};
  bool usable_ = false;
  std::array<Block, (side / Block::width) * (side / Block::height)> blocks_;
  std::array<std::int32_t, side * side + double_lanes> seen_{};  ///< room for what is read behind the last
  std::vector<Planes> drawn_;                                    ///< what `nearest` counts
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

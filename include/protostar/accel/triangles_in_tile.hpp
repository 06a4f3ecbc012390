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
  double left, top;           ///< x and y of the middle of the tile's first pixel

  Screen(const PixelRays& rays, const Tile& tile, const BoxSpace& space)
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
    usable = rays.is_pinhole() && is_moderate(length(e1)) && is_moderate(length(e2)) &&
             is_moderate(length(e3)) && std::abs(volume) > 0x1p-4 * sizes &&
             length(eye_in_box_space) < 0x1p40;
    across = cross(e2, e3) / volume, down = cross(e3, e1) / volume, ahead = cross(e1, e2) / volume;
    reach = std::max(half_width, half_height);
    uncertainty = 0x1p-42 * (length(across) + length(down) + reach * length(ahead));
    left = pixels.sample(0).x - half_width, top = pixels.sample(0).y - half_height;
  }
};

/// What the pixels of a tile see first of the triangles of a tree.
class TrianglesInTile {
 public:
  /// Draws a tile of at most 64 × 64 pixels. If that is not possible, nothing is seen.
  void draw(const TriangleTree& tree, const PixelRays& rays, const Frustum& frustum, const Tile& tile) {
    tree_ = &tree;
    tile_ = tile;
    const Screen screen(rays, tile, tree.space());
    usable_ = screen.usable && rays.pixels().samples() == 1 && tree.has_all();
    if (!usable_) return;
    stride_ = static_cast<std::size_t>(tile.width() + float_lanes);
    const std::size_t pixels = stride_ * static_cast<std::size_t>(tile.height());
    far_.assign(pixels, 0), near_.assign(pixels, 0), other_.assign(pixels, 0), place_.resize(pixels);
    const auto is_hidden = [&](const Bounds& box) { return this->is_hidden(screen, box); };
    tree.each_leaf_ahead(frustum.side, screen.ahead, is_hidden, [&](Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
        const std::uint32_t first = leaf.first + i;
        const int count = std::min(double_lanes, static_cast<int>(leaf.count - i));
        const Shapes shapes(screen, corners([&](int k) -> auto& {
                              return tree.in_leaf(first + static_cast<std::uint32_t>(std::min(k, count - 1)));
                            }),
                            tile);
        for (int k = 0; k < count; ++k) draw_one(shapes, k, static_cast<std::int32_t>(first) + k);
      }
    });
  }

  /// What the rays of a packet, from a pixel on to the right, see first; and which, for part().
  struct Seen {
    FirstCrossings first;
    Indices which = -1;
  };
  [[nodiscard]] bool is_drawn() const { return usable_; }
  [[nodiscard]] Seen seen(const CameraRays<Point>& rays, int x, int y) const {
    const std::size_t at = index(x - tile_.x0, y - tile_.y0);
    const Floats far = Floats::load(&far_[at]), other = Floats::load(&other_[at]);
    const Chosen one = rays.wanted && mask_for<double>(other < far);
    Seen seen{.first = {.t = infinity,
                        .met = false,
                        .in_doubt = rays.wanted && mask_for<double>(far <= other && other > Floats(0.0f))}};
    if (!any(one)) return seen;
    // Where there is none it is any other.
    const Bits found = bits(one);
    const int any_lane = std::countr_zero(found);
    const auto place = [&](int lane) {
      return place_[at + static_cast<std::size_t>((found >> lane & 1) != 0 ? lane : any_lane)];
    };
    const auto [a, b, c] =
        corners([&](int lane) -> auto& { return tree_->in_leaf(static_cast<std::size_t>(place(lane))); });
    const auto e = protostar::detail::rounded_triangle_equation(rays.origin, rays.direction, a, b, c);
    const Doubles t = e.height / e.slope;
    seen.first.met = one && e.crosses && e.certain && t > 0.0 && t < infinity;
    seen.first.in_doubt = seen.first.in_doubt || (one && !seen.first.met);
    seen.first.t = select(seen.first.met, t, Doubles(infinity));
    seen.which = Indices::of_each([&](int lane) { return static_cast<std::int64_t>(place(lane)); });
    return seen;
  }

  /// The number of a triangle that is seen.
  [[nodiscard]] int part(std::int64_t which) const {
    return static_cast<int>(tree_->number(static_cast<std::size_t>(which)));
  }

 private:
  using Row = Lanes<float, float_lanes>;
  static constexpr float infinite = std::numeric_limits<float>::infinity();

  /// The corners of as many triangles as a packet has lanes.
  static std::array<Vectors, 3> corners(const auto& triangle) {
    std::array<const Triangle*, double_lanes> at;
    for (int lane = 0; lane < double_lanes; ++lane) at[static_cast<std::size_t>(lane)] = &triangle(lane);
    const auto vectors = [&](Point Triangle::*corner) {
      const auto numbers = [&](int axis) {
        return Doubles::of_each(
            [&](int lane) { return (at[static_cast<std::size_t>(lane)]->*corner)[axis]; });
      };
      return Vectors{numbers(0), numbers(1), numbers(2)};
    };
    return {vectors(&Triangle::a), vectors(&Triangle::b), vectors(&Triangle::c)};
  }

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

  /// A corner of each of some triangles.
  struct Corner {
    Doubles x, y, z, size, reach;  ///< X, Y, Z, |p| and L

    Corner(const Screen& screen, const Vectors& p) {
      const Vectors w = screen.scale * (p - Vectors(screen.eye));
      x = dot(w, Vectors(screen.across)), y = dot(w, Vectors(screen.down)), z = dot(w, Vectors(screen.ahead));
      size = abs(w.x) + abs(w.y) + abs(w.z);
      reach = abs(x) + abs(y) + screen.reach * abs(z);
    }
  };

  /// Some triangles, as pixels are tried against them.
  struct Shapes {
    LinearInFloat side[3], nearness;
    std::array<float, double_lanes> error, least, most;  ///< of k: how far it may be off, and its range
    std::array<int, double_lanes> x0, x1, y0, y1;        ///< the pixels of the tile from, and to before

    Shapes(const Screen& screen, const std::array<Vectors, 3>& corners, const Tile& tile) {
      const Corner a(screen, corners[0]), b(screen, corners[1]), c(screen, corners[2]);
      const double gamma = screen.uncertainty, T = screen.reach;
      Doubles off = 0.0;
      int edge = 0;
      const auto line = [&](const Corner& p, const Corner& q) {
        const Linear s{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
        const Doubles w = 8 * gamma * (p.size * q.reach + q.size * p.reach), M = s.most(T);
        off = off + w;
        side[edge++] = select(w <= 0x1p-22 * M && M > 0x1p-900, 1 / M, Doubles(0.0)) * s;
        return s;
      };
      const Linear ab = line(a, b), bc = line(b, c), ca = line(c, a);
      const Doubles det = bc.x * a.x + bc.y * a.y + bc.one * a.z;
      const Doubles e =
          12 * gamma / T *
          (a.size * b.reach * c.reach + a.reach * b.size * c.reach + a.reach * b.reach * c.size);
      const Linear k = (1 / det) * (ab + bc + ca);
      const Doubles K = k.most(T), uncertain = 2 * (off + K * e) / abs(det) + 0x1p-20 * K;
      const Chosen known = e < 0.5 * abs(det) && uncertain < 0x1p60 && K < 0x1p60 && K > 0x1p-60;
      nearness = Linear{select(known, k.x, 0.0), select(known, k.y, 0.0), select(known, k.one, 0.0)};
      to_float(select(known, uncertain, Doubles(infinity))).store(error.data());

      const Chosen in_front =
          a.z > 0x1p12 * gamma * a.size && b.z > 0x1p12 * gamma * b.size && c.z > 0x1p12 * gamma * c.size;
      const Doubles from = 1 / max(a.z, max(b.z, c.z)), to = 1 / min(a.z, min(b.z, c.z));
      const auto float_of = [](Doubles x) { return to_float(min(x, 0x1p100)); };
      float_of(select(in_front, (1 - 0x1p-11) * from, Doubles(0.0))).store(least.data());
      to_float(select(in_front && to < 0x1p100, (1 + 0x1p-11) * to, Doubles(infinity))).store(most.data());

      const auto pixels = [&](Doubles u, Doubles v, Doubles w, double start, int count, auto& first,
                              auto& last) {
        const Doubles low = min(u, min(v, w)) - start - 0x1p-10, high = max(u, max(v, w)) - start + 0x1p-10;
        const Doubles begin = select(in_front, max(Doubles(0.0), min(low, static_cast<double>(count))), 0.0);
        const Doubles end =
            select(in_front, max(Doubles(0.0), min(high + 1, static_cast<double>(count))), Doubles(count));
        for (int i = 0; i < double_lanes; ++i) {
          const auto at = static_cast<std::size_t>(i);
          first[at] = static_cast<int>(begin[i]);
          first[at] += first[at] < begin[i];
          last[at] = static_cast<int>(end[i]);
        }
      };
      const Doubles za = 1 / a.z, zb = 1 / b.z, zc = 1 / c.z;
      pixels(a.x * za, b.x * zb, c.x * zc, screen.left, tile.width(), x0, x1);
      pixels(a.y * za, b.y * zb, c.y * zc, screen.top, tile.height(), y0, y1);
      left = static_cast<float>(screen.left), top = static_cast<float>(screen.top);
    }

    float left, top;
  };

  [[nodiscard]] std::size_t index(int x, int y) const {
    return stride_ * static_cast<std::size_t>(y) + static_cast<std::size_t>(x);
  }

  /// Whether no pixel can see anything in a box of box space, given what they see already.
  [[nodiscard]] bool is_hidden(const Screen& screen, const Bounds& box) const {
    const Point from = box.min - screen.eye_in_box_space, to = box.max - screen.eye_in_box_space;
    double nearest = infinity, left = infinity, right = -infinity, top = infinity, bottom = -infinity;
    for (int i = 0; i < 8; ++i) {
      const Vec3 p{i & 1 ? to.x : from.x, i & 2 ? to.y : from.y, i & 4 ? to.z : from.z};
      const double z = dot(p, screen.ahead);
      if (!(z > 0x1p12 * screen.uncertainty * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z)))) return false;
      const double x = dot(p, screen.across) / z, y = dot(p, screen.down) / z;
      nearest = std::min(nearest, z);
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
    const auto first = [](double place, double start) {
      return static_cast<int>(std::ceil(std::clamp(place - start - 0x1p-10, 0.0, 64.0)));
    };
    const auto end = [](double place, double start, int count) {
      return static_cast<int>(std::clamp(place - start + 0x1p-10 + 1, 0.0, static_cast<double>(count)));
    };
    const double most = (1 + 0x1p-11) / nearest;
    if (!(most < 0x1p100)) return false;
    const Row limit = static_cast<float>((1 + 0x1p-20) * most);
    const int x0 = first(left, screen.left), x1 = end(right, screen.left, tile_.width());
    const int y1 = end(bottom, screen.top, tile_.height());
    for (int y = first(top, screen.top); y < y1; ++y)
      for (int x = x0; x < x1; x += float_lanes)
        if ((bits(Row::load(&far_[index(x, y)]) <= limit) & first_bits(x1 - x)) != 0) return false;
    return true;
  }

  /// Of each pixel, what may be seen of the triangles so far: one that surely is in front of all but those
  /// that may be as near as `other`.
  void draw_one(const Shapes& shapes, int which, std::int32_t place) {
    const auto k = static_cast<std::size_t>(which);
    if (shapes.x0[k] >= shapes.x1[k]) return;
    constexpr float e = 0x1p-20f;
    const Row error = shapes.error[k], least = shapes.least[k], most = shapes.most[k];
    for (int y = shapes.y0[k]; y < shapes.y1[k]; ++y) {
      const float down = shapes.top + static_cast<float>(y);
      for (int x = shapes.x0[k]; x < shapes.x1[k]; x += float_lanes) {
        const Row across = iota<float, float_lanes>() + Row(shapes.left + static_cast<float>(x));
        const auto at_pixels = [&](const LinearInFloat& f) {
          return Row(f.x[k]) * across + Row(f.y[k] * down + f.one[k]);
        };
        const Row ab = at_pixels(shapes.side[0]), bc = at_pixels(shapes.side[1]),
                  ca = at_pixels(shapes.side[2]), nearness = at_pixels(shapes.nearness);
        const Row largest = max(max(ab, bc), ca), smallest = min(min(ab, bc), ca);
        const Row near = min(nearness + error, most), far = max(nearness - error, least);
        const std::size_t i = index(x, y);
        const Row known = Row::load(&far_[i]);
        const auto seen = !(largest > Row(e) && smallest < Row(-e)) && near >= known && near > Row(0.0f);
        if (!any(seen)) continue;
        const auto surely = seen && (smallest > Row(e) || largest < Row(-e)) && far > known;
        const Row before = Row::load(&near_[i]);
        max(Row::load(&other_[i]), select(surely, before, select(seen, near, 0.0f))).store(&other_[i]);
        select(surely, far, known).store(&far_[i]);
        select(surely, near, before).store(&near_[i]);
        using Places = Lanes<std::int32_t, float_lanes>;
        select(surely, Places(place), Places::load(&place_[i])).store(&place_[i]);
      }
    }
  }

  const TriangleTree* tree_ = nullptr;
  Tile tile_{};
  bool usable_ = false;
  std::size_t stride_ = 0;
  std::vector<float> far_, near_;  ///< between which k of the nearest is; 0 where there is none
  std::vector<float> other_;       ///< the largest k that any other may have
  std::vector<std::int32_t> place_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

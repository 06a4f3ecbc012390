// What the pixels of a tile see first of many triangles: these are drawn into the tile, and each pixel keeps
// the nearest, or only whether there is any.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "coverage.hpp"
#include "packet.hpp"
#include "pixel_block.hpp"
#include "screen.hpp"
#include "tile.hpp"
#include "triangle_tree.hpp"
#include "triangles_in_front.hpp"
#include "triangles_on_screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// What the pixels of a tile see first of the triangles of a tree.
class TrianglesInTile {
 public:
  /// Draws a tile of at most 64 × 64 pixels, as the rays through a sample of each see it. If that is not
  /// possible, or triangles are so small that rays are sooner followed, nothing is drawn: that is known
  /// before for all of them, or while it is tried, for those of this tile. What t() and part() tell, and what
  /// is first, is worked out only if it is asked.
  void draw(const TriangleTree& tree, const PixelRays& rays, int sample, const Frustum& frustum,
            const Tile& tile, Asked asked) {
    tree_ = &tree;
    tile_ = tile;
    asked_ = asked;
    const Screen screen(rays, sample, tile, tree.space());
    usable_ = screen.usable && tree.has_all() && tile.width() <= side && tile.height() <= side &&
              static_cast<double>(tree.size()) <= most_a_pixel * screen.pixels_of_all;
    if (!usable_) return;
    if (asked == Asked::whether)
      cover(screen, frustum);
    else
      find_nearest(screen, frustum);
  }

  [[nodiscard]] bool is_drawn() const { return usable_; }
  [[nodiscard]] bool tells_where() const { return asked_ == Asked::where; }

  /// What the rays of a packet, from a pixel on to the right, surely see first: which triangle, for t() and
  /// part(), if it tells where. Where it is no more than possible that they see any, they are in doubt.
  struct Seen {
    Chosen met, in_doubt;
    Indices which = -1;
  };
  [[nodiscard, gnu::always_inline]] Seen seen(const Chosen& wanted, int x, int y) const {
    if (!tells_where()) {
      const Coverage::Row& row = rows_[static_cast<std::size_t>(y - tile_.y0)];
      const auto from_x_on = [&](std::uint64_t pixels) {
        return mask_of<double, double_lanes>(static_cast<Bits>(pixels >> (x - tile_.x0)));
      };
      return {.met = wanted && from_x_on(row.surely),
              .in_doubt = wanted && from_x_on(row.in_doubt & ~row.surely)};
    }
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

  static constexpr int side = PixelBlock::side;
  static constexpr std::int32_t nothing = -1,
                                in_doubt = -2;  ///< what is seen, beside the number of a triangle

  using Whole = Lanes<std::int32_t, float_lanes>;

  /// What the pixels of a block see so far.
  struct alignas(4 * sizeof(Pixels)) Block {
    float far[float_lanes], near[float_lanes];  ///< between which k of the nearest is
    float other[float_lanes];                   ///< the largest k that any other may have
    std::int32_t nearest[float_lanes];
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

  [[nodiscard]] static std::size_t index(int x, int y) { return static_cast<std::size_t>(side * y + x); }
  [[nodiscard]] Block& block(int x, int y) { return blocks_[PixelBlock::index(x, y)]; }
  [[nodiscard]] const Block& block(int x, int y) const { return blocks_[PixelBlock::index(x, y)]; }

  /// Calls visit(leaf, i, there) for what the tile may see, but for boxes that are hidden by then: the
  /// triangles from the i-th of a leaf on, as many as a vector holds, and those that are there.
  void each_in_tile(const Screen& screen, const Frustum& frustum, const auto& is_hidden, const auto& visit) {
    int budget = most_tried_a_pixel * tile_.width() * tile_.height();  // boxes and triangles
    tree_->each_leaf_ahead(
        frustum.side, [&](const Node& node) { return BoxesOnScreen(screen, node); },
        [&](const BoxOnScreen& box) { return --budget < 0 || is_hidden(box); },
        [&](Leaf leaf) {
          budget -= static_cast<int>(leaf.count);
          for (std::uint32_t i = 0; i < leaf.count; i += double_lanes)
            visit(leaf, i, first_bits(static_cast<int>(leaf.count - i)));
        });
    usable_ = budget >= 0;
  }

  /// Which pixels see any.
  void cover(const Screen& screen, const Frustum& frustum) {
    const TrianglesInFront::Places places(screen);
    Coverage coverage;
    coverage.clear();
    each_in_tile(
        screen, frustum, [&](const BoxOnScreen& box) { return coverage.hides(box); },
        [&](Leaf leaf, std::uint32_t i, Bits left) {
          const auto corners = tree_->leaves().corners(leaf, i);
          const TrianglesInFront in_front(places, corners);
          left &= in_front.in_tile;
          coverage.add(in_front, left & in_front.known);
          left &= ~in_front.known;
          if (left == 0) return;
          const TrianglesOnScreen others(screen, corners, Asked::whether);
          for (left &= others.in_tile; left != 0; left &= left - 1)
            coverage.add(others, static_cast<std::size_t>(std::countr_zero(left)));
        });
    for (int y = 0; y < tile_.height(); ++y) rows_[static_cast<std::size_t>(y)] = coverage.row(y);
  }

  /// Which one each pixel sees first.
  void find_nearest(const Screen& screen, const Frustum& frustum) {
    clear();
    each_in_tile(
        screen, frustum, [&](const BoxOnScreen& box) { return is_hidden(box); },
        [&](Leaf leaf, std::uint32_t i, Bits there) {
          const auto corners = tree_->leaves().corners(leaf, i);
          const TrianglesOnScreen triangles(screen, corners, Asked::where);
          Bits some = there & triangles.in_tile;
          if (some == 0) return;
          const auto first = static_cast<std::int32_t>(drawn_.size() * double_lanes);
          const Floats floors = drawn_.emplace_back(screen, corners, leaf, i).floors(screen, corners);
          for (; some != 0; some &= some - 1) {
            const int k = std::countr_zero(some);
            draw_one(triangles, floors[k], static_cast<std::size_t>(k), first + k);
          }
        });
    if (usable_) decide();
  }

  void clear() {
    Block empty;
    // What is compared with the least float above 0 is compared with 0 as well.
    std::fill(std::begin(empty.far), std::end(empty.far), std::numeric_limits<float>::denorm_min());
    std::fill(std::begin(empty.near), std::end(empty.near), 0.0f),
        std::fill(std::begin(empty.other), std::end(empty.other), 0.0f);
    std::fill(std::begin(empty.nearest), std::end(empty.nearest), nothing);
    for (int y = 0; y < tile_.height(); y += PixelBlock::height)
      std::fill_n(&block(0, y), (tile_.width() + PixelBlock::width - 1) / PixelBlock::width, empty);
    drawn_.clear();
  }

  /// Whether no pixel can see anything in a box, given what they see already.
  [[nodiscard]] bool is_hidden(const BoxOnScreen& box) const {
    return PixelBlock::all_of(box, [&, nearest = Pixels(box.nearest)](int x, int y) {
      return (bits(Pixels::load(block(x, y).far) <= nearest) & PixelBlock::inside(box, x, y)) == 0;
    });
  }

  /// Of each pixel, what may be seen of the triangles so far: one that surely is in front of all but those
  /// that may be as near as `other`.
  void draw_one(const TrianglesOnScreen& triangles, float floor, std::size_t i, std::int32_t which) {
    constexpr float e = TrianglesOnScreen::error_of_sides;
    triangles.each_block(i, [&](int x, int y, const Pixels& inside, const auto& nearness) {
      const auto [far, near] = nearness();
      Block& pixels = block(x, y);
      const Pixels known = Pixels::load(pixels.far), before = Pixels::load(pixels.near);
      const auto maybe = inside >= Pixels(-e) && near >= known,
                 surely = inside > Pixels(e) && far > max(known, floor);
      max(Pixels::load(pixels.other), select(surely, before, select(maybe, near, 0.0f))).store(pixels.other);
      select(surely, far, known).store(pixels.far);
      select(surely, near, before).store(pixels.near);
      select(surely, Whole(which), Whole::load(pixels.nearest)).store(pixels.nearest);
    });
  }

  /// Writes down what each pixel sees.
  void decide() {
    for (int y = 0; y < tile_.height(); y += PixelBlock::height)
      for (int x = 0; x < tile_.width(); x += PixelBlock::width) {
        const Block& pixels = block(x, y);
        std::int32_t seen[float_lanes];
        select(Pixels::load(pixels.other) < Pixels::load(pixels.far), Whole::load(pixels.nearest),
               Whole(in_doubt))
            .store(seen);
        for (int row = 0; row < PixelBlock::height; ++row)
          std::memcpy(&seen_[index(x, y + row)], seen + row * PixelBlock::width,
                      sizeof(*seen) * PixelBlock::width);
      }
  }

  const TriangleTree* tree_ = nullptr;
  Tile tile_{};
  bool usable_ = false;
  Asked asked_ = Asked::where;
  std::array<Coverage::Row, side> rows_;  ///< if it does not tell where
  std::array<Block, PixelBlock::in_tile> blocks_;
  std::array<std::int32_t, side * side + double_lanes> seen_{};  ///< room for what is read behind the last
  std::vector<Planes> drawn_;                                    ///< what `nearest` counts
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Visibility buffer of a tile: many triangles are rasterized, and each pixel keeps the nearest.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "../bvh/node.hpp"
#include "../bvh/traversal.hpp"
#include "../plain_vector.hpp"
#include "../surfaces/mesh_tree.hpp"
#include "frustum.hpp"
#include "packet.hpp"
#include "pixel_block.hpp"
#include "pixel_rays.hpp"
#include "screen.hpp"
#include "triangles_on_screen.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Visibility buffer of a tile, for the triangles of a TriangleTree.
class TrianglesInTile {
 public:
  /// Rasterizes the triangles into a tile of at most 64 × 64 pixels, as the rays through a sample of each
  /// pixel see them. If that is not possible, or if triangles are so small that tracing rays is faster,
  /// nothing is drawn: this is found before, for all triangles, or on the way, for the triangles in this
  /// tile.
  void draw(const TriangleTree& tree, const PixelRays& rays, int sample, const TileHalfSpaces& half_spaces,
            const Tile& tile) {
    tree_ = &tree;
    tile_ = tile;
    const Screen screen(rays, sample, tile, tree.bvh().space());
    usable_ = screen.usable && tree.bvh().unbounded().empty() && tile.width() <= side &&
              tile.height() <= side &&
              static_cast<double>(tree.bvh().order().size()) <= most_a_pixel * screen.pixels_of_all;
    if (usable_) find_nearest(screen, half_spaces);
  }

  [[nodiscard]] bool is_drawn() const { return usable_; }

  /// Visibility for the rays of a packet, from a pixel on to the right that is a multiple of double_lanes
  /// from the left of the tile: lanes that surely hit, with the entry of the closest triangle for t() and
  /// primitive(), and lanes in doubt, which may hit.
  struct Seen {
    LaneMask met, in_doubt;
    Indices which = -1;
  };
  [[nodiscard, gnu::always_inline]] Seen seen(const LaneMask& active, int x, int y) const {
    const Indices which =
        widened(Lanes<std::int32_t, double_lanes>::load(&seen_[index(x - tile_.x0, y - tile_.y0)]));
    const LaneMask doubtful = mask_for<double>(which == Indices(in_doubt)),
                   none = mask_for<double>(which == Indices(nothing));
    return {.met = active && !doubtful && !none, .in_doubt = active && doubtful, .which = which};
  }

  /// Returns t of rays in direction d with the triangles that they hit, by `which` of seen(); any number in
  /// other lanes. At least one ray must hit.
  [[nodiscard, gnu::always_inline]] Doubles t(const Indices& which, const LaneMask& met,
                                              const Vectors& d) const {
    const double* planes[double_lanes];
    const auto any_lane = std::countr_zero(bits(met)) % double_lanes;  // stands in for lanes without a hit
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

  /// Returns the index, in the mesh, of a triangle that is seen.
  [[nodiscard]] int primitive(std::int64_t which) const {
    const Planes& planes = drawn_[static_cast<std::size_t>(which / double_lanes)];
    const auto i = planes.first + static_cast<std::uint32_t>(which % double_lanes);
    return static_cast<int>(tree_->leaves().number(TriangleLeaves::place(planes.leaf, i)));
  }

 private:
  /// Triangles per pixel, and boxes and triangles tested per pixel, at which rasterizing takes about as long
  /// as tracing rays (the pictures of tests/bench/bench_meshes.cpp).
  static constexpr int most_a_pixel = 8, most_tried_a_pixel = 32;

  static constexpr int side = PixelBlock::side;
  static_assert(side % double_lanes == 0);  // so that packets end in their row
  static constexpr std::int32_t nothing = -1,
                                in_doubt = -2;  ///< entries without a triangle

  using Whole = Lanes<std::int32_t, float_lanes>;

  /// Closest triangles so far in the pixels of a block.
  struct alignas(4 * sizeof(Pixels)) Block {
    float far[float_lanes], near[float_lanes];  ///< lower and upper bound of the nearest one's k
    float other[float_lanes];                   ///< upper bound for k of all others
    std::int32_t nearest[float_lanes];
  };

  /// Planes of some triangles, for t of rays from the eye: height / n·d.
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

    /// Returns lower bounds of k above which t is certain. By the method and the bounds of
    /// triangle_equation, t is certain if |n·d| > 2^-18 of the sizes of its terms, which sum up to no
    /// more than the largest term of n times |d|₁, d being a unit vector: 2^-17 of that largest covers √3 and
    /// the roundings here. As the plane is crossed at o + D/k in box space, n·D is height · k · scale, and
    /// |D| at most `longest`.
    [[nodiscard]] Floats floors(const Screen& screen, const std::array<Vectors, 3>& corners) const {
      const auto& [a, b, c] = corners;
      const auto sum_of = [](const Vectors& v) { return v.x + v.y + v.z; };
      const Vectors p = abs(b - a), q = abs(c - a), w = abs(a - Vectors(screen.eye)),
                    terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
      const Doubles U = sum_of(p), V = sum_of(q), heights = dot(terms, w),
                    height = Doubles::load(numbers + 3 * double_lanes);
      const LaneMask known = U > 0x1p-200 && U < 0x1p200 && V > 0x1p-200 && V < 0x1p200 &&
                             sum_of(w) < 0x1p200 && abs(height) > 0x1p-18 * heights && heights > 0x1p-800;
      const Doubles least = max(0x1p-17 * max(terms.x, max(terms.y, terms.z)), 0x1p-500),
                    floor = least * (screen.longest / screen.scale) / abs(height);
      return to_float(select(known && floor < 0x1p100, floor, Doubles(infinity)));
    }
  };

  [[nodiscard]] static std::size_t index(int x, int y) { return static_cast<std::size_t>(side * y + x); }
  [[nodiscard]] Block& block(int x, int y) { return blocks_[PixelBlock::index(x, y)]; }
  [[nodiscard]] const Block& block(int x, int y) const { return blocks_[PixelBlock::index(x, y)]; }

  /// Search for the leaves that a tile sees, near ones mostly before far ones, unless `hidden` is true for
  /// their boxes by then.
  template <class Hidden>
  struct SeenOnScreen {
    using Key = BoxOnScreen;

    const Screen& screen;
    InHalfSpaces sides;
    const Hidden& hidden;

    struct Children {
      BoxesOnScreen boxes;
      Bits met;
      BoxOnScreen operator[](int k) const { return boxes[k]; }
    };
    /// Decides by the sides of the tile unless all boxes that are seen are surely in front of the eye.
    [[nodiscard]] Children look(const Node& node) const {
      Children children{BoxesOnScreen(screen, node), 0};
      children.met = children.boxes.seen;
      if ((children.met & ~children.boxes.in_front) != 0) children.met &= sides.look(node).met;
      return children;
    }
    [[nodiscard]] bool precedes(const BoxOnScreen& a, const BoxOnScreen& b) const {
      return a.nearest > b.nearest;
    }
    [[nodiscard]] bool is_hidden(const BoxOnScreen& box) const { return hidden(box); }
  };

  /// Calls visit(leaf, i, there) for the leaves that the tile may see, except in boxes that are hidden by
  /// then: for the triangles from the i-th on, as many as a vector holds, with a bit in `there` for each that
  /// exists.
  void each_in_tile(const Screen& screen, const TileHalfSpaces& half_spaces, const auto& is_hidden,
                    const auto& visit) {
    int budget = most_tried_a_pixel * tile_.width() * tile_.height();  // boxes and triangles
    PlainVector<BoxHalfSpace> sides;
    for (const HalfSpace& half_space : half_spaces.side) sides.push_back({half_space, tree_->bvh().space()});
    const auto hidden = [&](const BoxOnScreen& box) { return --budget < 0 || is_hidden(box); };
    tree_->each_leaf(SeenOnScreen<decltype(hidden)>{screen, {sides}, hidden}, [&](Leaf leaf) {
      budget -= static_cast<int>(leaf.count);
      for (std::uint32_t i = 0; i < leaf.count; i += double_lanes)
        visit(leaf, i, first_bits(static_cast<int>(leaf.count - i)));
    });
    usable_ = budget >= 0;
  }

  /// Finds the closest triangle of each pixel.
  void find_nearest(const Screen& screen, const TileHalfSpaces& half_spaces) {
    clear();
    each_in_tile(
        screen, half_spaces, [&](const BoxOnScreen& box) { return is_hidden(box); },
        [&](Leaf leaf, std::uint32_t i, Bits there) {
          const auto corners = tree_->leaves().corners(leaf, i);
          const TrianglesOnScreen triangles(screen, corners);
          const Bits some = there & triangles.in_tile;
          if (some == 0) return;
          const auto first = static_cast<std::int32_t>(drawn_.size() * double_lanes);
          const Floats floors = drawn_.emplace_back(screen, corners, leaf, i).floors(screen, corners);
          for (const int k : lanes_in(some))
            draw_one(triangles, floors[k], static_cast<std::size_t>(k), first + k);
        });
    if (usable_) decide();
  }

  void clear() {
    Block empty;
    // The least float above 0 is a lower bound of any k > 0, and above the 0 of `other`.
    std::fill(std::begin(empty.far), std::end(empty.far), std::numeric_limits<float>::denorm_min());
    std::fill(std::begin(empty.near), std::end(empty.near), 0.0f),
        std::fill(std::begin(empty.other), std::end(empty.other), 0.0f);
    std::fill(std::begin(empty.nearest), std::end(empty.nearest), nothing);
    for (int y = 0; y < tile_.height(); y += PixelBlock::height)
      std::fill_n(&block(0, y), (tile_.width() + PixelBlock::width - 1) / PixelBlock::width, empty);
    drawn_.clear();
  }

  /// Returns true if no pixel can see anything in a box behind the triangles so far.
  [[nodiscard]] bool is_hidden(const BoxOnScreen& box) const {
    return PixelBlock::all_of(box, [&, nearest = Pixels(box.nearest)](int x, int y) {
      return (bits(Pixels::load(block(x, y).far) <= nearest) & PixelBlock::inside(box, x, y)) == 0;
    });
  }

  /// Rasterizes one triangle. `nearest` of a pixel is then surely in front of all triangles so far, except
  /// those that may be as near as `other`.
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

  /// Stores the visibility of each pixel: nothing, a triangle, or in doubt.
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
  std::array<Block, PixelBlock::in_tile> blocks_;
  std::array<std::int32_t, side * side> seen_{};
  std::vector<Planes> drawn_;  ///< indexed by `nearest`, one entry for each double_lanes triangles
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

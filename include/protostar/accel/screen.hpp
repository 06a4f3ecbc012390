// The picture of a pinhole camera around a tile, and the pixels of the tile that may see a box.
//
// The rays of a pinhole at o lead along D(x, y) = x e1 + y e2 + e3, x and y being pixels from the tile's
// middle and e3 the direction there. By the dual basis e1*, e2*, e3* a point, from o, has the coordinates
// (X, Y, Z), and is seen at (X/Z, Y/Z) if it is in front, Z > 0. It is o + D/k with k = 1/Z: the larger k,
// the nearer.
//
// Quantities of a tile are computed here in double. The volume of e1, e2, e3, as unit vectors, is above 1/16,
// so the roundings of these, of the dual basis, and of the rays' directions are below 2^-42 of the products
// of lengths: X, Y and Z of a point p, from o, are off by less than that part of |p| times the length of
// their own vector of the basis. Let γ be 2^-42 (|e1*| + |e2*| + T |e3*|), the tile's rays being in |x|, |y|
// ≤ T. Then X, Y and T Z are off by less than γ|p|.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "../bvh/box_space.hpp"
#include "../bvh/node.hpp"
#include "../bvh/traversal.hpp"
#include "../camera.hpp"
#include "../image.hpp"
#include "../pixel_grid.hpp"
#include "../simd/simd.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Map from points, in box space, to X, Y and Z.
struct Screen {
  bool usable = false;
  Point eye{0}, eye_in_box_space{0};
  double scale = 1;           ///< scale of box space
  Vec3 across, down, ahead;   ///< dual basis
  double reach, uncertainty;  ///< T and γ
  double longest;             ///< upper bound for the length of a direction in the tile
  int width, height;          ///< pixels of the tile
  double left, top;           ///< x and y of the sample in the tile's first pixel
  double pixels_of_all;       ///< estimate for all triangles, as a ball of radius √3 in box space

  Screen(const PixelRays& rays, int sample, const Tile& tile, const BoxSpace& space)
      : eye(rays.camera().position),
        eye_in_box_space(space(eye)),
        scale(space.scale),
        width(tile.width()),
        height(tile.height()) {
    const auto& [x0, y0, x1, y1] = tile;
    const PixelGrid& pixels = rays.pixels();
    const Camera& camera = rays.camera();
    const double half_width = 0.5 * width, half_height = 0.5 * height;
    const Vec3 e1 = (pixels.u(x1, 0) - pixels.u(x0, 0)) / width * camera.right,
               e2 = (pixels.v(y1, 0) - pixels.v(y0, 0)) / height * camera.up,
               e3 = pixels.u(x0, half_width) * camera.right + pixels.v(y0, half_height) * camera.up +
                    camera.forward;
    const double sizes = length(e1) * length(e2) * length(e3), volume = dot(cross(e1, e2), e3);
    // Float has to hold the quantities that are computed from them below.
    const auto is_moderate = [](double x) { return 0x1p-30 < x && x < 0x1p30; };
    // The terms of e3 are not much larger than e3, so its rounding is in proportion to its length.
    const double parts = length(pixels.u(x0, half_width) * camera.right) +
                         length(pixels.v(y0, half_height) * camera.up) + length(camera.forward);
    usable = rays.is_pinhole() && parts < 0x1p5 * length(e3) && is_moderate(length(e1)) &&
             is_moderate(length(e2)) && is_moderate(length(e3)) && std::abs(volume) > 0x1p-4 * sizes &&
             length(eye_in_box_space) < 0x1p40 && 0x1p-500 < scale && scale < 0x1p500;
    across = cross(e2, e3) / volume, down = cross(e3, e1) / volume, ahead = cross(e1, e2) / volume;
    reach = std::max(half_width, half_height) + rays.margin();
    longest = length(e3) + reach * (length(e1) + length(e2));
    uncertainty = 0x1p-42 * (length(across) + length(down) + reach * length(ahead));
    pixels_of_all = std::numbers::pi * 3 / dot(eye_in_box_space, eye_in_box_space) * dot(e3, e3) /
                    (length(e1) * length(e2));
    left = pixels.common_place(sample).x - half_width, top = pixels.common_place(sample).y - half_height;
  }
};

/// Pixels between two positions, of `count` pixels with their middles at 0, 1, ...: from `first` to before
/// `end`. The positions may be off by 2^-11.
template <int N>
struct PixelsBetween {
  Lanes<std::int32_t, N> first, end;
  Mask<float, N> any;  ///< true if there is any pixel

  PixelsBetween(const Lanes<float, N>& low, const Lanes<float, N>& high, int count) {
    const Lanes<float, N> all = static_cast<float>(count), none = 0.0f;
    // If a position is NaN, min and max choose so that no pixel is left out.
    const auto behind_first = to_whole(all - min(all, max(none, low - Lanes<float, N>(0x1p-10f))));
    first = Lanes<std::int32_t, N>(count) - behind_first;
    end = to_whole(max(none, min(all, high + Lanes<float, N>(1 + 0x1p-10f))));
    any = all - to_float(behind_first) < to_float(end);
  }
};

/// Pixels of a tile, of at most 255 a side, that may see anything in a box, from x0 to before x1 and from y0
/// to before y1, and the nearest k of the box.
struct BoxOnScreen {
  float nearest;  ///< upper bound for k
  std::uint8_t x0, x1, y0, y1;
};

/// Pixels that may see each box of a node, and the nearest k of each.
///
/// In float, with u = 2^-24, the ends of the boxes from o are off by 2u of themselves and 2^-47 |o|, for
/// which `size` has a part; the dual basis, products and sums add 5u. 2^-21 = 8u of sizes and of |e1*|, |e2*|
/// or |e3*| is subtracted from the least X, Y and Z in a box, and added to the largest. Quotients, products
/// and the tile's first pixel are off by less than 2^-16 of a pixel if that is in a tile. Z > 2^-100 is far
/// from underflow, and 1/Z from overflow.
class BoxesOnScreen {
 public:
  Bits seen;      ///< boxes that any pixel may see
  Bits in_front;  ///< boxes surely in front; pixels of other boxes are not known

  BoxesOnScreen(const Screen& screen, const Node& node) {
    NodeFloats ends[2][3], size = static_cast<float>(0x1p-24 * length(screen.eye_in_box_space));
    for (int axis = 0; axis < 3; ++axis) {
      const double o = screen.eye_in_box_space[axis];
      const auto high = static_cast<float>(o), low = static_cast<float>(o - high);
      for (int end = 0; end < 2; ++end)
        ends[end][axis] = (NodeFloats::load(node.end[end][axis]) - NodeFloats(high)) - NodeFloats(low);
      size += max(abs(ends[0][axis]), abs(ends[1][axis]));
    }
    struct Range {
      NodeFloats least, most;
    };
    const auto range_of = [&](const Vec3& f) {
      const NodeFloats error = NodeFloats(static_cast<float>(0x1p-21 * length(f))) * size;
      Range range{-error, error};
      for (int axis = 0; axis < 3; ++axis) {
        const NodeFloats factor = static_cast<float>(f[axis]);
        range.least += factor * ends[f[axis] < 0][axis], range.most += factor * ends[f[axis] > 0][axis];
      }
      return range;
    };
    const Range X = range_of(screen.across), Y = range_of(screen.down), Z = range_of(screen.ahead);
    const auto known = Z.least > NodeFloats(0x1p-100f);
    const NodeFloats most = NodeFloats(1.0f) / Z.least, least = NodeFloats(1.0f) / Z.most;
    const auto pixels = [&](const Range& range, double start, int count) {
      const NodeFloats first = static_cast<float>(start);
      const NodeFloats low = min(range.least * most, range.least * least) - first,
                       high = max(range.most * most, range.most * least) - first;
      return PixelsBetween<node_width>(select(known, low, 0.0f),
                                       select(known, high, static_cast<float>(count)), count);
    };
    const auto x = pixels(X, screen.left, screen.width), y = pixels(Y, screen.top, screen.height);
    const auto is_used = NodeFloats::load(node.end[0][0]) <= NodeFloats::load(node.end[1][0]);
    seen = bits(is_used && x.any && y.any), in_front = bits(known);
    x.first.store(x0_), x.end.store(x1_), y.first.store(y0_), y.end.store(y1_);
    select(known, NodeFloats(1 + 0x1p-20f) * most, std::numeric_limits<float>::infinity()).store(nearest_);
  }

  [[nodiscard]] BoxOnScreen operator[](int k) const {
    const auto small = [](std::int32_t number) { return static_cast<std::uint8_t>(number); };
    return {nearest_[k], small(x0_[k]), small(x1_[k]), small(y0_[k]), small(y1_[k])};
  }

 private:
  alignas(64) float nearest_[node_width];
  alignas(64) std::int32_t x0_[node_width], x1_[node_width], y0_[node_width], y1_[node_width];
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

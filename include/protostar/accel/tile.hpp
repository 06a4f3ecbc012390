// Culls the surfaces that the pixels of a tile may see: lists that get shorter from a tile to a smaller one.
//
// A surface is represented by a sphere that contains it. The rays of a tile lie between four planes; a
// surface outside one of them is not seen. This is tested in float, several surfaces at once, and drops a
// surface only if it is certainly outside.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "../bvh/box_space.hpp"
#include "../camera.hpp"
#include "../image.hpp"
#include "../interval.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "packet.hpp"
#include "pixel_rays.hpp"
#include "sphere_around.hpp"
#include "sphere_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Region that contains the rays of a tile: four planes, one for each side, as unit normals to the inside,
/// and a cone around the middle ray. They pass through the camera's apex; parallel rays have no apex and no
/// cone. The planes fit a tile better, and the cone tells the sky from a sphere that fills the view below it.
/// A normal that is not certain is 0, so that all points are inside.
struct Frustum {
  HalfSpace side[5];     ///< the four sides, and one that excludes what lies behind
  float normal[5][3];    ///< normals of the four sides, and the axis of the cone
  float offset[4] = {};  ///< normal · x for the points x of a side, measured from the apex
  float cosine, sine;    ///< cosine and sine of the cone's half-angle; 0 and 1 if not certain, or above 60°

  [[gnu::noinline]] Frustum(const PixelRays& rays, const Tile& tile) {
    const Camera& camera = rays.camera();
    const Point& apex = rays.viewpoint().apex;
    set(0, apex, rays.right_of(tile.x0));
    set(1, apex, -rays.right_of(tile.x1));
    set(2, apex, -rays.below(tile.y1));
    set(3, apex, rays.below(tile.y0));
    // Directions within an angle below 90° of an axis form a convex cone, so one that contains the corners'
    // rays contains all between them.
    const double us[] = {rays.pixels().u(tile.x0, 0), rays.pixels().u(tile.x1, 0)},
                 vs[] = {rays.pixels().v(tile.y0, 0), rays.pixels().v(tile.y1, 0)};
    const Vec3 middle =
        camera.direction(0.5 * (us[0] + us[1]) * camera.right, 0.5 * (vs[0] + vs[1]) * camera.up);
    double least_square = rays.hand() != 0 && !camera.is_orthographic() ? 1 : 0;  // squared cosine
    for (const double u : us)
      for (const double v : vs) {
        const Vec3 corner = camera.forward + u * camera.right + v * camera.up;
        const double along = std::max(0.0, dot(middle, corner));
        least_square = std::min(along * along / dot(corner, corner), least_square);  // NaN stays NaN
      }
    const double least = std::sqrt(least_square);
    const bool sure = least > 0.5;
    set(4, apex, least > 0.1 ? middle : Vec3{0});
    cosine = sure ? static_cast<float>(least) : 0;
    sine = sure ? static_cast<float>(std::sqrt(1 - least * least)) : 1;
    if (!rays.is_pinhole()) start_on_film(rays, camera(us[0], vs[0]).origin, camera(us[1], vs[1]).origin);
  }

 private:
  void set(int i, const Point& apex, const Vec3& inwards) {
    side[i] = {apex, inwards};
    for (int k = 0; k < 3; ++k) normal[i][k] = static_cast<float>(side[i].normal[k]);
  }

  /// Adapts the half-spaces to rays that start on a film, between two corners in this tile. The last
  /// half-space is then the one ahead of the film. Sides of parallel rays pass through a corner, each through
  /// one of the two; no candidate that float holds is as far out as 2^120. Every half-space is moved out by
  /// drift, by which candidates are larger.
  void start_on_film(const PixelRays& rays, const Point& upper_left, const Point& lower_right) {
    const Viewpoint& viewpoint = rays.viewpoint();
    side[4] = {viewpoint.film, viewpoint.ahead};
    if (rays.camera().is_orthographic())
      for (const int i : {0, 1, 2, 3}) {
        side[i].on = i == 0 || i == 3 ? upper_left : lower_right;
        const double from_apex = dot(side[i].normal, side[i].on - viewpoint.apex);
        offset[i] = static_cast<float>(std::clamp(from_apex, -0x1p120, 0x1p120));
      }
    for (HalfSpace& half_space : side) half_space.on -= viewpoint.drift * half_space.normal;
  }
};

/// Unit directions of a pinhole's packet in float, each component rounded once.
struct FloatDirections {
  Floats x, y, z;

  FloatDirections() = default;
  explicit FloatDirections(const Vectors& d) : x(to_float(d.x)), y(to_float(d.y)), z(to_float(d.z)) {}
};

/// Surfaces that a camera may see, as float spheres with centers measured from its apex; stored as one row
/// for each number, so that several are tested at once.
class Candidates {
 public:
  using Places = Lanes<std::uint32_t, double_lanes>;  ///< indices of surfaces in the scene's order

  [[nodiscard]] int size() const { return size_; }
  /// Returns the i-th surface's index in the scene's order.
  [[nodiscard]] int place(int i) const { return static_cast<int>(place_[index(i)]); }

  /// Returns a lower bound of t at which a camera ray of unit direction hits the i-th surface or,
  /// after order_by_distance(), any that follows it.
  [[nodiscard]] float nearest(int i) const { return nearest_[index(i)]; }

  /// Adds the surfaces of some lanes, each contained in a sphere, but for those wholly behind the film.
  ///
  /// A ray that meets a sphere still does when both are shifted. Hence a ray from the apex meets the sphere
  /// of that center whose radius r is larger by drift, which is the sphere from here on.
  ///
  /// With u = 2^-24: the center from the apex, l, is off by at most u|l| in float, a normal by u, and their
  /// product by 3u|l| more; in double, normals and rays have been turned by less than u. Hence the distance
  /// from a plane is accurate to 6u|l|, and the radius to u r. The margin added to the radius,
  /// 2^-20 (|l| + r) = 16u (|l| + r), is more; 2^-140 covers underflow. A sphere so large that the sums might
  /// overflow is taken to be everywhere. The distance of the center from the film, computed in double, is
  /// accurate to that margin as well.
  ///
  /// Seen from outside, the sphere has an angular radius ψ with sin ψ = r/|l|. A cone of half-angle φ around
  /// an axis a misses it if l is at more than φ + ψ from a, that is if
  ///   a·l < |l| cos(φ + ψ) = cos φ · h − sin φ · r   with the distance of the horizon h = √(|l|² − r²).
  /// |l|² − r² is accurate to 2^-50 (|l|² + r²), given |l| as it is computed. In float a·l is off by 6u|l|,
  /// each product by 3u (|l| + r), cos φ and sin φ by 2u of them; with cos φ > 1/2, reducing h by
  /// 2^-18 (|l| + r) = 64u (|l| + r) covers all of it.
  ///
  /// The sphere is met at no t below |l| − r, measured from the apex; a ray lacks at most the first `start`
  /// of that. Nor is it met at a t less than its distance from the film.
  void add(const Places& places, Bits some, const Viewpoint& viewpoint, const SpheresAround& around) {
    const Vectors l = around.center - Vectors(viewpoint.apex);
    const Doubles radius = around.radius + viewpoint.drift;
    const Doubles distance = length(l),
                  depth = dot(Vectors(viewpoint.ahead), around.center - Vectors(viewpoint.film));
    const Doubles error = 0x1p-20 * (distance + radius) + 0x1p-140;
    some &= bits(!(depth < -(radius + error)));
    make_room(size_ + double_lanes);
    const LaneMask fits = distance + radius + abs(depth) < 0x1p120;
    const auto store = [&](auto& row, const Doubles& numbers, double otherwise) {
      store_chosen(row.data() + size_, some, to_float(select(fits, numbers, Doubles(otherwise))));
    };
    store(x_, l.x, 0), store(y_, l.y, 0), store(z_, l.z, 0);
    store(reach_, radius + error, infinity);
    const Doubles square = distance * distance - radius * radius;
    const Doubles sure_square = square - 0x1p-49 * (distance * distance + radius * radius);
    store(horizon_, select(sure_square > 0.0, sqrt(sure_square) - 4 * error, Doubles(-infinity)), -infinity);
    store(nearest_, max(distance - viewpoint.start, depth) - radius - error, 0);
    size_ += store_chosen(place_.data() + size_, some, places);
  }
  void add(int place, const Viewpoint& viewpoint, const SphereAround& around) {
    add(Places(static_cast<std::uint32_t>(place)), Bits{1}, viewpoint, SpheresAround(around));
  }

  /// Adds those surfaces of another list that a tile may see, in their order.
  [[gnu::noinline]] void add(const Candidates& others, const Frustum& frustum) {
    make_room(size_ + others.size_);
    for (int i = 0; i < others.size_; i += float_lanes) {
      const auto at = [&](const auto& row) { return row.data() + i; };
      const Wide x = Wide::load(at(others.x_)), y = Wide::load(at(others.y_)), z = Wide::load(at(others.z_));
      const Wide reach = Wide::load(at(others.reach_));
      // NaN, which comes from numbers beyond float, is not outside.
      Mask<float, float_lanes> outside = false;
      for (int k = 0; k < 4; ++k) {
        const auto& n = frustum.normal[k];
        outside = outside || (x * n[0] + y * n[1] + z * n[2] < frustum.offset[k] - reach);
      }
      const auto& axis = frustum.normal[4];
      const Wide horizon = Wide::load(at(others.horizon_));
      outside = outside ||
                (x * axis[0] + y * axis[1] + z * axis[2] < horizon * frustum.cosine - reach * frustum.sine);
      const Bits seen = bits(!outside) & first_bits(others.size_ - i);
      if (seen == 0) continue;
      const auto to = [&](auto& row) { return row.data() + size_; };
      store_chosen(to(x_), seen, x);
      store_chosen(to(y_), seen, y);
      store_chosen(to(z_), seen, z);
      store_chosen(to(reach_), seen, reach);
      store_chosen(to(horizon_), seen, horizon);
      store_chosen(to(nearest_), seen, Wide::load(at(others.nearest_)));
      size_ += store_chosen(to(place_), seen, Lanes<std::uint32_t, float_lanes>::load(at(others.place_)));
    }
  }

  /// Returns which rays of a pinhole may hit the i-th surface, each at a t of at most `until`.
  ///
  /// b = d·l, at which a ray is nearest to the center, is accurate to 5u|l|, from d, l, three products and
  /// two sums; hence p = l − b d, from that point to the center, to 9u|l|, and |p|² to 3u of itself more. A
  /// ray that meets the sphere has |p| ≤ r and first meets it at b − r or later. The 16u (|l| + r) by which
  /// reach exceeds r cover all of that, and 2^-120 covers underflow of the squares. Raising `until` by 2^-22
  /// of it covers its rounding to float; if that underflows, the 2^-140 of reach do.
  [[nodiscard]] Mask<float, double_lanes> may_be_hit(int i, const FloatDirections& d,
                                                     const Doubles& until) const {
    const std::size_t at = index(i);
    const Floats x = x_[at], y = y_[at], z = z_[at];
    const float reach = reach_[at];
    const Floats b = d.x * x + d.y * y + d.z * z;
    const Floats px = x - b * d.x, py = y - b * d.y, pz = z - b * d.z;
    return px * px + py * py + pz * pz <= Floats(reach * reach + 0x1p-120f) && b >= Floats(-reach) &&
           b - Floats(reach) <= to_float(until) * Floats(1 + 0x1p-22f);
  }

  void clear() { size_ = 0; }

  /// Sorts by nearest(), roughly, near first; then lowers each nearest(i) to the least from i on.
  void order_by_distance() {
    constexpr std::size_t slabs = 256;
    float least = std::numeric_limits<float>::infinity(), most = 0;
    for (int i = 0; i < size_; ++i) least = std::min(least, nearest(i)), most = std::max(most, nearest(i));
    const float scale = (slabs - 1) / (most - least);
    const auto slab = [&](int i) {
      const float depth = (nearest(i) - least) * scale;
      return depth >= 0 && depth < slabs ? static_cast<std::size_t>(depth) : 0;  // 0 for NaN too
    };
    std::size_t start[slabs + 1] = {};
    for (int i = 0; i < size_; ++i) ++start[slab(i) + 1];
    for (std::size_t k = 0; k < slabs; ++k) start[k + 1] += start[k];
    std::vector<std::size_t> order(index(size_));
    for (int i = 0; i < size_; ++i) order[start[slab(i)]++] = index(i);
    reorder(order);
    for (int i = size_ - 2; i >= 0; --i)
      nearest_[index(i)] = std::min(nearest_[index(i)], nearest_[index(i + 1)]);
  }

  /// Sets all nearest() to 0, so that no surface is left out for its distance.
  void bring_near() { std::fill(nearest_.begin(), nearest_.end(), 0.0f); }

  /// Sorts by index in the scene's order.
  void order_by_place() {
    std::vector<std::size_t> order(index(size_));
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return place_[a] < place_[b]; });
    reorder(order);
  }

 private:
  using Wide = Lanes<float, float_lanes>;

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  /// Moves the order[i]-th surface to i.
  void reorder(const std::vector<std::size_t>& order) {
    const auto move = [&](auto& row) {
      auto moved = row;
      for (std::size_t i = 0; i < order.size(); ++i) moved[i] = row[order[i]];
      row = std::move(moved);
    };
    move(x_), move(y_), move(z_), move(reach_), move(horizon_), move(nearest_), move(place_);
  }

  /// Makes room for count surfaces, and for the lanes that a store of a whole vector writes behind them.
  void make_room(int count) {
    const std::size_t needed = index(count + float_lanes);
    if (x_.size() >= needed) return;
    const std::size_t room = std::max(needed, 2 * x_.size());
    for (auto* row : {&x_, &y_, &z_, &reach_, &horizon_, &nearest_}) row->resize(room);
    place_.resize(room);
  }

  int size_ = 0;
  std::vector<float> x_, y_, z_, reach_, horizon_, nearest_;
  std::vector<std::uint32_t> place_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Lists of the surfaces that the pixels of a tile may see; a part of the tile has a shorter list.
//
// A surface is represented by a sphere that contains it. The rays of a tile lie between four planes and in a
// cone; a surface outside of one of them is not seen. This is tested in float, several surfaces at once, and
// drops a surface only if it is certainly outside.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "../interval.hpp"
#include "../plain_vector.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "../simd/vectors.hpp"
#include "frustum.hpp"
#include "pixel_rays.hpp"
#include "sphere_around.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Sphere that contains a surface, in float, for tests of rays that start at the apex, as a pinhole's do
/// (visibility.hpp).
struct CandidateSphere {
  float x, y, z;  ///< center, measured from the apex (Viewpoint)
  float reach;    ///< radius, larger by what float may be off; infinite if float does not hold the sphere
  float inner;    ///< radius within which a line surely meets the surface; below 0 if there is none
  float margin;   ///< bound of the errors of tests along a ray, 2^-19 (distance + radius); infinite as reach
};

/// Positions of some surfaces in a list of Candidates, ascending.
class CandidatePositions {
 public:
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int operator[](int i) const { return positions_[static_cast<std::size_t>(i)]; }

  void clear() { size_ = 0; }

  /// Adds position + k for each bit k that is set, above all positions so far.
  void add(int position, Bits some) {
    const auto needed = static_cast<std::size_t>(size_ + float_lanes);
    if (positions_.size() < needed) positions_.resize(needed);
    size_ += store_chosen(positions_.data() + size_, some,
                          WideIndices(position) + iota<std::int32_t, float_lanes>());
  }

  /// Adds the positions 0 to count − 1.
  void add_first(int count) {
    for (int i = 0; i < count; i += float_lanes) add(i, first_bits(std::min(count - i, float_lanes)));
  }

 private:
  int size_ = 0;
  PlainVector<std::int32_t> positions_;
};

/// Surfaces that a camera or a tile may see, as spheres that contain them; stored as one row for each number,
/// so that several are tested at once. A surface without bounds has a sphere of infinite radius, and any tile
/// may see it.
class Candidates {
 public:
  [[nodiscard]] int size() const { return size_; }
  /// Returns the i-th surface's index in the scene's order.
  [[nodiscard]] int index(int i) const { return static_cast<int>(index_[slot(i)]); }

  /// Returns a lower bound, maybe below 0, of t in scene units at which a camera ray of unit direction hits
  /// the i-th surface or any that follows it, if the list is sorted near to far; 0 if not.
  [[nodiscard]] float nearest(int i) const { return is_near_to_far_ ? *address_of(row_nearest, i) : 0; }

  /// Returns index(i) of all surfaces.
  [[nodiscard]] std::span<const std::uint32_t> indices() const { return {index_.data(), slot(size_)}; }

  /// Adds the surfaces of some lanes, each contained in a sphere. Leaves out those wholly behind the film or
  /// the lens, if its normal is certain: none for a pinhole, as for any viewpoint with ahead = 0.
  void add(const SurfaceIndices& indices, Bits some, const Viewpoint& viewpoint,
           const SpheresAround& around) {
    // A ray that meets a sphere still does when both are shifted, and a true ray, shifted by at most drift,
    // is a part of one from the apex (Viewpoint; parallel rays have none). Hence a ray from the apex meets
    // the sphere with the radius `own` = around.radius + drift wherever the true ray meets the surface. For a
    // lens, the frustum is that of the rays through its center, and the part of a ray that meets a sphere is
    // shifted by drift_of_lens at most besides: `radius` = own + drift_of_lens. The frustum and the cone are
    // tested with `radius`, which is r below; nearest() and what is behind the film are computed with `own`.
    //
    // With u = 2^-24: the center from the apex, l, is off by at most u|l| in float, a normal by u, and their
    // product by 3u|l| more; in double, normals and rays have been turned by less than u. Hence the distance
    // from a plane is accurate to 6u|l|, and the radius to u r. The radius is raised by `error`,
    // 2^-20 (|l| + r) = 16u (|l| + r), which is more, and a little further as lines in float need it
    // (visibility.hpp); 2^-140 covers underflow. A sphere so large that the sums might overflow is taken to
    // be everywhere. The distance of the center from the film, computed in double, is accurate to that as
    // well.
    //
    // Seen from outside, the sphere has an angular radius ψ with sin ψ = r/|l|. A cone of half-angle φ around
    // an axis a misses it if l is at more than φ + ψ from a, that is if
    //   a·l < |l| cos(φ + ψ) = cos φ · h − sin φ · r   with the distance of the horizon h = √(|l|² − r²).
    // |l|² − r² is accurate to 2^-50 (|l|² + r²), given |l| as it is computed. In float a·l is off by 6u|l|,
    // each product by 3u (|l| + r), cos φ and sin φ by 2u of them; with cos φ > 1/2, reducing h by
    // 2^-18 (|l| + r) = 64u (|l| + r) covers all of it.
    //
    // A ray that starts at the apex meets the sphere at no t below |l| − r; one that starts on a film, at no
    // t below the sphere's distance from the film.
    //
    // There is no inner radius if the apex may be inside the sphere, or if squares might leave the range of
    // float.
    const Vectors l = around.center - Vectors(viewpoint.apex);
    const Doubles distance = length(l),
                  depth = dot(Vectors(viewpoint.ahead), around.center - Vectors(viewpoint.film));
    const Doubles own = around.radius + viewpoint.drift;
    const Doubles radius =
        viewpoint.lens_radius > 0 ? own + viewpoint.drift_of_lens(depth, distance, own) : own;
    const Doubles error = 0x1p-20 * (distance + radius) + 0x1p-140;
    some &= bits(!(depth < -(own + error)));
    make_room(size_ + double_lanes);
    const LaneMask fits = distance + radius + abs(depth) < 0x1p120;
    const auto store = [&](Row row, const Doubles& numbers, double otherwise) {
      store_chosen(address_of(row, size_), some, to_float(select(fits, numbers, Doubles(otherwise))));
    };
    store(row_x, l.x, 0), store(row_y, l.y, 0), store(row_z, l.z, 0);
    const Doubles along = 0x3p-20 * distance;
    store(row_reach, sqrt((radius + error) * (radius + error) + along * along), infinity);
    const Doubles square = distance * distance - radius * radius;
    const Doubles sure_square = square - 0x1p-49 * (distance * distance + radius * radius);
    store(row_horizon, select(sure_square > 0.0, sqrt(sure_square) - 4 * error, Doubles(-infinity)),
          -infinity);
    store(row_nearest, (viewpoint.is_pinhole ? distance : depth) - own - error, 0);
    store(row_margin, 2 * error, infinity);
    const Doubles inner = around.inner - error;
    const LaneMask is_sure = inner > 0x1p-60 && inner < 0x1p60 && distance > radius + error;
    store(row_inner, select(is_sure, inner, Doubles(-1.0)), -1);
    size_ += store_chosen(index_.data() + size_, some, indices);
  }
  /// Adds one surface, unless it is wholly behind the film.
  void add(int index, const Viewpoint& viewpoint, const SphereAround& around) {
    add(SurfaceIndices(static_cast<std::uint32_t>(index)), Bits{1}, viewpoint, SpheresAround(around));
  }

  /// Adds those surfaces of another list that a tile may see, in their order. Precondition: this list is
  /// empty.
  [[gnu::noinline]] void add(const Candidates& others, const Frustum& frustum) {
    is_near_to_far_ = others.is_near_to_far_;
    make_room(size_ + others.size_);
    others.each_seen(frustum, [&](int i, Bits seen) {
      for (int row = 0; row < row_count; ++row)
        store_chosen(address_of(Row(row), size_), seen, WideFloats::load(others.address_of(Row(row), i)));
      size_ += store_chosen(index_.data() + size_, seen,
                            Lanes<std::uint32_t, float_lanes>::load(others.index_.data() + i));
    });
  }

  /// Replaces `found` by the positions in this list, ascending, of the surfaces that a tile may see.
  [[gnu::noinline]] void find(const Frustum& frustum, CandidatePositions& found) const {
    found.clear();
    each_seen(frustum, [&](int i, Bits seen) { found.add(i, seen); });
  }

  /// Returns the sphere around the i-th surface.
  [[nodiscard]] CandidateSphere sphere(int i) const {
    return {*address_of(row_x, i),     *address_of(row_y, i),     *address_of(row_z, i),
            *address_of(row_reach, i), *address_of(row_inner, i), *address_of(row_margin, i)};
  }

  /// Returns true if all rays of a pinhole in a frustum surely meet the i-th surface, by the frustum's cone.
  ///
  /// A ray meets a sphere of angular radius ψ if it is at less than ψ from its center l. Rays at up to φ ≤ ψ
  /// from an axis a all do if l is at less than ψ − φ from a, that is if
  ///   a·l > |l| cos(ψ − φ) = h cos φ + i sin φ   with the inner radius i = |l| sin ψ and h = √(|l|² − i²).
  /// With u = 2^-24: l and a are off by u|l| and u in float, and rays have been turned by less than u, so a·l
  /// is off by 3u|l|. For |l| stands a number that is not below it, since h grows with it. cos φ and sin φ
  /// are off by 2u, and their products by 2u (|l| + i). The margin, 32u (|l| + r), covers all of these.
  [[nodiscard]] bool fills(int i, const Frustum& frustum) const {
    const CandidateSphere s = sphere(i);
    const double x = s.x, y = s.y, z = s.z, inner = s.inner, margin = s.margin;
    const auto& axis = frustum.cone_axis;
    const double square = (x * x + y * y + z * z) * (1 + 0x1p-20);
    const double horizon = std::sqrt(square - inner * inner);
    return inner - margin > std::sqrt(square) * frustum.sine &&
           axis[0] * x + axis[1] * y + axis[2] * z - margin >
               horizon * frustum.cosine + inner * frustum.sine;  // NaN fills nothing
  }

  /// Returns true if any ray may hit the i-th surface, as it has no bounds, or none that float holds.
  [[nodiscard]] bool is_everywhere(int i) const { return !(*address_of(row_reach, i) < infinity); }

  void clear() { size_ = 0, is_near_to_far_ = false; }

  /// Order of a list: near to far, roughly, in 256 steps of nearest(); or by the surfaces' indices.
  enum class Order { near_to_far, of_scene };

  /// Sorts the list, so that nearest() returns bounds, or 0 in the scene's order.
  void sort(Order order) { order == Order::near_to_far ? order_by_distance() : order_by_index(); }

 private:
  /// Numbers of a surface, a row for each: those of CandidateSphere, h, and nearest().
  enum Row { row_x, row_y, row_z, row_reach, row_inner, row_margin, row_horizon, row_nearest, row_count };

  /// Calls visit(i, seen) for each group of float_lanes surfaces that the frustum does not cull entirely: i
  /// is the position of the first, and bit k of `seen` is set if surface i + k may be seen.
  [[gnu::always_inline]] void each_seen(const Frustum& frustum, const auto& visit) const {
    for (int i = 0; i < size_; i += float_lanes) {
      const auto load = [&](Row row) { return WideFloats::load(address_of(row, i)); };
      const WideFloats x = load(row_x), y = load(row_y), z = load(row_z), r = load(row_reach);
      const auto along = [&](const Frustum::Normal& n) {
        return fused_or_not(z, WideFloats(n[2]), fused_or_not(y, WideFloats(n[1]), x * n[0]));
      };
      // NaN, which comes from numbers beyond float, is not outside.
      WideMask outside = false;
      for (int k = 0; k < 4; ++k) outside = outside || along(frustum.side[k]) < frustum.offset[k] - r;
      if (frustum.has_cone())
        outside = outside || along(frustum.cone_axis) < load(row_horizon) * frustum.cosine - r * frustum.sine;
      const Bits seen = bits(!outside) & first_bits(size_ - i);
      if (seen != 0) visit(i, seen);
    }
  }

  /// Returns where a number of the i-th surface is stored, and behind it those of the surfaces that follow.
  [[nodiscard]] float* address_of(Row row, int i) { return rows_[row].data() + i; }
  [[nodiscard]] const float* address_of(Row row, int i) const { return rows_[row].data() + i; }

  /// Sorts by nearest(), roughly, near first; then lowers each nearest(i) to the least from i on.
  void order_by_distance() {
    is_near_to_far_ = true;
    float least = std::numeric_limits<float>::infinity(), most = 0;
    for (int i = 0; i < size_; ++i) least = std::min(least, nearest(i)), most = std::max(most, nearest(i));
    const float scale = (buckets - 1) / (most - least);
    const auto bucket = [&](std::uint32_t i) {
      const float depth = (nearest(static_cast<int>(i)) - least) * scale;
      return depth >= 0 && depth < buckets ? static_cast<std::size_t>(depth) : 0;  // 0 for NaN too
    };
    start_order();
    sort_by(bucket);
    reorder();
    for (int i = size_ - 2; i >= 0; --i) *address_of(row_nearest, i) = std::min(nearest(i), nearest(i + 1));
  }

  void order_by_index() {
    is_near_to_far_ = false;
    start_order();
    for (int byte = 0; byte < 4; ++byte)
      sort_by([&](std::uint32_t i) { return index_[i] >> (8 * byte) & 255; });
    reorder();
  }

  static constexpr std::size_t buckets = 256;

  /// Sets order_ to the order that the surfaces have.
  void start_order() {
    order_.resize(slot(size_));
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint32_t>(i);
  }

  /// Sorts order_ by bucket_of(position) < buckets; positions in the same bucket keep their order.
  void sort_by(const auto& bucket_of) {
    std::uint32_t start[buckets + 1] = {};
    for (const std::uint32_t i : order_) ++start[bucket_of(i) + 1];
    for (std::size_t k = 0; k < buckets; ++k) start[k + 1] += start[k];
    sorted_.resize(order_.size());
    for (const std::uint32_t i : order_) sorted_[start[bucket_of(i)]++] = i;
    std::swap(order_, sorted_);
  }

  static std::size_t slot(int i) { return static_cast<std::size_t>(i); }

  /// Moves the order_[i]-th surface to i.
  void reorder() {
    const auto move = [&](auto& row, auto& moved) {
      moved.resize(row.size(), 0);  // whole vectors are read, also behind the last surface
      for (std::size_t i = 0; i < order_.size(); ++i) moved[i] = row[order_[i]];
      std::swap(row, moved);
    };
    for (auto& row : rows_) move(row, moved_row_);
    move(index_, sorted_);
  }

  /// Makes room for count ≥ 1 surfaces, and for the lanes that loads and stores of a whole vector, from the
  /// last surface on, have behind it.
  void make_room(int count) {
    const std::size_t needed = slot(count + float_lanes - 1);
    if (index_.size() >= needed) return;
    const std::size_t room = std::max(needed, 2 * index_.size());
    for (auto& row : rows_) row.resize(room, 0);
    index_.resize(room, 0);
  }

  int size_ = 0;
  bool is_near_to_far_ = false;  ///< true if nearest() is that of row_nearest
  PlainVector<float> rows_[row_count];
  PlainVector<std::uint32_t> index_;

  /// Buffers of sort().
  PlainVector<std::uint32_t> order_, sorted_;
  PlainVector<float> moved_row_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

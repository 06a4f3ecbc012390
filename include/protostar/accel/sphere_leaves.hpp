// The spheres in the leaves of a BVH, tested in float: which a ray surely misses, and which it surely meets.
//
// In box space let o be the origin of a ray, l = c − o for the center c of a sphere, and d the direction, of
// length 1. With u = 2^-24, what sphere_filter.hpp computes is off by at most
//
//   l   rounding the center, the origin and the difference: u (|c| + |o| + |l|) ≤ 2u (|o| + |l|)
//   b   the error of l, u |l| for that of d, 3u |l| for products and sums: u (2|o| + 6|l|)
//   p   the errors of l and b, u |l| for d, the product and the difference: u (4|o| + 11|l|)
//
// A line that meets the sphere, or seems to in float, has |l| ≤ |b| + r, these errors apart. Hence the errors
// of b and p are together at most u (6|o| + 17|b| + 17r), and e = 32u (|o| + |b| + r) leaves 15u of each term
// for the rounding of r, of squares and of sums. So the reach is R = r + e, the inner radius i = r − e, and
// the margin m = e. That p is off by less than e/2, and what follows for R and i, is proved in
// tests/proofs/leaves.gappa and leaves_radii.gappa.
//
// A ray that starts inside of a sphere or on it has a lower bound of the first hit that is not above 0, since
// its line meets the sphere at a t ≤ 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "../bvh/bvh.hpp"
#include "../bvh/node.hpp"
#include "../plain_vector.hpp"
#include "../simd/prefetch.hpp"
#include "../surfaces/sphere.hpp"
#include "packet.hpp"
#include "sphere_around.hpp"
#include "sphere_filter.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Spheres of the leaves of a BVH, as rows of floats in box space.
class SphereLeaves {
 public:
  /// Copies the spheres of a tree: sphere_of(i) is the i-th, which has bounds.
  SphereLeaves(const Bvh& bvh, const auto& sphere_of, const RenderOptions& options)
      : rows_(4 * bvh.order().size() + static_cast<std::size_t>(float_lanes)) {
    std::fill_n(rows_.end() - float_lanes, float_lanes, 0.0f);  // padding, read behind the last sphere
    const auto fill = [&](Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const auto& sphere = sphere_of(bvh.order()[leaf.first + i]);
        const Point center = bvh.space()(sphere.center);
        float* const row = &rows_[4 * std::size_t{leaf.first} + i];
        row[0] = static_cast<float>(center.x);
        row[leaf.count] = static_cast<float>(center.y);
        row[2 * leaf.count] = static_cast<float>(center.z);
        row[3 * leaf.count] = static_cast<float>(std::abs(sphere.radius) * bvh.space().scale);
      }
    };
    bvh.each_leaf(fill, options);
  }

  /// Prefetches the first of a leaf's numbers, or all.
  void fetch(Leaf leaf) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first}];
    prefetch(row);
    prefetch(row + 16);
  }
  void fetch_all(Leaf leaf) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first}];
    for (std::uint32_t i = 0; i < 4 * leaf.count + 15; i += 16) prefetch(row + i);
  }

  /// Returns how a ray passes the spheres from the i-th of a leaf on, as many as a vector holds; lanes behind
  /// the last of the leaf are of no sphere. A Reach is up to 2^-19 of itself wider than the range that it
  /// stands for (BoxRay): to ask what is surely within the range, narrow it by more.
  [[nodiscard, gnu::always_inline]] SpherePass pass(Leaf leaf, std::uint32_t i, const BoxRay& ray) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const auto from_origin = [&](int axis) {
      return WideFloats::load(row + static_cast<std::uint32_t>(axis) * leaf.count) -
             WideFloats(ray.origin[axis]);
    };
    const LinePass line({ray.direction[0], ray.direction[1], ray.direction[2]},
                        {from_origin(0), from_origin(1), from_origin(2)});
    const WideFloats r = WideFloats::load(row + 3 * leaf.count);
    const WideFloats e = fused_or_not(WideFloats(0x1p-19f), abs(line.along) + r,
                                      WideFloats(0x1p-19f * ray.distance + ray.widening));
    return {line, r + e, r - e, e};
  }
  /// Returns which spheres, from the i-th of a leaf on, may reach into every one of the half-spaces.
  [[nodiscard]] Bits within(Leaf leaf, std::uint32_t i, std::span<const BoxHalfSpace> half_spaces) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const WideFloats x = WideFloats::load(row), y = WideFloats::load(row + leaf.count),
                     z = WideFloats::load(row + 2 * leaf.count), r = WideFloats::load(row + 3 * leaf.count);
    WideMask within = true;
    for (const auto& [normal, from] : half_spaces)
      within =
          within && !(x * WideFloats(normal[0]) + y * WideFloats(normal[1]) + z * WideFloats(normal[2]) + r <
                      WideFloats(from));  // NaN is not outside
    return bits(within) & first_bits(static_cast<int>(leaf.count - i));
  }

  /// Returns spheres in world space that surely contain those from the i-th of a leaf on, with inner ones
  /// that these surely contain. A float is off by 2^-24 of itself or by 2^-150, and the center in the world
  /// by two roundings of double.
  [[nodiscard]] SpheresAround around(Leaf leaf, std::uint32_t i, const BoxSpace& space) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const auto load = [&](std::uint32_t k) { return to_double(Floats::load(row + k * leaf.count)); };
    const Vectors c{load(0), load(1), load(2)};
    const double unit = 1 / space.scale;  // exact: a power of two
    const Doubles r = load(3), size = abs(c.x) + abs(c.y) + abs(c.z);
    const Vectors center = Vectors(space.center) + c * Doubles(unit);
    const Doubles error =
        (0x1p-23 * (r + size) + 0x1p-140) * unit + 0x1p-50 * (abs(center.x) + abs(center.y) + abs(center.z));
    return {center, r * unit + error, r * unit - error};
  }

 private:
  /// Numbers of each leaf, from 4 · first on: all x, all y, all z of the centers, and the radii.
  PlainVector<float> rows_;
};

/// Spheres few enough that testing them all in double, as many at once as a vector holds, is faster than a
/// search of the tree in float.
class FewSpheres {
 public:
  static constexpr std::size_t most = 8;

  explicit FewSpheres(const SceneVector<Sphere>& spheres) : count_(spheres.size()) {
    for (std::size_t i = 0; i < std::min(count_, most); ++i) {
      const auto& [center, radius] = spheres[i];
      x_[i] = center.x, y_[i] = center.y, z_[i] = center.z, r_[i] = std::abs(radius);
    }
  }

  /// Returns true if it holds all spheres that there are.
  [[nodiscard]] bool has_all() const { return count_ <= most; }

  /// Returns the spheres that the ray does not surely miss, by the bounds of its equation. A sphere that the
  /// ray departs from is always among them: its departure decides, not the digits of its origin.
  /// Precondition: has_all().
  [[nodiscard]] Bits met(const Ray& ray, const Interval& range) const {
    Bits met = 0;
    for (std::size_t i = 0; i < count_; i += double_lanes) {
      const auto load = [&](const double* numbers) { return Doubles::load(numbers + i); };
      const Vectors center{load(x_), load(y_), load(z_)};
      const Doubles r = load(r_);
      const auto e = sphere_equation(ray, center, r);
      auto missed = e.surely_misses();
      if (range.min >= 0) missed = missed || surely_recedes(e);
      if (ray.departure.kind == Departure::Kind::sphere) {
        const auto& [x, y, z, radius] = ray.departure.geometry;
        missed = missed && !(center.x == x && center.y == y && center.z == z && r == radius);
      }
      met |= bits(!missed) << i;
    }
    return met & first_bits(static_cast<int>(count_));
  }

 private:
  std::size_t count_ = 0;
  alignas(64) double x_[most] = {}, y_[most] = {}, z_[most] = {}, r_[most] = {};
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

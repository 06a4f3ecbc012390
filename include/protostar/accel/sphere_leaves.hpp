// The spheres of a tree's leaves in float, and which of them a ray surely misses.
//
// In box space let l = center − origin and d the direction, of length 1. The line passes the center at the
// distance b = d·l from the origin, and at p = l − b d from the center. It meets the sphere where |p| ≤ r,
// from b − √(r² − p²) to b + √(r² − p²). In float, with u = 2^-24 and o the origin:
//
//   l   rounding the center, the origin and the difference: u (|c| + |o| + |l|) ≤ 2u (|o| + |l|)
//   b   the same, u |l| for that of d, 3u |l| for products and sums: u (2|o| + 6|l|)
//   p   the errors of l and b, u |l| for d, the product and the difference: u (4|o| + 11|l|)
//
// A line that meets the sphere has |l| ≤ |b| + r. So with e = 16u (|o| + |b| + r) and R = r + e, the 5u left
// being for squares, sums and the rounding of r, it has p² ≤ R²; it meets the sphere nowhere before b − √(R²
// − p²) − e or after b + √(R² − p²) + e.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "bvh.hpp"
#include "sphere_around.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

class SphereLeaves {
 public:
  using Floats = Lanes<float, float_lanes>;

  /// The spheres that may be met, by their place from a leaf's first on, and no nearer than where.
  struct Met {
    Bits spheres;
    Floats near;
  };

  SphereLeaves() = default;
  SphereLeaves(const Bvh& bvh, const auto& sphere_of)
      : rows_(4 * bvh.order().size() + static_cast<std::size_t>(float_lanes)) {
    bvh.each_leaf([&](Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const auto& sphere = sphere_of(bvh.order()[leaf.first + i]);
        const Point center = bvh.space()(sphere.center);
        float* const row = &rows_[4 * std::size_t{leaf.first} + i];
        row[0] = static_cast<float>(center.x);
        row[leaf.count] = static_cast<float>(center.y);
        row[2 * leaf.count] = static_cast<float>(center.z);
        row[3 * leaf.count] = static_cast<float>(std::abs(sphere.radius) * bvh.space().scale);
      }
    });
  }

  void fetch(Leaf leaf) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first}];
    prefetch(row);
    prefetch(row + 16);
  }

  /// Of the spheres from the i-th of a leaf on, as many as a vector holds.
  [[nodiscard]] Met met(Leaf leaf, std::uint32_t i, const BoxRay& ray, Reach reach) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const Floats dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
    const Floats lx = Floats::load(row) - Floats(ray.origin[0]);
    const Floats ly = Floats::load(row + leaf.count) - Floats(ray.origin[1]);
    const Floats lz = Floats::load(row + 2 * leaf.count) - Floats(ray.origin[2]);
    const Floats r = Floats::load(row + 3 * leaf.count);
    const Floats b = dx * lx + dy * ly + dz * lz;
    const Floats px = lx - b * dx, py = ly - b * dy, pz = lz - b * dz;
    const Floats e = Floats(0x1p-20f) * (abs(b) + r) + Floats(ray.margin);
    const Floats R = r + e, q = R * R - (px * px + py * py + pz * pz);
    Bits spheres = bits(q >= Floats(0)) & all_below(leaf.count - i);
    if (spheres == 0) return {0, {}};
    const Floats s = sqrt(q), near = b - s - e, far = b + s + e;
    return {spheres & bits(near <= Floats(reach.until) && far >= Floats(reach.from)), near};
  }

  /// A sphere that surely contains the i-th of a leaf. A float is off by a part 2^-24 or by 2^-150, and the
  /// center in the world by two roundings of double.
  [[nodiscard]] SphereAround around(Leaf leaf, std::uint32_t i, const BoxSpace& space) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const Vec3 c{row[0], row[leaf.count], row[2 * leaf.count]};
    const double r = row[3 * leaf.count], size = std::abs(c.x) + std::abs(c.y) + std::abs(c.z);
    const double unit = 1 / space.scale;  // exact: a power of two
    const Point center = space.center + c * unit;
    const double rounding = 0x1p-50 * (std::abs(center.x) + std::abs(center.y) + std::abs(center.z));
    return {center, (r + 0x1p-23 * (r + size) + 0x1p-140) * unit + rounding};
  }

 private:
  /// The lanes below the n-th.
  static Bits all_below(std::uint32_t n) { return n < 32 ? (Bits{1} << n) - 1 : ~Bits{0}; }

  /// Of each leaf, from 4 · first on: all x, all y, all z of the centers, and the radii.
  std::vector<float> rows_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

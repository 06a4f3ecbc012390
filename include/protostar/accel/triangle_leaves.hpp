// The triangles of a tree's leaves in float: which of them a ray surely misses.
//
// In box space, where no coordinate is larger than 1, let o be the origin and d the direction, of length 1.
// With the edges u = b − a and v = c − a, w = a − o and m = w × d, the line passes the edges on the sides
// (numeric/triangle_roots.hpp)
//
//   side(a, b) = −u·m,   side(c, a) = v·m,   side(b, c) = (u × v)·d − side(a, b) − side(c, a)
//
// and misses the triangle where one of them is positive and another negative. In float, with h = 2^-24, U and
// V the sums of the sizes of the components of u and v, O that of o, and r = 1 + O, which no component of w
// exceeds:
//
//   w         each component: rounding a, o and the difference: 2h r
//   m         those of w, h r for that of d, and the products, times |d_i| + |d_j| ≤ √2; the difference:
//             (4√2 + √2) h r < 8h r
//   u·m, v·m  those of m, and 2√2 h r for those of u or v and the products; two sums: 13h r U and 13h r V
//   u × v·d   edges, products, difference, d, the product and two sums: 9h U V
//
// So side(b, c) has at most 13h r (U + V) + 9h U V, and 2h of all its parts, √2 r (U + V) + U V, for its own
// two roundings: less than 16h r (U + V + U V). The bound used is 2^-19 = 32h of that, which leaves as much
// for its own roundings, and 2^-120, which is far above whatever underflows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "../vec3.hpp"
#include "bvh.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

class TriangleLeaves {
 public:
  using Floats = Lanes<float, float_lanes>;

  /// Of triangles with points a, b and c.
  TriangleLeaves(const Bvh& bvh, const auto& triangle_of)
      : rows_(rows * bvh.order().size() + static_cast<std::size_t>(float_lanes)) {
    bvh.each_leaf([&](Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const auto& triangle = triangle_of(bvh.order()[leaf.first + i]);
        // The edges are rounded once more than a is, which is nothing to float.
        const Point a = bvh.space()(triangle.a);
        const Vec3 u = (triangle.b - triangle.a) * bvh.space().scale,
                   v = (triangle.c - triangle.a) * bvh.space().scale;
        const auto size = [](const Vec3& w) { return std::abs(w.x) + std::abs(w.y) + std::abs(w.z); };
        const double numbers[rows] = {a.x, a.y, a.z, u.x, u.y,
                                      u.z, v.x, v.y, v.z, size(u) + size(v) + size(u) * size(v)};
        float* const row = &rows_[rows * std::size_t{leaf.first} + i];
        for (std::size_t k = 0; k < rows; ++k) row[k * leaf.count] = static_cast<float>(numbers[k]);
      }
    });
  }

  /// What fetches the numbers of a leaf that is likely to be visited soon.
  [[nodiscard]] auto soon() const {
    return [this](Leaf leaf) {
      const float* const row = &rows_[rows * std::size_t{leaf.first}];
      for (std::size_t i = 0; i < rows * leaf.count; i += 16) prefetch(row + i);
    };
  }

  /// Those from the i-th of a leaf on, as many as a vector holds, that a line does not surely miss.
  [[nodiscard]] Bits met(Leaf leaf, std::uint32_t i, const BoxRay& ray) const {
    const float* const row = &rows_[rows * std::size_t{leaf.first} + i];
    const auto load = [&](std::size_t k) { return Floats::load(row + k * leaf.count); };
    const Floats dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
    const Floats wx = load(0) - Floats(ray.origin[0]), wy = load(1) - Floats(ray.origin[1]),
                 wz = load(2) - Floats(ray.origin[2]);
    const Floats ux = load(3), uy = load(4), uz = load(5), vx = load(6), vy = load(7), vz = load(8);
    const Floats mx = wy * dz - wz * dy, my = wz * dx - wx * dz, mz = wx * dy - wy * dx;
    const Floats slope = (uy * vz - uz * vy) * dx + (uz * vx - ux * vz) * dy + (ux * vy - uy * vx) * dz;
    const Floats ab = -(ux * mx + uy * my + uz * mz), ca = vx * mx + vy * my + vz * mz, bc = slope - ab - ca;
    const Floats error = load(9) * Floats(0x1p-19f * (1 + ray.distance)) + Floats(0x1p-120f);
    const Floats most = max(max(ab, ca), bc), least = min(min(ab, ca), bc);
    return bits(!(most > error && least < -error)) & first_bits(static_cast<int>(leaf.count - i));
  }

 private:
  /// Of each leaf, from rows · first on: all a.x, all a.y, ... of a, u and v, and the sizes U + V + U V.
  static constexpr std::size_t rows = 10;
  std::vector<float> rows_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

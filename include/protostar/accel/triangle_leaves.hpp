// The triangles of a tree's leaves in float: which of them a ray surely misses, which it surely crosses, and
// where.
//
// In box space, where no coordinate is larger than 1, let o be the origin and d the direction, of length 1.
// With the edges u = b − a and v = c − a, n = u × v, w = a − o and m = w × d, the line passes the edges on
// the sides (numeric/triangle_roots.hpp)
//
//   side(a, b) = −u·m,   side(c, a) = v·m,   side(b, c) = n·d − side(a, b) − side(c, a)
//
// It misses the triangle where one of them is positive and another negative, and crosses it where all have
// one sign, at t = n·w / n·d. u, v and n may be divided by one number, which is U + V + U V here, U and V
// being the sums of the sizes of the components of u and v; N is that of n, after the division. In float,
// with h = 2^-24, O the sum of sizes of o, and r = 1 + O, which no component of w exceeds:
//
//   w         each component: rounding a, o and the difference: 2h r
//   m         those of w, h r for that of d, and the products, times |d_i| + |d_j| ≤ √2; the difference:
//             (4√2 + √2) h r < 8h r
//   u·m, v·m  those of m, and 2√2 h r for those of u or v and the products; two sums: 13h r U and 13h r V
//   n·d       n, d, the product and two sums: 5h N, and N ≤ 2 U V
//   n·w       n, w, the product and two sums: 6h r N
//
// So side(b, c) has at most 13h r (U + V) + 10h U V, and 2h of all its parts, √2 r (U + V) + 2 U V, for its
// own two roundings: less than 16h r (U + V + U V), which is 16h r after the division. The bound used is 32h
// r = 2^-19 r, which leaves as much for its own roundings, and is far above whatever underflows.
//
// Where S = |n·d| is more than 2^-19 N, which has an error e ≤ 8h N ≤ S/4, and H = n·w one of at most 8h r N,
//
//   |H/S − t| ≤ (8h r N + e |t|) / S   with   |t| ≤ 4/3 (|H| + 8h r N) / S
//
// so that t is off by at most 12h (r + |H/S|) N / S. The quotient, which is a product with 1/S, is rounded by
// 2h of itself, where N / S ≥ 1 − 8h as d has length 1. The bound used is 2^-20 (r + |H/S|) N / S, 16h, and
// the rest is for its own roundings. For N > 2^-100 what underflows adds nothing to speak of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

#include "../vec3.hpp"
#include "bvh.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

class TriangleLeaves {
 public:
  using Floats = Lanes<float, float_lanes>;

  /// Triangles by their place from a leaf's first on.
  struct Crossed {
    Bits maybe, surely;  ///< crossed within a reach at all; and between near and far
    Floats near, far;    ///< what is crossed is crossed no nearer than near

    /// Whether one is surely crossed before the reach's end, which is 2^-20 too far at most.
    [[nodiscard]] bool any_surely_before(float until) const {
      return (surely & bits(far < Floats(until * (1 - 0x1p-18f)))) != 0;
    }
  };

  /// Of triangles with points a, b and c, by their places in the leaves.
  TriangleLeaves(const Bvh& bvh, const auto& triangle_at, const RenderOptions& options)
      : rows_(std::make_unique_for_overwrite<float[]>(rows * bvh.order().size() + float_lanes)) {
    const auto fill = [&](Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const auto& triangle = triangle_at(leaf.first + i);
        // The edges are rounded once more than a is, which is nothing to float.
        const Point a = bvh.space()(triangle.a);
        const Vec3 u = (triangle.b - triangle.a) * bvh.space().scale,
                   v = (triangle.c - triangle.a) * bvh.space().scale, n = cross(u, v);
        const auto size = [](const Vec3& w) { return std::abs(w.x) + std::abs(w.y) + std::abs(w.z); };
        const double all = size(u) + size(v) + size(u) * size(v), unit = all > 0x1p-1000 ? 1 / all : 0;
        float* row = &rows_[rows * std::size_t{leaf.first} + i];
        for (const Vec3& w : {a, unit * u, unit * v, unit * n})
          for (int axis = 0; axis < 3; ++axis, row += leaf.count) *row = static_cast<float>(w[axis]);
      }
    };
    bvh.each_leaf(fill, options);
  }

  /// What fetches the numbers of a leaf that is likely to be visited soon.
  [[nodiscard]] auto soon() const {
    return [this](Leaf leaf) {
      const float* const row = &rows_[rows * std::size_t{leaf.first}];
      for (std::size_t i = 0; i < rows * leaf.count; i += 16) prefetch(row + i);
    };
  }

  /// Where a ray crosses the triangles from the i-th of a leaf on, as many as a vector holds, within a reach.
  [[nodiscard]] Crossed crossed(Leaf leaf, std::uint32_t i, const BoxRay& ray, Reach reach) const {
    const float* const row = &rows_[rows * std::size_t{leaf.first} + i];
    const auto load = [&](std::size_t k) { return Floats::load(row + k * leaf.count); };
    const Floats dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
    const Floats wx = load(0) - Floats(ray.origin[0]), wy = load(1) - Floats(ray.origin[1]),
                 wz = load(2) - Floats(ray.origin[2]);
    const Floats ux = load(3), uy = load(4), uz = load(5), vx = load(6), vy = load(7), vz = load(8);
    const Floats nx = load(9), ny = load(10), nz = load(11);
    const Floats mx = wy * dz - wz * dy, my = wz * dx - wx * dz, mz = wx * dy - wy * dx;
    const Floats slope = nx * dx + ny * dy + nz * dz;
    const Floats ab = -(ux * mx + uy * my + uz * mz), ca = vx * mx + vy * my + vz * mz, bc = slope - ab - ca;
    const float r = 1 + ray.distance;
    const Floats error = 0x1p-19f * r, most = max(max(ab, ca), bc), least = min(min(ab, ca), bc);
    const Bits passed =
        bits(!(most > error && least < -error)) & first_bits(static_cast<int>(leaf.count - i));
    if (passed == 0) return {.maybe = 0, .surely = 0, .near = {}, .far = {}};

    const Floats size = abs(nx) + abs(ny) + abs(nz), height = nx * wx + ny * wy + nz * wz;
    const auto is_known = Floats(0x1p19f) * abs(slope) > size && size > Floats(0x1p-100f);
    const Floats inverse = Floats(1) / slope, t = height * inverse;
    const Floats margin = Floats(0x1p-20f) * size * abs(inverse) * (Floats(r) + abs(t));
    const Floats near = select(is_known, t - margin, -infinite), far = select(is_known, t + margin, infinite);
    return {.maybe = passed & bits(near <= Floats(reach.until) && far >= Floats(reach.from)),
            .surely =
                passed & bits(near > Floats(reach.from * (1 + 0x1p-18f)) && (least > error || most < -error)),
            .near = near,
            .far = far};
  }

 private:
  static constexpr float infinite = std::numeric_limits<float>::infinity();

  /// Of each leaf, from rows · first on: all a.x, all a.y, ... of a, u, v and n.
  static constexpr std::size_t rows = 12;
  std::unique_ptr<float[]> rows_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

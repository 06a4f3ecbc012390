// The spheres in the leaves of a BVH, tested in float: which a ray surely misses, and which it surely meets.
//
// In box space let l = center − origin and d the direction, of length 1. The line passes the center at the
// distance b = d·l from the origin, and at p = l − b d from the center. It meets the sphere if |p| ≤ r, from
// b − √(r² − p²) to b + √(r² − p²). Errors in float, with u = 2^-24 and o the origin:
//
//   l   rounding the center, the origin and the difference: u (|c| + |o| + |l|) ≤ 2u (|o| + |l|)
//   b   the error of l, u |l| for that of d, 3u |l| for products and sums: u (2|o| + 6|l|)
//   p   the errors of l and b, u |l| for d, the product and the difference: u (4|o| + 11|l|)
//
// A line that meets the sphere, or seems to in float, has |l| ≤ |b| + r, these errors apart. Hence the errors
// of b and p are together at most u (6|o| + 17|b| + 17r), and e = 32u (|o| + |b| + r) leaves 15u of each term
// for the rounding of r, of squares and of sums. Let R = r + e and q = R² − p², as computed in float.
//
// A line that meets the sphere has q ≥ 0; it meets the sphere nowhere before b − √q − e or after b + √q + e.
//
// A ray that starts inside the sphere, or on it, has b² ≤ q, since b² + p² is off by less than 2r (e_b + e_p)
// and R² is larger than r² by 2r e. Therefore a ray with b² > q starts outside; it meets the sphere only if b
// > 0, and up to a distance s < b only if (b − s)² ≤ q, since the point there is no nearer to the center than
// R. If p² < (r − e)², e < b < s − e and b² > q, it surely meets the sphere before s: it starts outside, and
// its point nearest to the center is inside.
//
// If R < 4√q and 64e < R, it meets the sphere no later than at b − √q + 17e: with r − e ≥ R − 2e and |p| + e,
// its half chord is at least √((R − 2e − |p|)(R − 2e + |p|)) > √(q − 4eR) ≥ √q − 4eR/√q > √q − 16e. The code
// uses 31e, which exceeds all errors of distances to boxes (Slabs).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "../bvh/bvh.hpp"
#include "../bvh/node.hpp"
#include "../numeric/sphere_equation.hpp"
#include "../simd/prefetch.hpp"
#include "../surfaces/sphere.hpp"
#include "packet.hpp"
#include "sphere_around.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Spheres that contain surfaces, one in each lane.
struct SpheresAround {
  Vectors center;
  Doubles radius, inner;

  SpheresAround(const Vectors& centers, const Doubles& radii, const Doubles& inner_radii)
      : center(centers), radius(radii), inner(inner_radii) {}
  SpheresAround(const SphereAround& one) : center(one.center), radius(one.radius), inner(one.inner) {}

  [[nodiscard]] SphereAround operator[](int lane) const { return {center[lane], radius[lane], inner[lane]}; }
};

class SphereLeaves {
 public:
  using Floats = Lanes<float, float_lanes>;

  /// Spheres that a ray may enter: bit and lane k are the k-th of those tested.
  struct Entered {
    Bits maybe, surely;  ///< may be met; and are surely entered, between near and far
    Floats near, far;    ///< lower bound of where it is met, and upper bound of where it is entered
  };
  struct Crossed {
    Bits maybe;   ///< spheres that may be crossed
    bool surely;  ///< true if one of them surely is
  };

  SphereLeaves() = default;
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

  void fetch(Leaf leaf) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first}];
    prefetch(row);
    prefetch(row + 16);
  }

  /// Tests where the ray first meets the spheres from the i-th of a leaf on, as many as a vector holds,
  /// within a reach. The ends of the reach may be off by 2^-19 of themselves.
  [[nodiscard]] Entered entered(Leaf leaf, std::uint32_t i, const BoxRay& ray, Reach reach) const {
    const Passed passed(*this, leaf, i, ray);
    if (passed.close == 0) return {.maybe = 0, .surely = 0, .near = {}, .far = {}};
    const auto& [close, b, pp, r, e, R, q] = passed;
    const Floats s = sqrt(q), near = b - s - e;
    return {
        .maybe = close & bits(near <= Floats(reach.until) && b + s + e >= Floats(reach.from)),
        .surely = bits(near > Floats(reach.from * (1 + 0x1p-18f)) && R < Floats(4) * s && Floats(64) * e < R),
        .near = near,
        .far = near + Floats(32) * e};
  }

  /// Tests whether the ray crosses the spheres from the i-th of a leaf on within a reach. No crossing is
  /// certain in a reach that does not begin at the origin.
  [[nodiscard]] Crossed crossed(Leaf leaf, std::uint32_t i, const BoxRay& ray, Reach reach) const {
    const Passed passed(*this, leaf, i, ray);
    if (passed.close == 0) return {.maybe = 0, .surely = false};
    const auto& [close, b, pp, r, e, R, q] = passed;
    const auto starts_outside = b * b > q, approaches = b > Floats(0);
    const float until = reach.from == 0 ? reach.until * (1 - 0x1p-18f) : -1;
    const Floats inner = r - e, beyond = b - Floats(reach.until);
    const auto surely =
        starts_outside && b > e && b + e < Floats(until) && inner > Floats(0) && pp < inner * inner;
    const auto ends_before = beyond > Floats(0) && beyond * beyond > q;
    return {.maybe = close & bits(!starts_outside || (approaches && !ends_before)),
            .surely = (close & bits(surely)) != 0};
  }

  /// Returns which spheres, from the i-th of a leaf on, may reach into every one of the half-spaces.
  [[nodiscard]] Bits within(Leaf leaf, std::uint32_t i, std::span<const BoxHalfSpace> half_spaces) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const Floats x = Floats::load(row), y = Floats::load(row + leaf.count),
                 z = Floats::load(row + 2 * leaf.count), r = Floats::load(row + 3 * leaf.count);
    Mask<float, float_lanes> within = true;
    for (const auto& [normal, from] : half_spaces)
      within = within && !(x * Floats(normal[0]) + y * Floats(normal[1]) + z * Floats(normal[2]) + r <
                           Floats(from));  // NaN is not outside
    return bits(within) & first_bits(static_cast<int>(leaf.count - i));
  }

  /// Returns spheres in world space that surely contain those from the i-th of a leaf on, with inner ones
  /// that these surely contain. A float is off by 2^-24 of itself or by 2^-150, and the center in the world
  /// by two roundings of double.
  [[nodiscard]] SpheresAround around(Leaf leaf, std::uint32_t i, const BoxSpace& space) const {
    const float* const row = &rows_[4 * std::size_t{leaf.first} + i];
    const auto load = [&](std::uint32_t k) { return to_double(simd::Floats::load(row + k * leaf.count)); };
    const Vectors c{load(0), load(1), load(2)};
    const double unit = 1 / space.scale;  // exact: a power of two
    const Doubles r = load(3), size = abs(c.x) + abs(c.y) + abs(c.z);
    const Vectors center = Vectors(space.center) + c * Doubles(unit);
    const Doubles error =
        (0x1p-23 * (r + size) + 0x1p-140) * unit + 0x1p-50 * (abs(center.x) + abs(center.y) + abs(center.z));
    return {center, r * unit + error, r * unit - error};
  }

 private:
  /// Numbers of a line that passes spheres, named as at the top of this file; `close` has the spheres that it
  /// may meet.
  struct Passed {
    Bits close;
    Floats b, pp, r, e, R, q;

    Passed(const SphereLeaves& leaves, Leaf leaf, std::uint32_t i, const BoxRay& ray) {
      const float* const row = &leaves.rows_[4 * std::size_t{leaf.first} + i];
      const Floats dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
      const Floats lx = Floats::load(row) - Floats(ray.origin[0]);
      const Floats ly = Floats::load(row + leaf.count) - Floats(ray.origin[1]);
      const Floats lz = Floats::load(row + 2 * leaf.count) - Floats(ray.origin[2]);
      r = Floats::load(row + 3 * leaf.count);
      b = dx * lx + dy * ly + dz * lz;
      const Floats px = lx - b * dx, py = ly - b * dy, pz = lz - b * dz;
      pp = px * px + py * py + pz * pz;
      e = Floats(0x1p-19f) * (abs(b) + r) + Floats(0x1p-19f * ray.distance + ray.widening);
      R = r + e;
      q = R * R - pp;
      close = bits(q >= Floats(0)) & first_bits(static_cast<int>(leaf.count - i));
    }
  };

  /// Numbers of each leaf, from 4 · first on: all x, all y, all z of the centers, and the radii.
  LargeVector<float> rows_;
};

/// Spheres few enough that testing them all in double, as many at once as a vector holds, is faster than a
/// search of the tree in float.
class FewSpheres {
 public:
  static constexpr std::size_t most = 8;

  explicit FewSpheres(const std::vector<Sphere>& spheres) : count_(spheres.size()) {
    for (std::size_t i = 0; i < std::min(count_, most); ++i) {
      const auto& [center, radius] = spheres[i];
      x_[i] = center.x, y_[i] = center.y, z_[i] = center.z, r_[i] = std::abs(radius);
    }
  }

  /// Returns true if it holds all spheres that there are.
  [[nodiscard]] bool has_all() const { return count_ <= most; }

  /// Returns the spheres that the ray does not surely miss, by the bounds of sphere_roots and
  /// is_surely_behind. A sphere that the ray departs from is always among them: its departure decides, not
  /// the digits of its origin.
  [[nodiscard]] Bits met(const Ray& ray, const Interval& range) const {
    Bits met = 0;
    const SphereLine line(ray.origin, ray.direction);
    for (std::size_t i = 0; i < count_; i += double_lanes) {
      const auto load = [&](const double* numbers) { return Doubles::load(numbers + i); };
      const Vectors center{load(x_), load(y_), load(z_)};
      const Doubles r = load(r_);
      const auto e = protostar::detail::rounded_sphere_equation(line, center, r);
      auto missed = e.surely_misses();
      if (range.min >= 0) missed = missed || e.surely_recedes();
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

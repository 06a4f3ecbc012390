// Boxes, and rays as boxes see them: in float, in units in which everything fits between −1 and 1.
//
// Float is enough to say what a ray surely misses. The center of everything is the origin here, so that
// digits are not spent on where in the world a scene is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "../bounds.hpp"
#include "../interval.hpp"
#include "../ray.hpp"
#include "simd.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Four floats, of which boxes and points use three.
using Float4 = Lanes<float, 4>;

/// A box in box space.
struct Box {
  Float4 min, max;

  /// The box that contains nothing, not even a point.
  static Box nothing() {
    return {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  }

  void add(const Box& other) {
    min = simd::min(min, other.min);
    max = simd::max(max, other.max);
  }
  void add(Float4 point) { add(Box{point, point}); }

  /// Twice its center.
  [[nodiscard]] Float4 middle() const { return min + max; }

  /// Half of its surface.
  [[nodiscard]] float area() const {
    const Float4 size = max - min;
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

/// What brings the world's points into box space: x becomes (x − center) · scale. The scale is a power of
/// two, so that only the difference is rounded, by 2^-53 of itself.
struct BoxSpace {
  Point center{0};
  double scale = 1;

  BoxSpace() = default;
  explicit BoxSpace(const Bounds& everything) : center(0.5 * everything.min + 0.5 * everything.max) {
    const Vec3 half = 0.5 * everything.max - 0.5 * everything.min;
    const double largest = std::max({half.x, half.y, half.z});
    if (largest > 0) scale = std::ldexp(1.0, std::clamp(-1 - std::ilogb(largest), -1000, 1000));
  }

  [[nodiscard]] Point operator()(const Point& x) const { return (x - center) * scale; }

  /// The box around bounds. float(x) is off by at most 2^-24 |x|, or by 2^-150 near 0.
  [[nodiscard]] Box operator()(const Bounds& bounds) const {
    const Vec3 a = (*this)(bounds.min), b = (*this)(bounds.max);
    Box box{Float4(0), Float4(0)};
    for (int i = 0; i < 3; ++i) {
      box.min.set(i, static_cast<float>(a[i] - (0x1p-23 * std::abs(a[i]) + 0x1p-140)));
      box.max.set(i, static_cast<float>(b[i] + (0x1p-23 * std::abs(b[i]) + 0x1p-140)));
    }
    return box;
  }
};

/// A ray in box space: its points are origin + s·direction, with a direction of length 1 and s = t · length.
///
/// The line meets a box where, on every axis i, min_i ≤ o_i + s d_i ≤ max_i, that is from s = (min_i −
/// o_i)/d_i to (max_i − o_i)/d_i, or the other way round for d_i < 0. In float, with u = 2^-24:
///
/// - o_i is moved out by a margin of 2^-23 |o_i| + 2^-40 (1 + |o|), of which the rounding to float takes at
///   most half. near_origin has it on the side from which the box looks nearer, far_origin on the other.
/// - 1/d_i is rounded once, the difference and the product once each, and each leaves the sign: s is good to
///   a part 3u. far_inverse has 8u more than inverse, more than both ends can be off.
/// - |d_i| < 2^-60 is taken as 2^-60. Where the line is in a box, s < |o| + 2, so that it moves by less than
///   2^-59 (|o| + 2) on that axis: the margin covers that, as it does all that underflows.
///
/// So a box that the line meets has near ≤ far. There is no infinity and no NaN in it.
struct BoxRay {
  float origin[3], direction[3];
  float near_origin[3], far_origin[3], inverse[3], far_inverse[3];
  bool backwards[3];  ///< whether d_i < 0
  float margin;       ///< 2^-20 |o|₁ + 2^-60, and what all things are widened by
  double length;      ///< of the ray's direction in box space

  /// Whether float can hold the ray. One that starts 2^60 times as far away as things are large, or whose
  /// direction is as short or as long as that, or not finite, meets every box.
  bool usable;

  /// All things are widened by a length of the world.
  BoxRay(const Ray& ray, const BoxSpace& space, double widening) {
    const Point o = space(ray.origin);
    const Vec3 d = ray.direction * space.scale;
    const double A = dot(d, d), distance = std::abs(o.x) + std::abs(o.y) + std::abs(o.z);
    const double wide = widening * space.scale;
    usable = 0x1p-800 < A && A < 0x1p800 && distance + wide < 0x1p60;
    if (!usable) return;
    length = std::sqrt(A);
    margin = static_cast<float>(0x1p-20 * distance + 0x1p-60 + 2 * wide);
    const double step = 1 / length;
    for (int i = 0; i < 3; ++i) {
      const double unit = d[i] * step, size = std::abs(unit) < 0x1p-60 ? 0x1p-60 : std::abs(unit);
      const double shift =
          std::copysign(0x1p-23 * std::abs(o[i]) + 0x1p-40 * (1 + distance) + 2 * wide, unit);
      const double slope = std::copysign(1 / size, unit);
      origin[i] = static_cast<float>(o[i]);
      direction[i] = static_cast<float>(unit);
      near_origin[i] = static_cast<float>(o[i] + shift);
      far_origin[i] = static_cast<float>(o[i] - shift);
      inverse[i] = static_cast<float>(slope);
      far_inverse[i] = static_cast<float>(slope * (1 + 0x1p-21));
      backwards[i] = std::signbit(unit);
    }
  }

  /// Distances in box space that are surely not above t, and not below. The factor covers three roundings.
  [[nodiscard]] float at_least(double t) const {
    return static_cast<float>(t * length * (t > 0 ? 1 - 0x1p-22 : 1 + 0x1p-22));
  }
  [[nodiscard]] float at_most(double t) const {
    return static_cast<float>(t * length * (t > 0 ? 1 + 0x1p-22 : 1 - 0x1p-22));
  }
};

/// The part of a ray in which something is looked for, as distances in box space.
struct Reach {
  float from, until;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

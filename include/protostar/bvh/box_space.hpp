// Boxes, and rays as boxes are tested for them: in float, in units in which the scene fits between −1 and 1.
//
// Float is enough to tell what a ray surely misses. The center of the scene is the origin here, so that no
// digits are spent on where in the world it is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "../bit_cast.hpp"
#include "../bounds.hpp"
#include "../interval.hpp"
#include "../ray.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Four floats, of which boxes and points use three.
using Float4 = Lanes<float, 4>;

/// Returns f(v), rounded to float. Where a register holds four doubles, f takes all components at once, and
/// elsewhere one at a time.
[[nodiscard]] Float4 float4(const Vec3& v, const auto& f) {
  const auto component = [&](int axis) { return axis < 3 ? v[axis] : 0.0; };
  if constexpr (double_lanes >= 4)
    return to_float(f(Lanes<double, 4>::of_each(component)));
  else
    return Float4::of_each([&](int axis) { return static_cast<float>(f(component(axis))); });
}

/// A box in box space.
struct Box {
  Float4 min, max;

  /// Returns the box that contains nothing, not even a point.
  static Box nothing() {
    return {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  }

  void add(const Box& other) {
    min = simd::min(min, other.min);
    max = simd::max(max, other.max);
  }
  void add(Float4 point) { add(Box{point, point}); }

  /// Returns twice the center.
  [[nodiscard]] Float4 twice_center() const { return min + max; }

  /// Returns half of the surface area.
  [[nodiscard]] float half_area() const {
    const Float4 size = max - min;
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

/// Map of the world into box space: x becomes (x − center) · scale. The scale is a power of two, so that only
/// the difference is rounded, by 2^-53 of itself. Surfaces of a program's own may be as large as doubles are;
/// beyond 2^399, only rays with nearly unit or with long directions are usable (BoxRay::usable).
struct BoxSpace {
  Point center{0};
  double scale = 1;

  BoxSpace() = default;
  explicit BoxSpace(const Bounds& everything) : center(0.5 * everything.min + 0.5 * everything.max) {
    const Vec3 half = 0.5 * everything.max - 0.5 * everything.min;
    const double largest = std::max({half.x, half.y, half.z});
    if (largest > 0) scale = std::ldexp(1.0, std::min(-1 - std::ilogb(largest), 1000));  // 2^-1024 or more
  }

  [[nodiscard]] Point operator()(const Point& x) const { return (x - center) * scale; }

  /// Returns the box around bounds. float(x) is off by at most 2^-24 |x|, or by 2^-150 near 0. An end at 0 is
  /// moved to the next normal number: some processors are slow at products of subnormal ones.
  [[nodiscard]] Box operator()(const Bounds& bounds) const {
    const Vec3 a = (*this)(bounds.min), b = (*this)(bounds.max);
    Box box{Float4(0), Float4(0)};
    for (int i = 0; i < 3; ++i) {
      box.min.set(i, static_cast<float>(a[i] - (0x1p-23 * std::abs(a[i]) + 0x1p-126)));
      box.max.set(i, static_cast<float>(b[i] + (0x1p-23 * std::abs(b[i]) + 0x1p-126)));
    }
    return box;
  }
};

/// A ray in box space: its points are origin + s·direction, with a direction of length 1 and s = t · length.
struct BoxRay {
  Float4 origin, direction;  ///< rounded to float
  Float4 inverse;            ///< 1 over each component of the direction, from −2^60 to 2^60
  float distance;            ///< |o|₁ of the origin o, to within 3u of itself, plus 2^-40
  float widening;            ///< length by which all primitives are widened
  double length;             ///< length of the ray's direction in box space

  /// True if float can hold the ray. If not, it is taken to meet every box: one that starts 2^60 units or
  /// more from the center, or whose direction, unless it is nearly a unit vector in the world, is not between
  /// 2^-400 and 2^400 long in box space, shorter than 2^-400 in the world, or has no finite square.
  bool usable;

  /// Maps a ray; all primitives are widened by `widen`, a length in the world.
  ///
  /// A direction made of floats, or by further rays of paths, is nearly a unit vector. With |d|² = 1 + h and
  /// |h| ≤ 2^-19, 1 + h/2 is off from the root by less than h²/8 ≤ 2^-41, and 1 − h/2 from its inverse by
  /// less than 3h²/8 < 2^-39. Other vectors wait for a root and a division. The three divisions by components
  /// do not wait for the root.
  [[gnu::always_inline]] BoxRay(const Ray& ray, const BoxSpace& space, double widen)
      : widening(static_cast<float>(2 * widen * space.scale)) {
    origin = float4(space(ray.origin), [](const auto& o) { return o; });
    const Float4 size = abs(origin);
    distance = size[0] + size[1] + size[2] + 0x1p-40f;
    usable = distance + widening < 0x1p60f;
    const double square = dot(ray.direction, ray.direction), excess = square - 1;
    double root = 1 + 0.5 * excess, inverse_root = 1 - 0.5 * excess;
    if (!(std::abs(excess) <= 0x1p-19)) {
      root = std::sqrt(square), inverse_root = 1 / root;
      usable = usable && 0x1p-800 < square && 0x1p-400 < root * space.scale && root * space.scale < 0x1p400;
    }
    length = root * space.scale;
    direction = float4(ray.direction, [&](const auto& d) { return d * inverse_root; });
    const auto inverse_size = [&]<class T>(const T& d) {
      using std::abs, std::max, std::min;
      return min(T(1) / max(abs(d), T(0x1p-600)) * T(root), T(0x1p60));
    };
    inverse = copysign(float4(ray.direction, inverse_size), direction);
  }

  /// Returns a lower bound (at_least) or an upper bound (at_most) of t ≥ 0 as a distance in box space, 2^-20
  /// of it away: this covers three roundings here and those of the distances that it is compared with
  /// (Slabs).
  [[nodiscard]] float at_least(double t) const { return static_cast<float>(t * length * (1 - 0x1p-20)); }
  [[nodiscard]] float at_most(double t) const { return static_cast<float>(t * length * (1 + 0x1p-20)); }
};

/// A ray as it is tested against boxes: an end of a box on axis i is at s = end · inverse_i + shift_i.
///
/// The line meets a box where, on every axis i, min_i ≤ o_i + s d_i ≤ max_i, hence from s = (min_i − o_i)/d_i
/// to (max_i − o_i)/d_i, or the other way round for d_i < 0. In float, with u = 2^-24, v = inverse_i and an
/// end m, |m| ≤ 1 + 4u:
///
/// - 1/d_i is rounded, so that v is off by less than 2u of itself, and m v by 2u |m v| from m/d_i.
/// - o_i, its sum with a margin, and their product with v are rounded: 5u |o_i v|, with the errors of v.
/// - The product m v may be rounded, and the sum of both is: 2u |m v| + u |o_i v|.
///
/// Together they are at most u |v| (4 |m| + 6 |o_i|), but for 5u of that. near_shift is lower than −o_i v by
/// |v| times a margin of 2^-21 (1 + |o_i|) + 2^-38 |o| + widening, with 2^-21 = 8u, and far_shift is higher
/// by it: the nearer end comes out no farther than it is, and the farther end no nearer. The rounding of
/// the margin is far less than u, and than what doubling the widening (BoxRay) adds.
///
/// |d_i| < 2^-60 is taken for 2^-60. The line comes to the nearer end no later by that. Inside a box
/// s < |o| + 2, and the farther end may be up to s too near; the margin is at least 2^60 (4u + 2^-38 |o|)
/// more than the errors, which is more than s.
///
/// Hence a box that the line meets has near ≤ far. There is no infinity and no NaN in it.
struct Slabs {
  Float4 inverse, near_shift, far_shift;
  /// Ends of a box that look nearer and farther on each axis: their places in Node::end.
  std::int32_t near_end[4], far_end[4];

  Slabs() = default;  ///< for no ray
  /// Makes those of a ray for nodes of some width.
  Slabs(const BoxRay& ray, std::int32_t width) {
    inverse = ray.inverse;
    const Float4 margin = fused_or_not(Float4(0x1p-21f), abs(ray.origin),
                                       Float4(0x1p-21f + 0x1p-38f * ray.distance + ray.widening));
    const Float4 ahead = copysign(margin, inverse);
    near_shift = (-ray.origin - ahead) * inverse;
    far_shift = (ahead - ray.origin) * inverse;
    // Lanes in which the sign bit is set have the two ends the other way round.
    using Places = Lanes<std::int32_t, 4>;
    const Places first = iota<std::int32_t, 4>() * Places(width), second = first + Places(3 * width);
    const Places bits = protostar::detail::bit_cast<detail::Vector<std::int32_t, 4>>(inverse.v);
    const Places change = (bits >> Places(31)) & Places(3 * width);
    (first + change).store(near_end);
    (second - change).store(far_end);
  }
};

/// The points x with normal · (x − on) ≥ 0; the normal has length 1, or 0 if all points belong to it.
struct HalfSpace {
  Point on;
  Vec3 normal;
};

/// A half-space in box space: the points x with normal · x ≥ from, and all that rounding to float might put
/// there.
///
/// It is compared with points at most 1 from the origin in each component, and with spheres there. In float,
/// with u = 2^-24, n is off by u, a center by u, and the products and sums by 3u of |n_x| + |n_y| + |n_z| ≤
/// √3; a radius of at most 1, and adding it, by 3u: 12u in all. The plane's distance is off by u of itself,
/// and by less than 2^-50 |on|. Margins of 2^-20 = 16u of 1 and of the distance, and of 2^-48 |on|, cover
/// these.
struct BoxHalfSpace {
  float normal[3];
  float from;

  BoxHalfSpace() = default;
  BoxHalfSpace(const HalfSpace& half_space, const BoxSpace& space) {
    const Point p = space(half_space.on);
    const Vec3& n = half_space.normal;
    const double distance = dot(n, p);
    const double margin =
        0x1p-20 * (1 + std::abs(distance)) + 0x1p-48 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
    for (int axis = 0; axis < 3; ++axis) normal[axis] = static_cast<float>(n[axis]);
    from = static_cast<float>(distance - margin);
  }
};

/// Part of a ray that is searched, as distances in box space.
struct Reach {
  float from, until;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

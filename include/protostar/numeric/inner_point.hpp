// Finds an exact point strictly inside a triangle, next to a point that should be there but is rounded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "../interval.hpp"
#include "../vec3.hpp"
#include "plane_through.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Point in the plane of a triangle and strictly inside of it, without rounding: either a point in doubles
/// that surely is there, or a + u (b − a) + v (c − a) with doubles u > 0 and v > 0, u + v < 1, which is there
/// whatever u and v are.
class InnerPoint {
 public:
  /// Finds the inner point next to a given point, as far as double tells: the given point itself if it
  /// certainly is inside, and otherwise the triangle's nearest point, to a few units of 2^-53 of the edges.
  InnerPoint(const Point& near, const Point& p, const Point& q, const Point& r) : a_(near) {
    if (surely_holds(near, p, q, r)) return;
    const std::array corners{p, q, r};
    const int size = exponent_of({q - p, r - q, p - r});
    const auto edge = [&](std::size_t i) { return scaled(corners[(i + 1) % 3] - corners[i], -size); };
    // a and b are the ends of the longest edge. The rounding of v, which the ratio of the edges may make
    // large, then moves the point along that edge, and u compensates for it.
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (dot(edge(i), edge(i)) > dot(edge(longest), edge(longest))) longest = i;
    a_ = corners[longest], b_ = corners[(longest + 1) % 3], c_ = corners[(longest + 2) % 3];

    const Vec3 e = edge(longest), f = scaled(c_ - a_, -size), x = scaled(near - a_, -size), n = cross(e, f);
    v_ = dot(cross(e, x), n) / dot(n, n);
    u_ = place_along(e, x - v_ * f);
    // A point beyond an edge, or undecided (NaN), is put on the edge.
    const auto clamped = [](double place) { return std::min(std::max(0.0, place), 1.0); };
    if (!(v_ > 0))
      u_ = clamped(place_along(e, x)), v_ = 0;
    else if (!(u_ > 0))
      u_ = 0, v_ = clamped(place_along(f, x));
    else if (!(u_ + v_ < 1))
      v_ = clamped(place_along(f - e, x - e)), u_ = 1 - v_;

    // Move from an edge to the inside. Any number above 0 would do; 2^-60 of the triangle is less than the
    // rounding of a place on its edge. A computed sum of 1 is at most 1 + 2^-53, and hence below 1 if both
    // are reduced by 2^-50 of themselves.
    constexpr double least = 0x1p-60;
    if (!(u_ > 0)) u_ = least;
    if (!(v_ > 0)) v_ = least;
    if (u_ + v_ > 1 - 0x1p-50) u_ *= 1 - 0x1p-50, v_ *= 1 - 0x1p-50;

    // Each component of the difference is the sum of three terms with at most four roundings each, and two
    // for the sums; 2^-50 covers 8 units of 2^-53.
    const Vec3 to_b = b_ - a_, to_c = c_ - a_, way = near - a_, off = abs(way - u_ * to_b - v_ * to_c),
               sizes = abs(way) + abs(to_b) + abs(to_c);
    const auto largest = [](const Vec3& w) { return std::max({w.x, w.y, w.z}); };
    distance_ = largest(off) + 0x1p-50 * largest(sizes) + 0x1p-1060;  // 2^-1060 covers underflow
  }

  /// Returns an upper bound, for each axis, of the distance from the given point to this one. It is not
  /// finite if double cannot hold the differences of the given numbers.
  [[nodiscard]] double distance() const { return distance_; }

  /// Returns the point without rounding.
  [[nodiscard, gnu::cold, gnu::noinline]] ExactVector exact() const {
    const ExactVector a = exact_vector(a_);
    if (u_ == 0) return a;
    return a + (ExactNumber(u_) * exact_difference(b_, a_) + ExactNumber(v_) * exact_difference(c_, a_));
  }

 private:
  /// Returns the projection of x onto a vector, in units of that vector.
  [[nodiscard]] static double place_along(const Vec3& vector, const Vec3& x) {
    return dot(x, vector) / dot(vector, vector);
  }

  /// Returns true if double is certain that a point is inside a triangle perpendicular to an axis: it lies on
  /// the same side of all three edges. A product of two differences has an error of 3 units of 2^-53, and the
  /// difference of two such products one more.
  [[nodiscard]] static bool surely_holds(const Point& point, const Point& p, const Point& q, const Point& r) {
    for (int i = 0; i < 3; ++i) {
      if (p[i] != q[i] || p[i] != r[i] || p[i] != point[i]) continue;
      const int k = (i + 1) % 3, l = (i + 2) % 3;
      const auto side = [&](const Point& from, const Point& to) {
        const Vec3 edge = to - from, way = point - from;
        const double one = edge[k] * way[l], other = edge[l] * way[k],
                     sizes = std::abs(one) + std::abs(other);
        const double difference = one - other;
        if (!(0x1p-1000 < sizes && sizes < infinity) || std::abs(difference) <= 0x1p-50 * sizes) return 0;
        return difference > 0 ? 1 : -1;
      };
      const int first = side(p, q);
      return first != 0 && side(q, r) == first && side(r, p) == first;
    }
    return false;
  }

  Point a_, b_{0}, c_{0};
  double u_ = 0, v_ = 0;  ///< 0 if the point is a
  double distance_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

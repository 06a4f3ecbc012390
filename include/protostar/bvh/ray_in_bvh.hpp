// Primitives of a BVH that a ray of the scene may meet, and the length by which its boxes are widened for the
// ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "../interval.hpp"
#include "../ray.hpp"
#include "../transformed_ray.hpp"
#include "box_space.hpp"
#include "bvh.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Returns a length by which a ray in an instance's object space is at most off from the exact one where it
/// passes a box of a tree: the error of its origin and t times that of its direction; infinite if the
/// direction is off by more than 2^-24 of itself. In the tree, which is within 1/scale of its center on each
/// axis, t |d| is at most the distance of the origin from the center and 3/scale, where |d| is the largest
/// component. Twice the sum covers the roundings here.
[[nodiscard]] inline double error_of(const RayTransform& transform, const BoxSpace& space) {
  double origin_error = 0, direction_error = 0, longest = 0, distance = 3 / space.scale;
  for (int i = 0; i < 3; ++i) {
    origin_error += transform.line.origin_error[i], direction_error += transform.line.direction_error[i];
    longest = std::max(longest, std::abs(transform.line.direction[i]));
    distance += std::abs(transform.line.origin[i] - space.center[i]);
  }
  // Distances along the ray are compared with a margin of 2^-20 of themselves (BoxRay::at_least).
  if (!(direction_error <= 0x1p-24 * longest)) return std::numeric_limits<double>::infinity();
  return 2 * (origin_error + distance * (direction_error / longest));
}

/// Returns the length by which primitives are widened for a ray that departs from a sphere, or that is
/// rounded itself.
///
/// A ray that departs from a sphere starts on the sphere by definition, whatever its digits say. If these put
/// its origin outside, they put the other root, 2b/A, outside too: the point there is as far from the center
/// as the origin is. The rounding is at most 4u of the distance and of the difference, with u = 2^-53.
[[nodiscard]] inline double widening(const Ray& ray, const BoxSpace& space) {
  if (ray.transform != nullptr) return error_of(*ray.transform, space);
  if (ray.departure.kind != Departure::Kind::sphere) return 0;
  const auto& [x, y, z, r] = ray.departure.geometry;
  const Vec3 l = Point{x, y, z} - ray.origin;
  const double distance = std::sqrt(dot(l, l));
  return std::max(0.0, distance - r + 0x1p-50 * (distance + r));
}

/// Returns the widening for a query, whose ray may start at a distance from its origin on each axis.
[[nodiscard]] double widening(const auto& query, const BoxSpace& space) {
  if constexpr (requires { query.distance(); })
    return widening(query.ray, space) + query.distance();
  else
    return widening(query.ray, space);
}

/// Returns true if visit(i) is true for any of the primitives.
bool any_of(std::span<const std::uint32_t> things, const auto& visit) {
  for (const std::uint32_t i : things)
    if (visit(i)) return true;
  return false;
}

/// Returns true if boxes tell anything of what a ray meets inside a range. Behind the origin their ends are
/// not widened (Slabs), so they do not help there.
[[nodiscard]] inline bool helps(const BoxRay& line, const Interval& range) {
  return line.usable && range.min >= 0;
}

/// Calls visit(i) for all primitives that are in no leaf of a tree, and visit_leaf(BoxRay, leaf, reach) for
/// every leaf that a ray may meet inside the range, until a call returns true; returns true if one did. If
/// boxes do not help, it calls visit(i) for all primitives instead.
template <Order order, class Soon = Ignore>
bool each_along(const Bvh& bvh, const BoxRay& line, const Interval& range, const auto& visit,
                const auto& visit_leaf, const Soon& soon = {}) {
  if (any_of(bvh.unbounded(), visit)) return true;
  if (!helps(line, range)) return any_of(bvh.order(), visit);
  return bvh.each_leaf_along<order>(
      line, {line.at_least(range.min), line.at_most(range.max)},
      [&](Leaf leaf, Reach& left) { return visit_leaf(line, leaf, left); }, soon);
}
template <Order order, class Soon = Ignore>
bool each_along(const Bvh& bvh, const Ray& ray, const Interval& range, const auto& visit,
                const auto& visit_leaf, const Soon& soon = {}) {
  return each_along<order>(bvh, BoxRay(ray, bvh.space(), widening(ray, bvh.space())), range, visit,
                           visit_leaf, soon);
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

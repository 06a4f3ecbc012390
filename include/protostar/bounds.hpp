// Axis-aligned bounding boxes of surfaces.
#pragma once

#include <array>
#include <optional>

#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Axis-aligned box: the points x with min ≤ x ≤ max in each component. Infinite for a surface without
/// bounds.
struct Bounds {
  Point min, max;
};

/// Tests whether a box has finite ends.
[[nodiscard]] inline bool is_finite(const Bounds& box) { return is_finite(box.min) && is_finite(box.max); }

/// Widens a box whose ends have been rounded once each, so that it contains the exact box: a rounding is at
/// most half a unit in the last place, and 2^-52 |x| is a whole one or more.
[[nodiscard]] inline Bounds outward(const Bounds& rounded) {
  return {rounded.min - 0x1p-52 * abs(rounded.min), rounded.max + 0x1p-52 * abs(rounded.max)};
}

/// Returns the center of a finite box, whose sides are finite, too.
[[nodiscard]] inline Point center_of(const Bounds& box) { return box.min + 0.5 * (box.max - box.min); }

/// Returns the halves of such a box, cut across its longest side at its center; none if no number lies
/// between the ends of that side.
[[nodiscard]] inline std::optional<std::array<Bounds, 2>> halves_of(const Bounds& box) {
  const Vec3 size = box.max - box.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const double middle = center_of(box)[axis];
  if (!(box.min[axis] < middle && middle < box.max[axis])) return {};
  std::array<Bounds, 2> halves{box, box};
  halves[0].max[axis] = halves[1].min[axis] = middle;
  return halves;
}

/// Tests whether the line of a ray without errors surely has no point in a box: projected along one axis, the
/// line is farther from the center than the box reaches. With u = 2^-53, w has an error of at most 2u (|o| +
/// |w|), and the half sides one of 2u (|o| + |w| + half), as |min| and |max| are at most |o| + |w| + half; a
/// component of w × d has 2u of its terms besides. 2^-49 of all is twice as much and more, 2^-1000 exceeds
/// underflow, and the comparison of what is infinite or NaN fails.
[[nodiscard]] inline bool surely_misses(const auto& ray, const Bounds& box) {
  const Vec3 w = 0.5 * (box.min + box.max) - ray.origin, half = 0.5 * (box.max - box.min),
             reach = half + 0x1p-49 * (abs(ray.origin) + abs(w) + half), d = abs(ray.direction),
             off = abs(cross(w, ray.direction)) - 0x1p-1000;
  return off.x > reach.y * d.z + reach.z * d.y || off.y > reach.z * d.x + reach.x * d.z ||
         off.z > reach.x * d.y + reach.y * d.x;
}

}  // namespace protostar::inline PROTOSTAR_ABI

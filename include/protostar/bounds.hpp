// Axis-aligned bounding boxes of surfaces.
#pragma once

#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Axis-aligned box: the points x with min ≤ x ≤ max in each component. Infinite for a surface without
/// bounds.
struct Bounds {
  Point min, max;
};

/// Widens a box whose ends have been rounded once each, so that it contains the exact box: a rounding is at
/// most half a unit in the last place, and 2^-52 |x| is a whole one or more.
[[nodiscard]] inline Bounds outward(const Bounds& rounded) {
  return {rounded.min - 0x1p-52 * abs(rounded.min), rounded.max + 0x1p-52 * abs(rounded.max)};
}

}  // namespace protostar::inline PROTOSTAR_ABI

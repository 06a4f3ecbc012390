// A box along the axes that contains a surface.
#pragma once

#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The points x with min ≤ x ≤ max, in each component. Where something has no bounds they are infinite.
struct Bounds {
  Point min, max;
};

/// The smallest and largest double numbers around a box whose ends have been rounded once each: a rounding is
/// at most half of the unit in the last place, and 2^-52 |x| is a whole one or more.
[[nodiscard]] inline Bounds outward(const Bounds& rounded) {
  return {rounded.min - 0x1p-52 * abs(rounded.min), rounded.max + 0x1p-52 * abs(rounded.max)};
}

}  // namespace protostar::inline PROTOSTAR_ABI

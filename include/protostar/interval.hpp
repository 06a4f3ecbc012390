// The part of a ray in which a crossing counts.
#pragma once

#include <limits>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// The parameters t with min < t < max (§2.2.4). It is open: neither end belongs to it, and NaN belongs to no
/// interval. The default is all that lies ahead of a ray's origin.
struct Interval {
  double min = 0;
  double max = infinity;

  [[nodiscard]] constexpr bool contains(double t) const { return min < t && t < max; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

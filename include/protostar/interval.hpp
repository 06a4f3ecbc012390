// The range of a ray's parameter t in which a hit counts.
#pragma once

#include <limits>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Open interval: the parameters t with min < t < max (§2.2.4). Neither end belongs to it, and NaN belongs to
/// no interval. The default is all that lies ahead of a ray's origin.
struct Interval {
  double min = 0;
  double max = infinity;

  [[nodiscard]] constexpr bool contains(double t) const { return min < t && t < max; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

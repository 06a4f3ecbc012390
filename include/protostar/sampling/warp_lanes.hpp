// Maps of warp.hpp in lanes, with the bits that each pair of numbers has alone.
#pragma once

#include <array>
#include <numbers>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "radians_of_each.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Points of the unit disk, in polar form and with sine and cosine of the angle.
struct PolarPoints {
  Doubles radius, sine, cosine;
};

/// Returns the points of concentric_polar.
[[nodiscard]] inline PolarPoints concentric_polar(Doubles u, Doubles v) {
  constexpr double eighth = std::numbers::pi / 4;
  const Doubles a = 2.0 * u - Doubles(1.0), b = 2.0 * v - Doubles(1.0);
  const LaneMask is_wide = abs(a) > abs(b);
  const Doubles size = select(is_wide, a, b), across = select(is_wide, b, -a);
  const LaneMask is_first = size > Doubles(0.0), is_center = size == Doubles(0.0);
  const Doubles begin = select(is_wide, select(is_first, Doubles(0.0), Doubles(4 * eighth)),
                               select(is_first, Doubles(2 * eighth), Doubles(6 * eighth)));
  const Doubles angle = begin + eighth * (across / size);
  const auto [sine, cosine] = sine_and_cosine_of_each(select(is_center, Doubles(0.0), angle));
  return {abs(size), sine, cosine};
}

/// Returns the points of concentric_disk.
[[nodiscard]] inline std::array<Doubles, 2> concentric_disk(Doubles u, Doubles v) {
  const auto [radius, sine, cosine] = concentric_polar(u, v);
  return {radius * cosine, radius * sine};
}

/// Returns the local directions of cosine_hemisphere.
[[nodiscard]] inline Vectors cosine_hemisphere(Doubles u, Doubles v) {
  const auto [radius, sine, cosine] = concentric_polar(u, v);
  const Doubles z = sqrt((Doubles(1.0) - radius) * (Doubles(1.0) + radius));
  return {radius * cosine, radius * sine, z};
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

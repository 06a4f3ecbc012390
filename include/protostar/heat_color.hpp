// Colors for numbers: the higher a number, the brighter and the warmer its color.
#pragma once

#include <iterator>

#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Colors of the shares 0, ⅕, … 1 in linear light: black, blue, purple, orange, yellow, white. Their
/// luminance grows throughout, so that the order of two numbers is seen in gray as well.
inline constexpr Color heat_colors[] = {{0, 0, 0},    {0.05f, 0, 0.5f}, {0.6f, 0, 0.3f},
                                        {1, 0.3f, 0}, {1, 0.8f, 0.15f}, {1, 1, 1}};

/// Returns the color of a share from 0 to 1, linear between those of heat_colors. Shares below 0, and NaN,
/// are black, and shares above 1 white.
[[nodiscard]] inline Color heat_color(double share) {
  constexpr int parts = static_cast<int>(std::size(heat_colors)) - 1;
  if (!(share > 0)) return heat_colors[0];
  if (share >= 1) return heat_colors[parts];
  const double place = parts * share;
  const int i = static_cast<int>(place);
  const float of_next = static_cast<float>(place - i);
  return (1 - of_next) * heat_colors[i] + of_next * heat_colors[i + 1];
}

}  // namespace protostar::inline PROTOSTAR_ABI

// An evening sky over hills, as an environment: a function of longitude and latitude. dusk.hdr is the same as
// a picture.
#pragma once

#include <algorithm>
#include <cmath>
#include <protostar/vec3.hpp>

/// The light from a direction (protostar::direction_uv).
inline protostar::Color dusk(double u, double v) {
  using protostar::Color, protostar::Vec3;
  if (v > 0.5) {  // fields, brighter towards the horizon
    const double far = 2 * (1 - v);
    return Color{far * far * Vec3{0.26, 0.2, 0.09} + Vec3{0.14, 0.11, 0.06}};
  }
  const double left = 2 * (u - 0.625), up = v - 0.41, far = left * left + up * up;  // from the sun, squared
  if (far < 0.0006) return {60, 40, 18};
  const double near = std::max(1 - far / 0.04, 0.0), glow = 0.5 * near * near * near;
  const double height = 1 - 2 * v, low = (1 - height) * (1 - height);
  const Vec3 sky = Vec3{0.1, 0.2, 0.45} + low * Vec3{0.75, 0.3, -0.15} + glow * Vec3{1, 0.7, 0.4};

  // Hills, in haze: their outline is 0.003 high.
  const auto zigzag = [](double x) { return std::abs(2 * (x - std::floor(x)) - 1); };
  const double above = v - (0.47 + 0.02 * zigzag(5 * u) - 0.01 * zigzag(13 * u));
  const double hill = std::clamp(above / 0.003, 0.0, 1.0);
  return Color{(1 - hill) * sky + hill * Vec3{0.12, 0.12, 0.17}};
}

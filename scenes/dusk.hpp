// An evening sky over hills, as an environment: a function of longitude and latitude. dusk.hdr is the same as
// a picture.
#pragma once

#include <cmath>
#include <protostar/vec3.hpp>

/// The light from a direction (protostar::direction_uv). In steps, so that the picture is a small file.
inline protostar::Color dusk(double u, double v) {
  using protostar::Color;
  const auto zigzag = [](double x) { return std::abs(2 * (x - std::floor(x)) - 1); };
  if (v > 0.5) {  // fields, brighter towards the horizon
    const double near = std::floor(40 * (v - 0.5)) / 20;
    return Color{protostar::Vec3{0.32, 0.24, 0.1} * (1 - 0.7 * near)};
  }
  if (v > 0.47 + 0.02 * zigzag(5 * u) - 0.01 * zigzag(13 * u)) return {0.08f, 0.1f, 0.13f};
  const double left = 2 * (u - 0.625), up = v - 0.41, far = left * left + up * up;  // of the sun
  if (far < 0.0006) return {60, 40, 18};
  const double glow = far < 0.002 ? 0.5 : far < 0.006 ? 0.25 : far < 0.015 ? 0.1 : 0;
  const double height = std::floor(64 * (0.5 - v)) / 32, low = (1 - height) * (1 - height);
  return Color{protostar::Vec3{0.1, 0.2, 0.45} + low * protostar::Vec3{0.75, 0.3, -0.15} +
               glow * protostar::Vec3{1, 0.7, 0.4}};
}

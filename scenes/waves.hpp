// Waves on a surface, as a normal map: a function of u and v.
#pragma once

#include <protostar/material.hpp>
#include <protostar/numeric/trigonometry.hpp>

/// Returns a normal map of so many waves along u and along v, each from 0 to 1, that rise and fall by at most
/// `slope` along either.
inline protostar::NormalMap waves(double along_u, double along_v, double slope) {
  using protostar::sine_of_degrees;
  return [=](double u, double v) {
    return protostar::Vec3{slope * sine_of_degrees(360 * along_u * u),
                           slope * sine_of_degrees(360 * along_v * v), 1};
  };
}

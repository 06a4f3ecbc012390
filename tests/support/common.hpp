// Constants and small functions that several tests use.
#pragma once

#include <limits>
#include <numbers>
#include <protostar/interval.hpp>
#include <protostar/numeric/roots.hpp>
#include <protostar/ray.hpp>
#include <protostar/surface.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/vec3.hpp>
#include <vector>

inline constexpr float four_pi = 4 * std::numbers::pi_v<float>;
inline constexpr float float_infinity = std::numeric_limits<float>::infinity(),
                       float_nan = std::numeric_limits<float>::quiet_NaN();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                        ulp = std::numeric_limits<double>::epsilon();

/// All of a line, also behind the origin of the ray.
inline const protostar::Interval everywhere{-protostar::infinity, protostar::infinity};

/// The ray from the origin along the z axis, to where a default camera looks.
inline const protostar::Ray ray_along_z{{0, 0, 0}, {0, 0, 1}};

/// Returns true if two colors differ by at most five roundings of float, each of 2^-24 of a channel, for a
/// power with 4π in it, irradiance, its product with a color, a sum, and the expected color.
inline bool near(const protostar::Color& a, const protostar::Color& b) {
  const protostar::Color difference = abs(a - b), most = 5 * 0x1p-25f * (abs(a) + abs(b));
  return difference.r <= most.r && difference.g <= most.g && difference.b <= most.b;
}

inline std::vector<double> list(const protostar::Roots& roots) { return {roots.begin(), roots.end()}; }

/// Returns where a ray crosses a surface, near to far.
inline std::vector<double> crossings_of(const protostar::Surface auto& surface, const protostar::Ray& ray,
                                        protostar::Interval range = {}) {
  std::vector<double> all;
  each_crossing(surface, ray, range, [&](const protostar::Crossing& crossing) { all.push_back(crossing.t); });
  return all;
}

/// Returns where a ray crosses a CSG tree; a solid alone becomes a tree of one leaf.
inline std::vector<double> crossings_of_solid(const protostar::Csg& tree, const protostar::Ray& ray,
                                              protostar::Interval range = {}) {
  return crossings_of(tree, ray, range);
}

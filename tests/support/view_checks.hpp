// Checks of lights as seen from a point: how their directions cover solid angles.
#pragma once

#include <cmath>
#include <cstdint>
#include <protostar/vec3.hpp>

#include "catch.hpp"
#include "jacobian.hpp"
#include "random.hpp"
#include "wrong_cases.hpp"

inline constexpr double u_roundoff = 0x1p-53;

inline double relative_error(double x, double expected) { return std::abs(x / expected - 1); }

/// Largest errors of directions, in units of u, as their views promise them; for a sphere 8u of its frame and
/// 5u in it (warp.cpp).
inline constexpr double of_sphere = 13, of_triangle = 40, of_rectangle = 20, of_disk = 64;

/// Tests whether the map of a view covers solid angles by its density. It does not look next to the
/// diagonals, where concentric maps bend, and next to u = jump.
WrongCases wrong_solid_angles(const auto& view, std::uint64_t seed, double roundings, int count = 200,
                              double jump = 0) {
  Random random(seed);
  WrongCases wrong;
  const auto direction_of = [&](double u, double v) { return view.sample(u, v).direction; };
  for (int i = 0; i < count; ++i) {
    const double u = random.real(0.03, 0.97), v = random.real(0.03, 0.97);
    if (is_at_diagonal(u, v) || std::abs(u - jump) < 0x1p-8) continue;
    const Estimated one = times_density(direction_of, view.sample(u, v).density, u, v, roundings);
    wrong.add(!one.is_one(), seed, u, v, one.value, one.error);
  }
  return wrong;
}

/// Checks that directions are unit vectors and lead to the light, also for numbers close to 0 and 1:
/// off(point) is the distance of a point from the light, and roundings(direction) the largest of a point at a
/// distance of 1, without those of the point itself.
void check_directions(const auto& view, const protostar::Point& from, const auto& off,
                      const auto& roundings) {
  constexpr double low = 0x1p-33;
  WrongCases wrong;
  for (const double u : {low, 0.1, 0.3, 0.5, 0.7, 1 - low})
    for (const double v : {low, 0.2, 0.5, 0.6, 1 - low}) {
      const auto [direction, distance, density] = view.sample(u, v);
      // Axes are unit and perpendicular by at most 6u to 8u, which count twice in the square of a length, and
      // a sum of three products has 3u; also for the length itself, whose root has u.
      wrong.add(!(std::abs(length(direction) - 1) < 20 * u_roundoff), "length", u, v);
      wrong.add(!(std::abs(density * view.solid_angle() - 1) < 2.001 * u_roundoff), "density", u, v);
      // The product with the distance, the sum, and weights or a distance of about 13 operations.
      const double most = (roundings(direction) + 15) * u_roundoff * (1 + distance);
      wrong.add(!(off(from + distance * direction) <= most), "off", u, v, direction);
    }
  CHECK(wrong == 0);
}

/// Returns the roundings of points in a plane to which directions lead that are off by some: at an angle to
/// it they move as much more as the quotient of the distance has errors.
inline auto in_plane(const protostar::Vec3& normal, double roundings) {
  return [=](const protostar::Vec3& direction) { return (roundings + 5) / std::abs(dot(direction, normal)); };
}

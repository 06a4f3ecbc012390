// Reference for the picture of stage 19, in long double. Of the library it has the numbers of the sampler,
// which are whole, and nothing else: directions are turned, lengthened and weighed here.
//
// Nothing is decided exactly: a ray past an edge may differ, and then its pixel is off by a part of the step
// there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/sampling/sobol_sampler.hpp>
#include <utility>

#include "../compare_images/picture.hpp"
#include "geometry.hpp"
#include "pictures.hpp"
#include "primitives.hpp"

namespace reference {

/// Lamp of the picture: a sphere, and its radiance.
struct Lamp {
  Vector center;
  Real radius;
  Vector radiance;
};

inline constexpr Lamp two_lamps[] = {{{-3, 2.25L, 1}, 0.75L, {20, 15, 11}},
                                     {{3.25L, 2.75L, 0.5L}, 0.125L, {400, 480, 600}}};

/// What the closest hit is on: a color, or a lamp.
struct Met {
  Vector color;
  const Lamp* lamp = nullptr;
};

inline Met meet_balls_and_lamps(FirstCrossing& ray) {
  Met met;
  const auto is_any = [](Vector) { return true; };
  for (const auto& [point, normal] : {std::pair<Vector, Vector>{{}, {0, 1, 0}}, {{0, 0, 5}, {0, 0, 1}}})
    if (ray.meet_flat(point, normal, is_any)) met.color = {0.7f, 0.7f, 0.7f};
  if (ray.meet_box({-0.25L, 0, 1}, {0.25L, 2, 1.5L})) met.color = {0.3f, 0.8f, 0.2f};
  if (ray.meet_quadric({0.75L, 0.75L, -1.5L}, {1, 1, 1}, {}, -0.25L)) met.color = {1, 0.4f, 0.1f};
  if (ray.meet_quadric({-1.75L, 0.5L, -0.5L}, {1, 1, 1}, {}, -0.25L)) met.color = {0.3f, 0.5f, 0.9f};
  for (const Lamp& lamp : two_lamps)
    if (ray.meet_quadric(lamp.center, {1, 1, 1}, {}, -lamp.radius * lamp.radius)) met.lamp = &lamp;
  return met;
}

/// Returns the direction from a point to a lamp that two numbers in (0, 1) choose. The square of the numbers
/// becomes the unit disk, by circles for squares around its middle (Shirley and Chiu). The cosine falls by
/// r² (1 − cos γ) from the middle of the cap, at the angle γ of whose rim is sin γ = R/d. The axes are
/// (1, 0, 0) and (0, 1, 0), turned by the shortest way that takes (0, 0, 1) to the lamp's center.
inline Vector towards_lamp(const Lamp& lamp, Vector from, Real u, Real v) {
  const Vector to = lamp.center - from, axis = 1 / length(to) * to;
  const Real sine = lamp.radius / length(to), height = 1 - std::sqrt(1 - sine * sine);
  const Real a = 2 * u - 1, b = 2 * v - 1, most = std::max(std::abs(a), std::abs(b));
  // Along a side of the square the angle grows evenly.
  const Real angle = std::abs(a) > std::abs(b) ? pi / 4 * (b / a) + (a < 0 ? pi : 0)
                                               : pi / 2 - pi / 4 * (a / b) + (b < 0 ? pi : 0);
  const Real cosine = 1 - most * most * height, side = std::sqrt(1 - cosine * cosine);
  // The turn by t around (0, 0, 1) × axis, in which 1/(1 + cos t) takes the place of (1 − cos t)/sin² t
  const Vector x{std::cos(angle), std::sin(angle), 0}, around = cross({0, 0, 1}, axis);
  const Vector turned = axis.z * x + cross(around, x) + dot(around, x) / (1 + axis.z) * around;
  return cosine * axis + side * turned;
}

/// Returns the light along the ray of a sample through a place of the film.
inline Vector two_lamps_along(const protostar::SobolSampler& sampler, Real u, Real v) {
  const Real half = std::tan(pi / 8);
  FirstCrossing seen{{0, 6, -8}, {half * u, 0.8L * half * v - 0.6L, 0.6L * half * v + 0.8L}};
  const auto [color, seen_lamp] = meet_balls_and_lamps(seen);
  if (seen_lamp) return seen_lamp->radiance;
  const Vector p = seen.point(seen.t);
  const Real side = (dot(seen.normal, seen.direction) < 0 ? 1 : -1) / length(seen.normal);
  const auto numbers = sampler(1);
  Vector arriving{0.15f, 0.15f, 0.15f};
  std::size_t i = 0;
  for (const Lamp& lamp : two_lamps) {
    const Vector direction = towards_lamp(lamp, p, numbers[i], numbers[i + 1]);
    i += 2;
    const Real cosine = side * dot(seen.normal, direction);
    FirstCrossing ray{p, direction};
    if (!(cosine > 0) || meet_balls_and_lamps(ray).lamp != &lamp) continue;
    const Vector to = lamp.center - p;
    const Real height = 1 - std::sqrt(1 - lamp.radius * lamp.radius / dot(to, to));
    arriving = arriving + 2 * pi * height * cosine * lamp.radiance;
  }
  return 1 / pi * arriving * color;
}

/// Returns the picture with the mean of so many rays for each pixel.
inline Picture soft_shadows(std::uint32_t samples) {
  constexpr int width = 640, height = 480;
  Picture result{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Vector sum;
      for (std::uint32_t i = 0; i < samples; ++i) {
        const protostar::SobolSampler sampler({.seed = 0,
                                               .x = static_cast<std::uint32_t>(x),
                                               .y = static_cast<std::uint32_t>(y),
                                               .sample = i,
                                               .samples = samples});
        const auto place = sampler(0);
        const Real u = x + Real{place[0]}, v = y + Real{place[1]};
        sum = sum + two_lamps_along(sampler, (2 * u - width) / height, (height - 2 * v) / height);
      }
      const Vector seen = Real{1} / static_cast<Real>(samples) * sum;
      result.pixels.push_back({encode(seen.x, 2.2L), encode(seen.y, 2.2L), encode(seen.z, 2.2L)});
    }
  return result;
}

}  // namespace reference

// Reference for the picture of stage 18, in long double and sharing nothing with the library.
//
// Nothing is decided exactly: a ray through an edge or a line between squares may differ, and then its pixel
// is off by a part of the step there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "../compare_images/picture.hpp"
#include "geometry.hpp"
#include "pictures.hpp"
#include "primitives.hpp"

namespace reference {

/// Returns the color of the closest hit with the balls and the floor, black if there is none.
inline Vector meet_balls_on_floor(FirstCrossing& ray) {
  Vector color;
  if (ray.meet_flat({}, {0, 1, 0}, [](Vector) { return true; })) {
    const Vector p = ray.point(ray.t);
    const Real gray = std::fmod(std::floor(p.x) + std::floor(p.z), 2) == 0 ? 0.8f : 0.1f;
    color = {gray, gray, gray};
  }
  if (ray.meet_quadric({0.5L, 2, 5}, {1, 1, 1}, {}, -4)) color = {1, 0.3f, 0};
  if (ray.meet_quadric({-5, 2, 9}, {1, 1, 1}, {}, -4)) color = {0.2f, 0.7f, 0.1f};
  if (ray.meet_quadric({6, 2, 12}, {1, 1, 1}, {}, -4)) color = {0.2f, 0.4f, 0.8f};
  return color;
}

/// Returns the light of a lamp and ambient light, color · (Φ/(4π) · cos θ / distance² + 0.15), at the closest
/// hit of a ray from (0, 6, −8) along (0, −0.28, 0.96) through a place of the film, or that of the sky.
inline Vector endless_floor_along(Real u, Real v) {
  const Vector lamp{-300, 500, -200};
  const Real half = std::tan(std::acos(Real{-1}) * 25 / 180);
  FirstCrossing seen{{0, 6, -8}, {half * u, 0.96L * half * v - 0.28L, 0.28L * half * v + 0.96L}};
  const Vector color = meet_balls_on_floor(seen);
  if (!std::isfinite(seen.t)) return {0.3f, 0.5f, 0.8f};
  const Vector p = seen.point(seen.t), way = lamp - p;
  const Real side = dot(seen.normal, seen.direction) < 0 ? 1 : -1;
  const Real height = side * dot(seen.normal, way) / (length(seen.normal) * length(way));
  FirstCrossing shadow{p, way};
  meet_balls_on_floor(shadow);
  const bool is_lit = height > 0 && shadow.t >= 1;
  const Real irradiance = is_lit ? 4e6L / (4 * std::numbers::pi_v<Real> * dot(way, way)) * height : 0;
  return (irradiance + 0.15f) * color;
}

/// Returns the picture with the mean of 2^digits rays for each pixel: ray i is in the middle of column i of
/// as many columns, and in the row whose number has the binary digits of i backwards.
inline Picture endless_floor(int digits) {
  constexpr int width = 640, height = 480;
  const int samples = 1 << digits;
  const auto place = [&](int whole, int part) { return whole + (part + 0.5L) / samples; };
  std::vector<int> rows(1);  // by column; each digit more puts a digit before those of the row
  for (int digit = 0; digit < digits; ++digit) {
    for (int& row : rows) row *= 2;
    for (std::size_t i = 0, count = rows.size(); i < count; ++i) rows.push_back(rows[i] + 1);
  }
  Picture result{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Vector sum;
      for (int i = 0; i < samples; ++i)
        sum = sum + endless_floor_along((2 * place(x, i) - width) / height,
                                        (height - 2 * place(y, rows[static_cast<std::size_t>(i)])) / height);
      const Vector seen = Real{1} / samples * sum;
      result.pixels.push_back({encode(seen.x, 2.2L), encode(seen.y, 2.2L), encode(seen.z, 2.2L)});
    }
  return result;
}

}  // namespace reference

// Reference for the pictures of stages 10 to 13, 16 and 27, from the formulas, in long double and sharing
// nothing with the library.
//
// Reflected and refracted rays start at points that are not whole, so nothing here is decided exactly. A
// rounding is at most 2^-64, and grows by about the ratio of a distance to a radius at every bounce: in a
// path of five rays it stays below 1e-12, except for nearly tangent rays. Hence pixels at an edge may differ.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "../compare_images/picture.hpp"
#include "geometry.hpp"
#include "scenes/dusk.hpp"

namespace reference {

/// Material of a surface. Colors are floats in the library, hence these floats here.
struct Stuff {
  Vector diffuse, specular;
  Real shininess = 1, reflect = 0, refract = 0;
  std::array<Real, 2> waves{};  ///< number of waves of stage 27, around and down; none if both are 0
};

inline const Stuff ivory{{0.36f, 0.36f, 0.27f}, {0.5L, 0.5L, 0.5L}, 50, 0.1L, 0};
inline const Stuff dull_ivory{{0.36f, 0.36f, 0.27f}, {0.5L, 0.5L, 0.5L}, 50, 0, 0};
inline const Stuff glass{{}, {0.9f, 0.9f, 0.9f}, 125, 0.1L, 0.8L};
inline const Stuff rubber{{0.42f, 0.14f, 0.14f}, {0.3f, 0.3f, 0.3f}, 10, 0, 0};
inline const Stuff mirror{{}, {16, 16, 16}, 1425, 0.8L, 0};

inline const Stuff bumpy_ivory{dull_ivory.diffuse, dull_ivory.specular, 50, 0, 0, {24, 12}};
inline const Stuff ribbed_rubber{rubber.diffuse, rubber.specular, 10, 0, 0, {0, 12}};

/// Scene of four balls, each with its material, and optionally a floor: y = −4 over |x| < 10, 10 < z < 30, in
/// squares of 2.
struct FourSpheres {
  std::array<Stuff, 4> stuff;
  bool has_floor = false;
  bool has_dusk = false;  ///< environment of stage 16, instead of a sky of one color
  int most_rays = 5;

  [[nodiscard]] Vector light_along(Vector direction) const {
    return light_along({}, 1 / length(direction) * direction, -1, most_rays);
  }

 private:
  static constexpr int floor = 4;
  static constexpr std::array<std::array<Real, 4>, 4> balls{
      {{-3, 0, 16, 2}, {-1, -1.5L, 12, 2}, {1.5L, -0.5L, 18, 3}, {7, 5, 18, 4}}};

  static Vector center(int i) {
    const auto& ball = balls[static_cast<std::size_t>(i)];
    return {ball[0], ball[1], ball[2]};
  }
  static Real radius(int i) { return balls[static_cast<std::size_t>(i)][3]; }

  static Vector dusk_along(Vector d) {
    const Real half_turn = std::acos(Real{-1});
    const auto seen = dusk(static_cast<double>(0.5L + std::atan2(d.x, d.z) / (2 * half_turn)),
                           static_cast<double>(std::acos(std::clamp<Real>(d.y, -1, 1)) / half_turn));
    return {seen.r, seen.g, seen.b};
  }

  /// Returns the normal of a ball with waves: each slope turns it towards the east or the south.
  static Vector with_waves(Vector n, const std::array<Real, 2>& waves) {
    const Real full_turn = 2 * std::acos(Real{-1});
    const Vector east{n.z, 0, -n.x};
    const Vector south{n.x * n.y, n.y * n.y - 1, n.z * n.y};  // n y − (0, 1, 0), as high as east is long
    const Real to_east = std::sin(full_turn * waves[0] * (0.5L + std::atan2(n.x, n.z) / full_turn));
    const Real to_south = std::sin(waves[1] * 2 * std::acos(std::clamp<Real>(n.y, -1, 1)));
    const Vector m = n + 0.5L / length(east) * (to_east * east + to_south * south);
    return 1 / length(m) * m;
  }

  struct Met {
    int what = -1;
    Real t = std::numeric_limits<Real>::infinity();
  };

  /// Returns the closest hit of a ray from a point, which lies on the surface left.
  [[nodiscard]] Met first(Vector from, Vector d, int left) const {
    Met met;
    const auto consider = [&](int what, Real t) {
      if (t > 0 && t < met.t) met = {what, t};
    };
    for (int i = 0; i < 4; ++i) {
      // |from + t d − C|² = R²  is  t² d·d + 2 t d·(from − C) + |from − C|² − R² = 0.
      const Vector v = from - center(i);
      const Real a = dot(d, d), b = dot(d, v);
      if (i == left) {  // from is on it, so |from − C|² = R²: t = 0 or this
        consider(i, -2 * b / a);
        continue;
      }
      const Real discriminant = b * b - a * (dot(v, v) - radius(i) * radius(i));
      if (discriminant < 0) continue;
      consider(i, (-b - std::sqrt(discriminant)) / a);
      consider(i, (-b + std::sqrt(discriminant)) / a);
    }
    if (has_floor && left != floor) {
      const Real t = (-4 - from.y) / d.y;
      const Vector p = from + t * d;
      if (std::abs(p.x) < 10 && 10 < p.z && p.z < 30) consider(floor, t);
    }
    return met;
  }

  [[nodiscard]] Stuff stuff_at(int what, Vector p) const {
    if (what != floor) return stuff[static_cast<std::size_t>(what)];
    const auto square = [](Real x) { return static_cast<int>(x / 2); };  // x ≥ 0
    const bool odd = (square(p.x + 10) + square(p.z - 10)) % 2 != 0;
    Stuff board;
    board.diffuse = odd ? Vector{0.6f, 0.6f, 0.6f} : Vector{0.6f, 0.4f, 0.2f};
    return board;
  }

  /// Returns the light along a ray of unit direction that starts on the surface left:
  ///   Σ (diffuse · n·l + specular · (r·v)^shininess) + reflect · mirrored + refract · refracted
  /// with the sum over the visible lights, each of 1, where l leads to the light, r is l mirrored, v leads to
  /// the eye.
  [[nodiscard]] Vector light_along(Vector from, Vector d, int left, int rays) const {
    const Met met = rays > 0 ? first(from, d, left) : Met{};
    if (met.what < 0) return has_dusk ? dusk_along(d) : Vector{0.2f, 0.7f, 0.8f};
    const Vector p = from + met.t * d;
    const Stuff is = stuff_at(met.what, p);
    Vector n = met.what == floor ? Vector{0, 1, 0} : 1 / radius(met.what) * (p - center(met.what));
    const bool from_outside = dot(n, d) < 0;
    Vector shading = is.waves == std::array<Real, 2>{} ? n : with_waves(n, is.waves);
    if (!from_outside) n = Real{-1} * n, shading = Real{-1} * shading;

    Vector sum;
    for (const Vector lamp : {Vector{-20, 20, -20}, Vector{30, 50, 25}, Vector{30, 20, -30}}) {
      const Vector way = lamp - p;
      const Vector l = 1 / length(way) * way;
      if (dot(n, l) <= 0 || dot(shading, l) <= 0 || first(p, way, met.what).t < 1) continue;
      const Vector r = 2 * dot(shading, l) * shading - l;
      const Real shine = std::max<Real>(-dot(r, d), 0);
      sum = sum + dot(shading, l) * is.diffuse + std::pow(shine, is.shininess) * is.specular;
    }
    if (is.reflect > 0) sum = sum + is.reflect * light_along(p, d - 2 * dot(n, d) * n, met.what, rays - 1);
    if (is.refract > 0) {
      // The tangential part is divided by the index, and the normal part completes it to length 1.
      const Real index = from_outside ? 1.5L : 1 / 1.5L;
      const Vector along = 1 / index * (d - dot(n, d) * n);
      const Real across = 1 - dot(along, along);
      if (across > 0)
        sum = sum + is.refract * light_along(p, along - std::sqrt(across) * n, met.what, rays - 1);
    }
    return sum;
  }
};

/// Returns the picture of linear light, each pixel divided by its largest channel if that is above 1.
inline Picture picture(const FourSpheres& scene, int width = 1024, int height = 768) {
  const Real half = std::tan(60.16056848873644L * std::acos(Real{-1}) / 360);
  Picture result{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vector whole = through_pixel(x, y, width, height).real();
      const Vector seen = scene.light_along({half * whole.x, half * whole.y, whole.z});
      const Real largest = std::max({seen.x, seen.y, seen.z, Real{1}});
      const auto code = [&](Real channel) {
        return static_cast<std::uint8_t>(std::lround(255 * channel / largest));
      };
      result.pixels.push_back({code(seen.x), code(seen.y), code(seen.z)});
    }
  return result;
}

}  // namespace reference

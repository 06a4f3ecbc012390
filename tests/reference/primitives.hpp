// Reference for the picture of stage 14, in long double and sharing nothing with the library.
//
// Nothing is decided exactly: pixels at an edge or at a line between squares may differ.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry.hpp"

namespace reference {

/// Closest hit of a ray so far, and a normal of any length and on any side.
struct FirstCrossing {
  Vector from, direction;
  Real t = std::numeric_limits<Real>::infinity();
  Vector normal = {};

  [[nodiscard]] Vector point(Real at) const { return from + at * direction; }

  /// Takes a crossing if it is the closest so far; returns true if it is. The point that a ray starts from is
  /// about 1e-18 from its surface, and is excluded by t > 1e-12.
  bool take(Real at, Vector its_normal) {
    if (!(at > 1e-12L && at < t)) return false;
    t = at;
    normal = its_normal;
    return true;
  }

  /// Intersects the quadric w·Sw + 2 l·w + k = 0 for w = p − center and a diagonal S.
  bool meet_quadric(Vector center, Vector squares, Vector linear, Real constant) {
    const Vector o = from - center, gradient = squares * o + linear;
    const Real a = dot(direction, squares * direction), b = dot(direction, gradient);
    const Real c = dot(o, gradient) + dot(o, linear) + constant, D = b * b - a * c;
    if (D < 0) return false;
    bool is_first = false;
    for (const Real at : {(-b - std::sqrt(D)) / a, (-b + std::sqrt(D)) / a})
      is_first |= take(at, squares * (point(at) - center) + linear);
    return is_first;
  }

  bool meet_flat(Vector corner, Vector its_normal, auto&& contains) {
    const Real at = dot(its_normal, corner - from) / dot(its_normal, direction);
    return contains(point(at)) && take(at, its_normal);
  }

  /// Intersects a polygon whose corners are in order around it; points inside are on one side of all edges.
  bool meet_polygon(const std::vector<Vector>& corners) {
    const Vector n = cross(corners[1] - corners[0], corners[2] - corners[0]);
    return meet_flat(corners[0], n, [&](Vector p) {
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector &a = corners[i], &b = corners[(i + 1) % corners.size()];
        if (dot(cross(b - a, p - a), n) < 0) return false;
      }
      return true;
    });
  }

  bool meet_box(Vector low, Vector high) {
    bool is_first = false;
    const auto is_in = [](Real x, Real from_x, Real to_x) { return from_x <= x && x <= to_x; };
    for (const Vector& corner : {low, high}) {
      is_first |= meet_flat(corner, {1, 0, 0},
                            [&](Vector p) { return is_in(p.y, low.y, high.y) && is_in(p.z, low.z, high.z); });
      is_first |= meet_flat(corner, {0, 1, 0},
                            [&](Vector p) { return is_in(p.x, low.x, high.x) && is_in(p.z, low.z, high.z); });
      is_first |= meet_flat(corner, {0, 0, 1},
                            [&](Vector p) { return is_in(p.x, low.x, high.x) && is_in(p.y, low.y, high.y); });
    }
    return is_first;
  }
};

/// Returns the color of the closest hit, black if there is none.
inline Vector meet_primitives(FirstCrossing& ray) {
  Vector color;
  if (ray.meet_flat({}, {0, 1, 0}, [](Vector) { return true; })) {
    const Vector p = ray.point(ray.t);
    const Real gray = std::fmod(std::floor(p.x) + std::floor(p.z), 2) == 0 ? 0.6f : 0.25f;
    color = {gray, gray, gray};
  }
  if (ray.meet_quadric({}, {2, 0, 2}, {0, 0.5L, 0}, -2)) color = {0.2f, 0.7f, 0.1f};
  if (ray.meet_quadric({-2.5L, 0.75L, -1.5L}, {1, 1, 1}, {}, -0.75L * 0.75L)) color = {1, 0.3f, 0};
  if (ray.meet_box({1.5L, 0, -2.25L}, {2.75L, 1.25L, -1})) color = {0.2f, 0.4f, 0.8f};
  const Vector middle{-3, 1.25L, 2};
  if (ray.meet_flat(middle, {1, 1, -2}, [&](Vector p) { return length(p - middle) <= 1.25L; }))
    color = {0.9f, 0.7f, 0.1f};
  if (ray.meet_polygon({{-1, 0, -3}, {0.75L, 0, -2.5L}, {0.5L, 1.25L, -2}})) color = {1, 0.35f, 0.5f};
  if (ray.meet_polygon({{2, 0, 1.5L}, {4, 0, 0.5L}, {4.5L, 1.75L, 1}, {2.5L, 1.75L, 2}}))
    color = {0.1f, 0.6f, 0.6f};
  return color;
}

/// Returns the light of a lamp and ambient light, color · (Φ/(4π) · cos θ / distance² + 0.1), at the closest
/// hit of a ray from (0, 4, −6) along (0, −0.6, 0.8) through a pixel, for a field of view of 60°.
inline Vector primitives_along(Whole pixel) {
  const Vector whole = pixel.real(), lamp{-3, 6, -4};
  const Real half = std::tan(std::acos(Real{-1}) / 6), right = half * whole.x, up = half * whole.y;
  FirstCrossing seen{{0, 4, -6}, {right, 0.8L * up - 0.6L * whole.z, 0.6L * up + 0.8L * whole.z}};
  const Vector color = meet_primitives(seen);
  if (!std::isfinite(seen.t)) return {};
  const Vector p = seen.point(seen.t), way = lamp - p;
  const Real side = dot(seen.normal, seen.direction) < 0 ? 1 : -1;
  const Real height = side * dot(seen.normal, way) / (length(seen.normal) * length(way));
  FirstCrossing shadow{p, way};
  meet_primitives(shadow);
  const bool is_lit = height > 0 && shadow.t >= 1;
  const Real irradiance = is_lit ? 550 / (4 * std::numbers::pi_v<Real> * dot(way, way)) * height : 0;
  return (irradiance + 0.1f) * color;
}

}  // namespace reference

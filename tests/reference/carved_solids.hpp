// Reference for the picture of stage 15, in long double and sharing nothing with the library.
//
// Along a ray, the inside of a solid consists of a few intervals. Between all of their ends in order, the
// middle of each piece is tested against every solid. Nothing is decided exactly: pixels at an edge may
// differ.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "geometry.hpp"

namespace reference {

/// Returns v rotated about an axis, v cos + (a × v) sin + a (a·v)(1 − cos) for the unit vector a along it.
inline Vector turned(Vector v, Vector axis, Real degrees) {
  const Real angle = degrees * std::acos(Real{-1}) / 180, c = std::cos(angle), s = std::sin(angle);
  const Vector a = 1 / length(axis) * axis;
  const Vector across{a.y * v.z - a.z * v.y, a.z * v.x - a.x * v.z, a.x * v.y - a.y * v.x};
  return c * v + s * across + (1 - c) * dot(a, v) * a;
}

/// Solid of the second degree, |S (p − center)| ≤ radius, where S = kept leaves out some axes; or a box.
struct Primitive {
  Vector center, kept;
  Real radius = 0;
  std::optional<Vector> low = {}, high = {};

  [[nodiscard]] bool contains(Vector p) const {
    if (low) {
      const Vector &a = *low, &b = *high;
      return a.x <= p.x && p.x <= b.x && a.y <= p.y && p.y <= b.y && a.z <= p.z && p.z <= b.z;
    }
    const Vector w = kept * (p - center);
    return dot(w, w) <= radius * radius;
  }

  /// Adds the values of t at which a line may go in or out.
  void add_ends(Vector o, Vector d, std::vector<Real>& ends) const {
    if (low) {
      for (const Vector& at : {*low, *high}) {
        ends.push_back((at.x - o.x) / d.x);
        ends.push_back((at.y - o.y) / d.y);
        ends.push_back((at.z - o.z) / d.z);
      }
      return;
    }
    const Vector v = kept * (o - center), w = kept * d;
    const Real a = dot(w, w), b = dot(v, w), D = b * b - a * (dot(v, v) - radius * radius);
    if (D < 0) return;
    ends.push_back((-b - std::sqrt(D)) / a);
    ends.push_back((-b + std::sqrt(D)) / a);
  }

  /// Returns the outward normal at a point of the boundary.
  [[nodiscard]] Vector normal(Vector p) const {
    if (!low) return 1 / radius * (kept * (p - center));
    Vector n;
    Real nearest = 1;
    const auto look = [&](Real distance, Vector normal) {
      if (std::abs(distance) < nearest) nearest = std::abs(distance), n = normal;
    };
    look(p.x - low->x, {-1, 0, 0}), look(p.y - low->y, {0, -1, 0}), look(p.z - low->z, {0, 0, -1});
    look(p.x - high->x, {1, 0, 0}), look(p.y - high->y, {0, 1, 0}), look(p.z - high->z, {0, 0, 1});
    return n;
  }

  /// Returns the distance of a point from the boundary, at least to first order.
  [[nodiscard]] Real distance(Vector p) const {
    if (!low) return std::abs(length(kept * (p - center)) - radius);
    Real nearest = std::numeric_limits<Real>::infinity();
    for (const Vector& w : {p - *low, *high - p})
      nearest = std::min({nearest, std::abs(w.x), std::abs(w.y), std::abs(w.z)});
    return nearest;
  }
};

/// Points that are in all of the first solids and in none of the others.
struct Carved {
  std::vector<Primitive> all, none;
  Vector color;
  std::function<Vector(Vector)> to_world;  ///< rotation to world directions
  std::function<Vector(Vector)> to_own;
  Vector place;

  [[nodiscard]] bool contains(Vector p) const {
    const auto is_in = [&](const Primitive& solid) { return solid.contains(p); };
    return std::all_of(all.begin(), all.end(), is_in) && std::none_of(none.begin(), none.end(), is_in);
  }

  /// Returns the first t > 0 at which a line from a point outside goes in.
  [[nodiscard]] std::optional<Real> first(Vector from, Vector direction) const {
    const Vector o = to_own(from - place), d = to_own(direction);
    std::vector<Real> ends;
    for (const auto* list : {&all, &none})
      for (const Primitive& solid : *list) solid.add_ends(o, d, ends);
    // A point on the solid itself is about 1e-18 from it.
    std::erase_if(ends, [](Real t) { return !(t > 1e-12L); });
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      if (contains(o + (ends[i] + ends[i + 1]) / 2 * d)) return ends[i];
    return std::nullopt;
  }

  /// Returns the outward normal, that of the solid with the nearest boundary, reversed if it is subtracted.
  [[nodiscard]] Vector normal(Vector at) const {
    const Vector p = to_own(at - place);
    Real nearest = std::numeric_limits<Real>::infinity();
    Vector n;
    for (const auto* list : {&all, &none})
      for (const Primitive& solid : *list)
        if (const Real distance = solid.distance(p); distance < nearest) {
          nearest = distance;
          n = list == &all ? solid.normal(p) : Real{-1} * solid.normal(p);
        }
    return to_world(n);
  }
};

inline std::vector<Carved> carved_solids() {
  const auto ball = [](Real z, Real radius) { return Primitive{{0, 0, z}, {1, 1, 1}, radius}; };
  const auto box = [](Vector low, Vector high) { return Primitive{{}, {}, 0, low, high}; };
  const Vector x{1, 0, 0}, y{0, 1, 0}, bowl{2, 0, 1};
  return {{{box({-1, -1, -1}, {1, 1, 1}), ball(0, 1.375L)},
           {{{}, {0, 1, 1}, 0.625L}, {{}, {1, 0, 1}, 0.625L}, box({-0.5L, -0.5L, -1}, {0.5L, 0.5L, 1})},
           {1, 0.3f, 0},
           [=](Vector v) { return turned(turned(v, y, 35), x, -25); },
           [=](Vector v) { return turned(turned(v, x, 25), y, -35); },
           {0, 0, 5}},
          {{ball(0, 1)},
           {ball(0, 0.875L), box({-1, 0.25L, -1}, {1, 1, 1})},
           {0.2f, 0.7f, 0.1f},
           [=](Vector v) { return turned(v, bowl, -40); },
           [=](Vector v) { return turned(v, bowl, 40); },
           {-2.5L, -0.5L, 6}},
          {{ball(-1, 1.375L), ball(1, 1.375L)},
           {},
           {0.2f, 0.4f, 0.8f},
           [=](Vector v) { return turned(v, y, 75); },
           [=](Vector v) { return turned(v, y, -75); },
           {2.5L, -0.5L, 5.5L}}};
}

/// Returns the light of a lamp and ambient light, color · (Φ/(4π) · cos θ / distance² + 0.1), at the closest
/// hit of a ray from the origin through a pixel, for a field of view of 60°.
inline Vector carved_solids_along(Whole pixel) {
  static const std::vector<Carved> solids = carved_solids();
  const Vector whole = pixel.real(), lamp{-2, 4, 0};
  const Real half = std::tan(std::acos(Real{-1}) / 6);
  const Vector d{half * whole.x, half * whole.y, whole.z};
  const Real floor = -1.5L / d.y;
  Real t = floor > 0 ? floor : std::numeric_limits<Real>::infinity();
  const Carved* seen = nullptr;
  for (const Carved& solid : solids)
    if (const auto met = solid.first({}, d); met && *met < t) t = *met, seen = &solid;
  if (!std::isfinite(t)) return {};
  const Vector p = t * d, way = lamp - p;
  const Vector n = seen ? seen->normal(p) : Vector{0, 1, 0};
  const Vector color = seen ? seen->color : Vector{0.6f, 0.6f, 0.6f};
  const Real height = dot(n, way) / length(way);
  const bool is_lit = height > 0 && std::none_of(solids.begin(), solids.end(), [&](const Carved& solid) {
                        const auto met = solid.first(p, way);
                        return met && *met < 1;
                      });
  const Real irradiance = is_lit ? 600 / (4 * std::numbers::pi_v<Real> * dot(way, way)) * height : 0;
  return (irradiance + 0.1f) * color;
}

}  // namespace reference

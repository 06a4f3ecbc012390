// Where a ray crosses a surface, and what can be asked there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "magnitude.hpp"
#include "material.hpp"
#include "numeric/exact_root.hpp"
#include "numeric/roots.hpp"
#include "ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// One crossing of a ray with a surface: the ray's parameter, and which of the surface's crossings with the
/// ray's line it is, counted from 0. On a surface that is made of parts, it is one of the part's crossings.
struct Crossing {
  double t = 0;
  int root = 0;
  int part = 0;  ///< which of a surface's parts is crossed, as the surface counts them
};

/// What can be asked of a surface whose type has been forgotten; the first argument is the surface.
/// surface.hpp has one such table for each type.
struct SurfaceFunctions {
  Vec3 (*normal_at)(const void* surface, const Point& point, int part);
  Uv (*uv_at)(const void* surface, const Point& point, int part);
  Departure (*departure)(const void* surface, int part);
  ExactRoot (*exact_root)(const void* surface, const Ray& ray, const Crossing& crossing);
};

/// A crossing with the surface that it is on, whatever the type of that.
struct SurfaceCrossing {
  Crossing crossing;
  const void* surface = nullptr;
  const SurfaceFunctions* functions = nullptr;
  const Material* material = nullptr;

  [[nodiscard]] Vec3 normal_at(const Point& point) const {
    return functions->normal_at(surface, point, crossing.part);
  }
  [[nodiscard]] Uv uv_at(const Point& point) const { return functions->uv_at(surface, point, crossing.part); }
  [[nodiscard]] Departure departure() const { return departure(crossing.part); }
  [[nodiscard]] Departure departure(int part) const {
    Departure departure = functions->departure(surface, part);
    departure.in_scene = surface;
    return departure;
  }
  [[nodiscard]] ExactRoot exact_root(const Ray& ray) const {
    return functions->exact_root(surface, ray, crossing);
  }
};

namespace detail {

/// precedes where the errors of t overlap: without rounding.
[[nodiscard, gnu::noinline, gnu::cold]] inline bool precedes_refined(Ray ray, SurfaceCrossing a,
                                                                     SurfaceCrossing b) {
  // What coincides exactly needs no more arithmetic. Where one of two planes is rounded, they may be left
  // together and be two nevertheless.
  if (a.crossing.root == b.crossing.root) {
    const Departure left = a.departure(), other = b.departure();
    const auto is_exact = [](const Departure& one) { return one.kind != Departure::Kind::rounded_plane; };
    if (is_exact(left) && is_exact(other) && left == other) return false;
  }
  return order(a.exact_root(ray), b.exact_root(ray)) < 0;
}

}  // namespace detail

/// Whether a ray crosses a before b: decided by their t where their errors allow, and exactly where not.
/// Crossings of surfaces that coincide are at equal t.
[[nodiscard]] inline bool precedes(const Ray& ray, const SurfaceCrossing& a, const SurfaceCrossing& b) {
  const double gap = b.crossing.t - a.crossing.t;
  const double larger = std::max(std::abs(a.crossing.t), std::abs(b.crossing.t));
  if (std::abs(gap) > 4 * Roots::relative_error * larger) return gap > 0;
  return detail::precedes_refined(ray, a, b);
}

/// The same for surfaces that have places in an order: of crossings at equal t, that of the earlier surface
/// is the first.
[[nodiscard]] inline bool precedes(const Ray& ray, const SurfaceCrossing& a, std::int64_t place_a,
                                   const SurfaceCrossing& b, std::int64_t place_b) {
  return place_a < place_b ? !precedes(ray, b, a) : precedes(ray, a, b);
}

/// A crossing of a ray with a surface. It holds t and works out the rest when it is asked, so that an
/// integrator pays only for what it uses. It is valid as long as the scene that it comes from lives and gets
/// no further surfaces.
class Intersection {
 public:
  using Light = Color;  ///< what its ray brings

  /// The ray's parameter here. A distance in scene units where the ray's direction is a unit vector.
  double t;

  Intersection(const Ray& ray, const SurfaceCrossing& on) : t(on.crossing.t), ray_(ray), on_(on) {}

  /// Where it is.
  [[nodiscard]] Point point() const { return ray_.at(std::min(t, farthest_point)); }

  /// The direction of the ray.
  [[nodiscard]] const Vec3& direction() const { return ray_.direction; }

  /// The surface's unit normal, on the side that the surface calls its outside (§2.3.1).
  [[nodiscard]] Vec3 normal() const { return on_.normal_at(point()); }

  /// The unit normal on the side that the ray comes from: surfaces are two-sided (§2.3.2).
  [[nodiscard]] Vec3 facing_normal() const {
    const Vec3 n = normal();
    return dot(n, ray_.direction) <= 0 ? n : -n;
  }

  /// Which of the surface's parts it is on, as the surface counts them; 0 for one without parts.
  [[nodiscard]] int part() const { return on_.crossing.part; }

  /// What the surface is made of.
  [[nodiscard]] const Material& material() const { return *on_.material; }

  /// Where it is on the surface, in the surface's own coordinates; 0 and 0 on one that has none.
  [[nodiscard]] Uv uv() const { return on_.uv_at(point()); }

  /// The surface's color here: the diffuse color of its material, or what that has for a texture.
  [[nodiscard]] Color color() const {
    if (!material().texture) return material().diffuse;
    const Uv place = uv();
    return material().texture(place.x, place.y);
  }

  /// The ray from here in a direction of any length. It knows what it departs from and does not meet it again
  /// at its origin; there is no offset.
  [[nodiscard]] Ray leave(const Vec3& direction) const { return {point(), direction, on_.departure()}; }

  /// t to 1 ulp, for a surface that knows its exact roots, as those of the library do; otherwise t as it is.
  [[nodiscard]] double refined() const {
    return static_cast<double>(protostar::refined(on_.exact_root(ray_)));
  }

  /// Whether this is strictly before another crossing of the same ray. The order is exact for surfaces that
  /// know their exact roots; see precedes.
  [[nodiscard]] bool operator<(const Intersection& other) const { return precedes(ray_, on_, other.on_); }

 private:
  Ray ray_;
  SurfaceCrossing on_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

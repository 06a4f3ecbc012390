// Crossings of rays with surfaces, and the point, normal and color there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <optional>

#include "magnitude.hpp"
#include "material.hpp"
#include "normals.hpp"
#include "numeric/exact_root.hpp"
#include "numeric/roots.hpp"
#include "ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Crossing of a ray with a surface.
struct Crossing {
  double t = 0;  ///< parameter of the ray

  /// Index of the crossing among the roots of the ray's line on this surface or primitive, near to far,
  /// without the root 0 of a ray that departs from it. For a surface that offers only intersect, or is
  /// marched, a running number within the search.
  int root = 0;

  int primitive = 0;  ///< index of the crossed primitive, as the surface counts them
};

/// Table of functions for a surface whose type is erased; their first argument is the surface, which
/// Departure::surface names. surface.hpp has one such table for each type.
struct SurfaceFunctions {
  /// Maps a point in the scene at a time back to the pose in which the moving surface was defined. The
  /// functions below that take a point expect that one. Null for types of surfaces that never move.
  Point (*at_rest)(const void* surface, const Point& point, double time);
  Vec3 (*normal_at)(const void* surface, const Point& point, int primitive);
  Uv (*uv_at)(const void* surface, const Point& point, int primitive);
  Tangents (*tangents_at)(const void* surface, const Point& point, int primitive);
  Departure (*departure)(const void* surface, int primitive);
  ExactRoot (*exact_root)(const void* surface, const Ray& ray, const Crossing& crossing);
};

/// Properties that are the same at all points of a surface, computed once for a picture.
struct SurfaceConstants {
  std::optional<Departure> departure;  ///< none for a surface made of primitives, which have one each
  std::optional<Vec3> normal;          ///< unit normal; none for a surface that is not flat (is_flat)
};

/// Crossing with the surface that it is on, of any type.
struct SurfaceCrossing {
  Crossing crossing;
  const void* surface = nullptr;
  const SurfaceFunctions* functions = nullptr;
  const Material* material = nullptr;
  const SurfaceConstants* constants = nullptr;  ///< null: the surface computes all at each hit
};

namespace detail {

/// Returns precedes(ray, a, b) for errors of t that overlap, decided without rounding.
[[nodiscard, gnu::noinline, gnu::cold]] inline bool precedes_refined(Ray ray, SurfaceCrossing a,
                                                                     SurfaceCrossing b) {
  // Surfaces that coincide exactly need no more arithmetic. If one of two planes is rounded, they may be left
  // together and be two nevertheless.
  if (a.crossing.root == b.crossing.root) {
    const Departure of_a = a.functions->departure(a.surface, a.crossing.primitive),
                    of_b = b.functions->departure(b.surface, b.crossing.primitive);
    const auto is_exact = [](const Departure& one) { return one.kind != Departure::Kind::rounded_plane; };
    if (is_exact(of_a) && is_exact(of_b) && of_a == of_b) return false;
  }
  return order(a.functions->exact_root(a.surface, ray, a.crossing),
               b.functions->exact_root(b.surface, ray, b.crossing)) < 0;
}

}  // namespace detail

/// Returns the shading normal that a normal map gives to a point of a surface, or of a primitive of it, whose
/// own normal is given.
[[nodiscard, gnu::noinline, gnu::cold]] inline Vec3 mapped_normal(const NormalMap& map, const void* surface,
                                                                  const SurfaceFunctions& functions,
                                                                  const Point& point, int primitive,
                                                                  const Vec3& normal) {
  const Uv uv = functions.uv_at(surface, point, primitive);
  return out_of_tangent_space(map(uv.x, uv.y), normal, functions.tangents_at(surface, point, primitive));
}

/// Returns true if a ray crosses a before b, decided by their t if the errors allow, otherwise exactly.
/// Crossings of surfaces that coincide are at equal t.
[[nodiscard]] inline bool precedes(const Ray& ray, const SurfaceCrossing& a, const SurfaceCrossing& b) {
  const double gap = b.crossing.t - a.crossing.t;
  const double larger = std::max(std::abs(a.crossing.t), std::abs(b.crossing.t));
  if (std::abs(gap) > 4 * Roots::relative_error * larger) return gap > 0;
  return detail::precedes_refined(ray, a, b);
}

/// Returns true if a ray crosses a before b, or at equal t if the surface of a has the smaller index; index_a
/// and index_b are the surfaces' indices.
[[nodiscard]] inline bool precedes(const Ray& ray, const SurfaceCrossing& a, std::int64_t index_a,
                                   const SurfaceCrossing& b, std::int64_t index_b) {
  return index_a < index_b ? !precedes(ray, b, a) : precedes(ray, a, b);
}

/// Hit of a ray on a surface. It holds t and computes the rest on demand, so that an integrator pays only for
/// what it uses. It is valid as long as its scene lives and gets no further surfaces; one that a path meets
/// in a picture, until the picture is drawn.
class Intersection {
 public:
  using Light = Color;  ///< type of radiance (Color, or Colors for packets), not a light source

  /// Parameter of the ray here, a distance in scene units if the ray's direction is a unit vector.
  double t;

  /// Copies numbers one by one, as they have often just been stored (copied, vec3.hpp).
  Intersection(const Ray& ray, const SurfaceCrossing& on)
      : t(on.crossing.t),
        ray_(copied(ray)),
        on_{.crossing = {on.crossing.t, on.crossing.root, on.crossing.primitive},
            .surface = on.surface,
            .functions = on.functions,
            .material = on.material,
            .constants = on.constants} {}

  /// Returns the point of the ray at t, with t limited to 2^440 (most_t).
  [[nodiscard]] Point point() const { return ray_.at(std::min(t, most_t)); }

  /// Returns the direction of the ray.
  [[nodiscard]] const Vec3& direction() const { return ray_.direction; }

  /// Returns the time of the ray, at which it hits a moving surface.
  [[nodiscard]] double time() const { return ray_.time; }

  /// Returns the unit normal that the surface gives here, before any normal map, on the side that the surface
  /// calls its outside (§2.3.1). On a mesh with vertex normals it is interpolated from these and differs from
  /// the triangle's geometric normal.
  [[nodiscard]] Vec3 surface_normal() const {
    if (on_.constants != nullptr && on_.constants->normal) return *on_.constants->normal;
    return on_.functions->normal_at(on_.surface, at_rest(), primitive());
  }

  /// Returns surface_normal() and the shading normal, which the material's normal map tilts, both on the
  /// surface's outside.
  [[nodiscard]] Normals<Vec3> normals() const {
    Normals<Vec3> n{.surface = surface_normal(), .shading = {}};
    n.shading = copied(n.surface);
    if (material().normal_map) [[unlikely]] {
      n.shading = mapped_normal(material().normal_map, on_.surface, *on_.functions, at_rest(), primitive(),
                                n.surface);
      n.is_mapped = true;
    }
    return n;
  }

  /// Returns the same two normals on the side that the ray comes from, as surfaces are two-sided (§2.3.2).
  [[nodiscard]] Normals<Vec3> facing_normals() const { return normals().facing(ray_.direction); }

  /// Returns the shading normal, on the surface's outside.
  [[nodiscard]] Vec3 normal() const { return normals().shading; }

  /// Returns the shading normal, on the side that the ray comes from.
  [[nodiscard]] Vec3 facing_normal() const { return facing_normals().shading; }

  /// Returns the height of a light over the surface, given the vector l to it: n·l with the shading normal n
  /// on the side that the ray comes from; at most 0 if the light is behind the surface, whatever n is.
  [[nodiscard]] double height(const Vec3& to_light) const {
    if (material().normal_map) [[unlikely]]
      return facing_normals().height(to_light);
    const Vec3 n = surface_normal();
    return dot(dot(n, ray_.direction) <= 0 ? n : -n, to_light);
  }

  /// Returns the surface that is hit: its address in the scene.
  [[nodiscard]] const void* surface() const { return on_.surface; }

  /// Returns the crossing that the hit is made of.
  [[nodiscard]] const SurfaceCrossing& crossing() const { return on_; }

  /// Returns the index of the primitive that is hit, as the surface counts them; 0 for a surface without
  /// primitives.
  [[nodiscard]] int primitive() const { return on_.crossing.primitive; }

  /// Returns the surface's material.
  [[nodiscard]] const Material& material() const { return *on_.material; }

  /// Returns the surface coordinates u and v; 0 and 0 on a surface that has none.
  [[nodiscard]] Uv uv() const { return on_.functions->uv_at(on_.surface, at_rest(), primitive()); }

  /// Returns the directions of these coordinates; 0 and 0 on a surface that does not know them.
  [[nodiscard]] Tangents tangents() const {
    return on_.functions->tangents_at(on_.surface, at_rest(), primitive());
  }

  /// Returns the surface's color here: its material's texture at (u, v), or the diffuse color if there is
  /// none.
  [[nodiscard]] Color color() const {
    if (!material().texture) return material().diffuse;
    const Uv at = uv();
    return material().texture(at.x, at.y);
  }

  /// Returns the ray from here in a direction of any length. Its departure keeps it from hitting the surface
  /// again at its origin; there is no offset.
  [[nodiscard]] Ray leave(const Vec3& direction) const {
    return {.origin = point(), .direction = direction, .departure = departure(), .time = ray_.time};
  }

  /// Sets a ray to leave(direction), number by number (copied).
  void leave(const Vec3& direction, Ray& ray) const {
    ray.origin = copied(point()), ray.direction = copied(direction);
    new (&ray.departure) Departure(departure());  // made in its place, and not copied there
    ray.transform = nullptr, ray.is_reversed = false, ray.time = ray_.time;
  }

  /// Returns t rounded from the exact root, within 1 ulp, if the surface has one; the middle of the enclosure
  /// for Torus and marched surfaces; t itself for a surface without an equation or exact_root.
  [[nodiscard]] double refined() const {
    return static_cast<double>(
        protostar::refined(on_.functions->exact_root(on_.surface, ray_, on_.crossing)));
  }

  /// Returns true if this is strictly before another hit of the same ray. The order is exact for surfaces
  /// that know their exact roots; see precedes.
  [[nodiscard]] bool operator<(const Intersection& other) const { return precedes(ray_, on_, other.on_); }

 private:
  /// Returns the hit point as the surface's functions expect it: mapped back to the defining pose if the
  /// surface moves.
  [[nodiscard]] Point at_rest() const {
    return on_.functions->at_rest == nullptr ? point()
                                             : on_.functions->at_rest(on_.surface, point(), ray_.time);
  }

  [[nodiscard]] Departure departure() const {
    if (on_.constants != nullptr && on_.constants->departure) return *on_.constants->departure;
    return on_.functions->departure(on_.surface, primitive());
  }

  Ray ray_;
  SurfaceCrossing on_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

// A sphere: the points at distance radius from center (§2.2.4).
#pragma once

#include <cmath>

#include "../magnitude.hpp"
#include "../numeric/sphere_equation.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A sphere. Lengths are in scene units. The radius is not 0; a negative one turns the normals inward and
/// changes nothing else (§2.3.2).
struct Sphere {
  Point center{0};
  double radius = 1;

  /// Returns t of the closest hit in the range, at which the ray enters the sphere or, from inside, leaves
  /// it. Touching is a hit; hits are decided exactly. A ray that departs from the sphere hits it again only
  /// if it leads inward.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal at a point of the sphere (§2.3.1, A.1.3): outward for a positive radius. At
  /// hit.point() it is off by at most (2^-30 T + 2^-53 (T + P)) / |radius| + 2^-51, which also bounds the
  /// sine of the angle: T is the distance of the hit from the ray's origin, P its distance from the
  /// coordinate origin. If that bound is above 1, for a sphere so small and so far away that the digits of a
  /// point do not tell where on the sphere it is, the normal is any vector with components between -2 and 2.
  template <class Points = Point>
  [[nodiscard]] Points normal_at(const Points& point) const {
    return within((point - center) * (1 / radius), 2);
  }

  /// Returns the direction from the center as azimuth and polar angle: u from 0 to 1 around the y axis, ½ in
  /// the direction of z and growing towards x; v from 0 at the top to 1 at the bottom.
  [[nodiscard]] Uv uv_at(const Point& point) const { return direction_uv(unit_along(point - center)); }

  /// Returns the equation of the sphere and a ray, or of each ray of a packet, in double with its error; of a
  /// line in exact numbers, without rounding.
  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return sphere_equation(rays, center, radius);
  }
  /// Returns the roots in double-double, where double leaves a ray in doubt; nullopt if it is so still.
  [[nodiscard]] auto refined_roots(const Ray& ray) const { return refined_sphere_roots(ray, center, radius); }
  [[nodiscard]] bool has_finite_numbers() const { return is_finite(center) && std::isfinite(radius); }

  /// Returns true if a ray, or the rays of a packet, depart from this sphere or from one that coincides.
  [[nodiscard]] bool is_left_by(const auto& rays) const {
    return rays.departure.kind == Departure::Kind::sphere && rays.departure.geometry == departure().geometry;
  }

  /// Returns false: the far end of a ray is outside a sphere (Solid).
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  [[nodiscard]] Bounds bounds() const {
    const Vec3 r(std::abs(radius));
    return outward({center - r, center + r});
  }

  /// Returns center and radius. Spheres that coincide have equal departures: a ray that starts on one leaves
  /// both.
  [[nodiscard]] Departure departure() const {
    return {.kind = Departure::Kind::sphere, .geometry = {center.x, center.y, center.z, std::abs(radius)}};
  }

  /// Throws std::invalid_argument if the center is not made of coordinates, or |radius| is not a size
  /// (magnitude.hpp).
  void validate() const {
    require_rule(is_coordinate(center), "Sphere: center must have numbers", coordinate_rule);
    require_rule(is_size(std::abs(radius)), "Sphere: radius must be a number of a magnitude", size_rule);
  }
};

static_assert(SurfaceWithEquation<Sphere> && SurfaceWithBounds<Sphere> && Solid<Sphere>);

}  // namespace protostar::inline PROTOSTAR_ABI

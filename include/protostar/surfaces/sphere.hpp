// A sphere: the points at distance radius from center (§2.2.4).
#pragma once

#include <cmath>

#include "../magnitude.hpp"
#include "../numeric/sphere_equation.hpp"
#include "../numeric/sphere_roots.hpp"
#include "../numeric/sphere_roots_of_each.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"
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
    const auto crossing = first_crossing(*this, ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
  }

  /// Returns the unit normal at a point of the sphere (§2.3.1, A.1.3): outward for a positive radius. At
  /// hit.point() it is off by at most (2^-30 T + 2^-53 (T + P)) / |radius| + 2^-51, which also bounds the
  /// sine of the angle: T is the distance of the hit from the ray's origin, P its distance from the
  /// coordinate origin. If that bound is above 1, for a sphere so small and so far away that the digits of a
  /// point do not tell where on the sphere it is, the normal is any vector with components between -2 and 2.
  template <class P = Point>
  [[nodiscard]] P normal_at(const P& point) const {
    return within((point - center) * (1 / radius), 2);
  }

  /// Returns the direction from the center as longitude and latitude: u from 0 to 1 around the y axis, ½ in
  /// the direction of z; v from 0 at the top to 1 at the bottom.
  [[nodiscard]] Uv uv_at(const Point& point) const { return direction_uv(unit_along(point - center)); }

  /// Returns all crossings of the ray's line; if the ray departs from the sphere, only the one that it does
  /// not come from.
  [[nodiscard]] Roots roots(const Ray& ray) const {
    if (ray.transform != nullptr) return transformed_roots(ray);
    if (is_left_by(ray)) return sphere_root_leaving(ray.origin, ray.direction, center, radius);
    return sphere_roots(ray.origin, ray.direction, center, radius);
  }

  /// Returns true if the ray surely does not cross the sphere in t > 0, by signs alone, without a root.
  [[nodiscard]] bool is_surely_behind(const Ray& ray) const {
    if (ray.transform != nullptr) return false;
    if (is_left_by(ray)) return left_sphere_surely_behind(ray.origin, ray.direction, center, radius);
    return sphere_surely_behind(ray.origin, ray.direction, center, radius);
  }

  /// A ray, with the part of its equation that is the same for all spheres.
  struct Line : SphereLine<Point, Vec3> {
    const Ray& ray;
    bool leaves_a_sphere;
    explicit Line(const Ray& along)
        : SphereLine(along.origin, along.direction),
          ray(along),
          leaves_a_sphere(along.departure.kind == Departure::Kind::sphere) {}
  };

  /// Returns the first root in t > 0, or that double does not decide it.
  [[nodiscard, gnu::always_inline]] FirstRoot first_root(const Line& line) const {
    if (line.ray.transform != nullptr || (line.leaves_a_sphere && is_left_by(line.ray)))
      return {.known = FirstRoot::Known::undecided};
    return first_sphere_root(line, center, radius);
  }

  /// Returns the roots of several rays at once, in the lanes of `active`.
  [[nodiscard]] auto roots_of_each(const auto& rays, const auto& active) const {
    if (is_left_by(rays))
      return sphere_root_leaving_of_each(rays.origin, rays.direction, center, radius, active);
    return sphere_roots_of_each(rays.origin, rays.direction, center, radius, active);
  }

  /// Returns the first root in t > 0 of each of several rays that depart from nothing.
  [[nodiscard]] auto first_root_of_each(const auto& rays, const auto& active) const {
    return first_sphere_root_of_each(rays.origin, rays.direction, center, radius, active);
  }

  /// Tests which of several rays cross the sphere in t > 0, or, as segments, in 0 < t < 1.
  [[nodiscard]] auto crossed_by_each(const auto& rays, const auto& active) const {
    if (is_left_by(rays))
      return left_sphere_crossed_by_each(rays.origin, rays.direction, center, radius, active);
    return sphere_crossed_by_each(rays.origin, rays.direction, center, radius, active);
  }
  [[nodiscard]] auto crossed_by_segments(const auto& rays, const auto& active) const {
    if (is_left_by(rays))
      return left_sphere_crossed_by_segments(rays.origin, rays.direction, center, radius, active);
    return sphere_crossed_by_segments(rays.origin, rays.direction, center, radius, active);
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, int root) const {
    const auto equation = sphere_equation(line_of<ExactNumber>(ray), center, radius);
    return is_left_by(ray) ? exact_root_of(equation.without_root_at_0()) : exact_root_of(equation, root);
  }

  /// Returns false: the inside is bounded on every ray.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  [[nodiscard]] Bounds bounds() const {
    const Vec3 r(std::abs(radius));
    return outward({center - r, center + r});
  }

  /// Returns center and radius; spheres with equal ones are left together.
  [[nodiscard]] Departure departure() const {
    return {.kind = Departure::Kind::sphere, .geometry = {center.x, center.y, center.z, std::abs(radius)}};
  }

  /// Throws std::invalid_argument if the center is not made of coordinates, or |radius| is not a size
  /// (magnitude.hpp).
  void validate() const {
    require_rule(is_coordinate(center), "Sphere: center must have numbers", coordinate_rule);
    require_rule(is_size(std::abs(radius)), "Sphere: radius must be a number of a magnitude", size_rule);
  }

  /// Returns true if a ray, or the rays of a packet, depart from the sphere.
  [[nodiscard]] bool is_left_by(const auto& ray) const {
    return ray.departure.kind == Departure::Kind::sphere && ray.departure.geometry == departure().geometry;
  }

 private:
  [[nodiscard, gnu::noinline]] Roots transformed_roots(const Ray& ray) const {
    const auto equation = [&](const auto& line) { return sphere_equation(line, center, radius); };
    if (!is_left_by(ray)) {
      if (const auto roots = rounded_sphere_roots(rounded_line(ray), center, radius)) return *roots;
      return roots_along(ray, equation);
    }
    return roots_along(ray, [&](const auto& line) { return equation(line).without_root_at_0(); });
  }
};

static_assert(SurfaceWithExactRoots<Sphere> && SurfaceWithDeparture<Sphere> && SurfaceWithBounds<Sphere> &&
              Solid<Sphere>);

}  // namespace protostar::inline PROTOSTAR_ABI

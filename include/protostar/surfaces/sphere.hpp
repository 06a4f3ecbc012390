// The set of points at distance radius from center (§2.2.4).
#pragma once

#include <cmath>
#include <stdexcept>

#include "../numeric/roots.hpp"
#include "../surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A sphere. Lengths are in scene units. The radius is not 0; a negative one turns the normals inwards and
/// changes nothing else (§2.3.2).
struct Sphere {
  Point center{0};
  double radius = 1;

  /// Where a ray meets the sphere first inside the range: where it enters it, or, from inside, where it
  /// leaves it. Touching is a hit. A sphere that the ray departs from is met again only by a ray that leads
  /// inwards.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return roots(ray).first_in(range);
  }

  /// The unit normal at a point of the sphere (§2.3.1, A.1.3): outwards for a positive radius.
  [[nodiscard]] Vec3 normal_at(const Point& point) const { return (point - center) / radius; }

  /// All crossings of the ray's line. With l = center − origin a point of the ray is on the sphere where
  ///   |t·d − l|² = r²,   that is   A t² − 2 b t + c = 0   with   A = d·d,  b = d·l,  c = l·l − r².
  /// A ray that departs from the sphere has c = 0: one root is 0, and the other is 2b/A, which lies ahead of
  /// rays that lead inwards and behind all others.
  [[nodiscard]] Roots roots(const Ray& ray) const {
    const Vec3 l = center - ray.origin;
    const double A = dot(ray.direction, ray.direction);
    const double b = dot(ray.direction, l);
    if (ray.departure == departure()) return Roots{2 * b / A};
    const Vec3 nearest =
        l - b / A * ray.direction;  // from the line's point nearest to the center, to the center
    const double r2 = radius * radius;
    return quadratic_roots(A, b, dot(l, l) - r2, A * (r2 - dot(nearest, nearest)));
  }

  /// Spheres of one center and radius are left together.
  [[nodiscard]] Departure departure() const {
    return {.kind = Departure::Kind::sphere, .geometry = {center.x, center.y, center.z, std::abs(radius)}};
  }

  /// Throws std::invalid_argument if the center is not finite or the radius is 0 or not finite.
  void validate() const {
    if (!is_finite(center)) throw std::invalid_argument("Sphere: center must be finite");
    if (!std::isfinite(radius) || radius == 0)
      throw std::invalid_argument("Sphere: radius must be finite and not 0");
  }
};

static_assert(SurfaceWithRoots<Sphere> && SurfaceWithDeparture<Sphere>);

}  // namespace protostar::inline PROTOSTAR_ABI

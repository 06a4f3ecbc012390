// Quadrics: the points where a polynomial of the second degree in x, y and z is 0, as ellipsoids, cones and
// cylinders.
#pragma once

#include <cmath>
#include <stdexcept>

#include "../magnitude.hpp"
#include "../numeric/quadric_equation.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A quadric: the points where its form (QuadricForm, in numeric/quadric_equation.hpp) is 0. Inside it the
/// form is negative. The default is the unit sphere. Hits are decided exactly.
struct Quadric {
  QuadricForm form;

  /// Returns t of the closest hit in the range. Touching is a hit, at which the ray crosses the quadric
  /// twice; a ray that lies in the quadric does not cross it. A ray that departs from the quadric may hit it
  /// once more.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal at a point of the quadric, outward along the gradient of the form. The terms of
  /// the gradient cancel if the quadric is far from the coordinate origin, and digits are lost. If the
  /// gradient is 0, as at the apex of a cone, there is no normal: (0, 0, 1) stands for it.
  [[nodiscard]] Vec3 normal_at(const Point& point) const {
    const Vec3 gradient = form.times(point) + form.linear;
    return unit_along(gradient);
  }

  /// Returns the normal as longitude and latitude; if the quadric is a sphere, u and v are a Sphere's.
  [[nodiscard]] Uv uv_at(const Point& point) const { return direction_uv(normal_at(point)); }

  /// Returns the directions in which the longitude and the latitude of the normal grow. Along w, the gradient
  /// g changes by Q w. If it is to turn to the east, w is at right angles to g and to Q times the way down,
  /// so that Q w has no part along that; and likewise for the way down. With e and d for a unit vector to the
  /// east and down, g × e = −d and g × d = e, so that w = g × Q d turns g by (e·Q e) (d·Q d) − (e·Q d)² to
  /// the east, and g × Q e by as much upwards: their signs are that of the curvature. Without a curvature, as
  /// on a cone, both ways are the same line, along which the normal does not turn: none is returned.
  [[nodiscard]] Tangents tangents_at(const Point& point) const {
    const double sign = curvature_sign(form);
    if (sign == 0) return {};
    const Vec3 g = normal_at(point);
    const auto [east, down] = direction_tangents(g);
    const auto way = [&](const Vec3& unwanted) { return cross(g, of_moderate_size(form.times(unwanted))); };
    return {sign * way(down), -sign * way(east)};
  }

  [[nodiscard]] auto equation(const Ray& ray) const { return quadric_equation(ray, form); }
  [[nodiscard]] auto equation(const RoundedLine& line) const { return quadric_equation(line, form); }
  [[nodiscard]] auto equation(const ExactLine& line) const { return quadric_equation(line, form); }
  [[nodiscard]] bool has_finite_numbers() const { return is_finite(form); }

  [[nodiscard]] bool is_left_by(const Ray& ray) const { return ray.departure.is_from(this); }

  /// Returns all crossings of the ray's line; if the ray departs from the quadric, only the one that it does
  /// not come from. This one does not count outside of the bounds, where it can be only if the origin is
  /// about as far off the quadric.
  [[nodiscard]] Roots roots(const Ray& ray) const {
    const Roots roots = certified_roots(*this, ray);
    const bool may_be_outside = roots.count() > 0 && is_left_by(ray) && ray.transform == nullptr;
    return may_be_outside && !is_in_quadric_bounds(ray, form) ? Roots{} : roots;
  }

  /// Returns true if the far end of the ray is inside: all that is behind the crossings whose t a double
  /// holds. Nearly along the axis of a cylinder or of a paraboloid, a crossing may be beyond that.
  [[nodiscard]] bool ends_inside(const Ray& ray) const {
    return with_line(ray, [&](const auto& line) {
      const RoundedQuadricEquation e(line, form);
      return e.is_A_certain() && e.has_finite_roots() ? e.A < 0 : ends_inside_in_doubt(ray);
    });
  }

  /// Returns the bounds of an ellipsoid whose form is negative around its center, about a thousandth wider;
  /// infinite for other quadrics.
  [[nodiscard]] Bounds bounds() const { return quadric_bounds(form); }

  /// Returns this quadric, recognized by its address.
  [[nodiscard]] Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }

  /// Throws std::invalid_argument if a number is not a coordinate (magnitude.hpp), or the form is constant.
  void validate() const {
    require_rule(is_coordinate(form.squares) && is_coordinate(form.products) && is_coordinate(form.linear) &&
                     is_coordinate(form.constant),
                 "Quadric: the numbers of the form must be", coordinate_rule);
    if (form.squares == Vec3{0} && form.products == Vec3{0} && form.linear == Vec3{0})
      throw std::invalid_argument("Quadric: the form must not be constant");
  }

 private:
  /// Returns ends_inside without rounding: the side for t → ∞, turned over by each crossing beyond the range
  /// of double.
  [[nodiscard, gnu::cold, gnu::noinline]] bool ends_inside_in_doubt(const Ray& ray) const {
    if (!is_proper(ray) || !has_finite_numbers()) return false;
    bool is_inside = ends_negative(equation(exact_line(ray)), is_left_by(ray));
    for (const double t : roots(ray))
      if (t == infinity) is_inside = !is_inside;
    return is_inside;
  }
};

static_assert(SurfaceWithEquation<Quadric> && SurfaceWithBounds<Quadric> && Solid<Quadric>);

}  // namespace protostar::inline PROTOSTAR_ABI

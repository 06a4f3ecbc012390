// Quadrics: the points where a polynomial of the second degree in x, y and z is 0, as ellipsoids, cones and
// cylinders.
#pragma once

#include <cmath>
#include <stdexcept>

#include "../magnitude.hpp"
#include "../numeric/quadric_bounds.hpp"
#include "../numeric/quadric_roots.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A quadric: the points where its form (QuadricForm, in numeric/quadric_roots.hpp) is 0. Inside it the form
/// is negative. The default is the unit sphere. Hits are decided exactly.
struct Quadric {
  QuadricForm form;

  /// Returns t of the closest hit in the range. Touching is a hit, at which the ray crosses the quadric
  /// twice; a ray that lies in the quadric does not cross it. A ray that departs from the quadric may hit it
  /// once more.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    const auto crossing = first_crossing(*this, ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
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

  /// Returns all crossings of the ray's line; if the ray departs from the quadric, only the one that it does
  /// not come from. This one does not count outside of the bounds, where it can be only if the origin is
  /// about as far off the quadric.
  [[nodiscard]] Roots roots(const Ray& ray) const {
    if (ray.transform != nullptr) return transformed_roots(ray);
    if (!is_left_by(ray)) return quadric_roots(ray.origin, ray.direction, form);
    const Roots root = quadric_root_leaving(ray.origin, ray.direction, form);
    const bool counts = root.count() > 0 && is_in_quadric_bounds(ray.origin, ray.direction, form);
    return counts ? root : Roots{};
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, int root) const {
    const auto equation = quadric_equation(line_of<ExactNumber>(ray), form);
    return is_left_by(ray) ? exact_root_of(equation.without_root_at_0()) : exact_root_of(equation, root);
  }

  /// Returns true if the far end of the ray, t → ∞, is inside.
  [[nodiscard]] bool ends_inside(const Ray& ray) const {
    const bool leaves = is_left_by(ray);
    if (ray.transform == nullptr) return quadric_ends_negative(ray.origin, ray.direction, form, leaves);
    if (const detail::RoundedQuadricEquation e(rounded_line(ray), form); e.in_range && e.is_A_certain())
      return e.A < 0;
    return is_proper(ray) && decided(ray, [&](const auto& line) {
             return ends_negative(quadric_equation(line, form), leaves);
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
  [[nodiscard, gnu::noinline]] Roots transformed_roots(const Ray& ray) const {
    const auto equation = [&](const auto& line) { return quadric_equation(line, form); };
    if (!is_left_by(ray)) {
      if (const auto roots = roots_if_certain(detail::RoundedQuadricEquation(rounded_line(ray), form)))
        return *roots;
      return roots_along(ray, equation);
    }
    return roots_along(ray, [&](const auto& line) { return equation(line).without_root_at_0(); });
  }

  [[nodiscard]] bool is_left_by(const Ray& ray) const {
    return ray.departure.kind == Departure::Kind::object && ray.departure.object == this;
  }
};

static_assert(SurfaceWithExactRoots<Quadric> && SurfaceWithDeparture<Quadric> && SurfaceWithBounds<Quadric> &&
              Solid<Quadric>);

}  // namespace protostar::inline PROTOSTAR_ABI

// A plane: the points x with normal · x = distance.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../magnitude.hpp"
#include "../numeric/planar_equation.hpp"
#include "../numeric/scale.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A plane. The normal may have any length but 0; if it is a unit vector, distance is the plane's distance
/// from the coordinate origin along it, in scene units.
struct Plane {
  Vec3 normal{0, 1, 0};
  double distance = 0;

  /// Returns t of the ray's crossing with the plane if that is in the range. A ray parallel to the plane does
  /// not cross it, even in the plane, nor does one that departs from it.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  static constexpr bool is_flat = true;  ///< the normal is the same at every point

  /// Returns the unit normal, the same at every point.
  template <class P = Point>
  [[nodiscard]] Vec3 normal_at(const P&) const {
    const Vec3 size = abs(normal);
    return normalize(normal /
                     std::max({size.x, size.y, size.z}));  // its squares neither overflow nor underflow
  }

  /// Returns coordinates from the plane's point nearest the coordinate origin, in scene units: u along e1,
  /// the direction of a × n, where n is the unit normal and a the coordinate axis on which it is smallest in
  /// magnitude, the first of equals; v along e2 = n × e1.
  template <class P = Point>
  [[nodiscard]] auto uv_at(const P& point) const {
    return plane_uv(normal_at(point), point);
  }

  [[nodiscard]] Tangents tangents_at(const Point& point) const { return plane_tangents(normal_at(point)); }

  /// Returns the distance of a point from the plane, less than 0 on the side away from the normal; rounded.
  [[nodiscard]] double distance_bound(const Point& point) const {
    const int exponent = -immoderate_exponent(normal);  // so that the squares of the normal are in range
    const Vec3 n = scaled(normal, exponent);
    return (dot(n, point) - scaled(distance, exponent)) / length(n);
  }

  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return plane_equation(rays, normal, distance);
  }
  [[nodiscard]] bool has_finite_numbers() const { return is_finite(normal) && std::isfinite(distance); }

  /// Returns true if a ray, or the rays of a packet, depart from the plane.
  [[nodiscard]] bool is_left_by(const auto& rays) const {
    return rays.departure.is_planar() && rays.departure == departure();
  }

  /// Returns the plane. Planes whose equations are equal, or multiples of each other, are left together, with
  /// all surfaces in them.
  [[nodiscard]] Departure departure() const {
    return {.kind = Departure::Kind::plane, .geometry = {normal.x, normal.y, normal.z, distance}};
  }

  /// Throws std::invalid_argument if the normal is 0 or not finite, or distance over the normal's largest
  /// component is not a coordinate (magnitude.hpp).
  void validate() const {
    if (!is_finite(normal) || normal == Vec3{0})
      throw std::invalid_argument("Plane: normal must be finite and not zero");
    const Vec3 size = abs(normal);
    require_rule(is_coordinate(distance / std::max({size.x, size.y, size.z})),
                 "Plane: distance must, over the largest component of normal, be", coordinate_rule);
  }
};

static_assert(SurfaceWithEquation<Plane>);

}  // namespace protostar::inline PROTOSTAR_ABI

// A disk: the points of a plane that are no farther than radius from position.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "../magnitude.hpp"
#include "../numeric/planar_equation.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"
#include "planar.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A disk around position, perpendicular to a normal of any length but 0. Its outline belongs to it. Hits are
/// decided exactly.
struct Disk {
  Point position{0};
  Vec3 normal{0, 0, 1};
  double radius = 1;

  /// Returns t of the ray's crossing with the disk if that is in the range. A ray parallel to its plane does
  /// not cross it, even in that plane, nor does one that departs from the plane.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  static constexpr bool is_flat = true;  ///< the normal is the same at every point

  /// Returns the unit normal, the same at every point.
  template <class P = Point>
  [[nodiscard]] Vec3 normal_at(const P&) const {
    return normalize(of_moderate_size(normal));
  }

  /// Returns coordinates from position, in scene units: u along e1, the direction of a × n, where n is the
  /// unit normal and a the coordinate axis on which it is smallest in magnitude, the first of equals; v along
  /// e2 = n × e1.
  template <class P = Point>
  [[nodiscard]] auto uv_at(const P& point) const {
    const P from_center = point - position;
    return plane_uv(normal_at(point), from_center);
  }

  [[nodiscard]] Tangents tangents_at(const Point& point) const { return plane_tangents(normal_at(point)); }

  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return disk_equation(rays, position, normal, radius);
  }
  [[nodiscard]] bool has_finite_numbers() const {
    return is_finite(position) && is_finite(normal) && std::isfinite(radius);
  }

  /// Returns true if a ray, or the rays of a packet, depart from the plane of the disk.
  [[nodiscard]] bool is_left_by(const auto& rays) const {
    const auto& [x, y, z] = std::array{normal.x, normal.y, normal.z};
    return is_plane_left_by(rays, *this, position, Vec3{0, -z, y}, Vec3{z, 0, -x}, Vec3{-y, x, 0});
  }

  /// Returns the box that reaches from the center by √(n_j² + n_k²) · radius on each axis i, for the unit
  /// normal n. The square root is good to 2^-50 of itself, and to 2^-500 where the squares underflow.
  [[nodiscard]] Bounds bounds() const {
    const Vec3 n = normal_at(position);
    const auto reach = [&](double j, double k) {
      return radius * ((1 + 0x1p-50) * std::sqrt(j * j + k * k) + 0x1p-500);
    };
    const Vec3 half{reach(n.y, n.z), reach(n.z, n.x), reach(n.x, n.y)};
    return outward({position - half, position + half});
  }

  /// Returns the disk's plane; surfaces in one plane are left together.
  [[nodiscard]] Departure departure() const {
    return departure_of_plane(
        position, [&](int i) { return normal[(i + 1) % 3] == 0 && normal[(i + 2) % 3] == 0; },
        [&] { return plane_at(position, normal); });
  }

  /// Throws std::invalid_argument if the position is not made of coordinates, the radius is not a size
  /// (magnitude.hpp), or the normal is 0 or not finite.
  void validate() const {
    require_rule(is_coordinate(position), "Disk: position must have numbers", coordinate_rule);
    if (!is_finite(normal) || normal == Vec3{0})
      throw std::invalid_argument("Disk: normal must be finite and not zero");
    require_rule(is_size(radius), "Disk: radius must be", size_rule);
  }
};

static_assert(SurfaceWithEquation<Disk> && SurfaceWithBounds<Disk>);

}  // namespace protostar::inline PROTOSTAR_ABI

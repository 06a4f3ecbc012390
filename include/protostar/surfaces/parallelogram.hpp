// A parallelogram: the points position + a·edge_u + b·edge_v with 0 ≤ a ≤ 1 and 0 ≤ b ≤ 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../magnitude.hpp"
#include "../numeric/planar_equation.hpp"
#include "../surface.hpp"
#include "planar.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A parallelogram, from one corner along two edges, which are not parallel. Its outline belongs to it. Hits
/// are decided exactly.
struct Parallelogram {
  Point position{0};
  Vec3 edge_u{1, 0, 0}, edge_v{0, 1, 0};

  /// Returns t of the ray's crossing with the parallelogram if that is in the range. A ray parallel to its
  /// plane does not cross it, even in that plane, nor does one that departs from the plane.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  static constexpr bool is_flat = true;  ///< the normal is the same at every point

  /// Returns the unit normal along edge_u × edge_v, the same at every point.
  template <class P = Point>
  [[nodiscard]] Vec3 normal_at(const P&) const {
    return unit_normal(edge_u, edge_v);
  }

  /// Returns the coordinates of a point of the plane along edge_u and edge_v, in scene units: 0 at position,
  /// and the edge's length at the far end of an edge.
  template <class P = Point>
  [[nodiscard]] auto uv_at(const P& point) const {
    // For the unit vectors u and v of the edges and w = α u + β v, with n = u × v: w × v = α n, u × w = β n.
    const auto unit = [](const Vec3& edge) { return normalize(of_moderate_size(edge)); };
    const Vec3 u = unit(edge_u), v = unit(edge_v), n = cross(u, v);
    const P w = point - position;
    return uv_of(dot(cross(w, v), n) / dot(n, n), dot(cross(u, w), n) / dot(n, n));
  }

  [[nodiscard]] Tangents tangents_at(const Point&) const { return {edge_u, edge_v}; }

  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return parallelogram_equation(rays, position, edge_u, edge_v);
  }

  /// Equation in double whose terms that are the same for all rays are computed in advance.
  struct Prepared {
    Point position;
    CornerEdges<Vec3> edges;
    [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
      return parallelogram_equation(rays, position, edges);
    }
  };
  [[nodiscard]] Prepared prepared() const { return {position, CornerEdges(edge_u, edge_v)}; }

  [[nodiscard]] bool has_finite_numbers() const {
    return is_finite(position) && is_finite(edge_u) && is_finite(edge_v);
  }

  /// Returns true if a ray, or the rays of a packet, depart from the plane of the parallelogram.
  [[nodiscard]] bool is_left_by(const auto& rays) const {
    return is_plane_left_by(rays, *this, position, edge_u, edge_v);
  }

  [[nodiscard]] Bounds bounds() const {
    const Bounds edge = outward({position + min(edge_u, 0.0), position + max(edge_u, 0.0)});
    return outward({edge.min + min(edge_v, 0.0), edge.max + max(edge_v, 0.0)});
  }

  /// Returns the parallelogram's plane; surfaces in one plane are left together.
  [[nodiscard]] Departure departure() const {
    return departure_of_plane(
        position, [&](int i) { return edge_u[i] == 0 && edge_v[i] == 0; },
        [&] { return plane_through(position, edge_u, edge_v); });
  }

  /// Throws std::invalid_argument if the edges are parallel or 0, a number is not a coordinate, or an edge's
  /// largest component is not a size (magnitude.hpp).
  void validate() const {
    require_rule(is_coordinate(position), "Parallelogram: position must have numbers", coordinate_rule);
    require_rule(is_coordinate(edge_u) && is_coordinate(edge_v),
                 "Parallelogram: edge_u and edge_v must have numbers", coordinate_rule);
    if (!is_finite(normal_at(position)))
      throw std::invalid_argument("Parallelogram: edge_u and edge_v must not be 0 or parallel");
    const auto has_size = [](const Vec3& edge) {
      const Vec3 size = abs(edge);
      return is_size(std::max({size.x, size.y, size.z}));
    };
    require_rule(has_size(edge_u) && has_size(edge_v),
                 "Parallelogram: edge_u and edge_v must have largest components", size_rule);
  }
};

static_assert(SurfaceWithEquation<Parallelogram> && SurfaceWithBounds<Parallelogram>);

}  // namespace protostar::inline PROTOSTAR_ABI

// The set of points of the triangle between three points.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../numeric/plane_through.hpp"
#include "../numeric/triangle_roots.hpp"
#include "../surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A triangle; its points are not on one line. Whether a ray hits it is exact for numbers whose sizes in one
/// test differ by less than 2^100; what lies further below the largest may be lost.
///
/// A part of its outline belongs to it. A ray that passes exactly through an edge or a vertex is taken for
/// one that starts an immeasurably small bit aside, the same for all triangles. So of two triangles on either
/// side of an edge it hits exactly one, and of those around a vertex of a closed mesh, as many as a ray next
/// to it.
struct Triangle {
  Point a{0}, b{1, 0, 0}, c{0, 1, 0};

  /// Where a ray crosses the triangle, if that is inside the range. A ray parallel to its plane never does,
  /// one that lies in it included, and neither does one that departs from its plane.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    const auto crossing = first_crossing(*this, ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
  }

  /// The unit normal along (b − a) × (c − a), the same at every point.
  template <class P = Point>
  [[nodiscard]] Vec3 normal_at(const P&) const {
    return unit_normal_through(a, b, c);
  }

  /// Barycentric coordinates: the point is a + u (b − a) + v (c − a).
  template <class P = Point>
  [[nodiscard]] auto uv_at(const P& point) const {
    // For w = u e + v f with the edges e and f, and n = e × f: w × f = u n, e × w = v n. The lengths go up to
    // the fourth power, so that a power of two brings the edges to about 1 first.
    const double unit = std::ldexp(1, std::clamp(-exponent_of({b - a, c - a}), -1000, 1000));
    const Vec3 e = unit * (b - a), f = unit * (c - a), n = cross(e, f);
    const P w = unit * (point - a);
    return uv_of(dot(cross(w, f), n) / dot(n, n), dot(cross(e, w), n) / dot(n, n));
  }

  /// The crossing of the ray's line; of a ray that departs from the triangle's plane, none.
  [[nodiscard]] Roots roots(const Ray& ray) const {
    if (is_left_by(ray)) return {};
    return triangle_roots(ray.origin, ray.direction, a, b, c);
  }

  /// The same of several rays at once, of those that are wanted.
  [[nodiscard]] auto roots_of_each(const auto& rays, const auto& wanted) const {
    return triangle_roots_of_each(rays.origin, rays.direction, a, b, c, wanted && !is_left_by(rays));
  }

  [[nodiscard]] RefinedRoots refined_roots(const Ray& ray, Precision) const {
    return refined_triangle_roots(ray.origin, ray.direction, a, b, c);
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, int) const {
    return exact_triangle_root(ray.origin, ray.direction, a, b, c);
  }

  [[nodiscard]] Bounds bounds() const { return {min(a, min(b, c)), max(a, max(b, c))}; }

  /// What lies in one plane is left together. Where the plane is at a right angle to an axis that is exact;
  /// of others, equal planes always have equal departures.
  [[nodiscard]] Departure departure() const {
    for (int i = 0; i < 3; ++i)
      if (a[i] == b[i] && a[i] == c[i]) {
        Departure departure{.kind = Departure::Kind::plane};
        departure.geometry[static_cast<std::size_t>(i)] = 1, departure.geometry[3] = a[i];
        return departure;
      }
    return {.kind = Departure::Kind::rounded_plane, .geometry = plane_through_points(a, b, c)};
  }

  /// Throws std::invalid_argument if the points are on one line, or a number is not finite.
  void validate() const {
    if (!is_finite(a) || !is_finite(b) || !is_finite(c))
      throw std::invalid_argument("Triangle: a, b and c must be finite");
    if (!is_finite(normal_at(a))) throw std::invalid_argument("Triangle: a, b and c must not be on one line");
  }

 private:
  [[nodiscard]] bool is_left_by(const auto& ray) const {
    return ray.departure.is_planar() && !surely_differs(ray.departure.geometry, a, b - a, c - a) &&
           ray.departure == departure();
  }
};

static_assert(SurfaceWithRefinedRoots<Triangle> && SurfaceWithDeparture<Triangle> &&
              SurfaceWithBounds<Triangle>);

/// Whether a ray that leaves a triangle of a mesh only seems to cross another one: its origin is rounded, and
/// may lie behind a neighbor (docs/numerics.md, Leaving a mesh).
///
/// Its line leads through some point P of the triangle that is left, to the side σ of its plane. The other is
/// crossed ahead of P only if it has a vertex on that side, and the triangle that is left has one on the side
/// of the other's plane from which the line comes; behind P, the other way round. If σ is 0, the line is
/// parallel to the plane, and the first says nothing.
///
/// Of two that have no more than a vertex in common, this may not tell. But a line that passes near the
/// vertex crosses the triangles around it in and out in turn. So if it misses the one that it leaves, the one
/// that it crosses there to the same side stands in for it. There is within 2^-30 of the triangle's
/// coordinates, which is what t of the hit is good to, of a ray from no farther away.
[[nodiscard]] inline bool only_seems_crossed(const Triangle& left, const Triangle& other, const Ray& ray,
                                             double t) {
  const auto side_of_way = [&](const Triangle& plane) {
    return side_led_to(ray.direction, plane.a, plane.b, plane.c);
  };
  const auto has_vertex = [](const Triangle& one, int side, const Triangle& plane) {
    const auto is_there = [&](const Point& vertex) {
      return side_of_point(vertex, plane.a, plane.b, plane.c) == side;
    };
    return is_there(one.a) || is_there(one.b) || is_there(one.c);
  };
  const int side = side_of_way(left), side_of_other = side_of_way(other), way = t > 0 ? 1 : -1;
  if (side != 0 && !has_vertex(other, way * side, left)) return true;
  if (!has_vertex(left, -way * side_of_other, other)) return true;

  const auto largest = [](const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  const double size = std::max({largest(left.a), largest(left.b), largest(left.c)});
  const auto is_of_both = [&](const Point& vertex) {
    return vertex == other.a || vertex == other.b || vertex == other.c;
  };
  return side == side_of_other && std::abs(t) * largest(ray.direction) <= 0x1p-30 * size &&
         (is_of_both(left.a) || is_of_both(left.b) || is_of_both(left.c)) &&
         triangle_roots(ray.origin, ray.direction, left.a, left.b, left.c).count() == 0;
}

}  // namespace protostar::inline PROTOSTAR_ABI

// A triangle between three points, and rays that leave a triangle of a mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../magnitude.hpp"
#include "../numeric/inner_point.hpp"
#include "../numeric/planar_equation.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"
#include "planar.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A triangle; its points are not on one line. Hits are decided exactly.
///
/// A part of its outline belongs to it. A ray exactly through an edge or a vertex is treated as if it started
/// infinitesimally aside, in the same way for all triangles. Hence it hits exactly one of two triangles on
/// either side of an edge, and of the triangles around a vertex of a closed mesh it hits as many as a ray
/// next to it.
struct Triangle {
  Point a{0}, b{1, 0, 0}, c{0, 1, 0};

  /// Returns t of the ray's crossing with the triangle if that is in the range. A ray parallel to its plane
  /// does not cross it, even in that plane, nor does one that departs from the plane.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  static constexpr bool is_flat = true;  ///< the normal is the same at every point

  /// Returns the unit normal along (b − a) × (c − a), the same at every point.
  template <class P = Point>
  [[nodiscard]] Vec3 normal_at(const P&) const {
    return unit_normal_through(a, b, c);
  }

  /// Returns barycentric coordinates: the point is a + u (b − a) + v (c − a).
  template <class P = Point>
  [[nodiscard]] auto uv_at(const P& point) const {
    // For w = u e + v f with the edges e and f, and n = e × f: w × f = u n, e × w = v n. Lengths occur to the
    // fourth power, so a power of two first scales the edges to about 1.
    const double unit = std::ldexp(1, std::clamp(-exponent_of({b - a, c - a}), -1000, 1000));
    const Vec3 e = unit * (b - a), f = unit * (c - a), n = cross(e, f);
    const P w = unit * (point - a);
    return uv_of(dot(cross(w, f), n) / dot(n, n), dot(cross(e, w), n) / dot(n, n));
  }

  [[nodiscard]] Tangents tangents_at(const Point&) const { return {b - a, c - a}; }

  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return triangle_equation(rays, a, b, c);
  }

  /// Equation in double whose terms that are the same for all rays are computed in advance.
  struct Prepared {
    Point a;
    CornerEdges<Vec3> edges;
    [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
      return triangle_equation(rays, a, edges);
    }
  };
  [[nodiscard]] Prepared prepared() const { return {a, CornerEdges(b - a, c - a)}; }

  [[nodiscard]] bool has_finite_numbers() const { return is_finite(a) && is_finite(b) && is_finite(c); }

  /// Returns true if a ray, or the rays of a packet, depart from the plane of the triangle.
  [[nodiscard]] bool is_left_by(const auto& rays) const {
    return is_plane_left_by(rays, *this, a, b - a, c - a);
  }

  [[nodiscard]] Bounds bounds() const { return {min(a, min(b, c)), max(a, max(b, c))}; }

  /// Returns the triangle's plane; surfaces in one plane are left together.
  [[nodiscard]] Departure departure() const {
    return departure_of_plane(
        a, [&](int i) { return a[i] == b[i] && a[i] == c[i]; },
        [&] { return plane_through_points(a, b, c); });
  }

  /// Throws std::invalid_argument if the points are on one line, or a number is not a coordinate
  /// (magnitude.hpp).
  void validate() const {
    require_rule(is_coordinate(a) && is_coordinate(b) && is_coordinate(c),
                 "Triangle: a, b and c must have numbers", coordinate_rule);
    if (!is_finite(normal_at(a))) throw std::invalid_argument("Triangle: a, b and c must not be on one line");
  }
};

static_assert(SurfaceWithEquation<Triangle> && SurfaceWithBounds<Triangle>);

/// Start of a ray that leaves a triangle of a mesh, and its crossings with the mesh's other triangles.
///
/// The ray's origin is rounded: it lies beside the triangle, and near an edge it may lie behind the neighbor.
/// Therefore the ray starts at the point inside the triangle that is next to its origin, without rounding.
/// Its line crosses that triangle there, at t = 0. All other triangles are tested against this one line, so
/// it crosses a closed mesh in and out in turn, beginning with the side to which it leaves
/// (docs/derivations.md, Leaving a mesh).
class StartInTriangle {
 public:
  StartInTriangle(const Ray& ray, const Triangle& departed)
      : departed_(departed), start_(ray.origin, departed.a, departed.b, departed.c) {}

  /// Returns an upper bound for its distance from the ray's origin, on each axis.
  [[nodiscard]] double distance() const { return start_.distance(); }

  /// Returns the ray's line in doubles, with upper bounds for their errors that hold for both lines: the
  /// ray's own, and the one from this start.
  [[nodiscard]] RoundedLine line(const Ray& ray) const {
    RoundedLine line = rounded_line(ray);
    line.origin_error += distance();
    return line;
  }

  /// Returns the crossing of the line with another triangle, as certain as Roots says; none if that triangle
  /// lies in the plane that the ray leaves.
  [[nodiscard]] Roots roots(const Ray& ray, const Triangle& other) const {
    return roots_of(rounded_equation(ray, other), [&] { return roots_with_more_digits(ray, other); });
  }

  /// Returns the crossing with another triangle without rounding. If the crossings of the given ray and of
  /// the line surely differ by less than 2^-32 of t, it is the given ray's, which is at the same t as its
  /// crossing with another surface in the triangle's plane.
  [[nodiscard, gnu::cold, gnu::noinline]] ExactRoot exact_root(const Ray& ray, const Triangle& other) const {
    return exact_root_on(other,
                         rounded_equation(ray, other).is_certain ? exact_line(ray) : line_from_start(ray));
  }

  /// Returns the order of two triangles that are crossed at t_a and t_b: the sign of the difference of t on
  /// the line, without rounding.
  [[nodiscard]] int order_of(const Ray& ray, const Triangle& a, double t_a, const Triangle& b,
                             double t_b) const {
    const double gap = t_a - t_b, larger = std::max(std::abs(t_a), std::abs(t_b));
    if (std::abs(gap) > 4 * Roots::relative_error * larger + (shift(ray, a) + shift(ray, b)))
      return gap > 0 ? 1 : -1;
    const ExactLine line = line_from_start(ray);
    return order(exact_root_on(a, line), exact_root_on(b, line));
  }

  /// Returns an upper bound for the difference between t of a crossing on the given ray and on the line,
  /// n·(P − o) / n·d. In double, n·d is good to 2^-31 of itself if it is above 2^-18 of the sizes of its
  /// terms (triangle_equation); if not, the bound is infinite.
  [[nodiscard]] double shift(const Ray& ray, const Triangle& other) const {
    const RoundedLine line = this->line(ray);
    const Vec3 u = other.b - other.a, v = other.c - other.a, terms = detail::sizes_of_cross(u, v);
    const double slope = std::abs(dot(cross(u, v), line.direction)),
                 slopes = dot(terms, direction_sizes(line));
    const bool is_known = 0x1p-800 < slopes && slope > 0x1p-18 * slopes && slope < infinity;
    return is_known ? (1 + 0x1p-30) * dot(terms, line.origin_error) / slope : infinity;
  }

 private:
  [[nodiscard]] RoundedLinear<double, bool> rounded_equation(const Ray& ray, const Triangle& other) const {
    return other.equation(line(ray));
  }

  [[nodiscard, gnu::cold, gnu::noinline]] Roots roots_with_more_digits(const Ray& ray,
                                                                       const Triangle& other) const {
    if (!is_proper(ray)) return {};
    ++fallbacks.exact;
    const ExactLinear exact = other.equation(line_from_start(ray));
    if (!exact.is_on_surface) return {};
    if (const auto e = rounded_equation(ray, other); e.is_certain) return Roots{e.height / e.slope};
    return exact.height.sign() == 0 && is_parallel_to(other) ? Roots{} : roots_of(exact);
  }

  [[nodiscard]] static ExactRoot exact_root_on(const Triangle& other, const ExactLine& line) {
    return exact_root_of(triangle_plane_equation(line, other.a, other.b, other.c));
  }

  /// Returns the line from the start, without rounding.
  [[nodiscard]] ExactLine line_from_start(const Ray& ray) const {
    ExactLine line = exact_line(ray);
    line.origin = line.weight * start_.exact();
    return line;
  }

  [[nodiscard]] bool is_parallel_to(const Triangle& other) const {
    const ExactVector sine =
        cross(exact_normal(departed_.a, departed_.b, departed_.c), exact_normal(other.a, other.b, other.c));
    return std::all_of(sine.begin(), sine.end(), [](const ExactNumber& x) { return x.sign() == 0; });
  }

  Triangle departed_;
  InnerPoint start_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

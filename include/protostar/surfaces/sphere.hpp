// A sphere: the points at distance radius from center, and its equation (tutorial, §2.2.4 and A.1.1).
//
// With l = center − origin, a point origin + t·d of a line is on the sphere if |t·d − l|² = r², that is
//   A t² − 2 b t + c = 0   with   A = d·d,  b = d·l,  c = l·l − r²   and the discriminant   D = b² − A c.
// In double, E bounds the error of D, and w = l·l + r² is the size of c's terms.
// A line that starts on the sphere has c = 0 by definition, whatever its digits say; its roots are 0 and
// 2b/A, and only the second is a crossing other than the start.
//
// docs/derivations.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <cmath>
#include <optional>
#include <type_traits>

#include "../interval.hpp"
#include "../magnitude.hpp"
#include "../numeric/double_double.hpp"
#include "../numeric/equation.hpp"
#include "../numeric/rounded_equation.hpp"
#include "../surface.hpp"
#include "../vec3.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Bound of all underflow errors in the discriminant together, 2^-1075 (4A + 3|c| + 6|b| + 2), for A < 2^150.
/// Where c or b are so large that the errors could exceed it, the bound of rounding in E is larger.
inline constexpr double underflow_of_sphere = 0x1p-900;

}  // namespace detail

/// Returns the equation in double, of one line or a packet of lines (origin and direction) and of one sphere
/// or one in each lane.
///
/// E = 2^-48 A w + underflow_of_sphere bounds the error of D, since rounding makes less than 21u A w. It is
/// computed as 2^-68 · (2^20 A w), which overflows to infinity before b², A c or their terms do, and is
/// infinite too if A is not in the range of is_moderate_square; with infinite E no line is decided in double.
[[nodiscard, gnu::always_inline]] inline auto sphere_equation(const auto& rays, const auto& center,
                                                              const auto& radius) {
  const auto l = center - rays.origin;
  const auto A = dot(rays.direction, rays.direction);
  const auto b = dot(rays.direction, l);
  const auto ll = dot(l, l);
  const auto rr = radius * radius;
  const auto c = ll - rr, w = ll + rr;
  using T = std::remove_const_t<decltype(b)>;
  const auto E = 0x1p-68 * (select(detail::is_moderate_square(T(A)), 0x1p20 * T(A), T(infinity)) * w) +
                 detail::underflow_of_sphere;
  return RoundedQuadratic<T, std::remove_const_t<decltype(c)>, true>{
      .A = A, .b = b, .c = c, .w = w, .D = b * b - A * c, .E = E};
}

/// Returns the equation without rounding, with l = weight · center − origin, so that no division is needed.
[[nodiscard]] inline ExactQuadratic sphere_equation(const ExactLine& line, const Point& center,
                                                    double radius) {
  const ExactVector l = line.weight * exact_vector(center) - line.origin;
  const ExactNumber r = line.weight * radius;
  return {.A = dot(line.direction, line.direction), .b = dot(line.direction, l), .c = dot(l, l) - r * r};
}

/// Returns the equation of a line whose numbers are rounded. Their errors o_error and d_error come on top of
/// the rounding of the equation itself (with_errors): A is off by d_error · (2 |d| + d_error) more, b by
/// d_error · (|l| + o_error) + |d| · o_error, and c by o_error · (2 |l| + o_error).
[[nodiscard]] inline RoundedQuadratic<double, double> sphere_equation(const RoundedLine& line,
                                                                      const Point& center, double radius) {
  const Vec3 l = abs(center - line.origin), d = abs(line.direction), &o_error = line.origin_error,
             &d_error = line.direction_error;
  return with_errors(sphere_equation<RoundedLine>(line, center, radius), dot(d_error, 2.0 * d + d_error),
                     dot(d_error, l + o_error) + dot(d, o_error), dot(o_error, 2.0 * l + o_error));
}

/// Tests whether a line certainly starts outside the sphere and leads away from its center, so that it has no
/// root above 0. The error of c is at most 7u w.
template <class T, class C>
[[nodiscard, gnu::always_inline]] inline auto surely_recedes(const RoundedQuadratic<T, C, true>& e) {
  return e.c > 0x1p-50 * e.w && surely_leads_away(e.A, e.b, e.w);
}

/// Returns the certified roots of a ray that starts close to the sphere, where c alone cancels, by c in
/// double-double; std::nullopt if that does not decide. Precondition: the ray does not depart from the
/// sphere, and its transform is null.
[[nodiscard, gnu::noinline, gnu::cold]] inline std::optional<Roots> refined_sphere_roots(const auto& ray,
                                                                                         const Point& center,
                                                                                         double radius) {
  const auto e = sphere_equation(ray, center, radius);
  // In double-double, the error of c is at most 16u² w, below 2^-32 |c| for |c| > 2^-70 w. The rest is as in
  // certified_quotient: |q| is larger than 2^-9 √(A w), since |q|² ≥ √D |q| > 2^31 E, so the errors of b and
  // √D do not need a large c. For w > 2^-900, underflow does not matter.
  if (!(e.D > 4 * e.E && e.w > 0x1p-900)) return std::nullopt;
  const double root = std::sqrt(e.D), q = e.b + std::copysign(root, e.b);
  if (!(root * std::abs(q) > 0x1p31 * e.E)) return std::nullopt;
  DoubleDouble c = -two_product(radius, radius);
  for (int i = 0; i < 3; ++i) {
    const DoubleDouble l = two_sum(center[i], -ray.origin[i]);
    c = c + l * l;
  }
  if (!(std::abs(c.hi) > 0x1p-70 * e.w)) return std::nullopt;
  return roots_from(e.A, c.hi, q);
}

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

  /// Returns the directions in which u and v grow at a point: at a polar angle θ from the y axis, both are of
  /// length sin θ, whatever the radius, and 0 at the poles.
  [[nodiscard]] Tangents tangents_at(const Point& point) const {
    return direction_tangents(unit_along(point - center));
  }

  /// Returns the distance of a point from the sphere, less than 0 inside; as a bound, it is too large by at
  /// most 2^-50 (|p − center| + |radius|). With u = 2^-53, a difference is rounded by u, a sum of squares by
  /// 3u and its root by u, so that the length is off by 3.5u of itself, and the result by u more.
  [[nodiscard]] double distance_bound(const Point& point) const {
    return length(point - center) - std::abs(radius);
  }

  /// Returns the equation of the sphere and a ray, a RoundedLine or each ray of a packet, in double with its
  /// error, or that of an ExactLine, without rounding.
  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return sphere_equation(rays, center, radius);
  }

  /// Returns the roots of a ray that double leaves in doubt, by double-double; std::nullopt if it is still in
  /// doubt. Precondition: the ray does not depart from this sphere, and its transform is null.
  [[nodiscard]] auto refined_roots(const Ray& ray) const { return refined_sphere_roots(ray, center, radius); }

  /// Returns true if no number is infinite or NaN.
  [[nodiscard]] bool has_finite_numbers() const { return is_finite(center) && std::isfinite(radius); }

  /// Returns true if a ray, or the rays of a packet, depart from this sphere or from one that coincides,
  /// inward or outward.
  [[nodiscard]] bool is_left_by(const auto& rays) const {
    return rays.departure.kind == Departure::Kind::sphere && rays.departure.geometry == departure().geometry;
  }

  /// Returns false: a sphere is bounded, so that the far end of a ray, t → ∞, is outside of it (Solid).
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  /// Returns the box around the sphere, rounded outward.
  [[nodiscard]] Bounds bounds() const {
    const Vec3 r(std::abs(radius));
    return outward({center - r, center + r});
  }

  /// Returns center and radius. Spheres that coincide have equal departures: a ray that starts on one leaves
  /// both.
  [[nodiscard]] Departure departure() const {
    return {.kind = Departure::Kind::sphere, .geometry = {center.x, center.y, center.z, std::abs(radius)}};
  }

  /// Throws std::invalid_argument unless each coordinate of the center is at most 2^400 in magnitude and
  /// 2^-400 ≤ |radius| ≤ 2^400 (magnitude.hpp); NaN fails.
  void validate() const {
    require_rule(is_coordinate(center), "Sphere: center must have numbers", coordinate_rule);
    require_rule(is_size(std::abs(radius)), "Sphere: radius must be a number of a magnitude", size_rule);
  }
};

static_assert(SurfaceWithEquation<Sphere> && SurfaceWithBounds<Sphere> && Solid<Sphere>);

}  // namespace protostar::inline PROTOSTAR_ABI

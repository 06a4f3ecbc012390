// A torus: the points at distance `tube` from a circle, whose roots along a line are those of a quartic.
//
// With p relative to the center, the axis a of any length, N = a·a, and k = R² − r², a point is on the torus
// of the radii R and r if f(p) = N (p·p + k)² − 4R² (N p·p − (p·a)²) = 0: N p·p − (p·a)² is N times the
// square of the distance ρ from the axis, and ρ² + h² + k = ±2Rρ is (ρ ∓ R)² + h² = r². Inside f is negative.
// On the points p + x·d of a line, with A = d·d, B = p·d, K = p·p + k, G = d·a and H = p·a, f is
//
//   N A² x⁴ + 4N A B x³ + (N (4B² + 2A K) − 4R² (N A − G²)) x² + (4N B K − 8R² (N B − G H)) x
//     + N K² − 4R² (N p·p − H²).
//
// A ray that leaves the torus has the next crossing at the first x > 0 with the value that f has at 0. The
// constant term is left out, x is divided out, and a cubic remains, without an offset.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "../exact/polynomial_roots.hpp"
#include "../magnitude.hpp"
#include "../march/field_line.hpp"
#include "../march/hit_proof.hpp"
#include "../numeric/exact_root.hpp"
#include "../numeric/scale.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A torus around an axis of any length but 0 through the center. The tube is thinner than the radius, so
/// that there is a hole. Each hit is proven: t is enclosed to 2^-30 of itself, nothing lies before it, and a
/// miss is a miss. A ray that comes nearer to the torus than double-double tells hits, and
/// fallbacks.undecided counts it.
struct Torus {
  Point center{0};
  Vec3 axis{0, 1, 0};
  double radius = 1;   ///< radius of the circle in the middle of the tube
  double tube = 0.25;  ///< radius of the tube

  /// Returns t of the closest hit in the range. Touching is a hit.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal at a point of the torus, from the circle in the middle of the tube to the point.
  [[nodiscard]] Vec3 normal_at(const Point& point) const {
    const Section at = section(point);
    return unit_along(at.outward * at.away + unit_axis() * at.up);
  }

  /// Returns u and v from 0 to 1: u is ½ + the angle around the axis/2π, from e1 to e2 of plane_tangents of
  /// the axis, and v is ½ at the outer equator, ¼ at the top, where the axis leads, and ¾ at the bottom. For
  /// the axis y, u is that of a sphere.
  [[nodiscard]] Uv uv_at(const Point& point) const {
    constexpr double two_pi = 2 * std::numbers::pi;
    const Section at = section(point);
    const auto [e1, e2] = plane_tangents(unit_axis());
    return {0.5 + arc_tangent(dot(e2, at.outward), dot(e1, at.outward)) / two_pi,
            0.5 - arc_tangent(at.up, at.away) / two_pi};
  }
  [[nodiscard]] Tangents tangents_at(const Point& point) const {
    const Vec3 around = cross(unit_axis(), section(point).outward);
    return {around, cross(around, normal_at(point))};
  }

  /// Returns the first crossing in the range.
  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    return first_of_all(*this, ray, range);
  }

  /// Calls visit(const Crossing&) for all crossings in the range, near to far. A touch is two.
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    const Roots4 roots = roots_of_line(ray);
    for (int i = 0; i < roots.count; ++i)
      if (const Crossing crossing{roots.t[i], i}; lies_inside(*this, ray, crossing, range)) visit(crossing);
  }

  /// Returns a crossing, enclosed in double-double.
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    ExactRoot root{.A = 1.0, .b = crossing.t, .D = {}, .error = enclosure_width * std::abs(crossing.t)};
    const detail::ModerateLine line(ray);
    const auto roots = enclosed_roots<DoubleDouble>(ray, detail::enclosed_exact_line(ray, line, line.unit));
    for (int i = 0; i < roots.count; ++i) {
      const Enclosure<DoubleDouble>& t = roots.root[i];
      const DoubleDouble middle = DoubleDouble(0.5) * (t.lower + t.upper);
      if (!(std::abs(line.unit * middle.hi - crossing.t) <= enclosure_width * std::abs(crossing.t))) continue;
      root = exact_root_between(t.lower, t.upper);
      root.b = line.unit * root.b, root.error = line.unit * root.error;
      if (i >= crossing.root) break;  // of equal ones that with the same index
    }
    return root;
  }

  /// Returns this torus, recognized by its address.
  [[nodiscard]] Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }
  [[nodiscard]] bool is_left_by(const Ray& ray) const { return ray.departure.is_from(this); }

  /// Returns false: the far end of a ray is outside a torus (Solid).
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  /// Returns the box that reaches from the center by R √(1 − n_i²) + r on each axis i, for the unit vector n
  /// along the torus' axis, and a thousandth of R + r farther, in which rays that leave it cross it; rounded
  /// outward, since that may be less than the rounding of a center far away.
  [[nodiscard]] Bounds bounds() const {
    const Vec3 n = unit_axis();
    const double more = tube + 0x1p-10 * (radius + tube);
    const auto reach = [&](double j, double k) { return radius * std::sqrt(j * j + k * k) + more; };
    const Vec3 half{reach(n.y, n.z), reach(n.z, n.x), reach(n.x, n.y)};
    return outward({center - half, center + half});
  }

  /// Throws std::invalid_argument if center or axis are not made of coordinates, the axis is 0, a radius is
  /// not a size (magnitude.hpp), or the tube is not thinner than the radius.
  void validate() const {
    require_rule(is_coordinate(center), "Torus: center must have numbers", coordinate_rule);
    require_rule(is_coordinate(axis), "Torus: axis must have numbers", coordinate_rule);
    if (axis == Vec3{0}) throw std::invalid_argument("Torus: axis must not be 0");
    require_rule(is_size(radius), "Torus: radius must be a number", size_rule);
    require_rule(is_size(tube), "Torus: tube must be a number", size_rule);
    if (!(tube < radius))
      detail::refuse_found("Torus: tube must be less than radius, so that there is a hole", tube);
  }

 private:
  /// Place of a point in the plane of it and the axis, in lengths of R + r: the unit vector away from the
  /// axis, and the way from the middle of the tube, away from the axis and along it.
  struct Section {
    Vec3 outward;
    double away, up;
  };

  /// Roots in double, near to far.
  struct Roots4 {
    int count = 0;
    double t[4]{};
  };

  [[nodiscard]] Vec3 unit_axis() const { return unit_along(axis); }

  [[nodiscard]] Section section(const Point& point) const {
    const double size = radius + tube;
    const Vec3 n = unit_axis(), p = within((point - center) * (1 / size), 2);
    const double up = dot(p, n);
    const Vec3 across = p - up * n;
    return {unit_along(across), length(across) - radius / size, up};
  }

  /// Returns all roots of a ray's line in double, those of a line of moderate direction times its unit: as
  /// the search in double tells them if it is certain, and each is enclosed narrowly; otherwise as that in
  /// double-double does. An enclosure there that contains 0 stands for the root 0, which a ray that leaves
  /// the torus does not have; it is undecided if 0 is no root.
  [[nodiscard]] Roots4 roots_of_line(const Ray& ray) const {
    if (!is_proper(ray) || (ray.transform == nullptr && surely_misses(ray, bounds()))) return {};
    Roots4 roots;
    const detail::ModerateLine line(ray);
    const auto add = [&](double t_of_line) {
      const double t = line.unit * t_of_line;
      if (!is_left_by(ray) || is_in_bounds(ray, t)) roots.t[roots.count++] = t;
    };
    const auto first = enclosed_roots<double>(ray, detail::enclosed_line(line));
    bool is_known = first.are_certain;
    for (int i = 0; is_known && i < first.count; ++i)
      is_known = detail::is_narrow(first.root[i].lower, first.root[i].upper);
    if (is_known) {
      for (int i = 0; i < first.count; ++i) add(0.5 * (first.root[i].lower + first.root[i].upper));
      return roots;
    }
    ++fallbacks.double_double;
    const auto second = enclosed_roots<DoubleDouble>(ray, detail::enclosed_exact_line(ray, line, line.unit));
    bool is_decided = second.are_certain;
    for (int i = 0; i < second.count; ++i) {
      const Enclosure<DoubleDouble>& t = second.root[i];
      if (!t.contains(DoubleDouble(0.0))) {
        is_decided = is_decided && detail::is_narrow(t.lower.hi, t.upper.hi);
        add(static_cast<double>(DoubleDouble(0.5) * (t.lower + t.upper)));
      } else {
        is_decided = is_decided && has_root_0(ray);
        if (!is_left_by(ray)) add(0);
      }
    }
    if (!is_decided) ++fallbacks.undecided;
    return roots;
  }

  /// Tests without rounding whether 0 is a root of a ray's line: whether it starts on the torus or, if the
  /// ray leaves the torus, touches it there. With the numbers of the line times its weight w, f(p) is N (p·p
  /// + w² k)² − 4R² w² (N p·p − H²), and a quarter of the slope N B (p·p + w² k) − 2R² w² (N B − G H).
  [[nodiscard, gnu::cold, gnu::noinline]] bool has_root_0(const Ray& ray) const {
    const ExactLine line = exact_line(ray);
    const ExactVector p = line.origin - line.weight * exact_vector(center), &d = line.direction,
                      a = exact_vector(axis);
    const ExactNumber N = dot(a, a), B = dot(p, d), H = dot(p, a), R2 = radius * ExactNumber(radius),
                      ww = line.weight * line.weight, pp = dot(p, p),
                      s = pp + ww * (R2 - tube * ExactNumber(tube)), RR2 = 2 * (R2 * ww);
    return is_left_by(ray) ? N * B * s == RR2 * (N * B - dot(d, a) * H)
                           : N * s * s == 2 * RR2 * (N * pp - H * H);
  }

  /// Tests whether a crossing of a ray that leaves the torus is in the bounds. It is not only if the ray
  /// starts far off the torus.
  [[nodiscard]] bool is_in_bounds(const Ray& ray, double t) const {
    if (ray.transform != nullptr) return true;
    const Point p = ray.at(t);
    const Bounds box = bounds();
    for (int k = 0; k < 3; ++k)
      if (!(box.min[k] <= p[k] && p[k] <= box.max[k])) return false;
    return true;
  }

  template <class B>
  [[nodiscard]] static Enclosure<B> product(const Enclosure<B> (&a)[3], const Enclosure<B> (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  /// Returns the roots t of a line of moderate direction, enclosed.
  ///
  /// The polynomial is one of x with t = t0 + S x, which is seen from the point at t0, and in lengths of a
  /// power of two L that is a hundredth larger than R + r or more, so that it loses few digits and its
  /// numbers are about 1. t0 is near the point nearest to the center, or 0 for a ray that leaves the torus. S
  /// is a power of two for which S|d| is at least L, or 4L if t0 = 0. All roots are in (−1, 1) if x = ±1 is
  /// farther from the center than R + r, seen along d, which is tested: d·d − |p·d| > |d| (R + r)/L.
  template <class B>
  [[nodiscard]] EnclosedRoots<B> enclosed_roots(const Ray& ray, const detail::EnclosedLine<B>& line) const {
    const bool leaves = is_left_by(ray);
    EnclosedRoots<B> roots;
    const auto middle = [](const Enclosure<B>& x) {
      return static_cast<double>(B(0.5) * (x.lower + x.upper));
    };
    Vec3 o, direction;
    for (int k = 0; k < 3; ++k)
      o[k] = middle(line.origin[k]) - center[k], direction[k] = middle(line.direction[k]);
    const int e = std::ilogb(1.01 * (radius + tube)) + 1, d_exponent = exponent_of({direction}) - 1;
    const double unit = std::ldexp(1.0, -e), S = std::ldexp(1.0, e - d_exponent + (leaves ? 2 : 0));
    const Vec3 d_unit = scaled(direction, -d_exponent);
    double t0 = leaves ? 0 : std::ldexp(-dot(o, d_unit) / dot(d_unit, d_unit), -d_exponent);
    if (!std::isfinite(t0)) t0 = 0;

    Enclosure<B> p[3], d[3], a[3];
    const Vec3 a_unit = of_moderate_size(axis);
    for (int k = 0; k < 3; ++k) {
      p[k] = (line.origin[k] - Enclosure<B>(center[k]) + line.direction[k] * t0) * unit;
      d[k] = line.direction[k] * S * unit;
      a[k] = Enclosure<B>(a_unit[k]);
    }
    const Enclosure<B> R = Enclosure<B>(radius) * unit, r = Enclosure<B>(tube) * unit, outer = R + r;
    const Enclosure<B> A = product(d, d), b = product(p, d), P = product(p, p);
    // The square of the distance of the line from the center, times A: above (R + r)² A the line misses.
    if (detail::certain_sign(A * P - square(b) - square(outer) * A) > 0) return roots;
    if (!(detail::certain_sign(A - abs(b) - sqrt(A) * outer) > 0)) {
      roots.are_certain = false;
      return roots;
    }
    const Enclosure<B> N = product(a, a), G = product(d, a), H = product(p, a);
    const Enclosure<B> K = P + (R - r) * outer, RR4 = square(R) * 4.0;
    EnclosedPolynomial<B> f{
        4,
        {N * square(K) - RR4 * (N * P - square(H)), (N * b * K - RR4 * (N * b - G * H) * 0.5) * 4.0,
         N * (square(b) * 4.0 + A * K * 2.0) - RR4 * (N * A - square(G)), N * A * b * 4.0, N * square(A)}};
    if (leaves) f = {3, {f.c[1], f.c[2], f.c[3], f.c[4]}};
    roots = roots_in_unit_interval(f);
    for (int i = 0; i < roots.count; ++i) roots.root[i] = Enclosure<B>(t0) + roots.root[i] * S;
    return roots;
  }
};

static_assert(CompositeSurface<Torus> && SurfaceWithBounds<Torus> && Solid<Torus>);

}  // namespace protostar::inline PROTOSTAR_ABI

// Crossings of a line with what lies in a plane: the plane itself, a disk, a parallelogram, a triangle. Their
// existence is exact, and t is certified (Roots).
//
// With w = p − o for a point p of the plane and a line from o along d, the line crosses the plane at
//   t = n·w / n·d,
// and a surface in the plane if it passes the test of its inside. Double nearly always decides; if its error
// bound does not allow it, everything is evaluated without rounding. docs/derivations.md derives the bounds,
// in units of u = 2^-53, also for a line whose numbers have errors (RoundedLine). In the given ranges,
// underflow is negligible and nothing overflows.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "../vec3.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

[[nodiscard, gnu::always_inline]] inline auto sum_of(const auto& v) { return v.x + v.y + v.z; }

/// Returns the sizes of the terms of u × v.
template <class V>
[[nodiscard, gnu::always_inline]] inline V sizes_of_cross(const V& u, const V& v) {
  const V p = abs(u), q = abs(v);
  return {p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
}

/// Tests whether t = height / slope is as accurate as Roots requires, given the sums of the sizes of the
/// terms of both: their errors are at most 9u and 8u of these sums.
[[nodiscard, gnu::always_inline]] inline auto is_quotient_certain(const auto& height, const auto& heights,
                                                                  const auto& slope, const auto& slopes) {
  using std::abs;
  return abs(height) > 0x1p-18 * heights && abs(slope) > 0x1p-18 * slopes && heights > 0x1p-800 &&
         slopes > 0x1p-800;
}

}  // namespace detail

/// Edges u and v from a corner of a parallelogram or a triangle, or of several in lanes, and the terms of the
/// equation that depend on the edges alone, so that they may be computed once for all lines.
template <class Vector>
struct CornerEdges {
  using Number = decltype(detail::sum_of(Vector()));
  using Truth = std::remove_const_t<decltype(Number() < Number())>;

  Vector u, v, normal, terms;  ///< the edges, u × v, and the sizes of its terms
  Number sum, product;         ///< U + V and U V of the sums of the sizes of u and v
  Truth are_in_range;

  [[gnu::always_inline]] CornerEdges(const Vector& one, const Vector& other)
      : u(one), v(other), normal(cross(u, v)), terms(detail::sizes_of_cross(u, v)) {
    const auto U = detail::sum_of(abs(u)), V = detail::sum_of(abs(v));
    sum = U + V, product = U * V;
    are_in_range = 0x1p-200 < U && U < 0x1p200 && 0x1p-200 < V && V < 0x1p200;
  }
};

namespace detail {

/// Lines that surely pass outside of an outline, and those that surely pass inside.
template <class Lines>
struct SureSides {
  Lines outside, inside;
};
template <class Lines>
SureSides(Lines, Lines) -> SureSides<Lines>;

/// Returns the equation in double of a parallelogram or a triangle with the corner p and two edges u and v,
/// for one or more lines. sides(x, y, slope, E) returns their SureSides, with
///   slope = (u × v)·d,   x = v·m,   y = u·m   and   m = w × d,
/// whose comparisons have an error below E. With U, V, W, D the sums of the sizes of u, v, w and d, errors
/// are at most 11u D (U V + (U + V) W); E is 16u of it.
template <class V>
[[nodiscard, gnu::always_inline]] inline auto equation_along_edges(const auto& rays, const auto& p,
                                                                   const CornerEdges<V>& edges,
                                                                   const auto& sides) {
  const auto w = p - rays.origin;
  const auto m = cross(w, rays.direction);
  const auto w_sizes = origin_sizes(rays, w);
  const auto d_sizes = direction_sizes(rays);
  const auto W = sum_of(w_sizes);
  const auto D = sum_of(d_sizes);
  const auto in_range = edges.are_in_range && W < 0x1p200 && 0x1p-200 < D && D < 0x1p200;

  const auto height = dot(edges.normal, w);
  const auto slope = dot(edges.normal, rays.direction);
  const auto certain =
      in_range && is_quotient_certain(height, dot(edges.terms, w_sizes), slope, dot(edges.terms, d_sizes));

  const auto E = 0x1p-49 * D * (edges.product + edges.sum * W);
  const auto [outside, inside] = sides(dot(edges.v, m), dot(edges.u, m), slope, E);
  const auto misses = in_range && outside, crosses = in_range && inside;
  return RoundedLinear{height, slope, misses, crosses, certain};
}

}  // namespace detail

/// Returns the equation of the plane n · x = distance in double, of one or more lines: height and slope have
/// errors of at most 5u and 4u of the sums of the sizes of their terms.
[[nodiscard, gnu::always_inline]] inline auto plane_equation(const auto& rays, const Vec3& normal,
                                                             double distance) {
  const auto height = distance - dot(normal, rays.origin);
  const auto slope = dot(normal, rays.direction);
  const auto heights = std::abs(distance) + dot(abs(normal), origin_sizes(rays, rays.origin));
  const auto slopes = dot(abs(normal), direction_sizes(rays));
  const auto certain =
      detail::is_quotient_certain(height, heights, slope, slopes) && heights < 0x1p900 && slopes < 0x1p900;
  return RoundedLinear{height, slope, std::remove_const_t<decltype(certain)>(false), certain, certain};
}

/// Returns the equation without rounding.
[[nodiscard]] inline ExactLinear plane_equation(const ExactLine& line, const Vec3& normal, double distance) {
  const ExactVector n = exact_vector(normal);
  return {.height = line.weight * distance - dot(n, line.origin), .slope = dot(n, line.direction)};
}

/// Returns the equation of a disk in double, of one or more lines. Relative to the disk's center, a line is
/// in its plane at
///   t·d − w = ((n·w) d − (n·d) w) / n·d = v / n·d   with   v = n × (d × w),
/// and in the disk if |v| ≤ radius · |n·d|. With N, W, D the sums of the sizes of n, w and d, |v| has an
/// error of at most 9.5u N D W, and radius · |n·d| one of 6u N D radius. Comparing them has an error of at
/// most 10.5u N D (W + radius); E is 16u of it. A line found to be outside misses regardless of the sign of
/// the slope.
[[nodiscard, gnu::always_inline]] inline auto disk_equation(const auto& rays, const Point& position,
                                                            const Vec3& normal, double radius) {
  using std::abs, std::sqrt;
  const auto w = position - rays.origin;
  const auto w_sizes = origin_sizes(rays, w);
  const auto d_sizes = direction_sizes(rays);
  const double N = detail::sum_of(abs(normal));
  const auto W = detail::sum_of(w_sizes);
  const auto D = detail::sum_of(d_sizes);
  const auto in_range = 0x1p-100 < N && N < 0x1p100 && 0x1p-100 < D && D < 0x1p100 && W < 0x1p100 &&
                        0x1p-200 < radius && radius < 0x1p100;

  const auto height = dot(normal, w);
  const auto slope = dot(normal, rays.direction);
  const auto certain = in_range && detail::is_quotient_certain(height, dot(abs(normal), w_sizes), slope,
                                                               dot(abs(normal), d_sizes));
  const auto m = cross(rays.direction, w);
  const std::remove_const_t<decltype(m)> v{normal.y * m.z - normal.z * m.y, normal.z * m.x - normal.x * m.z,
                                           normal.x * m.y - normal.y * m.x};
  const auto from_center = sqrt(dot(v, v));
  const auto reach = radius * abs(slope);
  const auto E = 0x1p-49 * N * D * (W + radius);
  const auto misses = in_range && from_center > reach + E, crosses = in_range && from_center < reach - E;
  return RoundedLinear{height, slope, misses, crosses, certain};
}

/// Returns the equation without rounding, with w = weight · position − origin.
[[nodiscard]] inline ExactLinear disk_equation(const ExactLine& line, const Point& position,
                                               const Vec3& normal, double radius) {
  const ExactVector n = exact_vector(normal), w = line.weight * exact_vector(position) - line.origin,
                    v = cross(n, cross(line.direction, w));
  ExactLinear e{.height = dot(n, w), .slope = dot(n, line.direction)};
  const ExactNumber reach = line.weight * radius * e.slope;
  e.is_on_surface = (reach * reach - dot(v, v)).sign() >= 0;
  return e;
}

/// Returns the equation of a parallelogram in double, of one or more lines. A point of a line is the point
/// position + a·u + b·v of the plane if t·d = w + a·u + b·v. By Cramer's rule, with S = (u × v)·d and m = w ×
/// d, this holds for
///   a = v·m / S,   b = −u·m / S,
/// and the point is in the parallelogram for 0 ≤ a ≤ 1 and 0 ≤ b ≤ 1. If even the sign of S is in doubt, |S|
/// is so small that a line found to be outside misses with either sign.
[[nodiscard, gnu::always_inline]] inline auto parallelogram_equation(const auto& rays, const Point& position,
                                                                     const CornerEdges<Vec3>& edges) {
  return detail::equation_along_edges(
      rays, position, edges, [](const auto& x, const auto& y, const auto& slope, const auto& E) {
        using std::abs;
        const auto turned = slope < 0.0;
        const auto along_u = select(turned, -x, x), along_v = select(turned, y, -y), end = abs(slope);
        return detail::SureSides{along_u < -E || along_v < -E || along_u > end + E || along_v > end + E,
                                 along_u > E && along_v > E && along_u < end - E && along_v < end - E};
      });
}

[[nodiscard, gnu::always_inline]] inline auto parallelogram_equation(const auto& rays, const Point& position,
                                                                     const Vec3& edge_u, const Vec3& edge_v) {
  return parallelogram_equation(rays, position, CornerEdges(edge_u, edge_v));
}

/// Returns the equation without rounding: t·d = w + weight · (a·u + b·v) with w = weight · position − origin.
[[nodiscard]] inline ExactLinear parallelogram_equation(const ExactLine& line, const Point& position,
                                                        const Vec3& edge_u, const Vec3& edge_v) {
  const ExactVector u = exact_vector(edge_u), v = exact_vector(edge_v), n = cross(u, v),
                    w = line.weight * exact_vector(position) - line.origin, m = cross(w, line.direction);
  ExactLinear e{.height = dot(n, w), .slope = dot(n, line.direction)};
  // a, b and their upper limit 1, times |S| · weight.
  const ExactNumber sign = e.slope.sign(), along_u = sign * dot(v, m), along_v = -(sign * dot(u, m)),
                    end = sign * line.weight * e.slope;
  for (const ExactNumber& distance_to_edge : {along_u, along_v, end - along_u, end - along_v})
    e.is_on_surface = e.is_on_surface && distance_to_edge.sign() >= 0;
  return e;
}

// A line passes the edge of a triangle from p to q on the side that is the sign of
//   side(p, q) = d · ((p − o) × (q − o)) = d · (p × q) + o · ((p − q) × d),
// and it crosses the triangle a, b, c if it passes all three edges, one after the other along the outline, on
// the same side. The sum of the sides is d·n with n = (b − a) × (c − a).
//
// If a side is 0, the line meets the edge or its extension. The origin is then regarded as moved by (ε, ε²,
// ε³), with an ε > 0 that is smaller than any number (Edelsbrunner and Mücke, "Simulation of Simplicity",
// 1990): the sign is that of the first component of (p − q) × d that is not 0. If all are 0, the edge is
// parallel to the line, the triangle is seen edge-on, and it is not crossed.
//
// Hence side(q, p) is always −side(p, q), and a line aimed at an edge that two triangles share, or at a
// vertex of many, passes them like a line next to it: through one of them, and not through two.

/// Returns the equation of a triangle in double, of one or more lines and one or more triangles, given its
/// corner a and the edges u = b − a and v = c − a. With these,
///   side(a, b) = −u·m,   side(c, a) = v·m,   side(b, c) = n·d − side(a, b) − side(c, a).
template <class V>
[[nodiscard, gnu::always_inline]] inline auto triangle_equation(const auto& rays, const V& a,
                                                                const CornerEdges<V>& edges) {
  return detail::equation_along_edges(rays, a, edges,
                                      [](const auto& x, const auto& y, const auto& slope, const auto& E) {
                                        using std::max, std::min;
                                        const auto ab = -y, ca = x, bc = slope - ab - ca;
                                        const auto least = min(ab, min(bc, ca)), most = max(ab, max(bc, ca));
                                        const auto outside = most > E && least < -E;
                                        return detail::SureSides{outside, least > E || most < -E};
                                      });
}
[[nodiscard, gnu::always_inline]] inline auto triangle_equation(const auto& rays, const auto& a,
                                                                const auto& b, const auto& c) {
  return triangle_equation(rays, a, CornerEdges(b - a, c - a));
}

namespace detail {

/// Returns the side on which a line passes the edge from p to q: 1 or -1, or 0 if it is parallel to the edge.
/// The edge from q to p is passed on the other side.
[[nodiscard]] inline int side_of_edge(const ExactLine& line, const Point& p, const Point& q) {
  // With P = weight · p − origin and Q = weight · q − origin, d · (P × Q) = weight (q − p) · (d × P), as P
  // drops out of Q = weight (q − p) + P.
  const ExactVector along = exact_difference(q, p), &d = line.direction;
  const int side = dot(along, cross(d, line.weight * exact_vector(p) - line.origin)).sign();
  if (side != 0) return side;
  for (const ExactNumber& component : cross(d, along))  // (p − q) × d
    if (component.sign() != 0) return component.sign();
  return 0;
}

}  // namespace detail

/// Returns the equation of the triangle's plane without rounding.
[[nodiscard]] inline ExactLinear triangle_plane_equation(const ExactLine& line, const Point& a,
                                                         const Point& b, const Point& c) {
  const ExactVector n = cross(exact_difference(b, a), exact_difference(c, a));
  return {.height = dot(n, line.weight * exact_vector(a) - line.origin), .slope = dot(n, line.direction)};
}

/// Returns the equation of the triangle without rounding.
[[nodiscard]] inline ExactLinear triangle_equation(const ExactLine& line, const Point& a, const Point& b,
                                                   const Point& c) {
  ExactLinear e = triangle_plane_equation(line, a, b, c);
  const int side = detail::side_of_edge(line, a, b);
  e.is_on_surface =
      side != 0 && detail::side_of_edge(line, b, c) == side && detail::side_of_edge(line, c, a) == side;
  return e;
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Crossings of a line with a triangle: their existence is exact, and t is certified (Roots).
//
// A line from o along d passes the edge from p to q on the side that is the sign of
//   side(p, q) = d · ((p − o) × (q − o)) = d · (p × q) + o · ((p − q) × d),
// and it crosses the triangle a, b, c if it passes all three edges, one after the other along the outline, on
// the same side. The sum of the sides is d·n with n = (b − a) × (c − a), and the plane is crossed at t = n·(a
// − o) / d·n.
//
// If a side is 0, the line meets the edge or its extension. The origin is then regarded as moved by (ε, ε²,
// ε³), with an ε > 0 that is smaller than any number (Edelsbrunner and Mücke, "Simulation of Simplicity",
// 1990): the sign is that of the first component of (p − q) × d that is not 0. If all are 0, the edge is
// parallel to the line, the triangle is seen edge-on, and it is not crossed.
//
// Hence side(q, p) is always −side(p, q), and a line aimed at an edge that two triangles share, or at a
// vertex of many, passes them like a line next to it: through one of them, and not through two. Double nearly
// always decides; if its error bound does not allow it, a side is evaluated without rounding.
// docs/derivations.md derives the bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "../vec3.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Returns the side on which a line passes the edge from p to q: 1 or -1, or 0 if it is parallel to the edge;
/// empty if rounded numbers do not decide. The edge from q to p is passed on the other side.
template <class T>
[[nodiscard]] std::optional<int> side_of_edge(const LineOf<T>& line, const Point& p, const Point& q) {
  // With P = weight · p − origin and Q = weight · q − origin, d · (P × Q) = weight (q − p) · (d × P), as P
  // drops out of Q = weight (q − p) + P.
  const VectorOf<T> along = vector_of<T>(q) - vector_of<T>(p), &d = line.direction;
  const auto side = sign_of(dot(along, cross(d, line.weight * given<T>(p) - line.origin)));
  if (!side || *side != 0) return side;
  const VectorOf<T> moved = cross(d, along);  // (p − q) × d
  for (const T& component : moved)
    if (const auto sign = sign_of(component); !sign || *sign != 0) return sign;
  return 0;
}

}  // namespace detail

/// Returns the equation of the triangle's plane, in numbers of type T.
template <class T>
[[nodiscard]] LinearEquation<T> triangle_plane_equation(const LineOf<T>& line, const Point& a, const Point& b,
                                                        const Point& c) {
  const VectorOf<T> from = vector_of<T>(a), n = cross(vector_of<T>(b) - from, vector_of<T>(c) - from);
  return {.height = dot(n, line.weight * given<T>(a) - line.origin), .slope = dot(n, line.direction)};
}

/// Returns the equation of the triangle, in numbers of type T; 0 t = 0 if the line certainly misses it.
template <class T>
[[nodiscard]] LinearEquation<T> triangle_equation(const LineOf<T>& line, const Point& a, const Point& b,
                                                  const Point& c) {
  const Point* const corners[] = {&a, &b, &c, &a};
  std::optional<int> first;
  bool is_decided = true;
  for (int i = 0; i < 3; ++i) {
    const auto side = detail::side_of_edge(line, *corners[i], *corners[i + 1]);
    if (side == 0 || (side && first && *side != *first))
      return {.height = T(0.0), .slope = T(0.0), .is_on_surface = false};
    is_decided = is_decided && side;
    if (!first) first = side;
  }
  LinearEquation<T> e = triangle_plane_equation(line, a, b, c);
  if (!is_decided) e.is_on_surface = std::nullopt;
  return e;
}

/// Slack of a line whose numbers are exact.
struct NoSlack {
  template <class T>
  friend T operator+(const T& size, NoSlack) {
    return size;
  }
};

/// Returns the slack of a line whose numbers have errors of at most error.
[[nodiscard]] inline double slack_for(double error) { return 0x1p50 * error; }

/// Returns the equation in double, of one or more lines and one or more triangles. With the edges u = b − a
/// and v = c − a, w = a − o and m = w × d,
///   side(a, b) = −u·m,   side(c, a) = v·m,   side(b, c) = n·d − side(a, b) − side(c, a).
/// In units of 2^-53, and U, V, W, D being the sums of the magnitudes of the components of u, v, w and d:
///
/// - side(a, b) and side(c, a) have errors of at most 7 of U W D and V W D, n·d has 7 of U V D, and side(b,
///   c) at most 9 of all three. E is 16 of these.
/// - n·w and n·d have at most 8 and 7 of the sums of the magnitudes of their terms. Above 2^-18 of these
///   sums, t is accurate to 2^-31.
///
/// In the given range, underflow is negligible and nothing overflows.
///
/// If the numbers of the line have errors e of the origin and f of the direction, on each axis, the slacks
/// are 2^50 of these and are added to the magnitudes of the components of w and d. Such a line has a side (p,
/// q) that differs by at most e |q − p|₁ D and f |q − p|₁ W, which E then exceeds sixfold, an n·w that
/// differs by e of the magnitudes of the components of n, and an n·d that differs by f of them: 2^-32 of
/// itself if above 2^-18 of these sums. Hence t is accurate to 2^-30.
[[nodiscard, gnu::always_inline]] inline auto triangle_equation(const auto& origin, const auto& direction,
                                                                const auto& a, const auto& b, const auto& c,
                                                                const auto& slack_of_origin,
                                                                const auto& slack_of_direction) {
  using std::abs, std::max, std::min;
  const auto sum_of_sizes = [](const auto& v) { return abs(v.x) + abs(v.y) + abs(v.z); };
  const auto u = b - a, v = c - a;
  const auto w = a - origin;
  const auto m = cross(w, direction);
  const auto U = sum_of_sizes(u), V = sum_of_sizes(v);
  const std::remove_const_t<decltype(w)> w_sizes{abs(w.x) + slack_of_origin, abs(w.y) + slack_of_origin,
                                                 abs(w.z) + slack_of_origin};
  const std::remove_cvref_t<decltype(direction)> d_sizes{abs(direction.x) + slack_of_direction,
                                                         abs(direction.y) + slack_of_direction,
                                                         abs(direction.z) + slack_of_direction};
  const auto W = w_sizes.x + w_sizes.y + w_sizes.z;
  const auto D = d_sizes.x + d_sizes.y + d_sizes.z;
  const auto in_range = 0x1p-200 < U && U < 0x1p200 && 0x1p-200 < V && V < 0x1p200 && W < 0x1p200 &&
                        0x1p-200 < D && D < 0x1p200;

  const auto n = cross(u, v), p = abs(u), q = abs(v);
  const std::remove_const_t<decltype(n)> terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z,
                                               p.x * q.y + p.y * q.x};  // terms of n
  const auto height = dot(n, w);
  const auto slope = dot(n, direction);
  const auto heights = dot(terms, w_sizes);
  const auto slopes = dot(terms, d_sizes);
  const auto certain = in_range && abs(height) > 0x1p-18 * heights && abs(slope) > 0x1p-18 * slopes &&
                       heights > 0x1p-800 && slopes > 0x1p-800;

  const auto ab = -dot(u, m), ca = dot(v, m), bc = slope - ab - ca;
  const auto E = 0x1p-49 * D * (U * V + (U + V) * W);
  const auto least = min(ab, min(bc, ca)), most = max(ab, max(bc, ca));
  const auto misses = in_range && most > E && least < -E, crosses = in_range && (least > E || most < -E);
  return RoundedLinear{height, slope, misses, crosses, certain};
}

}  // namespace protostar::inline PROTOSTAR_ABI

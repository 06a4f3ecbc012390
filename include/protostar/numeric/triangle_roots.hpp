// Where a line crosses a triangle: exactly whether, and t as certain as Roots says.
//
// A line from o along d passes the edge from p to q on the side that is the sign of
//   side(p, q) = d · ((p − o) × (q − o)) = d · (p × q) + o · ((p − q) × d),
// and it crosses the triangle a, b, c if it passes all three edges, one after the other along the outline, on
// the same side. Their sum is d·n with n = (b − a) × (c − a), and the plane is crossed at t = n·(a − o) /
// d·n.
//
// Where a side is 0, the line meets the edge or what it is a part of. The origin is then thought moved by (ε,
// ε², ε³), with an ε > 0 that is smaller than any number (Edelsbrunner and Mücke, "Simulation of Simplicity",
// 1990): the sign is that of the first component of (p − q) × d that is not 0. If all are, the edge is
// parallel to the line, the triangle is seen from its edge, and no side of it counts.
//
// So side(q, p) is always −side(p, q), and a line that is aimed at an edge that two triangles share, or at a
// vertex of many, passes them as a line next to it does: through one of them, and not through two. Double
// decides nearly always; where its error bound does not allow that, a side is evaluated without rounding.
// docs/numerics.md derives the bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "../vec3.hpp"
#include "exact_root.hpp"
#include "plane_through.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// On which side a line of finite numbers passes the edge from p to q: 1 or -1, or 0 where it is parallel to
/// it. The other way round, the edge is passed on the other side.
[[nodiscard, gnu::cold, gnu::noinline]] inline int exact_side(const Point& origin, const Vec3& direction,
                                                              const Point& p, const Point& q) {
  // The other way round it is the other sign, also where a product would underflow.
  if (std::tie(q.x, q.y, q.z) < std::tie(p.x, p.y, p.z)) return -exact_side(origin, direction, q, p);
  const int lengths = exponent_of({origin, p, q});
  const Point o = scaled(origin, -lengths), from = scaled(p, -lengths), to = scaled(q, -lengths);
  const ExactVector d = exact_vector(scaled(direction, -exponent_of({direction})));
  const ExactVector along = exact_difference(to, from);
  // d · ((p − o) × (q − o)) = (q − p) · (d × (p − o)), as p − o drops out of q − o = (q − p) + (p − o).
  const Expansion side = exact_dot(along, exact_cross(d, exact_difference(from, o)));
  if (side.sign() != 0) return side.sign();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3, l = (i + 2) % 3;
    const Expansion component = d[k] * along[l] - d[l] * along[k];  // of (p − q) × d
    if (component.sign() != 0) return component.sign();
  }
  return 0;
}

/// Both parts of t in double, the sides by which the line passes the edges, and what is certain: that it
/// misses the triangle, that it crosses it, and that t is good enough.
template <class T, class M>
struct RoundedTriangleEquation {
  T height, slope;
  T ab, bc, ca, error;  ///< the sides; in range, each is off by less than the error
  M in_range, misses, crosses, certain;
};

/// With the edges u = b − a and v = c − a, w = a − o and m = w × d,
///   side(a, b) = −u·m,   side(c, a) = v·m,   side(b, c) = n·d − side(a, b) − side(c, a).
/// In units of 2^-53, and U, V, W, D being the sums of the sizes of the components of u, v, w and d:
///
/// - side(a, b) and side(c, a) have errors of at most 7 of U W D and V W D, n·d has 7 of U V D, and side(b,
///   c) at most 9 of all three. E is 16 of these.
/// - n·w and n·d have at most 8 and 7 of the sums of the sizes of their terms. Above 2^-18 of these sums, t
///   is good to 2^-31.
///
/// In the range given, what underflows adds nothing to speak of, and nothing overflows.
[[nodiscard, gnu::always_inline]] inline auto rounded_triangle_equation(const auto& origin,
                                                                        const auto& direction, const auto& a,
                                                                        const auto& b, const auto& c) {
  using std::abs, std::max, std::min;
  const auto sum_of_sizes = [](const auto& v) { return abs(v.x) + abs(v.y) + abs(v.z); };
  const auto u = b - a, v = c - a;
  const auto w = a - origin;
  const auto m = cross(w, direction);
  const auto U = sum_of_sizes(u), V = sum_of_sizes(v);
  const auto W = sum_of_sizes(w);
  const auto D = sum_of_sizes(direction);
  const auto in_range = 0x1p-200 < U && U < 0x1p200 && 0x1p-200 < V && V < 0x1p200 && W < 0x1p200 &&
                        0x1p-200 < D && D < 0x1p200;

  const auto n = cross(u, v), p = abs(u), q = abs(v);
  const std::remove_const_t<decltype(n)> terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z,
                                               p.x * q.y + p.y * q.x};  // of n
  const auto height = dot(n, w);
  const auto slope = dot(n, direction);
  const auto heights = dot(terms, abs(w));
  const auto slopes = dot(terms, abs(direction));
  const auto certain = in_range && abs(height) > 0x1p-18 * heights && abs(slope) > 0x1p-18 * slopes &&
                       heights > 0x1p-800 && slopes > 0x1p-800;

  const auto ab = -dot(u, m), ca = dot(v, m), bc = slope - ab - ca;
  const auto E = 0x1p-49 * D * (U * V + (U + V) * W);
  const auto least = min(ab, min(bc, ca)), most = max(ab, max(bc, ca));
  const auto misses = in_range && most > E && least < -E, crosses = in_range && (least > E || most < -E);
  return RoundedTriangleEquation<std::remove_const_t<decltype(slope)>, std::remove_const_t<decltype(misses)>>{
      height, slope, ab, bc, ca, E, in_range, misses, crosses, certain};
}

/// Whether the line of finite numbers crosses the triangle, where double may not decide.
[[nodiscard, gnu::cold, gnu::noinline]] inline bool crosses_triangle_in_doubt(
    const RoundedTriangleEquation<double, bool>& e, const Point& origin, const Vec3& direction,
    const Point& a, const Point& b, const Point& c) {
  const auto side = [&](double rounded, const Point& p, const Point& q) {
    if (e.in_range && std::abs(rounded) > e.error) return rounded > 0 ? 1 : -1;
    return exact_side(origin, direction, p, q);
  };
  const int first = side(e.ab, a, b);
  return first != 0 && side(e.bc, b, c) == first && side(e.ca, c, a) == first;
}

}  // namespace detail

/// Where the line crosses the triangle's plane, without rounding: A > 0, or A = 0 where it is parallel.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_triangle_root(const Point& origin,
                                                                             const Vec3& direction,
                                                                             const Point& a, const Point& b,
                                                                             const Point& c) {
  // Powers of two, as for the sphere.
  const int lengths = exponent_of({origin, a, b, c}), directions = exponent_of({direction});
  const Point o = scaled(origin, -lengths), p = scaled(a, -lengths), q = scaled(b, -lengths),
              r = scaled(c, -lengths);
  const ExactVector n = exact_cross(exact_difference(q, p), exact_difference(r, p));
  const Expansion height = exact_dot(n, exact_difference(p, o));
  const Expansion slope = exact_dot(n, exact_vector(scaled(direction, -directions)));
  const bool negative = slope.sign() < 0;
  return {.A = negative ? -slope : slope,
          .b = negative ? -height : height,
          .D = {},
          .exponent = lengths - directions};
}

/// The root in double-double; none where the line does not cross the triangle.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_triangle_roots(
    const Point& origin, const Vec3& direction, const Point& a, const Point& b, const Point& c) {
  ++fallbacks.exact;
  const auto e = detail::rounded_triangle_equation(origin, direction, a, b, c);
  if (!e.crosses && !detail::crosses_triangle_in_doubt(e, origin, direction, a, b, c)) return {};
  return refined_linear_root(exact_triangle_root(origin, direction, a, b, c));
}

namespace detail {

/// The sign of n·w, with n = (b − a) × (c − a): in double if that is sure, or else exact(). In double n·w is
/// off by at most 8 units of 2^-53 of the sum of the sizes of its terms, as above. In the range given, what
/// underflows in n is below 2^-1073, which is times w less than 2^-872, far below 2^-49 of 2^-800.
[[nodiscard]] inline int sign_along_normal(const Vec3& w, const Point& a, const Point& b, const Point& c,
                                           const auto& exact) {
  const Vec3 u = b - a, v = c - a, p = abs(u), q = abs(v);
  const Vec3 terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
  const double along = dot(cross(u, v), w), sizes = dot(terms, abs(w));
  const auto is_moderate = [](const Vec3& sizes_of_one) {
    const double size = sizes_of_one.x + sizes_of_one.y + sizes_of_one.z;
    return 0x1p-200 < size && size < 0x1p200;
  };
  if (is_moderate(p) && is_moderate(q) && is_moderate(abs(w)) && sizes > 0x1p-800 &&
      std::abs(along) > 0x1p-49 * sizes)
    return along > 0 ? 1 : -1;
  return exact();
}

}  // namespace detail

/// To which side of the plane through a, b and c a direction leads: the sign of d·n, without rounding.
[[nodiscard]] inline int side_led_to(const Vec3& direction, const Point& a, const Point& b, const Point& c) {
  return detail::sign_along_normal(direction, a, b, c, [&] {
    const int lengths = exponent_of({a, b, c});
    const Point p = scaled(a, -lengths), q = scaled(b, -lengths), r = scaled(c, -lengths);
    return exact_dot(exact_cross(exact_difference(q, p), exact_difference(r, p)),
                     exact_vector(scaled(direction, -exponent_of({direction}))))
        .sign();
  });
}

/// On which side of it a point is: the sign of n·(point − a), without rounding.
[[nodiscard]] inline int side_of_point(const Point& point, const Point& a, const Point& b, const Point& c) {
  if (point == a || point == b || point == c) return 0;
  return detail::sign_along_normal(point - a, a, b, c, [&] {
    const int lengths = exponent_of({a, b, c, point});
    const Point p = scaled(a, -lengths), q = scaled(b, -lengths), r = scaled(c, -lengths);
    return exact_dot(exact_cross(exact_difference(q, p), exact_difference(r, p)),
                     exact_difference(scaled(point, -lengths), p))
        .sign();
  });
}

namespace detail {

/// The root where double does not decide. Numbers that are not finite cross nothing.
[[nodiscard, gnu::noinline, gnu::cold]] inline Roots triangle_roots_in_doubt(
    const RoundedTriangleEquation<double, bool>& e, const Point& origin, const Vec3& direction,
    const Point& a, const Point& b, const Point& c) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(a) || !is_finite(b) || !is_finite(c))
    return {};
  ++fallbacks.exact;
  if (!e.crosses && !crosses_triangle_in_doubt(e, origin, direction, a, b, c)) return {};
  if (e.certain) return Roots{e.height / e.slope};
  const RefinedRoots refined = refined_linear_root(exact_triangle_root(origin, direction, a, b, c));
  return refined.count == 0 ? Roots{} : Roots{static_cast<double>(refined.t[0])};
}

}  // namespace detail

/// The root, certified.
[[nodiscard, gnu::always_inline]] inline Roots triangle_roots(const Point& origin, const Vec3& direction,
                                                              const Point& a, const Point& b,
                                                              const Point& c) {
  const auto e = detail::rounded_triangle_equation(origin, direction, a, b, c);
  if (e.misses) return {};
  if (e.crosses && e.certain) return Roots{e.height / e.slope};
  return detail::triangle_roots_in_doubt(e, origin, direction, a, b, c);
}

/// The roots of several lines at once; see sphere_roots_of_each.
[[nodiscard, gnu::always_inline]] inline auto triangle_roots_of_each(const auto& origin,
                                                                     const auto& direction, const Point& a,
                                                                     const Point& b, const Point& c,
                                                                     const auto& wanted) {
  using M = std::remove_cvref_t<decltype(wanted)>;
  using T = std::remove_cvref_t<decltype(direction.x)>;
  if (!any(wanted))
    return RootsOfEach<T, M>{.near_over = 0.0,
                             .near_under = 1.0,
                             .far_over = 0.0,
                             .far_under = 1.0,
                             .meets = wanted,
                             .in_doubt = wanted,
                             .count = 1};
  const auto e = detail::rounded_triangle_equation(origin, direction, a, b, c);
  const T height = e.height;
  const M meets = e.crosses && e.certain;
  return RootsOfEach<T, M>{.near_over = height,
                           .near_under = e.slope,
                           .far_over = height,
                           .far_under = e.slope,
                           .meets = wanted && meets,
                           .in_doubt = wanted && !e.misses && !meets,
                           .count = 1};
}

}  // namespace protostar::inline PROTOSTAR_ABI

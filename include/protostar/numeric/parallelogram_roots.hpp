// Where a line crosses a parallelogram: exactly whether, and t as certain as Roots says.
//
// With w = position − origin, a point origin + t·d of the line is the point position + a·u + b·v of the plane
// where t·d = w + a·u + b·v. By Cramer's rule, with S = (u × v)·d and m = w × d, that is for
//   t = (u × v)·w / S,   a = v·m / S,   b = −u·m / S,
// and it is a point of the parallelogram for 0 ≤ a ≤ 1 and 0 ≤ b ≤ 1. Double decides nearly always; where its
// error bound does not allow that, everything is evaluated without rounding. docs/numerics.md derives the
// bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "../vec3.hpp"
#include "exact_root.hpp"
#include "plane_through.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// A line and a parallelogram of finite numbers, without rounding.
struct ExactParallelogramEquation {
  Expansion height, slope;  ///< slope = |S|, and height/slope is t but for a power of two
  int exponent;             ///< of that
  bool is_inside = false;   ///< whether the line crosses the plane in the parallelogram

  [[gnu::cold, gnu::noinline]] ExactParallelogramEquation(const Point& origin, const Vec3& direction,
                                                          const Point& position, const Vec3& edge_u,
                                                          const Vec3& edge_v) {
    // Powers of two, as for the sphere. No length is larger than 1 in units of the common one, so that
    // nothing below is scaled up.
    const int us = exponent_of({edge_u}), vs = exponent_of({edge_v}), directions = exponent_of({direction});
    const int lengths = std::max({us, vs, exponent_of({origin, position})});
    const ExactVector u = exact_vector(scaled(edge_u, -us)), v = exact_vector(scaled(edge_v, -vs)),
                      d = exact_vector(scaled(direction, -directions)),
                      p = exact_vector(scaled(position, -lengths)),
                      o = exact_vector(scaled(origin, -lengths)), w = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
    const ExactVector n = exact_cross(u, v), m = exact_cross(w, d);
    height = exact_dot(n, w);
    slope = exact_dot(n, d);
    exponent = lengths - directions;
    Expansion along_u = exact_dot(v, m), along_v = -exact_dot(u, m);
    if (slope.sign() < 0) {
      height = -height, slope = -slope;
      along_u = -along_u, along_v = -along_v;
    }
    if (slope.sign() == 0 || along_u.sign() < 0 || along_v.sign() < 0) return;
    Expansion end_u = slope, end_v = slope;  // along_u and along_v for a = 1 and b = 1
    end_u.scale(us - lengths), end_v.scale(vs - lengths);
    is_inside = (end_u - along_u).sign() >= 0 && (end_v - along_v).sign() >= 0;
  }
};

}  // namespace detail

/// Where the line crosses the parallelogram's plane, without rounding: A > 0, or A = 0 where it is parallel.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_parallelogram_root(const Point& origin,
                                                                                  const Vec3& direction,
                                                                                  const Point& position,
                                                                                  const Vec3& edge_u,
                                                                                  const Vec3& edge_v) {
  const detail::ExactParallelogramEquation e(origin, direction, position, edge_u, edge_v);
  return {.A = e.slope, .b = e.height, .D = {}, .exponent = e.exponent};
}

/// The root in double-double; none where the line does not cross the parallelogram.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_parallelogram_roots(const Point& origin,
                                                                                        const Vec3& direction,
                                                                                        const Point& position,
                                                                                        const Vec3& edge_u,
                                                                                        const Vec3& edge_v) {
  ++fallbacks.exact;
  const detail::ExactParallelogramEquation e(origin, direction, position, edge_u, edge_v);
  if (!e.is_inside) return {};
  return refined_linear_root({.A = e.slope, .b = e.height, .D = {}, .exponent = e.exponent});
}

namespace detail {

/// The root where double does not decide. Numbers that are not finite cross nothing.
[[nodiscard, gnu::noinline, gnu::cold]] inline Roots parallelogram_roots_in_doubt(const Point& origin,
                                                                                  const Vec3& direction,
                                                                                  const Point& position,
                                                                                  const Vec3& edge_u,
                                                                                  const Vec3& edge_v) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(position) || !is_finite(edge_u) ||
      !is_finite(edge_v))
    return {};
  const RefinedRoots refined = refined_parallelogram_roots(origin, direction, position, edge_u, edge_v);
  return refined.count == 0 ? Roots{} : Roots{static_cast<double>(refined.t[0])};
}

/// Both parts of t in double, and what is certain: that the line misses the parallelogram, or that it crosses
/// it and t is good enough.
template <class T, class M>
struct RoundedParallelogramEquation {
  T height, slope;
  M misses, meets;
};

/// With u = 2^-53, and U, V, W, D the sums of the sizes of the components of u, v, w and d:
///
/// - height and slope have errors of at most 6u and 5u of the sums of the sizes of their terms. Above 2^-19
///   of these sums, t is good to 2^-30.
/// - v·m and u·m have 6u of V W D and U W D, and S has 5u U V D. Compared with each other, a, b and 1, times
///   S, are good to 7u D (U V + max(U, V) W); E is 8u of it. Where even the sign of S is not sure, |S| is
///   smaller than E allows for a line that is found to miss.
///
/// In the range given, what underflows adds nothing to speak of, and nothing overflows.
[[nodiscard, gnu::always_inline]] inline auto rounded_parallelogram_equation(const auto& origin,
                                                                             const auto& direction,
                                                                             const Point& position,
                                                                             const Vec3& edge_u,
                                                                             const Vec3& edge_v) {
  using std::abs;
  const auto sum_of_sizes = [](const auto& v) { return abs(v.x) + abs(v.y) + abs(v.z); };
  const auto w = position - origin;
  const auto m = cross(w, direction);
  const double U = sum_of_sizes(edge_u), V = sum_of_sizes(edge_v);
  const auto W = sum_of_sizes(w);
  const auto D = sum_of_sizes(direction);
  const auto in_range = 0x1p-200 < U && U < 0x1p200 && 0x1p-200 < V && V < 0x1p200 && W < 0x1p200 &&
                        0x1p-200 < D && D < 0x1p200;

  const Vec3 n = cross(edge_u, edge_v), p = abs(edge_u), q = abs(edge_v);
  const Vec3 terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};  // of n
  const auto height = dot(n, w);
  const auto slope = dot(n, direction);
  const auto heights = dot(terms, abs(w));
  const auto slopes = dot(terms, abs(direction));
  const auto certain = abs(height) > 0x1p-19 * heights && abs(slope) > 0x1p-19 * slopes &&
                       heights > 0x1p-800 && slopes > 0x1p-800;

  const auto turned = slope < 0.0;
  const auto x = dot(edge_v, m), y = dot(edge_u, m), end = abs(slope);
  const auto along_u = select(turned, -x, x), along_v = select(turned, y, -y);
  const auto E = 0x1p-50 * D * (U * V + std::max(U, V) * W);
  const auto outside = along_u < -E || along_v < -E || along_u > end + E || along_v > end + E;
  const auto inside = along_u > E && along_v > E && along_u < end - E && along_v < end - E;
  const auto misses = in_range && outside, meets = in_range && inside && certain;
  return RoundedParallelogramEquation<std::remove_const_t<decltype(slope)>,
                                      std::remove_const_t<decltype(misses)>>{height, slope, misses, meets};
}

}  // namespace detail

/// The root, certified.
[[nodiscard, gnu::always_inline]] inline Roots parallelogram_roots(const Point& origin, const Vec3& direction,
                                                                   const Point& position, const Vec3& edge_u,
                                                                   const Vec3& edge_v) {
  const auto e = detail::rounded_parallelogram_equation(origin, direction, position, edge_u, edge_v);
  if (e.misses) return {};
  if (e.meets) return Roots{e.height / e.slope};
  return detail::parallelogram_roots_in_doubt(origin, direction, position, edge_u, edge_v);
}

/// The roots of several lines at once; see sphere_roots_of_each.
[[nodiscard, gnu::always_inline]] inline auto parallelogram_roots_of_each(
    const auto& origin, const auto& direction, const Point& position, const Vec3& edge_u, const Vec3& edge_v,
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
  const auto e = detail::rounded_parallelogram_equation(origin, direction, position, edge_u, edge_v);
  const T height = e.height;
  return RootsOfEach<T, M>{.near_over = height,
                           .near_under = e.slope,
                           .far_over = height,
                           .far_under = e.slope,
                           .meets = wanted && e.meets,
                           .in_doubt = wanted && !e.misses && !e.meets,
                           .count = 1};
}

}  // namespace protostar::inline PROTOSTAR_ABI

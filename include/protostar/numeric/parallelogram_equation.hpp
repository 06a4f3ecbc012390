// Crossings of a line with a parallelogram: their existence is exact, and t is certified (Roots).
//
// With w = position − origin, a point origin + t·d of the line is the point position + a·u + b·v of the plane
// if t·d = w + a·u + b·v. By Cramer's rule, with S = (u × v)·d and m = w × d, this holds for
//   t = (u × v)·w / S,   a = v·m / S,   b = −u·m / S,
// and the point is in the parallelogram for 0 ≤ a ≤ 1 and 0 ≤ b ≤ 1. Double nearly always decides; if its
// error bound does not allow it, everything is evaluated without rounding. docs/derivations.md derives the
// bounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "../vec3.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the equation in numbers of type T: t·d = w + weight · (a·u + b·v) with w = weight · position −
/// origin.
template <class T>
[[nodiscard]] LinearEquation<T> parallelogram_equation(const LineOf<T>& line, const Point& position,
                                                       const Vec3& edge_u, const Vec3& edge_v) {
  const VectorOf<T> u = vector_of<T>(edge_u), v = vector_of<T>(edge_v), n = cross(u, v),
                    w = line.weight * given<T>(position) - line.origin, m = cross(w, line.direction);
  LinearEquation<T> e{.height = dot(n, w), .slope = dot(n, line.direction), .is_on_surface = std::nullopt};
  const auto slope = sign_of(e.slope);
  if (!slope) return e;
  // a, b and their upper limit 1, times |S| · weight.
  const Given<T> sign(*slope);
  const T along_u = sign * dot(v, m), along_v = -sign * dot(u, m), end = sign * line.weight * e.slope;
  bool is_decided = true;
  for (const T& distance_to_edge : {along_u, along_v, end - along_u, end - along_v}) {
    const auto inside = sign_of(distance_to_edge);
    if (inside && *inside < 0) {
      e.is_on_surface = false;
      return e;
    }
    is_decided = is_decided && inside;
  }
  if (is_decided) e.is_on_surface = true;
  return e;
}

/// Returns the equation in double, of one or more lines. With u = 2^-53, and U, V, W, D the sums of the
/// magnitudes of the components of u, v, w and d:
///
/// - height and slope have errors of at most 6u and 5u of the sums of the magnitudes of their terms. Above
///   2^-19 of these sums, t is accurate to 2^-30.
/// - v·m and u·m have errors of at most 6u V W D and 6u U W D, and S of 5u U V D. Comparing a, b and 1, times
///   S, has an error of at most 7u D (U V + max(U, V) W); E is 8u of it. If even the sign of S is in doubt,
///   |S| is so small that a line found to be outside misses with either sign.
///
/// In the given range, underflow is negligible and nothing overflows.
[[nodiscard, gnu::always_inline]] inline auto parallelogram_equation(const auto& origin,
                                                                     const auto& direction,
                                                                     const Point& position,
                                                                     const Vec3& edge_u, const Vec3& edge_v) {
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
  const Vec3 terms{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};  // terms of n
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
  return RoundedLinear{height, slope, misses, meets, meets};
}

}  // namespace protostar::inline PROTOSTAR_ABI

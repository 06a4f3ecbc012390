// Where a line crosses a plane, as certain as Roots says.
//
// A point origin + t·d of the line is on the plane normal · x = distance for t = (distance − normal·origin) /
// normal·d. Double decides nearly always; where its error bound does not allow that, both parts are evaluated
// without rounding.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "../vec3.hpp"
#include "exact_root.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The root of finite numbers without rounding: A > 0, or A = 0 where the line is parallel to the plane.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_plane_root(const Point& origin,
                                                                          const Vec3& direction,
                                                                          const Vec3& normal,
                                                                          double distance) {
  // Powers of two, as for the sphere; the distance is a product of a normal and a length.
  const int normals = exponent_of({normal}), directions = exponent_of({direction});
  const int lengths = std::max(exponent_of({origin}), exponent_of({Vec3{distance}}) - normals);
  const Vec3 n = scaled(normal, -normals), d = scaled(direction, -directions), o = scaled(origin, -lengths);
  const auto exact_dot = [](const Vec3& v, const Vec3& w) {
    return Expansion(v.x) * Expansion(w.x) + Expansion(v.y) * Expansion(w.y) +
           Expansion(v.z) * Expansion(w.z);
  };
  const Expansion height = Expansion(std::ldexp(distance, -normals - lengths)) - exact_dot(n, o);
  const Expansion slope = exact_dot(n, d);
  const bool negative = slope.sign() < 0;
  return {.A = negative ? -slope : slope,
          .b = negative ? -height : height,
          .D = {},
          .exponent = lengths - directions};
}

/// The same in double-double; none where the line is parallel to the plane.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_plane_roots(const Point& origin,
                                                                                const Vec3& direction,
                                                                                const Vec3& normal,
                                                                                double distance) {
  ++fallbacks.exact;
  return refined_linear_root(exact_plane_root(origin, direction, normal, distance));
}

namespace detail {

/// The root where double does not decide. Numbers that are not finite cross nothing.
[[nodiscard, gnu::noinline, gnu::cold]] inline Roots plane_roots_in_doubt(const Point& origin,
                                                                          const Vec3& direction,
                                                                          const Vec3& normal,
                                                                          double distance) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(normal) || !std::isfinite(distance))
    return {};
  const RefinedRoots refined = refined_plane_roots(origin, direction, normal, distance);
  return refined.count == 0 ? Roots{} : Roots{static_cast<double>(refined.t[0])};
}

}  // namespace detail

namespace detail {

/// Both parts of the quotient in double, and whether each is good enough.
///
/// Their errors are at most 4u and 3u (u = 2^-53) of the sums of the sizes of their terms. Above 2^-19 of
/// these sums, each part is good to 2^-32; in the range given, underflow adds nothing to speak of.
template <class H, class S, class M>
struct RoundedPlaneEquation {
  H height;
  S slope;
  M certain;
};

[[nodiscard, gnu::always_inline]] inline auto rounded_plane_equation(const auto& origin,
                                                                     const auto& direction,
                                                                     const Vec3& normal, double distance) {
  using std::abs;
  const auto height = distance - dot(normal, origin);
  const auto slope = dot(normal, direction);
  const auto heights = std::abs(distance) + dot(abs(normal), abs(origin));
  const auto slopes = dot(abs(normal), abs(direction));
  const auto certain = abs(height) > 0x1p-19 * heights && abs(slope) > 0x1p-19 * slopes &&
                       0x1p-900 < heights && heights < 0x1p900 && 0x1p-900 < slopes && slopes < 0x1p900;
  return RoundedPlaneEquation<std::remove_const_t<decltype(height)>, std::remove_const_t<decltype(slope)>,
                              std::remove_const_t<decltype(certain)>>{height, slope, certain};
}

}  // namespace detail

/// The root, certified.
[[nodiscard, gnu::always_inline]] inline Roots plane_roots(const Point& origin, const Vec3& direction,
                                                           const Vec3& normal, double distance) {
  const auto [height, slope, certain] = detail::rounded_plane_equation(origin, direction, normal, distance);
  if (certain) return Roots{height / slope};
  return detail::plane_roots_in_doubt(origin, direction, normal, distance);
}

/// The roots of several lines at once; see sphere_roots_of_each.
[[nodiscard, gnu::always_inline]] inline auto plane_roots_of_each(const auto& origin, const auto& direction,
                                                                  const Vec3& normal, double distance,
                                                                  const auto& wanted) {
  using M = std::remove_cvref_t<decltype(wanted)>;
  const auto [height, slope, certain] = detail::rounded_plane_equation(origin, direction, normal, distance);
  using T = std::remove_cvref_t<decltype(slope)>;
  return RootsOfEach<T, M>{.near_over = height,
                           .near_under = slope,
                           .far_over = height,
                           .far_under = slope,
                           .meets = wanted && certain,
                           .in_doubt = wanted && !certain,
                           .count = 1};
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Crossings of several lines with a sphere at once, as far as double decides them (sphere_roots.hpp).
#pragma once

#include <cmath>
#include <type_traits>

#include "../interval.hpp"
#include "../vec3.hpp"
#include "roots.hpp"
#include "sphere_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the first root in t > 0 of several lines at once, for the active lanes (active). If they start at
/// one point outside the sphere, as camera rays mostly do, it is c/q for all of them.
[[nodiscard, gnu::always_inline]] inline auto first_sphere_root_of_each(const auto& origin,
                                                                        const auto& direction,
                                                                        const Point& center, double radius,
                                                                        const auto& active) {
  using std::sqrt;
  const auto e = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using T = std::remove_const_t<decltype(e.b)>;
  using M = std::remove_cvref_t<decltype(active)>;
  FirstRootOfEach<T, M> first{.t = infinity, .is_there = false, .in_doubt = false};
  const M open = active && !e.surely_misses();
  if (!any(open)) return first;
  const auto find = [&](const T& t, const M& certain, const M& recedes) {
    first.t = t;
    first.is_there = open && certain && !recedes && t > 0.0 && t < infinity;
    first.in_doubt = open && !certain && !(recedes && e.D > 4 * e.E);
  };
  const auto is_outside = e.c > 0x1p-18 * e.w;
  if constexpr (std::is_same_v<decltype(is_outside), const bool>)
    if (is_outside) {
      const T root = sqrt(e.D), q = e.b + root;
      find(e.c / q, root * q > 0x1p31 * e.E && e.b >= 0.0, e.b < 0.0);
      return first;
    }
  const auto [q, certain] = detail::certified_quotient(e);
  const M is_far = M(!is_outside) && q >= 0.0;
  find(select(is_far, q, T(e.c)) / select(is_far, e.A, q), certain, is_outside && q < 0.0);
  return first;
}

/// Returns the roots of several lines at once, in the order near, far, for the active lanes (active). If
/// double decides, the numbers are the same as from sphere_roots. Directions are vectors of lanes; the origin
/// is one point, or one in each lane.
[[nodiscard, gnu::always_inline]] inline auto sphere_roots_of_each(const auto& origin, const auto& direction,
                                                                   const Point& center, double radius,
                                                                   const auto& active) {
  const auto equation = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using T = std::remove_const_t<decltype(equation.A)>;
  using M = std::remove_cvref_t<decltype(active)>;
  const M open = active && !equation.surely_misses();
  const T A = equation.A, c(equation.c);
  if (!any(open))
    return RootsOfEach<T, M>{.near_over = c,
                             .near_under = c,
                             .far_over = c,
                             .far_under = c,
                             .meets = open,
                             .in_doubt = open,
                             .count = 2};
  const auto [q, certain] = detail::certified_quotient(equation);
  const M meets = open && certain;
  // b and q have the same sign. Certified roots are so far apart that rounding does not change their order.
  const auto backwards = q < 0.0;
  return RootsOfEach<T, M>{.near_over = select(backwards, q, c),
                           .near_under = select(backwards, A, q),
                           .far_over = select(backwards, c, q),
                           .far_under = select(backwards, q, A),
                           .meets = meets,
                           .in_doubt = open && !meets,
                           .count = 2};
}

/// Returns which of several lines certainly cross the sphere in t > 0, by signs alone, without computing a
/// root.
[[nodiscard, gnu::always_inline]] inline auto sphere_crossed_by_each(const auto& origin,
                                                                     const auto& direction,
                                                                     const Point& center, double radius,
                                                                     const auto& active) {
  const auto equation = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using M = std::remove_cvref_t<decltype(active)>;
  const M open = active && !equation.surely_misses();
  const M sure = open && equation.surely_meets();
  return CrossedByEach<M>{.crossed = sure && (equation.b > 0.0 || equation.c < 0.0),
                          .in_doubt = open && !sure};
}

/// Returns which of several lines certainly cross the sphere in 0 < t < 1, by signs alone, without computing
/// a root.
///
/// At t = 1 the equation has the value f = A − 2b + c, and half its slope is A − b. The errors of A, b, c are
/// at most 3u A, 4u √(A w) ≤ 2u (A + w) and 7u w, those of the two operations at most 4u (A + w) together, so
/// f and A − b are accurate to 15u (A + w) < 2^-49 (A + w). A line that meets the sphere is inside it between
/// its roots: from outside, it gets there if it ends inside, or else if its nearest point to the center comes
/// before its end.
[[nodiscard, gnu::always_inline]] inline auto sphere_crossed_by_segments(const auto& origin,
                                                                         const auto& direction,
                                                                         const Point& center, double radius,
                                                                         const auto& active) {
  const auto e = detail::rounded_sphere_equation(SphereLine(origin, direction), center, radius);
  using M = std::remove_cvref_t<decltype(active)>;
  const M open = active && !e.surely_misses();
  if (!any(open)) return CrossedByEach<M>{.crossed = open, .in_doubt = open};
  const auto f = e.A - 2 * e.b + e.c, slope = e.A - e.b, error = 0x1p-49 * (e.A + e.w);
  const auto starts_outside = e.c > 0.0;
  const auto ends_outside = f > error, ends_inside = f < -error;
  const auto approaches = e.b > 0.0, recedes = slope > error;
  const M sure =
      open && e.surely_meets() &&
      (ends_inside || (ends_outside && (!starts_outside || !approaches || recedes || slope < -error)));
  const M crossed = sure && ((starts_outside && approaches && (ends_inside || recedes)) ||
                             (!starts_outside && ends_outside));
  return CrossedByEach<M>{.crossed = crossed, .in_doubt = open && !sure};
}

/// Returns the roots other than t = 0 of several lines that start on the sphere, for the active lanes
/// (active); see sphere_roots_of_each.
[[nodiscard, gnu::always_inline]] inline auto sphere_root_leaving_of_each(const auto& origin,
                                                                          const auto& direction,
                                                                          const Point& center, double radius,
                                                                          const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  using T = std::remove_cvref_t<decltype(b)>;
  const T over = 2 * b;
  return RootsOfEach<T, M>{.near_over = over,
                           .near_under = A,
                           .far_over = over,
                           .far_under = A,
                           .meets = active && certain,
                           .in_doubt = active && !certain,
                           .count = 1};
}

/// Returns which of several lines that start on the sphere certainly cross it in t > 0, or in 0 < t < 1: the
/// root 2b/A has the sign of b, and is below 1 if 2b < A. Both are accurate to 2^-31 of themselves.
[[nodiscard, gnu::always_inline]] inline auto left_sphere_crossed_by_each(const auto& origin,
                                                                          const auto& direction,
                                                                          const Point& center, double radius,
                                                                          const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  return CrossedByEach<M>{.crossed = active && certain && b > 0.0, .in_doubt = active && !certain};
}
[[nodiscard, gnu::always_inline]] inline auto left_sphere_crossed_by_segments(
    const auto& origin, const auto& direction, const Point& center, double radius, const auto& active) {
  using M = std::remove_cvref_t<decltype(active)>;
  const auto [A, b, certain] = detail::rounded_leaving_equation(origin, direction, center, radius);
  const auto over = 2 * b;
  const auto before_end = over < (1 - 0x1p-29) * A;
  const auto behind_end = over > (1 + 0x1p-29) * A;
  const M sure = active && certain && (b < 0.0 || before_end || behind_end);
  return CrossedByEach<M>{.crossed = sure && b > 0.0 && before_end, .in_doubt = active && !sure};
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Roots of rays and a surface, derived from the surface's equation.
//
// A surface writes its equation twice: equation(rays) in double with bounds of its errors, for one ray or for
// several in lanes, or for a RoundedLine, whose errors count (numeric/rounded_equation.hpp); and
// equation(line) without rounding, for an ExactLine (numeric/equation.hpp). is_left_by(rays) tells if these
// depart from the surface, and the root 0 does not count. Double nearly always decides; a ray in doubt is
// decided without rounding.
#pragma once

#include "numeric/rounded_equation.hpp"
#include "ray.hpp"
#include "transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// True if the equation of a surface is quadratic: a ray that leaves it may cross it once more.
template <class S>
inline constexpr bool is_quadratic = requires(const S& surface, const ExactLine& line) {
  surface.equation(line).without_root_at_0();
};

/// Calls answer(e) with the equation e of a line, or of lines, and a surface, and returns its result. If the
/// rays on them depart from the surface, e lacks the root 0: a quadratic equation becomes linear, and a
/// linear one surely misses.
[[nodiscard, gnu::always_inline]] inline auto by_equation(const auto& surface, const auto& rays,
                                                          const auto& line, const auto& answer) {
  using Equation = decltype(surface.equation(line));
  if (rays.departure.kind == Departure::Kind::none || !surface.is_left_by(rays))
    return answer(surface.equation(line));
  if constexpr (requires(const Equation& e) { e.without_root_at_0(); })
    return answer(surface.equation(line).without_root_at_0());
  else
    return answer(
        Equation{.height = 0.0, .slope = 1.0, .misses = true, .crosses = false, .is_certain = false});
}

/// Returns the certified roots of a ray that double leaves in doubt: by the surface's refined_roots(ray), in
/// double-double, if it has such a function and that decides; otherwise without rounding, which
/// fallbacks.exact counts. There are none if the direction is 0, or if a number of the ray or of the surface
/// is not finite, which a surface may tell by has_finite_numbers().
template <class S>
[[nodiscard, gnu::noinline, gnu::cold]] Roots roots_in_doubt(const S& surface, const Ray& ray) {
  if (!is_proper(ray)) return {};
  if constexpr (requires { surface.has_finite_numbers(); })
    if (!surface.has_finite_numbers()) return {};
  [[maybe_unused]] const bool leaves = surface.is_left_by(ray);
  if constexpr (requires { surface.refined_roots(ray); })
    if (!leaves && ray.transform == nullptr)
      if (const auto roots = surface.refined_roots(ray)) return *roots;
  ++fallbacks.exact;
  const auto exact = surface.equation(exact_line(ray));
  if constexpr (is_quadratic<S>) {
    return leaves ? roots_of(exact.without_root_at_0()) : roots_of(exact);
  } else {
    // Existence may be in doubt where t is not.
    const auto e = surface.equation(rounded_line(ray));
    return e.is_certain && exact.is_on_surface ? Roots{e.height / e.slope} : roots_of(exact);
  }
}

}  // namespace detail

/// Returns the roots of the active ones of several rays in lanes, or of one ray, as far as double tells.
[[nodiscard, gnu::always_inline]] inline auto roots_of_each(const auto& surface, const auto& rays,
                                                            const auto& active) {
  return detail::by_equation(surface, rays, rays, [&](const auto& e) { return roots_of_each(e, active); });
}

/// Returns the first root in t > 0 of the active ones of several rays in lanes, or of one ray, as far as
/// double tells. Precondition: ray.transform is null.
[[nodiscard, gnu::always_inline]] inline auto first_root_of_each(const auto& surface, const auto& rays,
                                                                 const auto& active) {
  return detail::by_equation(surface, rays, rays,
                             [&](const auto& e) { return first_root_of_each(e, active); });
}

/// Returns which of the active ones of several rays in lanes, or of one ray, cross the surface in 0 < t < 1
/// if they are segments, else in t > 0, as far as double tells. Precondition: ray.transform is null.
[[nodiscard, gnu::always_inline]] inline auto crossed_by_each(const auto& surface, const auto& rays,
                                                              const auto& active, bool are_segments) {
  return detail::by_equation(surface, rays, rays,
                             [&](const auto& e) { return crossed_by_each(e, active, are_segments); });
}

/// Returns the certified roots of a ray's line, without the root 0 if the ray departs from the surface.
template <class S>
[[nodiscard, gnu::always_inline]] inline Roots certified_roots(const S& surface, const Ray& ray) {
  return with_line(ray, [&](const auto& line) {
    return detail::by_equation(surface, ray, line, [&](const auto& e) {
      return roots_of(e, [&] { return detail::roots_in_doubt(surface, ray); });
    });
  });
}

/// Returns a root of a ray's line without rounding, by its index among the certified roots.
template <class S>
[[nodiscard, gnu::noinline, gnu::cold]] ExactRoot exact_root_of(const S& surface, const Ray& ray, int root) {
  const auto exact = surface.equation(exact_line(ray));
  if constexpr (detail::is_quadratic<S>)
    if (surface.is_left_by(ray)) return exact_root_of(exact.without_root_at_0());
  return exact_root_of(exact, root);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Roots of rays and a surface, derived from the surface's equation.
//
// A surface writes its equation twice: equation(rays) in double with bounds of its errors, for one ray or for
// several in lanes (numeric/rounded_equation.hpp), and exact(line) in numbers of any type
// (numeric/equation.hpp). is_left_by(rays) tells if these depart from the surface, and the root 0 does not
// count. Double nearly always decides; a ray in doubt is decided without rounding.
#pragma once

#include "numeric/rounded_equation.hpp"
#include "ray.hpp"
#include "transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// True if the equation of a surface is quadratic: a ray that leaves it may cross it once more.
template <class S>
inline constexpr bool is_quadratic = requires(const S& surface, const ExactLine& line) {
  surface.exact(line).without_root_at_0();
};

/// Calls answer(e) with the equation e of rays and a surface, and returns its result. If the rays depart from
/// the surface, e lacks the root 0: a quadratic equation becomes linear, and a linear one surely misses.
[[nodiscard, gnu::always_inline]] inline auto by_equation(const auto& surface, const auto& rays,
                                                          const auto& answer) {
  using Equation = decltype(surface.equation(rays));
  if (rays.departure.kind == Departure::Kind::none || !surface.is_left_by(rays))
    return answer(surface.equation(rays));
  if constexpr (requires(const Equation& e) { e.without_root_at_0(); })
    return answer(surface.equation(rays).without_root_at_0());
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
    if (!leaves)
      if (const auto roots = surface.refined_roots(ray)) return *roots;
  ++fallbacks.exact;
  const auto exact = surface.exact(line_of<ExactNumber>(ray));
  if constexpr (is_quadratic<S>) {
    return leaves ? roots_of(exact.without_root_at_0()) : roots_of(exact);
  } else {
    // Existence may be in doubt where t is not.
    const auto e = surface.equation(ray);
    return e.is_certain && exact.is_on_surface == true ? Roots{e.height / e.slope} : roots_of(exact);
  }
}

/// Returns the certified roots of a ray that an instance has mapped into its space, and whose numbers are
/// rounded: by the surface's rounded_equation(line), in double with larger bounds, if it has such a function
/// and that decides; otherwise without rounding.
template <class S>
[[nodiscard, gnu::noinline]] Roots transformed_roots(const S& surface, const Ray& ray) {
  if (surface.is_left_by(ray)) {
    if constexpr (is_quadratic<S>)
      return roots_along(ray, [&](const auto& line) { return surface.exact(line).without_root_at_0(); });
    else
      return {};
  }
  const auto in_doubt = [&] {
    return roots_along(ray, [&](const auto& line) { return surface.exact(line); });
  };
  if constexpr (requires { surface.rounded_equation(rounded_line(ray)); })
    return roots_of(surface.rounded_equation(rounded_line(ray)), in_doubt);
  else
    return in_doubt();
}

}  // namespace detail

/// Returns the roots of the active ones of several rays in lanes, or of one ray, as far as double tells.
[[nodiscard, gnu::always_inline]] inline auto roots_of_each(const auto& surface, const auto& rays,
                                                            const auto& active) {
  return detail::by_equation(surface, rays, [&](const auto& e) { return roots_of_each(e, active); });
}

/// Returns the first root in t > 0 of the active ones of several rays in lanes, or of one ray, as far as
/// double tells. No instance may have mapped the rays.
[[nodiscard, gnu::always_inline]] inline auto first_root_of_each(const auto& surface, const auto& rays,
                                                                 const auto& active) {
  return detail::by_equation(surface, rays, [&](const auto& e) { return first_root_of_each(e, active); });
}

/// Returns which of the active ones of several rays in lanes, or of one ray, cross the surface in 0 < t < 1
/// if they are segments, else in t > 0, as far as double tells. No instance may have mapped the rays.
[[nodiscard, gnu::always_inline]] inline auto crossed_by_each(const auto& surface, const auto& rays,
                                                              const auto& active, bool are_segments) {
  return detail::by_equation(surface, rays,
                             [&](const auto& e) { return crossed_by_each(e, active, are_segments); });
}

/// Returns the certified roots of a ray's line: all crossings, or if the ray departs from the surface, those
/// that it does not come from.
template <class S>
[[nodiscard, gnu::always_inline]] inline Roots certified_roots(const S& surface, const Ray& ray) {
  if (ray.transform != nullptr) return detail::transformed_roots(surface, ray);
  return detail::by_equation(surface, ray, [&](const auto& e) {
    return roots_of(e, [&] { return detail::roots_in_doubt(surface, ray); });
  });
}

/// Returns a root of a ray's line without rounding, by its index among the certified roots.
template <class S>
[[nodiscard, gnu::noinline, gnu::cold]] ExactRoot exact_root_of(const S& surface, const Ray& ray, int root) {
  const auto exact = surface.exact(line_of<ExactNumber>(ray));
  if constexpr (detail::is_quadratic<S>)
    if (surface.is_left_by(ray)) return exact_root_of(exact.without_root_at_0());
  return exact_root_of(exact, root);
}

}  // namespace protostar::inline PROTOSTAR_ABI

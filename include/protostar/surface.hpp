// Functions that intersect rays with a surface of any type, and tell what is known at a hit.
//
// A SurfaceWithEquation has equation(line) for several kinds of line: rays in double, one or several in
// lanes, or a RoundedLine, with bounds of the errors (numeric/rounded_equation.hpp), and an ExactLine,
// without rounding (numeric/equation.hpp). is_left_by(rays) tells if rays depart from the surface; then the
// root 0 does not count. Double nearly always decides; a ray in doubt is decided without rounding.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "intersection.hpp"
#include "interval.hpp"
#include "numeric/roots.hpp"
#include "numeric/rounded_equation.hpp"
#include "own_intersect.hpp"
#include "ray.hpp"
#include "surface_concepts.hpp"
#include "transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the unit normal at a point of a surface, or of a primitive of it.
template <Surface S>
[[nodiscard]] Vec3 normal_at(const S& surface, const Point& point, int primitive) {
  if constexpr (is_made_of_primitives<S>)
    return surface.normal_at(point, primitive);
  else
    return surface.normal_at(point);
}

/// Returns the coordinates of a point of a surface, or of a primitive of it; 0 and 0 if it has none.
template <Surface S>
[[nodiscard]] Uv uv_at(const S& surface, const Point& point, int primitive) {
  if constexpr (knows_uv<S> && is_made_of_primitives<S>)
    return surface.uv_at(point, primitive);
  else if constexpr (knows_uv<S>)
    return surface.uv_at(point);
  else
    return Uv{0};
}

/// Returns the directions of the coordinates at a point of a surface, or of a primitive of it; 0 and 0 if it
/// does not know them.
template <Surface S>
[[nodiscard]] Tangents tangents_at(const S& surface, const Point& point, int primitive) {
  if constexpr (knows_tangents<S> && is_made_of_primitives<S>)
    return surface.tangents_at(point, primitive);
  else if constexpr (knows_tangents<S>)
    return surface.tangents_at(point);
  else
    return {};
}

/// Returns the departure of a ray that leaves a surface, or a primitive of it: the surface's own departure,
/// or else the object itself. It names the surface.
template <Surface S>
[[nodiscard]] Departure departure_of(const S& surface, int primitive = 0) {
  Departure departure = [&]() -> Departure {  // built in its place
    if constexpr (is_made_of_primitives<S>) return surface.departure(primitive);
    if constexpr (knows_departure<S> && !is_made_of_primitives<S>) return surface.departure();
    return {.kind = Departure::Kind::object, .object = &surface};
  }();
  departure.surface = &surface;
  return departure;
}

namespace detail {

/// Returns true if rays depart from the surface, so that their root at 0 is no crossing.
[[nodiscard, gnu::always_inline]] inline bool departs_from(const auto& surface, const auto& rays) {
  return rays.departure.kind != Departure::Kind::none && surface.is_left_by(rays);
}

/// Returns the equation of a surface, along lines that depart from it, without their root at 0: a quadratic
/// equation becomes linear, and a linear one surely misses.
[[nodiscard, gnu::always_inline]] inline auto equation_of_departing(const auto& surface, const auto& lines) {
  using Equation = decltype(surface.equation(lines));
  if constexpr (requires(const Equation& e) { e.without_root_at_0(); })
    return surface.equation(lines).without_root_at_0();
  else
    return Equation{.height = 0.0, .slope = 1.0, .misses = true, .crosses = false, .is_certain = false};
}

/// Returns the certified roots of a ray that double leaves in doubt: by the surface's refined_roots(ray), in
/// double-double, if it has such a function and that decides; otherwise without rounding, which
/// fallbacks.exact counts. There are none if the direction is 0, or if a number of the ray or of the surface
/// is not finite, which a surface may tell by has_finite_numbers().
template <class S>
[[nodiscard, gnu::noinline, gnu::cold]] Roots roots_with_more_digits(const S& surface, const Ray& ray) {
  if (!is_proper(ray)) return {};
  if constexpr (requires { surface.has_finite_numbers(); })
    if (!surface.has_finite_numbers()) return {};
  [[maybe_unused]] const bool leaves = surface.is_left_by(ray);
  if constexpr (requires { surface.refined_roots(ray); })
    if (!leaves && ray.transform == nullptr)
      if (const auto roots = surface.refined_roots(ray)) {
        ++fallbacks.double_double;
        return *roots;
      }
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

/// Returns the roots of the active ones of several rays in lanes, or of one ray, as far as double tells. Rays
/// in doubt have in_doubt set. Precondition: no ray has a transform, whose errors would be ignored.
[[nodiscard, gnu::always_inline]] inline auto roots_of_each(const auto& surface, const auto& rays,
                                                            const auto& active) {
  if (detail::departs_from(surface, rays))
    return roots_of_each(detail::equation_of_departing(surface, rays), active);
  return roots_of_each(surface.equation(rays), active);
}

/// Returns the first root in t > 0 of the active ones of several rays in lanes, or of one ray, as far as
/// double tells. Precondition: ray.transform is null.
[[nodiscard, gnu::always_inline]] inline auto first_root_of_each(const auto& surface, const auto& rays,
                                                                 const auto& active) {
  if (detail::departs_from(surface, rays))
    return first_root_of_each(detail::equation_of_departing(surface, rays), active);
  return first_root_of_each(surface.equation(rays), active);
}

/// Returns which of the active ones of several rays in lanes, or of one ray, cross the surface in 0 < t < 1
/// if they are segments, else in t > 0, as far as double tells. Precondition: ray.transform is null.
[[nodiscard, gnu::always_inline]] inline auto crossed_by_each(const auto& surface, const auto& rays,
                                                              const auto& active, bool are_segments) {
  if (detail::departs_from(surface, rays))
    return crossed_by_each(detail::equation_of_departing(surface, rays), active, are_segments);
  return crossed_by_each(surface.equation(rays), active, are_segments);
}

/// Returns the certified roots of a ray's line, without the root 0 if the ray departs from the surface.
template <class S>
[[nodiscard, gnu::always_inline]] inline Roots certified_roots(const S& surface, const Ray& ray) {
  return with_line(ray, [&](const auto& line) {
    const auto in_doubt = [&] { return detail::roots_with_more_digits(surface, ray); };
    if (detail::departs_from(surface, ray))
      return roots_of(detail::equation_of_departing(surface, line), in_doubt);
    return roots_of(surface.equation(line), in_doubt);
  });
}

/// Returns a root of a ray's line without rounding, by its index among the certified roots.
template <class S>
[[nodiscard, gnu::noinline, gnu::cold]] ExactRoot exact_root_of(const S& surface, const Ray& ray, int root) {
  const auto exact = surface.equation(exact_line(ray));
  if constexpr (is_quadratic<S>)
    if (surface.is_left_by(ray)) return exact_root_of(exact.without_root_at_0());
  return exact_root_of(exact, root);
}

/// Returns the root of a crossing without rounding. If the surface knows no more than t, t is taken as exact.
template <Surface S>
[[nodiscard]] ExactRoot exact_root(const S& surface, const Ray& ray, const Crossing& crossing) {
  if constexpr (CompositeSurface<S>)
    return surface.exact_root(ray, crossing);
  else if constexpr (SurfaceWithEquation<S>)
    return exact_root_of(surface, ray, crossing.root);
  else
    return exact_root_of(crossing.t);
}

namespace detail {

/// Returns lies_inside for a t whose error reaches an end of the range.
template <Surface S>
[[nodiscard, gnu::noinline, gnu::cold]] bool lies_inside_refined(const S& surface, Ray ray, Crossing crossing,
                                                                 Interval range) {
  const auto side_of = [&](double end) {  // -1 before an end, 0 at it, 1 behind it
    return order(exact_root(surface, ray, crossing), exact_root_of(end));
  };
  return std::isfinite(crossing.t) && (range.min == -infinity || side_of(range.min) > 0) &&
         (range.max == infinity || side_of(range.max) < 0);
}

}  // namespace detail

/// Returns true if a crossing lies inside an open range, decided by t if its error allows, otherwise exactly.
template <Surface S>
[[nodiscard]] bool lies_inside(const S& surface, const Ray& ray, const Crossing& crossing, Interval range) {
  const double t = crossing.t, margin = 2 * Roots::relative_error * std::abs(t);
  if (range.min < t - margin && t + margin < range.max) return true;
  if (!(range.min < t + margin && t - margin < range.max)) return false;
  return detail::lies_inside_refined(surface, ray, crossing, range);
}

/// Returns the range without the crossing at which a ray starts on a surface that has no departure(); takes
/// up to three calls of intersect. Meant for range.min ≥ 0: a negative min is kept, or raised above all
/// crossings behind.
///
/// The crossing at t = 0 is computed and comes out as a little more or less. The line's crossing nearest to
/// the origin is taken for it: one that lies ahead is cut off, one behind or at the origin is outside a
/// forward ray as it is. This fails if the surface has another crossing so near that the error of t reaches
/// it: along a ray that leaves at a grazing angle, or at a sharp edge. A surface that knows its roots should
/// offer roots() and departure().
template <Surface S>
[[nodiscard]] Interval beyond_departure(const S& surface, const Ray& ray, Interval range) {
  constexpr double tiny =
      std::numeric_limits<double>::denorm_min();  // the open interval (-tiny, tiny) holds 0 alone
  if (detail::own_intersect(surface, ray, Interval{-tiny, tiny})) return range;
  const auto ahead = detail::own_intersect(surface, ray, Interval{});
  if (!ahead) return range;
  const Ray back{.origin = ray.origin, .direction = -ray.direction, .time = ray.time};
  const auto behind = detail::own_intersect(surface, back, Interval{});
  if (!(behind && *behind < *ahead) && range.min < *ahead) range.min = *ahead;
  return range;
}

/// Returns the range in which to intersect a surface: shortened if the ray departs from this surface, which
/// takes no account of departures itself.
template <Surface S>
[[nodiscard]] Interval range_for(const S& surface, const Ray& ray, Interval range) {
  if constexpr (!knows_departure<S>)
    if (ray.departure.is_from(&surface)) return beyond_departure(surface, ray, range);
  return range;
}

/// Returns all roots of a ray's line: those of a surface's own function, or those of its equation.
template <Surface S>
[[nodiscard]] Roots roots_of(const S& surface, const Ray& ray) {
  if constexpr (SurfaceWithRoots<S>)
    return surface.roots(ray);
  else
    return certified_roots(surface, ray);
}

/// Returns the first of the crossings that a composite surface visits, for one that finds all at once.
[[nodiscard]] std::optional<Crossing> first_of_all(const auto& surface, const Ray& ray, Interval range) {
  std::optional<Crossing> first;
  surface.each_crossing(ray, range, [&](const Crossing& crossing) {
    if (!first) first = crossing;
  });
  return first;
}

/// Returns the first crossing of a ray with a surface inside a range, if there is one.
template <Surface S>
[[nodiscard]] std::optional<Crossing> first_crossing(const S& surface, const Ray& ray, Interval range) {
  range = range_for(surface, ray, range);
  if constexpr (CompositeSurface<S>) {
    return surface.first_crossing(ray, range);
  } else if constexpr (SurfaceWithRoots<S> || SurfaceWithEquation<S>) {
    if constexpr (!SurfaceWithRoots<S>)
      if (range.min == 0 && ray.transform == nullptr)
        if (const auto first = first_root_of_each(surface, ray, true); !first.in_doubt) {
          const Crossing crossing{first.t, first.is_far};
          return first.is_there && lies_inside(surface, ray, crossing, range) ? std::optional(crossing)
                                                                              : std::nullopt;
        }
    const Roots roots = roots_of(surface, ray);
    for (int i = 0; i < roots.count(); ++i)
      if (const Crossing crossing{roots[i], i}; lies_inside(surface, ray, crossing, range)) return crossing;
    return std::nullopt;
  } else {
    const auto t = detail::own_intersect(surface, ray, range);
    return t ? std::optional(Crossing{*t}) : std::nullopt;
  }
}

/// Returns true if a ray departs from a surface and does not hit it again in t > 0, as is known without its
/// roots: a plane, or a sphere that the ray leaves outward. False means unknown, and is returned whenever
/// range.min < 0.
template <Surface S>
[[nodiscard]] bool leaves_for_good([[maybe_unused]] const S& surface, const Ray& ray, Interval range) {
  if constexpr (SurfaceWithEquation<S> && !SurfaceWithRoots<S> && !CompositeSurface<S>)
    return range.min >= 0 && surface.is_left_by(ray) && (!is_quadratic<S> || leaves_outward(ray));
  else
    return false;
}

/// Returns t of the first crossing of a ray with a surface inside a range, if there is one.
template <Surface S>
[[nodiscard]] std::optional<double> first_t(const S& surface, const Ray& ray, Interval range) {
  const auto crossing = first_crossing(surface, ray, range);
  return crossing ? std::optional(crossing->t) : std::nullopt;
}

/// Returns true if a ray has any hit on a surface inside a range. A surface made of many primitives may know
/// that sooner than its closest hit, and offers any_hit(ray, range). Its any_hit gets the range unchanged: it
/// must itself ignore the crossing at t = 0 of a ray that departs from the surface.
template <Surface S>
[[nodiscard]] bool any_hit(const S& surface, const Ray& ray, Interval range) {
  if constexpr (requires { surface.any_hit(ray, range); }) {
    return surface.any_hit(ray, range);
  } else {
    if constexpr (SurfaceWithEquation<S> && !SurfaceWithRoots<S>)
      if (range.min == 0 && (range.max == 1 || range.max == infinity) && ray.transform == nullptr)
        if (const auto known = crossed_by_each(surface, ray, true, range.max == 1); !known.in_doubt)
          return known.crossed;
    return first_crossing(surface, ray, range).has_value();
  }
}

/// Calls visit(const Crossing&) for every crossing inside a range, near to far. A surface that offers its
/// roots has a point of tangency twice; on any other, the search goes on after the last hit, and the ray is
/// never restarted.
template <Surface S>
void each_crossing(const S& surface, const Ray& ray, Interval range, auto&& visit) {
  range = range_for(surface, ray, range);
  if constexpr (CompositeSurface<S>) {
    surface.each_crossing(ray, range, visit);
  } else if constexpr (SurfaceWithRoots<S> || SurfaceWithEquation<S>) {
    const Roots roots = roots_of(surface, ray);
    for (int i = 0; i < roots.count(); ++i)
      if (const Crossing crossing{roots[i], i}; lies_inside(surface, ray, crossing, range)) visit(crossing);
  } else {
    int root = 0;
    while (const auto t = detail::own_intersect(surface, ray, range)) {
      visit(Crossing{*t, root++});
      range.min = *t;
    }
  }
}

/// Function table of a surface type.
template <Surface S>
inline constexpr SurfaceFunctions functions_of{
    .at_rest =
        [] {
          Point (*at_rest)(const void*, const Point&, double) = nullptr;
          if constexpr (knows_rest<S>)
            at_rest = [](const void* s, const Point& p, double time) -> Point {
              return static_cast<const S*>(s)->at_rest(p, time);
            };
          return at_rest;
        }(),
    .normal_at = [](const void* s, const Point& p, int primitive) -> Vec3 {
      return normal_at(*static_cast<const S*>(s), p, primitive);
    },
    .uv_at = [](const void* s, const Point& p, int primitive) -> Uv {
      return uv_at(*static_cast<const S*>(s), p, primitive);
    },
    .tangents_at = [](const void* s, const Point& p, int primitive) -> Tangents {
      return tangents_at(*static_cast<const S*>(s), p, primitive);
    },
    .departure = [](const void* s,
                    int primitive) { return departure_of(*static_cast<const S*>(s), primitive); },
    .exact_root =
        [](const void* s, const Ray& ray, const Crossing& crossing) {
          return exact_root(*static_cast<const S*>(s), ray, crossing);
        }};

/// Returns a crossing with a surface, whose type is erased.
template <Surface S>
[[nodiscard]] SurfaceCrossing crossing_on(const S& surface, const Crossing& crossing,
                                          const Material& material) {
  return {.crossing = {crossing.t, crossing.root, crossing.primitive},
          .surface = &surface,
          .functions = &functions_of<S>,
          .material = &material};
}

}  // namespace protostar::inline PROTOSTAR_ABI

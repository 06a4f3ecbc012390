// Surface concepts, and functions that intersect rays with a surface of any type.
//
// A surface must know its first crossing with a ray, and its normal. It may know more, and then more is
// exact: its departure, its roots, its equation. The functions below ask for what it offers and derive the
// rest.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

#include "bounds.hpp"
#include "intersection.hpp"
#include "interval.hpp"
#include "numeric/roots.hpp"
#include "ray.hpp"
#include "surface_roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Surface: any copyable type with the two functions
///
///   std::optional<double> intersect(const Ray&, Interval) const
///   Vec3 normal_at(Point) const
///
/// which return the smallest t of a crossing inside an open interval, and the unit normal at a point of the
/// surface. They and all other functions of a surface are called from several threads at once, and answer
/// alike each time. `static_assert(Surface<Mine>)` checks a type of your own.
///
/// If a surface is made of primitives, as a mesh is of triangles, its functions of a point or a departure
/// take the index of the primitive as well: normal_at(point, part). Its crossings hold that index.
template <class S>
concept Surface = std::copy_constructible<S> &&
    requires(const S& surface, const Ray& ray, Interval range, Point point) {
  { surface.intersect(ray, range) } -> std::same_as<std::optional<double>>;
  requires requires {
    { surface.normal_at(point) } -> std::convertible_to<Vec3>;
  } || requires {
    { surface.normal_at(point, 0) } -> std::convertible_to<Vec3>;
  };
};

/// Surface with bounds: every crossing that it reports is inside them, and the traversal finds it through
/// them. Bounds that are rounded must be widened (outward).
template <class S>
concept SurfaceWithBounds = Surface<S> && requires(const S& surface) {
  { surface.bounds() } -> std::same_as<Bounds>;
};

/// Returns the bounds of a surface; infinite for one without.
template <Surface S>
[[nodiscard]] Bounds bounds_of(const S& surface) {
  if constexpr (SurfaceWithBounds<S>)
    return surface.bounds();
  else
    return {Point{-infinity}, Point{infinity}};
}

/// Surface that offers its roots, all crossings with the ray's line, and its departure; it omits the root t =
/// 0 for a ray with that departure. A point of tangency counts as two.
template <class S>
concept SurfaceWithRoots = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.roots(ray) } -> std::same_as<Roots>;
};

/// Surface that writes down its equation, from which its roots are derived (surface_roots.hpp). They are
/// certified, their test against a range is exact, and so is the order of its crossings and others'.
template <class S>
concept SurfaceWithEquation = Surface<S> &&
    requires(const S& surface, const Ray& ray, const ExactLine& line) {
  surface.equation(ray);
  exact_root_of(surface.equation(line), 0);
  { surface.is_left_by(ray) } -> std::same_as<bool>;
};

/// Surface made of others, or of primitives, that finds its crossings itself, with departures and exact
/// roots.
template <class S>
concept CompositeSurface = Surface<S> &&
    requires(const S& surface, const Ray& ray, Interval range, const Crossing& crossing) {
  { surface.first_crossing(ray, range) } -> std::same_as<std::optional<Crossing>>;
  surface.each_crossing(ray, range, [](const Crossing&) {});
  { surface.exact_root(ray, crossing) } -> std::same_as<ExactRoot>;
};

/// Boundary of a closed solid: each crossing of a line leads into it or out of it, and a tangent line has two
/// crossings where it touches. ends_inside tells if the far end of a ray, t → ∞, is inside, which is never so
/// for a bounded solid. A solid made of primitives has part_count.
template <class S>
concept Solid = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.ends_inside(ray) } -> std::same_as<bool>;
} &&(
    !requires(const S& surface) { surface.departure(0); } ||
    requires(const S& surface) {
      { surface.part_count() } -> std::same_as<int>;
    });

/// True for a surface made of primitives: its functions take the index of one.
template <class S>
inline constexpr bool is_made_of_parts = Surface<S>&& requires(const S& surface, Point point) {
  { surface.normal_at(point, 0) } -> std::convertible_to<Vec3>;
  { surface.departure(0) } -> std::same_as<Departure>;
};

/// True for a surface that says which geometry a ray leaving it departs from, and that omits the root t = 0
/// for a ray with that departure.
template <class S>
inline constexpr bool knows_departure = is_made_of_parts<S> || requires(const S& surface) {
  { surface.departure() } -> std::same_as<Departure>;
};

/// True for a surface with coordinates of its own, for textures.
template <class S>
inline constexpr bool knows_uv = requires(const S& surface, const Point& point) {
  { surface.uv_at(point) } -> std::same_as<Uv>;
}
|| (is_made_of_parts<S> && requires(const S& surface, const Point& point) {
  { surface.uv_at(point, 0) } -> std::same_as<Uv>;
});

/// Returns true if a surface has coordinates. A type that holds other surfaces may tell for each object, by
/// has_uv().
template <Surface S>
[[nodiscard]] bool has_uv(const S& surface) {
  if constexpr (requires { surface.has_uv(); })
    return surface.has_uv();
  else
    return knows_uv<S>;
}

/// Returns true if the crossings of a surface are on primitives of it. A type that holds other surfaces may
/// tell for each object, by has_parts().
template <Surface S>
[[nodiscard]] bool has_parts(const S& surface) {
  if constexpr (requires { surface.has_parts(); })
    return surface.has_parts();
  else
    return is_made_of_parts<S>;
}

/// Returns true if the normal is the same at all points of a primitive, so that it is computed once for all
/// rays that hit it. A surface says so, by has_flat_parts(), if that pays.
template <Surface S>
[[nodiscard]] bool has_flat_parts(const S& surface) {
  if constexpr (requires { surface.has_flat_parts(); })
    return surface.has_flat_parts();
  else
    return false;
}

/// Returns true if a surface is the boundary of a solid. A type that holds other surfaces may tell for each
/// object, by is_solid().
template <Surface S>
[[nodiscard]] bool is_solid(const S& surface) {
  if constexpr (requires { surface.is_solid(); })
    return surface.is_solid();
  else
    return Solid<S>;
}

/// Returns true if a surface is a Solid and the far end of a ray is inside it.
template <Surface S>
[[nodiscard]] bool ends_inside(const S& surface, const Ray& ray) {
  if constexpr (Solid<S>)
    return surface.ends_inside(ray);
  else
    return false;
}

/// Returns the number of a solid's primitives: 1 for a solid that is not made of primitives.
template <Surface S>
[[nodiscard]] int part_count(const S& surface) {
  if constexpr (requires { surface.part_count(); })
    return surface.part_count();
  else
    return 1;
}

/// Returns the unit normal at a point of a surface, or of a primitive of it.
template <Surface S>
[[nodiscard]] Vec3 normal_at(const S& surface, const Point& point, int part) {
  if constexpr (is_made_of_parts<S>)
    return surface.normal_at(point, part);
  else
    return surface.normal_at(point);
}

/// Returns the coordinates of a point of a surface, or of a primitive of it; 0 and 0 if it has none.
template <Surface S>
[[nodiscard]] Uv uv_at(const S& surface, const Point& point, int part) {
  if constexpr (knows_uv<S> && is_made_of_parts<S>)
    return surface.uv_at(point, part);
  else if constexpr (knows_uv<S>)
    return surface.uv_at(point);
  else
    return Uv{0};
}

/// Returns the departure of a ray that leaves a surface, or a primitive of it: the surface's own departure,
/// or else the object itself.
template <Surface S>
[[nodiscard]] Departure departure_of(const S& surface, int part = 0) {
  if constexpr (is_made_of_parts<S>)
    return surface.departure(part);
  else if constexpr (knows_departure<S>)
    return surface.departure();
  else
    return {.kind = Departure::Kind::object, .object = &surface};
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

/// Returns the part of the range that is left for a ray that departs from a surface without departure().
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
  if (surface.intersect(ray, Interval{-tiny, tiny})) return range;
  const auto ahead = surface.intersect(ray, Interval{});
  if (!ahead) return range;
  const auto behind = surface.intersect(Ray{ray.origin, -ray.direction}, Interval{});
  if (!(behind && *behind < *ahead) && range.min < *ahead) range.min = *ahead;
  return range;
}

/// Returns the range in which to intersect a surface: shortened if the ray departs from this surface, which
/// takes no account of departures itself.
template <Surface S>
[[nodiscard]] Interval range_for(const S& surface, const Ray& ray, Interval range) {
  if constexpr (!knows_departure<S>)
    if (ray.departure.kind == Departure::Kind::object && ray.departure.object == &surface)
      return beyond_departure(surface, ray, range);
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
    const auto t = surface.intersect(ray, range);
    return t && range.contains(*t) ? std::optional(Crossing{*t}) : std::nullopt;
  }
}

/// Returns t of the first crossing of a ray with a surface inside a range, if there is one.
template <Surface S>
[[nodiscard]] std::optional<double> first_t(const S& surface, const Ray& ray, Interval range) {
  const auto crossing = first_crossing(surface, ray, range);
  return crossing ? std::optional(crossing->t) : std::nullopt;
}

/// Returns true if a ray has any hit on a surface inside a range. A surface made of many primitives may know
/// that sooner than its closest hit, and offers any_hit(ray, range).
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
    for (auto t = surface.intersect(ray, range); t && range.contains(*t); t = surface.intersect(ray, range)) {
      visit(Crossing{*t, root++});
      range.min = *t;
    }
  }
}

/// Function table of a surface type.
template <Surface S>
inline constexpr SurfaceFunctions functions_of{
    .normal_at = [](const void* s, const Point& p, int part) -> Vec3 {
      return normal_at(*static_cast<const S*>(s), p, part);
    },
    .uv_at = [](const void* s, const Point& p, int part) -> Uv {
      return uv_at(*static_cast<const S*>(s), p, part);
    },
    .departure = [](const void* s, int part) { return departure_of(*static_cast<const S*>(s), part); },
    .exact_root =
        [](const void* s, const Ray& ray, const Crossing& crossing) {
          return exact_root(*static_cast<const S*>(s), ray, crossing);
        }};

/// Returns a crossing with a surface, whose type is erased.
template <Surface S>
[[nodiscard]] SurfaceCrossing crossing_on(const S& surface, const Crossing& crossing,
                                          const Material& material) {
  return {.crossing = crossing, .surface = &surface, .functions = &functions_of<S>, .material = &material};
}

}  // namespace protostar::inline PROTOSTAR_ABI

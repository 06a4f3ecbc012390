// What a surface is, and how a scene crosses one of any kind.
//
// A surface has to know two things: where a ray meets it first, and its normal. It may know more, and then
// more is exact: its roots, their refinement, its departure. The functions below ask for what it offers and
// derive the rest.
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

namespace protostar::inline PROTOSTAR_ABI {

/// A surface: any copyable type with the two functions
///
///   std::optional<double> intersect(const Ray&, Interval) const
///   Vec3 normal_at(Point) const
///
/// the smallest t of a crossing inside an open interval, and the unit normal at a point of the surface. They
/// and all others that a surface may have are called from several threads at once, and answer alike each
/// time. `static_assert(Surface<Mine>)` checks a type of your own.
///
/// A surface that is made of parts, as a mesh is of triangles, takes the part as well wherever it is asked
/// about a point or a departure: normal_at(point, part). Its crossings say which it is.
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

/// A surface that is made of parts.
template <class S>
concept SurfaceWithParts = Surface<S> && requires(const S& surface, Point point) {
  { surface.normal_at(point, 0) } -> std::convertible_to<Vec3>;
  { surface.departure(0) } -> std::same_as<Departure>;
};

/// A surface that offers its roots, all crossings with the ray's line, as certain as Roots says. A point of
/// tangency counts as two, and whether one lies inside an interval is decided exactly if the roots can be
/// refined.
template <class S>
concept SurfaceWithRoots = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.roots(ray) } -> std::same_as<Roots>;
};

/// A surface with roots that mostly knows the first in t > 0 sooner than all of them. What is the same for
/// all surfaces of its type is worked out for a ray once, as its Line.
template <class S>
concept SurfaceWithFirstRoot = SurfaceWithRoots<S> &&
    requires(const S& surface, const typename S::Line& line) {
  requires std::constructible_from<typename S::Line, const Ray&>;
  { surface.first_root(line) } -> std::same_as<FirstRoot>;
};

/// A surface that knows its roots without rounding: the order of its crossings and others' is then exact.
template <class S>
concept SurfaceWithExactRoots = SurfaceWithRoots<S> && requires(const S& surface, const Ray& ray) {
  { surface.exact_root(ray, 0) } -> std::same_as<ExactRoot>;
};

/// A surface that says what a ray leaving it departs from, and that, given a ray with that departure, leaves
/// out the root t = 0.
template <class S>
concept SurfaceWithDeparture = SurfaceWithParts<S> ||(Surface<S>&& requires(const S& surface) {
  { surface.departure() } -> std::same_as<Departure>;
});

/// A surface that knows how far its t can be from the true one at the origin of a ray that leaves it, in t.
/// Such a ray starts beyond that.
template <class S>
concept SurfaceWithError = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.departure_error(ray) } -> std::same_as<double>;
};

/// A surface that is made of others and hands on what they offer, departures included.
template <class S>
concept CompositeSurface = Surface<S> && SurfaceWithDeparture<S> &&
    requires(const S& surface, const Ray& ray, Interval range, const Crossing& crossing) {
  { surface.first_crossing(ray, range) } -> std::same_as<std::optional<Crossing>>;
  surface.each_crossing(ray, range, [](const Crossing&) {});
  { surface.exact_root(ray, crossing) } -> std::same_as<ExactRoot>;
};

/// A surface that can be asked whether its fields make sense: validate() throws std::invalid_argument if not.
template <class S>
concept SurfaceWithValidation = Surface<S> && requires(const S& surface) {
  surface.validate();
};

/// A surface that knows a box around itself: every crossing that it reports is inside, and it is found by way
/// of that box. What rounds has to widen it.
template <class S>
concept SurfaceWithBounds = Surface<S> && requires(const S& surface) {
  { surface.bounds() } -> std::same_as<Bounds>;
};

/// A surface that has coordinates of its own, for textures.
template <class S>
concept SurfaceWithUv = (Surface<S> &&
                         requires(const S& surface, const Point& point) {
                           { surface.uv_at(point) } -> std::same_as<Uv>;
                         }) ||
                        (SurfaceWithParts<S> && requires(const S& surface, const Point& point) {
                          { surface.uv_at(point, 0) } -> std::same_as<Uv>;
                        });

/// The boundary of a closed solid: each crossing of a line leads into it or out of it, and where the line
/// touches it there are two. It says whether the far end of a ray, t → ∞, is inside; of what has bounds, none
/// is. One with parts says how many they are.
template <class S>
concept Solid = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.ends_inside(ray) } -> std::same_as<bool>;
} &&(!SurfaceWithParts<S> || requires(const S& surface) {
  { surface.part_count() } -> std::same_as<int>;
});

/// Whether a surface has coordinates. One that holds others may say it of each.
template <Surface S>
[[nodiscard]] bool has_uv(const S& surface) {
  if constexpr (requires { surface.has_uv(); })
    return surface.has_uv();
  else
    return SurfaceWithUv<S>;
}

/// Whether crossings of a surface are on parts of it. One that holds others may say it of each.
template <Surface S>
[[nodiscard]] bool has_parts(const S& surface) {
  if constexpr (requires { surface.has_parts(); })
    return surface.has_parts();
  else
    return SurfaceWithParts<S>;
}

/// Whether the normal is the same at all points of a part, so that it is worked out once for those that see
/// it. A surface says so where that pays.
template <Surface S>
[[nodiscard]] bool has_flat_parts(const S& surface) {
  if constexpr (requires { surface.has_flat_parts(); })
    return surface.has_flat_parts();
  else
    return false;
}

/// Whether a surface is the boundary of a solid. One that holds others may say it of each.
template <Surface S>
[[nodiscard]] bool is_solid(const S& surface) {
  if constexpr (requires { surface.is_solid(); })
    return surface.is_solid();
  else
    return Solid<S>;
}

/// Whether the far end of a ray is inside a surface, if that is a solid.
template <Surface S>
[[nodiscard]] bool ends_inside(const S& surface, const Ray& ray) {
  if constexpr (Solid<S>)
    return surface.ends_inside(ray);
  else
    return false;
}

/// How many parts a solid has: one without parts is one.
template <Surface S>
[[nodiscard]] int part_count(const S& surface) {
  if constexpr (requires { surface.part_count(); })
    return surface.part_count();
  else
    return 1;
}

/// The unit normal at a point of a surface, or of a part of it.
template <Surface S>
[[nodiscard]] Vec3 normal_at(const S& surface, const Point& point, int part) {
  if constexpr (SurfaceWithParts<S>)
    return surface.normal_at(point, part);
  else
    return surface.normal_at(point);
}

/// The coordinates of a point of a surface, or of a part of it; 0 and 0 if it has none.
template <Surface S>
[[nodiscard]] Uv uv_at(const S& surface, const Point& point, int part) {
  if constexpr (SurfaceWithUv<S> && SurfaceWithParts<S>)
    return surface.uv_at(point, part);
  else if constexpr (SurfaceWithUv<S>)
    return surface.uv_at(point);
  else
    return Uv{0};
}

/// What a ray that leaves this surface, or a part of it, departs from: what the surface says, or else the
/// object itself.
template <Surface S>
[[nodiscard]] Departure departure_of(const S& surface, int part = 0) {
  if constexpr (SurfaceWithParts<S>)
    return surface.departure(part);
  else if constexpr (SurfaceWithDeparture<S>)
    return surface.departure();
  else
    return {.kind = Departure::Kind::object, .object = &surface};
}

/// A crossing without rounding. A surface that knows no more than t is taken at its word.
template <Surface S>
[[nodiscard]] ExactRoot exact_root(const S& surface, const Ray& ray, const Crossing& crossing) {
  if constexpr (CompositeSurface<S>)
    return surface.exact_root(ray, crossing);
  else if constexpr (SurfaceWithExactRoots<S>)
    return surface.exact_root(ray, crossing.root);
  else
    return exact_root_of(crossing.t);
}

namespace detail {

/// lies_inside where the error of t reaches an end of the range.
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

/// Whether a crossing lies inside an open range: decided by t where its error allows, and exactly where not.
template <Surface S>
[[nodiscard]] bool lies_inside(const S& surface, const Ray& ray, const Crossing& crossing, Interval range) {
  const double t = crossing.t, margin = 2 * Roots::relative_error * std::abs(t);
  if (range.min < t - margin && t + margin < range.max) return true;
  if (!(range.min < t + margin && t - margin < range.max)) return false;
  return detail::lies_inside_refined(surface, ray, crossing, range);
}

/// The part of the range that is left for a ray that departs from a surface which knows nothing of
/// departures.
///
/// The crossing at t = 0 is computed and comes out as a little more or less. A surface that knows its error
/// says where others begin. Without that, of all crossings with the line the nearest to the origin is taken
/// for the one that is left: one that lies ahead is cut off, one behind or at the origin is outside a forward
/// ray as it is. This fails where the surface has another crossing so near that the error of t reaches it:
/// along a ray that leaves at a grazing angle, or at a sharp edge. A surface that knows its roots should
/// offer roots() and departure().
template <Surface S>
[[nodiscard]] Interval beyond_departure(const S& surface, const Ray& ray, Interval range) {
  const auto from = [&](double t) {
    return Interval{.min = range.min < t ? t : range.min, .max = range.max};
  };
  if constexpr (SurfaceWithError<S>) {
    return from(surface.departure_error(ray));
  } else {
    constexpr double tiny =
        std::numeric_limits<double>::denorm_min();  // the open interval (-tiny, tiny) holds 0 alone
    if (surface.intersect(ray, Interval{-tiny, tiny})) return range;
    const auto ahead = surface.intersect(ray, Interval{});
    if (!ahead) return range;
    const auto behind = surface.intersect(Ray{ray.origin, -ray.direction}, Interval{});
    return behind && *behind < *ahead ? range : from(*ahead);
  }
}

/// The range in which a surface is crossed, its departure taken into account if it does not do that itself.
template <Surface S>
[[nodiscard]] Interval range_for(const S& surface, const Ray& ray, Interval range) {
  if constexpr (!SurfaceWithDeparture<S>)
    if (ray.departure.kind == Departure::Kind::object && ray.departure.object == &surface)
      return beyond_departure(surface, ray, range);
  return range;
}

/// Where a ray meets a surface first inside a range.
template <Surface S>
[[nodiscard]] std::optional<Crossing> first_crossing(const S& surface, const Ray& ray, Interval range) {
  range = range_for(surface, ray, range);
  if constexpr (CompositeSurface<S>) {
    return surface.first_crossing(ray, range);
  } else if constexpr (SurfaceWithRoots<S>) {
    if constexpr (SurfaceWithFirstRoot<S>)
      if (range.min == 0)
        if (const FirstRoot first = surface.first_root(typename S::Line(ray));
            first.known != FirstRoot::Known::undecided) {
          const Crossing crossing{first.t, first.root};
          return lies_inside(surface, ray, crossing, range) ? std::optional(crossing) : std::nullopt;
        }
    const Roots roots = surface.roots(ray);
    for (int i = 0; i < roots.count(); ++i)
      if (const Crossing crossing{roots[i], i}; lies_inside(surface, ray, crossing, range)) return crossing;
    return std::nullopt;
  } else {
    const auto t = surface.intersect(ray, range);
    return t && range.contains(*t) ? std::optional(Crossing{*t}) : std::nullopt;
  }
}

/// Whether a ray meets a surface inside a range. One that is made of many may know that sooner than which it
/// meets first, and offers is_met(ray, range).
template <Surface S>
[[nodiscard]] bool is_met(const S& surface, const Ray& ray, Interval range) {
  if constexpr (requires { surface.is_met(ray, range); })
    return surface.is_met(ray, range);
  else
    return first_crossing(surface, ray, range).has_value();
}

/// Calls visit(const Crossing&) for every crossing inside a range, near to far. A surface that offers its
/// roots has a point of tangency twice; of another, a straight ray never restarts but goes on after its last
/// hit.
template <Surface S>
void each_crossing(const S& surface, const Ray& ray, Interval range, auto&& visit) {
  range = range_for(surface, ray, range);
  if constexpr (CompositeSurface<S>) {
    surface.each_crossing(ray, range, visit);
  } else if constexpr (SurfaceWithRoots<S>) {
    const Roots roots = surface.roots(ray);
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

/// The table of a surface type.
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

/// A crossing with a surface, whose type is forgotten.
template <Surface S>
[[nodiscard]] SurfaceCrossing crossing_on(const S& surface, const Crossing& crossing,
                                          const Material& material) {
  return {.crossing = crossing, .surface = &surface, .functions = &functions_of<S>, .material = &material};
}

}  // namespace protostar::inline PROTOSTAR_ABI

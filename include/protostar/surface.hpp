// What a surface is, and how a scene crosses one of any kind.
//
// A surface has to know two things: where a ray meets it first, and its normal. It may know more, and then
// more is exact: its roots, its departure. The functions below ask for what it offers and derive the rest.
#pragma once

#include <concepts>
#include <limits>
#include <optional>

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
/// the smallest t of a crossing inside an open interval, and the unit normal at a point of the surface. Both
/// are called from several threads at once. `static_assert(Surface<Mine>)` checks a type of your own.
template <class S>
concept Surface = std::copy_constructible<S> &&
    requires(const S& surface, const Ray& ray, Interval range, Point point) {
  { surface.intersect(ray, range) } -> std::same_as<std::optional<double>>;
  { surface.normal_at(point) } -> std::convertible_to<Vec3>;
};

/// A surface that offers its roots, so that a point of tangency counts as two crossings.
template <class S>
concept SurfaceWithRoots = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.roots(ray) } -> std::same_as<Roots>;
};

/// A surface that may have more than two crossings and visits them itself: crossings(ray, range, visit) calls
/// visit(t) for each inside the range, near to far, its departure taken into account.
template <class S>
concept SurfaceWithCrossings = Surface<S> && requires(const S& surface, const Ray& ray, Interval range) {
  surface.crossings(ray, range, [](double) {});
};

/// A surface that says what a ray leaving it departs from, and whose intersect and roots, given a ray with
/// that departure, leave out the root t = 0.
template <class S>
concept SurfaceWithDeparture = Surface<S> && requires(const S& surface) {
  { surface.departure() } -> std::same_as<Departure>;
};

/// A surface that can be asked whether its fields make sense: validate() throws std::invalid_argument if not.
template <class S>
concept SurfaceWithValidation = Surface<S> && requires(const S& surface) {
  surface.validate();
};

/// What a ray that leaves this surface departs from: what the surface says, or else the object itself.
template <Surface S>
[[nodiscard]] Departure departure_of(const S& surface) {
  if constexpr (SurfaceWithDeparture<S>)
    return surface.departure();
  else
    return {.kind = Departure::Kind::object, .object = &surface};
}

/// The part of the range that is left for a ray that departs from a surface which knows nothing of
/// departures.
///
/// The crossing at t = 0 is computed and comes out as a little more or less. Of all crossings with the line
/// it is taken to be the nearest to the origin: one that lies ahead is cut off with what comes before it, one
/// behind or at the origin is outside a forward ray as it is. This fails where the surface has another
/// crossing so near that the error of t reaches it: along a ray that leaves at a grazing angle, or at a sharp
/// edge. A surface with roots that are known to it should offer departure().
template <Surface S>
[[nodiscard]] Interval beyond_departure(const S& surface, const Ray& ray, Interval range) {
  constexpr double tiny =
      std::numeric_limits<double>::denorm_min();  // the open interval (-tiny, tiny) holds 0 alone
  if (surface.intersect(ray, Interval{-tiny, tiny})) return range;
  const auto ahead = surface.intersect(ray, Interval{});
  if (!ahead) return range;
  const auto behind = surface.intersect(Ray{ray.origin, -ray.direction}, Interval{});
  if (behind && *behind < *ahead) return range;
  return {.min = range.min < *ahead ? *ahead : range.min, .max = range.max};
}

/// Where a ray meets a surface first inside a range, its departure taken into account.
template <Surface S>
[[nodiscard]] std::optional<double> first_crossing(const S& surface, const Ray& ray, Interval range) {
  if constexpr (!SurfaceWithDeparture<S>)
    if (ray.departure.kind == Departure::Kind::object && ray.departure.object == &surface)
      range = beyond_departure(surface, ray, range);
  return surface.intersect(ray, range);
}

/// Calls visit(t) for every crossing inside a range, near to far. A surface that offers its roots has a point
/// of tangency twice; of another, a straight ray never restarts but goes on after its last hit.
template <Surface S>
void each_crossing(const S& surface, const Ray& ray, Interval range, auto&& visit) {
  if constexpr (SurfaceWithCrossings<S>) {
    surface.crossings(ray, range, visit);
  } else if constexpr (SurfaceWithRoots<S>) {
    if constexpr (!SurfaceWithDeparture<S>)
      if (ray.departure == departure_of(surface)) range = beyond_departure(surface, ray, range);
    for (const double t : surface.roots(ray))
      if (range.contains(t)) visit(t);
  } else {
    for (auto t = first_crossing(surface, ray, range); t && range.contains(*t);
         t = surface.intersect(ray, range)) {
      visit(*t);
      range.min = *t;
    }
  }
}

/// A surface of a scene with its color, its type forgotten.
template <Surface S>
[[nodiscard]] SurfaceView view_of(const S& surface, const Color& color) {
  return {.surface = &surface,
          .normal_at = [](const void* s, const Point& p) -> Vec3 {
            return static_cast<const S*>(s)->normal_at(p);
          },
          .departure = [](const void* s) { return departure_of(*static_cast<const S*>(s)); },
          .color = &color};
}

}  // namespace protostar::inline PROTOSTAR_ABI

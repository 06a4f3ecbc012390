// Surface concepts, and compile-time checks with a sentence for each member that a type lacks.
//
// A surface must know its first crossing with a ray, and its normal. It may know more, and then more is
// exact: its departure, its roots, its equation. surface.hpp asks for what it offers and derives the rest.
#pragma once

#include <concepts>
#include <optional>

#include "bounds.hpp"
#include "intersection.hpp"
#include "interval.hpp"
#include "numeric/equation.hpp"
#include "numeric/roots.hpp"
#include "ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

class FieldTape;      // exact/recorded.hpp
class MarchListener;  // march/march_steps.hpp
struct MarchSetup;    // march/field_line.hpp

namespace detail {

// Tests whether a type has one member, for the concepts and for the sentences on what is missing.

template <class S>
inline constexpr bool has_intersect = requires(const S& surface, const Ray& ray, Interval range) {
  { surface.intersect(ray, range) } -> std::same_as<std::optional<double>>;
};
template <class S>
inline constexpr bool has_normal = requires(const S& surface, Point point) {
  { surface.normal_at(point) } -> std::convertible_to<Vec3>;
};
template <class S>
inline constexpr bool has_normal_of_primitives = requires(const S& surface, Point point) {
  { surface.normal_at(point, 0) } -> std::convertible_to<Vec3>;
};
template <class S>
inline constexpr bool has_ends_inside = requires(const S& surface, const Ray& ray) {
  { surface.ends_inside(ray) } -> std::same_as<bool>;
};
template <class S>
inline constexpr bool has_primitive_count = requires(const S& surface) {
  { surface.primitive_count() } -> std::same_as<int>;
};

}  // namespace detail

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
/// take the index of the primitive as well: normal_at(point, primitive). Its crossings hold that index.
template <class S>
concept Surface = std::copy_constructible<S> && detail::has_intersect<S> &&
    (detail::has_normal<S> || detail::has_normal_of_primitives<S>);

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

/// Surface that may be marched with a proof: march_setup() returns its set-up, or null if it is not marched,
/// march(ray, range, listener) tells a listener of each step to the first crossing in the range, and
/// record_field(tape) writes the field down.
template <class S>
concept MarchedSurface = Surface<S> &&
    requires(const S& surface, const Ray& ray, Interval range, MarchListener& listener, FieldTape& tape) {
  { surface.march_setup() } -> std::same_as<const MarchSetup*>;
  surface.march(ray, range, listener);
  surface.record_field(tape);
};

/// Surface with roots(ray): all crossings of the ray's whole line, t < 0 included, near before far, at most
/// two. With departure() it must omit the root t = 0 of a ray with that departure; without it,
/// beyond_departure applies. A point of tangency is given twice. Exact comparisons take each t as it is.
template <class S>
concept SurfaceWithRoots = Surface<S> && requires(const S& surface, const Ray& ray) {
  { surface.roots(ray) } -> std::same_as<Roots>;
};

/// Surface that writes down its equation, from which its roots are derived (surface.hpp). They are
/// certified, their test against a range is exact, and so is the order of its crossings and others'.
template <class S>
concept SurfaceWithEquation = Surface<S> &&
    requires(const S& surface, const Ray& ray, const ExactLine& line) {
  surface.equation(ray);
  exact_root_of(surface.equation(line), 0);
  { surface.is_left_by(ray) } -> std::same_as<bool>;
};

/// True if the equation of a surface is quadratic: a ray that leaves it may cross it once more.
template <class S>
inline constexpr bool is_quadratic = requires(const S& surface, const ExactLine& line) {
  surface.equation(line).without_root_at_0();
};

/// Surface whose equation has terms that are the same for all rays: prepared() computes these, and returns an
/// object with the same equation(rays) for rays in double.
template <class S>
concept PreparedSurface = SurfaceWithEquation<S> && requires(const S& surface, const Ray& ray) {
  { surface.prepared().equation(ray) } -> std::same_as<decltype(surface.equation(ray))>;
};

/// Surface that finds its crossings itself: one made of other surfaces or of primitives, one with more than
/// two crossings per line (Torus), or one that is marched. Its functions take account of departures, and
/// each_crossing visits near to far.
template <class S>
concept CompositeSurface = Surface<S> && requires(const S& surface, const Ray& ray, Interval range,
                                                  const Crossing& crossing, void (*visit)(const Crossing&)) {
  { surface.first_crossing(ray, range) } -> std::same_as<std::optional<Crossing>>;
  surface.each_crossing(ray, range, +visit);  // a temporary, as visitors mostly are
  { surface.exact_root(ray, crossing) } -> std::same_as<ExactRoot>;
};

/// Boundary of a closed solid: each crossing of a line leads into it or out of it, and a tangent line has two
/// crossings where it touches. ends_inside tells if a ray is inside behind the last crossing of its line, or
/// on the whole line if there is none, which is never so for a bounded solid. A solid made of primitives has
/// primitive_count.
template <class S>
concept Solid = Surface<S> && detail::has_ends_inside<S> &&
    (!requires(const S& surface) { surface.departure(0); } || detail::has_primitive_count<S>);

/// True for a surface made of primitives: its functions take the index of one.
template <class S>
inline constexpr bool is_made_of_primitives =
    Surface<S>&& detail::has_normal_of_primitives<S>&& requires(const S& surface) {
  { surface.departure(0) } -> std::same_as<Departure>;
};

/// True for a surface that says which geometry a ray leaving it departs from, and that omits the root t = 0
/// for a ray with that departure.
template <class S>
inline constexpr bool knows_departure = is_made_of_primitives<S> || requires(const S& surface) {
  { surface.departure() } -> std::same_as<Departure>;
};

/// True for a surface that says, by a constant is_flat, that its normal is the same at all of its points.
template <class S>
inline constexpr bool is_flat = requires {
  requires S::is_flat;
};

/// True for a surface with coordinates of its own, for textures.
template <class S>
inline constexpr bool knows_uv = requires(const S& surface, const Point& point) {
  { surface.uv_at(point) } -> std::same_as<Uv>;
}
|| (is_made_of_primitives<S> && requires(const S& surface, const Point& point) {
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

/// True for a surface that knows the directions of its coordinates, for normal maps.
template <class S>
inline constexpr bool knows_tangents = requires(const S& surface, const Point& point) {
  { surface.tangents_at(point) } -> std::same_as<Tangents>;
}
|| (is_made_of_primitives<S> && requires(const S& surface, const Point& point) {
  { surface.tangents_at(point, 0) } -> std::same_as<Tangents>;
});

/// Returns true if a surface has coordinates and knows their directions. A type that holds other surfaces may
/// tell for each object, by has_tangents().
template <Surface S>
[[nodiscard]] bool has_tangents(const S& surface) {
  if constexpr (requires { surface.has_tangents(); })
    return surface.has_tangents();
  else
    return knows_uv<S> && knows_tangents<S>;
}

/// True for a surface with distance_bound(point): a lower bound, up to rounding, of the distance to the
/// surface in scene units; may be less than 0 inside.
template <class S>
inline constexpr bool knows_distance = requires(const S& surface, const Point& point) {
  { surface.distance_bound(point) } -> std::same_as<double>;
};

/// Returns true if a surface tells a bound of distances from it. A type that holds other surfaces may tell
/// for each object, by has_distance_bound().
template <Surface S>
[[nodiscard]] bool has_distance_bound(const S& surface) {
  if constexpr (requires { surface.has_distance_bound(); })
    return surface.has_distance_bound();
  else
    return knows_distance<S>;
}

/// True for a surface that may move: its functions of a point take the point where it was made, which
/// at_rest(point, time) returns.
template <class S>
inline constexpr bool knows_rest = requires(const S& surface, const Point& point) {
  { surface.at_rest(point, 0.0) } -> std::same_as<Point>;
};

/// Returns true if a surface moves. A type that holds other surfaces may tell for each object, by
/// is_moving().
template <Surface S>
[[nodiscard]] bool is_moving(const S& surface) {
  if constexpr (requires { surface.is_moving(); })
    return surface.is_moving();
  else
    return knows_rest<S>;
}

/// Returns true if the crossings of a surface are on primitives of it. A type that holds other surfaces may
/// tell for each object, by has_primitives().
template <Surface S>
[[nodiscard]] bool has_primitives(const S& surface) {
  if constexpr (requires { surface.has_primitives(); })
    return surface.has_primitives();
  else
    return is_made_of_primitives<S>;
}

/// Returns true if the normal is the same at all points of a primitive, so that it is computed once for all
/// rays that hit it. A surface says so, by has_flat_primitives(), if that pays.
template <Surface S>
[[nodiscard]] bool has_flat_primitives(const S& surface) {
  if constexpr (requires { surface.has_flat_primitives(); })
    return surface.has_flat_primitives();
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
[[nodiscard]] int primitive_count(const S& surface) {
  if constexpr (requires { surface.primitive_count(); })
    return surface.primitive_count();
  else
    return 1;
}

namespace detail {

// A concept that is not satisfied stops the compiler, but g++'s message need not name the missing member.
// Functions that take surfaces therefore take any type, and instantiate one of the checks below: each of its
// static_asserts is a sentence, and the compiler adds the name of the type.

/// Checks the members that every Surface has. `hold` is true: if a check fails, compilation stops before
/// anyone sees it.
template <class S>
struct SurfaceRequirements {
  static constexpr bool hold = true;

  static_assert(std::copy_constructible<S>, "Surface: the type cannot be copied");
  static_assert(
      has_intersect<S>,
      "Surface: the type has no intersect(const Ray&, Interval) const that returns std::optional<double>");
  static_assert(has_normal<S> || has_normal_of_primitives<S>,
                "Surface: the type has no normal_at(Point) const that returns a Vec3");
  static_assert(has_normal<S> || !has_normal_of_primitives<S> || is_made_of_primitives<S>,
                "Surface: the type has normal_at(Point, int) const, for primitives, but no Departure "
                "departure(int) const");
};

/// Checks the members that a Surface may have: a function with such a name but another signature would be
/// ignored silently.
template <Surface S>
struct SurfaceOffers : SurfaceRequirements<S> {
  static_assert(
      SurfaceWithRoots<S> || !requires(S surface, const Ray& ray) { surface.roots(ray); },
      "Surface: roots(const Ray&) is not const or does not return Roots");
  static_assert(
      SurfaceWithEquation<S> || !requires(S surface, const Ray& ray) { surface.equation(ray); },
      "Surface: equation(rays) is not const, has no exact form for an ExactLine, or there is no "
      "bool is_left_by(const Ray&) const");
  static_assert(
      CompositeSurface<S> ||
          !requires(S surface, const Ray& ray) { surface.first_crossing(ray, Interval{}); },
      "Surface: first_crossing(const Ray&, Interval) is not const, does not return std::optional<Crossing>, "
      "or lacks each_crossing(ray, range, visit) or exact_root(ray, crossing), which go with it");
  static_assert(
      has_normal_of_primitives<S> || !requires(S surface, Point point) { surface.normal_at(point, 0); },
      "Surface: normal_at(Point, int) is not const or does not return a Vec3");
  static_assert(
      knows_departure<S> || !requires(S surface) { surface.departure(); },
      "Surface: departure() is not const or does not return a Departure");
  static_assert(
      !requires(S surface) { surface.validate(); } || requires(const S surface) { surface.validate(); },
      "Surface: validate() is not const");
  static_assert(
      SurfaceWithBounds<S> || !requires(S surface) { surface.bounds(); },
      "Surface: bounds() is not const or does not return Bounds");
  static_assert(
      knows_uv<S> || !requires(S surface, Point point) { surface.uv_at(point); },
      "Surface: uv_at(Point) is not const or does not return a Uv");
  static_assert(
      knows_tangents<S> || !requires(S surface, Point point) { surface.tangents_at(point); },
      "Surface: tangents_at(Point) is not const or does not return Tangents");
  static_assert(
      knows_uv<S> || !requires(S surface, Point point) { surface.uv_at(point, 0); },
      "Surface: uv_at(Point, int) is not const, does not return a Uv, or lacks normal_at(Point, int)");
  static_assert(
      knows_tangents<S> || !requires(S surface, Point point) { surface.tangents_at(point, 0); },
      "Surface: tangents_at(Point, int) is not const, does not return Tangents, or lacks normal_at(Point, "
      "int)");
  static_assert(
      knows_rest<S> || !requires(S surface, Point point) { surface.at_rest(point, 0.0); },
      "Surface: at_rest(Point, double) is not const or does not return a Point");
  static_assert(
      !requires(S surface) { surface.is_solid(); } ||
          requires(const S surface) {
            { surface.is_solid() } -> std::same_as<bool>;
          },
      "Surface: is_solid() is not const or does not return bool");
  static_assert(
      knows_distance<S> || !requires(S surface, Point point) { surface.distance_bound(point); },
      "Surface: distance_bound(Point) is not const or does not return double");
  static_assert(
      Solid<S> || !requires(S surface, const Ray& ray) { surface.ends_inside(ray); },
      "Surface: ends_inside(const Ray&) is not const or does not return bool, or there are primitives and "
      "no int primitive_count() const");
};

/// Checks the members that a Solid needs beyond those of a Surface.
template <class S>
struct SolidRequirements : SurfaceRequirements<S> {
  static_assert(!Surface<S> || has_ends_inside<S>,
                "Solid: the surface has no bool ends_inside(const Ray&) const");
  static_assert(!is_made_of_primitives<S> || has_primitive_count<S>,
                "Solid: the surface has primitives, but no int primitive_count() const");
};

/// Type that is neither Other nor a Surface, but has one of a surface's functions: it is meant to be one.
template <class S, class Other = void>
concept MeantAsSurface = !std::same_as<S, Other> &&
                         (
                             requires { &S::intersect; } || requires { &S::normal_at; }) &&
                         !Surface<S>;

/// Placeholder for a type that is no surface, or no solid, after the first error message, so that no more
/// follow.
struct NoSurface {
  std::optional<double> intersect(const Ray&, Interval) const { return std::nullopt; }
  Vec3 normal_at(Point) const { return Vec3{0}; }
  bool ends_inside(const Ray&) const { return false; }
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

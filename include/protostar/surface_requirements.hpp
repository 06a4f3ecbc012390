// Compile-time checks of surface types, with a sentence for each member that is missing.
//
// A concept that is not satisfied stops the compiler, but g++'s message need not name the missing member.
// Functions that take surfaces therefore take any type, and instantiate one of the checks below: each of its
// static_asserts is a sentence, and the compiler adds the name of the type.
#pragma once

#include <concepts>
#include <optional>

#include "surface.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Checks the members that every Surface has. `hold` is true: if a check fails, compilation stops before
/// anyone sees it.
template <class S>
struct SurfaceRequirements {
  static constexpr bool hold = true;

  static constexpr bool has_normal_of_parts = requires(const S& surface, Point point) {
    { surface.normal_at(point, 0) } -> std::convertible_to<Vec3>;
  };

  static_assert(std::copy_constructible<S>, "Surface: the type cannot be copied");
  static_assert(
      requires(const S& surface, const Ray& ray, Interval range) {
        { surface.intersect(ray, range) } -> std::same_as<std::optional<double>>;
      },
      "Surface: the type has no intersect(const Ray&, Interval) const that returns std::optional<double>");
  static_assert(
      has_normal_of_parts ||
          requires(const S& surface, Point point) {
            { surface.normal_at(point) } -> std::convertible_to<Vec3>;
          },
      "Surface: the type has no normal_at(Point) const that returns a Vec3");
  static_assert(
      !has_normal_of_parts || is_made_of_parts<S> ||
          requires(const S& surface, Point point) { surface.normal_at(point); },
      "Surface: the type has normal_at(Point, int) const, for parts, but no Departure departure(int) const");
};

/// Checks the members that a Surface may have: a function with such a name but another signature would be
/// ignored silently.
template <Surface S>
struct SurfaceOffers : SurfaceRequirements<S> {
  static_assert(
      SurfaceWithRoots<S> || !requires(S surface, const Ray& ray) { surface.roots(ray); },
      "Surface: roots(const Ray&) is not const or does not return Roots");
  static_assert(
      SurfaceOffers::has_normal_of_parts ||
          !requires(S surface, Point point) { surface.normal_at(point, 0); },
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
      Solid<S> || !requires(S surface, const Ray& ray) { surface.ends_inside(ray); },
      "Surface: ends_inside(const Ray&) is not const or does not return bool, or there are parts and "
      "no int part_count() const");
};

/// Checks the members that a Solid needs beyond those of a Surface.
template <class S>
struct SolidRequirements : SurfaceRequirements<S> {
  static_assert(
      !Surface<S> ||
          requires(const S& surface, const Ray& ray) {
            { surface.ends_inside(ray) } -> std::same_as<bool>;
          },
      "Solid: the surface has no bool ends_inside(const Ray&) const");
  static_assert(
      !is_made_of_parts<S> ||
          requires(const S& surface) {
            { surface.part_count() } -> std::same_as<int>;
          },
      "Solid: the surface has parts, but no int part_count() const");
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

}  // namespace protostar::inline PROTOSTAR_ABI::detail

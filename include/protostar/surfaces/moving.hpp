// A surface that moves along a straight line while a shutter is open.
#pragma once

#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "../magnitude.hpp"
#include "../shutter.hpp"
#include "../surface.hpp"
#include "../surface_concepts.hpp"
#include "any_surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A way along a straight line: at each time t, what moves is at t · velocity from where it was made. It
/// moves during the times given; before and after them it stands still.
struct Motion {
  Vec3 velocity{0};
  Shutter during{0, 1};

  [[nodiscard]] Vec3 way(double time) const { return during.nearest(time) * velocity; }

  /// Returns the point, where all was made, of a point at a time.
  [[nodiscard]] Point at_rest(const Point& point, double time) const { return point - way(time); }
};

/// A surface that is, at each time t, at t · velocity from where it was made. It moves during the times
/// given, which should be those of the camera's shutter; before and after them it stands still.
///
/// A ray of a time t (Ray::time) is moved by −t · velocity, and traced where the surface was made, "at rest".
/// That is one rounding of the product and one of the origin, and all ways of rendering share them. Roots and
/// departures of the moved ray are as exact as the surface's own are. A ray that leaves the surface has the
/// time of the ray that hit it, and so it leaves it where that has hit.
///
/// It is no solid for Csg and cannot be in an Instance, but may hold both. A surface that coincides with it,
/// at one time or at all, is not left together with it.
template <Surface S = AnySurface>
class Moving {
  static_assert(detail::SurfaceOffers<S>::hold);

 public:
  Moving(S surface, const Vec3& velocity, const Shutter& during = {0, 1})
      : surface_(std::move(surface)), motion_{velocity, during} {}

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the point at rest of a point of the surface at a time. All functions of a point take it.
  [[nodiscard]] Point at_rest(const Point& point, double time) const { return motion_.at_rest(point, time); }

  /// Functions of a point at rest.
  [[nodiscard]] Vec3 normal_at(const Point& at_rest, int primitive = 0) const {
    return protostar::normal_at(surface_, at_rest, primitive);
  }
  [[nodiscard]] Uv uv_at(const Point& at_rest, int primitive = 0) const {
    return protostar::uv_at(surface_, at_rest, primitive);
  }
  [[nodiscard]] Tangents tangents_at(const Point& at_rest, int primitive = 0) const {
    return protostar::tangents_at(surface_, at_rest, primitive);
  }

  /// Returns this surface, recognized by its address.
  [[nodiscard]] Departure departure(int primitive = 0) const {
    return {.kind = Departure::Kind::object, .primitive = primitive, .object = this};
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    return protostar::first_crossing(surface_, at_rest(ray), range);
  }
  [[nodiscard]] bool any_hit(const Ray& ray, Interval range) const {
    return protostar::any_hit(surface_, at_rest(ray), range);
  }
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    protostar::each_crossing(surface_, at_rest(ray), range, visit);
  }
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return protostar::exact_root(surface_, at_rest(ray), crossing);
  }

  [[nodiscard]] bool has_primitives() const { return true; }
  [[nodiscard]] bool has_uv() const { return protostar::has_uv(surface_); }
  [[nodiscard]] bool has_tangents() const { return protostar::has_tangents(surface_); }

  /// Returns the box around all places that it takes.
  ///
  /// With u = 2^-53: a moved origin is off by u (|o| + 2 |way|), so a crossing is off the moved bounds by
  /// that. |o| is at most the distance from the crossing and a corner's size. Of the distance, culling and
  /// trees have margins of 2^-20 and more; 2^-50 = 8u of a corner and of the way covers the rest, and the
  /// sum's rounding.
  [[nodiscard]] Bounds bounds() const {
    const Bounds rest = bounds_of(surface_);
    const Vec3 a = motion_.way(during().opens), b = motion_.way(during().closes);
    const Vec3 margin = 0x1p-50 * (max(abs(rest.min), abs(rest.max)) + max(abs(a), abs(b)));
    return {rest.min + min(a, b) - margin, rest.max + max(a, b) + margin};
  }

  [[nodiscard]] const S& surface() const { return surface_; }
  [[nodiscard]] const Motion& motion() const { return motion_; }
  [[nodiscard]] const Vec3& velocity() const { return motion_.velocity; }
  [[nodiscard]] const Shutter& during() const { return motion_.during; }

  /// Throws std::invalid_argument if the surface is not valid or moves itself, if the times are not
  /// (Shutter), or if a number of the velocity or of the way is no coordinate (magnitude.hpp).
  void validate() const {
    if constexpr (requires { surface_.validate(); }) surface_.validate();
    if (is_moving(surface_)) throw std::invalid_argument("Moving: the surface must not be moving itself");
    during().validate("Moving");
    require_rule(is_coordinate(velocity()), "Moving: velocity must have numbers", coordinate_rule);
    for (const double time : {during().opens, during().closes})
      require_rule(is_coordinate(motion_.way(time)), "Moving: velocity times time must have numbers",
                   coordinate_rule);
  }

 private:
  /// Returns the ray at rest. It departs from the surface if the ray left this one; any other surface that it
  /// may have left is elsewhere.
  [[nodiscard]] Ray at_rest(const Ray& ray) const {
    Ray rest = ray;
    rest.origin = at_rest(ray.origin, ray.time);
    rest.departure =
        ray.departure.object == this ? departure_of(surface_, ray.departure.primitive) : Departure{};
    return rest;
  }

  S surface_;
  Motion motion_;
};

static_assert(CompositeSurface<Moving<>> && is_made_of_primitives<Moving<>> && !Solid<Moving<>>);

}  // namespace protostar::inline PROTOSTAR_ABI

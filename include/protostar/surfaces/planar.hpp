// Departures from surfaces that lie in a plane.
#pragma once

#include <cstddef>

#include "../numeric/plane_through.hpp"
#include "../ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the departure from the plane x_axis = place.
[[nodiscard]] inline Departure departure_across(int axis, double place) {
  Departure departure{.kind = Departure::Kind::plane};
  departure.geometry[static_cast<std::size_t>(axis)] = 1, departure.geometry[3] = place;
  return departure;
}

/// Returns the departure from the plane of a surface, which surfaces in one plane have in common. It is exact
/// if the plane is perpendicular to an axis, is_across(axis); if not, it is equation(), rounded, and equal
/// planes still have equal departures.
[[nodiscard]] Departure departure_of_plane(const Point& position, const auto& is_across,
                                           const auto& equation) {
  for (int axis = 0; axis < 3; ++axis)
    if (is_across(axis)) return departure_across(axis, position[axis]);
  return {.kind = Departure::Kind::rounded_plane, .geometry = equation()};
}

/// Returns true if a ray, or the rays of a packet, depart from the plane of a surface through a position
/// along some vectors. Its equation is written down only for rays that leave another surface, perhaps in the
/// same plane.
[[nodiscard]] bool is_plane_left_by(const auto& rays, const auto& surface, const Point& position,
                                    const auto&... along) {
  return rays.departure.is_planar() && !surely_differs(rays.departure.geometry, position, along...) &&
         (rays.departure.surface == &surface || rays.departure == surface.departure());
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Rays in lanes, and their first crossings, for surfaces that search for all of them at once. A surface that
// holds one of any type passes them on (surfaces/any_surface.hpp).
#pragma once

#include <concepts>

#include "function_ref.hpp"
#include "interval.hpp"
#include "numeric/rounded_equation.hpp"
#include "ray.hpp"
#include "simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Rays, one in each lane. It borrows the function that returns the ray of a lane, with all that it knows.
struct RayLanes {
  const simd::Vectors& origin;
  const simd::Vectors& direction;
  simd::LaneMask active;  ///< lanes of rays that are asked for; results in the others do not matter
  bool may_depart;        ///< false if no ray leaves any geometry
  FunctionRef<Ray(int)> ray;
};

/// First crossing of each ray inside a range: its t alone, as such surfaces have no primitives.
using FirstOfLanes = FirstRootOfEach<simd::Doubles, simd::LaneMask>;

/// Surface that finds the first crossings of several rays at once, with the same bits as ray by ray, by
/// `FirstOfLanes first_of_lanes(const RayLanes&, Interval) const`.
template <class S>
concept SurfaceOfLanes = requires(const S& surface, const RayLanes& rays) {
  { surface.first_of_lanes(rays, Interval{}) } -> std::same_as<FirstOfLanes>;
};

/// Sets the first crossing of each of the given lanes to the one that `find(lane)` returns, if there is one.
void set_one_by_one(FirstOfLanes& first, simd::LaneMask lanes, const auto& find) {
  for (const int lane : lanes_in(lanes)) {
    const auto crossing = find(lane);
    if (!crossing) continue;
    first.t.set(lane, crossing->t);
    first.is_there = first.is_there || simd::mask_of<double, simd::double_lanes>(simd::Bits{1} << lane);
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI

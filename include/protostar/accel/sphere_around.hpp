// A sphere that contains a surface: what tiles take it for.
#pragma once

#include <cmath>
#include <concepts>

#include "../surface.hpp"
#include "../surfaces/sphere.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A sphere that contains a surface.
struct SphereAround {
  Point center;
  double radius;  ///< infinite where the surface has no bounds
};

/// Whether a surface has finite bounds. A tree has just these in its leaves.
template <Surface S>
[[nodiscard]] bool has_bounds(const S& surface) {
  if constexpr (SurfaceWithBounds<S>) {
    const auto [min, max] = surface.bounds();
    return is_finite(min) && is_finite(max);
  } else {
    return false;
  }
}

/// The sphere around a surface. Its radius may be infinite.
template <Surface S>
[[nodiscard]] SphereAround sphere_around(const S& surface) {
  if constexpr (std::same_as<S, Sphere>) {
    return {surface.center, std::abs(surface.radius)};
  } else if constexpr (!SurfaceWithBounds<S>) {
    return {Point{0}, infinity};
  } else {
    const auto [min, max] = surface.bounds();
    const Vec3 half = 0.5 * max - 0.5 * min;
    const Point center = min + half;
    // The center is off by a rounding of each of its parts, the length by three of itself.
    return {center, length(half) * (1 + 0x1p-50) + 0x1p-51 * (length(center) + length(half))};
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Bounding spheres of surfaces, by which these are culled from tiles.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>

#include "../function_ref.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../surface.hpp"
#include "../surfaces/sphere.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A sphere that contains a surface.
struct SphereAround {
  Point center;
  double radius;  ///< infinite if the surface has no bounds

  /// Radius of a sphere around center that no ray from outside enters before it enters the surface; below 0
  /// if there is none.
  double inner = -1;
};

/// Spheres that contain surfaces, one in each lane.
struct SpheresAround {
  Vectors center;
  Doubles radius, inner;

  SpheresAround(const Vectors& centers, const Doubles& radii, const Doubles& inner_radii)
      : center(centers), radius(radii), inner(inner_radii) {}
  SpheresAround(const SphereAround& one) : center(one.center), radius(one.radius), inner(one.inner) {}

  [[nodiscard]] SphereAround operator[](int lane) const { return {center[lane], radius[lane], inner[lane]}; }
};

/// Indices of surfaces in the scene's order, one in each lane.
using SurfaceIndices = Lanes<std::uint32_t, double_lanes>;

/// Some surfaces and the spheres around them, in lanes whose bit is set.
struct SurfacesAround {
  SurfaceIndices indices;
  Bits lanes;
  SpheresAround around;
};

/// Function that is told of some surfaces at a time.
using VisitSurfaces = FunctionRef<void(const SurfacesAround&)>;

/// Returns a sphere around a surface. Its radius is infinite if the surface has no bounds, or infinite ones.
template <Surface S>
[[nodiscard]] SphereAround sphere_around(const S& surface) {
  if constexpr (std::same_as<S, Sphere>) {
    return {surface.center, std::abs(surface.radius), std::abs(surface.radius)};
  } else if constexpr (!SurfaceWithBounds<S>) {
    return {Point{0}, infinity};
  } else {
    const Bounds bounds = surface.bounds();
    if (!is_finite(bounds)) return {Point{0}, infinity};
    const auto& [min, max] = bounds;
    const Vec3 half = 0.5 * max - 0.5 * min;
    const Point center = min + half;
    // The center is off by one rounding of each component, the length by three roundings of itself.
    return {center, length(half) * (1 + 0x1p-50) + 0x1p-51 * (length(center) + length(half))};
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Several spheres, one in each lane, that rays of a packet are tested with at once.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "../scene.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../surfaces/sphere.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Returns the index of the first sphere in the order of a scene's surfaces.
template <Surface... S>
[[nodiscard]] std::int64_t first_sphere(const Scene<S...>& scene) {
  std::int64_t first = 0;
  bool is_before = true;
  const auto pass = [&]<class T>(const SceneVector<T>& surfaces) {
    is_before = is_before && !std::same_as<T, Sphere>;
    if (is_before) first += static_cast<std::int64_t>(surfaces.size());
  };
  (pass(scene.template surfaces<S>()), ...);
  return first;
}

/// A sphere in each lane, with the members of Sphere that the first roots of camera rays need.
struct SpheresInLanes {
  Vectors center;
  Doubles radius;

  /// Gathers the spheres with some indices.
  SpheresInLanes(const Sphere* spheres, const Indices& indices) {
    const auto number = [&](const double& of_first) { return gathered(spheres, of_first, indices); };
    center = {number(spheres->center.x), number(spheres->center.y), number(spheres->center.z)};
    radius = number(spheres->radius);
  }

  [[nodiscard, gnu::always_inline]] auto equation(const auto& rays) const {
    return sphere_equation(rays, center, radius);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

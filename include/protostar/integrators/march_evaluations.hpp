// Shows how many evaluations of fields the rays of a picture take, as a heat map.
#pragma once

#include <cstdint>
#include <stdexcept>

#include "../heat_color.hpp"
#include "../scene.hpp"
#include "../scene_fields.hpp"
#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator that counts the evaluations of all fields that the marches of a ray take, values and slopes
/// alike, until its closest hit or its miss is proven. The radiance is the heat_color of their number divided
/// by `most`. Surfaces that are not marched take none.
struct MarchEvaluationsIntegrator {
  SceneMarches marches;
  double most = 128;  ///< number of evaluations from which on the color is white

  /// Prepares the marches of a scene; pictures of that scene can then be drawn. Throws std::invalid_argument
  /// if no surface is marched.
  template <Surface... S>
  explicit MarchEvaluationsIntegrator(const Scene<S...>& scene, double white = 128)
      : marches(scene, "MarchEvaluationsIntegrator: "), most(white) {}

  /// Throws std::invalid_argument unless `most` is greater than 0. render calls it.
  void validate() const {
    if (!(most > 0)) [[unlikely]]
      throw std::invalid_argument("MarchEvaluationsIntegrator: most must be greater than 0; it is " +
                                  shown(most));
  }

  /// Returns the number of evaluations of a ray's marches. Throws std::logic_error if the scene is not the
  /// one of the marches.
  [[nodiscard]] std::uint64_t evaluations(const Ray& ray, const auto& scene) const {
    marches.require(scene);
    std::uint64_t sum = 0;
    marches.each_march(ray, scene.intersect(ray, Interval{}),
                       [&](const void*, const CountedMarch& march) { sum += march.counts().evaluations(); });
    return sum;
  }

  [[nodiscard]] Color radiance(const Ray& ray, const auto& scene) const {
    return heat_color(static_cast<double>(evaluations(ray, scene)) / most);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

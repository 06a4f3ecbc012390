// Shows how narrowly the marches of a picture enclose their hits, as a heat map.
#pragma once

#include <cmath>
#include <optional>

#include "../heat_color.hpp"
#include "../scene.hpp"
#include "../scene_fields.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of the bits to which the t of a hit on a marched surface is proven: −log2((max − min)/t), with
/// t in [min, max]. The radiance is the heat_color of (bits − fewest)/(most − fewest). It is black if a ray
/// hits nothing, hits a surface that is not marched, or touches a marched one without a proof.
struct EnclosureWidthIntegrator {
  /// Every hit is proven to 30 bits (enclosure_width), and a double has 53: an enclosure whose ends are
  /// neighboring doubles has about 52.
  static constexpr double fewest = 30, most = 53;

  SceneMarches marches;

  /// Prepares the marches of a scene; pictures of that scene can then be drawn. Throws std::invalid_argument
  /// if no surface is marched.
  template <Surface... S>
  explicit EnclosureWidthIntegrator(const Scene<S...>& scene)
      : marches(scene, "EnclosureWidthIntegrator: ") {}

  /// Returns the bits to which the closest hit is proven, nothing if it is not on a marched surface, and 0
  /// for a touch. The logarithm is exact at powers of 2 and interpolated linearly between them, which is too
  /// small by less than 0.09; std::log2 would give other last digits on other machines. Throws
  /// std::logic_error if the scene is not the one of the marches.
  [[nodiscard]] std::optional<double> bits(const Ray& ray, const auto& scene) const {
    marches.require(scene);
    const auto hit = scene.intersect(ray, Interval{});
    std::optional<double> found;
    if (!hit) return found;
    marches.each_march(ray, hit, [&](const void* surface, const CountedMarch& march) {
      if (surface != hit->surface() || !march.is_hit()) return;
      const Interval& t = march.enclosure();
      int exponent = 0;
      const double share = t.min < t.max ? std::frexp(t.max / (t.max - t.min), &exponent) : 1;  // in [½, 1)
      found = exponent + 2 * (share - 1);
    });
    return found;
  }

  [[nodiscard]] Color radiance(const Ray& ray, const auto& scene) const {
    return heat_color((bits(ray, scene).value_or(0) - fewest) / (most - fewest));
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

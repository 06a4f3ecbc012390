// Light that arrives at a hit along rays to lights, and what the surface sends back of it to the viewer.
//
// A matte surface takes light by rays to lights alone: directions that are drawn to a light by solid angle
// vary least there. For a glossy lobe, rays to lights are best for a large lobe and a small light, and
// directions drawn by the lobe for a small lobe and a large light; both are drawn and weighed by the power
// heuristic, so that of each direction the weights add up to 1 (multiple importance sampling, Veach and
// Guibas 1995).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "intersection.hpp"
#include "light.hpp"
#include "lobes.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Numbers of rays to area lights and environments that this thread has traced, and of those that it did not
/// have to: the light was behind the surface, or seen edge on.
struct LightRays {
  std::uint64_t traced = 0, skipped = 0;
};
inline thread_local LightRays light_rays;

/// Returns the weight of a direction that was drawn with the density `own`, and with `other` in another way:
/// own²/(own² + other²). It is 1 if `other` is 0, also if both are, or `own` is infinite, as that of a
/// mirror; otherwise 0 if `own` is 0, for a direction that is left to the other way.
[[nodiscard]] inline double power_heuristic(double own, double other) {
  if (!(other > 0) || own == std::numeric_limits<double>::infinity()) return 1;
  const double ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

/// Light that a surface receives or reflects, by the ways in which it does.
struct ReflectedLight {
  Color matte{0};   ///< irradiance over π, which the albedo reflects
  Color glossy{0};  ///< radiance that the glossy lobe reflects

  ReflectedLight& operator+=(const ReflectedLight& other) {
    matte += other.matte, glossy += other.glossy;
    return *this;
  }
  friend ReflectedLight operator*(const ReflectedLight& light, float factor) {
    return {light.matte * factor, light.glossy * factor};
  }
};

/// Factors by which the radiance from one direction becomes ReflectedLight.
struct LightShare {
  double matte = 0;  ///< for ReflectedLight::matte
  Color glossy{0};   ///< for ReflectedLight::glossy

  /// Returns true if light from that direction is reflected at all.
  [[nodiscard]] bool counts() const { return matte > 0 || !is_black(glossy); }

  /// Returns the light that a radiance from that direction becomes.
  [[nodiscard]] ReflectedLight of(const Color& radiance) const {
    return {matte > 0 ? clamped(radiance * to_float(matte)) : Color{0}, clamped(radiance * glossy)};
  }
};

/// Hit, with all that the rays to lights need of it. Its normals are computed once. Borrows the hit.
struct Reflector {
  const Intersection& hit;
  Vertex vertex;
  bool is_matte;                       ///< true if the albedo is not black
  std::optional<GlossyLobeAt> glossy;  ///< empty if the material has no glossy lobe

  /// Probability that the path goes on by the glossy lobe. Times the density of the lobe's directions, it is
  /// the density against which rays to lights are weighed (power_heuristic).
  double glossy_probability = 1;

  /// Takes a hit, and the surface's color there. Always inlined, as each vertex of a path calls it.
  [[gnu::always_inline]] Reflector(const Intersection& at, const Color& albedo)
      : hit(at), vertex(at), is_matte(!is_black(albedo)) {
    if (const Material& material = at.material(); !is_black(material.glossy)) [[unlikely]]
      glossy.emplace(vertex, material);
  }

  /// Returns true if light may be reflected.
  [[nodiscard]] bool reflects() const { return is_matte || glossy.has_value(); }

  /// Returns the share of the light from a unit direction that was drawn with a density in 1/steradian, times
  /// a weight: 1 over the expected number of rays to that light. Counts the ray there (light_rays): it has to
  /// be traced if the share counts. It is always inlined, as frame_around is.
  [[nodiscard, gnu::always_inline]] LightShare share_of_ray(const Vec3& direction, double density,
                                                            double weight) const {
    // With a limit that a float holds, black stays black (0 · ∞ is NaN). No light that is likely to be chosen
    // exceeds it.
    constexpr double largest_factor = most_irradiance;
    const double height = is_matte ? vertex.normals.height(direction) : 0;
    LightShare share{std::min(weight * height / (std::numbers::pi * density), largest_factor)};
    if (glossy) {
      const double own = density / weight;
      const double part = power_heuristic(own, glossy_probability * glossy->density(direction)) / own;
      share.glossy = times(glossy->reflection(direction), std::min(part, largest_factor));
    }
    ++(share.counts() ? light_rays.traced : light_rays.skipped);
    return share;
  }

  /// Returns the light from a direction, by its share_of_ray. radiance() traces the ray there and returns the
  /// radiance of the light, or black if it is hidden; it is called only if the light counts.
  [[nodiscard]] ReflectedLight light_by_ray(const Vec3& direction, double density, double weight,
                                            const auto& radiance) const {
    const LightShare share = share_of_ray(direction, density, weight);
    return share.counts() ? share.of(radiance()) : ReflectedLight{};
  }

  /// Returns the light of a source at a point or in a direction, if nothing occludes it. Its `matte` is the
  /// irradiance, which the caller divides by π. A glossy lobe may reflect light that is behind a shading
  /// normal (GlossyLobeAt).
  [[nodiscard]] ReflectedLight light_of(const Light& light, const auto& scene) const {
    if (!glossy) [[likely]]
      return {visible_irradiance(scene, hit, light)};
    const Vec3 to_light = light.towards(hit.point());
    const double height = is_matte ? hit.height(to_light) : 0;
    const Color share = glossy->reflection(normalize(to_light));
    if (!(height > 0) && is_black(share)) return {};
    if (scene.occluded(hit.leave(to_light), light.occlusion_range())) return {};
    return {light.received(to_light, height), clamped(share * light.perpendicular_irradiance(hit.point()))};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

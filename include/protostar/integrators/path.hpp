// Shows all light between lights and the eye, by paths that are drawn by chance (Kajiya 1986).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "../area_lights.hpp"
#include "../lobes.hpp"
#include "../render.hpp"
#include "../sampling/sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of all light: the radiance of a hit is its emission, and the light from everywhere that its
/// material sends back along the ray, which in turn is the radiance of what is seen there,
///   L = L_e + ρ/π ∫ L cos θ dω + reflect · L(mirrored) + refract · (F L(mirrored) + (1 − F) L(refracted)),
/// with the color as the albedo ρ, and Fresnel's share F. The sky, or black, if there is no hit.
///
/// A path from the eye follows one of these terms at each vertex, chosen by chance. In the integral, the
/// light of area lights is found by a ray to one of them, as by DirectIntegrator: directions drawn to a light
/// by solid angle vary less on matte surfaces than a mixture with those that the surface draws, and take a
/// ray less. If the path meets that light next, it is not counted again. Lights at points or in directions
/// light matte surfaces, as in DirectIntegrator; all other light, of the sky and of surfaces that are no
/// AreaLights, is found by the path itself.
///
/// The estimate is unbiased up to the depth. It is bounded: no path weighs more than the product of the sums
/// of shares at its first vertices.
struct PathIntegrator : FirstHit<PathIntegrator> {
  /// Largest depth. It bounds the time of a sample, and the coordinates of points (farthest_point).
  static constexpr int most_depth = 1000;

  /// Number of bounces after which Russian roulette ends paths by chance. Those that go on get the weight of
  /// those that end, so that no light is lost on average.
  static constexpr int sure_bounces = 3;

  AreaLights lights;

  /// Largest number of bounces between light and eye, from 0 to most_depth: 0 shows emission alone, 1 adds
  /// what DirectIntegrator shows, if there are no mirrors. A path that is cut adds nothing.
  int depth = 100;

  /// Largest number of rays from a vertex to lights at points or in directions; of more lights, as many are
  /// drawn. One more ray is for an area light, chosen with a probability in proportion to its power.
  int most_rays = 16;

  /// Prepares the lights of a scene; pictures of that scene can then be drawn.
  template <Surface... S>
  explicit PathIntegrator(const Scene<S...>& scene) : lights(scene) {}

  /// Throws std::invalid_argument if depth or most_rays is not in its range. render calls it.
  void validate() const {
    if (depth < 0 || depth > most_depth) [[unlikely]]
      throw std::invalid_argument("PathIntegrator: depth must be from 0 to " + std::to_string(most_depth) +
                                  "; it is " + std::to_string(depth));
    if (most_rays < 1) [[unlikely]]
      throw std::invalid_argument("PathIntegrator: most_rays must be at least 1; it is " +
                                  std::to_string(most_rays));
  }

  /// Takes set 1 of the sampler at the hit, and the next set at each further vertex: two numbers for the
  /// direction and two for the light, of which the first also decides how the path goes on. Throws
  /// std::logic_error if the scene is not the one of the lights.
  [[nodiscard]] Color shade(const Intersection& first, const auto& scene, const auto& sampler) const {
    lights.require(scene);
    Color sum{0}, weight{1};
    double most_weight = 0;
    bool is_lit = false;  // by rays to lights, from the vertex before
    std::optional<Intersection> hit(first);
    for (int bounce = 0;; ++bounce) {
      const Material& material = hit->material();
      if (!is_black(material.emission) && !(is_lit && lights.may_choose(*hit)))
        sum = clamped(sum + clamped(weight * material.emission));
      if (bounce >= depth) return sum;

      const SampleSet<double> numbers = sampler(static_cast<std::uint32_t>(1 + bounce));
      const Color albedo = hit->color();
      if (!is_black(albedo))
        sum = clamped(sum + clamped(weight * clamped(albedo * light_at(*hit, scene, numbers))));

      double number = numbers[2];
      const auto onward = scatter(Vertex(*hit), material, albedo, numbers, number);
      if (!onward) return sum;
      if (bounce == sure_bounces) most_weight = largest(weight);
      weight = clamped(weight * onward->weight);
      if (bounce >= sure_bounces && !survives(weight, most_weight, number)) return sum;
      is_lit = !onward->is_sharp;
      const Ray ray = hit->leave(onward->direction);
      hit = scene.intersect(ray, Interval{});
      if (!hit) return clamped(sum + clamped(weight * background(ray, scene)));
    }
  }

 private:
  /// Returns an estimate of the irradiance, over π, by ambient light, by lights at points or in directions,
  /// and by area lights, if they are not occluded.
  [[nodiscard]] Color light_at(const Intersection& hit, const auto& scene,
                               const SampleSet<double>& numbers) const {
    Color light = ambient_of(scene);
    const std::vector<Light>& all = scene.lights();
    if (const auto rays = static_cast<std::size_t>(most_rays); all.size() <= rays) {
      for (const Light& one : all) light += visible_irradiance(scene, hit, one);
    } else {
      // One number chooses all: each share of 1/rays of the lights gets a ray.
      const double step = static_cast<double>(all.size()) / most_rays;
      for (int k = 0; k < most_rays; ++k) {
        const auto i = static_cast<std::size_t>((k + numbers[2]) * step);
        light += to_float(step) * visible_irradiance(scene, hit, all[std::min(i, all.size() - 1)]);
      }
    }
    light = clamped(light) * to_float(1 / std::numbers::pi);
    if (!(lights.by_power().whole() > 0)) return light;
    const auto [index, probability, rest] = lights.by_power().choose(numbers[2]);
    return clamped(light +
                   lights.lights()[index].light_by_ray(hit, scene, {rest, numbers[3]}, 1 / probability));
  }

  /// Chooses one of the material's lobes, with a probability in proportion to its share, and draws a
  /// direction by it; none if the material scatters no light, or the direction leads into the surface.
  [[nodiscard]] static std::optional<Bounce> scatter(const Vertex& vertex, const Material& material,
                                                     const Color& albedo, const SampleSet<double>& numbers,
                                                     double& number) {
    const DiffuseLobe diffuse{albedo};
    const MirrorLobe mirror{to_float(material.reflect)};
    const GlassLobe glass{to_float(material.refract), material.ior};
    const double sharp = mirror.share() + glass.share(), whole = diffuse.share() + sharp;
    if (!(whole > 0)) return std::nullopt;
    std::optional<Bounce> onward;
    double share = 0;
    if (decide(number, diffuse.share() / whole))
      onward = diffuse.sample(vertex, numbers), share = diffuse.share();
    else if (decide(number, mirror.share() / sharp))
      onward = mirror.sample(vertex), share = mirror.share();
    else
      onward = glass.sample(vertex, number), share = glass.share();
    if (onward) onward->weight = times(onward->weight, whole / share);
    return onward;
  }

  /// Russian roulette: a path goes on with a probability in proportion to its weight, and then weighs as much
  /// as any may.
  [[nodiscard]] static bool survives(Color& weight, double most_weight, double& number) {
    const double probability = largest(weight) / most_weight;
    if (probability >= 1) return true;
    if (!decide(number, probability)) return false;
    weight = times(weight, 1 / probability);
    return true;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

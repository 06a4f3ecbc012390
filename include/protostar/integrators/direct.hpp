// Shows matte and glossy surfaces in the light that comes straight from lights of any size, with soft
// shadows.
#pragma once

#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "../area_lights.hpp"
#include "../render.hpp"
#include "../sampling/sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of direct light: the radiance of a hit is
///   L_e + ρ/π · Σ E
/// with its emission L_e, its color as the albedo ρ, and the irradiance E of each light that is not occluded:
/// the ambient ones, those at a point or in a direction, and the area lights. The sky, or black, if there is
/// no hit.
///
/// The irradiance by an area light is the mean, over directions ω drawn to it, of V L_e cos θ/p(ω), where p
/// is the density of the direction by solid angle, and the visibility V is 1 if the light is the first
/// surface that the ray along ω meets. The light thus needs no exception among the occluders, and is visible
/// from a point exactly where a ray of the camera would see it.
///
/// A material's glossy lobe reflects lights at a point or in a direction, area lights, and what else a mirror
/// sees that sends out light itself: the sky and other surfaces with an emission. A direction that the lobe
/// draws is traced for it (light_at_hit.hpp). The lobe does not reflect ambient light, and matte surfaces do
/// not reflect the sky.
struct DirectIntegrator : FirstHit<DirectIntegrator> {
  /// Says that camera rays may be traced in packets (accel/packet_integrator.hpp). It names its own type.
  using ShadesEachHit = DirectIntegrator;

  AreaLights lights;

  /// Largest number of rays to area lights for one hit, at least 1. If there are at most so many lights, each
  /// gets a ray, and only the place on the light is random. If there are more lights, most_rays rays are
  /// cast, each to a light that is chosen with a probability in proportion to its power; so the time of a hit
  /// has a bound.
  int most_rays = 16;

  /// Prepares the lights of a scene; pictures of that scene can then be drawn.
  template <Surface... S>
  explicit DirectIntegrator(const Scene<S...>& scene) : lights(scene) {}

  /// Throws std::invalid_argument if most_rays is less than 1. render calls it.
  void validate() const {
    if (most_rays < 1) [[unlikely]]
      throw std::invalid_argument("DirectIntegrator: most_rays must be at least 1; it is " +
                                  std::to_string(most_rays));
  }

  /// Takes two numbers for each ray from the sampler: those of ray k are in set 1 + k/2. With more lights
  /// than rays, they come after one pair for the choice. A glossy lobe takes the next two. Throws
  /// std::logic_error if the scene is not the one of the lights.
  [[nodiscard]] Color shade(const Intersection& hit, const auto& scene, const auto& sampler) const {
    lights.require(scene);
    const Material& material = hit.material();
    const Color albedo = hit.color();
    const Reflector at(hit, albedo);
    if (!at.reflects()) return material.emission;
    ReflectedLight light{ambient_of(scene)};
    for (const Light& one : scene.lights()) light += at.light_of(one, scene);
    light.matte *= to_float(1 / std::numbers::pi);
    Pairs pairs(sampler);
    light += light_of_areas(at, scene, pairs);
    const Color matte = clamped(material.emission + albedo * clamped(light.matte));
    if (!at.glossy) return matte;
    return clamped(matte + clamped(light.glossy + light_along_lobe(at, scene, pairs.next())));
  }

 private:
  /// Returns an estimate of the light of all area lights. pairs.next() returns two numbers in (0, 1).
  [[nodiscard]] ReflectedLight light_of_areas(const Reflector& at, const auto& scene, auto& pairs) const {
    const std::vector<AreaLight>& all = lights.lights();
    const auto rays = static_cast<std::uint32_t>(most_rays);
    ReflectedLight sum;
    if (all.size() <= rays) {
      for (const AreaLight& one : all) sum += one.light_by_ray(at, scene, pairs.next(), 1);
      return sum;
    }
    if (!(lights.by_power().whole() > 0)) return sum;  // all lights are meshes without an area
    // One number chooses all lights: (k + u)/n for k from 0 to n − 1, so that each share of 1/n of all power
    // gets one ray, and each light n times its share on average.
    const double u = pairs.next().x;
    for (std::uint32_t k = 0; k < rays; ++k) {
      const auto [index, probability, rest] = lights.by_power().choose((k + u) / rays);
      sum += all[index].light_by_ray(at, scene, pairs.next(), 1 / (rays * probability));
    }
    return sum;
  }

  /// Returns an estimate of the light that the glossy lobe reflects, by a direction that it draws: the share
  /// of area lights that rays to them leave to it, and all of the sky and of other surfaces with an emission.
  [[nodiscard]] Color light_along_lobe(const Reflector& at, const auto& scene, const Uv& numbers) const {
    const Bounce drawn = at.glossy->sample(numbers.x, numbers.y);
    if (!drawn.goes_on()) return Color{0};
    const Ray ray = at.hit.leave(drawn.direction);
    return follow(
        ray, scene, [&] { return clamped(drawn.weight * background(ray, scene)); },
        [&](const Intersection& seen) {
          const Color& emission = seen.material().emission;
          if (is_black(emission)) return Color{0};
          return times(clamped(drawn.weight * emission),
                       power_heuristic(drawn.weighed_density, density_by_lights(ray.origin, seen)));
        });
  }

  /// Returns the density with which rays to lights draw the direction from a point to a hit.
  [[nodiscard]] double density_by_lights(const Point& from, const Intersection& seen) const {
    const auto [density, probability] = lights.drawn(from, seen);
    const auto rays = static_cast<std::size_t>(most_rays);
    return lights.lights().size() <= rays ? density : density * most_rays * probability;
  }

  /// The numbers of a sampler from set 1 on, two at a time.
  template <class Sampler>
  class Pairs {
   public:
    explicit Pairs(const Sampler& sampler) : sampler_(sampler) {}
    Uv next() {
      if (is_second_ = !is_second_; is_second_) return {numbers_[2], numbers_[3]};
      numbers_ = sampler_(++set_);
      return {numbers_[0], numbers_[1]};
    }

   private:
    const Sampler& sampler_;
    std::uint32_t set_ = 0;
    bool is_second_ = true;
    SampleSet<double> numbers_{};
  };
};

}  // namespace protostar::inline PROTOSTAR_ABI

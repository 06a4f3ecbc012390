// Shows all light between lights and the eye, by paths that are drawn by chance (Kajiya 1986).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "../area_lights.hpp"
#include "../environment_light.hpp"
#include "../light_at_hit.hpp"
#include "../lobes.hpp"
#include "../render.hpp"
#include "../sampling/sampler.hpp"
#include "../sampling/solid_angle.hpp"
#include "../simd/simd.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of all light: the radiance of a hit is its emission, and the light from everywhere that its
/// material sends back along the ray, which in turn is the radiance of what is seen there,
///   L = L_e + ∫ (ρ/π + f) L cos θ dω + reflect · L(mirrored) + refract · (F L(mirrored) + (1 − F)
///   L(refracted)),
/// with the color as the albedo ρ, the glossy lobe f, and Fresnel's share F. The sky, or black, if there is
/// no hit.
///
/// A path from the eye follows one of these terms at each vertex, chosen by chance. In the integral, the
/// light of area lights is found by a ray to one of them, as by DirectIntegrator: directions drawn to a light
/// by solid angle vary less on matte surfaces than a mixture with those that the surface draws, and take a
/// ray less. If the path meets that light next, it is not counted again. An environment that is not of one
/// color is a light like these. Glossy lobes reflect both the light that rays find and the light that the
/// path meets, weighed by how likely each way was to find it (light_at_hit.hpp). Lights at points or in
/// directions light matte and glossy surfaces, as in DirectIntegrator; all other light, of a sky of one color
/// and of surfaces that are no AreaLights, is found by the path itself.
///
/// The estimate is unbiased up to the depth. Without glossy lobes, and if the shares of each material add up
/// to at most 1, no path weighs more than 1. Rays to lights have weights without such a bound, as lights are
/// chosen by their power.
struct PathIntegrator : FirstHit<PathIntegrator> {
  using FollowsPaths = PathIntegrator;  ///< those of several pixels together (accel/packet_integrator.hpp)

  /// Largest depth. It bounds the time of a sample, and the coordinates of points (most_t).
  static constexpr int most_depth = 1000;

  /// Number of bounces after which Russian roulette ends paths by chance. Those that go on get the weight of
  /// those that end, so that no light is lost on average.
  static constexpr int sure_bounces = 3;

  AreaLights lights;
  EnvironmentLight environment;

  /// Largest number of bounces between light and eye, from 0 to most_depth: 0 shows emission alone, 1 adds
  /// what DirectIntegrator shows, if there are no mirrors, and the light of the sky and of surfaces that are
  /// no AreaLights. A path that is cut adds nothing.
  int depth = 100;

  /// Largest number of rays from a vertex to lights at points or in directions; of more lights, as many are
  /// drawn. One more ray is for an area light, chosen with a probability in proportion to its power.
  int most_rays = 16;

  /// Prepares the lights of a scene; pictures of that scene can then be drawn.
  template <Surface... S>
  explicit PathIntegrator(const Scene<S...>& scene) : lights(scene), environment(scene) {}

  /// Throws std::invalid_argument if depth or most_rays is not in its range. render calls it.
  void validate() const {
    if (depth < 0 || depth > most_depth) [[unlikely]]
      throw std::invalid_argument("PathIntegrator: depth must be from 0 to " + std::to_string(most_depth) +
                                  "; it is " + std::to_string(depth));
    if (most_rays < 1) [[unlikely]]
      throw std::invalid_argument("PathIntegrator: most_rays must be at least 1; it is " +
                                  std::to_string(most_rays));
  }

  /// Path on its way from the eye: the light that it has found, and the ray on which it goes on.
  struct Path {
    Color sum{0}, weight{1};
    double most_weight = 0;  ///< largest channel of the weight at bounce sure_bounces, for Russian roulette
    int bounces = 0;
    Ray ray;
    double weighed_density = std::numeric_limits<double>::infinity();  ///< of the bounce before its ray

    /// Returns true for the camera's ray, and one that a mirror or glass has sent on: light is found by it
    /// alone.
    [[nodiscard]] bool is_sharp() const { return weighed_density == std::numeric_limits<double>::infinity(); }

    /// Returns the set of numbers that it takes at its next vertex.
    [[nodiscard]] std::uint32_t set() const { return static_cast<std::uint32_t>(1 + bounces); }
  };

  /// Direction to a light, if one has been drawn together with those of other paths (draw_to_lights).
  using ToLight = std::optional<LightSample>;

  /// Numbers of a set, and the local direction of cosine_hemisphere to which the first two lead.
  struct Numbers : SampleSet<double> {
    Vec3 hemisphere;
    const LightSample* to_light = nullptr;  ///< direction to the light that they choose; null: not drawn yet
    Numbers(const SampleSet<double>& set, const Vec3& direction)
        : SampleSet<double>(set), hemisphere(direction) {}
    explicit Numbers(const SampleSet<double>& set)
        : Numbers(set, cosine_hemisphere(set[0], set[1]).direction) {}
  };

  /// Takes set 1 of the sampler at the hit, and the next set at each further vertex: two numbers for the
  /// direction and two for the light, of which the first also decides how the path goes on. Throws
  /// std::logic_error if the scene is not the one of the lights, or has another environment.
  [[nodiscard]] Color shade(const Intersection& first, const auto& scene, const auto& sampler) const {
    require(scene);
    Path path;
    const auto draw = [&] { return Numbers(sampler(path.set())); };
    bool goes_on = meet(path, first, scene, draw);
    while (goes_on) {
      const auto hit = scene.intersect(path.ray, Interval{});
      if (!hit) return leave(path, scene);
      goes_on = meet(path, *hit, scene, draw);
    }
    return path.sum;
  }

  /// Throws std::logic_error if the scene is not the one of the lights, or has another environment.
  void require(const auto& scene) const {
    lights.require(scene);
    environment.require(scene);
  }

  /// Draws directions to lights for some paths at once, as many as there are lanes or fewer: those to each
  /// rectangle to which two or more of the paths cast rays. path(k) and hit(k) are the k-th path and its next
  /// hit, u[k] and v[k] the third and fourth number of its set; drawn[k] gets the direction, if one is drawn.
  void draw_to_lights(std::size_t count, const auto& path, const auto& hit, const double* u, const double* v,
                      std::span<ToLight> drawn) const {
    if (!lights.has_rectangles()) return;
    std::array<ChosenLight, simd::double_lanes> chosen;
    for (std::size_t k = 0; k < count; ++k)
      if (path(k).bounces < depth && reflects_light(hit(k).material())) chosen[k] = choose_light(u[k]);
    for (std::size_t first = 0; first < count; ++first) {
      const AreaLight* const light = chosen[first].area;
      if (light == nullptr || light->rectangle() == nullptr) continue;
      std::array<std::size_t, simd::double_lanes> which;
      std::array<Point, simd::double_lanes> from;
      std::array<LightSample, simd::double_lanes> samples;
      FewNumbers rest{}, other{};
      std::size_t some = 0;
      for (std::size_t k = first; k < count; ++k)
        if (chosen[k].area == light) {
          from[some] = hit(k).point(), rest[some] = chosen[k].rest, other[some] = v[k];
          which[some++] = k;
          chosen[k].area = nullptr;
        }
      if (some < 2) continue;
      RectangleView::sample_each(*light->rectangle(), {from.data(), some}, rest, other, samples);
      for (std::size_t i = 0; i < some; ++i) drawn[which[i]] = samples[i];
    }
  }

  /// Adds the light that a path finds at a hit to path.sum, and chooses how it goes on from there, along
  /// path.ray; returns false if the path ends. draw() returns the Numbers of path.set(), and is called at
  /// most once, only if light is scattered.
  [[nodiscard]] bool meet(Path& path, const Intersection& hit, const auto& scene, const auto& draw) const {
    const Material& material = hit.material();
    if (!is_black(material.emission)) {
      if (const double share =
              path.is_sharp() ? 1 : power_heuristic(path.weighed_density, density_by_lights(path.ray, hit));
          share > 0)
        path.sum = clamped(path.sum + times(clamped(path.weight * material.emission), share));
      if (!scatters(material)) return false;  // as most lamps
    }
    if (path.bounces >= depth) return false;

    const Numbers numbers = draw();
    const Color albedo = hit.color();
    Reflector at(hit, albedo);
    const LobeShares shares(material, albedo, at);
    if (at.glossy) at.glossy_probability = shares.glossy / shares.whole();
    if (at.reflects() && has_light(scene)) {
      const ReflectedLight light = light_at(at, scene, numbers);
      Color reflected = clamped(albedo * light.matte);
      if (at.glossy) reflected = clamped(reflected + light.glossy);
      path.sum = clamped(path.sum + clamped(path.weight * reflected));
    }

    double number = numbers[2];
    const Bounce onward = scatter(material, albedo, at, shares, numbers, number);
    if (!onward.goes_on()) return false;
    if (path.bounces == sure_bounces) path.most_weight = largest(path.weight);
    path.weight = clamped(path.weight * onward.weight);
    if (path.bounces >= sure_bounces && !survives(path.weight, path.most_weight, number)) return false;
    path.weighed_density = onward.weighed_density;
    at.leave(onward.direction, path.ray);
    ++path.bounces;
    return true;
  }

  /// Returns the light of a path whose ray hits nothing.
  [[nodiscard]] Color leave(const Path& path, const auto& scene) const {
    const Color sky = clamped(path.weight * background(path.ray, scene));
    return clamped(path.sum + times(sky, power_heuristic(path.weighed_density, density_by_lights(path.ray))));
  }

 private:
  /// Returns true if there are area lights to which rays are cast.
  [[nodiscard]] bool has_area_lights() const { return lights.by_power().whole() > 0; }

  /// Choice of the light to which a ray leads.
  struct ChosenLight {
    const AreaLight* area = nullptr;  ///< null: the environment, or none if the probability is 0
    double probability = 0;
    double rest = 0;  ///< number in [0, 1) for a direction to the light
  };

  /// Chooses an area light or the environment by the third number of a set.
  [[nodiscard]] ChosenLight choose_light(double number) const {
    const double share = 1 - share_of_environment();
    if (share < 1 && !decide(number, share)) return {nullptr, 1 - share, number};
    if (!has_area_lights()) return {};
    const auto [index, probability, rest] = lights.by_power().choose(number);
    return {&lights.lights()[index], probability * share, rest};
  }

  /// Returns true if a material may reflect light from directions that are drawn to lights.
  [[nodiscard]] static bool reflects_light(const Material& material) {
    return material.texture || !is_black(material.diffuse) || !is_black(material.glossy);
  }
  /// Returns true if a path may go on from a material.
  [[nodiscard]] static bool scatters(const Material& material) {
    return reflects_light(material) || material.reflect > 0 || material.refract > 0;
  }

  /// Returns true if light_at may find any light.
  [[nodiscard]] bool has_light(const auto& scene) const {
    return has_area_lights() || !scene.lights().empty() || environment.has_places() ||
           !is_black(ambient_of(scene));
  }

  /// Returns the probability that a ray to a light is one to the environment, and not to an area light. A sky
  /// of one color gets none: directions drawn by the surfaces find it as well.
  [[nodiscard]] double share_of_environment() const {
    if (!environment.has_places()) return 0;
    return has_area_lights() ? 0.5 : 1;
  }

  /// Returns the density with which rays to lights draw the direction of a ray that hits a surface, or
  /// nothing.
  [[nodiscard]] double density_by_lights(const Ray& ray, const Intersection& hit) const {
    const auto [drawn, probability] = lights.drawn(ray.origin, hit);
    return drawn * probability * (1 - share_of_environment());
  }
  [[nodiscard]] double density_by_lights(const Ray& ray) const {
    if (!environment.has_places()) return 0;
    return share_of_environment() * environment.density(ray.direction);
  }

  /// Returns an estimate of the light that a hit reflects of ambient light, of lights at points or in
  /// directions, of an area light or of the environment, if they are not occluded.
  [[nodiscard]] ReflectedLight light_at(const Reflector& at, const auto& scene,
                                        const Numbers& numbers) const {
    ReflectedLight light{ambient_of(scene)};
    const std::vector<Light>& all = scene.lights();
    if (const auto rays = static_cast<std::size_t>(most_rays); all.size() <= rays) {
      for (const Light& one : all) light += at.light_of(one, scene);
    } else {
      // One number chooses all: each share of 1/rays of the lights gets a ray.
      const double step = static_cast<double>(all.size()) / most_rays;
      for (int k = 0; k < most_rays; ++k) {
        const auto i = static_cast<std::size_t>((k + numbers[2]) * step);
        light += at.light_of(all[std::min(i, all.size() - 1)], scene) * to_float(step);
      }
    }
    light.matte = clamped(light.matte) * to_float(1 / std::numbers::pi);
    const auto [area, probability, rest] = choose_light(numbers[2]);
    if (area != nullptr) {
      light += area->light_by_ray(at, scene, {rest, numbers[3]}, 1 / probability, numbers.to_light);
    } else if (probability > 0) {
      const auto drawn = environment.sample(rest, numbers[3]);
      const Ray ray = at.leave(drawn.direction);
      light += at.light_by_ray(drawn.direction, drawn.density, 1 / probability, [&] {
        return scene.occluded(ray, Interval{}) ? Color{0} : background(ray, scene);
      });
    }
    light.matte = clamped(light.matte);
    return light;
  }

  enum class Lobe { diffuse, glossy, mirror, glass };

  /// Shares of light that a material's lobes send back (their share()), as weights for the choice of a lobe.
  struct LobeShares {
    double diffuse, glossy, mirror, glass;

    LobeShares(const Material& material, const Color& albedo, const Reflector& at)
        : diffuse(DiffuseLobe{albedo}.share()),
          glossy(at.glossy ? at.glossy->share() : 0),
          mirror(MirrorLobe{to_float(material.reflect)}.share()),
          glass(GlassLobe{to_float(material.refract), material.ior}.share()) {}

    [[nodiscard]] double sharp() const { return mirror + glass; }
    [[nodiscard]] double whole() const { return diffuse + glossy + sharp(); }

    struct Choice {
      Lobe lobe;
      double share;
    };

    /// Chooses a lobe, with a probability in proportion to its share. Precondition: there is any.
    [[nodiscard]] Choice choose(double& number) const {
      if (diffuse == whole()) return {Lobe::diffuse, diffuse};  // the number stays as it is
      if (decide(number, diffuse / whole())) return {Lobe::diffuse, diffuse};
      if (glossy > 0 && decide(number, glossy / (glossy + sharp()))) return {Lobe::glossy, glossy};
      if (decide(number, mirror / sharp())) return {Lobe::mirror, mirror};
      return {Lobe::glass, glass};
    }
  };

  /// Chooses one of the material's lobes and draws a direction by it. A path does not go on if the material
  /// scatters no light, or the direction leads into the surface.
  [[nodiscard]] static Bounce scatter(const Material& material, const Color& albedo, const Reflector& at,
                                      const LobeShares& shares, const Numbers& numbers, double& number) {
    const double whole = shares.whole();
    if (!(whole > 0)) return {};
    const auto [lobe, share] = shares.choose(number);
    Bounce onward = lobe == Lobe::diffuse  ? DiffuseLobe{albedo}.along(at.vertex, numbers.hemisphere)
                    : lobe == Lobe::glossy ? at.glossy->sample(numbers[0], numbers[1])
                    : lobe == Lobe::mirror
                        ? MirrorLobe{to_float(material.reflect)}.sample(at.vertex)
                        : GlassLobe{to_float(material.refract), material.ior}.sample(at.vertex, number);
    if (lobe == Lobe::glossy) onward.weighed_density *= share / whole;
    if (share != whole) onward.weight = times(onward.weight, whole / share);
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

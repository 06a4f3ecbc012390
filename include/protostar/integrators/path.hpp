// Shows all light between lights and the eye, by paths that are drawn by chance (Kajiya 1986).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
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
#include "../path_vertex.hpp"
#include "../render.hpp"
#include "../sampling/sampler.hpp"
#include "../sampling/solid_angle.hpp"
#include "../simd/simd.hpp"
#include "../uninitialized.hpp"

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
  /// Say that the integrator follows paths of several pixels together, and lets several of them meet their
  /// hits at once (accel/packet_integrator.hpp). Both name its own type.
  using FollowsPaths = PathIntegrator;
  using MeetsTogether = PathIntegrator;

  /// Largest depth. It bounds the time of a sample, and the coordinates of points (most_t).
  static constexpr int most_depth = 1000;

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
    double first_weight = 0;  ///< largest channel of the weight after the first bounce
    int bounces = 0;
    Ray ray;
    double weighed_density = std::numeric_limits<double>::infinity();  ///< of the bounce before its ray

    /// Returns true for the camera's ray, and one that a mirror or glass has sent on: light is found by it
    /// alone.
    [[nodiscard]] bool is_sharp() const { return weighed_density == std::numeric_limits<double>::infinity(); }

    /// Returns the set of numbers that it takes at its next vertex.
    [[nodiscard]] std::uint32_t set() const { return static_cast<std::uint32_t>(1 + bounces); }
  };

  using Numbers = detail::VertexNumbers;

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

  /// Returns the share of its weight after the first bounce down to which a path goes on for sure. Below it,
  /// Russian roulette ends paths by chance, and those that go on get the weight of those that end, so that no
  /// light is lost on average. It is less without lights that vertices find (has_light): a path then
  /// brings most of its light at its end. Both shares are choices, on which noise alone depends.
  [[nodiscard]] double sure_share(const auto& scene) const { return has_light(scene) ? 0.5 : 0.25; }

  /// Throws std::logic_error if the scene is not the one of the lights, or has another environment.
  void require(const auto& scene) const {
    lights.require(scene);
    environment.require(scene);
  }

  /// Adds the light that a path finds at a hit to path.sum, and chooses how it goes on from there, along
  /// path.ray; returns false if the path ends. draw() returns the Numbers of path.set(), and is called at
  /// most once, only if light is scattered.
  [[nodiscard]] bool meet(Path& path, const Intersection& hit, const auto& scene, const auto& draw) const {
    if (!arrive(path, hit)) return false;
    PathVertex vertex(hit, draw);
    vertex.chosen = choose_light(vertex);
    Color radiance{0};
    if (Ray to_light; vertex.aim(&to_light))
      radiance = follow(
          to_light, scene, [] { return Color{0}; },
          [&](const Intersection& seen) { return vertex.shown_by(seen); });
    return go_on(path, vertex, scene, radiance);
  }

  /// Lets `count` paths meet their hits: path(k) as by meet(path(k), hit(k), scene, draw), whose result
  /// becomes goes_on[k], with numbers(k) as the result of draw(). Directions to a rectangle are drawn
  /// together, and rays to area lights are traced together, as many as there are lanes.
  void meet_each(std::size_t count, const auto& path, const auto& hit, const auto& numbers, const auto& scene,
                 std::span<bool> goes_on) const {
    // Not all vertices cast a ray: those of many paths fill the lanes. Without lights they need not wait.
    const std::size_t some = has_area_lights() ? most_vertices : lanes;
    for (std::size_t first = 0; first < count; first += some)
      meet_some(first, std::min(some, count - first), path, hit, numbers, scene, goes_on);
  }

  /// Returns the light of a path whose ray hits nothing.
  [[nodiscard]] Color leave(const Path& path, const auto& scene) const {
    const Color sky = clamped(path.weight * background(path.ray, scene));
    if (!environment.has_places()) return clamped(path.sum + sky);  // no ray to a light leads there
    return clamped(path.sum + times(sky, power_heuristic(path.weighed_density, density_by_lights(path.ray))));
  }

 private:
  using ChosenLight = detail::ChosenLight;
  using PathVertex = detail::PathVertex;

  /// Lanes, and the largest number of vertices that wait for each other.
  static constexpr std::size_t lanes = simd::double_lanes, most_vertices = 8 * lanes;

  /// Lets `count` paths from `first` on meet their hits as meet_each does, at most most_vertices.
  void meet_some(std::size_t first, std::size_t count, const auto& path, const auto& hit, const auto& numbers,
                 const auto& scene, std::span<bool> goes_on) const {
    Uninitialized<PathVertex, most_vertices> vertices;
    std::array<std::size_t, most_vertices> path_of;  // paths that have the vertices
    std::size_t met = 0;
    for (std::size_t k = first; k < first + count; ++k) {
      goes_on[k] = arrive(path(k), hit(k));
      if (!goes_on[k]) continue;
      PathVertex& vertex = *new (&vertices[met]) PathVertex(hit(k), [&] { return numbers(k); });
      vertex.chosen = choose_light(vertex);
      path_of[met++] = k;
    }
    if (lights.has_rectangles()) draw_to_rectangles(vertices, met);

    Uninitialized<Ray, most_vertices> rays;
    std::array<std::size_t, most_vertices + 1> vertex_of;  // vertices that cast the rays
    std::size_t cast = 0;
    for (std::size_t k = 0; k < met; ++k)
      if (vertices[k].aim(&rays[cast])) vertex_of[cast++] = k;
    Uninitialized<SurfaceCrossing, most_vertices> seen;
    for (std::size_t k = 0; k < cast; k += lanes)
      scene.intersect_each(
          std::min(lanes, cast - k), [&](std::size_t i) -> const Ray& { return rays[k + i]; },
          [&](std::size_t i) { return &seen[k + i]; });

    vertex_of[cast] = met;  // no vertex: the last of its list
    for (std::size_t k = 0, ray = 0; k < met; ++k) {
      const Color radiance = k == vertex_of[ray] ? vertices[k].shown_by(seen[ray++]) : Color{0};
      goes_on[path_of[k]] = go_on(path(path_of[k]), vertices[k], scene, radiance);
    }
  }

  /// Adds the emission of a hit to path.sum. Returns true if the path has a vertex there: the material
  /// scatters light, and the path may have another bounce.
  [[nodiscard]] bool arrive(Path& path, const Intersection& hit) const {
    const Material& material = hit.material();
    if (!is_black(material.emission)) {
      if (const double share =
              path.is_sharp() ? 1 : power_heuristic(path.weighed_density, density_by_lights(path.ray, hit));
          share > 0)
        path.sum = clamped(path.sum + times(clamped(path.weight * material.emission), share));
      if (!scatters(material)) return false;  // as most lamps
    }
    return path.bounces < depth;
  }

  /// Chooses an area light or the environment for a vertex that reflects light, by the third number.
  [[nodiscard]] ChosenLight choose_light(const PathVertex& vertex) const {
    if (!vertex.at.reflects()) return {};
    double number = vertex.numbers[2];
    const double share = 1 - share_of_environment();
    if (share < 1 && !decide(number, share)) return {nullptr, 1 - share, number};
    if (!has_area_lights()) return {};
    const auto [index, probability, rest] = lights.by_power().choose(number);
    return {&lights.lights()[index], probability * share, rest};
  }

  /// Draws directions to rectangles for `count` vertices, as many at once as there are lanes: to each
  /// rectangle that two or more have chosen.
  static void draw_to_rectangles(Uninitialized<PathVertex, most_vertices>& vertices, std::size_t count) {
    for (std::size_t first = 0; first < count; ++first) {
      const AreaLight* const light = vertices[first].chosen.area;
      if (light == nullptr || vertices[first].drawn || light->rectangle() == nullptr) continue;
      std::array<PathVertex*, lanes> which;
      std::array<Point, lanes> from;
      std::array<LightSample, lanes> samples;
      FewNumbers rest{}, other{};
      std::size_t some = 0;
      for (std::size_t k = first; k < count && some < lanes; ++k)
        if (PathVertex& vertex = vertices[k]; vertex.chosen.area == light && !vertex.drawn) {
          from[some] = vertex.hit.point();
          rest[some] = vertex.chosen.rest, other[some] = vertex.numbers[3];
          which[some++] = &vertex;
        }
      if (some < 2) continue;
      RectangleView::sample_each(*light->rectangle(), {from.data(), some}, rest, other, samples);
      for (std::size_t i = 0; i < some; ++i) which[i]->drawn = samples[i];
    }
  }

  /// Adds the light that a vertex reflects to path.sum, and chooses how the path goes on, along path.ray;
  /// returns false if it ends. `radiance` is what the vertex's ray to an area light has found, or black.
  [[nodiscard]] bool go_on(Path& path, const PathVertex& vertex, const auto& scene,
                           const Color& radiance) const {
    const Reflector& at = vertex.at;
    if (at.reflects() && has_light(scene)) {
      const ReflectedLight light = light_at(vertex, scene, radiance);
      Color reflected = clamped(vertex.albedo * light.matte);
      if (at.glossy) reflected = clamped(reflected + light.glossy);
      path.sum = clamped(path.sum + clamped(path.weight * reflected));
    }

    double number = vertex.numbers[2];
    const Bounce onward = vertex.scatter(number);
    if (!onward.goes_on()) return false;
    path.weight = clamped(path.weight * onward.weight);
    if (path.bounces == 0)
      path.first_weight = largest(path.weight);
    else if (!survives(path.weight, sure_share(scene) * path.first_weight, number))
      return false;
    path.weighed_density = onward.weighed_density;
    vertex.hit.leave(onward.direction, path.ray);
    ++path.bounces;
    return true;
  }

  /// Returns true if there are area lights to which rays are cast.
  [[nodiscard]] bool has_area_lights() const { return lights.by_power().whole() > 0; }

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

  /// Returns the density with which rays to area lights draw the direction of a ray that hits a surface.
  [[nodiscard]] double density_by_lights(const Ray& ray, const Intersection& hit) const {
    const auto [drawn, probability] = lights.drawn(ray.origin, hit);
    return drawn * probability * (1 - share_of_environment());
  }
  /// Returns the density with which rays to the environment draw the direction of a ray. Precondition:
  /// environment.has_places().
  [[nodiscard]] double density_by_lights(const Ray& ray) const {
    return share_of_environment() * environment.density(ray.direction);
  }

  /// Returns an estimate of the light that a vertex reflects of ambient light, of lights at points or in
  /// directions, of an area light with the radiance that its ray has found, or of the environment.
  [[nodiscard]] ReflectedLight light_at(const PathVertex& vertex, const auto& scene,
                                        const Color& radiance) const {
    const Reflector& at = vertex.at;
    ReflectedLight light{ambient_of(scene)};
    const std::vector<Light>& all = scene.lights();
    if (const auto rays = static_cast<std::size_t>(most_rays); all.size() <= rays) {
      for (const Light& one : all) light += at.light_of(one, scene);
    } else {
      // One number chooses all: each share of 1/rays of the lights gets a ray.
      const double step = static_cast<double>(all.size()) / most_rays;
      for (int k = 0; k < most_rays; ++k) {
        const auto i = static_cast<std::size_t>((k + vertex.numbers[2]) * step);
        light += at.light_of(all[std::min(i, all.size() - 1)], scene) * to_float(step);
      }
    }
    light.matte = clamped(light.matte) * to_float(1 / std::numbers::pi);
    if (const auto& [area, probability, rest] = vertex.chosen; area != nullptr) {
      light += vertex.share.of(radiance);
    } else if (probability > 0) {
      const auto drawn = environment.sample(rest, vertex.numbers[3]);
      const Ray ray = vertex.hit.leave(drawn.direction);
      light += at.light_by_ray(drawn.direction, drawn.density, 1 / probability, [&] {
        return scene.occluded(ray, Interval{}) ? Color{0} : background(ray, scene);
      });
    }
    light.matte = clamped(light.matte);
    return light;
  }

  /// Russian roulette: a path that weighs less than sure_weight goes on with a probability in proportion to
  /// its weight, and then weighs as much as that.
  [[nodiscard]] static bool survives(Color& weight, double sure_weight, double& number) {
    const double probability = largest(weight) / sure_weight;
    if (probability >= 1) return true;
    if (!decide(number, probability)) return false;
    weight = times(weight, 1 / probability);
    return true;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

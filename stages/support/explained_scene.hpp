// A scene that records what an integrator asks it, for the explanation of a pixel.
//
// The integrator runs on it unchanged, ray by ray, as on the scene itself: it is a Traceable with lights.
// Each query tests all surfaces that the plain path of the library tests, and gives the same answer.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/render.hpp>
#include <protostar/scene.hpp>
#include <utility>
#include <vector>

#include "explanation.hpp"
#include "facts.hpp"

/// Scene for the explanation of a pixel, which borrows the real one.
class ExplainedScene {
 public:
  template <class... S>
  explicit ExplainedScene(const protostar::Scene<S...>& scene)
      : lights_(scene.lights()), ambient_(scene.ambient()), sky_(scene.sky()) {
    (add(scene.template surfaces<S>(), scene.template materials<S>()), ...);
    if (const protostar::Environment& environment = scene.environment())
      environment_ = [this, environment](const protostar::Vec3& direction) {
        const protostar::Color light = environment(direction);
        const protostar::Uv uv = protostar::environment_uv(direction);
        current_->sky.push_back({light, uv, look_up_of(environment, uv)});
        return light;
      };
  }
  ExplainedScene(const ExplainedScene&) = delete;
  ExplainedScene& operator=(const ExplainedScene&) = delete;

  /// Records into a sample from now on.
  void record(RayRecord& all) const { current_ = &all; }

  /// Returns the closest hit. The integrator shades it next, so that what it asks then belongs to this ray.
  std::optional<protostar::Intersection> intersect(const protostar::Ray& ray,
                                                   protostar::Interval range) const;
  bool occluded(const protostar::Ray& ray, protostar::Interval range) const;
  void crossings(const protostar::Ray& ray, protostar::Interval range, const auto& visit) const {
    for (const protostar::Intersection& hit : all_hits(ray, range)) visit(hit);
  }

  /// Traces the ray and shades its hit, and returns to the ray before.
  protostar::Color follow(const protostar::Ray& ray, const auto& background, const auto& shade) const {
    RayRecord& before = *current_;
    const auto hit = intersect(ray, protostar::Interval{});
    RayRecord& own = *current_;
    const protostar::Color radiance = hit ? shade(*hit) : background();
    own.radiance = radiance;
    current_ = &before;
    return radiance;
  }

  const std::vector<protostar::Light>& lights() const {
    current_->asks_lights = true;
    return lights_;
  }
  const protostar::Color& ambient() const { return ambient_; }
  const std::optional<protostar::Color>& sky() const {
    current_->sky.push_back({.radiance = sky_});
    return sky_;
  }
  const protostar::Environment& environment() const { return environment_; }

  /// Returns the lights without a record that they are asked for.
  const std::vector<protostar::Light>& all_lights() const { return lights_; }

  /// Returns the index of a surface by its address in the real scene; the number of surfaces if it is none.
  std::size_t index_of(const void* address) const {
    const auto found = std::find_if(surfaces_.begin(), surfaces_.end(),
                                    [&](const Entry& entry) { return entry.address == address; });
    return static_cast<std::size_t>(found - surfaces_.begin());
  }
  const std::vector<Facts>& facts() const { return facts_; }
  const std::vector<protostar::Bounds>& bounds() const { return bounds_; }

 private:
  /// Surface of the scene, as functions.
  struct Entry {
    const void* address;
    std::function<std::vector<protostar::Crossing>(const protostar::Ray&, protostar::Interval, bool is_first)>
        crossings;
    std::function<Facts(const protostar::Ray&, protostar::Interval, bool is_first)> equation;
    std::function<protostar::SurfaceCrossing(const protostar::Crossing&)> on;
    std::function<Facts(int primitive)> primitive;
  };

  template <class T>
  void add(const protostar::SceneVector<T>& surfaces,
           const protostar::SceneVector<protostar::Material>& materials);

  /// Tests a surface, and records what comes of it.
  const Considered& consider(RayRecord& record, std::size_t surface, bool is_first) const;
  /// Returns a hit of a surface in numbers.
  HitRecord recorded(const protostar::Intersection& hit, std::size_t surface) const;
  RayRecord& begin(RayRecord::Query query, const protostar::Ray& ray, protostar::Interval range) const;
  std::vector<protostar::Intersection> all_hits(const protostar::Ray& ray, protostar::Interval range) const;

  std::vector<Entry> surfaces_;
  std::vector<Facts> facts_;
  std::vector<protostar::Bounds> bounds_;
  const std::vector<protostar::Light>& lights_;  ///< of the real scene, by which AreaLights recognize it
  protostar::Color ambient_;
  std::optional<protostar::Color> sky_;
  protostar::Environment environment_;
  mutable RayRecord* current_ = nullptr;
};

template <class T>
void ExplainedScene::add(const protostar::SceneVector<T>& surfaces,
                         const protostar::SceneVector<protostar::Material>& materials) {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const T& surface = surfaces[i];
    const protostar::Material& material = materials[i];
    surfaces_.push_back(
        {.address = &surface,
         .crossings =
             [&](const protostar::Ray& ray, protostar::Interval range, bool is_first) {
               std::vector<protostar::Crossing> all;
               if (!is_first)
                 protostar::each_crossing(surface, ray, range,
                                          [&](const protostar::Crossing& one) { all.push_back(one); });
               else if (const auto first = protostar::first_crossing(surface, ray, range))
                 all.push_back(*first);
               return all;
             },
         .equation =
             [&](const protostar::Ray& ray, protostar::Interval range, bool is_first) {
               if constexpr (std::same_as<T, protostar::AnySurface>)
                 if (is_first && surface.march_setup()) return march_of(surface, ray, range);
               return equation_of(surface, ray);
             },
         .on = [&](const protostar::Crossing& one) { return protostar::crossing_on(surface, one, material); },
         .primitive = [&](int primitive) { return primitive_of(surface, primitive); }});
    facts_.push_back(facts_of(surface));
    bounds_.push_back(protostar::bounds_of(surface));
  }
}

namespace explaining {

/// Scene of one light alone, in which rays hit nothing: an integrator that shades a hit in it returns the
/// light's share of the radiance, if nothing occludes the light. is_asked tells whether the integrator has
/// asked if anything does.
struct OneLight {
  std::array<protostar::Light, 1> light;
  std::optional<protostar::Color> black = protostar::Color{0};
  mutable bool is_asked = false;

  std::optional<protostar::Intersection> intersect(const protostar::Ray&, protostar::Interval) const {
    return std::nullopt;
  }
  bool occluded(const protostar::Ray&, protostar::Interval) const {
    is_asked = true;
    return false;
  }
  void crossings(const protostar::Ray&, protostar::Interval, const auto&) const {}
  const std::array<protostar::Light, 1>& lights() const { return light; }
  const std::optional<protostar::Color>& sky() const { return black; }
};

/// Returns the index of the first ray to a light among those that follow a hit and are no other light's;
/// empty if there is none.
inline std::optional<std::size_t> shadow_ray_along(const protostar::Vec3& towards, const RayRecord& record) {
  std::size_t i = 0;
  for (const RayRecord& ray : record.rays) {
    const auto is_of = [&](const LightRecord& light) { return light.shadow_ray == i; };
    const std::vector<LightRecord>& before = record.hit->lights;
    if (ray.query == RayRecord::Query::any && ray.ray.direction == towards &&
        std::none_of(before.begin(), before.end(), is_of))
      return i;
    ++i;
  }
  return std::nullopt;
}

/// Adds what a light brings to the hit of a ray, as the integrators compute it, to the lights before it.
/// Integrators ask for lights in their order, so that of several in one direction each has the first ray that
/// is left.
void add_light(RayRecord& record, const protostar::Intersection& hit, const protostar::Light& light,
               const auto& integrator) {
  const protostar::Point point = hit.point();
  const protostar::Vec3 towards = light.towards(point);
  const double height = hit.height(towards);
  LightRecord lit{.towards = towards,
                  .cosine = height / length(towards),
                  .facing = light.perpendicular_irradiance(point),
                  .irradiance = light.received(towards, height),
                  .share = {}};
  bool has_ray = true;
  if constexpr (requires { integrator.shade(hit, OneLight{{light}}); }) {
    const OneLight alone{{light}};
    lit.share = integrator.shade(hit, alone);
    has_ray = alone.is_asked;
  }
  if (has_ray) lit.shadow_ray = shadow_ray_along(towards, record);
  record.hit->lights.push_back(lit);
}

/// Adds the lights of a ray's hit, and of the rays that follow it, after the pixel has been traced.
void add_lights(RayRecord& record, const std::vector<protostar::Light>& lights, const auto& integrator) {
  if (record.crossing && record.asks_lights) {
    // What the surface itself sends out is no light's share.
    protostar::Material unlit = record.hit->material;
    unlit.emission = protostar::Color{0};
    record.crossing->material = &unlit;
    const protostar::Intersection hit(record.ray, *record.crossing);
    for (const protostar::Light& light : lights) add_light(record, hit, light, integrator);
  }
  record.crossing.reset();
  for (RayRecord& ray : record.rays) add_lights(ray, lights, integrator);
}

}  // namespace explaining

/// Sampler of a sample, which records the sets that are taken of it.
class RecordedSampler {
 public:
  explicit RecordedSampler(SampleRecord& sample) : sample_(sample) {}

  protostar::SampleSet<double> operator()(std::uint32_t set) const {
    const protostar::SampleSet<double> numbers = sample_.sampler(set);
    const auto is_same = [&](const auto& taken) { return taken.first == set; };
    if (std::none_of(sample_.sets.begin(), sample_.sets.end(), is_same))
      sample_.sets.emplace_back(set, numbers);
    return numbers;
  }

  const protostar::SampleIndex& index() const { return sample_.sampler.index(); }

 private:
  SampleRecord& sample_;
};

/// Traces the rays of a pixel by the plain path, and records them; the explanation knows the pixel and the
/// size of the picture. radiance(sample) returns the radiance along the ray of a sample. Without a sampler in
/// the options, they take the default.
void explain_function(Explanation& explanation, const protostar::Camera& camera,
                      const std::function<protostar::Color(SampleRecord&)>& radiance,
                      const protostar::RenderOptions& options,
                      const protostar::SamplerChoice& default_sampler);

/// Does so by an integrator in a scene that records its rays.
template <class I>
void explain(Explanation& explanation, const protostar::Camera& camera, const ExplainedScene& scene,
             const I& integrator, const protostar::RenderOptions& options) {
  explanation.is_recorded = true;
  explanation.surfaces = scene.facts();
  explanation.bounds = scene.bounds();
  explanation.lights = scene.all_lights();
  explanation.ambient = scene.ambient();
  if constexpr (requires { integrator.depth; }) explanation.depth = integrator.depth;
  if constexpr (requires { integrator.distance; }) explanation.distance = integrator.distance;
  if constexpr (requires {
                  integrator.lights.by_power();
                  integrator.most_rays;
                }) {
    explanation.most_rays = integrator.most_rays;
    for (const auto& light : integrator.lights.lights())
      explanation.area_lights.push_back({scene.index_of(light.surface()), light.emission()});
  }
  if constexpr (requires { integrator.environment.has_places(); })
    explanation.environment_has_places = integrator.environment.has_places();
  [[maybe_unused]] const auto radiance = protostar::detail::radiance_in(scene, integrator);
  explain_function(
      explanation, camera,
      [&](SampleRecord& sample) {
        scene.record(sample.all);
        protostar::Color light{0};
        // A function may ask for a PixelSampler by its type; its numbers are not recorded.
        if constexpr (protostar::detail::Radiates<I, ExplainedScene, RecordedSampler>)
          light = protostar::detail::radiance_along(sample.ray, integrator, scene, RecordedSampler(sample));
        else
          light = protostar::detail::radiance_of_sample(radiance, sample.ray, sample.sampler);
        explaining::add_lights(sample.all, explanation.lights, integrator);
        return light;
      },
      options, protostar::detail::default_sampler<I, ExplainedScene>(camera));
}

// The library's own types are compiled once (support/explain.cpp).
extern template void ExplainedScene::add(const protostar::SceneVector<protostar::AnySurface>&,
                                         const protostar::SceneVector<protostar::Material>&);
extern template void ExplainedScene::add(const protostar::SceneVector<protostar::Mesh>&,
                                         const protostar::SceneVector<protostar::Material>&);
extern template void ExplainedScene::add(const protostar::SceneVector<protostar::Parallelogram>&,
                                         const protostar::SceneVector<protostar::Material>&);
extern template void ExplainedScene::add(const protostar::SceneVector<protostar::Plane>&,
                                         const protostar::SceneVector<protostar::Material>&);
extern template void ExplainedScene::add(const protostar::SceneVector<protostar::Sphere>&,
                                         const protostar::SceneVector<protostar::Material>&);

extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::BinaryIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::ColorIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::DepthIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::DiffuseIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::NormalIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::ShadowIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::TransparencyIntegrator&, const protostar::RenderOptions&);
extern template void explain(Explanation&, const protostar::Camera&, const ExplainedScene&,
                             const protostar::WhittedIntegrator&, const protostar::RenderOptions&);

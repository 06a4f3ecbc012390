// Scenes for paths, in the library's way and, of two of them, in that of "Ray Tracing in One Weekend"; and a
// view of a scene that counts what paths ask it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <protostar/accel/accelerate.hpp>
#include <protostar/integrators/path.hpp>
#include <protostar/integrators/unoccluded.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <utility>
#include <vector>

#include "scenes/cornell_box.hpp"
#include "scenes/weekend.hpp"
#include "support/random.hpp"
#include "weekend_way.hpp"

namespace bench {

using PathScene = protostar::Scene<protostar::Sphere, protostar::Parallelogram>;

/// A scene that is drawn by paths, at some size.
struct PathWorkload {
  std::string name;
  int width, height;
  protostar::Camera camera;
  PathScene scene;
  int depth;

  /// The true light along a ray, if it is known.
  std::function<protostar::Color(const protostar::Ray&)> truth = {};

  /// True if a few paths bring much of the light, such as through glass to a lamp.
  bool has_rare_light = false;
};

/// Returns the weekend scene with mirrors in place of metal: blurred mirrors of the two ways have different
/// lobes, so the pictures would differ, and with them the errors.
inline PathWorkload weekend_workload() {
  return {"weekend", 80, 45, camera_of_weekend(), weekend_of_mirrors(), 50};
}

inline PathWorkload cornell_workload() {
  return {.name = "Cornell box",
          .width = 50,
          .height = 50,
          .camera = camera_of_cornell_box(),
          .scene = cornell_box(),
          .depth = 50,
          .has_rare_light = true};
}

/// Returns the inside of a sphere whose color is a texture, and which shines. All points of it light each
/// other alike, so the light from each is L_e (1 + ρ/(1 − ⟨ρ⟩)), with the mean ⟨ρ⟩ of the color over the
/// sphere.
inline PathWorkload furnace_workload() {
  using protostar::Color;
  constexpr float emission = 0.25f, mean_red = 0.7f, mean_green = 0.5f, mean_blue = 0.2f;
  const auto color = [](double u, double v) {
    const double wave = 0.3 * std::cos(std::numbers::pi * v) + 0.15 * std::sin(4 * std::numbers::pi * u);
    return Color{mean_red, mean_green + static_cast<float>(wave), mean_blue};
  };
  PathWorkload work{"textured furnace",
                    50,
                    50,
                    protostar::Camera::look_at({0.5, 0.2, -0.4}, {-1, 0.3, 0.5}, {0, 1, 0}, 70),
                    {},
                    protostar::PathIntegrator::most_depth};
  work.scene.add(protostar::Sphere{{0, 0, 0}, 1},
                 protostar::Material{.texture = color, .emission = Color{emission}});
  work.truth = [scene = work.scene, color](const protostar::Ray& ray) {
    const protostar::Uv at = scene.intersect(ray, protostar::Interval{})->uv();
    const Color rho = color(at.x, at.y), rest = Color{1 - mean_red, 1 - mean_green, 1 - mean_blue};
    return emission * (Color{1} + Color{rho.r / rest.r, rho.g / rest.g, rho.b / rest.b});
  };
  return work;
}

/// Returns a floor below 256 small lamps of different strengths, of which none is in front of another, and
/// with paths of one bounce: the truth is that of lamps that nothing hides.
///
/// From a point of the floor, lamps at the distances d and d + 1 along it are seen under angles that differ
/// by more than h/(h² + (d + 1)²), with the height h = 2, and have radii below r/√(h² + d²). For d < 16 and r
/// = .04 the first is the larger.
inline PathWorkload lamps_workload() {
  using protostar::Color;
  PathWorkload work{"256 lamps", 50, 50, protostar::Camera::look_at({0, 1.5, -4}, {0, 0, -2}, {0, 1, 0}, 50),
                    {},          1};
  work.scene.add(protostar::Parallelogram{{-20, 0, -20}, {0, 0, 40}, {40, 0, 0}}, Color{0.8f});
  Random random(256);
  for (int i = 0; i < 256; ++i) {
    const Color light{protostar::Vec3{random.real(3, 90), random.real(3, 90), random.real(3, 90)}};
    work.scene.add(protostar::Sphere{{i % 16 - 7.5, 2, i / 16 - 7.5}, 0.04},
                   protostar::Material{.emission = light});
  }
  const auto scene = std::make_shared<const PathScene>(work.scene);
  work.truth = [scene, truth = protostar::UnoccludedIntegrator(*scene)](const protostar::Ray& ray) {
    return truth.radiance(ray, *scene);
  };
  return work;
}

// ---- The books' way

/// Returns a workload's world for the books' way, its surfaces in a tree or not, and half of the directions
/// of matte surfaces to the lamp and the balls of glass, if there is a lamp.
inline weekend_way::World world_of(const PathWorkload& work, bool has_tree) {
  namespace way = weekend_way;
  const auto vector = [](const auto& v) { return way::vec3(v.x, v.y, v.z); };
  const auto objects = std::make_shared<way::HittableList>(), lights = std::make_shared<way::HittableList>();
  const auto material_of = [&](const protostar::Material& m) {
    if (!protostar::is_black(m.emission)) return way::diffuse_light(vector(m.emission));
    if (m.refract > 0) return way::dielectric(m.ior);
    if (m.reflect > 0) return way::metal(way::vec3{m.reflect}, 0);
    return way::lambertian(vector(m.diffuse));
  };
  const auto add = [&](const std::shared_ptr<way::Hittable>& object, const protostar::Material& m) {
    objects->objects.push_back(object);
    if (!protostar::is_black(m.emission) || m.refract > 0) lights->objects.push_back(object);
  };
  bool has_lamp = false;
  const auto& quads = work.scene.surfaces<protostar::Parallelogram>();
  for (std::size_t i = 0; i < quads.size(); ++i) {
    const protostar::Material& m = work.scene.materials<protostar::Parallelogram>()[i];
    has_lamp = has_lamp || !protostar::is_black(m.emission);
    add(std::make_shared<way::Quad>(vector(quads[i].position), vector(quads[i].edge_u),
                                    vector(quads[i].edge_v), material_of(m)),
        m);
  }
  const auto& balls = work.scene.surfaces<protostar::Sphere>();
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const protostar::Material& m = work.scene.materials<protostar::Sphere>()[i];
    add(std::make_shared<way::Sphere>(vector(balls[i].center), balls[i].radius, material_of(m)), m);
  }
  way::World world{.objects = objects, .lights = nullptr, .has_sky = !has_lamp};
  if (has_lamp) world.lights = lights;
  if (has_tree) world.objects = std::make_shared<way::BvhNode>(objects->objects, 0, objects->objects.size());
  return world;
}

inline weekend_way::Camera weekend_way_camera() {
  return {.from = {13, 2, 3},
          .at = {0, 0, 0},
          .field_of_view = 20,
          .aperture = weekend_aperture(),
          .focus = weekend_focus};
}

inline weekend_way::Camera weekend_way_cornell_camera() {
  return {.from = {278, 278, -800}, .at = {278, 278, 0}, .field_of_view = 40, .aperture = 0, .focus = 10};
}

// ---- Counts

/// Numbers of rays that the paths of a picture asked of their scene, and of work that they left out.
struct PathCounts {
  std::uint64_t vertices = 0;              ///< hits that a path came to
  std::uint64_t in_sky = 0, on_black = 0;  ///< ends of paths: no hit; surfaces that send nothing on
  std::uint64_t light_rays = 0, light_rays_skipped = 0;
  std::uint64_t lobes_skipped = 0;  ///< of surfaces that send light on in several ways, those not followed
  std::uint64_t paths = 0;

  [[nodiscard]] std::uint64_t rays() const { return vertices + in_sky + light_rays; }

  /// Returns the number of paths that ended by chance, or at a surface's edge where a direction led into it.
  [[nodiscard]] std::uint64_t by_chance() const { return paths - in_sky - on_black; }
};

/// View of an accelerated scene that counts. PathIntegrator counts its rays to area lights itself.
class CountedScene {
 public:
  CountedScene(const protostar::Accelerated<PathScene>& scene, PathCounts& counts)
      : scene_(&scene), counts_(&counts), light_rays_(protostar::light_rays.traced) {}

  [[nodiscard]] std::optional<protostar::Intersection> intersect(const protostar::Ray& ray,
                                                                 protostar::Interval range) const {
    auto hit = scene_->intersect(ray, range);
    if (protostar::light_rays.traced != light_rays_) {
      light_rays_ = protostar::light_rays.traced;
      ++counts_->light_rays;
    } else if (!hit) {
      ++counts_->in_sky;
    } else {
      ++counts_->vertices;
      const protostar::Material& m = hit->material();
      const int lobes = int{!protostar::is_black(hit->color())} + int{m.reflect > 0} + 2 * int{m.refract > 0};
      if (lobes == 0)
        ++counts_->on_black;
      else
        counts_->lobes_skipped += static_cast<std::uint64_t>(lobes - 1);
    }
    return hit;
  }
  [[nodiscard]] bool occluded(const protostar::Ray& ray, protostar::Interval range) const {
    return scene_->occluded(ray, range);
  }
  void crossings(const protostar::Ray& ray, protostar::Interval range, auto&& visit) const {
    scene_->crossings(ray, range, visit);
  }
  [[nodiscard]] const std::vector<protostar::Light>& lights() const { return scene_->lights(); }
  [[nodiscard]] const protostar::Color& ambient() const { return scene_->ambient(); }
  [[nodiscard]] const std::optional<protostar::Color>& sky() const { return scene_->sky(); }
  [[nodiscard]] const protostar::Environment& environment() const { return scene_->environment(); }

 private:
  const protostar::Accelerated<PathScene>* scene_;
  PathCounts* counts_;
  mutable std::uint64_t light_rays_;
};

}  // namespace bench

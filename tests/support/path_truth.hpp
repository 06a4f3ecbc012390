// Scenes with light of which each ray's true value is known without sampling, to judge PathIntegrator by.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <protostar/integrators/path.hpp>
#include <protostar/integrators/unoccluded.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <string>
#include <utility>
#include <vector>

#include "light_truth.hpp"
#include "random.hpp"

/// A scene, some rays in it, and the true green light along each of them.
struct PathTruth {
  using Scene = protostar::Scene<protostar::Sphere, protostar::Plane, protostar::AnySurface>;

  /// Makes a scene and, as it is done, puts it in the place where its surfaces stay.
  PathTruth(std::string title, std::function<void(Scene&)> fill, int most_bounces)
      : name(std::move(title)), scene(std::make_unique<Scene>()), depth(most_bounces) {
    fill(*scene);
    integrator = std::make_unique<protostar::PathIntegrator>(*scene);
    integrator->depth = depth;
  }

  void add(const protostar::Ray& ray, double light) { rays.push_back(ray), truths.push_back(light); }

  /// Returns one sample of the light along a ray.
  [[nodiscard]] protostar::Color sample(std::size_t ray, const protostar::SobolSampler& sampler) const {
    return integrator->radiance(rays[ray], *scene, sampler);
  }

  // Bounds of chance. Student's t with 31 degrees of freedom is beyond 10 with a probability of 3e-11, and a
  // number that is nearly normal, as a sum over rays, beyond 6 with 2e-9: among 5000 rays in 30 scenes a
  // false alarm is raised by less than one in 10^6 seeds.
  static constexpr double most_errors_of_ray = 10, most_errors_of_mean = 6;

  /// Compares the light along each ray with the truth.
  [[nodiscard]] LightTruth judge(int samples) const {
    LightTruth light;
    light.allowed_errors = most_errors_of_ray;
    for (std::size_t i = 0; i < rays.size(); ++i)
      light.compare(
          rays[i], [&](const protostar::SobolSampler& sampler) { return sample(i, sampler); }, truths[i],
          samples);
    return light;
  }

  /// Returns true if no ray differs from the truth by more than chance allows, nor their mean.
  [[nodiscard]] static bool is_right(const LightTruth& light) {
    return light.wrong == 0 && std::abs(light.mean_error) <= most_errors_of_mean * std::sqrt(light.variance) +
                                                                 0x1p-20 * light.mean_truth;
  }

  /// Returns the relative bias that is found almost surely, if all rays have it: as many standard errors as
  /// are allowed, and as many again for chance.
  [[nodiscard]] static double detectable_bias(const LightTruth& light) {
    return 2 * most_errors_of_mean * std::sqrt(light.variance) / light.mean_truth;
  }

  std::string name;
  std::unique_ptr<Scene> scene;
  int depth;
  std::unique_ptr<protostar::PathIntegrator> integrator;
  std::vector<protostar::Ray> rays;
  std::vector<double> truths;
};

/// Makes scenes with known light, with so many rays in each.
///
/// Inside of a sphere, light that comes from one point is as bright at all others: a patch dA has the solid
/// angle dA cos θ/r², and both cosines are r/2R, so that cos θ cos θ'/r² = 1/4R². If a point sends out L_e by
/// itself, each bounce adds its albedo ρ times the mean of what was there before:
///   L = L_e + ρ ⟨L_e⟩/(1 − ⟨ρ⟩),   up to d bounces   L_e + ρ ⟨L_e⟩ (1 − ⟨ρ⟩^d)/(1 − ⟨ρ⟩).
/// In a furnace, a closed room of any shape with the same emission and albedo everywhere, L = L_e/(1 − ρ) in
/// all directions. Things in it that only turn light away, white, a mirror or glass, look alike and are
/// invisible. Parallel mirrors give L = (L_a + r_a L_b)/(1 − r_a r_b), and a slab of glass lets (1 − F)/(1 +
/// F) through.
class PathTruths {
 public:
  using Ray = protostar::Ray;
  using Point = protostar::Point;
  using Vec3 = protostar::Vec3;
  using Color = protostar::Color;
  using Material = protostar::Material;
  using Scene = PathTruth::Scene;

  explicit PathTruths(int rays) : rays_(rays) {
    add_spheres();
    add_furnaces();
    add_lamps();
    add_glass_and_mirrors();
    add_glossy();
    add_environment();
  }

  [[nodiscard]] const std::vector<PathTruth>& all() const { return all_; }

 private:
  static constexpr double pi = std::numbers::pi;
  static constexpr int deep = protostar::PathIntegrator::most_depth;

  /// Albedo inside of a sphere, of mean ½: with n_y = cos πv, and another wave in u.
  static double albedo(double u, double v) {
    return 0.5 + 0.3 * std::cos(pi * v) + 0.15 * std::sin(4 * pi * u);
  }

  void add_spheres() {
    const Point center{1, 2, 3};
    const auto textured = [=](Scene& scene, const Color& emission) {
      const auto color = [](double u, double v) {
        return Color{0.9f, static_cast<float>(albedo(u, v)), 0.2f};
      };
      scene.add(protostar::Sphere{center, 2}, Material{.texture = color, .emission = emission});
    };
    // The light of an emission ε and of an irradiance E everywhere, which lends L_e the share ρ E/π.
    const auto add = [&](const char* name, const auto& fill, double epsilon, double E, int depth) {
      PathTruth& truth = all_.emplace_back(name, fill, depth);
      for (int i = 0; i < rays_; ++i) {
        const Ray ray{center + random_.point(1), random_.direction()};
        const auto at = truth.scene->intersect(ray)->uv();
        const double rho = albedo(at.x, at.y), sent = E / pi;
        // The light of E is bounced once before it comes to a place that others see.
        const auto bounced = [](double mean, int bounces) {
          return (1 - std::pow(0.5, bounces)) / 0.5 * mean;
        };
        truth.add(ray, epsilon + rho * (sent + bounced(epsilon, depth) + bounced(0.5 * sent, depth - 1)));
      }
    };
    const auto lamp = [=](Scene& scene) {
      textured(scene, {0.5f, 1, 0.25f});
      scene.add(protostar::AmbientLight{Color{2.5f}});
    };
    add("inside of a textured lamp, 1 bounce", lamp, 1, 2.5, 1);
    add("inside of a textured lamp, 3 bounces", lamp, 1, 2.5, 3);
    add("inside of a textured lamp", lamp, 1, 2.5, deep);
    // Lights in the center: E = Φ/(4π R²) for each.
    const auto lit = [=](int lights) {
      return [=](Scene& scene) {
        textured(scene, Color{0});
        for (int i = 0; i < lights; ++i)
          scene.add(protostar::PointLight{center, Color{static_cast<float>(1 + i % 3)}});
      };
    };
    add("inside of a textured sphere, a light in the center", lit(1), 0, 1 / (16 * pi), deep);
    add("inside of a textured sphere, 60 lights in the center", lit(60), 0, 120 / (16 * pi), deep);
  }

  /// Adds rays from points near the origin in all directions, that all see the same light.
  void add_alike(PathTruth& truth, double light, double size = 0.3) {
    for (int i = 0; i < rays_; ++i) truth.add({random_.point(size), random_.direction()}, light);
  }

  void add_furnaces() {
    const Material warm{.diffuse = Color{0.75f, 0.7f, 0.1f}, .emission = Color{1, 2, 4}};
    const auto box = [=](Scene& scene) { scene.add(protostar::Box{{-2, -1, -1}, {3, 1, 2}}, warm); };
    for (const int depth : {0, 1, 3, 8, deep})
      add_alike(all_.emplace_back("furnace to " + std::to_string(depth) + " bounces", box, depth),
                2 * (1 - std::pow(0.7, depth + 1.0)) / 0.3);

    // A mixture that is chosen from, in a lamp and in a box.
    const Material mixed{.diffuse = Color{0.3f, 0.4f, 0.1f}, .reflect = 0.25, .emission = Color{1}};
    add_alike(all_.emplace_back(
                  "furnace, matte and mirror, a lamp",
                  [=](Scene& scene) {
                    scene.add(protostar::Sphere{{0, 0, 0}, 2}, mixed);
                  },
                  deep),
              1 / 0.35);
    add_alike(all_.emplace_back(
                  "furnace, matte and mirror, no lamp",
                  [=](Scene& scene) { scene.add(protostar::Box{}, mixed); }, deep),
              1 / 0.35);

    // Things that turn light away in a lamp, which hide the lamp from each other.
    const auto things = [](Scene& scene) {
      scene.add(protostar::Sphere{{0, 0, 1.5}, 0.6}, Material{.refract = 1, .ior = 1.5});
      scene.add(protostar::Sphere{{0, 1, 0}, 0.6}, Material{.reflect = 1});
      scene.add(protostar::AnySurface(protostar::Box{{-1, -1.2, -1}, {1, -1, 1}}),
                Material{.diffuse = Color{1}});
      scene.add(protostar::Sphere{{1.2, 0, 0}, 0.6},
                Material{.diffuse = Color{0.25f, 0.3f, 0.25f}, .reflect = 0.3, .refract = 0.4, .ior = 1.3});
    };
    add_alike(all_.emplace_back(
                  "glass, a mirror and white things in a lamp",
                  [=](Scene& scene) {
                    things(scene);
                    scene.add(protostar::Sphere{{0, 0, 0}, 4},
                              Material{.diffuse = Color{0.4f}, .emission = Color{1}});
                  },
                  deep),
              1 / 0.6);
    add_alike(all_.emplace_back(
                  "glass, a mirror and white things under a sky",
                  [=](Scene& scene) {
                    things(scene);
                    scene.set_sky(Color{0.5f});
                  },
                  deep),
              0.5);
    add_trapped();
  }

  /// Adds rays that start inside of a ball of glass, in which a ray meets the surface always at one angle:
  /// either it comes out in the end, or all is reflected each time.
  void add_trapped() {
    PathTruth& truth = all_.emplace_back(
        "inside of a ball of glass under a sky",
        [](Scene& scene) {
          scene.add(protostar::Sphere{{0, 0, 0}, 2}, Material{.refract = 1, .ior = 2});
          scene.set_sky(Color{1});
        },
        60);
    for (int i = 0; i < rays_;) {
      const Ray ray{random_.point(1.1), random_.direction()};
      const double sine = length(cross(ray.origin, ray.direction)) / 2;
      if (std::abs(sine - 0.5) < 0.01) continue;  // almost all is reflected, more often than 60 times
      truth.add(ray, sine < 0.5 ? 1 : 0);
      ++i;
    }
  }

  /// Adds lamps over a plane, whose light is known in closed form.
  void add_lamps() {
    const auto add = [&](const char* name, const auto& fill) {
      const auto plane_and_lamp = [&](Scene& scene) {
        scene.add(protostar::Plane{{0, 1, 0}, 0}, Color{0.5f, 0.8f, 0.25f});
        fill(scene);
      };
      PathTruth& truth = all_.emplace_back(name, plane_and_lamp, 1);
      for (int i = 0; i < rays_; ++i) {
        const Vec3 view{0.1, 1e-3, 0.2};
        const Ray ray{Point{random_.real(-2, 2), 0, random_.real(-2, 2)} + view, -view};
        const auto hit = truth.scene->intersect(ray);
        truth.add(ray, double{protostar::UnoccludedIntegrator(*truth.scene).shade(*hit, *truth.scene).g});
      }
    };
    const auto lamp = [](float light) { return Material{.emission = Color{light}}; };
    const auto of = [=](const auto& surface) { return [=](Scene& scene) { scene.add(surface, lamp(3)); }; };
    add("light of a sphere", of(protostar::Sphere{{0, 2, 0}, 1}));
    add("light of a rectangle", of(protostar::Parallelogram{{-1, 2, -1}, {2, 0, 0}, {0, 0, 1}}));
    add("light of a disk", of(protostar::Disk{{0.5, 1.5, 0}, {0.1, 1, 0.2}, 1}));
    add("light of a triangle", of(protostar::Triangle{{-1, 1, 0}, {2, 2, 0}, {0, 1.5, 2}}));
    add("light of four lamps", [=](Scene& scene) {
      for (int i = 0; i < 4; ++i)
        scene.add(protostar::Sphere{{-6.0 + 4 * i, 4.0 + i, 5}, 0.5 + 0.2 * i},
                  lamp(static_cast<float>(1 + i)));
    });

    // A black wall at an angle α leaves (1 + cos α)/2 of the sky.
    for (const double degrees : {60.0, 135.0}) {
      const double angle = degrees * pi / 180;
      const Vec3 up{std::cos(angle), std::sin(angle), 0};
      PathTruth& truth = all_.emplace_back(
          "sky beside a wall",
          [&](Scene& scene) {
            scene.add(protostar::AnySurface(protostar::Parallelogram{{-10, 0, -10}, {20, 0, 0}, {0, 0, 20}}),
                      Color{0.5f, 0.8f, 0.25f});
            scene.add(protostar::AnySurface(protostar::Parallelogram{{1, 0, -1e6}, 1e6 * up, {0, 0, 2e6}}),
                      Color{0});
            scene.set_sky(Color{1});
          },
          deep);
      const Vec3 view{0, 1e-3, 1e-3};
      for (int i = 0; i < rays_; ++i)
        truth.add({Point{random_.real(-0.9, 0.9), 0, random_.real(-5, 5)} + view, -view},
                  0.8f * (1 + std::cos(angle)) / 2);
    }
  }

  void add_glass_and_mirrors() {
    PathTruth& mirrors = all_.emplace_back(
        "parallel mirrors",
        [](Scene& scene) {
          scene.add(protostar::Plane{{0, 0, 1}, -1}, Material{.reflect = 0.8, .emission = Color{1}});
          scene.add(protostar::Plane{{0, 0, 1}, 1}, Material{.reflect = 0.6, .emission = Color{3}});
        },
        deep);
    for (int i = 0; i < rays_; ++i) {
      const Vec3 direction = random_.direction();
      mirrors.add({random_.point(0.5), direction},
                  (direction.z < 0 ? 1 + 0.8 * 3 : 3 + 0.6 * 1) / (1 - 0.8 * 0.6));
    }

    // A slab before a lamp as large as half of the sky, seen under angles from 0 to 85°.
    PathTruth& slab = all_.emplace_back(
        "slab of glass",
        [](Scene& scene) {
          scene.add(protostar::AnySurface(protostar::Box{{-1e4, -1e4, 0}, {1e4, 1e4, 0.1}}),
                    Material{.refract = 1, .ior = 1.5});
          scene.add(protostar::Plane{{0, 0, 1}, 1}, Material{.emission = Color{1}});
        },
        deep);
    for (int i = 0; i < rays_; ++i) {
      const double before = (i + 0.5) / rays_ * 85 * pi / 180, behind = std::asin(std::sin(before) / 1.5);
      const double across = std::sin(before - behind) / std::sin(before + behind),
                   along = std::tan(before - behind) / std::tan(before + behind);
      const double F = (across * across + along * along) / 2;
      const double turn = random_.real(0, 2 * pi);
      slab.add({{0, 0, -1},
                {std::sin(before) * std::cos(turn), std::sin(before) * std::sin(turn), std::cos(before)}},
               (1 - F) / (1 + F));
    }
  }

  /// Adds a ball in a room of six lamps with a radiance of 1, which reflects the share A of light from
  /// everywhere: the mean weight of its lobe. Added to that is its matte share.
  void add_glossy() {
    const Material varnished{.diffuse = Color{0.3f}, .glossy = Color{0.5f}, .roughness = 0.6};
    PathTruth& truth = all_.emplace_back(
        "glossy ball in a room of lamps",
        [&](Scene& scene) {
          scene.add(protostar::Sphere{{0, 0, 0}, 0.5}, varnished);
          for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
              Vec3 corner{-1}, u{0}, v{0};
              corner[axis] = side, u[(axis + 1) % 3] = 2, v[(axis + 2) % 3] = 2;
              scene.add(protostar::AnySurface(protostar::Parallelogram{corner, u, v}),
                        Material{.emission = Color{1}});
            }
        },
        deep);
    const protostar::GgxLobe lobe{varnished.glossy, varnished.roughness};
    for (int i = 0; i < rays_; ++i) {
      const Vec3 normal = random_.direction(), eye = 0.9 * random_.direction();
      if (dot(normal, eye - 0.5 * normal) < 0.02) {
        --i;
        continue;
      }
      const Vec3 view = protostar::frame_around(normal).local(normalize(eye - 0.5 * normal));
      double sum = 0;
      constexpr int steps = 96;
      for (int k = 0; k < steps * steps; ++k)
        sum += double{lobe.sample(view, (k / steps + 0.5) / steps, (k % steps + 0.5) / steps).weight.g};
      truth.add({eye, 0.5 * normal - eye}, double{varnished.diffuse.g} + sum / (steps * steps));
    }
  }

  /// Adds a ball under an environment with the radiance a + b ω_y: a surface with the normal n reflects ρ (a
  /// + ⅔ b n_y). Another has the radiance (ω_y + ω_y²)², bright above, to which rays are drawn. In Legendre
  /// polynomials of ω_y it is 8/15 + 6/5 P1 + (2/3 + 4/7) P2 + 4/5 P3 + 8/35 P4, and a surface reflects the
  /// shares 1, 2/3, 1/4, 0 and −1/24 of them.
  void add_environment() {
    const auto add = [&](const char* name, const auto& light, const auto& reflected) {
      const auto fill = [=](Scene& scene) {
        scene.add(protostar::Sphere{{0, 0, 0}, 1}, Color{0.8f});
        scene.set_environment(
            [=](double, double v) { return Color{static_cast<float>(light(std::cos(pi * v)))}; });
      };
      PathTruth& truth = all_.emplace_back(name, fill, deep);
      for (int i = 0; i < rays_; ++i) {
        const Vec3 normal = random_.direction();
        truth.add({2.0 * normal, -normal}, double{0.8f} * reflected(normal.y));
      }
    };
    add(
        "ball under an environment", [](double y) { return 1 + 0.9 * y; },
        [](double y) { return 1 + 2 / 3.0 * 0.9 * y; });
    add(
        "ball under a bright zenith", [](double y) { return (y + y * y) * (y + y * y); },
        [](double y) {
          const double s = y * y, p2 = (3 * s - 1) / 2, p4 = (35 * s * s - 30 * s + 3) / 8;
          return 8 / 15.0 + 4 / 5.0 * y + 13 / 42.0 * p2 - p4 / 105;
        });
  }

  int rays_;
  Random random_{23};
  std::vector<PathTruth> all_;
};

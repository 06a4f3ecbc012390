// Light on glossy surfaces, as the integrators find it, against quadrature.
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <protostar/accel/accelerate.hpp>
#include <protostar/environment_light.hpp>
#include <protostar/integrators/direct.hpp>
#include <protostar/integrators/path.hpp>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/light_truth.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

/// Returns a metal of this roughness, with a matte part if asked for.
Material metal(double roughness, float matte_part = 0) {
  return {.diffuse = Color{matte_part}, .glossy = Color{0.9f, 0.6f, 0.3f}, .roughness = roughness};
}

/// Rays to the floor y = 0 at the origin, from a steep and from a grazing view.
const Vec3 views[] = {normalize(Vec3{1, 1.5, 0.2}), normalize(Vec3{-0.3, 0.1, 1})};

/// The floor as seen along a view: what it sends back of light from a direction, in green, by the lobe
/// itself.
struct Floor {
  Material material;
  Vec3 view;
  Frame frame = frame_around({0, 1, 0});

  [[nodiscard]] double reflection(const Vec3& direction) const {
    if (!(direction.y > 0)) return 0;
    const GgxLobe lobe{material.glossy, material.roughness};
    return lobe.reflection(frame.local(view), frame.local(direction)).g +
           material.diffuse.g / std::numbers::pi * direction.y;
  }

  /// Returns the light from a cone of directions in which the radiance is 1, by midpoints.
  [[nodiscard]] double light_of_cone(const Vec3& axis, double cosine, int n = 150) const {
    const Frame around = frame_around(axis);
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        // Rings of equal steps of their angle, as the height over the cone's edge is smooth in it.
        const double angle = std::acos(cosine) * (i + 0.5) / n, turn = 2 * std::numbers::pi * (j + 0.5) / n;
        const double sine = std::sin(angle);
        sum += sine * reflection(around({sine * std::cos(turn), sine * std::sin(turn), std::cos(angle)}));
      }
    return sum * std::acos(cosine) / n * 2 * std::numbers::pi / n;
  }
};

/// Compares the light of the floor by an integrator with its true value; returns the mean square of the
/// error of a mean of `samples`, of the sum over the views.
LightTruth compare_floor(const auto& integrator, const auto& scene, const Material& material,
                         const auto& truth, int samples = 32) {
  LightTruth light;
  for (const Vec3& view : views) {
    const Ray ray{0.01 * view, -view};
    const auto hit = scene.intersect(ray, Interval{});
    REQUIRE(hit);
    REQUIRE(hit->material().glossy == material.glossy);
    light.compare(
        ray, [&](const auto& sampler) { return integrator.shade(*hit, scene, sampler); },
        truth(Floor{material, view}), samples);
  }
  CHECK(light.wrong == 0);
  return light;
}

/// Returns a path integrator of one bounce: direct light alone.
template <Surface... S>
PathIntegrator one_bounce(const Scene<S...>& scene) {
  PathIntegrator path(scene);
  path.depth = 1;
  return path;
}

Material glow(float light) { return {.emission = Color{light}}; }

}  // namespace

TEST_CASE("under a sky of one color a glossy floor has the albedo of its lobe") {
  for (const double roughness : {0.25, 0.6, 1.0}) {
    CAPTURE(roughness);
    Scene<Plane> scene;
    scene.add(Plane{{0, 1, 0}, 0}, metal(roughness));
    scene.set_sky(Color{2});
    // Around the mirror direction, where the lobe is narrow.
    const auto truth = [](const Floor& floor) {
      const Vec3 mirrored{-floor.view.x, floor.view.y, -floor.view.z};
      const Frame around = frame_around(mirrored);
      double sum = 0;
      constexpr int n = 300, m = 100;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) {
          const double s = (i + 0.5) / n, angle = std::numbers::pi * s * s * s;
          const double turn = 2 * std::numbers::pi * (j + 0.5) / m, sine = std::sin(angle);
          sum += sine * 3 * std::numbers::pi * s * s *
                 floor.reflection(around({sine * std::cos(turn), sine * std::sin(turn), std::cos(angle)}));
        }
      return 2 * sum / n * 2 * std::numbers::pi / m;
    };
    compare_floor(DirectIntegrator(scene), scene, metal(roughness), truth);
    compare_floor(one_bounce(scene), scene, metal(roughness), truth);
  }
}

TEST_CASE("a glossy floor reflects a lamp as quadrature says, large or small, by both integrators") {
  struct Row {
    Point center;
    double radius, roughness;
    float matte_part;
  };
  const auto row = GENERATE(Row{{-2, 3, 0}, 1.5, 0.4, 0.5f}, Row{{-20, 30, -4}, 1, 0.15, 0},
                            Row{{0, 2, -1}, 1.9, 0.9, 0.5f}, Row{{-2, 3, 0}, 1.5, 0.2, 0});
  CAPTURE(row.radius, row.roughness, row.matte_part);
  const Material material = metal(row.roughness, row.matte_part);
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  scene.add(Sphere{row.center, row.radius}, glow(3));
  const double sine = row.radius / length(row.center);
  const auto truth = [&](const Floor& floor) {
    return 3 * floor.light_of_cone(normalize(row.center), std::sqrt(1 - sine * sine));
  };
  compare_floor(DirectIntegrator(scene), scene, material, truth);
  compare_floor(one_bounce(scene), scene, material, truth);
}

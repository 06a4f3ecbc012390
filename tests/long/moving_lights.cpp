// Lamps that move while the shutter is open: the light that surfaces get from them, by rays to where they are
// at the time of a ray.
#include <cmath>
#include <cstdint>
#include <protostar/integrators/direct.hpp>
#include <protostar/integrators/path.hpp>
#include <protostar/integrators/unoccluded.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/moving.hpp>
#include <protostar/surfaces/plane.hpp>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/light_truth.hpp"
#include "support/meshes.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

using LampScene = Scene<Plane, AnySurface, Moving<Sphere>, Moving<Mesh>>;

const Material lamp_in_motion{.emission = Color{6, 3, 1.5f}};
const Material floors[] = {
    {.diffuse = Color{0.5f, 0.8f, 0.25f}},
    {.diffuse = Color{0.25f}, .glossy = Color{0.5f}, .roughness = 0.4},
    {.shininess = 20, .glossy = Color{0.5f}, .blur = Blur::phong},
};

LampScene floor_of(const Material& material) {
  LampScene scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  return scene;
}

/// Shapes that light others, each where it is at time 0, and the shape moved by a way.
std::vector<AnySurface> shapes(const Vec3& way) {
  return {Sphere{Point{0.5, 1.5, 0} + way, 0.75},
          Parallelogram{Point{-1, 2, -1} + way, {2, 0.5, 0}, {0.4, 0.3, 1}},
          Disk{Point{0.5, 1.5, 0} + way, {0.1, 1, 0.2}, 1},
          Triangle{Point{-1, 1, 0} + way, Point{2, 2, 0} + way, Point{0, 1.5, 2} + way},
          Mesh(meshes::moved(meshes::box(1), 0.4, Point{0.5, 1, 0} + way))};
}

/// Ray down to the floor, near the lamps.
Ray ray_to_floor(Random& random, double time) {
  const Vec3 view{random.real(-0.2, 0.2), 1e-3, 0.2};
  return {
      .origin = Point{random.real(-2, 2), 0, random.real(-2, 2)} + view, .direction = -view, .time = time};
}

}  // namespace

TEST_CASE("a lamp in motion lights a floor as one at rest does where it is at the time of the ray") {
  // Points are moved with a rounding of 2^-52, which the light follows: 2^-16 is ample. A ray that meets the
  // edge of a lamp may go past it, and makes all the difference, with a probability of about 2^-45.
  Random random(4);
  const Vec3 velocity{1.5, 0.25, -1};
  WrongCases wrong(random);
  int lit = 0;
  for (const Material& material : floors)
    for (std::size_t k = 0; k < 5; ++k)
      for (int i = 0; i < 25; ++i) {
        const Shutter during{0.25, 2};
        const double time = random.real(0, 2.5), when = during.nearest(time);
        LampScene moving = floor_of(material), held = floor_of(material), still = floor_of(material);
        held.add(AnySurface(Moving<>(shapes(Vec3{0})[k], velocity, during)), lamp_in_motion);
        const AnySurface shape = shapes(Vec3{0})[k];
        if (const Sphere* const sphere = shape.target<Sphere>())
          moving.add(Moving<Sphere>(*sphere, velocity, during), lamp_in_motion);
        else if (const Mesh* const mesh = shape.target<Mesh>())
          moving.add(Moving<Mesh>(*mesh, velocity, during), lamp_in_motion);
        else if (const Disk* const disk = shape.target<Disk>())
          moving.add(AnySurface(Moving<Disk>(*disk, velocity, during)), lamp_in_motion);
        else
          moving.add(AnySurface(Moving<>(shape, velocity, during)), lamp_in_motion);
        still.add(shapes(when * velocity)[k], lamp_in_motion);

        const Ray ray = ray_to_floor(random, time);
        const SobolSampler sampler(
            {.seed = 3, .x = static_cast<std::uint32_t>(i), .sample = 1, .samples = 16});
        const auto compare = [&](const auto& light_in) {
          const double in_motion = light_in(moving).g, as_held = light_in(held).g,
                       at_rest = light_in(still).g;
          lit += at_rest > 0;
          const double allowed = 0x1p-16 * at_rest;
          wrong.add(!(std::abs(in_motion - at_rest) <= allowed && std::abs(as_held - at_rest) <= allowed),
                    "shape", k, "time", time, ray.origin, in_motion, as_held, at_rest);
        };
        const auto hit_in = [&](const LampScene& scene) { return scene.intersect(ray, Interval{}).value(); };
        if (hit_in(still).t != 1) continue;  // a lamp before the floor
        compare([&](const LampScene& scene) {
          return DirectIntegrator(scene).shade(hit_in(scene), scene, sampler);
        });
        compare([&](const LampScene& scene) {
          return PathIntegrator(scene).shade(hit_in(scene), scene, sampler);
        });
        compare(
            [&](const LampScene& scene) { return UnoccludedIntegrator(scene).shade(hit_in(scene), scene); });
      }
  CHECK(wrong == 0);
  CHECK(lit > 600);
}

TEST_CASE("the light of a lamp in motion is the mean over the times of its light at rest") {
  Random random(5);
  const Vec3 velocity{3, 0.5, -1};
  for (const bool by_paths : {false, true}) {
    LightTruth truth;
    LampScene moving = floor_of(floors[0]);
    moving.add(Moving<Sphere>({{-1, 1.5, 0}, 0.75}, velocity), lamp_in_motion);
    const DirectIntegrator direct(moving);
    const PathIntegrator path(moving);
    for (int i = 0; i < 12; ++i) {
      const Ray ray = ray_to_floor(random, 0);
      // The closed form is smooth in the time, as the lamp is above the horizon: the rule of midpoints is off
      // by its second derivative over 24 n², less than 2^-20 of it.
      double sum = 0;
      constexpr int n = 400;
      for (int k = 0; k < n; ++k) {
        LampScene still = floor_of(floors[0]);
        still.add(AnySurface(Sphere{Point{-1, 1.5, 0} + (k + 0.5) / n * velocity, 0.75}), lamp_in_motion);
        sum += UnoccludedIntegrator(still).shade(still.intersect(ray, Interval{}).value(), still).g / n;
      }
      truth.compare(
          ray,
          [&](const auto& sampler) {
            Ray at_time = ray;
            at_time.time = sampler(set_of_time)[0];
            const Intersection hit = moving.intersect(at_time, Interval{}).value();
            return by_paths ? path.shade(hit, moving, sampler) : direct.shade(hit, moving, sampler);
          },
          sum, 32);
    }
    CHECK(truth.wrong == 0);
    CHECK(truth.detectable_bias() < 0.02);
  }
}

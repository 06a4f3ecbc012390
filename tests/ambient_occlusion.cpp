#include <protostar/integrators/ambient_occlusion.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <protostar/protostar.hpp>
#include <string>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/light_truth.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

constexpr int occlusion_samples = PROTOSTAR_LONG_FORMS ? 1024 : 32;
using OcclusionScene = Scene<Plane, Parallelogram>;

/// Compares the free share over points of the plane y = 0, −0.9 ≤ x ≤ 0.9, with its true value.
void check_free_share(const OcclusionScene& scene, double distance, double share) {
  const AmbientOcclusionIntegrator integrator(distance);
  LightTruth truth;
  Random random(5);
  for (int i = 0; i < 6; ++i) {
    const Vec3 view{0, 1e-3, 1e-3};
    const Ray ray{Point{random.real(-0.9, 0.9), 0, random.real(-5, 5)} + view, -view};
    truth.compare(
        ray, [&](const auto& sampler) { return integrator.radiance(ray, scene, sampler); }, share,
        occlusion_samples);
  }
  CHECK(truth.wrong == 0);
  CHECK(std::abs(truth.mean_error) <=
        LightTruth::most_errors * std::sqrt(truth.variance) + 0x1p-20 * truth.mean_truth);
}

}  // namespace

TEST_CASE("a wall at an angle α to a surface leaves (1 + cos α)/2 of the space over it free") {
  for (const double degrees : {30.0, 60.0, 90.0, 135.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    OcclusionScene scene;
    scene.add(Plane{{0, 1, 0}, 0}, Color{0.5f});
    scene.add(Parallelogram{{1, 0, -1e6}, 1e6 * Vec3{std::cos(angle), std::sin(angle), 0}, {0, 0, 2e6}},
              Color{0.5f});
    check_free_share(scene, std::numeric_limits<double>::infinity(), (1 + std::cos(angle)) / 2);
  }
}

TEST_CASE("a ceiling at the height h leaves (h/d)² free, of what is nearer than d") {
  OcclusionScene scene;
  scene.add(Plane{{0, 1, 0}, 0}, Color{0.5f});
  scene.add(Plane{{0, 1, 0}, 2}, Color{0.5f});
  check_free_share(scene, std::numeric_limits<double>::infinity(), 0);
  check_free_share(scene, 4, 0.25);
  check_free_share(scene, 2.5, 0.64);
  check_free_share(scene, 1.9, 1);
}

TEST_CASE("ambient occlusion refuses a distance that is no number above 0, and shows no hit white") {
  CHECK_NOTHROW(AmbientOcclusionIntegrator{}.validate());
  CHECK_NOTHROW(AmbientOcclusionIntegrator(1e-3).validate());
  CHECK(message_of<std::invalid_argument>([] { AmbientOcclusionIntegrator(-1).validate(); }) ==
        "AmbientOcclusionIntegrator: distance must be greater than 0; it is -1");
  for (const double distance : {0.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS_AS(AmbientOcclusionIntegrator(distance).validate(), std::invalid_argument);
  CHECK(AmbientOcclusionIntegrator{}.radiance(Ray{}, OcclusionScene{}, SobolSampler(SampleIndex{})) ==
        Color{1});
}

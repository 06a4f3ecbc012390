#include <protostar/integrators/path.hpp>

#include <cmath>
#include <cstdint>
#include <protostar/accel/accelerate.hpp>
#include <protostar/protostar.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/path_truth.hpp"
#include "support/pictures.hpp"

using namespace protostar;

TEST_CASE("light by paths is the light that closed forms give, for each ray of each scene") {
  const PathTruths truths(4);
  for (const PathTruth& truth : truths.all()) {
    CAPTURE(truth.name);
    const LightTruth light = truth.judge(16);
    CHECK(light.wrong == 0);
    CHECK(PathTruth::is_right(light));
  }
}

TEST_CASE("a path integrator refuses a depth or a number of rays out of range, and another scene") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 3}, 1}, Material{.emission = Color{1}});
  PathIntegrator path(scene);
  for (const int depth : {0, 1000}) {
    path.depth = depth;
    CHECK_NOTHROW(path.validate());
  }
  path.depth = 1001;
  CHECK(message_of<std::invalid_argument>([&] { path.validate(); }) ==
        "PathIntegrator: depth must be from 0 to 1000; it is 1001");
  path.depth = -1;
  CHECK_THROWS_AS(path.validate(), std::invalid_argument);
  path.depth = 5;
  path.most_rays = 0;
  CHECK(message_of<std::invalid_argument>([&] { path.validate(); }) ==
        "PathIntegrator: most_rays must be at least 1; it is 0");
  const Scene<Sphere> copy = scene;
  const auto hit = copy.intersect({{0, 0, 0}, {0, 0, 1}}, Interval{});
  CHECK_THROWS_AS(path.shade(*hit, copy, SobolSampler(SampleIndex{})), std::logic_error);
}

TEST_CASE("a path takes one set of the sampler at each vertex, from set 1 on") {
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, -1}, Color{1});
  scene.add(Plane{{0, 1, 0}, 1}, Color{1});
  scene.add(Sphere{{0, 0, 5}, 0.5}, Material{.emission = Color{1}});
  const auto hit = scene.intersect({{0, 0, 0}, {0, -1, 0}}, Interval{});
  PathIntegrator path(scene);
  for (const int depth : {0, 1, 4}) {
    path.depth = depth;
    std::vector<std::uint32_t> sets;
    static_cast<void>(path.shade(*hit, scene, [&](std::uint32_t set) {
      sets.push_back(set);
      return SampleSet<double>{0.5, 0.4, 0.3, 0.2};
    }));
    std::vector<std::uint32_t> expected;
    for (int k = 1; k <= depth; ++k) expected.push_back(static_cast<std::uint32_t>(k));
    CHECK(sets == expected);
  }
}

TEST_CASE("a picture by paths has the same bytes by tiles, by any number of threads and with a tree") {
  Scene<Plane, Sphere, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, -1}, Color{0.6f});
  scene.add(Sphere{{0, 0, 4}, 0.7}, Material{.refract = 1});
  scene.add(Sphere{{1.2, -0.4, 4}, 0.6}, Material{.diffuse = Color{0.3f}, .reflect = 0.5});
  scene.add(Sphere{{-1.5, 1, 4}, 0.4}, Material{.emission = Color{3}});
  scene.add(AnySurface(Parallelogram{{1, 1, 3}, {1, 0, 0}, {0, 0.3, 1}}), Material{.emission = Color{2}});
  scene.add(PointLight{{0, 3, 2}, Color{20}});
  scene.set_sky(Color{0.5f});
  const PathIntegrator path(scene);
  const auto camera = Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  RenderOptions options;
  options.samples = 2;
  Image tiled(80, 70), fast(80, 70), plain(80, 70);
  render(tiled, camera, scene, path, options);
  options.threads = 3;
  render(fast, camera, accelerate(scene), path, options);
  options.tiles = false;
  render(plain, camera, scene, path, options);
  CHECK(different_pixels(plain, tiled) == 0);
  CHECK(different_pixels(plain, fast) == 0);
  CHECK(count_pixels(plain, [&](int x, int y) { return x > 0 && plain(x, y) != plain(x - 1, y); }) > 2000);
}

#include <protostar/integrators/path.hpp>
#include <protostar/integrators/whitted.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <memory>
#include <protostar/accel/accelerate.hpp>
#include <protostar/protostar.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/path_truth.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

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

TEST_CASE("a path integrator refuses a scene that was given another environment, by tiles and ray by ray") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 3}, 1}, Color{0.5f});
  const auto of = [](const Color& color) {
    Image image(2, 2);
    image(0, 0) = color;
    return EnvironmentImage{std::make_shared<const Image>(image)};
  };
  const auto error_of = [&](const PathIntegrator& path, bool tiles) {
    const auto of_view = [&](const auto& view) {
      return message_of<std::logic_error>([&] {
        Image image(4, 3);
        render(image, Camera{}, view, path, {.samples = 2, .threads = 1, .tiles = tiles});
      });
    };
    const std::string error = of_view(scene);
    CHECK(of_view(accelerate(scene)) == error);
    return error;
  };
  const std::string changed =
      "EnvironmentLight: the scene has been given another environment since it was made; make it again";
  for (const bool tiles : {false, true}) {
    CAPTURE(tiles);
    const PathIntegrator before(scene);
    scene.set_sky(Color{0.5f});  // found by paths, and no directions are drawn to it
    CHECK(error_of(before, tiles).empty());
    scene.set_environment(of(Color{1}));
    CHECK(error_of(before, tiles) == changed);
    const PathIntegrator after(scene);
    CHECK(error_of(after, tiles).empty());
    scene.set_environment(of(Color{2}));
    CHECK(error_of(after, tiles) == changed);
  }
}

/// Integrator whose paths end at once: the light is t of the first hit to its last digit.
struct RefinedDistance : FirstHit<RefinedDistance> {
  using FollowsPaths = RefinedDistance;
  struct Path {
    Color sum{0};
    Ray ray;
  };
  struct Numbers {
    Numbers(const SampleSet<double>&, const Vec3&) {}
  };

  void require(const auto&) const {}
  [[nodiscard]] Color shade(const Intersection& hit, const auto&, const auto&) const {
    return Color{static_cast<float>(hit.refined())};
  }
  [[nodiscard]] bool meet(Path& path, const Intersection& hit, const auto& scene, const auto& draw) const {
    path.sum = shade(hit, scene, draw);
    return false;
  }
  [[nodiscard]] Color leave(const Path& path, const auto&) const { return path.sum; }
};

TEST_CASE("paths of several pixels begin at the root of the surface at which each begins alone") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 1}, 4}, Color{1});  // around the camera: the second root of its line
  scene.add(Sphere{{0, 0, 3}, 1}, Color{1});
  Image tiles(37, 23), plain(37, 23);
  render(tiles, Camera{}, scene, RefinedDistance{}, {.samples = 2, .threads = 1});
  render(plain, Camera{}, scene, RefinedDistance{}, {.samples = 2, .threads = 1, .tiles = false});
  CHECK(tiles(0, 0).r > 4);
  CHECK(std::abs(tiles(18, 11).r - 2) < 0.01f);
  CHECK(different_pixels(plain, tiles) == 0);
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
  // Without lamps fewer paths meet their hits at once.
  const float lamp = GENERATE(0.0f, 1.0f);
  CAPTURE(lamp);
  scene.add(Sphere{{-1.5, 1, 4}, 0.4}, Material{.emission = Color{3 * lamp}});
  scene.add(AnySurface(Parallelogram{{1, 1, 3}, {1, 0, 0}, {0, 0.3, 1}}),
            Material{.emission = Color{2 * lamp}});
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

/// Compares pictures by tiles and ray by ray of few surfaces, many of which coincide, in an empty scene; with
/// is_full of as many surfaces as are few, and by Whitted's integrator as well.
template <class S>
void compare_few_surfaces(S scene, bool from_afar, bool is_full = false) {
  // Balls of glass and a mirror, around each other, twice in one place, and cut by a floor on which boards
  // lie.
  scene.add(Sphere{Point{0, 0, 4}, 0.8}, Material{.refract = 1});
  scene.add(Sphere{Point{0, 0, 4}, 0.8}, Material{.diffuse = Color{0.1f}, .refract = 0.9});
  scene.add(Sphere{Point{0.1, 0, 4}, 0.5}, Material{.diffuse = Color{0.3f}, .reflect = 0.5});
  scene.add(Sphere{Point{-1.5, -1, 4}, 0.6}, Color{0.7f});
  scene.add(Plane{{0, 1, 0}, -1}, Color{0.6f});
  scene.add(Parallelogram{Point{-1, -1, 3}, {2, 0, 0}, {0, 0, 2}}, Color{0.2f, 0.7f, 0.3f});
  scene.add(Parallelogram{Point{0, -1, 2}, {1, 0, 1}, {-1, 0, 1}}, Color{0.8f, 0.1f, 0.3f});
  // Tilted boards in one plane, and lamps: two rectangles, of which one is tilted, a sheared one and a ball.
  scene.add(Parallelogram{Point{1, -1, 3}, {1, 2, 0}, {0, 0, 2}}, Color{0.5f});
  scene.add(Parallelogram{Point{1.5, 0, 3}, {0.5, 1, 0}, {0, 0, 1}},
            Material{.diffuse = Color{0.9f}, .reflect = 0.1});
  scene.add(Parallelogram{Point{-1, 3, 3}, {2, 0, 0}, {0, 0, 1}}, Material{.emission = Color{4}});
  scene.add(Parallelogram{Point{-3, 0, 3}, {0.6, 0.8, 0}, {0, 0, 2}}, Material{.emission = Color{1, 2, 3}});
  scene.add(Parallelogram{Point{2, 2, 2}, {1, 0, 0}, {0.5, 0.3, 1}}, Material{.emission = Color{2}});
  scene.add(Sphere{Point{-1, 1.5, 4}, 0.2}, Material{.emission = Color{5}});
  if constexpr (std::same_as<S, AnyScene>) {
    // A box of glass on the floor and a board, which its lower side lies in, and a ball in place of another.
    scene.add(AnySurface(Box{Point{-0.9, -1, 2.6}, Point{-0.2, -0.4, 3.4}}),
              Material{.diffuse = Color{0.2f}, .refract = 0.8});
    scene.add(AnySurface(Sphere{Point{0.1, 0, 4}, 0.5}), Material{.diffuse = Color{0.1f}, .refract = 0.5});
  }
  if (is_full) {
    // Pairs of balls in one place, on the floor.
    for (int i = 0; scene.size() < simd::few_surfaces; ++i)
      scene.add(Sphere{Point{-1.6 + 0.45 * (i / 2), -0.8, 2.4}, 0.2},
                Material{.diffuse = i % 2 == 0 ? Color{0.8f, 0.6f, 0.1f} : Color{0.1f, 0.2f, 0.8f},
                         .reflect = 0.3});
    scene.add(PointLight{{0, 3, 2}, Color{20}});
  }
  const PathIntegrator path(scene);
  const Vec3 down{0.1, -0.3, 1};
  const auto camera = from_afar ? Camera::orthographic(Point{0, 0, 4} - 0x1p36 * down, down, {0, 1, 0.3}, 4)
                                : Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  RenderStatistics counts;
  Image tiled(70, 60), plain(70, 60);
  render(tiled, camera, scene, path, {.samples = 3, .statistics = &counts});
  render(plain, camera, scene, path, {.samples = 3, .tiles = false});
  CHECK(different_pixels(plain, tiled) == 0);
  CHECK(count_pixels(plain, [&](int x, int y) { return x > 0 && plain(x, y) != plain(x - 1, y); }) > 2000);
  if (is_full) {
    Image whitted_tiled(70, 60), whitted_plain(70, 60);
    render(whitted_tiled, camera, scene, WhittedIntegrator{});
    render(whitted_plain, camera, scene, WhittedIntegrator{}, {.tiles = false});
    CHECK(different_pixels(whitted_plain, whitted_tiled) == 0);
  }
  if (simd::double_lanes > 2) {
    CHECK(counts.rays_alone < counts.other_rays);
    // Lanes leave each ray in doubt that is tested with the surface that it departs from.
    if (!from_afar) CHECK(counts.in_doubt < counts.other_rays / 2);
  }
}

TEST_CASE(
    "a picture by paths has the same bytes by tiles in a scene of few surfaces, many of which coincide") {
  // Hits of rays from afar have digits that are 2^-16 apart, so that most are certainly off their surfaces,
  // and off those that coincide with them.
  const bool from_afar = GENERATE(false, true);
  compare_few_surfaces(Scene<Sphere, Parallelogram, Plane>(), from_afar);
  compare_few_surfaces(AnyScene(), from_afar);
  compare_few_surfaces(Scene<Sphere, Parallelogram, Plane>(), from_afar, true);
}

TEST_CASE("paths from a box seen from afar do not meet boards that lie in its side, by tiles or ray by ray") {
  // Points of the side are up to 2^-17 off it. A path that leaves one at a small angle would cross the side
  // again, in one of the boards beside it, and be black there.
  AnyScene scene;
  scene.add(AnySurface(Box{Point{-1, -1, -1}, Point{1, 0, 1}}), Color{0.8f});
  for (int i = 0; i < 12; ++i)
    scene.add(Parallelogram{Point{0.04 * i - 0.24, 0, -0.5}, {0.02, 0, 0}, {0, 0, 1}}, Material{});
  scene.set_sky(Color{1});
  PathIntegrator path(scene);
  path.depth = 1;
  const Vec3 down{0.1, -1, 0.3};
  const auto camera = Camera::orthographic(-0x1p36 * down, down, {0, 0.3, 1}, 0.4);
  Image tiled(70, 60), plain(70, 60);
  render(tiled, camera, scene, path, {.samples = 48});
  render(plain, camera, scene, path, {.samples = 48, .tiles = false});
  CHECK(different_pixels(plain, tiled) == 0);
  CHECK(count_pixels(plain, [&](int x, int y) { return plain(x, y) == Color{0.8f}; }) > 1000);
  CHECK(count_pixels(plain, [&](int x, int y) { return plain(x, y) == Color{0}; }) > 1000);
}

TEST_CASE("Russian roulette keeps each path at a share of the weight that it has after its first bounce") {
  const float albedo = 0.75f;
  Scene<AnySurface> scene;
  scene.add(AnySurface(Box{}), Material{.diffuse = Color{albedo, 0.5f, 0.1f}, .emission = Color{1}});
  const PathIntegrator path(scene);
  int longest = 0;
  double mean = 0;
  constexpr int paths = 400;
  for (int i = 0; i < paths; ++i) {
    const SobolSampler numbers({.sample = static_cast<std::uint32_t>(i), .samples = paths});
    int vertices = 0;
    const float light = path.radiance({{0.1, 0.2, 0.3}, {1, 2, 3}}, scene,
                                      [&](std::uint32_t set) {
                                        ++vertices;
                                        return numbers(set);
                                      })
                            .r;
    double expected = 0, weight = 1;
    for (int k = 0; k < vertices; ++k, weight = std::max(weight, path.sure_share(scene)) * albedo)
      expected += weight;
    CHECK(std::abs(light - expected) <= 1e-6 * expected);  // a rounding of float for each vertex
    longest = std::max(longest, vertices);
    mean += light / paths;
  }
  CHECK(longest > 10);
  CHECK(std::abs(mean - 4) < 0.2);
}

TEST_CASE("of more lights than rays, those that get a ray stand for the others") {
  Scene<Plane> scene;
  scene.add(Plane{{0, 1, 0}, 0}, Color{0.5f});
  for (int i = 0; i < 60; ++i) scene.add(PointLight{{0, 2, 0}, Color{1}});
  const auto light = [&](int rays) {
    PathIntegrator path(scene);
    path.most_rays = rays;
    return path.radiance({{0, 1, 0}, {0, -1, 0}}, scene, SobolSampler(SampleIndex{})).g;
  };
  for (const int rays : {1, 7, 16, 59, 60, 100}) CHECK(std::abs(light(rays) / light(60) - 1) < 1e-5);
}

TEST_CASE("mirrors of paths are those of WhittedIntegrator, with normal maps too") {
  Scene<Sphere, Plane> scene;
  const NormalMap tilted([](double u, double v) { return Vec3{std::sin(20 * u), std::cos(30 * v), 1.5}; });
  scene.add(Sphere{{0, 0, 3}, 1}, Material{.normal_map = tilted, .reflect = 0.5, .emission = Color{0.25f}});
  scene.add(Sphere{{1.5, 0.5, 2}, 0.7}, Material{.reflect = 1, .emission = Color{0, 0.5f, 0}});
  scene.add(Plane{{0, 1, 0}, -1}, Material{.reflect = 0.5, .emission = Color{1, 2, 3}});
  scene.set_sky(Color{0.125f});
  PathIntegrator path(scene);
  path.depth = 2;  // the second bounce is sure, as it reflects at least half
  const WhittedIntegrator whitted{.depth = path.depth};
  Random random(9);
  WrongCases wrong(random);
  int compared = 0;
  for (int i = 0; i < 500; ++i) {
    const Ray ray{{0, 0, 0}, normalize(random.point(0.4) + Vec3{0, 0, 1})};
    const Color expected = whitted.radiance(ray, scene),
                light = path.radiance(ray, scene, SobolSampler(SampleIndex{}));
    if (expected != WhittedIntegrator{.depth = 20}.radiance(ray, scene)) continue;  // a path that was cut
    ++compared;
    wrong.add(!(length(light - expected) <= 1e-6f * length(expected)), ray);
  }
  CHECK(wrong == 0);
  CHECK(compared > 200);
}

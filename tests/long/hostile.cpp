// Scenes with hostile numbers: if accepted, they have finite pictures, equal for all ways of rendering, in
// bounded time.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <limits>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz/draw_any_scene.hpp"
#include "fuzz/hostile_numbers.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;
using namespace protostar;

namespace {

const fs::path project = PROTOSTAR_SOURCE_DIR;

/// Returns the scene files in a folder, in the order of their names.
std::vector<fs::path> scenes_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Adds glass spheres inside a large one, which also contains the camera: rays double at every hit.
void add_glass(auto& scene) {
  const Material glass{.reflect = 0.5, .refract = 0.5, .ior = 1.2};
  for (const double z : {3.0, 3.5, 4.0}) scene.add(Sphere{.center = {0.3, 0.2, z}, .radius = 1.5}, glass);
  scene.add(Sphere{.radius = 100}, glass);
}

/// Returns the CPU time of this process in seconds: other processes do not count.
double seconds_of_work() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

TEST_CASE("scenes of extreme numbers have finite pictures, equal by tiles and by rays, in bounded time") {
  // Each scene takes 256 camera rays. The slowest take a few milliseconds each, and twenty times as long
  // under sanitizers; without bounded arithmetic they took hours.
  for (const fs::path& path : scenes_in(project / "tests/hostile")) {
    CAPTURE(path);
    const double begin = seconds_of_work();
    SceneFile file = read_scene_file(path);
    CHECK(faults_of_pictures(file, all_integrators()) == "");
    CHECK(seconds_of_work() - begin < 60);
  }
}

TEST_CASE("scenes with some numbers replaced by hostile ones are refused or drawn correctly") {
  int accepted = 0;
  for (const char* folder : {"tests/hostile", "scenes"}) {
    // The scenes stand next to copies of the files that they name.
    const TemporaryFolder copies;
    fs::copy(project / folder, copies / "scenes");
    for (const fs::path& path : scenes_in(project / folder)) {
      const std::string text = bytes_of(path);
      for (std::uint32_t seed = 0; seed < std::uint32_t{cases(1, 4, 16)}; ++seed) {
        CAPTURE(path, seed);
        put_bytes(copies / "scenes" / "hostile.json", with_hostile_numbers(text, seed, 1 + seed % 4));
        try {
          SceneFile file = read_scene_file(copies / "scenes" / "hostile.json");
          CHECK(faults_of_pictures(file, all_integrators()) == "");
          ++accepted;
        } catch (const std::runtime_error& error) {
          CHECK_THAT(error.what(), ContainsSubstring("hostile.json: /"));  // the message names a place
        }
      }
    }
  }
  CHECK(accepted > cases(8, 35, 150));
}

TEST_CASE("every integrator clamps light to the largest float, or to what sums of samples hold") {
  constexpr float largest = std::numeric_limits<float>::max();
  SceneFile file;
  file.scene.add(Plane{.normal = {0, 0, 1}, .distance = 1e-100},
                 Material{.diffuse = Color{3e38f}, .reflect = 3e38});
  file.scene.add(AmbientLight{Color{1000}});
  file.scene.add(DirectionalLight{.direction = {0, 0, -1}, .intensity = Color{1000}});
  file.scene.set_sky(Color{2e38f});
  // The light of "depth" is the reciprocal of 1e-100.
  for (const std::string integrator : {"depth", "diffuse", "shadow", "transparency", "whitted"})
    for (const bool tiles : {true, false})
      for (const int samples : {0, 3}) {
        CAPTURE(integrator, tiles, samples);
        Image image(9, 2);
        draw(image, file, integrator, RenderOptions{.samples = samples, .threads = 1, .tiles = tiles});
        const float most = samples > 1 ? ExactSum::most : largest;
        CHECK(image(0, 0) == Color{most});
        CHECK(image(8, 1) == Color{most});
      }
  file.scene.add(Sphere{.center = {0, 0, 2}, .radius = 0.5},
                 Material{.refract = 3e38, .emission = Color{3e38f}});
  for (const std::string integrator : {"direct", "path"})
    for (const bool tiles : {true, false}) {
      CAPTURE(integrator, tiles);
      Image image(9, 2);
      draw(image, file, integrator, RenderOptions{.samples = 0, .threads = 1, .tiles = tiles});
      CHECK(image(0, 0) == Color{largest});
      CHECK(image(8, 1) == Color{largest});
    }

  Image bright(1, 1);
  bright(0, 0) = Color{1, largest, 0};
  expose(bright, 2);
  CHECK(bright(0, 0) == Color{2, largest, 0});
}

TEST_CASE("each of several samples is clamped to what sums hold") {
  Image image(1, 1);
  render(image, Camera{}, [](const Ray&) { return Color{3e38f, 1, 0}; }, {.samples = 4});
  CHECK(image(0, 0) == Color{ExactSum::most, 1, 0});
}

TEST_CASE("a normal is finite even where the coordinates of the point do not determine it") {
  const auto is_short = [](const Vec3& n) { return is_finite(n) && length(n) < 4; };
  const Sphere tiny{.center = {0, 0, 1}, .radius = 0x1p-400};
  CHECK(is_short(tiny.normal_at({0, 0, 1 - 0x1p-30})));
  CHECK(is_short(tiny.normal_at({0x1p450, -0x1p450, 0x1p450})));
  CHECK(is_finite(tiny.uv_at(tiny.center)));

  // The cross product of the edges is 1e-400, below the range of double.
  const Triangle sliver{{1, 0, 0}, {1, 1e-200, 0}, {1, 0, 1e-200}};
  CHECK_NOTHROW(sliver.validate());
  CHECK(sliver.normal_at(sliver.a) == Vec3{1, 0, 0});

  // The square of the cross product of the edges is below the range of double.
  const Triangle thin{{0, 0, 0}, {1, 0, 0}, {1, 0x1p-540, 0}};
  CHECK_NOTHROW(thin.validate());
  CHECK(is_finite(thin.uv_at(Point{0.5, 0x1p-542, 0})));
  const Parallelogram thin_board{.edge_v = {1, 0x1p-540, 0}};
  CHECK_NOTHROW(thin_board.validate());
  CHECK(is_finite(thin_board.uv_at(Point{0.5, 0x1p-542, 0})));

  // In the object space of these nested instances the point is beyond the range of double.
  const Affine small = Affine{}.scaled_by(Vec3{0x1p-399});
  const Instance nested(Instance(Instance(Quadric{}, small), small), small);
  CHECK_NOTHROW(nested.validate());
  CHECK(std::abs(length(nested.normal_at({0x1p300, 0x1p300, 0})) - 1) < 1e-15);
  CHECK(is_finite(nested.uv_at({0x1p300, 0x1p300, 0})));
}

TEST_CASE("a hit too far away for finite coordinates is placed at distance 2^440 along its ray") {
  Scene<Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{1});
  const auto hit = scene.intersect({Point{0}, {0, -1e-200, 1}});
  REQUIRE(hit);
  CHECK(hit->t == 1 / 1e-200);
  CHECK(hit->point() == Point{0, -0x1p440 * 1e-200, 0x1p440});
}

TEST_CASE("a render ends with an error if more rays follow one camera ray than are allowed") {
  Scene<Sphere, Plane, Parallelogram> scene;
  add_glass(scene);
  for (const bool tiles : {true, false}) {
    Image image(9, 2);
    const auto draw_to = [&](int depth, std::int64_t most_rays) {
      render(image, Camera{}, scene, WhittedIntegrator{.depth = depth, .most_rays = most_rays},
             {.threads = 1, .tiles = tiles});
    };
    CHECK_NOTHROW(draw_to(8, 255));  // at most 1 + 2 + ... + 128 rays
    CHECK_NOTHROW(draw_to(8, std::numeric_limits<std::int64_t>::max()));
    CHECK_THAT(message_of<std::runtime_error>([&] { draw_to(1000, 10'000); }),
               ContainsSubstring("more than 10000 rays follow one ray of the camera"));
  }
}

TEST_CASE("a scene file whose rays multiply without end is refused by their number in bounded time") {
  SceneFile file;
  add_glass(file.scene);
  file.depth = most_depth;
  Image image(9, 2);
  const double begin = seconds_of_work();
  CHECK_THROWS_AS(draw(image, file, "whitted", RenderOptions{.samples = 64, .threads = 1}),
                  std::runtime_error);
  CHECK(seconds_of_work() - begin < 60);

  // The command line's samples together with many lights.
  for (int i = 0; i < 64; ++i) file.scene.add(PointLight{});
  CHECK_FALSE(refusal_of_samples(1 << 16, 63));
  CHECK_THAT(message_of<std::runtime_error>(
                 [&] { draw(image, file, "shadow", RenderOptions{.samples = 1 << 16, .threads = 1}); }),
             ContainsSubstring("with 64 lights a pixel may take 4259840 rays, and at most 4194304"));
}

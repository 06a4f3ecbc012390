#include <protostar/integrators/direct.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <protostar/accel/accelerate.hpp>
#include <protostar/integrators/unoccluded.hpp>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/light_truth.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

const Material matte{.diffuse = Color{0.5f, 0.8f, 0.25f}};
Material lamp(float light) { return {.emission = Color{2 * light, light, light / 2}}; }

/// For light of which chance hides a large part.
constexpr int many_samples = cases(32, 1024);
constexpr int some_rays = cases(8, 40), some_samples = cases(16, 128);

void check(const LightTruth& truth) {
  CHECK(truth.wrong == 0);
  if (cases(0, 1) == 1) CHECK(truth.detectable_bias() < 0.03);
  CHECK(truth.lit >= truth.rays / 2);
  CHECK(std::abs(truth.mean_error) <=
        LightTruth::most_errors * std::sqrt(truth.variance) + 0x1p-20 * truth.mean_truth);
}

/// Compares the light of points of the plane y = 0, in a square, with the closed form, which is the truth if
/// nothing occludes a light.
void check_on_plane(const auto& scene, double half, int samples = some_samples) {
  const Vec3 view{0.1, 1e-3, 0.2};
  const DirectIntegrator direct(scene);
  const UnoccludedIntegrator unoccluded(scene);
  Random random(3);
  LightTruth truth;
  for (int i = 0; i < some_rays; ++i) {
    const Point at{random.real(-half, half), 0, random.real(-half, half)};
    const Ray ray{at + view, -view};
    const auto hit = scene.intersect(ray, Interval{});
    REQUIRE(hit);
    REQUIRE(hit->material().emission == Color{0});
    truth.compare(
        ray, [&](const auto& sampler) { return direct.shade(*hit, scene, sampler); },
        unoccluded.shade(*hit, scene).g, samples);
  }
  check(truth);
}

/// Checks the light of a lamp over a plane.
void check_lamp(AnySurface surface, int samples = some_samples) {
  Scene<Plane, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, 0}, matte);
  scene.add(std::move(surface), lamp(3));
  check_on_plane(scene, 2, samples);
}

}  // namespace

TEST_CASE("direct light of a sphere: above, far, cut by the horizon, touching, around the point") {
  struct Row {
    Point center;
    double radius, half;
  };
  const auto row = GENERATE(Row{{0, 3, 0}, 1, 3}, Row{{1, 1e4, 2}, 30, 3}, Row{{4, 0.2, 0}, 0.5, 3},
                            Row{{0.3, 1, 0.2}, 1, 1}, Row{{0, -1, 0}, 1.5, 0.6}, Row{{0, 1, 0}, 10, 3});
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, matte);
  scene.add(Sphere{row.center, row.radius}, lamp(3));
  check_on_plane(scene, row.half);
}

TEST_CASE("direct light of flat lamps: level, standing on the plane, cut by the horizon") {
  check_lamp(Parallelogram{{-1, 2, -1}, {2, 0, 0}, {0, 0, 1}});        // a rectangle
  check_lamp(Parallelogram{{-1, 2, -1}, {2, 0.5, 0}, {0.4, 0.3, 1}});  // oblique
  check_lamp(Parallelogram{{-4, 0, 2.5}, {8, 0, 0}, {0, 1, 0}});       // stands on it
  check_lamp(Parallelogram{{-4, -1, 2.5}, {8, 0, 0}, {0, 3, 1}});      // goes through it
  check_lamp(Triangle{{-1, 1, 0}, {2, 2, 0}, {0, 1.5, 2}});
  check_lamp(Disk{{0.5, 1.5, 0}, {0.1, 1, 0.2}, 1});
  check_lamp(Disk{{0.5, 0.5, 3}, {0.1, 0.2, 1}, 1});
}

TEST_CASE("direct light of a mesh is that of its triangles; a closed one hides its other side") {
  check_lamp(Mesh(meshes::moved(meshes::box(1), 0.4, {0.5, 1, 0})), many_samples);
  check_lamp(Mesh(meshes::moved(meshes::icosphere(1), 0.5, {0.5, 0.2, 1.5})), many_samples);
  MeshData roof{.vertices = {{-1, 1, -1}, {1, 1.2, -1}, {-1, 1, 1}, {1, 1.5, 1}},
                .triangles = {{0, 1, 2}, {3, 2, 1}}};
  check_lamp(Mesh(std::move(roof)));
}

TEST_CASE("a closed mesh is chosen as often as another lamp of its visible area and its radiance") {
  MeshData open = meshes::box(1);
  open.triangles.pop_back();  // 47 of 48 triangles, of ½ each
  Scene<Sphere, Mesh> scene;
  scene.add(Sphere{{0, 9, 0}, std::sqrt(6 / std::numbers::pi)}, lamp(3));
  scene.add(Mesh(meshes::box(1)), lamp(3));
  scene.add(Mesh(open), lamp(3));
  const AreaLights lights(scene);
  const double areas[] = {6, 24 / 4.0, 23.5 / 2};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(lights.lights()[i].visible_area() == Approx(areas[i]).epsilon(1e-14));
    CHECK(lights.by_power().probability(i) == Approx(areas[i] / 23.75).epsilon(1e-14));
  }
}

TEST_CASE("a hit is drawn with the density and the probability of its lamp, and of no other surface") {
  // Lamps and others in turns, of which the first and the last are no lamps, wherever the lists are.
  const auto check = [](auto scene) {
    for (int i = 0; i < 5; ++i) {
      const Material material = i % 2 == 1 ? lamp(static_cast<float>(i)) : Material{.diffuse = Color{1}};
      scene.add(Sphere{{4.0 * i, 0, 9}, 1}, material);
      scene.add(Parallelogram{{4.0 * i - 1, 4, 9}, {2, 0, 0}, {0, 2, 0}}, material);
    }
    const AreaLights lights(scene);
    REQUIRE(lights.lights().size() == 4);
    std::size_t lit = 0;
    for (int row = 0; row < 2; ++row)
      for (int i = 0; i < 5; ++i) {
        CAPTURE(row, i);
        const Ray ray{{4.0 * i, 5.0 * row, 0}, {0, 0, 1}};
        const std::optional<Intersection> hit = scene.intersect(ray, Interval{});
        REQUIRE(hit);
        const auto [density, probability] = lights.drawn(ray.origin, *hit);
        if (i % 2 == 0) {
          CHECK(density == 0);
          CHECK(probability == 0);
          continue;
        }
        ++lit;
        for (std::size_t k = 0; k < 4; ++k)
          if (const AreaLight& light = lights.lights()[k]; light.surface() == hit->surface()) {
            CHECK(density == light.density(ray.origin, *hit));
            CHECK(probability == lights.by_power().probability(k));
          }
        CHECK(density > 0);
        CHECK(probability > 0);
      }
    CHECK(lit == 4);
  };
  check(Scene<Sphere, Parallelogram>{});
  check(Scene<Parallelogram, Sphere>{});
}

TEST_CASE("a rectangle among the lamps is known, wherever it is among them") {
  const Parallelogram rectangle{{0, 0, 9}, {1, 0, 0}, {0, 2, 0}}, slanted{{0, 0, 9}, {1, 0, 0}, {1, 2, 0}};
  const auto has_rectangles = [](const auto&... lamps) {
    Scene<Parallelogram> scene;
    (scene.add(lamps, lamp(1)), ...);
    return AreaLights(scene).has_rectangles();
  };
  CHECK(has_rectangles(rectangle));
  CHECK(has_rectangles(rectangle, slanted));
  CHECK(has_rectangles(slanted, rectangle));
  CHECK_FALSE(has_rectangles(slanted));
  CHECK_FALSE(has_rectangles());
}

TEST_CASE("lamps without an area bring no light, also if there are more of them than rays") {
  MeshData line;
  line.vertices = {{0, 1, 4}, {1, 1, 4}, {2, 1, 4}};
  line.triangles = {{0, 1, 2}};
  Scene<Plane, Mesh> scene;
  scene.add(Plane{}, Material{.diffuse = Color{0.5f}, .glossy = Color{0.5f}, .roughness = 0.5});
  for (int i = 0; i < 2; ++i) scene.add(Mesh(line), lamp(1));
  DirectIntegrator direct(scene);
  const auto hit = scene.intersect(Ray{.origin = {0, 1, 0}, .direction = {0.1, -1, 0.2}}, Interval{});
  REQUIRE(hit);
  for (const int most_rays : {1, 16}) {
    direct.most_rays = most_rays;
    for (std::uint32_t i = 0; i < 8; ++i)
      CHECK(direct.shade(*hit, scene, SobolSampler({.sample = i, .samples = 8})) == Color{0});
  }
}

TEST_CASE("lamps of the smallest and of the largest sizes are chosen as often as any others") {
  const auto add_to = [](auto& scene, double unit) {
    const auto add_all = [&](const Point& at, double edge) {
      const Vec3 u = edge * unit * Vec3{1, 0, 0}, v = edge * unit * Vec3{0.5, 0, 1};
      const Point corner = unit * at;
      scene.add(Parallelogram{corner, u, v}, lamp(3));
      scene.add(Triangle{corner, corner + u, corner + v}, lamp(3));
      scene.add(Mesh({{corner, corner + u, corner + v}, {{0, 1, 2}}}), lamp(3));
    };
    scene.add(Parallelogram{unit * Point{-4, 0, -4}, unit * Vec3{8, 0, 0}, unit * Vec3{0, 0, 8}}, matte);
    add_all({-1, 2, 0}, 1);
    add_all({1, 3, 1}, 0.25);
  };
  Scene<Parallelogram, Triangle, Mesh> expected;
  add_to(expected, 1);
  const AreaLights shares(expected);
  REQUIRE(shares.lights().size() == 6);
  const Vec3 down{0.1, -1, 0.2};
  const auto shade = [&](const auto& scene, double unit, std::uint32_t sample) {
    DirectIntegrator direct(scene);
    direct.most_rays = 2;
    const auto hit = scene.intersect(Ray{.origin = {0, unit, 0}, .direction = down}, Interval{});
    REQUIRE(hit);
    return direct.shade(*hit, scene, SobolSampler({.sample = sample, .samples = 8}));
  };
  for (const int exponent : {-397, -300, 300, 397}) {
    CAPTURE(exponent);
    const double unit = std::ldexp(1, exponent);
    Scene<Parallelogram, Triangle, Mesh> scene;
    add_to(scene, unit);
    const AreaLights lights(scene);
    for (std::size_t i = 0; i < lights.lights().size(); ++i) {
      CHECK(lights.lights()[i].visible_area() == unit * unit * shares.lights()[i].visible_area());
      CHECK(lights.by_power().probability(i) == shares.by_power().probability(i));
    }
    for (std::uint32_t i = 0; i < 8; ++i) CHECK(shade(scene, unit, i) == shade(expected, 1, i));
  }
}

TEST_CASE("direct light of several lamps adds up, with one ray for each or as many as are allowed") {
  Scene<Plane, Sphere, Parallelogram> scene;
  scene.add(Plane{{0, 1, 0}, 0}, matte);
  scene.add(AmbientLight{Color{0.25f}});
  scene.add(PointLight{{1, 3, 1}, Color{30}});
  // Rays from one point to the lamps meet one lamp only.
  for (int i = 0; i < 5; ++i)
    scene.add(Sphere{{-8.0 + 4 * i, 2.0 + i, 9}, 0.5 + 0.1 * i}, lamp(1 + 2 * static_cast<float>(i)));
  scene.add(Parallelogram{{-1, 20, -1}, {2, 0, 0}, {0, 0, 2}}, lamp(100));
  scene.add(Sphere{{0, 2, 14}, 1e-100}, Material{.emission = Color{1e-38f}});  // of a power next to nothing
  check_on_plane(scene, 1);
  const UnoccludedIntegrator unoccluded(scene);
  const Ray ray{{0.3, 1, 0.2}, {0, -1, 0}};
  const auto hit = scene.intersect(ray, Interval{});
  for (const int rays : {1, 2, 6, 7, 16}) {
    DirectIntegrator direct(scene);
    direct.most_rays = rays;
    LightTruth truth;
    for (int i = 0; i < 4; ++i)
      truth.compare(
          ray, [&](const auto& sampler) { return direct.shade(*hit, scene, sampler); },
          unoccluded.shade(*hit, scene).g, 4 * some_samples);
    light_rays = {};
    static_cast<void>(direct.shade(*hit, scene, SobolSampler({.seed = 1, .samples = 4})));
    CHECK(light_rays.traced + light_rays.skipped == static_cast<std::uint64_t>(std::min(rays, 7)));
    check(truth);
  }
}

TEST_CASE("direct light has its full value where digits put points above their surface or below it") {
  const Vec3 normal{1 / 3.0, 2 / 3.0, 2 / 3.0}, u{0, 1, -1}, v{4, -1, -1};
  Scene<Plane, Sphere> scene;
  scene.add(Plane{normal, 0.7}, matte);
  scene.add(Sphere{3.0 * normal, 0.5}, lamp(3));
  const DirectIntegrator direct(scene);
  const UnoccludedIntegrator unoccluded(scene);
  Random random(8);
  WrongCases wrong(random);
  int above = 0, below = 0;
  for (int i = 0; i < 400; ++i) {
    const Point at = 0.7 * normal + random.real(-1, 1) * u + random.real(-0.3, 0.3) * v;
    const auto hit = scene.intersect({at + normal, -normal}, Interval{});
    REQUIRE(hit);
    const double height = dot(hit->point(), normal) - 0.7;
    above += height > 0, below += height < 0;
    // Each direction leads to the lamp, whose light hardly depends on the direction.
    const double light = direct.shade(*hit, scene, SobolSampler({.x = static_cast<std::uint32_t>(i)})).g;
    wrong.add(!(std::abs(light / unoccluded.shade(*hit, scene).g - 1) < 0.5), at, light);
  }
  CHECK(wrong == 0);
  CHECK(above > 10);
  CHECK(below > 10);
}

TEST_CASE("inside of a lamp that is a furnace each point has its emission and its albedo's share of it") {
  Scene<Sphere> scene;
  scene.add(Sphere{{1, 2, 3}, 4}, Material{.diffuse = Color{0.5f}, .emission = Color{2}});
  const DirectIntegrator direct(scene);
  LightTruth truth;
  Random random(4);
  for (int i = 0; i < some_rays; ++i) {
    const Ray ray{Point{1, 2, 3} + random.point(2), random.direction()};
    const auto hit = scene.intersect(ray, Interval{});
    CHECK(UnoccludedIntegrator(scene).shade(*hit, scene) == Color{3});
    truth.compare(
        ray, [&](const auto& sampler) { return direct.shade(*hit, scene, sampler); }, 3, some_samples);
  }
  check(truth);
  // From outside, a lamp does not light itself.
  const auto outside = scene.intersect({{1, 2, -30}, {0, 0, 1}}, Interval{});
  for (std::uint32_t i = 0; i < 16; ++i)
    CHECK(direct.shade(*outside, scene, SobolSampler({.seed = 1, .sample = i, .samples = 16})) == Color{2});
  CHECK(UnoccludedIntegrator(scene).shade(*outside, scene) == Color{2});
}

TEST_CASE("a wall that stands on a surface at an angle α leaves (1 + cos α)/2 of light from everywhere") {
  for (const double degrees : {30.0, 60.0, 90.0, 135.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    // The wall hides the sky from the horizon up to the angle α.
    const Vec3 up{std::cos(angle), std::sin(angle), 0};
    Scene<Parallelogram, Sphere> scene;
    scene.add(Sphere{{0, 0, 0}, 1e6}, lamp(1));  // as good as infinitely far away
    scene.add(Parallelogram{{-10, 0, -10}, {20, 0, 0}, {0, 0, 20}}, matte);
    scene.add(Parallelogram{{1, 0, -1e5}, 1e5 * up, {0, 0, 2e5}}, Material{});
    const DirectIntegrator direct(scene);
    LightTruth truth;
    Random random(5);
    for (int i = 0; i < some_rays; ++i) {
      const Point at{random.real(-0.9, 0.9), 0, random.real(-5, 5)};
      const Vec3 view{0, 1e-3, 1e-3};
      const Ray ray{at + view, -view};
      const auto hit = scene.intersect(ray, Interval{});
      REQUIRE(hit);
      REQUIRE(!is_black(hit->color()));
      truth.compare(
          ray, [&](const auto& sampler) { return direct.shade(*hit, scene, sampler); },
          double{matte.diffuse.g} * (1 + std::cos(angle)) / 2, many_samples);
    }
    check(truth);
  }
}

TEST_CASE("direct light is the same in an accelerated scene, and lamps occlude each other") {
  Scene<Plane, Sphere, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, 0}, matte);
  Random random(6);
  for (int i = 0; i < 40; ++i) {
    const Point center = Point{0, 2, 0} + random.point(1.8);
    if (i % 4 == 0) scene.add(Sphere{center, 0.3}, lamp(1));
    if (i % 4 == 1) scene.add(Sphere{center, 0.2}, matte);
    if (i % 4 == 2) scene.add(AnySurface(Sphere{center, 0.2}), lamp(1));
    if (i % 4 == 3) scene.add(AnySurface(Mesh(meshes::moved(meshes::box(1), 0.1, center))), lamp(1));
  }
  const auto fast = accelerate(scene);
  const DirectIntegrator direct(scene);
  WrongCases wrong(random);
  int darker = 0;
  light_rays = {};
  for (int i = 0; i < 300; ++i) {
    const Ray ray{{random.real(-2, 2), 6, random.real(-2, 2)}, random.point(0.3) + Vec3{0, -1, 0}};
    const auto hit = scene.intersect(ray, Interval{}), hit_in_fast = fast.intersect(ray, Interval{});
    REQUIRE(hit);
    const SobolSampler sampler({.seed = 7, .x = static_cast<std::uint32_t>(i)});
    const Color light = direct.shade(*hit, scene, sampler);
    wrong.add(light != direct.shade(*hit_in_fast, fast, sampler), ray);
    darker += light.g < UnoccludedIntegrator(scene).shade(*hit, scene).g;
  }
  CHECK(wrong == 0);
  CHECK(darker > 100);
  CHECK(light_rays.traced > 1000);
  CHECK(light_rays.skipped > 100);
}

TEST_CASE("a direct integrator refuses less than one ray for a hit, and another scene") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 3}, 1}, lamp(1));
  DirectIntegrator direct(scene);
  CHECK_NOTHROW(direct.validate());
  direct.most_rays = 0;
  CHECK(message_of<std::invalid_argument>([&] { direct.validate(); }) ==
        "DirectIntegrator: most_rays must be at least 1; it is 0");
  const Scene<Sphere> copy = scene;
  const auto hit = copy.intersect({{0, 0, 0}, {0, 0, 1}}, Interval{});
  CHECK_THROWS_AS(direct.shade(*hit, copy, SobolSampler(SampleIndex{})), std::logic_error);
}

TEST_CASE("lights that were made before the last surface are refused, in views of the scene as well") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 3}, 1}, lamp(1));
  const DirectIntegrator direct(scene);
  scene.add(Sphere{{0, 3, 3}, 1}, matte);
  const auto fast = accelerate(scene);
  const auto error_of = [&](const auto& view, bool tiles) {
    return message_of<std::logic_error>([&] {
      Image image(4, 3);
      render(image, Camera{}, view, direct, {.samples = 2, .threads = 1, .tiles = tiles});
    });
  };
  const std::string refused =
      "AreaLights: the scene is not the one of which they were made, or has been moved or given other "
      "surfaces "
      "since; make them again";
  for (const bool tiles : {false, true}) {
    CAPTURE(tiles);
    CHECK(error_of(scene, tiles) == refused);
    CHECK(error_of(fast, tiles) == refused);
  }
}

TEST_CASE("each ray to a lamp takes two numbers of its own, from set 1 on") {
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, matte);
  for (int i = 0; i < 5; ++i) scene.add(Sphere{{i - 2.0, 3, 0}, 0.3}, lamp(1));
  const auto hit = scene.intersect({{0, 1, 0}, {0, -1, 0}}, Interval{});
  DirectIntegrator direct(scene);
  const auto asked = [&] {
    std::vector<std::uint32_t> sets;
    static_cast<void>(direct.shade(*hit, scene, [&](std::uint32_t set) {
      sets.push_back(set);
      return SampleSet<double>{0.1, 0.2, 0.3, 0.4};
    }));
    return sets;
  };
  CHECK(asked() == std::vector<std::uint32_t>{1, 2, 3});
  direct.most_rays = 4;  // and a pair for the choice
  CHECK(asked() == std::vector<std::uint32_t>{1, 2, 3});
  direct.most_rays = 1;
  CHECK(asked() == std::vector<std::uint32_t>{1});
}

TEST_CASE("a picture of soft shadows has the same bytes by tiles, by any number of threads and with a tree") {
  Scene<Plane, Sphere, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, -1}, matte);
  scene.add(Sphere{{0, 0, 4}, 0.7}, matte);
  scene.add(Sphere{{-1.5, 1, 4}, 0.4}, lamp(3));
  scene.add(AnySurface(Parallelogram{{1, 1, 3}, {1, 0, 0}, {0, 0.3, 1}}), lamp(2));
  scene.set_sky(Color{0.5f});
  const DirectIntegrator direct(scene);
  const auto camera = Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  for (const int samples : {0, 4}) {
    RenderOptions options;
    options.samples = samples;
    Image tiled(80, 70), fast(80, 70), plain(80, 70);
    render(tiled, camera, scene, direct, options);
    options.threads = 3;
    render(fast, camera, accelerate(scene), direct, options);
    options.tiles = false;
    render(plain, camera, scene, direct, options);
    CHECK(different_pixels(plain, tiled) == 0);
    CHECK(different_pixels(plain, fast) == 0);
    CHECK(count_pixels(plain, [&](int x, int y) { return plain(x, y) != Color{0}; }) > 5000);
    // Chance differs between neighbors on the plane.
    CHECK(count_pixels(plain, [&](int x, int y) { return x > 0 && plain(x, y) != plain(x - 1, y); }) > 2000);
  }
}

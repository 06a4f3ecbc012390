// Light on glossy surfaces, as the integrators find it, against quadrature.
#include <algorithm>
#include <cmath>
#include <cstddef>
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

/// Returns a polished surface with Phong's lobe of this exponent.
Material polished(double exponent, float matte_part = 0) {
  return {.diffuse = Color{matte_part},
          .shininess = exponent,
          .glossy = Color{0.9f, 0.6f, 0.3f},
          .blur = Blur::phong};
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
    const GgxLobe ggx{material.glossy, material.roughness};
    const PhongLobe phong{material.glossy, material.shininess};
    const Vec3 from = frame.local(view), to = frame.local(direction);
    return (material.blur == Blur::phong ? phong.reflection(from, to) : ggx.reflection(from, to)).g +
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

Material glowing(float light) { return {.emission = Color{light}}; }

}  // namespace

TEST_CASE("under a sky of one color a glossy floor has the albedo of its lobe") {
  for (const Material& material :
       {metal(0.25), metal(0.6), metal(1.0), polished(0), polished(5), polished(60)}) {
    CAPTURE(material.roughness, material.shininess);
    Scene<Plane> scene;
    scene.add(Plane{{0, 1, 0}, 0}, material);
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
    compare_floor(DirectIntegrator(scene), scene, material, truth);
    compare_floor(one_bounce(scene), scene, material, truth);
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
  const bool is_metal = GENERATE(true, false);
  CAPTURE(row.radius, row.roughness, row.matte_part, is_metal);
  // About as wide as the GGX lobe.
  const double exponent = 2 / std::pow(row.roughness, 4);
  const Material material =
      is_metal ? metal(row.roughness, row.matte_part) : polished(exponent, row.matte_part);
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  scene.add(Sphere{row.center, row.radius}, glowing(3));
  const double sine = row.radius / length(row.center);
  const auto truth = [&](const Floor& floor) {
    return 3 * floor.light_of_cone(normalize(row.center), std::sqrt(1 - sine * sine));
  };
  compare_floor(DirectIntegrator(scene), scene, material, truth);
  compare_floor(one_bounce(scene), scene, material, truth);
}

TEST_CASE(
    "rays to lights, directions of the lobe, and both have the same mean, and both are near the better of "
    "the two") {
  const double roughness = GENERATE(0.2, 0.5);
  const Material material = metal(roughness);
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  const Point center{-3, 4, 0};
  scene.add(Sphere{center, 2}, glowing(3));
  const DirectIntegrator direct(scene);
  const Floor floor{material, views[0]};
  const double truth = 3 * floor.light_of_cone(normalize(center), std::sqrt(1 - 4.0 / 25), 400);
  const Ray ray{0.01 * views[0], -views[0]};
  const auto hit = scene.intersect(ray, Interval{});
  const GlossyLobeAt lobe(Vertex(*hit), material);
  const SphereView lamp(hit->point(), center, 2);
  LightTruth by_light, by_lobe, by_both;
  for (int i = 0; i < 4; ++i) {
    by_light.compare(
        ray,
        [&](const auto& sampler) {
          const SampleSet<double> numbers = sampler(1);
          const LightSample drawn = lamp.sample(numbers[0], numbers[1]);
          return 3.0f * times(lobe.reflection(drawn.direction), 1 / drawn.density);
        },
        truth, 32);
    by_lobe.compare(
        ray,
        [&](const auto& sampler) {
          const SampleSet<double> numbers = sampler(1);
          const Bounce drawn = lobe.sample(numbers[2], numbers[3]);
          const auto seen = drawn.goes_on() ? scene.intersect(hit->leave(drawn.direction)) : std::nullopt;
          return seen ? drawn.weight * seen->material().emission : Color{0};
        },
        truth, 32);
    by_both.compare(
        ray, [&](const auto& sampler) { return direct.shade(*hit, scene, sampler); }, truth, 32);
  }
  CHECK(by_light.wrong == 0);
  CHECK(by_lobe.wrong == 0);
  CHECK(by_both.wrong == 0);
  CAPTURE(by_light.variance, by_lobe.variance, by_both.variance);
  CHECK(by_both.variance < 1.5 * std::min(by_light.variance, by_lobe.variance));
  CHECK(by_both.variance < std::max(by_light.variance, by_lobe.variance));
}

TEST_CASE(
    "a glossy floor reflects lamps of all kinds, more of them than rays, and others that are no area "
    "lights") {
  const Material material = metal(0.4, 0.25f);
  Scene<Plane, Sphere, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  // Spheres in a row, which do not hide each other from the origin.
  double expected_0 = 0, expected_1 = 0;
  for (int i = 0; i < 5; ++i) {
    const Point center{-8.0 + 4 * i, 6, -0.8};  // one of them in the mirror direction of a view
    const float light = 1 + 2 * static_cast<float>(i);
    scene.add(Sphere{center, 1}, glowing(light));
    const double s = 1 / length(center);
    expected_0 +=
        light * Floor{material, views[0]}.light_of_cone(normalize(center), std::sqrt(1 - s * s), 60);
    expected_1 +=
        light * Floor{material, views[1]}.light_of_cone(normalize(center), std::sqrt(1 - s * s), 60);
  }
  const auto truth = [&](const Floor& floor) { return floor.view == views[0] ? expected_0 : expected_1; };
  for (const int rays : {1, 3, 16}) {
    CAPTURE(rays);
    DirectIntegrator direct(scene);
    direct.most_rays = rays;
    compare_floor(direct, scene, material, truth, 64);
  }
  compare_floor(one_bounce(scene), scene, material, truth, 64);
}

TEST_CASE("a glossy floor reflects a mesh as a lamp like the sphere that it stands for") {
  // A closed convex mesh with vertices on a sphere contains another sphere, which touches its innermost
  // triangle. It looks larger than that one and smaller than the one around it, and so does its light.
  const MeshData ball = meshes::icosphere(3);
  double inner = 1;
  for (std::size_t i = 0; i < ball.triangles.size(); ++i) {
    const Triangle t = ball.triangle(i);
    inner = std::min(inner, dot(t.a - Point{}, normalize(cross(t.b - t.a, t.c - t.a))));
  }
  CHECK(inner > 0.99);
  const Material material = metal(0.6);
  Scene<Plane, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  const Point center{-2, 3, 0};
  scene.add(AnySurface(Mesh(meshes::moved(ball, 1, center))), glowing(3));
  for (const Vec3& view : views) {
    const auto light_of_sphere = [&](double radius) {
      const double s = radius / length(center);
      return 3 * Floor{material, view}.light_of_cone(normalize(center), std::sqrt(1 - s * s));
    };
    const Ray ray{0.01 * view, -view};
    const auto hit = scene.intersect(ray, Interval{});
    const DirectIntegrator direct(scene);
    constexpr std::uint32_t samples = 2048, seeds = 32;
    double sum = 0, squares = 0;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      double light = 0;
      for (std::uint32_t i = 0; i < samples; ++i)
        light += direct.shade(*hit, scene, SobolSampler({.seed = seed, .sample = i, .samples = samples})).g;
      sum += light / samples, squares += (light / samples) * (light / samples);
    }
    // Five standard errors of the mean of independent scramblings.
    const double mean = sum / seeds, error = 5 * std::sqrt((squares / seeds - mean * mean) / (seeds - 1));
    CAPTURE(inner, mean, error);
    CHECK(error < 0.01 * mean);
    CHECK(mean > light_of_sphere(inner) - error);
    CHECK(mean < light_of_sphere(1) + error);
  }
}

TEST_CASE("a glossy floor reflects a light at a point by its lobe's value, and nothing that is occluded") {
  const Material material = metal(0.4);
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  const Point lamp{-2, 3, 0.5};
  scene.add(ConstantLight{lamp, Color{3}});
  const Ray ray{0.01 * views[0], -views[0]};
  const SobolSampler sampler(SampleIndex{});
  const double expected = 3 * Floor{material, views[0]}.reflection(normalize(lamp));
  const auto check = [&](double light) {
    const auto hit = scene.intersect(ray, Interval{});
    CHECK(std::abs(DirectIntegrator(scene).shade(*hit, scene, sampler).g - light) < 1e-6 * expected);
    CHECK(std::abs(one_bounce(scene).shade(*hit, scene, sampler).g - light) < 1e-6 * expected);
  };
  check(expected);
  scene.add(Sphere{0.5 * lamp, 0.1}, Color{0.5f});
  check(0);
}

TEST_CASE(
    "a glossy floor with a tilted normal reflects a light at a point like a small ball of the same power, "
    "also one behind that normal") {
  // Seen from behind, the normal is replaced by the floor's own for the lobe, but not for matte light.
  const double tilt = GENERATE(-60.0, 20.0, 60.0) * std::numbers::pi / 180;
  CAPTURE(tilt);
  Material material = metal(0.8);
  material.normal_map = NormalMap([=](double, double) { return Vec3{0, std::sin(tilt), std::cos(tilt)}; });
  const Parallelogram floor{.position = {-50, -1, -50}, .edge_u = {100, 0, 0}, .edge_v = {0, 0, 100}};
  const Point lamp{0, 3, -4};
  constexpr double radius = 0.05, power = 400;
  Scene<Sphere, Parallelogram> point, ball;
  point.add(floor, material);
  ball.add(floor, material);
  point.add(PointLight{.position = lamp, .power = Color{to_float(power)}});
  constexpr double pi = std::numbers::pi;
  ball.add(Sphere{lamp, radius}, glowing(to_float(power / (4 * pi * pi * radius * radius))));
  const Ray ray{{0, -0.2, -3}, {0, -0.8, 3}};
  const auto hit = point.intersect(ray, Interval{}), same = ball.intersect(ray, Interval{});
  const double expected = DirectIntegrator(point).shade(*hit, point, SobolSampler(SampleIndex{})).g;
  CHECK(expected > 0.01);
  CHECK(one_bounce(point).shade(*hit, point, SobolSampler(SampleIndex{})).g == expected);
  double sum = 0;
  const DirectIntegrator direct(ball);
  constexpr std::uint32_t samples = 512;
  for (std::uint32_t i = 0; i < samples; ++i)
    sum += direct.shade(*same, ball, SobolSampler({.seed = 1, .sample = i, .samples = samples})).g;
  CHECK(std::abs(sum / samples / expected - 1) < 0.02);
  // What occludes the light occludes it for the lobe as well.
  point.add(Sphere{hit->point() + 0.5 * (lamp - hit->point()), 0.1}, Color{0.5f});
  const auto again = point.intersect(ray, Interval{});
  CHECK(DirectIntegrator(point).shade(*again, point, SobolSampler(SampleIndex{})).g == 0);
}

TEST_CASE("paths find a small sun in an environment, on glossy and on matte floors, with lamps and without") {
  Image image(16, 8);
  for (int i = 0; i < 16 * 8; ++i) image(i % 16, i / 16) = Color{0.25f + 0.05f * static_cast<float>(i % 5)};
  image(4, 2) = Color{40};
  const EnvironmentImage environment{std::make_shared<const Image>(image)};
  const auto row = GENERATE(std::pair{0.4, 0.0f}, std::pair{0.8, 0.5f});
  const auto has_lamp = GENERATE(false, true);
  CAPTURE(row.first, has_lamp);
  const Material material = metal(row.first, row.second);
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  scene.set_environment(environment);
  const Point center{3, 3, 1};
  if (has_lamp) scene.add(Sphere{center, 1}, glowing(3));
  const double s = 1 / length(center), cosine = std::sqrt(1 - s * s);
  const auto truth = [&](const Floor& floor) {
    constexpr int w = 480, h = 240;
    double sum = has_lamp ? 3 * floor.light_of_cone(normalize(center), cosine) : 0;
    for (int y = 0; y < h / 2; ++y)
      for (int x = 0; x < w; ++x) {
        const double angle = std::numbers::pi * (y + 0.5) / h,
                     turn = 2 * std::numbers::pi * ((x + 0.5) / w - 0.5);
        const Vec3 d{std::sin(angle) * std::sin(turn), std::cos(angle), std::sin(angle) * std::cos(turn)};
        if (has_lamp && dot(d, normalize(center)) > cosine) continue;
        sum += std::sin(angle) * std::numbers::pi / h * 2 * std::numbers::pi / w * floor.reflection(d) *
               environment((x + 0.5) / w, (y + 0.5) / h).g;
      }
    return sum;
  };
  compare_floor(one_bounce(scene), scene, material, truth, 16);
}

TEST_CASE("a glossy surface in a furnace sends out as much as it receives if it is smooth and white") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 0}, 1}, Material{.emission = Color{1}, .glossy = Color{1}, .roughness = 0});
  PathIntegrator path(scene);
  for (const int depth : {0, 1, 3}) {
    path.depth = depth;
    LightTruth light;
    const Ray ray{{0.1, 0.2, 0}, normalize(Vec3{1, 2, 3})};
    const auto hit = scene.intersect(ray, Interval{});
    light.compare(
        ray, [&](const auto& sampler) { return path.shade(*hit, scene, sampler); }, 1.0 + depth, 8);
    CHECK(light.wrong == 0);
  }
}

TEST_CASE(
    "a picture of glossy surfaces has the same bytes by tiles, by any number of threads and with a tree") {
  Scene<Plane, Sphere, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, -1}, metal(0.3, 0.2f));
  scene.add(Sphere{{0, 0, 4}, 0.7}, metal(0));
  scene.add(Sphere{{-1.5, 1, 4}, 0.4}, glowing(3));
  scene.add(AnySurface(Parallelogram{{1, 1, 3}, {1, 0, 0}, {0, 0.3, 1}}), glowing(2));
  scene.set_environment([](double u, double v) { return Color{Vec3{u, v, 0.5}}; });
  const auto camera = Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  const auto check = [&](const auto& integrator) {
    RenderOptions options;
    options.samples = 2;
    Image tiled(48, 40), fast(48, 40), plain(48, 40);
    render(tiled, camera, scene, integrator, options);
    options.threads = 3;
    render(fast, camera, accelerate(scene), integrator, options);
    options.tiles = false;
    render(plain, camera, scene, integrator, options);
    CHECK(different_pixels(plain, tiled) == 0);
    CHECK(different_pixels(plain, fast) == 0);
    CHECK(count_pixels(plain, [&](int x, int y) { return x > 0 && plain(x, y) != plain(x - 1, y); }) > 1000);
  };
  check(DirectIntegrator(scene));
  check(PathIntegrator(scene));
}

TEST_CASE("beside a tilted normal a glossy lobe leads out of the surface, and away from it keeps its shape") {
  const NormalMap map([](double u, double v) { return Vec3{2 * std::sin(9 * u), 2 * std::cos(7 * v), 1}; });
  Material material = metal(0.5);
  material.normal_map = map;
  Scene<Plane> scene;
  scene.add(Plane{{0, 1, 0}, 0}, material);
  Random random(6);
  WrongCases wrong(random);
  int facing_away = 0, into_surface = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 view = normalize(Vec3{random.real(-1, 1), random.real(0.01, 1), random.real(-1, 1)});
    const Point at{random.real(-3, 3), 0, random.real(-3, 3)};
    const auto hit = scene.intersect({at + view, -view}, Interval{});
    REQUIRE(hit);
    const Vertex vertex(*hit);
    const GlossyLobeAt lobe(vertex, material);
    facing_away += dot(vertex.normals.shading, view) < 0;
    const Vec3 below = random.direction();
    wrong.add(below.y <= 0 && lobe.reflection(below) != Color{0}, "from below", view, below);
    const Bounce drawn = lobe.sample(random.interior(), random.interior());
    into_surface += !drawn.goes_on();
    if (!drawn.goes_on()) continue;
    wrong.add(!(drawn.direction.y > 0), "into the surface", view, drawn.direction);
    wrong.add(!(std::abs(lobe.density(drawn.direction) / drawn.weighed_density - 1) < 1e-9), "density", view);
    const double weight = lobe.reflection(drawn.direction).g / drawn.weighed_density;
    wrong.add(!(std::abs(weight / drawn.weight.g - 1) < 1e-5), "weight", view, weight, drawn.weight.g);
  }
  CHECK(wrong == 0);
  CHECK(facing_away > 100);
  CHECK(into_surface > 100);
}

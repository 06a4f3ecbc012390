#include <protostar/integrators/unoccluded.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/box.hpp>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

constexpr Color albedo{0.5f, 0.75f, 0.25f};

/// A plane, a ball, and a lamp of each kind that lights others.
Scene<Plane, Sphere, Parallelogram, AnySurface> lamps_of_all_kinds() {
  Scene<Plane, Sphere, Parallelogram, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, -1}, albedo);
  scene.add(Sphere{{0, 0, 4}, 0.7}, albedo);
  scene.add(Sphere{{-1.5, 1, 4}, 0.4}, Material{.diffuse = albedo, .emission = Color{3, 2, 1}});
  scene.add(Parallelogram{{1, -1.2, 5}, {1, 0, 0.3}, {0, 2, 0.2}}, Material{.emission = Color{1, 2, 3}});
  scene.add(AnySurface(Disk{{0, 1.5, 4.5}, {0.1, 1, 0.3}, 0.4}), Material{.emission = Color{4}});
  scene.add(AnySurface(Triangle{{-2, -1, 5}, {-1, 0, 6}, {-2.5, 1, 5}}), Material{.emission = Color{2}});
  scene.add(AnySurface(Mesh(meshes::moved(meshes::box(1), 0.2, {1, -0.8, 3}))),
            Material{.emission = Color{2}});
  scene.add(PointLight{{1, 2, 1}, Color{20}});
  scene.add(AmbientLight{Color{0.1f}});
  return scene;
}

}  // namespace

TEST_CASE("unoccluded light is the emission and the albedo over π times the irradiance in closed form") {
  const auto scene = lamps_of_all_kinds();
  const UnoccludedIntegrator unoccluded(scene);
  REQUIRE(unoccluded.lights.lights().size() == 5);
  const auto camera = Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  Image image(32, 24);
  render(image, camera, scene, unoccluded);
  WrongCases wrong;
  int lit = 0, lamps = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) {
      const auto hit =
          scene.intersect(camera(Camera::u_at(x + 0.5, 32, 24), Camera::v_at(y + 0.5, 24)), Interval{});
      if (!hit) {
        wrong.add(image(x, y) != Color{0}, x, y);
        continue;
      }
      const Point p = hit->point();
      const Vec3 n = hit->facing_normal();
      const bool is_lamp = !is_black(hit->material().emission);
      if (is_lamp) {
        ++lamps;
        // Lamps without an albedo show their emission alone.
        if (is_black(hit->color())) wrong.add(image(x, y) != hit->material().emission, x, y);
        continue;
      }
      Vec3 sum = Vec3{3, 2, 1} * sphere_irradiance(p, n, {-1.5, 1, 4}, 0.4) +
                 Vec3{1, 2, 3} * parallelogram_irradiance(p, n, {1, -1.2, 5}, {1, 0, 0.3}, {0, 2, 0.2}) +
                 Vec3(4.0) * disk_irradiance(p, n, {0, 1.5, 4.5}, {0.1, 1, 0.3}, 0.4) +
                 Vec3(2.0) * triangle_irradiance(p, n, {-2, -1, 5}, {-1, 0, 6}, {-2.5, 1, 5});
      // Of the cube, the three faces in front count once.
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 corner(-0.2), u{0}, v{0};
        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 0.4;
        const double side = p[axis] - Point{1, -0.8, 3}[axis];
        if (std::abs(side) <= 0.2) continue;
        corner[axis] = side > 0 ? 0.2 : -0.2;
        sum += 2 * parallelogram_irradiance(p, n, Point{1, -0.8, 3} + corner, u, v);
      }
      const Vec3 to_light = Point{1, 2, 1} - p;
      const double r = length(to_light);
      sum += Vec3(20 * std::max(0.0, dot(n, to_light)) / (4 * std::numbers::pi * r * r * r) + 0.1);
      for (int c = 0; c < 3; ++c) {
        const double expected = double{albedo[c]} / std::numbers::pi * sum[c];
        wrong.add(!(std::abs(image(x, y)[c] - expected) < 1e-6 * expected), x, y, c, image(x, y)[c],
                  expected);
      }
      ++lit;
    }
  CHECK(wrong == 0);
  CHECK(lit > 200);
  CHECK(lamps > 50);
}

TEST_CASE("unoccluded light has the same bytes by tiles, by any number of threads and with a tree") {
  const auto scene = lamps_of_all_kinds();
  const UnoccludedIntegrator unoccluded(scene);
  const auto camera = Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  Image plain(80, 70), tiled(80, 70), fast(80, 70);
  RenderOptions by_rays;
  by_rays.tiles = false;
  render(plain, camera, scene, unoccluded, by_rays);
  for (const int threads : {1, 3}) {
    render(tiled, camera, scene, unoccluded, {.threads = threads});
    CHECK(different_pixels(plain, tiled) == 0);
  }
  render(fast, camera, accelerate(scene), unoccluded);
  CHECK(different_pixels(plain, fast) == 0);
  // WhittedIntegrator shows emission, and takes packets.
  render(plain, camera, scene, WhittedIntegrator{}, by_rays);
  render(tiled, camera, scene, WhittedIntegrator{});
  CHECK(different_pixels(plain, tiled) == 0);
  CHECK(count_pixels(plain, [&](int x, int y) { return plain(x, y) == Color{1, 2, 3}; }) > 20);
}

TEST_CASE(
    "a lamp does not light the surface that it lies on, nor itself, whatever the digits of points are") {
  Scene<Parallelogram> scene;
  const Vec3 u{3, 1, -2}, v{1, 2, 5}, normal = normalize(cross(u, v));
  scene.add(Parallelogram{-4.0 * u - 4.0 * v, 8.0 * u, 8.0 * v}, albedo);
  scene.add(Parallelogram{u, 2.0 * u, v}, Material{.diffuse = albedo, .emission = Color{1}});
  const UnoccludedIntegrator unoccluded(scene);
  int beside = 0, inside = 0;
  double largest = 0;
  for (double a = 0.05; a < 4; a += 0.1) {
    const Ray down{a * u + 0.37 * v + normal, -normal};
    const auto hit = scene.intersect(down, Interval{});
    REQUIRE(hit);
    CHECK((unoccluded.shade(*hit, scene) == hit->material().emission));
    // Where both are, the first is seen, in whose plane the lamp lies.
    (1 < a && a < 3 ? inside : beside) += 1;
    largest = std::max(largest, std::abs(dot(hit->point(), normal)));
  }
  CHECK(beside > 10);
  CHECK(inside > 10);
  CHECK(largest > 0);  // points are rounded
}

TEST_CASE("all surfaces with an emission are seen, and those of known shapes light others") {
  Scene<Plane, AnySurface> scene;
  scene.add(Plane{{0, 1, 0}, 0}, Material{.diffuse = albedo, .emission = Color{0.25f}});
  scene.add(AnySurface(Box{{-1, 1, -1}, {1, 2, 1}}), Material{.emission = Color{5}});
  const UnoccludedIntegrator unoccluded(scene);
  CHECK(unoccluded.lights.lights().empty());
  CHECK(unoccluded.radiance({{0, 5, 0}, {0, -1, 0}}, scene) == Color{5});
  CHECK(unoccluded.radiance({{3, 5, 0}, {0, -1, 0}}, scene) == Color{0.25f});
}

TEST_CASE(
    "a lamp lights itself from inside alone, whichever way its normals lead, and also if it moves by "
    "nothing") {
  const Material shining{.diffuse = Color{1}, .emission = Color{1}};
  const auto seen = [](const auto& scene, const Ray& ray) {
    return UnoccludedIntegrator(scene).radiance(ray, scene).r;
  };
  const Ray from_outside{{0.3, 0.2, -5}, {0, 0, 1}}, from_inside{{0.3, 0.2, 0}, {0, 0, 1}};
  for (const double radius : {1.0, -1.0}) {
    CAPTURE(radius);
    const Sphere sphere{{0.1, 0.2, 0.3}, radius};
    Scene<Sphere> at_rest;
    at_rest.add(sphere, shining);
    CHECK(seen(at_rest, from_outside) == 1);
    CHECK(seen(at_rest, from_inside) == 2);
    Scene<Moving<Sphere>> moving;
    moving.add(Moving<Sphere>(sphere, Vec3{0}), shining);
    CHECK(seen(moving, from_outside) == 1);
    CHECK(seen(moving, from_inside) == 2);
  }
}

TEST_CASE("the brightest lamps leave no number that is infinite or none") {
  constexpr float most = std::numeric_limits<float>::max();
  Scene<Plane, Sphere> scene;
  scene.add(Plane{{0, 1, 0}, 0}, Color{most, 0, 1});
  for (int i = 0; i < 3; ++i) scene.add(Sphere{{0, 3, 0}, 2.5}, Material{.emission = Color{most, most, 0}});
  const UnoccludedIntegrator unoccluded(scene);
  CHECK(unoccluded.radiance({{0, 0.1, 0}, {0, -1, 0}}, scene) == Color{most, 0, 0});
}

TEST_CASE("area lights are refused with another scene, or one that has got other surfaces") {
  Scene<Sphere> scene;
  scene.add(Sphere{{0, 0, 3}, 1}, Material{.emission = Color{1}});
  const UnoccludedIntegrator unoccluded(scene);
  const Scene<Sphere> copy = scene;
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  CHECK(unoccluded.radiance(ray, scene) == Color{1});
  CHECK_THROWS_AS(unoccluded.radiance(ray, copy), std::logic_error);
  scene.add(Sphere{{0, 5, 3}, 1}, Color{1});
  CHECK_THROWS_AS(unoccluded.radiance(ray, scene), std::logic_error);
  CHECK(UnoccludedIntegrator(copy).radiance(ray, copy) == Color{1});
}

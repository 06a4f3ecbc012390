// Reflected and refracted rays in render by tiles: the picture drawn ray by ray, to any depth.
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <cstdint>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/everything.hpp"
#include "support/pictures.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// Returns a scene of so few surfaces that secondary rays stay together in packets; neighbors differ in
/// material.
Everything mirrors_and_glass() {
  const Material chrome{.specular = Color{1}, .shininess = 1425, .reflect = 0.8},
      glass{.specular = Color{0.9f}, .shininess = 125, .reflect = 0.1, .refract = 0.8},
      air{.reflect = 0.2, .refract = 0.7, .ior = 1 / 1.5},
      rubber{.diffuse = {0.4f, 0.1f, 0.1f}, .specular = Color{0.3f}, .shininess = 12.5},
      tiles{.texture = Checker{{0.6f, 0.4f, 0.2f}, Color{0.6f}, 0.7}, .reflect = 0.25},
      water{.diffuse = {0, 0.1f, 0.2f}, .reflect = 0.3, .refract = 0.9, .ior = 1.33};
  Everything scene;
  scene.add(Sphere{.center = {-1, 0, 5}}, chrome);
  scene.add(Sphere{.center = {1, 0.2, 4}}, glass);
  scene.add(Sphere{.center = {1, 0.2, 4}, .radius = -0.5}, glass);  // a hollow inside the glass
  scene.add(Sphere{.center = {0.2, -0.4, 3}, .radius = 0.4}, air);
  scene.add(Sphere{.center = {0, 1.5, 6}, .radius = 0.8}, rubber);
  scene.add(Sphere{.center = {-1, -1.5, 4}, .radius = 0.6}, tiles);
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, water);
  scene.add(Plane{.normal = {0, 2, 0.1}, .distance = -6}, tiles);
  scene.add(AnySurface(Sphere{.center = {2.5, 0.5, 6}}), chrome);
  scene.add(AnySurface(Plane{.normal = {0, 0, 1}, .distance = 12}), tiles);
  scene.add(AnySurface(Cylinder{.radius = 9}), chrome);
  scene.set_sky({0.2f, 0.7f, 0.8f});
  scene.add(PointLight{.position = {1, 4, -2}, .power = Color{300, 200, 100}});
  scene.add(DirectionalLight{.direction = {1, 2, -1}, .intensity = {0.2f, 0.1f, 0.1f}});
  scene.add(SpotLight{.position = {0, 4, 4}, .direction = {0, -1, 0}, .angle = 35, .power = Color{200}});
  scene.add(AmbientLight{{0.02f, 0.01f, 0.03f}});
  return scene;
}

/// Returns a scene of two mirrors that face each other, and two spheres between them.
Everything hall_of_mirrors() {
  Everything scene;
  const Material mirror{.diffuse = Color{0x1p-8f}, .reflect = 0.95};
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 3}, mirror);
  scene.add(Plane{.normal = {0, 0, 1}, .distance = -2}, mirror);
  scene.add(Sphere{.center = {0.8, 0, 2}, .radius = 0.5}, mirror);
  scene.add(Sphere{.center = {-0.8, 0.2, 1}, .radius = 0.4}, Color{1, 0.5f, 0});
  scene.add(AmbientLight{Color{1}});
  scene.set_sky({0.2f, 0.7f, 0.8f});
  return scene;
}

/// Returns the number of pixels that WhittedIntegrator draws differently by tiles and ray by ray.
int wrong_pixels(const Everything& scene, const Camera& camera, int width, int height, int depth) {
  const WhittedIntegrator whitted{.depth = depth};
  Image image(width, height);
  render(image, camera, scene, whitted, {.threads = 2});
  return different_bytes(image, ray_by_ray(camera, width, height, scene, whitted));
}

}  // namespace

TEST_CASE("by tiles, mirrors and glass look as they do ray by ray, to any depth") {
  const auto scene = mirrors_and_glass();
  for (const Camera& camera : {Camera{}, Camera{.position = {0, -2, 0}},  // under water
                               Camera{.position = scene.surfaces<Sphere>()[1].center},
                               Camera::orthographic(Point{0}, {0, 0, 1}, {0, 1, 0}, 5)})
    for (const int depth : {0, 1, 2, 3, 5}) {
      CAPTURE(camera.position.y, camera.film_right.x, depth);
      CHECK(wrong_pixels(scene, camera, cases(45, 93), cases(35, 70), depth) == 0);
    }
  Image by_tiles(61, 43), plain(61, 43), sky(61, 43);
  const auto draw = [&](Image& image, int depth, const RenderOptions& options) {
    render(image, Camera{}, scene, WhittedIntegrator{.depth = depth}, options);
  };
  draw(by_tiles, 4, {.samples = 3});
  draw(plain, 4, {.samples = 3, .tiles = false});
  CHECK(different_bytes(by_tiles, plain) == 0);
  RenderStatistics one_ray, five_rays;
  draw(by_tiles, 1, {.statistics = &one_ray});
  draw(plain, 5, {.statistics = &five_rays});
  CHECK(different_bytes(by_tiles, plain) > 1000);
  // Secondary rays are tested in packets, too.
  CHECK(five_rays.surface_tests > 5 * one_ray.surface_tests);
  draw(sky, 0, {});
  CHECK(count_pixels(sky, [&](int x, int y) { return sky(x, y) != *scene.sky(); }) == 0);
}

TEST_CASE("by tiles, total reflection is decided for each ray") {
  Everything water;
  water.add(Plane{}, Material{.refract = 1, .ior = 1.33});
  water.set_sky({0.2f, 0.7f, 0.8f});
  const Camera under_water{.position = {0, -1, 0}, .up = {0, -0.5, 1}, .forward = {0, 1, 0.5}};
  CHECK(wrong_pixels(water, under_water, 90, 70, 5) == 0);
  Image image(90, 70);
  RenderStatistics taken;
  render(image, under_water, water, WhittedIntegrator{}, {.statistics = &taken});
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) == Color{0}; }) > 1000);
  const int bright = count_pixels(image, [&](int x, int y) { return image(x, y) == *water.sky(); });
  CHECK(bright > 1000);
  CHECK(taken.other_rays == static_cast<std::uint64_t>(bright));  // no other rays are followed
}

TEST_CASE("by tiles, mirror images that double leaves in doubt are decided exactly") {
  const Material mirror{.diffuse = Color{0.1f}, .reflect = 0.5};
  Everything scene;
  // The ball is so small that rays that leave it start next to the ground.
  scene.add(Sphere{.center = {0, -1001, 3}, .radius = 1000}, mirror);
  scene.add(Sphere{.center = {0, -0.9985, 3}, .radius = 0.0015}, mirror);
  scene.add(PointLight{.position = {1, 4, 1}, .power = Color{300}});
  const Camera near_it{.position = {0, -0.997, 2.995}};
  RenderStatistics taken;
  Image image(120, 90);
  render(image, near_it, scene, WhittedIntegrator{.depth = 5}, {.statistics = &taken});
  CHECK(wrong_pixels(scene, near_it, 120, 90, 5) == 0);
  CHECK(taken.in_doubt > 100);

  // The later of two balls is larger, by less than double resolves. A third ball, equal to it, is never seen.
  Everything balls;
  balls.add(Plane{.normal = {0, 0, 1}, .distance = 3}, Material{.reflect = 1});
  balls.add(Sphere{.center = {0, 0, -4}, .radius = 1}, Color{1, 0, 0});
  balls.add(Sphere{.center = {0, 0, -4}, .radius = 1 + 0x1p-36}, Color{0, 1, 0});
  balls.add(AnySurface(Sphere{.center = {0, 0, -4}, .radius = 1 + 0x1p-36}), Color{0, 0, 1});
  balls.add(AmbientLight{Color{1}});
  CHECK(wrong_pixels(balls, Camera{}, 90, 70, 2) == 0);
  Image mirrored(90, 70);
  render(mirrored, Camera{}, balls, WhittedIntegrator{});
  CHECK(count_pixels(mirrored, [&](int x, int y) { return mirrored(x, y) == Color{0, 1, 0}; }) > 20);
  CHECK(count_pixels(mirrored, [&](int x, int y) { return mirrored(x, y).r + mirrored(x, y).b > 0; }) == 0);
}

TEST_CASE("by tiles, long paths look as they do ray by ray, and do not overflow the stack") {
  const auto hall = hall_of_mirrors();
  for (const int depth : {31, 32, 33, 34, 60}) {
    CAPTURE(depth);
    CHECK(wrong_pixels(hall, Camera{}, 61, 43, depth) == 0);
  }
  CHECK(wrong_pixels(hall, Camera{}, 9, 7, 1000) == 0);  // maximum of scene files
}

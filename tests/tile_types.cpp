#include <protostar/accel/render_tiles.hpp>
#include <protostar/any_scene.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "support/catch.hpp"
#include "support/pictures.hpp"

using namespace protostar;

namespace {

/// Adds spheres, two tilted planes of different normals, and a light. No normal is that of the first surface.
void add_spheres_and_planes(auto& scene) {
  scene.add(Sphere{.center = {0, 0, 4}, .radius = 1}, Color{1, 0.3f, 0});
  scene.add(Sphere{.center = {1.5, 0.5, 5}, .radius = 1}, Material{.diffuse = Color{0.2f}, .reflect = 0.5f});
  scene.add(Plane{.normal = {0.1, 2, -0.3}, .distance = -2}, Color{0.5f});
  scene.add(Plane{.normal = {-0.4, 0.2, -1}, .distance = -9}, Color{0.3f, 0.4f, 0.6f});
  scene.add(PointLight{.position = {-2, 4, 0}, .power = Color{300}});
}

/// Counts the pixels that differ between a picture by tiles and one ray by ray.
int different_by_tiles(const auto& scene, const Camera& camera, const auto& integrator) {
  const int samples = camera.has_lens() ? 4 : 1;
  Image tiled(64, 48), alone(64, 48);
  render(tiled, camera, scene, integrator, {.samples = samples, .tiles = true});
  render(alone, camera, scene, integrator, {.samples = samples, .tiles = false});
  return different_pixels(tiled, alone);
}

}  // namespace

TEST_CASE("a scene that names no type of surface shows its sky, by tiles as ray by ray") {
  Scene<> scene;
  scene.set_sky(Color{0.25f, 0.5f, 1});
  const auto accelerated = accelerate(scene);
  for (const bool tiles : {false, true}) {
    CAPTURE(tiles);
    Image image(19, 3), by_view(19, 3);
    render(image, Camera{}, scene, WhittedIntegrator{}, {.samples = 2, .tiles = tiles});
    render(by_view, Camera{}, accelerated, WhittedIntegrator{}, {.samples = 2, .tiles = tiles});
    int other = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        other += image(x, y) != *scene.sky() || by_view(x, y) != *scene.sky();
    CHECK(other == 0);
  }
}

TEST_CASE("scenes of two and of more types of surfaces are drawn by tiles as ray by ray, by each camera") {
  Scene<Sphere, Plane> of_two;
  add_spheres_and_planes(of_two);
  AnyScene of_any;
  add_spheres_and_planes(of_any);
  of_any.add(Parallelogram{{-2, -1, 4}, {1, 0.5, 0.2}, {0.1, 1, -0.5}}, Color{0.9f, 0.8f, 0.1f});
  of_any.add(Box{{-0.5, -1.5, 2.5}, {0.5, -1, 3}}, Color{0.4f, 0.9f, 0.4f});
  const Camera pinhole = Camera::look_at({0.2, 0.4, -1}, {0, 0, 4}), lens = pinhole.with_lens(0.2, 4),
               parallel = Camera::orthographic({0.2, 0.4, -1}, {0, 0, 1}, {0, 1, 0}, 5);
  for (const Camera* const camera : {&pinhole, &lens, &parallel}) {
    CAPTURE(camera->has_lens(), camera->is_orthographic());
    const auto check = [&](const auto& integrator) {
      CHECK(different_by_tiles(of_two, *camera, integrator) == 0);
      CHECK(different_by_tiles(of_any, *camera, integrator) == 0);
    };
    check(NormalIntegrator{});
    check(DiffuseIntegrator{});
    check(ShadowIntegrator{});
    check(WhittedIntegrator{.depth = 3});
  }
}

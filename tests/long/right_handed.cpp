// Tests of scenes in right-handed coordinates, as most modeling programs write them: x to the right, y up,
// and the camera looks along -z. Protostar's coordinates are left-handed: the default camera looks along z.
#include <protostar/accel/render_tiles.hpp>
#include <protostar/camera.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/drawn_alike.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"

using namespace protostar;

namespace {

const Color red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1};

/// Returns v with its z multiplied by z; −1 turns a right-handed scene into a left-handed one and back.
Vec3 turned_z(const Vec3& v, double z) { return {v.x, v.y, z * v.z}; }

/// Returns a scene that is not its own mirror image, seen from the origin along z for z = 1, along -z for −1.
auto scene_along(double z) {
  Scene<Sphere, Plane, Box, Mesh> scene;
  scene.add(Sphere{.center = turned_z({1.5, 0.25, 4}, z), .radius = 0.5}, red);
  scene.add(Sphere{.center = turned_z({-1.25, 0.5, 5}, z), .radius = 0.75}, green);
  scene.add(Plane{.normal = turned_z({0.125, 1, -0.25}, z), .distance = -1.5}, Color{0.75f});
  const Point corner = turned_z({0.25, 0.75, 3}, z), opposite = turned_z({0.75, 1.25, 4}, z);
  scene.add(Box{.min = min(corner, opposite), .max = max(corner, opposite)}, blue);
  MeshData data = meshes::box(2);
  for (Point& vertex : data.vertices) vertex = turned_z(0.25 * vertex + Vec3{-0.5, -0.75, 3}, z);
  scene.add(Mesh(std::move(data), {.threads = 1}), Color{1, 1, 0});
  scene.add(PointLight{.position = turned_z({2, 5, -1}, z), .power = Color{600}});
  return scene;
}

}  // namespace

TEST_CASE("a camera for right-handed scenes shows x to the right when it looks along -z") {
  const Camera camera = Camera::look_at_right_handed({0, 0, 0}, {0, 0, -1});
  CHECK(camera(0, 0).direction == Vec3{0, 0, -1});
  CHECK(camera(1, 0).direction.x > 0.7);
  CHECK(camera(0, 1).direction.y > 0.7);
  // A camera made by look_at with the same arguments shows the mirror image.
  CHECK(Camera::look_at({0, 0, 0}, {0, 0, -1})(1, 0).direction.x < -0.7);

  Scene<Sphere> scene;
  scene.add(Sphere{.center = {2, 0, -4}, .radius = 1}, red);
  scene.add(Sphere{.center = {-2, 0, -4}, .radius = 1}, green);
  scene.add(Sphere{.center = {0, 2, -4}, .radius = 1}, blue);
  Image image(96, 96);
  for (const bool tiles : {true, false}) {
    render(image, camera, scene, ColorIntegrator{}, {.tiles = tiles});
    CHECK(image(72, 48) == red);
    CHECK(image(24, 48) == green);
    CHECK(image(48, 24) == blue);
    CHECK(image(48, 72) == Color{0});
  }
}

TEST_CASE("look_at and look_at_right_handed mirror each other, and refuse the same arguments") {
  const Point position{1, 2, 3}, target{-2, 0.5, -7};
  const Vec3 upward{0.1, 1, 0.2};
  const Camera left = Camera::look_at(position, target, upward, 40);
  const Camera right = Camera::look_at_right_handed(position, target, upward, 40);
  for (const double u : {-0.75, 0.0, 0.5})
    for (const double v : {-0.5, 0.0, 1.0}) {
      CHECK(right(u, v).origin == left(-u, v).origin);
      CHECK(right(u, v).direction == left(-u, v).direction);
    }
  CHECK_THROWS_AS(Camera::look_at_right_handed(position, position), std::invalid_argument);
  CHECK_THROWS_AS(Camera::look_at_right_handed(position, target, target - position), std::invalid_argument);
}

TEST_CASE("a right-handed scene has the same picture as its left-handed twin, by tiles and ray by ray") {
  const auto right_handed = scene_along(-1), twin = scene_along(1);
  const Vec3 ahead{0, 0, 1}, back{0, 0, -1}, up{0, 1, 0};
  const Point o{0};
  struct {
    const char* what;
    Camera for_right, for_twin;
  } const rows[] = {
      {"look_at", Camera::look_at_right_handed({0.5, 0.25, 0}, {0.25, 0, -4}),
       Camera::look_at({0.5, 0.25, 0}, {0.25, 0, 4})},
      {"perspective", Camera::perspective(o, back, up, 70).mirrored(), Camera::perspective(o, ahead, up, 70)},
      {"sensor", Camera::sensor(o, back, up, 0.5).mirrored(), Camera::sensor(o, ahead, up, 0.5)},
      {"viewport", Camera::viewport(o, back, up, 2, 1.5, 1).mirrored(),
       Camera::viewport(o, ahead, up, 2, 1.5, 1)},
      {"orthographic", Camera::orthographic(o, back, up, 5).mirrored(),
       Camera::orthographic(o, ahead, up, 5)},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    for (const int samples : {0, 3}) {
      Image expected(60, 45), tiled(60, 45), plain(60, 45);
      render(expected, row.for_twin, twin, ShadowIntegrator{}, {.samples = samples, .tiles = false});
      render(tiled, row.for_right, right_handed, ShadowIntegrator{}, {.samples = samples});
      render(plain, row.for_right, right_handed, ShadowIntegrator{}, {.samples = samples, .tiles = false});
      CHECK(different_pixels(plain, expected) == 0);
      CHECK(different_pixels(tiled, expected) == 0);
    }
    const DrawnAlike alike = drawn_alike(right_handed, row.for_right);
    CHECK(alike.lit > 500);
    CHECK(alike.different == 0);
  }
}

TEST_CASE("a camera mirrored twice is unchanged") {
  const Camera camera = Camera::viewport({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 2, 1, 3),
               twice = camera.mirrored().mirrored();
  CHECK(twice.right == camera.right);
  CHECK(twice.film_right == camera.film_right);
  CHECK(camera.mirrored()(0.5, 0.25).origin == camera(-0.5, 0.25).origin);
}

#include <cmath>
#include <limits>
#include <numbers>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/cylinder.hpp"
#include "support/pictures.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// Returns a ball of radius 1 around (0, 0, 3) on the ground y = −1.
Scene<Sphere, Plane> ball_on_ground() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1, 0.5f, 0.25f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f, 1, 0});
  return scene;
}

const Ray at_ball{{0, 0, 0}, {0, 0, 1}};
const Ray at_ground{{4, 0, 3}, {0, -1, 0}};
const Ray at_nothing{{0, 0, 0}, {0, 1, 0}};

}  // namespace

TEST_CASE("binary: white where there is a surface, black where there is none") {
  const auto scene = ball_on_ground();
  CHECK(BinaryIntegrator{}.radiance(at_ball, scene) == Color{1});
  CHECK(BinaryIntegrator{}.radiance(at_ground, scene) == Color{1});
  CHECK(BinaryIntegrator{}.radiance(at_nothing, scene) == Color{0});
}

TEST_CASE("depth: the reciprocal of the distance") {
  const auto scene = ball_on_ground();
  CHECK(DepthIntegrator{}.radiance(at_ball, scene) == Color{0.5f});
  CHECK(DepthIntegrator{}.radiance(at_ground, scene) == Color{1});
  CHECK(DepthIntegrator{}.radiance({{0, 0, -6}, {0, 0, 1}}, scene) == Color{0.125f});
  CHECK(DepthIntegrator{}.radiance({{0, 0, 2.75}, {0, 0, -1}}, scene) == Color{1 / 0.75f});
  CHECK(DepthIntegrator{}.radiance(at_nothing, scene) == Color{0});
}

TEST_CASE("normal: components mapped from [−1, 1] to [0, 1], the surface's own normal also from behind") {
  const auto scene = ball_on_ground();
  CHECK(NormalIntegrator{}.radiance(at_ball, scene) == Color{0.5f, 0.5f, 0});
  CHECK(NormalIntegrator{}.radiance(at_ground, scene) == Color{0.5f, 1, 0.5f});
  CHECK(NormalIntegrator{}.radiance({{0, -5, 0}, {0, 1, 0}}, scene) == Color{0.5f, 1, 0.5f});
  CHECK(NormalIntegrator{}.radiance({{0, 0, 3}, {1, 0, 0}}, scene) == Color{1, 0.5f, 0.5f});
  CHECK(NormalIntegrator{}.radiance(at_nothing, scene) == Color{0});
}

TEST_CASE("color: the material's color without shading") {
  const auto scene = ball_on_ground();
  CHECK(ColorIntegrator{}.radiance(at_ball, scene) == Color{1, 0.5f, 0.25f});
  CHECK(ColorIntegrator{}.radiance(at_ground, scene) == Color{0.5f, 1, 0});
  CHECK(ColorIntegrator{}.radiance(at_nothing, scene) == Color{0});
}

TEST_CASE("diffuse: color times irradiance, summed over the lights, without shadows") {
  auto scene = ball_on_ground();
  scene.add(PointLight{.position = {0, 0, 1}, .power = Color{four_pi}});  // 1 in front of the ball
  CHECK(near(DiffuseIntegrator{}.radiance(at_ball, scene), {1, 0.5f, 0.25f}));
  scene.add(PointLight{.position = {0, 0, 0}, .power = Color{four_pi, 0, 8 * four_pi}});  // 2 in front of it
  CHECK(near(DiffuseIntegrator{}.radiance(at_ball, scene), {1.25f, 0.5f, 0.75f}));
  CHECK(DiffuseIntegrator{}.radiance(at_nothing, scene) == Color{0});

  auto hidden = ball_on_ground();
  hidden.add(PointLight{.position = {0, 3, 3}, .power = Color{16 * four_pi}});  // above the ball
  CHECK(near(DiffuseIntegrator{}.radiance({{0, -0.5, 1.5}, {0, -1, 1}}, hidden),
             Color{0.5f, 1, 0} * static_cast<float>(16 * 4 / std::pow(17, 1.5))));
}

TEST_CASE("diffuse: surfaces are two-sided, and only lights on the visible side count") {
  Scene<Plane> scene;
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 2}, Color{1});
  scene.add(PointLight{.position = {0, 0, 0}, .power = Color{4 * four_pi}});
  CHECK(near(DiffuseIntegrator{}.radiance({{0, 0, 1}, {0, 0, 1}}, scene), Color{1}));
  CHECK(near(ShadowIntegrator{}.radiance({{0, 0, 1}, {0, 0, 1}}, scene), Color{1}));
  CHECK(DiffuseIntegrator{}.radiance({{0, 0, 9}, {0, 0, -1}}, scene) == Color{0});
  CHECK(ShadowIntegrator{}.radiance({{0, 0, 9}, {0, 0, -1}}, scene) == Color{0});
}

TEST_CASE("shadow: as diffuse, from the lights that are not occluded") {
  auto scene = ball_on_ground();
  scene.add(PointLight{.position = {0, 3, 3}, .power = Color{16 * four_pi}});  // above the ball
  const Ray under_ball{{0, -0.5, 1.5}, {0, -1, 1}};  // hits the ground at (0, −1, 2)
  CHECK(DiffuseIntegrator{}.radiance(under_ball, scene) != Color{0});
  CHECK(ShadowIntegrator{}.radiance(under_ball, scene) == Color{0});
  CHECK(ShadowIntegrator{}.radiance(at_ground, scene) == DiffuseIntegrator{}.radiance(at_ground, scene));
  CHECK(ShadowIntegrator{}.radiance(at_ground, scene) != Color{0});
  CHECK(ShadowIntegrator{}.radiance(at_nothing, scene) == Color{0});

  // A second light, visible from that point.
  scene.add(PointLight{.position = {0, 0, 2}, .power = Color{four_pi}});
  auto alone = ball_on_ground();
  alone.add(scene.lights()[1]);
  CHECK(ShadowIntegrator{}.radiance({{1, 0, 0}, {0, -1, 0}}, scene) != Color{0});
  CHECK(ShadowIntegrator{}.radiance(under_ball, alone) == ShadowIntegrator{}.radiance(under_ball, scene));
}

TEST_CASE("shadow: a surface beyond the light casts none, nor does one that the light touches") {
  Scene<Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{1});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 2}, Color{1});  // a ceiling
  const Ray down{{0, 1, 0}, {0, -1, 0}};
  const auto lit_from = [&](double height) {
    auto lit = scene;
    lit.add(PointLight{.position = {0, height, 0}, .power = Color{1}});
    return ShadowIntegrator{}.radiance(down, lit) != Color{0};
  };
  CHECK(lit_from(1.9));
  CHECK(lit_from(2));
  CHECK_FALSE(lit_from(2.1));
}

TEST_CASE("transparency: white light from behind, times the color at every crossing") {
  auto scene = ball_on_ground();
  const Color ball{1, 0.5f, 0.25f}, ground{0.5f, 1, 0};
  CHECK(TransparencyIntegrator{}.radiance(at_nothing, scene) == Color{1});
  CHECK(TransparencyIntegrator{}.radiance(at_ball, scene) == ball * ball);
  CHECK(TransparencyIntegrator{}.radiance({{0, 0, 3}, {0, 0, 1}}, scene) == ball);         // from inside
  CHECK(TransparencyIntegrator{}.radiance({{0, 1, 0}, {0, 0, 1}}, scene) == ball * ball);  // touching
  CHECK(TransparencyIntegrator{}.radiance(at_ground, scene) == ground);
  CHECK(TransparencyIntegrator{}.radiance({{0, 5, 3}, {0, -1, 0}}, scene) == ball * ball * ground);
}

TEST_CASE("transparency: there is no limit to the number of crossings") {
  Scene<Sphere> scene;
  for (int i = 1; i <= 100; ++i)
    scene.add(Sphere{.center = {0, 0, 200}, .radius = static_cast<double>(i)}, Color{0.995f, 1, 2});
  const Color light = TransparencyIntegrator{}.radiance({{0, 0, 0}, {0, 0, 1}}, scene);
  CHECK(std::abs(light.r / std::pow(double{0.995f}, 200) - 1) <= 200 * 0x1.0001p-24);  // 200 roundings
  CHECK(light.g == 1);
  CHECK(light.b == std::numeric_limits<float>::max());  // 2^200 exceeds float

  scene.add(Sphere{.center = {0, 0, 200}, .radius = 0.5}, Color{1, 1, 0});  // no blue
  const Color black = TransparencyIntegrator{}.radiance({{0, 0, 0}, {0, 0, 1}}, scene);
  CHECK(black == Color{light.r, light.g, 0});
}

TEST_CASE("every integrator is defined for scenes without surfaces or lights") {
  const auto check_background = [](const auto& empty) {
    CHECK(BinaryIntegrator{}.radiance(at_ball, empty) == Color{0});
    CHECK(DepthIntegrator{}.radiance(at_ball, empty) == Color{0});
    CHECK(NormalIntegrator{}.radiance(at_ball, empty) == Color{0});
    CHECK(ColorIntegrator{}.radiance(at_ball, empty) == Color{0});
    CHECK(DiffuseIntegrator{}.radiance(at_ball, empty) == Color{0});
    CHECK(ShadowIntegrator{}.radiance(at_ball, empty) == Color{0});
    CHECK(TransparencyIntegrator{}.radiance(at_ball, empty) == Color{1});
  };
  check_background(Scene<>{});  // not even a type of surface
  check_background(Scene<Sphere>{});
  const auto dark = ball_on_ground();
  CHECK(DiffuseIntegrator{}.radiance(at_ball, dark) == Color{0});
  CHECK(ShadowIntegrator{}.radiance(at_ball, dark) == Color{0});
}

TEST_CASE("a negative radius changes the picture of the normal integrator and of no other") {
  const auto of_radius = [](double sign) {
    Scene<Sphere> scene;
    scene.add(Sphere{.center = {0, 0, 3}, .radius = sign}, Color{0.8f, 0.5f, 0.2f});
    scene.add(Sphere{.center = {0.5, 1.5, 2}, .radius = 0.3 * sign}, Color{0.8f, 0.5f, 0.2f});
    scene.add(PointLight{.position = {1, 3, 0}, .power = Color{100}});
    return scene;
  };
  const auto differences = [&](const auto& integrator) {
    return different_pixels(ray_by_ray(Camera{}, 200, 150, of_radius(1), integrator),
                            ray_by_ray(Camera{}, 200, 150, of_radius(-1), integrator));
  };
  CHECK(differences(BinaryIntegrator{}) == 0);
  CHECK(differences(DepthIntegrator{}) == 0);
  CHECK(differences(ColorIntegrator{}) == 0);
  CHECK(differences(DiffuseIntegrator{}) == 0);
  CHECK(differences(ShadowIntegrator{}) == 0);
  CHECK(differences(TransparencyIntegrator{}) == 0);
  CHECK(differences(NormalIntegrator{}) > 1000);
}

TEST_CASE("every picture of three spheres is the same with AnySurface") {
  const auto differences = [](const auto& integrator) {
    return different_pixels(ray_by_ray(Camera{}, 200, 150, three_spheres(), integrator),
                            ray_by_ray(Camera{}, 200, 150, three_spheres<AnySurface>(), integrator));
  };
  CHECK(differences(BinaryIntegrator{}) == 0);
  CHECK(differences(DepthIntegrator{}) == 0);
  CHECK(differences(NormalIntegrator{}) == 0);
  CHECK(differences(ColorIntegrator{}) == 0);
  CHECK(differences(DiffuseIntegrator{}) == 0);
  CHECK(differences(ShadowIntegrator{}) == 0);
  CHECK(differences(TransparencyIntegrator{}) == 0);
}

namespace {
template <Surface S>
void check_pictures_of_cylinder() {
  // A cylinder does not shadow its own points that face a light: from outside and from inside, the pictures
  // with and without shadows are equal. One crossing too many or too few would change a pixel.
  const Color color{0.5f, 0.25f, 0.75f};
  const auto scene_of = [&](double radius, const Point& light) {
    Scene<S> scene;
    scene.add(Cylinder{.radius = radius}, color);
    scene.add(PointLight{.position = light, .power = Color{100}});
    return scene;
  };
  for (const double radius : {0.01, 0.7, 1.0, 3.3, 1000.0}) {
    CAPTURE(radius);
    const Camera outside{.position = {0, 0, -3 * radius}};
    const auto from_outside = scene_of(radius, {2 * radius, radius, -3 * radius});
    CHECK(different_pixels(ray_by_ray(outside, 200, 150, from_outside, DiffuseIntegrator{}),
                           ray_by_ray(outside, 200, 150, from_outside, ShadowIntegrator{})) == 0);
    const Image glass = ray_by_ray(outside, 200, 150, from_outside, TransparencyIntegrator{});
    const Image mask = ray_by_ray(outside, 200, 150, from_outside, BinaryIntegrator{});
    CHECK(count_pixels(glass, [&](int x, int y) {
            return glass(x, y) != (mask(x, y) == Color{1} ? color * color : Color{1});
          }) == 0);

    const Camera inside{.position = {0.3 * radius, 0, 0.1 * radius}};
    const auto from_inside = scene_of(radius, {-0.5 * radius, 0, 0.5 * radius});
    const Image lit = ray_by_ray(inside, 200, 150, from_inside, DiffuseIntegrator{});
    CHECK(count_pixels(lit, [&](int x, int y) { return lit(x, y) == Color{0}; }) == 0);
    CHECK(different_pixels(lit, ray_by_ray(inside, 200, 150, from_inside, ShadowIntegrator{})) == 0);
    const Image from_within = ray_by_ray(inside, 200, 150, from_inside, TransparencyIntegrator{});
    CHECK(count_pixels(from_within, [&](int x, int y) { return from_within(x, y) != color; }) == 0);
  }
}
}  // namespace

TEST_CASE("pictures of a user-defined surface show no acne") { check_pictures_of_cylinder<Cylinder>(); }

TEST_CASE("pictures of a user-defined surface in AnySurface show no acne") {
  check_pictures_of_cylinder<AnySurface>();
}

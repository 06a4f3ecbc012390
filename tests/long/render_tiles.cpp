#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/everything.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// User-defined sphere with bounds, but without packet functions. Its normal_at accepts any GLM vector and
/// nothing else.
struct BoundedBall {
  Point center{0};
  double radius = 1;

  std::optional<double> intersect(const Ray& ray, Interval range) const {
    const Vec3 l = center - ray.origin, d = ray.direction;
    return quadratic_roots(dot(d, d), dot(d, l), dot(l, l) - radius * radius,
                           dot(d, l) * dot(d, l) - dot(d, d) * (dot(l, l) - radius * radius))
        .first_in(range);
  }
  auto normal_at(const auto& point) const { return glm::normalize(point - center); }
  Bounds bounds() const { return {center - Vec3{1.001 * radius}, center + Vec3{1.001 * radius}}; }
};
static_assert(SurfaceWithBounds<BoundedBall> && !SurfaceWithBounds<Cylinder>);

/// BoundedBall with bounds that are far too large, and beyond float.
struct BallSomewhere : BoundedBall {
  Bounds bounds() const { return {Point{-1e200}, Point{1e200}}; }
};

/// Calls test(name, integrator) with one integrator for each path through the tiles: any hit, closest hit,
/// shadow rays, and all hits. The others shade the closest hit as NormalIntegrator does, and each takes long
/// to compile; the golden pictures cover them.
void for_each_integrator(const auto& test) {
  test("binary", BinaryIntegrator{});
  test("normal", NormalIntegrator{});
  test("shadow", ShadowIntegrator{});
  test("transparency", TransparencyIntegrator{});
}

/// Checks that the picture of an integrator equals the one drawn ray by ray, and that its statistics are
/// plausible.
void check_picture(const auto& scene, const Camera& camera, int width, int height, const auto& integrator) {
  RenderStatistics taken;
  Image image(width, height);
  render(image, camera, scene, integrator, {.statistics = &taken});
  CHECK(different_bytes(image, ray_by_ray(camera, width, height, scene, integrator)) == 0);
  CHECK(taken.pixels_skipped + taken.camera_rays == static_cast<std::uint64_t>(width * height));
  if (!std::is_same_v<decltype(integrator), const ShadowIntegrator&>) CHECK(taken.other_rays == 0);
}

void check_pictures(const Everything& scene, const Camera& camera, int width, int height) {
  for_each_integrator([&](const std::string& name, const auto& integrator) {
    INFO(name << ", " << width << "x" << height);
    check_picture(scene, camera, width, height, integrator);
  });
}

template <class S>
S with_lights(S scene, const Point& around = Point{0}) {
  scene.add(PointLight{.position = around + Vec3{1, 4, -2}, .power = Color{300, 200, 100}});
  scene.add(PointLight{.position = around + Vec3{-5, 2, 1}, .power = Color{50, 100, 300}});
  scene.add(PointLight{.position = around + Vec3{0, 0.1, 3}, .power = Color{10}});
  return scene;
}

Everything random_spheres(int count, double least, double most, const Point& around) {
  Random random(static_cast<std::uint64_t>(count));
  Everything scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = around.y - 2}, Color{0.5f});
  for (int i = 0; i < count; ++i) {
    const Sphere sphere{around + Vec3{0, 0, 5} + random.point(4),
                        std::exp2(random.real(std::log2(least), std::log2(most)))};
    if (i % 10 == 9)
      scene.add(AnySurface(sphere), random.color());
    else
      scene.add(sphere, random.color());
  }
  return with_lights(std::move(scene), around);
}

}  // namespace

TEST_CASE("by tiles, pictures of any size are those drawn ray by ray") {
  const auto scene = three_spheres_and_nothing_else();
  struct {
    int width, height;
  } const sizes[] = {{1, 1}, {3, 1}, {1, 3}, {16, 16}, {17, 63}, {65, 129}, {641, 479}};
  for (const auto& [width, height] : sizes) check_pictures(scene, Camera{}, width, height);
}

TEST_CASE("by tiles, pictures of many spheres are those drawn ray by ray") {
  check_pictures(random_spheres(300, 0.002, 2, Point{0}), Camera{}, 101, 67);
  check_pictures(random_spheres(40, 0.1, 1, Point{0}), Camera{}, 131, 70);
  check_pictures(random_spheres(2100, 0.01, 0.3, Point{0}), Camera{}, 70,
                 33);  // in a tree
}

TEST_CASE("by tiles, pictures far from the origin are those drawn ray by ray") {
  const Point there{65537, -65537, 65537};
  const auto scene = random_spheres(60, 0.1, 1, there);
  check_pictures(scene, Camera{.position = there}, 80, 60);
  check_pictures(scene, Camera{.position = there, .right = {1e-2, 0, 0}, .up = {0, 1e-2, 0}}, 40, 30);
}

TEST_CASE("by tiles, pictures from any camera are those drawn ray by ray") {
  const auto scene = random_spheres(20, 0.1, 3, Point{0});
  for (const Camera& camera :
       {Camera{.right = {-1, 0, 0}}, Camera{.forward = {0, 0, -1}},
        Camera{.right = {10, 0, 0}, .up = {0, 10, 0}}, Camera{.position = {0, -2, 0}},  // on the plane
        Camera{.position = scene.surfaces<Sphere>()[3].center},
        Camera{.position = {0, 5, 0}, .right = {1, 0.5, 0}, .up = {0.2, 0.1, 3}, .forward = {0.1, -1, 2}}})
    check_pictures(scene, camera, 67, 50);
}

TEST_CASE("by tiles, pictures of rays that start on a film are those drawn ray by ray") {
  const auto few = random_spheres(20, 0.1, 3, Point{0}), some = random_spheres(300, 0.002, 2, Point{0}),
             many = random_spheres(2100, 0.01, 0.3, Point{0});
  const Vec3 ahead{0, 0, 1}, up{0, 1, 0};
  const Point inside = few.surfaces<Sphere>()[3].center;
  for (const Camera& camera :
       {Camera::sensor({0, 0, 2}, ahead, up, 0.7), Camera::sensor(inside, ahead, up, 2),
        Camera::viewport({0, 0, -1}, ahead, up, 6, 6, 5),  // in the midst of the spheres
        Camera::orthographic(Point{0}, ahead, up, 7), Camera::orthographic(inside, {0.6, 0, 0.8}, up, 3),
        Camera::orthographic({0, 0, 1e6}, -ahead, up, 8),
        // Cameras whose rays start on a line, and whose rays cross each other.
        Camera{.position = {0, 0, 1}, .film_right = {3, 0, 0}},
        Camera{.position = {0, 0, 1}, .film_right = {-3, 0, 0}, .film_up = {0, -3, 1}}}) {
    CAPTURE(camera.position.x, camera.position.z, camera.film_right.x);
    check_pictures(few, camera, cases(45, 67), cases(33, 50));
    check_pictures(some, camera, cases(34, 51), cases(22, 33));
    check_pictures(many, camera, cases(18, 35), cases(9, 17));
  }
  const Point there{65537, -65537, 65537};
  const auto far_away = random_spheres(60, 0.1, 1, there);
  check_pictures(far_away, Camera::orthographic(there, ahead, up, 6), 40, 30);
  check_pictures(far_away, Camera::sensor(there, ahead, up, 1), 40, 30);
}

TEST_CASE("by tiles, rays that start on a film and only touch a surface are decided as they are ray by ray") {
  const int width = 61, height = 43;
  for (const Camera& camera : {Camera::sensor(Point{0}, {0, 0, 1}, {0, 1, 0}, 0.5),
                               Camera::orthographic(Point{0}, {0, 0, 1}, {0, 1, 0}, 2)}) {
    Random random(9);
    Everything scene;
    for (int i = 0; i < 150; ++i) {
      const int pixel = static_cast<int>(random.bits() % (width * height));
      const Ray ray = camera.through_pixel(pixel % width, pixel / width, width, height);
      const double radius = random.real(0.01, 0.4);
      const Sphere touched{
          ray.at(random.real(-0.4, 8)) + radius * normalize(cross(ray.direction, random.direction())),
          radius};
      if (i % 5 == 0)
        scene.add(AnySurface(touched), random.color());
      else
        scene.add(touched, random.color());
      // A sphere on which the ray starts, up to rounding.
      if (i % 10 == 0) scene.add(Sphere{ray.origin + radius * random.direction(), radius}, random.color());
    }
    check_pictures(with_lights(scene), camera, width, height);
  }
}

TEST_CASE("by tiles, surfaces that coincide, touch or lie in each other look as they do ray by ray") {
  Everything scene;
  Random random(5);
  const auto add = [&](const auto& surface) { scene.add(surface, random.color()); };
  for (int i = 0; i < 3; ++i) add(Sphere{.center = {-2, 0, 5}, .radius = i == 1 ? -1.0 : 1.0});  // coincide
  for (int i = 0; i < 6; ++i) add(Sphere{.center = {0.5, 0, 5}, .radius = std::exp2(-i)});       // nested
  for (int i = 0; i < 6; ++i)
    add(Sphere{.center = {0, -1 + std::exp2(-i), 4}, .radius = std::exp2(-i)});       // tangent
  for (int i = 0; i < 3; ++i) add(Sphere{.center = {2.0 + i, 0, 5}, .radius = 0.5});  // in a row
  add(Sphere{.center = {0, 0, 0}, .radius = 0.25});                                   // around the camera
  for (int i = 1; i < 4; ++i) add(Plane{.normal = {0, 1.0 * i, 0}, .distance = -1.0 * i});
  add(Plane{.normal = {0, 0, 1}, .distance = 6});
  check_pictures(with_lights(scene), Camera{}, 120, 90);
  // In pictures of odd sides, rays of the middle row and column lie in planes of symmetry and are tangent.
  check_pictures(with_lights(scene), Camera{}, 41, 31);
}

TEST_CASE("by tiles, rays that only touch a surface are decided as they are ray by ray") {
  const int width = 61, height = 43;
  Random random(8);
  Everything scene;
  const auto touched = [&] {
    const int pixel = static_cast<int>(random.bits() % (width * height));
    const Ray ray = Camera{}.through_pixel(pixel % width, pixel / width, width, height);
    const double radius = random.real(0.01, 0.4);
    const Vec3 away = normalize(cross(ray.direction, random.direction()));
    return Sphere{ray.at(random.real(3, 8)) + radius * away, radius};
  };
  for (int i = 0; i < 150; ++i) scene.add(touched(), random.color());
  for (int i = 0; i < 30; ++i) scene.add(AnySurface(touched()), random.color());
  check_pictures(with_lights(scene), Camera{}, width, height);
}

// A tile treats AnySurface as the sphere around its bounds, so it tests the later of the two surfaces first.
TEST_CASE("by tiles, the earlier of two coinciding surfaces is seen, whichever is tested first") {
  Everything scene;
  for (int i = -1; i <= 1; ++i) {
    scene.add(Sphere{.center = {2.0 * i, 0, 5}, .radius = 1}, Color{1, 0, 0});
    scene.add(AnySurface(Sphere{.center = {2.0 * i, 0, 5}, .radius = 1}), Color{0, 1, 0});
  }
  check_pictures(with_lights(scene), Camera{}, 50, 40);
  Image image(50, 40);
  render(image, Camera{}, scene, ColorIntegrator{});
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y).r > 0; }) > 100);
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y).g > 0; }) == 0);
}

TEST_CASE("by tiles, surfaces of any kind look as they do ray by ray") {
  Random random(6);
  Everything any;
  Scene<BoundedBall, Cylinder> own;
  for (int i = 0; i < 20; ++i) {
    const Sphere sphere{Vec3{0, 0, 6} + random.point(3), random.real(0.1, 1)};
    const BoundedBall ball{Vec3{0, 0, 6} + random.point(3), random.real(0.1, 1)};
    any.add(AnySurface(sphere), random.color());
    any.add(AnySurface(ball), random.color());
    own.add(ball, random.color());
  }
  any.add(Plane{.normal = {0, 1, 0.1}, .distance = -2}, random.color());
  any.add(AnySurface(Plane{.normal = {0, 1, 0}, .distance = -2}), random.color());
  any.add(AnySurface(Cylinder{.radius = 9}), random.color());
  own.add(Cylinder{.radius = 8}, random.color());
  own.add(Cylinder{.radius = 0.5}, random.color());
  check_pictures(with_lights(any), Camera{}, 75, 50);
  for (const Camera& camera :
       {Camera{}, Camera{.position = {2, 0, -10}}}) {  // inside and outside of the cylinders
    check_picture(with_lights(own), camera, 75, 50, ShadowIntegrator{});
    check_picture(with_lights(own), camera, 75, 50, TransparencyIntegrator{});
  }
}

TEST_CASE("by tiles, surfaces whose bounds are beyond float, or overflow, look as they do ray by ray") {
  for (const int others : {5, 2100}) {  // candidates are found among all, or in a tree
    Everything scene = random_spheres(others, 0.01, 0.3, Point{0});
    scene.add(Sphere{.center = {1e120, 0, 0}, .radius = 1.7e120}, Color{0.5f, 0.7f, 0.9f});
    scene.add(AnySurface(BallSomewhere{BoundedBall{.center = {0.5, 0.5, 4}, .radius = 0.8}}),
              Color{0.9f, 0.5f, 0.2f});
    const bool is_small = cases(0, others > 5 ? 0 : 1, 1) == 0;
    check_pictures(scene, Camera{}, is_small ? 17 : 70, is_small ? 9 : 33);
  }
}

TEST_CASE("by tiles, textures, lights of every kind, a sky, mirrors and glass look as they do ray by ray") {
  Random random(12);
  Everything scene;
  const auto texture = [&] { return Checker{random.color(), random.color(), random.real(0.05, 0.8)}; };
  const auto material = [&](int i) {
    Material made{.diffuse = random.color()};
    if (i % 2 == 0) made.texture = texture();
    if (i % 3 == 0) made.specular = random.color(), made.shininess = random.real(1, 100);
    if (i % 4 == 1) made.reflect = random.real(0, 1);
    if (i % 5 == 1) made.refract = random.real(0, 1), made.ior = random.real(0.5, 2);
    return made;
  };
  for (int i = 0; i < 25; ++i) {
    const Sphere sphere{Vec3{0, 0, 6} + random.point(3), random.real(0.1, 1)};
    if (i % 5 == 4)
      scene.add(AnySurface(sphere), material(i));
    else
      scene.add(sphere, material(i));
  }
  scene.add(Plane{.normal = {0.1, 1, 0}, .distance = -2}, material(6));
  scene.add(AnySurface(Plane{.normal = {0, 0, 1}, .distance = 12}), material(0));
  scene.add(PointLight{.position = {1, 4, -2}, .power = Color{300, 200, 100}});
  scene.add(ConstantLight{.position = {-5, 2, 1}, .intensity = {0.1f, 0.2f, 0.3f}});
  scene.add(DirectionalLight{.direction = {1, 2, -1}, .intensity = {0.2f, 0.1f, 0.1f}});
  scene.add(SpotLight{
      .position = {0, 4, 4}, .direction = {0, -1, 0.3}, .angle = 35, .power = Color{200}, .fade = 15});
  scene.add(AmbientLight{{0.02f, 0.01f, 0.03f}});
  for (const bool has_sky : {false, true}) {
    if (has_sky) scene.set_sky({0.2f, 0.7f, 0.8f});
    for (const Camera& camera : {Camera{}, Camera::orthographic(Point{0}, {0, 0, 1}, {0, 1, 0}, 8)}) {
      check_pictures(scene, camera, 101, 67);
      Image image(101, 67);
      render(image, camera, scene, WhittedIntegrator{.depth = 5}, {.threads = 2});
      const Image expected = ray_by_ray(camera, 101, 67, scene, WhittedIntegrator{.depth = 5});
      CHECK(different_bytes(image, expected) == 0);
      const Image one_ray = ray_by_ray(camera, 101, 67, scene, WhittedIntegrator{.depth = 1});
      CHECK(different_bytes(image, one_ray) > 500);
    }
  }
}

TEST_CASE("by tiles, an empty scene is empty") {
  check_pictures(Everything{}, Camera{}, 33, 20);
  RenderStatistics taken;
  Image image(33, 20);
  render(image, Camera{}, Everything{}, DepthIntegrator{}, {.statistics = &taken});
  CHECK(taken.pixels_skipped == 33 * 20);
  CHECK(taken.surface_tests == 0);
}

TEST_CASE("the picture is the same with and without tiles, and for any number of threads") {
  const auto scene = three_spheres_and_nothing_else();
  for_each_integrator([&](const std::string& name, const auto& integrator) {
    INFO(name);
    const Image expected = ray_by_ray(Camera{}, 200, 150, scene, integrator);
    RenderStatistics first;
    for (const int threads : {1, 2, 5}) {
      RenderStatistics taken, none;
      Image by_tiles(200, 150), without(200, 150), accelerated(200, 150), only_accelerated(200, 150);
      render(by_tiles, Camera{}, scene, integrator, {.threads = threads, .statistics = &taken});
      render(without, Camera{}, scene, integrator, {.threads = threads, .tiles = false, .statistics = &none});
      render(accelerated, Camera{}, accelerate(scene), integrator, {.threads = threads});
      render(only_accelerated, Camera{}, accelerate(scene), integrator,
             {.threads = threads, .tiles = false, .statistics = &none});
      CHECK(different_bytes(by_tiles, expected) == 0);
      CHECK(different_bytes(without, expected) == 0);
      CHECK(different_bytes(accelerated, expected) == 0);
      CHECK(different_bytes(only_accelerated, expected) == 0);
      CHECK(none.camera_rays + none.other_rays + none.pixels_skipped + none.surface_tests == 0);
      if (threads == 1) first = taken;
      CHECK(taken.surface_tests == first.surface_tests);
      CHECK(taken.other_rays == first.other_rays);
      CHECK(taken.in_doubt == first.in_doubt);
      CHECK(taken.exact == first.exact);
    }
  });
}

TEST_CASE("few rays of a packet are in doubt") {
  Image image(320, 240);
  const auto check = [&](const auto& scene) {
    for_each_integrator([&](const std::string& name, const auto& integrator) {
      INFO(name);
      RenderStatistics taken;
      render(image, Camera{}, scene, integrator, {.statistics = &taken});
      const std::uint64_t tests = taken.surface_tests + taken.float_tests;
      CHECK(tests > 10000);
      CHECK(taken.in_doubt * 1000 < tests);
    });
  };
  check(three_spheres_and_nothing_else());
  check(random_spheres(300, 0.002, 2, Point{0}));
}

#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

/// User-defined sphere with bounds, but without packet functions. Its normal_at accepts any GLM vector and
/// nothing else.
struct Ball {
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
static_assert(SurfaceWithBounds<Ball> && !SurfaceWithBounds<Cylinder>);

/// Ball with bounds that are far too large, and beyond float.
struct BallSomewhere : Ball {
  Bounds bounds() const { return {Point{-1e200}, Point{1e200}}; }
};

/// Scene type of nearly all tests, since every integrator is compiled anew for each type.
using Everything = Scene<Sphere, Plane, AnySurface>;

/// Returns the number of pixels whose bytes differ between two pictures of one size.
int different_bytes(const Image& a, const Image& b) {
  return count_pixels(a, [&](int x, int y) { return std::memcmp(&a(x, y), &b(x, y), sizeof(Color)) != 0; });
}

/// Calls test(name, integrator) with one integrator for each path through the tiles: any hit, closest hit,
/// shadow rays, and all hits. The others shade the closest hit as NormalIntegrator does, and each takes long
/// to compile; the golden pictures cover them.
void for_each_integrator(const auto& test) {
  test("binary", BinaryIntegrator{});
  test("normal", NormalIntegrator{});
  test("shadow", ShadowIntegrator{});
  test("transparency", TransparencyIntegrator{});
}

/// Returns the picture drawn ray by ray, without render().
Image ray_by_ray(const Camera& camera, int width, int height, const auto& scene, const auto& integrator) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image(x, y) = integrator.radiance(camera.through_pixel(x, y, width, height), scene);
  return image;
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

Everything three_spheres_and_nothing_else() {
  Everything scene;
  for (const auto& [sphere, color] : the_three_spheres) scene.add(sphere, color);
  scene.add(light_of_the_three_spheres);
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
    check_pictures(few, camera, 67, 50);
    check_pictures(some, camera, 51, 33);
    check_pictures(many, camera, 35, 17);
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

TEST_CASE("a sensor does not see surfaces between it and its focal point, and tests none of them") {
  Everything scene;
  scene.add(Sphere{.center = {0, 0, -0.5}, .radius = 0.2}, Color{1});
  const Camera sensor = Camera::sensor(Point{0}, {0, 0, 1}, {0, 1, 0}, 1),
               pinhole{.position = {0, 0, -1}, .right = sensor.right, .up = sensor.up};
  const auto seen_by = [&](const Camera& camera, RenderStatistics& taken) {
    Image image(160, 120);
    render(image, camera, scene, BinaryIntegrator{}, {.statistics = &taken});
    return count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; });
  };
  RenderStatistics by_sensor, by_pinhole;
  CHECK(seen_by(pinhole, by_pinhole) > 1000);
  CHECK(seen_by(sensor, by_sensor) == 0);
  CHECK(by_sensor.surface_tests == 0);
  CHECK(by_sensor.pixels_skipped == 160 * 120);
  // A sphere that the sensor cuts is seen from inside.
  scene.add(Sphere{.center = {0, 0, 0}, .radius = 0.1}, Color{1});
  CHECK(seen_by(sensor, by_sensor) > 300);
}

TEST_CASE("tiles cull surfaces outside the view of any camera") {
  const Vec3 ahead{0, 0, 1}, up{0, 1, 0};
  for (const Camera& camera :
       {Camera{}, Camera::sensor(Point{0}, ahead, up, 0.5), Camera::orthographic(Point{0}, ahead, up, 10)})
    for (const int count : {60, 3000}) {
      Everything scene;
      Random random(10);
      for (int i = 0; i < count; ++i)
        scene.add(Sphere{Vec3{0, 0, 6} + random.point(5), 2 / std::sqrt(count)}, random.color());
      RenderStatistics taken;
      Image image(320, 240);
      render(image, camera, scene, BinaryIntegrator{}, {.statistics = &taken});
      CAPTURE(count, camera.film_right.x, taken.camera_rays, taken.surface_tests);
      const auto seen = count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; });
      CHECK(seen > 4000);
      CHECK(taken.camera_rays < 320 * 240);
      CHECK(taken.surface_tests < 5 * taken.camera_rays);
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
  Scene<Ball, Cylinder> own;
  for (int i = 0; i < 20; ++i) {
    const Sphere sphere{Vec3{0, 0, 6} + random.point(3), random.real(0.1, 1)};
    const Ball ball{Vec3{0, 0, 6} + random.point(3), random.real(0.1, 1)};
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
    scene.add(AnySurface(BallSomewhere{Ball{.center = {0.5, 0.5, 4}, .radius = 0.8}}),
              Color{0.9f, 0.5f, 0.2f});
    check_pictures(scene, Camera{}, 70, 33);
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
      CHECK(wrong_pixels(scene, camera, 93, 70, depth) == 0);
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

namespace {

/// User-defined integrator for single rays, with a shade function.
struct Headlight {
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray);
    return hit ? shade(*hit, scene) : Color{0};
  }
  Color shade(const Intersection& hit, const auto&) const {
    return hit.color() * static_cast<float>(std::abs(hit.normal().z));
  }
};

/// User-defined integrator with a sky, hence not black for rays that miss; asks for the closest hit, any hit
/// and all hits, also of secondary rays.
struct Mirrors {
  Color radiance(const Ray& ray, const Traceable auto& scene) const { return radiance(ray, scene, 3); }
  Color radiance(const Ray& ray, const auto& scene, int left) const {
    const auto hit = scene.intersect(ray);
    Color color{Vec3{0.5 + 0.5 * ray.direction.y}};
    scene.crossings(ray, Interval{0, 4}, [&](const Intersection& crossing) { color *= crossing.color(); });
    if (!hit || left == 0 || scene.occluded(ray, Interval{0, 0.5})) return color;
    const Vec3 n = hit->facing_normal(), d = ray.direction;
    return hit->color() * radiance(hit->leave(d - 2 * dot(d, n) * n), scene, left - 1) + 0.1f * color;
  }
};

/// User-defined integrator that asks for more than the closest hit of the camera ray: behind some t, beside
/// it, and of a ray that departs from a surface.
struct Curious {
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    Color color{0};
    const auto look = [&](const Ray& along, Interval range) {
      const auto hit = scene.intersect(along, range);
      color = 0.5f * color + (hit ? hit->color() : Color{1});
    };
    look(ray, {3, infinity});
    look(ray, {0, 3});
    look({ray.origin, ray.direction + Vec3{0.4, 0.1, 0}}, {});
    look({ray.origin + Vec3{0.4, 0.1, 0}, ray.direction}, {});
    look({ray.origin, ray.direction, the_three_spheres[0].sphere.departure()}, {});
    return color;
  }
};

/// User-defined integrator that takes packets.
struct Rings {
  using TakesPackets = Rings;
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray);
    return hit ? shade(*hit, scene) : background(ray, scene);
  }
  Color background(const auto&, const auto&) const { return {0, 0, 0.125f}; }
  template <class Hit>
  typename Hit::Light shade(const Hit& hit, const auto&) const {
    return hit.color() * to_float(1 / (1 + hit.t * hit.t));
  }
};

/// User-defined integrator that derives from one of the library, which takes packets, and draws something
/// else.
struct Facets : DepthIntegrator {
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray);
    return hit ? 0.25f * Color{floor(4.0 * hit->normal())} : Color{0.5f};
  }
};

/// User-defined integrator that takes packets and sees the lights where nothing is hit.
struct Glow {
  using TakesPackets = Glow;
  template <class R>
  typename R::Light radiance(const R& ray, const auto& scene) const {
    Color glow{0};
    for (const Light& light : scene.lights()) glow += light.irradiance(Point{0}, Vec3{0, 0, 1});
    return select(scene.occluded(ray, Interval{}), Color{0}, glow);
  }
};

/// User-defined integrator that takes packets and traces shadow rays with different ends, unlike those to a
/// light.
struct Bristles {
  using TakesPackets = Bristles;
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit, scene) : background(ray, scene);
  }
  Color background(const auto&, const auto&) const { return Color{0.5f}; }
  template <class Hit>
  typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    const auto bristle = 4.0 * hit.facing_normal();
    return select(scene.occluded(hit.leave(bristle), Interval{0, 1}), Color{0}, Color{1});
  }
};

}  // namespace

TEST_CASE("by tiles, a user's integrator draws the same picture as ray by ray") {
  const auto check = [](const auto& scene, const auto& integrator) {
    for (const Camera& camera : {Camera{}, Camera::sensor({0, 0, 1}, {0, 0, 1}, {0, 1, 0}, 0.6),
                                 Camera::orthographic({0, 0, 2}, {0, 0, 1}, {0, 1, 0}, 3)}) {
      const Image expected = ray_by_ray(camera, 90, 70, scene, integrator);
      for (const bool tiles : {true, false}) {
        Image image(90, 70);
        render(image, camera, scene, integrator, {.threads = 2, .tiles = tiles});
        CHECK(different_bytes(image, expected) == 0);
      }
    }
  };
  const auto scene = three_spheres();
  check(scene, Headlight{});
  check(scene, Mirrors{});
  check(scene, Curious{});
  check(scene, Rings{});
  check(scene, Facets{});
  check(scene, Glow{});
  Scene<Sphere> crowd;  // enough for occluders to be found in a tree
  Random random(20);
  for (int i = 0; i < 300; ++i)
    crowd.add(Sphere{Vec3{0, 0, 6} + random.point(3), random.real(0.05, 0.3)}, Color{1});
  check(crowd, Bristles{});

  const auto lambda = [](const Ray& ray, const auto& traced) { return Mirrors{}.radiance(ray, traced); };
  const auto typed = [](const Ray& ray, const Scene<Sphere>& traced) {
    return Mirrors{}.radiance(ray, traced);
  };
  const Image expected = ray_by_ray(Camera{}, 90, 70, scene, Mirrors{});
  Image by_lambda(90, 70), by_typed(90, 70), by_structure(90, 70);
  render(by_lambda, Camera{}, scene, lambda);
  render(by_typed, Camera{}, scene, typed);
  struct Typed {
    Color radiance(const Ray& ray, const Scene<Sphere>& traced) const {
      return Mirrors{}.radiance(ray, traced);
    }
  };
  render(by_structure, Camera{}, scene, Typed{});
  CHECK(different_bytes(by_lambda, expected) == 0);
  CHECK(different_bytes(by_typed, expected) == 0);
  CHECK(different_bytes(by_structure, expected) == 0);
}

TEST_CASE("in tiles without candidates, a packet integrator still gets the scene's lights") {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 9}, .radius = 1}, Color{1});
  scene.add(ConstantLight{.position = {0, 0, 5}, .intensity = Color{1, 2, 3}});
  RenderStatistics taken;
  Image image(90, 70);
  render(image, Camera{}, scene, Glow{}, {.statistics = &taken});
  CHECK(different_bytes(image, ray_by_ray(Camera{}, 90, 70, scene, Glow{})) == 0);
  CHECK(taken.pixels_skipped > 90 * 70 / 2);
  CHECK(image(0, 0) == Color{1, 2, 3});
}

TEST_CASE("by tiles, a function of a ray and any scene may access the scene's surfaces") {
  const auto scene = three_spheres();
  const auto touched = [&](const Ray& ray, const auto& traced) {
    Color color{static_cast<float>(traced.size())};
    for (std::size_t i = 0; i < traced.template surfaces<Sphere>().size(); ++i)
      if (traced.template surfaces<Sphere>()[i].intersect(ray))
        color *= traced.template materials<Sphere>()[i].diffuse;
    return color;
  };
  Image by_tiles(90, 70), without(90, 70);
  render(by_tiles, Camera{}, scene, touched);
  render(without, Camera{}, scene, touched, {.tiles = false});
  CHECK(different_bytes(by_tiles, without) == 0);
  CHECK(count_pixels(without, [&](int x, int y) { return without(x, y) == Color{3}; }) > 90 * 70 / 4);
}

TEST_CASE("statistics count the work that is needed, and no more") {
  Image image(320, 240);
  const auto taken_by = [&](const auto& scene, const auto& integrator, const Camera& camera = {}) {
    RenderStatistics taken;
    render(image, camera, scene, integrator, {.statistics = &taken});
    return taken;
  };
  Everything scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Color{1});

  // One sphere: each ray near it is tested once, and other rays are not traced.
  const RenderStatistics binary = taken_by(scene, BinaryIntegrator{});
  CHECK(binary.surface_tests == binary.camera_rays);
  CHECK(binary.camera_rays < 320 * 240 / 5);
  CHECK(taken_by(scene, DepthIntegrator{}).surface_tests == binary.surface_tests);

  // Sky above the ground: almost no ray is traced there, though the ground extends beyond both sides of those
  // tiles.
  const auto tutorial = three_spheres_and_nothing_else();
  const RenderStatistics outdoors = taken_by(tutorial, BinaryIntegrator{});
  const int sky = count_pixels(image, [&](int x, int y) { return image(x, y) == Color{0}; });
  CHECK(sky > 320 * 240 / 4);
  CHECK(outdoors.pixels_skipped > static_cast<std::uint64_t>(sky) * 3 / 4);

  // A sphere behind the camera takes no work at all.
  const RenderStatistics away = taken_by(scene, ShadowIntegrator{}, Camera{.forward = {0, 0, -1}});
  CHECK(away.surface_tests + away.camera_rays + away.other_rays + away.in_doubt == 0);
  CHECK(away.pixels_skipped == 320 * 240);

  // A light behind all visible points needs no shadow ray, and one in front of them one for each hit.
  scene.add(PointLight{.position = {0, 0, 100}, .power = Color{1}});
  CHECK(taken_by(scene, ShadowIntegrator{}).other_rays == 0);
  scene.add(PointLight{.position = {0, 0, 0}, .power = Color{1}});
  const RenderStatistics lit = taken_by(scene, ShadowIntegrator{});
  const int seen = count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; });
  CHECK(lit.other_rays == static_cast<std::uint64_t>(seen));

  // Shadow rays are traced in packets; the rays of an integrator for single rays are not.
  CHECK(lit.rays_alone == 0);
  const RenderStatistics mirrors = taken_by(three_spheres(), Mirrors{});
  CHECK(mirrors.other_rays > 320 * 240);
  CHECK(mirrors.rays_alone == mirrors.other_rays);

  // Counts are added to those already there.
  RenderStatistics twice = lit;
  render(image, Camera{}, scene, ShadowIntegrator{}, {.statistics = &twice});
  CHECK(twice.other_rays == 2 * lit.other_rays);
  CHECK(twice.surface_tests == 2 * lit.surface_tests);
  CHECK(twice.pixels_skipped == 2 * lit.pixels_skipped);
}

TEST_CASE("each kind of culling by tiles may be turned off: the picture is the same, and takes more work") {
  Everything few, many;
  // The ground is first, so that a sphere that casts a shadow on it is tested first only if it was the last
  // occluder.
  for (std::size_t i = the_three_spheres.size(); i-- > 0;)
    few.add(the_three_spheres[i].sphere, the_three_spheres[i].color);
  few.add(light_of_the_three_spheres);
  Random random(21);
  for (int i = 0; i < 200; ++i)
    many.add(Sphere{Vec3{0, 0, 6} + random.point(3), random.real(0.1, 0.4)}, random.color());
  many.add(PointLight{.position = {3, 6, 0}, .power = Color{300}});

  const auto check = [](const Everything& scene, const auto& integrator, bool casts_shadows) {
    const bool has_lists = casts_shadows && scene.size() > 16;
    Image expected(200, 150), image(200, 150);
    RenderStatistics all;
    render(expected, Camera{}, scene, integrator, {.statistics = &all});
    const auto with = [&](const Skips& skips) {
      RenderStatistics taken;
      render(image, Camera{}, scene, integrator, {.skips = skips, .statistics = &taken});
      CHECK(different_bytes(image, expected) == 0);
      CHECK(taken.other_rays == all.other_rays);
      CHECK(taken.camera_rays == (skips.empty_tiles ? all.camera_rays : 200 * 150));
      CHECK(taken.pixels_skipped + taken.camera_rays == 200 * 150);
      return taken;
    };
    CHECK(all.pixels_skipped > 10000);
    CHECK((all.other_rays > 4000) == casts_shadows);
    CHECK(with({.empty_tiles = false}).surface_tests == all.surface_tests);
    CHECK((with({.passed_surfaces = false}).surface_tests > all.surface_tests) == (scene.size() > 16));
    CHECK(with({.farther_surfaces = false}).surface_tests > all.surface_tests);
    // Occluder lists are built on demand, so the number of tests may be lower or higher with them.
    const RenderStatistics each = with({.occluder_lists = false});
    CHECK((each.rays_alone > all.rays_alone) == has_lists);
    CHECK(each.rays_alone == (has_lists ? all.other_rays : 0));
    const RenderStatistics nothing_skipped = with({false, false, false, false});
    if (!has_lists) CHECK(nothing_skipped.surface_tests > all.surface_tests);
    CHECK(nothing_skipped.rays_alone == each.rays_alone);
  };
  for (const Everything* const scene : {&few, &many}) {
    check(*scene, ColorIntegrator{}, false);
    check(*scene, ShadowIntegrator{}, true);
  }
}

TEST_CASE("few rays of a packet are in doubt") {
  Image image(320, 240);
  const auto check = [&](const auto& scene) {
    for_each_integrator([&](const std::string& name, const auto& integrator) {
      INFO(name);
      RenderStatistics taken;
      render(image, Camera{}, scene, integrator, {.statistics = &taken});
      CHECK(taken.surface_tests > 10000);
      CHECK(taken.in_doubt * 1000 < taken.surface_tests);
    });
  };
  check(three_spheres_and_nothing_else());
  check(random_spheres(300, 0.002, 2, Point{0}));
}

// A user's integrators in render by tiles: the pictures drawn ray by ray.
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/moving.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/torus.hpp>

#include <cmath>
#include <cstddef>
#include <optional>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/following.hpp"
#include "support/meshes.hpp"
#include "support/mirrors.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

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

/// User-defined integrator that asks for all crossings, and also shades closest hits.
struct Silhouette {
  using TakesPackets = Silhouette;
  using AsksForCrossings = Silhouette;
  template <class R>
  typename R::Light radiance(const R& ray, const auto& scene) const {
    typename R::Light light = background(ray, scene);
    scene.crossings(ray, Interval{}, [&](const auto& crossing) { light *= crossing.color(); });
    return light;
  }
  template <class R>
  typename R::Light background(const R&, const auto&) const {
    return typename R::Light(Color{1});
  }
  template <class Hit>
  typename Hit::Light shade(const Hit&, const auto&) const {
    return typename Hit::Light(Color{0});
  }
};

/// User-defined integrator whose background reads the direction of rays, which is a unit vector for all of
/// them.
struct Unit {
  using TakesPackets = Unit;
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit, scene) : background(ray, scene);
  }
  template <class R>
  typename R::Light background(const R& ray, const auto&) const {
    const auto is_unit = dot(ray.direction, ray.direction) > 0.5;
    return select(is_unit, Color{0.25f}, Color{1});
  }
  template <class Hit>
  typename Hit::Light shade(const Hit& hit, const auto&) const {
    return hit.color() * to_float(1 / hit.t);
  }
};

/// User-defined integrator that shades single hits of packets of camera rays, by all that a hit tells.
struct Telltale : FirstHit<Telltale> {
  using ShadesEachHit = Telltale;
  Color background(const auto&, const auto&) const { return {0, 0.25f, 0}; }
  Color shade(const Intersection& hit, const auto& scene, const auto& sampler) const {
    const auto numbers = sampler(1);
    const bool is_free = !scene.occluded(hit.leave(hit.facing_normal()), Interval{});
    return {to_float(hit.refined()), to_float(dot(hit.normal(), Vec3{1, 2, 3}) + hit.uv().x + numbers[0]),
            hit.color().r + static_cast<float>(hit.primitive()) + static_cast<float>(is_free)};
  }
};

/// User-defined surface whose equation takes packets, and whose other functions take single rays and points.
struct HalfPacketPlane {
  Plane plane;

  std::optional<double> intersect(const Ray& ray, Interval range) const {
    return plane.intersect(ray, range);
  }
  Vec3 normal_at(const Point& p) const { return plane.normal_at(p); }
  auto equation(const auto& rays) const { return plane.equation(rays); }
  bool is_left_by(const Ray& ray) const { return plane.is_left_by(ray); }
  Departure departure() const { return plane.departure(); }
};

}  // namespace

TEST_CASE("by tiles, a surface whose equation alone takes packets has the same picture as ray by ray") {
  Scene<Sphere, HalfPacketPlane> scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Color{0.5f});
  scene.add(HalfPacketPlane{{{0, 1, 0}, -1}}, Color{0.25f});
  scene.add(PointLight{{0, 4, 2}, Color{100}});
  Image plain(64, 48), image(64, 48);
  render(plain, Camera{}, scene, ShadowIntegrator{}, {.tiles = false});
  render(image, Camera{}, scene, ShadowIntegrator{});
  CHECK(different_bytes(image, plain) == 0);
  CHECK(count_pixels(plain, [&](int x, int y) { return plain(x, y) != Color{0}; }) > 1000);
}

TEST_CASE("by tiles, an integrator that shades and asks for crossings draws the same picture as ray by ray") {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 4}, Color{0});
  Image plain(64, 64), image(64, 64);
  render(plain, Camera{}, scene, Silhouette{}, {.tiles = false});
  render(image, Camera{}, scene, Silhouette{});
  CHECK(different_bytes(image, plain) == 0);
}

TEST_CASE("by tiles, a background gets rays of the camera") {
  Scene<Sphere> few, many;
  few.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Color{1});
  Random random(31);
  for (int i = 0; i < 60; ++i)
    many.add(Sphere{.center = random.point(2) + Vec3{0, 0, 6}, .radius = 0.2}, Color{1});
  for (const Scene<Sphere>* const scene : {&few, &many}) {
    Image plain(64, 64), image(64, 64);
    render(plain, Camera{}, *scene, Unit{}, {.tiles = false});
    render(image, Camera{}, *scene, Unit{});
    CHECK(different_bytes(image, plain) == 0);
  }
}

TEST_CASE("where many surfaces lie behind each other, most are never tested") {
  Scene<Sphere> walls;  // spheres that fill the view, one behind the other
  for (int i = 999; i >= 0; --i)
    walls.add(Sphere{.center = {0, 0, 200.0 + 300 * i}, .radius = 100}, Color{1});
  Image image(64, 64);
  RenderStatistics taken;
  render(image, Camera{.right = {0.1, 0, 0}, .up = {0, 0.1, 0}}, walls, DepthIntegrator{},
         {.statistics = &taken});
  CHECK(taken.float_tests + taken.surface_tests < 64 * 64 * 20);
}

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

TEST_CASE("by tiles, an integrator that shades each hit draws the same picture as ray by ray") {
  Scene<Sphere, Parallelogram, Mesh, AnySurface> scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Material{.diffuse = Color{0.5f}, .texture = Checker{}});
  scene.add(Sphere{.center = {0, 0, 9}, .radius = 30}, Color{0.125f});  // seen from inside
  scene.add(Parallelogram{{-2, -1, 4}, {1, 0, 0}, {0, 1, 1}},
            Material{.diffuse = Color{0.25f}, .normal_map = [](double u, double v) {
                       return Vec3{0.3 * u, 0.2 * v, 1};
                     }});
  scene.add(Mesh(meshes::moved(meshes::box(1), 0.7, Point{1.5, 0.5, 4})), Color{0.75f});
  scene.add(AnySurface(Torus{.center = {-1, 1, 4}, .axis = {1, 1, 1}, .radius = 0.5, .tube = 0.2}), Color{1});
  scene.add(AnySurface(Moving(Sphere{{1, -1, 3}, 0.4}, Vec3{0.3, 0, 0})), Color{0.375f});
  const auto check = [](const auto& drawn, const Camera& camera, const RenderOptions& options) {
    Image plain(75, 50), image(75, 50);
    RenderOptions without = options;
    without.tiles = false;
    render(plain, camera, drawn, Telltale{}, without);
    render(image, camera, drawn, Telltale{}, options);
    CHECK(different_bytes(image, plain) == 0);
    return count_pixels(plain, [&](int x, int y) { return x > 0 && plain(x, y) != plain(x - 1, y); });
  };
  const auto wide = Camera::perspective({}, {0, 0, 1}, {0, 1, 0}, 70);
  Camera moving = Camera::thin_lens({}, {0, 0, 1}, {0, 1, 0}, 70, 0.05, 4);
  moving.shutter = {0, 1};
  CHECK(check(scene, wide, {.threads = 2}) > 2000);
  CHECK(check(scene, wide, {.samples = 3, .filter = ReconstructionFilter::mitchell()}) > 2000);
  CHECK(check(scene, moving, {.samples = 3}) > 2000);
  CHECK(check(accelerate(scene), Camera::orthographic({0, 0, 2}, {0, 0, 1}, {0, 1, 0}, 3), {}) > 2000);

  Scene<Sphere> ball;  // tiles that see nothing have one color, without a ray
  ball.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Color{0.5f});
  RenderStatistics taken;
  CHECK(check(ball, wide, {.statistics = &taken}) > 100);
  CHECK(taken.pixels_skipped > 75 * 50 / 4);
}

TEST_CASE("an integrator that follows rays sees the closest of surfaces in any order") {
  Scene<Sphere> scene;
  // The second is behind the first hit, and the third in front of it.
  for (const double z : {6.0, 12.0, 4.0}) scene.add(Sphere{{0, 0, z}, 1}, Color{static_cast<float>(z), 1, 0});
  Image image(256, 192);  // with packets of which all rays meet all three
  render(image, Camera{}, scene, Following{});
  CHECK(different_bytes(image, ray_by_ray(Camera{}, 256, 192, scene, Following{})) == 0);
  CHECK(image(128, 96).r > 1.3f);  // 4 of the third at t = 3, and not 6 of the first at t = 5
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

// Surfaces and cameras that move while the shutter is open: crossings, departures, pictures by tiles and
// trees, culling, and the blur of an edge in motion.
#include <protostar/surfaces/moving.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/candidates.hpp>
#include <protostar/accel/frustum.hpp>
#include <protostar/accel/pixel_rays.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/light_truth.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

using MovingScene = Scene<Sphere, Plane, Moving<Sphere>, Moving<Mesh>, AnySurface>;

MovingScene moving_scene(int count) {
  MovingScene scene;
  Random random(11);
  const auto material = [&](int i) {
    return Material{.diffuse = random.color(),
                    .reflect = i % 3 == 0 ? 0.4 : 0,
                    .refract = i % 3 == 1 ? 0.4 : 0,
                    .ior = 1.4};
  };
  const auto place = [&] { return Point{random.real(-4, 4), random.real(-1, 3), random.real(2, 9)}; };
  for (int i = 0; i < count; ++i) {
    const Sphere sphere{.center = place(), .radius = random.real(0.1, 0.5)};
    if (i % 4 == 0) scene.add(sphere, material(i));
    if (i % 4 == 1) scene.add(Moving<Sphere>(sphere, random.point(1)), material(i));
    if (i % 4 == 2) scene.add(AnySurface(Moving<>(AnySurface(sphere), random.point(0.5))), material(i));
    if (i % 4 == 3)
      scene.add(AnySurface(Moving<Box>({sphere.center, sphere.center + Vec3{0.3}}, random.point(1))),
                material(i));
  }
  const Mesh torus(meshes::moved(meshes::torus(20, 10), 0.7, {1.1, 0.2, 4}), {.threads = 1});
  scene.add(Moving<Mesh>(torus, {-0.5, 0.25, 0}), Color{0.2f, 0.7f, 0.3f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1},
            Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  scene.add(PointLight{.position = {0, 5, 0}, .power = Color{300}});
  scene.set_sky(Color{0.3f, 0.5f, 0.7f});
  return scene;
}

}  // namespace

TEST_CASE("a moving surface is at each time where its velocity has brought it, and stands before and after") {
  Random random(1);
  WrongCases wrong(random);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Sphere rest{random.point(1), random.real(0.2, 1)};
    const Vec3 velocity = random.point(2);
    const Moving<Sphere> moving(rest, velocity, {0.25, 2});
    Scene<Moving<Sphere>, AnySurface> scene;
    scene.add(moving, Color{1});
    Scene<AnySurface> held;
    held.add(AnySurface(moving), Color{1});
    const double time = random.real(-1, 3), when = std::clamp(time, 0.25, 2.0);
    const Sphere there{rest.center + when * velocity, rest.radius};
    const Point origin = random.point(5);
    const Ray ray{.origin = origin, .direction = there.center + random.point(0.9) - origin, .time = time};
    const auto expected = there.intersect(ray);
    const auto hit = scene.intersect(ray, Interval{}), same = held.intersect(ray, Interval{});
    if (!expected) continue;
    ++hits;
    const bool is_right = hit && same && std::abs(hit->t - *expected) < 1e-7 && hit->t == same->t &&
                          length(hit->normal() - there.normal_at(hit->point())) < 1e-7 &&
                          hit->normal() == same->normal() && hit->uv() == same->uv() &&
                          length(Vec3{hit->uv().x - there.uv_at(hit->point()).x,
                                      hit->uv().y - there.uv_at(hit->point()).y, 0}) < 1e-5;
    const Bounds box = moving.bounds();
    const Point point = ray.at(*expected);
    const Vec3 off = max(box.min - point, point - box.max);
    wrong.add(!is_right || std::max({off.x, off.y, off.z}) > 1e-14, ray, time, there, "t", expected);
  }
  CHECK(wrong == 0);
  CHECK(hits > 700);
}

TEST_CASE("a ray that leaves a moving surface hits it no more outwards, and its other side inwards") {
  Random random(2);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    Scene<Moving<Sphere>, AnySurface, Sphere> scene;
    const Sphere rest{random.point(1), random.real(0.2, 1)};
    const Vec3 velocity = random.point(3);
    if (i % 2 == 0)
      scene.add(Moving<Sphere>(rest, velocity), Color{1});
    else
      scene.add(AnySurface(Moving<>(AnySurface(rest), velocity)), Color{1});
    const double time = random.real(0, 1);
    const Point target = rest.center + time * velocity, origin = target + 3.0 * random.direction();
    const auto hit = scene.intersect(
        {.origin = origin, .direction = target + random.point(0.1) - origin, .time = time}, Interval{});
    REQUIRE(hit);
    const Vec3 along = random.direction(), normal = hit->normal();
    const double rise = dot(along, normal);
    if (std::abs(rise) < 1e-9) continue;
    const Ray onward = hit->leave(along);
    CHECK(onward.time == time);
    int count = 0;
    double last = 0;
    scene.crossings(onward, Interval{}, [&](const Intersection& one) { ++count, last = one.t; });
    const double other_side = -2 * rise * rest.radius;
    wrong.add(count != (rise < 0) || (rise < 0 && std::abs(last - other_side) > 1e-9) ||
                  scene.occluded(onward, Interval{}) != (rise < 0),
              onward, time, rest, "count", count);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a ray that leaves a moving surface meets an equal one that stands where it was made") {
  const Sphere rest{{0, 0, 5}, 1};
  Scene<Sphere, Moving<Sphere>> scene;
  scene.add(rest, Color{1, 0, 0});
  scene.add(Moving<Sphere>(rest, {0, 0, -3}), Color{0, 1, 0});
  const auto hit = scene.intersect({.time = 1}, Interval{});
  REQUIRE(hit);
  CHECK(hit->t == 1);
  CHECK(hit->color() == Color{0, 1, 0});
  std::vector<double> crossings;
  scene.crossings(hit->leave({0, 0, 1}), Interval{},
                  [&](const Intersection& one) { crossings.push_back(one.t); });
  std::sort(crossings.begin(), crossings.end());
  CHECK(crossings == std::vector<double>{2, 3, 5});
  const auto back = scene.intersect({.origin = {0, 0, 10}, .direction = {0, 0, -1}, .time = 1}, Interval{});
  REQUIRE(back);  // leaves the one that stands, and meets the other
  const auto next = scene.intersect(back->leave({0, 0, -1}), Interval{});
  REQUIRE(next);
  CHECK(next->t == 2);
}

TEST_CASE("rays have the shutter's times, halfway through for one ray through the pixel's center") {
  const auto time_as_light = [](const Ray& ray) { return Color(static_cast<float>(ray.time)); };
  const Camera camera = Camera{}.with_shutter(2, 4);
  Image image(8, 8);
  render(image, camera, time_as_light);
  CHECK(image(3, 4).r == 3);
  render(image, Camera{}.with_shutter(5, 5), time_as_light, {.samples = 3});
  CHECK(image(3, 4).r == 5);
  for (const SamplerChoice& sampler : {SamplerChoice{}, sampler_of<HaltonSampler>,
                                       sampler_of<StratifiedSampler>, sampler_of<HammersleySampler>}) {
    render(image, camera, time_as_light, {.samples = 256, .sampler = sampler});
    CHECK(std::abs(image(3, 4).r - 3) < 0.02f);
  }
  const auto square = [](const Ray& ray) {
    return Color(static_cast<float>((ray.time - 3) * (ray.time - 3)));
  };
  render(image, camera, square, {.samples = 256});
  CHECK(std::abs(image(5, 2).r - 1 / 3.0f) < 0.02f);  // the variance of a uniform time
}

TEST_CASE(
    "a picture by one ray a pixel shows moving surfaces halfway, and a shutter of no length stills them") {
  Scene<Moving<Sphere>> moving;
  moving.add(Moving<Sphere>({{0, 0, 4}, 1}, {1, 0.5, 0}), Color{1});
  Scene<Sphere> halfway;
  halfway.add(Sphere{{0.5, 0.25, 4}, 1}, Color{1});
  for (const bool tiles : {false, true}) {
    Image a(48, 36), b(48, 36);
    render(a, Camera{}.with_shutter(0, 1), moving, NormalIntegrator{}, {.tiles = tiles});
    render(b, Camera{}, halfway, NormalIntegrator{}, {.tiles = tiles});
    CHECK(different_pixels(a, b) == 0);
    render(a, Camera{}.with_shutter(0.5, 0.5), moving, NormalIntegrator{}, {.samples = 4, .tiles = tiles});
    render(b, Camera{}, halfway, NormalIntegrator{}, {.samples = 4, .tiles = tiles});
    CHECK(different_pixels(a, b) == 0);
  }
}

TEST_CASE("pictures of moving surfaces have the same bytes ray by ray, by tiles and with a tree") {
  const std::vector<Camera> cameras{
      Camera::perspective({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60).with_shutter(0, 1),
      Camera::thin_lens({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60, 0.2, 5).with_shutter(0.25, 0.75),
      Camera::orthographic({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 4).with_shutter(0, 1),
      Camera::perspective({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60)
          .with_shutter(0, 1)
          .with_velocity({0.5, -0.25, 1}),
      Camera::thin_lens({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60, 0.2, 5)
          .with_shutter(0.25, 0.75)
          .with_velocity({-1, 0.5, 0.5}),
      Camera::orthographic({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 4)
          .with_shutter(0, 1)
          .with_velocity({0.5, 0.25, 1}),
      Camera::sensor({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 1).with_shutter(0.5, 1).with_velocity({-1, 0, 0.5})};
  std::size_t round = 0;
  for (const int count : {8, 200, 2600}) {
    const MovingScene scene = moving_scene(count);
    const auto fast = accelerate(scene);
    for (const auto sampler : sampler_names) {
      RenderOptions options{.samples = std::vector{2, 0, 3}[round % 3],
                            .sampler = *sampler_named(sampler),
                            .seed = round,
                            .threads = 2};
      const Camera& camera = cameras[round % cameras.size()];
      CAPTURE(count, sampler, round % cameras.size(), options.samples);
      ++round;
      const auto differ = [&](const auto& integrator) {
        Image plain(41, 33), tiles(41, 33), tree(41, 33);
        options.tiles = false;
        if (count < 1000) render(plain, camera, scene, integrator, options);
        render(tree, camera, fast, integrator, options);
        options.tiles = true;
        render(tiles, camera, scene, integrator, options);
        return different_pixels(tree, tiles) + (count < 1000 ? different_pixels(plain, tiles) : 0);
      };
      CHECK(differ(NormalIntegrator{}) == 0);
      CHECK(differ(ColorIntegrator{}) == 0);
      CHECK(differ(ShadowIntegrator{}) == 0);
      if (count == 8) {
        CHECK(differ(TransparencyIntegrator{}) == 0);
        CHECK(differ(WhittedIntegrator{.depth = 4}) == 0);
      }
    }
  }
}

TEST_CASE("an edge in motion fades linearly over its way, pixel by pixel") {
  // The edge is seen at u = (e + t w)/d at time t. Of the times from 0 to 1, the share s = (u d − e)/w,
  // between 0 and 1, has the board at u. Its integral is H.
  const auto integral = [](double s) { return s <= 0 ? 0 : s >= 1 ? s - 0.5 : s * s / 2; };
  constexpr int width = 32, height = 4, samples = PROTOSTAR_LONG_FORMS ? 1024 : 32;
  struct {
    double depth, edge, way;
  } const rows[] = {{1, -1, 4}, {2, 1, 6}, {0.5, -1, 0.75}};
  for (const auto& row : rows)
    for (const SamplerChoice& sampler :
         {sampler_of<SobolSampler>, sampler_of<HaltonSampler>, sampler_of<StratifiedSampler>}) {
      CAPTURE(row.depth, row.edge, row.way);
      const Parallelogram board{{row.edge, -1000, row.depth}, {1000, 0, 0}, {0, 2000, 0}};
      Scene<Moving<Parallelogram>> scene;
      scene.add(Moving<Parallelogram>(board, {row.way / 0.5, 0, 0}, {2, 2.5}), Color{1});
      Scene<Parallelogram> still;
      still.add(board, Color{1});
      // The way begins at time 2, at the edge.
      const Camera camera = Camera{.position = {4 * row.way, 0, 0}}.with_shutter(2, 2.5);
      std::vector<Image> pictures;
      for (int r = 0; r < LightTruth::scramblings; ++r) {
        pictures.emplace_back(width, height);
        const RenderOptions options{
            .samples = samples, .sampler = sampler, .seed = static_cast<std::uint64_t>(r)};
        render(pictures.back(), camera, scene, ColorIntegrator{}, options);
        // At rest, before a camera that moves to the other side instead, the edge has the same picture.
        Image from_camera(width, height);
        render(from_camera, camera.with_velocity({-row.way / 0.5, 0, 0}), still, ColorIntegrator{}, options);
        CHECK(different_pixels(from_camera, pictures.back()) == 0);
      }
      LightTruth truth;
      for (int x = 0; x < width; ++x) {
        const auto share = [&](int column) {
          return (Camera::u_at(column, width, height) * row.depth - row.edge) / row.way;
        };
        const double from = share(x), to = share(x + 1);
        for (int y = 0; y < height; ++y) {
          std::vector<double> means;
          for (const Image& picture : pictures) means.push_back(picture(x, y).g);
          truth.compare(means, (integral(to) - integral(from)) / (to - from), "pixel", x, y);
        }
      }
      CHECK(truth.wrong == 0);
      CHECK(truth.lit > width / 2);
      CHECK(std::abs(truth.mean_error) <=
            LightTruth::most_errors * std::sqrt(truth.variance) + 0x1p-20 * truth.mean_truth);
      CHECK(truth.detectable_bias() < (PROTOSTAR_LONG_FORMS ? 2e-3 : 0.02));
    }
}

TEST_CASE("a moving camera sees what one at rest sees if all surfaces move to the other side") {
  // Origins of rays are o + t v, and in the surfaces' space o − t (−v), which is equal.
  const Vec3 velocity{1.25, -0.5, 2};
  Scene<Sphere, Parallelogram> still;
  Scene<Moving<Sphere>, Moving<Parallelogram>> moving;
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const Sphere sphere{{random.real(-4, 4), random.real(-3, 3), random.real(3, 9)}, random.real(0.1, 0.6)};
    const Material material{.diffuse = random.color()};
    still.add(sphere, material);
    moving.add(Moving<Sphere>(sphere, -velocity), material);
  }
  const Parallelogram board{{-9, -3, -2}, {18, 0, 0}, {0, 1, 20}};
  still.add(board, Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  moving.add(Moving<Parallelogram>(board, -velocity),
             Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  const Point from{0.25, 0.5, -1};
  const Vec3 forwards{0, 0, 1}, upwards{0, 1, 0};
  for (const Camera& camera :
       {Camera::perspective(from, forwards, upwards, 60),
        Camera::thin_lens(from, forwards, upwards, 60, 0.2, 5),
        Camera::orthographic(from, forwards, upwards, 4), Camera::sensor(from, forwards, upwards, 1)})
    for (const Shutter& shutter : {Shutter{0, 1}, Shutter{0.5, 0.5}, Shutter{0.25, 1}})
      for (const int samples : {0, 3})
        for (const bool tiles : {false, true}) {
          const Camera rests = camera.with_shutter(shutter.opens, shutter.closes);
          const RenderOptions options{.samples = samples, .tiles = tiles};
          const auto differ = [&](const auto& integrator) {
            Image a(33, 25), b(33, 25);
            render(a, rests.with_velocity(velocity), still, integrator, options);
            render(b, rests, moving, integrator, options);
            return different_pixels(a, b);
          };
          CAPTURE(shutter.opens, samples, tiles, camera.aperture);
          CHECK(differ(NormalIntegrator{}) == 0);
          CHECK(differ(ColorIntegrator{}) == 0);
        }
}

TEST_CASE(
    "a tile keeps every sphere that the camera sees through one of its pixels at any place of its way") {
  Random random(7);
  WrongCases culled(random), outside(random);
  int met = 0, kept = 0, all = 0;
  for (int i = 0; i < 600; ++i) {
    Camera camera{.position = random.point(2),
                  .right = random.point(1),
                  .up = random.point(1),
                  .forward = random.point(1),
                  .shutter = {random.real(-2, 0), random.real(0, 2)},
                  .velocity = random.point(std::exp2(random.real(-6, 3)))};
    const Vec3 r = normalize(camera.right), u = normalize(camera.up), f = normalize(camera.forward);
    if (std::abs(dot(cross(r, u), f)) < 0.1) continue;
    if (i % 4 == 1) camera.aperture = std::exp2(random.real(-6, 1)), camera.focus = random.real(0.5, 9);
    if (i % 4 == 2) camera.film_right = camera.right, camera.film_up = camera.up;
    if (i % 4 == 3) {
      camera.film_right = camera.right, camera.film_up = camera.up;
      camera.right = camera.up = Vec3{0};
    }
    if (i % 5 == 4) camera.position = camera.position + Point{65537, -65537, 131074};
    if (i % 7 == 6) camera.velocity = 65536.0 * camera.velocity;
    camera.validate();
    const int width = 64, height = 48;
    const simd::PixelRays rays(camera, PixelGrid(width, height, {.samples = 4}), width, height);
    const Tile tile{16, 8, 32, 16};
    const simd::Frustum frustum(rays, tile);
    const simd::TileHalfSpaces half_spaces(rays, tile);
    for (int k = 0; k < 40; ++k) {
      // Most places, points and times are at an edge.
      const auto between = [&](double a, double b) {
        return a + (b - a) * std::clamp(random.real(-1, 2), 0.0, 1.0);
      };
      const double angle = random.real(0, 7), radius = between(0, 1);
      const double film_u = rays.pixels().u(0, between(tile.x0, tile.x1)),
                   film_v = rays.pixels().v(0, between(tile.y0, tile.y1));
      Ray ray = camera.has_lens()
                    ? camera(film_u, film_v, {radius * std::cos(angle), radius * std::sin(angle)})
                    : camera(film_u, film_v);
      ray.time = camera.shutter.at(between(0, 1));
      ray.origin = camera.origin_at(ray.time, ray.origin);
      const double t = std::exp2(random.real(-4, 6)), size = std::exp2(random.real(-12, 1));
      const Vec3 away = normalize(cross(ray.direction, random.direction()));
      const Sphere sphere{.center = ray.at(t) + size * random.real(0.9, 1.1) * away, .radius = size};
      simd::Candidates everything, in_tile;
      everything.add(0, rays.viewpoint(), simd::sphere_around(sphere));
      in_tile.add(everything, frustum);
      ++all, kept += in_tile.size();
      const auto hit = sphere.intersect(ray);
      if (!hit) continue;
      ++met;
      culled.add(in_tile.size() == 0, camera, ray.origin, ray.direction, sphere);
      everything.sort(simd::Candidates::Order::near_to_far);
      culled.add(everything.size() == 1 && everything.nearest(0) > *hit, "nearest", everything.nearest(0),
                 *hit);
      for (const simd::HalfSpace& side : half_spaces.side)
        outside.add(dot(side.normal, sphere.center - side.on) <
                        -sphere.radius - 0x1p-24 * (length(sphere.center) + length(side.on) + t),
                    camera, ray.origin, ray.direction, sphere);
    }
  }
  CHECK(culled == 0);
  CHECK(outside == 0);
  CHECK(met > all / 2);
  CHECK(kept < all);
}

TEST_CASE("a camera's velocity has to be coordinates, and lead to coordinates") {
  const auto refusal = [](const Vec3& velocity, const Shutter& shutter) {
    return message_of<std::invalid_argument>([&] {
      static_cast<void>(Camera{}.with_shutter(shutter.opens, shutter.closes).with_velocity(velocity));
    });
  };
  CHECK(refusal({0, 1e121, 0}, {0, 1}) ==
        "Camera: velocity must have numbers at most 2^400 (2.6e120) in magnitude; it is (0, 1e+121, 0)");
  CHECK(refusal({0, not_a_number, 0}, {0, 1}) == "Camera: velocity must be finite; it is (0, nan, 0)");
  CHECK(refusal({0, 0, 1e60}, {0, 1e61}) ==
        "Camera: position + time · velocity must have numbers at most 2^400 (2.6e120) in magnitude; it is "
        "(0, 0, 1e+121)");
  CHECK(refusal({0, 0, 1e60}, {-1, 1e59}).empty());
}

TEST_CASE("shutters and velocities that make no sense are refused, and moving parts of other surfaces") {
  const auto refusal = [](const auto& make) { return message_of<std::invalid_argument>(make); };
  CHECK(refusal([] { static_cast<void>(Camera{}.with_shutter(1, 0.5)); }) ==
        "Camera: the shutter must close when it opens or later, both at times between -2^400 and 2^400; it "
        "opens "
        "at 1 and closes at 0.5");
  for (const double bad : {infinity, -infinity, not_a_number}) {
    CHECK_THAT(refusal([=] { static_cast<void>(Camera{}.with_shutter(bad, 1)); }),
               ContainsSubstring("the shutter"));
    CHECK_THAT(refusal([=] { static_cast<void>(Camera{}.with_shutter(0, bad)); }),
               ContainsSubstring("the shutter"));
    Scene<Moving<Sphere>> scene;
    CHECK_THAT(refusal([&] {
                 scene.add(Moving<Sphere>({}, {0, bad, 0}), Color{1});
               }),
               ContainsSubstring("Moving: velocity must have numbers"));
    CHECK_THAT(refusal([&] {
                 scene.add(Moving<Sphere>({}, {0, 1, 0}, {0, bad}), Color{1});
               }),
               ContainsSubstring("Moving: the shutter"));
  }
  CHECK_THAT(refusal([] {
               Moving<Sphere>({}, {1e100, 0, 0}, {0, 1e100}).validate();
             }),
             ContainsSubstring("Moving: velocity times time"));
  CHECK_THAT(refusal([] {
               Moving<Sphere>(Sphere{{0, 0, 0}, 0}, {1, 0, 0}).validate();
             }),
             ContainsSubstring("Sphere"));
  const AnySurface moving = Moving<Sphere>({}, {1, 0, 0});
  CHECK_THAT(refusal([&] { Instance(moving, Affine{}).validate(); }),
             ContainsSubstring("must not be moving"));
  CHECK_THAT(refusal([&] { Moving<>(moving, {1, 0, 0}).validate(); }), ContainsSubstring("moving itself"));
  CHECK_THROWS_AS(Csg(moving), std::invalid_argument);
  CHECK_NOTHROW(Moving<>(AnySurface(Instance(Sphere{}, Affine{})), {1, 0, 0}).validate());
}

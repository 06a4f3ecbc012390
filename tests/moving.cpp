// Surfaces and cameras that move while the shutter is open: crossings, departures, and culling.
// long/moving_pictures.cpp has pictures.
#include <protostar/surfaces/moving.hpp>

#include <algorithm>
#include <cmath>
#include <protostar/accel/candidates.hpp>
#include <protostar/accel/frustum.hpp>
#include <protostar/accel/pixel_rays.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("a moving surface is at each time where its velocity has brought it, and stands before and after") {
  Random random(1);
  WrongCases wrong(random);
  // Multiples of 2^-10: ways and places are multiples of 2^-20, without rounding, so that a moved ray starts
  // as far from the sphere as the ray from where the sphere is.
  const auto number = [&](double size) { return std::round(random.real(-size, size) * 0x1p10) * 0x1p-10; };
  const auto vector = [&](double size) { return Vec3{number(size), number(size), number(size)}; };
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Sphere rest{vector(1), 0.6 + number(0.4)};
    const Vec3 velocity = vector(2);
    const Moving<Sphere> moving(rest, velocity, {0.25, 2});
    Scene<Moving<Sphere>, AnySurface> scene;
    scene.add(moving, Color{1});
    Scene<AnySurface> held;
    held.add(AnySurface(moving), Color{1});
    const double time = 1 + number(2), when = std::clamp(time, 0.25, 2.0);
    const Sphere there{rest.center + when * velocity, rest.radius};
    const Point origin = vector(5);
    const Ray ray{.origin = origin, .direction = there.center + random.point(0.9) - origin, .time = time};
    const auto expected = there.intersect(ray);
    const auto hit = scene.intersect(ray, Interval{}), same = held.intersect(ray, Interval{});
    const Bounds box = moving.bounds();
    const Vec3 off = max(box.min - (there.center - there.radius), there.center + there.radius - box.max);
    wrong.add(std::max({off.x, off.y, off.z}) > 0, "bounds", time, there, box);
    if (!expected) continue;
    ++hits;
    const Point at_rest = ray.at(*expected) - when * velocity;
    const bool is_right = hit && same && hit->t == *expected && hit->t == same->t &&
                          hit->normal() == rest.normal_at(at_rest) && hit->normal() == same->normal() &&
                          hit->uv() == rest.uv_at(at_rest) && hit->uv() == same->uv();
    wrong.add(!is_right, ray, time, there, "t", expected);
  }
  CHECK(wrong == 0);
  CHECK(hits > 700);
}

TEST_CASE("a ray that leaves a moving surface hits it no more outwards, and its other side inwards") {
  Random random(2);
  WrongCases wrong(random);
  constexpr double u = 0x1p-53;
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
    // With u = 2^-53, a component of the normal is rounded thrice, and their dot product by 3u.
    if (std::abs(rise) < 6.001 * u) continue;
    const Ray onward = hit->leave(along);
    CHECK(onward.time == time);
    int count = 0;
    double last = 0;
    scene.crossings(onward, Interval{}, [&](const Intersection& one) { ++count, last = one.t; });
    // The root is 2b/A, of the same point: b = d · l is off by u |l| for l and by 3u |l|, A = d · d by 3u,
    // from 1 by 9u more as normalize is off by 4.5u, the quotient by u; and other_side by 6u, and 1u for a
    // product.
    const double other_side = -2 * rise * rest.radius, most = 2 * rest.radius * (4 + 12 + 1 + 6 + 1) * u;
    wrong.add(count != (rise < 0) || (rise < 0 && std::abs(last - other_side) > most) ||
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
  // Each of two scramblings has one of its times in each 128th of the shutter's 2, off its middle by at most
  // 1/128. StratifiedSampler has 16 times in each 16th: six standard errors of 2/16/√12 by √256, exceeded by
  // one of 5e8 seeds. A float is rounded by 2^-23, as is the mean.
  struct {
    SamplerChoice sampler;
    double most;
  } const rows[] = {{SamplerChoice{}, 1 / 128.0},
                    {sampler_of<HaltonSampler>, 1 / 128.0},
                    {sampler_of<StratifiedSampler>, 6 * 2 / 16.0 / std::sqrt(12) / 16},
                    {sampler_of<HammersleySampler>, 1 / 128.0}};
  for (const auto& [sampler, most] : rows) {
    render(image, camera, time_as_light, {.samples = 256, .sampler = sampler});
    CHECK(std::abs(double{image(3, 4).r} - 3) <= most + 0x1p-22);
  }
  const auto square = [](const Ray& ray) {
    return Color(static_cast<float>((ray.time - 3) * (ray.time - 3)));
  };
  render(image, camera, square, {.samples = 256});
  // The variance of a uniform time. On a part of width h, x² is off its mean by |m| h + h²/6 at most, where m
  // is its middle, ½ on average.
  constexpr double h = 2 / 128.0;
  CHECK(std::abs(image(5, 2).r - 1 / 3.0) <= h / 2 + h * h / 6 + 0x1p-22);
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
  CHECK(refusal({0, 0, 1e60}, {0, 1e62}) ==
        "Camera: position + time · velocity must have numbers at most 2^400 (2.6e120) in magnitude; it is "
        "(0, 0, 1e+122)");
  CHECK(refusal({0, 0, 1e60}, {-1, 1e59}).empty());
}

TEST_CASE("shutters and velocities that make no sense are refused, and moving parts of other surfaces") {
  const auto refusal = [](const auto& make) { return message_of<std::invalid_argument>(make); };
  CHECK(refusal([] { static_cast<void>(Camera{}.with_shutter(1, 0.5)); }) ==
        "Camera: the shutter must close when it opens or later, both at times between -2^400 and 2^400; it "
        "opens "
        "at 1 and closes at 0.5");
  CHECK(refusal([] {
          static_cast<void>(Camera{}.with_shutter(1, 1 - 0x1p-40));
        }).ends_with("it opens at 1 and closes at 0.9999999999990905"));
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

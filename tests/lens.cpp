// Cameras with a lens: their rays, and culling. long/lens_pictures.cpp has pictures.
#include <algorithm>
#include <cmath>
#include <protostar/accel/candidates.hpp>
#include <protostar/accel/frustum.hpp>
#include <protostar/accel/pixel_rays.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/lens_scene.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("rays through all points of a lens meet where the ray through its center is in focus") {
  // With ε = 2^-53, a point of the lens is off by 5.5ε of each of its two terms and ε of their sum, 9.2ε of
  // the aperture, and the origin by ε more of itself. Terms of a direction are off by at most 9.5ε, and so is
  // focus times the direction of focus times the terms, the reach; terms of the meeting point are off by 4ε,
  // the way to it by ε of its ends and of itself, its cross product by 2.8ε, and normalize turns by ε.
  constexpr double epsilon = 0x1p-53;
  Random random(1);
  WrongCases wrong(random);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = skewed_camera_with_lens(random);
    const double u = random.real(-1, 1), v = random.real(-1, 1);
    const Point meeting =
        camera.position + camera.focus * (camera.forward + u * camera.right + v * camera.up);
    const double reach = camera.focus * (length(camera.forward) + std::abs(u) * length(camera.right) +
                                         std::abs(v) * length(camera.up)) +
                         std::sqrt(2) * camera.aperture;
    for (int k = 0; k < 20; ++k) {
      const Uv at = concentric_disk(random.interior(), random.interior());
      const Ray ray = camera(u, v, at);
      wrong.add(!(std::abs(length(ray.direction) - 1) <= 7.001 * epsilon), camera, ray);  // 4.5ε and 2.5ε
      const Vec3 to = meeting - ray.origin;
      const double most = epsilon * (13.5 * reach + 9.2 * camera.aperture + length(meeting) +
                                     length(ray.origin) + 4.9 * length(to));
      wrong.add(!(length(cross(to, ray.direction)) <= most), camera, u, v, at, to);
      const Vec3 on_lens = camera.aperture * (at.x * normalize(camera.right) + at.y * normalize(camera.up));
      // normalize is off by 4.5ε, products and the sum by 3ε of each of two terms: 10.7ε of the aperture.
      const double most_on_lens = epsilon * ((9.2 + 10.7 + 1.5) * camera.aperture + length(ray.origin));
      wrong.add(!(length(ray.origin - camera.position - on_lens) <= most_on_lens), camera, at, ray);
    }
    CHECK(camera(u, v, {0, 0}).direction == camera(u, v).direction);
    CHECK(camera(u, v).origin == camera.position);
  }
  CHECK(wrong == 0);
}

TEST_CASE("thin_lens is perspective with a disk of a radius, and a distance along direction in focus") {
  const Camera camera = Camera::thin_lens({1, 2, 3}, {0, 0, 2}, {0, 3, 0}, 90, 0.25, 4);
  CHECK(!camera.is_pinhole());
  CHECK(camera.has_lens());
  CHECK(camera(0, 0, {1, 0}).origin == Point{1.25, 2, 3});
  CHECK(camera(0, 0, {0, -1}).origin == Point{1, 1.75, 3});
  const Ray ray = camera(0, 0, {1, 0});
  // With u = 2^-53, 1.25 − 0.25 is off by u; 0.25 by 4u of itself, as both components, t and the product are.
  CHECK(std::abs(ray.at(4 / ray.direction.z).x - 1) <= 0x1p-52);
  const Camera long_lens = Camera{.forward = {0, 0, 8}}.with_lens(0.5, 4);
  CHECK(long_lens.focus == 0.5);
  CHECK(long_lens.without_lens().is_pinhole());
  CHECK(camera.mirrored()(0, 0, {1, 0}).origin == Point{0.75, 2, 3});
  CHECK(Camera::thin_lens({1, 2, 3}, {0, 0, 2}, {0, 3, 0}, 90, 0, 4).is_pinhole());
}

TEST_CASE("a lens of impossible numbers is refused, and one before a film") {
  const auto refusal = [](double aperture, double focus) {
    return message_of<std::invalid_argument>([=] {
      static_cast<void>(Camera::look_at({0, 0, 0}, {0, 0, 1}).with_lens(aperture, focus));
    });
  };
  CHECK(refusal(-1, 1) == "Camera: aperture must be a number from 0 to 2^400; it is -1");
  CHECK_THAT(refusal(infinity, 1), ContainsSubstring("aperture must be a number"));
  CHECK_THAT(refusal(not_a_number, 1), ContainsSubstring("aperture must be a number"));
  CHECK(refusal(1, 0) == "Camera: the focus must be finite and greater than 0; it is 0");
  CHECK_THAT(refusal(1, -2), ContainsSubstring("the focus must be finite"));
  CHECK_THAT(refusal(1, infinity), ContainsSubstring("the focus must be finite"));
  CHECK_THAT(refusal(1, not_a_number), ContainsSubstring("the focus must be finite"));
  CHECK_THAT(refusal(1e100, 1e-100), ContainsSubstring("aperture / focus must be at most 2^400"));
  for (const double focus : {0.0, -1.0, infinity, not_a_number})
    CHECK_THAT(message_of<std::invalid_argument>([&] { Camera{.focus = focus}.validate(); }),
               ContainsSubstring("Camera: focus must be finite and greater than 0"));
  CHECK_THAT(message_of<std::invalid_argument>([] {
               static_cast<void>(Camera::orthographic({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1).with_lens(0.1, 1));
             }),
             ContainsSubstring("a lens needs rays that start at one point"));
}

TEST_CASE("one ray through the pixel's center passes the lens' center, and an aperture of 0 is a pinhole") {
  const LensScene scene = balls_at_all_depths(30);
  const Camera pinhole = Camera::perspective({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60);
  for (const bool tiles : {false, true})
    for (const int samples : {0, 1, 5}) {
      const RenderOptions options{.samples = samples, .tiles = tiles};
      Image sharp(64, 48), blurred(64, 48), closed(64, 48);
      render(sharp, pinhole, scene, WhittedIntegrator{}, options);
      render(closed, pinhole.with_lens(0, 3), scene, WhittedIntegrator{}, options);
      render(blurred, pinhole.with_lens(0.2, 3), scene, WhittedIntegrator{}, options);
      CHECK(different_pixels(sharp, closed) == 0);
      CHECK((different_pixels(sharp, blurred) == 0) == (samples == 0));
    }
}

TEST_CASE("a camera with a lens takes Sobol's numbers if nothing else is chosen") {
  const LensScene scene = balls_at_all_depths(10);
  const Camera camera = Camera::thin_lens({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60, 0.3, 3);
  for (const bool tiles : {false, true}) {
    Image by_default(32, 24), by_sobol(32, 24), by_hammersley(32, 24);
    render(by_default, camera, scene, ShadowIntegrator{}, {.samples = 3, .tiles = tiles});
    render(by_sobol, camera, scene, ShadowIntegrator{},
           {.samples = 3, .sampler = sampler_of<SobolSampler>, .tiles = tiles});
    render(by_hammersley, camera, scene, ShadowIntegrator{},
           {.samples = 3, .sampler = sampler_of<HammersleySampler>, .tiles = tiles});
    CHECK(different_pixels(by_default, by_sobol) == 0);
    CHECK(different_pixels(by_default, by_hammersley) > 100);
  }
}

TEST_CASE("a tile keeps every sphere that a ray from any point of the lens through one of its pixels hits") {
  Random random(7);
  WrongCases culled(random), outside(random);
  int met = 0, all = 0;
  for (int i = 0; i < 400; ++i) {
    Camera camera = skewed_camera_with_lens(random);
    if (i % 4 == 1) camera.aperture *= 0x1p-20;
    if (i % 4 == 2) camera.position = camera.position + Point{65537, -65537, 131074};
    const int width = 64, height = 48;
    const simd::PixelRays rays(camera, PixelGrid(width, height, {.samples = 4}), width, height);
    const Tile tile{16, 8, 32, 16};
    const simd::Frustum frustum(rays, tile);
    const simd::TileHalfSpaces half_spaces(rays, tile);
    for (int k = 0; k < 50; ++k) {
      // Most places and points are at an edge.
      const auto between = [&](double a, double b) {
        const double at = random.real(-1, 2);
        return a + (b - a) * std::clamp(at, 0.0, 1.0);
      };
      const double angle = random.real(0, 7), radius = between(0, 1);
      const Ray ray =
          camera(rays.pixels().u(0, between(tile.x0, tile.x1)), rays.pixels().v(0, between(tile.y0, tile.y1)),
                 {radius * std::cos(angle), radius * std::sin(angle)});
      const double t = std::exp2(random.real(-4, 6)), size = std::exp2(random.real(-12, 1));
      const Vec3 away = normalize(cross(ray.direction, random.direction()));
      const Sphere sphere{.center = ray.at(t) + size * random.real(0.9, 1.1) * away, .radius = size};
      simd::Candidates everything, in_tile;
      everything.add(0, rays.viewpoint(), simd::sphere_around(sphere));
      in_tile.add(everything, frustum);
      ++all;
      if (!sphere.intersect(ray)) continue;
      ++met;
      culled.add(in_tile.size() == 0, camera, ray.origin, ray.direction, sphere);
      for (const simd::HalfSpace& side : half_spaces.side)
        outside.add(dot(side.normal, sphere.center - side.on) <
                        -sphere.radius - 0x1p-24 * (length(sphere.center) + length(side.on) + t),
                    camera, ray.origin, ray.direction, sphere);
    }
  }
  CHECK(culled == 0);
  CHECK(outside == 0);
  CHECK(met > all / 2);
}

TEST_CASE("a tile drops what no point of the lens sees, and more of it near the plane in focus") {
  const Camera camera = Camera::thin_lens({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 90, 1, 4);
  const simd::PixelRays rays(camera, PixelGrid(64, 64, {.samples = 4}), 64, 64);
  const simd::Frustum frustum(rays, {24, 24, 40, 40});  // |u|, |v| ≤ ¼
  struct {
    double x, z;
    bool seen;
  } const rows[] = {{1.05, 4, true}, {1.2, 4, false}, {1.9, 8, true},   {2.9, 8, true},    {3.2, 8, false},
                    {0.95, 2, true}, {1.2, 2, false}, {0.9, 0.1, true}, {1.3, 0.1, false}, {0, -0.2, false}};
  for (const auto& row : rows) {
    CAPTURE(row.x, row.z);
    simd::Candidates everything, in_tile;
    everything.add(0, rays.viewpoint(), simd::sphere_around(Sphere{{row.x, 0, row.z}, 0.1}));
    in_tile.add(everything, frustum);
    CHECK((in_tile.size() > 0) == row.seen);
  }
}

TEST_CASE("rays drift through a lens as far as at that end of a sphere which is more out of focus") {
  const simd::Viewpoint lens{.apex = Point{0}, .lens_radius = 0.25, .focus_depth = 8, .ahead = {0, 0, 1}};
  struct {
    double depth, distance, radius, blur;
  } const rows[] = {
      {8, 9, 0, 0},                    // in focus
      {8, 9, 2, 0.25},                 // both ends alike
      {4, 5, 1, 0.625},                // before the plane in focus: the near end, at depth 3
      {20, 25, 4, 2},                  // behind it: the far end, at depth 24
      {1, 1, 2, 1},                    // around the lens, where rays differ by its radius
      {1, 1, 31, 3},                   // around the lens, up to depth 32
      {0x1p50, 0x1p50, 0, 0x1p47 - 1}  // far away
  };
  for (const auto& row : rows) {
    CAPTURE(row.depth, row.radius);
    const double drift = lens.drift_of_lens(simd::Doubles(row.depth), simd::Doubles(row.distance),
                                            simd::Doubles(row.radius))[0];
    // The depth is accurate to 2^-26 of the distance, and the focus to 2^-20 of itself: 2^-19 covers both.
    const double farthest = (row.distance + row.radius) / 8, more = drift / 0.25 - row.blur;
    CHECK(more >= (0x1p-20 + 0x1p-26) * farthest);
    CHECK(more <= 0x1.1p-19 * (1 + farthest));
  }
  simd::Viewpoint unsure = lens;
  unsure.ahead = Vec3{0};
  CHECK(unsure.drift_of_lens(simd::Doubles(8.0), simd::Doubles(8.0), simd::Doubles(1.0))[0] == infinity);
}

TEST_CASE("the depth before a lens or a film is certain unless rays or vectors are almost in one plane") {
  const auto viewpoint_of = [](const Vec3& up, const Vec3& forward) {
    const Camera camera{.up = up, .forward = forward, .aperture = 0.5, .focus = 2};
    return simd::PixelRays(camera, PixelGrid(64, 48, {.samples = 4}), 64, 48).viewpoint();
  };
  const Vec3 up{0, 1, 0};
  CHECK(viewpoint_of(up, {0, 0, 1}).ahead == Vec3{0, 0, 1});
  CHECK(viewpoint_of(up, {0, 0, -3}).ahead == Vec3{0, 0, -1});
  CHECK(viewpoint_of(up, {0, 0, 3}).focus_depth == 6);
  // The height of forward over the plane of the lens has to be above 2^-6 of its length.
  CHECK(viewpoint_of(up, {63, 0, 1}).ahead == Vec3{0, 0, 1});
  CHECK(viewpoint_of(up, {64, 0, 1}).ahead == Vec3{0});
  // So has the sine between the rays and that plane to be above 2^-20.
  CHECK(viewpoint_of({0, 0x1p19, 0}, {0, 0, 1}).ahead == Vec3{0, 0, 1});
  CHECK(viewpoint_of({0, 0x1p21, 0}, {0, 0, 1}).ahead == Vec3{0});
  // The sine between the vectors of a film has to be above 2^-24.
  const auto of_film = [](double sine) {
    const Camera camera{.film_right = {1, 0, 0}, .film_up = {1, sine, 0}};
    return simd::PixelRays(camera, PixelGrid(64, 48), 64, 48).viewpoint();
  };
  CHECK(of_film(0x1p-23).ahead == Vec3{0, 0, 1});
  CHECK(of_film(0x1p-24).ahead == Vec3{0});
}

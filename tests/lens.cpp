// Cameras with a lens: their rays, pictures by tiles, culling, and the blur of an edge out of focus.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
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

/// Returns a camera of random directions, neither at right angles nor of one handedness, with a lens.
Camera skewed_camera_with_lens(Random& random) {
  for (;;) {
    const Camera camera{.position = random.point(2),
                        .right = random.point(1),
                        .up = random.point(1),
                        .forward = random.point(1),
                        .aperture = std::exp2(random.real(-6, 2)),
                        .focus = std::exp2(random.real(-3, 5))};
    const Vec3 r = normalize(camera.right), u = normalize(camera.up), f = normalize(camera.forward);
    if (std::abs(dot(cross(r, u), f)) > 0.1) return camera;
  }
}

using LensScene = Scene<Sphere, Plane, Parallelogram, Mesh>;

/// Returns a scene of balls before and behind the plane in focus, of which the first is around the camera.
LensScene balls_at_all_depths(int count) {
  LensScene scene;
  Random random(5);
  scene.add(Sphere{.center = {0, 0, 0}, .radius = 40}, Color{0.3f, 0.4f, 0.2f});
  for (int i = 0; i < count; ++i)
    scene.add(Sphere{.center = {random.real(-4, 4), random.real(-3, 3), random.real(-1, 12)},
                     .radius = random.real(0.02, 0.4)},
              Material{.diffuse = random.color(), .reflect = i % 3 == 0 ? 0.3 : 0});
  scene.add(Mesh(meshes::moved(meshes::torus(20, 10), 0.7, {1.1, 0.2, 3}), {.threads = 1}),
            Color{0.2f, 0.7f, 0.3f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1},
            Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});
  return scene;
}

}  // namespace

TEST_CASE("rays through all points of a lens meet where the ray through its center is in focus") {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = skewed_camera_with_lens(random);
    const double u = random.real(-1, 1), v = random.real(-1, 1);
    const Point meeting =
        camera.position + camera.focus * (camera.forward + u * camera.right + v * camera.up);
    for (int k = 0; k < 20; ++k) {
      const Uv at = concentric_disk(random.interior(), random.interior());
      const Ray ray = camera(u, v, at);
      CHECK(std::abs(length(ray.direction) - 1) < 1e-15);
      const Vec3 to = meeting - ray.origin;
      CHECK(length(cross(to, ray.direction)) < 1e-13 * (1 + length(to)));
      const Vec3 on_lens = ray.origin - camera.position;
      CHECK(std::abs(dot(cross(camera.right, camera.up), on_lens)) < 1e-14);
      CHECK(length(on_lens) < 1.5 * camera.aperture);
    }
    CHECK(camera(u, v, {0, 0}).direction == camera(u, v).direction);
    CHECK(camera(u, v).origin == camera.position);
  }
}

TEST_CASE("thin_lens is perspective with a disk of a radius, and a distance along direction in focus") {
  const Camera camera = Camera::thin_lens({1, 2, 3}, {0, 0, 2}, {0, 3, 0}, 90, 0.25, 4);
  CHECK(!camera.is_pinhole());
  CHECK(camera.has_lens());
  CHECK(camera(0, 0, {1, 0}).origin == Point{1.25, 2, 3});
  CHECK(camera(0, 0, {0, -1}).origin == Point{1, 1.75, 3});
  const Ray ray = camera(0, 0, {1, 0});
  CHECK(std::abs(ray.at(4 / ray.direction.z).x - 1) < 1e-15);
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

TEST_CASE("by tiles, pictures of a lens have the bytes of those ray by ray, for any sampler and filter") {
  Random random(3);
  const Vec3 up{0, 1, 0};
  const std::vector<Camera> cameras{
      Camera::thin_lens({0, 0, 0}, {0, 0, 1}, up, 60, 0.1, 3),
      Camera::thin_lens({0, 0.5, -3}, {0, 0, 1}, up, 90, 1, 5),
      Camera::look_at_right_handed({2, 1, -2}, {0, 0, 4}, up, 40).with_lens(0.5, 0.7),
      skewed_camera_with_lens(random),
      skewed_camera_with_lens(random),
      skewed_camera_with_lens(random)};
  std::size_t round = 0;
  for (const int count : {12, 300, 2500}) {
    const LensScene scene = balls_at_all_depths(count);
    for (const auto sampler : sampler_names)
      for (const auto filter : ReconstructionFilter::names) {
        if (count == 2500 && round % 4 != 0 && ++round) continue;
        const Camera& camera = cameras[round % cameras.size()];
        RenderOptions options{.samples = std::vector{1, 2, 3}[round % 3],
                              .sampler = *sampler_named(sampler),
                              .filter = ReconstructionFilter::named(filter),
                              .seed = round,
                              .threads = 2};
        if (round % 5 == 0) options.crop = {.x = 7, .y = 3, .width = 60, .height = 50};
        CAPTURE(count, sampler, filter, round % cameras.size());
        ++round;
        const auto differ = [&](const auto& integrator) {
          Image plain(45, 37), tiles(45, 37);
          options.tiles = false;
          render(plain, camera, scene, integrator, options);
          options.tiles = true;
          render(tiles, camera, scene, integrator, options);
          return different_pixels(plain, tiles);
        };
        CHECK(differ(NormalIntegrator{}) == 0);
        CHECK(differ(ColorIntegrator{}) == 0);
        if (count == 12) {
          CHECK(differ(TransparencyIntegrator{}) == 0);
          CHECK(differ(WhittedIntegrator{.depth = 3}) == 0);
          CHECK(differ([](const Ray& ray, const auto& in) {
                  const auto hit = in.intersect(ray, Interval{});
                  return Color(hit ? static_cast<float>(hit->t) : 0.0f);
                }) == 0);
        }
      }
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
  int met = 0, kept = 0, all = 0;
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
      ++all, kept += in_tile.size();
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

TEST_CASE("an edge out of focus fades as the disk's segment beyond it, pixel by pixel") {
  // A pixel at u sees of the plane z = d, from the lens point x, the place u d + x (1 − d/s). Beyond the edge
  // at e are the points of the unit disk beyond c = (e − u d)/(r |1 − d/s|), of which the share is the
  // segment's (arccos c − c √(1 − c²))/π; its mean over a pixel is the difference of the integral G.
  const auto integral = [](double c) {
    if (c >= 1) return 0.0;
    if (c <= -1) return c;
    const double root = std::sqrt(1 - c * c);
    return (c * std::acos(c) - root + root * root * root / 3) / std::numbers::pi;
  };
  constexpr int width = 32, height = 4, samples = PROTOSTAR_LONG_FORMS ? 1024 : 32;
  struct {
    double depth, focus, aperture, edge;
  } const rows[] = {{2, 1, 4, 1}, {1, 2, 4, 0.5}, {3, 2, 6, -0.75}};
  for (const auto& row : rows)
    for (const SamplerChoice& sampler :
         {sampler_of<SobolSampler>, sampler_of<HaltonSampler>, sampler_of<StratifiedSampler>}) {
      CAPTURE(row.depth, row.focus, row.aperture);
      Scene<Parallelogram> scene;
      scene.add(Parallelogram{{row.edge, -1000, row.depth}, {1000, 0, 0}, {0, 2000, 0}}, Color{1});
      const Camera camera = Camera::thin_lens({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 90, row.aperture, row.focus);
      std::vector<Image> pictures;
      for (int r = 0; r < LightTruth::scramblings; ++r) {
        pictures.emplace_back(width, height);
        render(pictures.back(), camera, scene, ColorIntegrator{},
               {.samples = samples, .sampler = sampler, .seed = static_cast<std::uint64_t>(r)});
      }
      LightTruth truth;
      const double radius = row.aperture * std::abs(1 - row.depth / row.focus);
      for (int x = 0; x < width; ++x) {
        const auto place = [&](int column) {
          return (row.edge - Camera::u_at(column, width, height) * row.depth) / radius;
        };
        const double from = place(x + 1), to = place(x);
        for (int y = 0; y < height; ++y) {
          std::vector<double> means;
          for (const Image& picture : pictures) means.push_back(picture(x, y).g);
          const double share = integral(to) - integral(from);
          truth.compare(means, share / (to - from), "pixel", x, y);
        }
      }
      CHECK(truth.wrong == 0);
      CHECK(truth.lit > width / 2);
      CHECK(std::abs(truth.mean_error) <=
            LightTruth::most_errors * std::sqrt(truth.variance) + 0x1p-20 * truth.mean_truth);
      CHECK(truth.detectable_bias() < (PROTOSTAR_LONG_FORMS ? 2e-3 : 0.02));
    }
}

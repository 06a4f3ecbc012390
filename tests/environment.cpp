// The environment: radiance of rays that hit nothing, by direction.
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
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
#include <protostar/io/hdr.hpp>
#include <protostar/io/image_texture.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>

#include "scenes/dusk.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

/// Returns u as red and v as green.
Color place(double u, double v) { return {static_cast<float>(u), static_cast<float>(v), 1}; }

/// Returns a color that differs everywhere.
Color colored_waves(double u, double v) {
  return Color{Vec3{2 + std::cos(40 * u), 2 + std::cos(50 * v), 2 + std::sin(30 * u * v)} / 3.0};
}

Color seen(const auto& integrator, const auto& scene, const Vec3& direction) {
  return integrator.radiance(Ray{{0, 0, 0}, direction}, scene);
}

}  // namespace

TEST_CASE(
    "a ray that hits nothing has the radiance of the environment in its direction, u around the y axis and v "
    "from the top") {
  Scene<Sphere> scene;
  scene.set_environment(place);
  struct {
    Vec3 direction;
    Color expected;
  } const rows[] = {
      {{0, 0, 1}, {0.5f, 0.5f, 1}},
      {{1, 0, 0}, {0.75f, 0.5f, 1}},
      {{-1, 0, 0}, {0.25f, 0.5f, 1}},
      {{0, 1, 0}, {0.5f, 0, 1}},
      {{0, -1, 0}, {0.5f, 1, 1}},
      {{0, 1, 1}, {0.5f, 0.25f, 1}},
      {{1, 0, 1}, {0.625f, 0.5f, 1}},
      {{0, 0, 1e-300}, {0.5f, 0.5f, 1}},
      {{1e300, 0, 1e300}, {0.625f, 0.5f, 1}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.direction.x, row.direction.y, row.direction.z);
    CHECK(seen(ColorIntegrator{}, scene, row.direction) == row.expected);
  }
  CHECK(environment_uv({0, -1, 0}).y == 1 - 0x1p-53);  // at 1 a texture that repeats has its top again
  // u is off from the edge by 1e-9/2π, less than 2^-32; a float at 1 is rounded by up to 2^-25.
  CHECK(std::abs(seen(ColorIntegrator{}, scene, {1e-9, 0, -1}).r - 1) <= 0x1p-24f);
  CHECK(std::abs(seen(ColorIntegrator{}, scene, {-1e-9, 0, -1}).r) <= 0x1p-32f);
}

TEST_CASE(
    "an image as an environment has its left edge at u = 0 and is mixed between the centers of its pixels") {
  Image picture(4, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) picture(x, y) = Color{Vec3(x, y, 1)};
  const EnvironmentImage environment{std::make_shared<const Image>(picture)};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct {
    double u, v;
    Color expected;
  } const rows[] = {
      {0.125, 0.25, {0, 0, 1}},     {0.625, 0.75, {2, 1, 1}},          // centers of pixels
      {0.375, 0.5, {1, 0.5, 1}},    {0.25, 0.25, {0.5, 0, 1}},         // between two
      {0.5, 0.5, {1.5, 0.5, 1}},    {0.4375, 0.375, {1.25, 0.25, 1}},  // between four
      {0, 0.25, {1.5, 0, 1}},       {1, 0.25, {1.5, 0, 1}},            // across the left and the right edge
      {0.9375, 0.25, {2.25, 0, 1}}, {-0.0625, 0.25, {2.25, 0, 1}},
      {0.125, 0, {0, 0, 1}},        {0.125, 1, {0, 1, 1}},  // beyond the outer centers
      {0.125, 0.125, {0, 0, 1}},    {nan, nan, {0, 0, 1}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.u, row.v);
    CHECK(environment(row.u, row.v) == row.expected);
  }
  Scene<Sphere> scene;
  scene.set_environment(environment);
  CHECK(seen(ColorIntegrator{}, scene, {0, 0, 1}) == Color{1.5, 0.5, 1});
  CHECK(seen(ColorIntegrator{}, scene, {0, -1, 0}) == Color{1.5, 1, 1});

  const TemporaryFolder folder;
  save_hdr(picture, folder / "a.hdr");
  CHECK(environment_image(folder / "a.hdr")(0.25, 0.5) == Color{0.5, 0.5, 1});
}

TEST_CASE("the evening sky is the same from dusk.hdr and from dusk.hpp") {
  const Image file = load_image(std::filesystem::path(PROTOSTAR_SOURCE_DIR) / "scenes" / "dusk.hdr");
  CHECK(count_pixels(file, [&](int x, int y) {
          const Color light = dusk((x + 0.5) / file.width(), (y + 0.5) / file.height());
          return file(x, y) != detail::nearest_rgbe(light);
        }) == 0);
  CHECK(file.width() == 1024);
}

TEST_CASE("integrators of light return the environment, even if there is a sky; others return black") {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, -3}}, Color{0.5f});
  scene.set_sky({9, 9, 9});
  scene.set_environment(colored_waves);
  const Vec3 direction{0.3, 0.2, 1};
  const Uv uv = direction_uv(normalize(direction));
  const Color expected = colored_waves(uv.x, uv.y);
  CHECK(seen(ColorIntegrator{}, scene, direction) == expected);
  CHECK(seen(DiffuseIntegrator{}, scene, direction) == expected);
  CHECK(seen(ShadowIntegrator{}, scene, direction) == expected);
  CHECK(seen(WhittedIntegrator{}, scene, direction) == expected);
  CHECK(seen(TransparencyIntegrator{}, scene, direction) == expected);
  CHECK(seen(BinaryIntegrator{}, scene, direction) == Color{0});
  CHECK(seen(DepthIntegrator{}, scene, direction) == Color{0});
  CHECK(seen(NormalIntegrator{}, scene, direction) == Color{0});
  CHECK(seen(ColorIntegrator{}, accelerate(scene), direction) == expected);
  const Color behind = colored_waves(direction_uv({0, 0, -1}).x, 0.5);
  CHECK(seen(TransparencyIntegrator{}, scene, {0, 0, -1}) == behind * Color{0.5f} * Color{0.5f});
}

TEST_CASE(
    "a mirror shows the environment in the mirrored direction, and beyond the depth limit in the ray's own "
    "direction") {
  Scene<Plane> scene;
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 2}, Material{.reflect = 1});
  scene.set_environment(place);
  const Color mirrored = seen(WhittedIntegrator{}, scene, {1, 0, 1});
  CHECK(std::abs(mirrored.r - 0.875f) <= 0x1p-24f);  // a float there is rounded by up to 2^-25
  CHECK(seen(WhittedIntegrator{.depth = 1}, scene, {1, 0, 1}) == mirrored);
  CHECK(seen(WhittedIntegrator{.depth = 0}, scene, {1, 0, 1}) == Color{0.625f, 0.5f, 1});
}

TEST_CASE("pictures with an environment are the same plain, accelerated and by tiles") {
  Random random(91);
  const int count = GENERATE(0, 3, 40);  // with 40 spheres, rays are traced one by one
  const int samples = GENERATE(0, 3);
  CAPTURE(count, samples);
  Scene<Sphere> scene;
  for (int i = 0; i < count; ++i)
    scene.add(Sphere{Vec3{0, 0, 4} + random.point(2), 0.5},
              Material{.diffuse = random.color(), .reflect = 0.4, .refract = i % 2 == 0 ? 0.5 : 0});
  scene.add(PointLight{.position = {3, 5, 0}, .power = Color{200}});
  scene.set_environment(colored_waves);
  const RenderOptions options{.samples = samples}, plainly{.samples = samples, .tiles = false};
  const auto check = [&](const auto& integrator, const auto& camera) {
    Image by_tiles(90, 66), plain(90, 66), accelerated(90, 66);
    render(by_tiles, camera, scene, integrator, options);
    render(plain, camera, scene, integrator, plainly);
    const auto fast = accelerate(scene);
    render(
        accelerated, camera, [&](const Ray& ray) { return integrator.radiance(ray, fast); }, plainly);
    CHECK(different_pixels(by_tiles, plain) == 0);
    CHECK(different_pixels(accelerated, plain) == 0);
    CHECK(count_pixels(plain, [&](int x, int y) { return plain(x, y) != plain(0, 0); }) > 5000);
  };
  check(WhittedIntegrator{.depth = 4}, Camera{});
  check(WhittedIntegrator{.depth = 0}, Camera{});
  check(TransparencyIntegrator{}, Camera{});
  check(WhittedIntegrator{.depth = 4}, Camera::sensor({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0.5));
}

TEST_CASE("an environment without a function is refused") {
  Scene<Sphere> scene;
  CHECK_THAT(message_of<std::invalid_argument>([&] { scene.set_environment({}); }),
             ContainsSubstring("Scene::set_environment"));
  CHECK_FALSE(scene.environment());
}

TEST_CASE("an environment is a function of the direction, or of its u and v") {
  const auto by_uv = [](double u, double v) { return Color{Vec3{u, v, 0.5}}; };
  const auto by_direction = [&](const Vec3& d) {
    const Uv uv = direction_uv(d);
    return by_uv(uv.x, uv.y);
  };
  const Environment first = by_uv, second = by_direction, copy = second;
  CHECK(first.by_uv());
  CHECK_FALSE(second.by_uv());
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    const Vec3 d = random.direction();
    CHECK(first(d) == by_direction(d));
    CHECK(second(d) == first(d));
    CHECK(copy(d) == first(d));
    // The ray may have any length.
    CHECK(environment_radiance(second, Ray{{}, 0x1p600 * d}) == environment_radiance(second, Ray{{}, d}));
  }
  CHECK_FALSE(Environment());
  const Image of_first = first.image(8, 4), of_second = second.image(8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      const double u = (x + 0.5) / 8, v = (y + 0.5) / 4;
      CHECK(of_first(x, y) == by_uv(u, v));
      const Color light = of_second(x, y);
      CHECK(std::abs(light.r - u) < 0x1p-24);  // a float below 1 is off by 2^-25 at most, angles by less
      CHECK(std::abs(light.g - v) < 0x1p-24);
    }
}

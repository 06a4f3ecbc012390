// Culling by tiles: how much work it saves, and that the picture remains the same.
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/everything.hpp"
#include "support/mirrors.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

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
      CHECK(taken.surface_tests <= 5 * taken.camera_rays);  // float may tell of all
    }
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
  const RenderStatistics depth = taken_by(scene, DepthIntegrator{});
  CHECK(depth.surface_tests == depth.camera_rays);
  CHECK(depth.camera_rays < 320 * 240 / 5);
  // Float tells whether it is hit, but for rays at its outline; for parts of tiles inside of the outline, it
  // tells for all rays at once.
  const RenderStatistics binary = taken_by(scene, BinaryIntegrator{});
  CHECK(binary.float_tests < depth.surface_tests);
  CHECK(binary.float_tests > depth.surface_tests / 2);
  CHECK(binary.surface_tests == binary.camera_rays);
  CHECK(binary.camera_rays < depth.camera_rays / 20);

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
      CHECK(taken.camera_rays >= all.camera_rays);
      if (!skips.empty_tiles) CHECK(taken.camera_rays == 200 * 150);
      CHECK(taken.pixels_skipped + taken.camera_rays == 200 * 150);
      return taken;
    };
    CHECK(all.pixels_skipped > 10000);
    CHECK((all.other_rays > 4000) == casts_shadows);
    CHECK(with({.empty_tiles = false}).surface_tests >= all.surface_tests);
    // Of few surfaces, t is as soon computed in double, but colors are sure in float.
    CHECK((with({.sure_in_float = false}).surface_tests > all.surface_tests) ==
          (scene.size() > 16 || !casts_shadows));
    // Occluder lists are built on demand, so the number of tests may be lower or higher with them.
    const RenderStatistics each = with({.occluder_lists = false});
    CHECK((each.rays_alone > all.rays_alone) == has_lists);
    CHECK(each.rays_alone == (has_lists ? all.other_rays : 0));
    const RenderStatistics nothing_skipped = with({false, false, false});
    CHECK(nothing_skipped.camera_rays > all.camera_rays);
    if (!has_lists) CHECK(nothing_skipped.surface_tests >= all.surface_tests);
    CHECK(nothing_skipped.rays_alone == each.rays_alone);
  };
  for (const Everything* const scene : {&few, &many}) {
    check(*scene, ColorIntegrator{}, false);
    check(*scene, ShadowIntegrator{}, true);
  }

  // In a picture of fewer than 64 pixels for each surface, no shadow ray gets a list of occluders.
  Image small(100, 75);
  RenderStatistics taken;
  render(small, Camera{}, many, ShadowIntegrator{}, {.statistics = &taken});
  CHECK(taken.other_rays > 1000);
  CHECK(taken.rays_alone == taken.other_rays);
  render(small, Camera{}, many, ShadowIntegrator{}, {.crop = {50, 37, 200, 150}, .statistics = &taken});
  CHECK(taken.rays_alone < taken.other_rays);
}

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {
const Color sky{0.25f, 0.5f, 1};
constexpr double degree = std::numbers::pi / 180;

/// Returns a scene of walls orthogonal to z, each with its material, and a sky.
Scene<Plane> walls(const std::vector<std::pair<double, Material>>& all) {
  Scene<Plane> scene;
  scene.set_sky(sky);
  for (const auto& [z, material] : all) scene.add(Plane{.normal = {0, 0, -1}, .distance = -z}, material);
  return scene;
}

/// Returns the scene with ambient light of 1, in which surfaces shine in their diffuse color.
Scene<Plane> shining(Scene<Plane> scene) {
  scene.add(AmbientLight{Color{1}});
  return scene;
}

Color seen(const auto& scene, int depth = 10, const Ray& ray = ray_along_z) {
  return WhittedIntegrator{.depth = depth}.radiance(ray, scene);
}

/// Scene that counts its queries.
struct Counting {
  const Scene<Plane>& scene;
  mutable int rays = 0, shadow_rays = 0;

  std::optional<Intersection> intersect(const Ray& ray, Interval range) const {
    ++rays;
    return scene.intersect(ray, range);
  }
  bool occluded(const Ray& ray, Interval range) const {
    ++shadow_rays;
    return scene.occluded(ray, range);
  }
  void crossings(const Ray&, Interval, auto&&) const {}
  const std::vector<Light>& lights() const { return scene.lights(); }
};
static_assert(Traceable<Counting>);
}  // namespace

TEST_CASE("reflection reverses the component of a direction along the normal") {
  const Vec3 up{0, 1, 0}, slant = normalize(Vec3{1, 1, 0});
  CHECK(reflected({0.6, -0.8, 0}, up) == Vec3{0.6, 0.8, 0});
  CHECK(reflected({0, -1, 0}, up) == Vec3{0, 1, 0});
  CHECK(reflected({1, 0, 0}, up) == Vec3{1, 0, 0});
  // With u = 2^-53, unit vectors are off by 4.5u (camera.cpp), and so is twice n·d n, by 18u for the square
  // of n in it, 3u for the dot product, and 3u for products and the sum; dot products here have 3u each.
  constexpr double u = 0x1p-53;
  CHECK(length(reflected({-1, 0, 0}, slant) - Vec3{0, 1, 0}) <= (18 + 2 * 3 + 3) * u);
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 d = random.direction(), n = random.direction(), r = reflected(d, n);
    CHECK(std::abs(dot(r, n) + dot(d, n)) <= (18 + 2 * 3 + 3 + 2 * 3) * u);
    // In the plane of both: products and differences are off by 2u and 3u, a cross product by 2√2 u, twice.
    CHECK(length(cross(n, r - d)) <= (2 * 2 + 3 + 4 * std::sqrt(2)) * u);
    CHECK(std::abs(length(r) - 1) <= (4.5 + 18 + 2 * 3 + 3 + 2.5) * u);
  }
}

TEST_CASE("refraction obeys Snell's law") {
  struct {
    double degrees, ratio;  // angle of incidence, and ratio of the indices
    double behind;          // angle of refraction; 90 and more: none
  } const rows[] = {
      {0, 1 / 1.5, 0},
      {30, 1 / 1.5, 19.471220634490691},
      {45, 1 / 1.5, 28.125505702055708},
      {60, 1 / 1.33, 40.628130651},
      {89.9, 1 / 1.5, 41.810236842},
      {0, 1.5, 0},
      {30, 1.5, 48.590377890729},
      {41.8, 1.5, 88.850362277},
      {41.82, 1.5, 90},  // sin 41.81° = 1/1.5
      {60, 1.5, 90},
      {89.9, 1.5, 90},
      {45, 1, 45},
      {89.9, 1, 89.9},
  };
  for (const auto& row : rows) {
    CAPTURE(row.degrees, row.ratio);
    const Vec3 normal{0, 1, 0};
    const Vec3 d{std::sin(row.degrees * degree), -std::cos(row.degrees * degree), 0};
    const auto [passes, behind] = refracted(d, normal, row.ratio);
    REQUIRE(passes == (row.behind < 90));
    if (!passes) continue;
    CHECK(std::abs(std::atan2(behind.x, -behind.y) / degree - row.behind) <= 0.5e-9);  // digits of the table
    // With u = 2^-53, the sine is off by 2u of itself, the square of the cosine by 3u for the root and u for
    // the sum, d by 2u, and the length here by 2.5u.
    CHECK(std::abs(behind.x - row.ratio * d.x) <= 2 * 0x1p-53 * behind.x);
    CHECK(behind.z == 0);
    CHECK(std::abs(length(behind) - 1) <= (2 + 2 + 2 + 2.5) * 0x1p-53);
  }
}

TEST_CASE("a mirror adds its share of the mirrored light") {
  const Material wall{.diffuse = {0.5f, 0.25f, 0}};
  auto scene = shining(walls({{3, {.reflect = 0.5}}, {-2, wall}}));
  CHECK(seen(scene) == 0.5f * wall.diffuse);
  CHECK(seen(walls({{3, {.reflect = 0.5}}})) == 0.5f * sky);
  CHECK(seen(walls({{3, {.reflect = 2}}})) == 2.0f * sky);  // no further weights
  // The mirror's own diffuse light is added.
  scene = shining(walls({{3, {.diffuse = {0, 0, 1}, .reflect = 0.5}}, {-2, wall}}));
  CHECK(seen(scene) == Color{0, 0, 1} + 0.5f * wall.diffuse);
}

TEST_CASE("a share too small for a float counts as 0, however bright the mirror image") {
  const float most = std::numeric_limits<float>::max();
  for (const Material& faint : {Material{.diffuse = Color{0.5f}, .reflect = 1e-60},
                                Material{.diffuse = Color{0.5f}, .refract = 1e-60, .ior = 1}}) {
    // Ambient light makes the color of the other walls twice the largest float, which overflows.
    Scene<Plane> scene = walls({{2, faint}, {-1, {.diffuse = Color{most}}}, {3, {.diffuse = Color{most}}}});
    scene.add(AmbientLight{Color{2}});
    CHECK(seen(scene) == Color{1});
  }
}

TEST_CASE("a mirror shows the surface that the reflected ray hits") {
  Scene<Plane, Sphere> scene;
  scene.add(AmbientLight{Color{1}});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Material{.reflect = 1});
  scene.add(Sphere{.center = {4, 2, 0}, .radius = 0.25}, Color{1, 0, 0});
  // The line from (0, 2, 0) to the mirror image (4, −4, 0) of the center crosses the ground at (2, −1, 0).
  CHECK(seen(scene, 10, {{0, 2, 0}, {4, -6, 0}}) == Color{1, 0, 0});
  CHECK(seen(scene, 10, {{0, 2, 0}, {4, -5, 0}}) == Color{0});
  CHECK(seen(scene, 10, {{0, 2, 0}, {0.004, -0.006, 0}}) == Color{1, 0, 0});
}

TEST_CASE("glass bends a ray where it enters and where it leaves") {
  // Glass ball: a ray at a height h enters at the angle a with sin a = h, continues at b with sin b = h/1.5,
  // and has turned by 2(a − b) in all.
  const Material glass{.refract = 1};
  for (const double h : {0.0, 0.25, 0.5, 0.9, -0.7}) {
    CAPTURE(h);
    const double a = std::asin(h), b = std::asin(h / 1.5), turned = 2 * (a - b);
    // Point where the ray leaves, relative to the center, and its direction there.
    const Point out{0, std::sin(2 * b - a), std::cos(2 * b - a)};
    const Vec3 onward{0, -std::sin(turned), std::cos(turned)};
    Scene<Sphere> scene;
    scene.add(AmbientLight{Color{1}});
    scene.add(Sphere{}, glass);
    scene.add(Sphere{.center = out + 20.0 * onward, .radius = 1e-6}, Color{1, 0.5f, 0});
    const Ray ray{{0, h, -5}, {0, 0, 1}};
    CHECK(seen(scene, 3, ray) == Color{1, 0.5f, 0});
    CHECK(seen(scene, 2, ray) == Color{0});
  }
}

TEST_CASE("the surface's own normal tells inside from outside") {
  // Water below the plane, and a lamp in the direction given by Snell's law.
  const Material water{.refract = 1, .ior = 1.33};
  const double a = 40 * degree, b = std::asin(std::sin(a) / 1.33);
  const Vec3 above{std::sin(a), -std::cos(a), 0}, below{std::sin(b), -std::cos(b), 0};
  for (const bool enters : {true, false})
    for (const double sign : {1.0, -1.0}) {  // a normal that points down makes the upper side the inside
      const Vec3 d = enters == (sign > 0) ? above : Vec3{below.x, below.y, 0};
      const Vec3 onward = enters == (sign > 0) ? below : above;
      const double flip = enters ? 1 : -1;  // mirrored for rays from below
      Scene<Plane, Sphere> scene;
      scene.add(AmbientLight{Color{1}});
      scene.add(Plane{.normal = {0, sign, 0}, .distance = 0}, water);
      scene.add(Sphere{.center = {5 * onward.x, flip * 5 * onward.y, 0}, .radius = 1e-6}, Color{1});
      CAPTURE(enters, sign);
      const bool from_thin = enters == (sign > 0);
      CHECK(from_thin == (d == above));
      CHECK(seen(scene, 2, {{-3 * d.x, -3 * flip * d.y, 0}, {d.x, flip * d.y, 0}}) == Color{1});
    }
}

TEST_CASE("total reflection refracts no light, and leaves the mirror's share unchanged") {
  Scene<Sphere> scene;
  scene.set_sky(sky);
  scene.add(Sphere{}, Material{.refract = 1, .ior = 1.5});
  // From inside, at an angle whose sine is 0.8 > 1/1.5.
  CHECK(seen(scene, 10, {{0.8, 0, 0}, {0, 0, 1}}) == Color{0});
  CHECK(seen(scene, 10, {{0.6, 0, 0}, {0, 0, 1}}) == sky);
  Scene<Sphere> mirroring;
  mirroring.set_sky(sky);
  mirroring.add(Sphere{}, Material{.reflect = 0.5, .refract = 1, .ior = 1.5});
  // Each reflection is at the same angle, and total, so only the path's end brings light.
  CHECK(seen(mirroring, 3, {{0.8, 0, 0}, {0, 0, 1}}) == 0.125f * sky);
}

TEST_CASE("a path ends after as many rays as depth says, and sees the sky") {
  // A path between two mirrors never ends.
  const auto scene = walls({{3, {.diffuse = Color{0}, .reflect = 0.5}}, {-2, {.reflect = 0.5}}});
  CHECK(seen(scene, 0) == sky);
  float share = 1;
  for (int depth = 1; depth <= 20; ++depth) {
    share /= 2;
    CHECK(seen(scene, depth) == share * sky);
    const Counting counting{scene};
    CHECK(seen(counting, depth) == Color{0});  // Counting has no sky
    CHECK(counting.rays == depth);
  }
}

TEST_CASE("an invalid depth is refused, by render before the first ray") {
  const auto scene = walls({{3, {.reflect = 0.5}}, {-2, {.reflect = 0.5}}});
  for (const int depth : {-3, -1, std::numeric_limits<int>::min(), 1001, 1'000'000}) {
    const WhittedIntegrator integrator{.depth = depth};
    Image image(4, 4);
    const std::string sentence =
        "WhittedIntegrator: depth must be from 0 to 1000; it is " + std::to_string(depth);
    CHECK(message_of<std::invalid_argument>([&] { integrator.validate(); }) == sentence);
    for (const bool tiles : {true, false})
      CHECK(message_of<std::invalid_argument>(
                [&] { render(image, Camera{}, scene, integrator, {.tiles = tiles}); }) == sentence);
    CHECK(message_of<std::invalid_argument>(
              [&] { render(image, Camera{}, accelerate(scene), integrator); }) == sentence);
    CHECK(image(1, 1) == Color{0});
    // Without render, a depth below 0 is refused where a path ends.
    if (depth < 0) CHECK(message_of<std::invalid_argument>([&] { seen(scene, depth); }) == sentence);
  }
  CHECK_NOTHROW(WhittedIntegrator{.depth = 0}.validate());
  CHECK_NOTHROW(WhittedIntegrator{.depth = 1000}.validate());
  CHECK(seen(scene, 1000) == Color{0});  // shares of 2^-1000, on the stack of this thread
}

TEST_CASE("rays that cannot add light are not traced") {
  const Point light{0, 0, 1};
  const auto asked = [&](const Material& material, const auto& lamp) {
    auto scene = walls({{3, material}});
    scene.add(lamp);
    const Counting counting{scene};
    static_cast<void>(seen(counting));
    return std::pair(counting.rays, counting.shadow_rays);
  };
  const PointLight lamp{.position = light, .power = Color{1}};
  CHECK(asked({.diffuse = Color{1}}, lamp) == std::pair(1, 1));
  CHECK(asked({.specular = Color{1}}, lamp) == std::pair(1, 1));
  CHECK(asked({}, lamp) == std::pair(1, 0));
  CHECK(asked({.reflect = 1}, lamp) == std::pair(2, 0));
  CHECK(asked({.refract = 1}, lamp) == std::pair(2, 0));
  CHECK(asked({.diffuse = Color{1}}, PointLight{.position = {0, 0, 4}, .power = Color{1}}) ==
        std::pair(1, 0));
  CHECK(asked({.diffuse = Color{1}}, PointLight{.position = light}) == std::pair(1, 0));
  CHECK(asked({.diffuse = Color{1, 0, 0}}, PointLight{.position = light, .power = {0, 1, 1}}) ==
        std::pair(1, 0));
  CHECK(asked({.diffuse = Color{1}},
              SpotLight{.position = light, .direction = {0, 1, 0}, .power = Color{1}}) == std::pair(1, 0));
  // Far from the middle of a narrow highlight.
  CHECK(asked({.specular = Color{1}, .shininess = 1e5},
              PointLight{.position = {2, 0, 1}, .power = Color{1}}) == std::pair(1, 0));
}

TEST_CASE("Phong's highlight: E⊥ times the cosine, to a power, between the eye and the reflected light") {
  // The ray hits the wall at (0, 0, 3) head-on, so the cosine is that of the light's angle.
  struct {
    double degrees, shininess;
  } const rows[] = {{0, 50}, {10, 50}, {45, 1},   {45, 2},   {45, 0.5}, {60, 10}, {80, 3},
                    {60, 0}, {5, 1e4}, {1, 1425}, {30, 150}, {89, 1},   {30, 700}};
  for (const auto& row : rows) {
    CAPTURE(row.degrees, row.shininess);
    const double a = row.degrees * degree;
    const Vec3 to_light{std::sin(a), 0, -std::cos(a)};
    auto scene = walls({{3, {.specular = {1, 0.5f, 2}, .shininess = row.shininess}}});
    scene.add(ConstantLight{.position = Point{0, 0, 3} + 2.0 * to_light, .intensity = Color{3, 3, 0.5f}});
    const auto lobe = static_cast<float>(std::pow(std::cos(a), row.shininess));
    CHECK(near(seen(scene), lobe * Color{3, 1.5f, 1}));
  }

  // Oblique ray: brightest if the light is in the mirror's direction.
  const Ray slant{{-3, 0, 0}, {1, 0, 1}};  // hits the wall at (0, 0, 3)
  const auto highlight = [&](const Vec3& to_light) {
    auto scene = walls({{3, {.specular = Color{1}, .shininess = 2}}});
    scene.add(DirectionalLight{.direction = to_light, .intensity = Color{1}});
    return seen(scene, 1, slant);
  };
  CHECK(highlight({1, 0, -1}) == Color{1});
  CHECK(highlight({0, 0, -1}) == Color{0.5f});
  CHECK(highlight({1, std::sqrt(2.0), -1}) == Color{0.5f});
  CHECK(highlight({1, 0, -1e-9}) == Color{0.5f});
  CHECK(highlight({-1, 0, -1e-9}) == Color{0});  // more than a right angle away
  CHECK(highlight({1, 0, 0}) == Color{0});       // in the plane of the surface
  CHECK(highlight({1, 0, 0.5}) == Color{0});     // behind the surface
}

TEST_CASE("a highlight is the float nearest to the power of its cosine") {
  if (!long_double_judges()) return;
  Random random(5);
  for (const double shininess :
       {0.0, 0.3, 1.0, 2.0, 3.0, 10.0, 12.5, 50.0, 125.0, 1425.0, 60001.0, 65536.0, 65537.0}) {
    CAPTURE(shininess);
    WrongCases wrong(random);
    // If the power is much below 1, where double is least certain, one in thousands is in doubt.
    for (int i = 0; i < (shininess == 60001 ? 50000 : 500); ++i) {
      const double height = 1 - random.real(0, std::min(1.0, 90 / shininess));
      const DirectionalLight lamp{.direction = {std::sqrt(1 - height * height), 0, -height},
                                  .intensity = Color{1}};
      auto scene = walls({{3, {.specular = Color{1}, .shininess = shininess}}});
      scene.add(lamp);
      const Vec3 to_light = Light(lamp).towards(Point{0, 0, 3});
      const double cosine = -to_light.z / length(to_light);
      const long double power =
          std::pow(static_cast<long double>(cosine), static_cast<long double>(shininess));
      wrong.add(seen(scene) != Color{static_cast<float>(power)}, to_light, power);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a highlight falls off with a lamp's distance as its light does, without the cosine") {
  auto scene = walls({{3, {.diffuse = Color{1}, .specular = Color{1}, .shininess = 0}}});
  const Vec3 to_light{2, 0, -1};
  scene.add(PointLight{.position = Point{0, 0, 3} + to_light, .power = Color{4 * std::numbers::pi_v<float>}});
  const double e = 1 / dot(to_light, to_light), cosine = 1 / std::sqrt(dot(to_light, to_light));
  CHECK(near(seen(scene), Color{static_cast<float>(e * cosine + e)}));
}

TEST_CASE("a light that is hidden adds nothing; ambient light is everywhere") {
  const Material matte{.diffuse = {0.5f, 0.25f, 1}, .specular = Color{1}, .shininess = 0};
  for (const double z : {2.0, 4.0, 20.0}) {  // position of a ball; the light is at z = 1, the wall at z = 3
    Scene<Plane, Sphere> scene;
    scene.add(Plane{.normal = {0, 0, -1}, .distance = -3}, matte);
    scene.add(Sphere{.center = {0, 0, z}, .radius = 0.25}, Color{1});
    scene.add(ConstantLight{.position = {0, 0, 1}, .intensity = Color{1}});
    CAPTURE(z);
    const Ray ray{{-1.5, 0, 0}, {1.5, 0, 3}};  // beside the ball
    const bool hidden = z == 2;
    CHECK((seen(scene, 1, ray) == Color{0}) == hidden);
    scene.add(AmbientLight{{2, 4, 0}});
    CHECK((seen(scene, 1, ray) == Color{1, 1, 0}) == hidden);
    CHECK(seen(scene, 1, {{0, 0, 2.9}, {0, 0, 0.1}}).r >= 1);
  }
}

TEST_CASE("surfaces without a mirror or glass look as they do under ShadowIntegrator") {
  Scene<Sphere, Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1},
            Material{.texture = Checker{{1, 0.5f, 0}, {0, 0.25f, 0.5f}, 0.7}});
  scene.add(Sphere{.center = {0, 0, 4}}, Color{0.5f, 1, 0.25f});
  scene.add(Sphere{.center = {1, 1, 2}, .radius = 0.5}, Color{1, 1, 0.25f});
  scene.add(PointLight{.position = {2, 4, 0}, .power = Color{100}});
  scene.add(DirectionalLight{.direction = {-1, 1, -1}, .intensity = Color{0.5f}});
  scene.add(SpotLight{
      .position = {0, 3, 3}, .direction = {0, -1, 0}, .angle = 40, .power = Color{200}, .fade = 20});
  scene.add(AmbientLight{Color{0.125f}});
  scene.set_sky(sky);
  Random random(8);
  WrongCases differing(random);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{{0, 0, -1}, normalize(Vec3{random.real(-1, 1), random.real(-1, 1), 1})};
    differing.add(seen(scene, 1, ray) != ShadowIntegrator{}.radiance(ray, scene), ray);
  }
  CHECK(differing == 0);
}

TEST_CASE("the length of a ray's direction does not change its light") {
  auto scene = shining(
      walls({{3, {.specular = Color{1}, .shininess = 5, .reflect = 0.5}}, {-2, {.diffuse = {1, 0, 0}}}}));
  scene.add(ConstantLight{.position = {1, 0, 0}, .intensity = Color{1}});
  const Color expected = seen(scene, 5, {{0, 0, 0}, {0.25, 0, 1}});
  for (const double length : {0x1p-100, 0.5, 8.0, 0x1p100})
    CHECK(seen(scene, 5, {{0, 0, 0}, length * Vec3{0.25, 0, 1}}) == expected);
}

TEST_CASE("a surface with an emission is seen so, also in a mirror, and does not light others") {
  const Color light{0.5f, 2, 0};
  // A wall that emits, seen directly; then behind glass and in a mirror that emits as well.
  CHECK(seen(walls({{3, {.emission = light}}})) == light);
  CHECK(seen(walls({{3, {.reflect = 0.5, .emission = Color{1}}}, {-2, {.emission = light}}})) ==
        Color{1} + 0.5f * light);
  CHECK(seen(walls({{3, {.refract = 0.25, .ior = 1}}, {4, {.emission = light}}})) == 0.25f * light);
  CHECK(seen(walls({{3, {.diffuse = Color{1}}}, {-2, {.emission = light}}})) == Color{0});
  CHECK(seen(walls({{3, {.emission = Color{std::numeric_limits<float>::max()}}}})) ==
        Color{std::numeric_limits<float>::max()});
}

#include <protostar/scene_fields.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <protostar/any_scene.hpp>
#include <protostar/encode.hpp>
#include <protostar/exact/functions.hpp>
#include <protostar/integrators/distance_occlusion.hpp>
#include <protostar/integrators/distance_shadow.hpp>
#include <protostar/integrators/enclosure_width.hpp>
#include <protostar/integrators/march_evaluations.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/moving.hpp>
#include <string>

#include "support/catch.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

const auto marched_ball = [](const auto& p) { return length(p - Vec3{0, 0, 4}) - 1.0; };
const auto marched_ring = [](const auto& p) {
  const auto q = p - Vec3{0.3, 0, 4};
  return length(Vec2{length(Vec2{q.x, q.y}) - 1.2, q.z}) - 0.25;
};
const Bounds around_both{{-2, -2, 2}, {2, 2, 6}};

/// A ball and a ring that are marched, and a floor that is not, each in AnySurface.
AnyScene marched_and_floor() {
  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(Marched{marched_ball, around_both}, Color{0.8f});
  scene.add(Marched{marched_ring, around_both}, Color{0.8f});
  return scene;
}

/// Returns V of a disk on one side of a line at s radii from its center.
double seen_of_disk(double s) {
  if (std::abs(s) >= 1) return s > 0;
  return 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi;
}

/// A sphere that counts how often it tells its distance.
struct AskedSphere {
  Sphere sphere;
  static inline int asked = 0;

  std::optional<double> intersect(const Ray& ray, Interval range) const {
    return sphere.intersect(ray, range);
  }
  Vec3 normal_at(Point p) const { return sphere.normal_at(p); }
  Bounds bounds() const { return sphere.bounds(); }
  double distance_bound(const Point& p) const {
    ++asked;
    return sphere.distance_bound(p);
  }
};

}  // namespace

TEST_CASE("the distance from a scene is the least of all, and surfaces surely farther are not asked") {
  Random random(25);
  WrongCases wrong(random);
  int asked = 0, all = 0;
  for (int round = 0; round < 20; ++round) {
    Scene<Plane, AskedSphere, Box, Marched<decltype(marched_ball)>> scene;
    scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
    scene.add(Marched{marched_ball, around_both}, Color{0.5f});
    for (int i = 0; i < 10; ++i) {
      const Point at = random.point(5), low = random.point(5);
      scene.add(AskedSphere{{at, random.real(0.1, 1)}}, Color{0.5f});
      scene.add(Box{low, low + Vec3{random.real(0.1, 2)}}, Color{0.5f});
    }
    const SceneDistances distances(scene, "test");
    for (int i = 0; i < 500; ++i) {
      // Anywhere, or on a surface.
      const auto& one = scene.surfaces<AskedSphere>()[static_cast<std::size_t>(i % 10)].sphere;
      const Point p = i % 2 ? random.point(8) : one.center + one.radius * random.direction();
      double least = infinity;
      const auto add = [&](const auto& surfaces) {
        for (const auto& surface : surfaces) least = std::min(least, surface.distance_bound(p));
      };
      add(scene.surfaces<Plane>()), add(scene.surfaces<AskedSphere>()), add(scene.surfaces<Box>());
      add(scene.surfaces<Marched<decltype(marched_ball)>>());
      AskedSphere::asked = 0;
      wrong.add(distances.distance_bound(p) != least, p, least);
      asked += AskedSphere::asked, all += 10;
    }
  }
  CHECK(wrong == 0);
  CHECK(asked < all / 3);
}

TEST_CASE("the heat map shows the evaluations that single rays take to their closest hit") {
  const AnyScene scene = marched_and_floor();
  const Marched ball{marched_ball, around_both};
  const Marched ring{marched_ring, around_both};
  const MarchEvaluationsIntegrator integrator(scene, 200);
  const std::size_t first = scene.surfaces<AnySurface>().size() - 2;  // the ball; then the ring
  Random random(24);
  WrongCases wrong(random);
  int on_ball = 0, on_ring = 0, on_floor = 0, nowhere = 0;
  for (int i = 0; i < 400; ++i) {
    const Ray ray{{0, 0, 0}, {random.real(-0.5, 0.5), random.real(-0.6, 0.5), 1}};
    const auto hit = scene.intersect(ray, Interval{});
    const double end = hit ? hit->t : infinity;
    const bool is_ball = hit && hit->surface() == &scene.surfaces<AnySurface>()[first];
    const bool is_ring = hit && hit->surface() == &scene.surfaces<AnySurface>()[first + 1];
    MarchCounts counts;
    static_cast<void>(ball.march(ray, {0, is_ball ? infinity : end}, counts));
    static_cast<void>(ring.march(ray, {0, is_ring ? infinity : end}, counts));
    const auto number = integrator.evaluations(ray, scene);
    wrong.add(number != counts.evaluations(), ray, number, counts.evaluations());
    wrong.add(integrator.radiance(ray, scene) != heat_color(static_cast<double>(number) / 200), ray);
    ++(is_ball ? on_ball : is_ring ? on_ring : hit ? on_floor : nowhere);
  }
  CHECK(wrong == 0);
  CAPTURE(on_ball, on_ring, on_floor, nowhere);
  CHECK(std::min({on_ball, on_ring, on_floor, nowhere}) > 20);
}

TEST_CASE("pictures of marches and of distances are equal by tiles, by trees and ray by ray") {
  const AnyScene scene = marched_and_floor();
  const Camera camera;
  const auto check = [&](const auto& integrator) {
    const DrawnAlike drawn = drawn_alike(scene, camera, integrator);
    CHECK(drawn.lit > 100);
    CHECK(drawn.different == 0);
  };
  check(MarchEvaluationsIntegrator(scene));
  check(EnclosureWidthIntegrator(scene));
  check(DistanceOcclusionIntegrator(scene, 1));
  AnyScene lit = scene;
  lit.add(Sphere{.center = {1, 3, 2}, .radius = 0.5}, Material{.emission = Color{20}});
  const DrawnAlike drawn = drawn_alike(lit, camera, DistanceShadowIntegrator(lit));
  CHECK(drawn.lit > 500);
  CHECK(drawn.different == 0);
}

TEST_CASE("a hit on a marched surface is proven to the bits of its enclosure, others to none") {
  const AnyScene scene = marched_and_floor();
  const Marched ball{marched_ball, around_both};
  const EnclosureWidthIntegrator integrator(scene);
  NoTrace trace;
  for (const double x : {0.0, 0.05, 0.1}) {
    const Ray ray{{0, 0, 0}, {x, -0.03, 1}};
    const MarchedRoot root = ball.march(ray, {}, trace);
    const double bits = std::log2(root.max / (root.max - root.min));
    const auto found = integrator.bits(ray, scene);
    REQUIRE(found);
    CHECK(*found <= bits);
    CHECK(*found > bits - 0.09);
    CHECK(*found >= 30);
    CHECK(integrator.radiance(ray, scene) == heat_color((*found - 30) / 23));
  }
  // The march along the other field may end with its crossing behind the closest hit, which does not count.
  const std::size_t first = scene.surfaces<AnySurface>().size() - 2;
  int on_ball = 0, different = 0;
  for (int i = 0; i < 400; ++i) {
    const Ray ray{{0, 0, 0}, {-0.3 + 0.0015 * i, 0.01, 1}};
    const auto hit = scene.intersect(ray, Interval{});
    if (!hit || hit->surface() != &scene.surfaces<AnySurface>()[first]) continue;
    ++on_ball;
    const MarchedRoot root = ball.march(ray, {}, trace);
    const double bits = std::log2(root.max / (root.max - root.min)),
                 found = integrator.bits(ray, scene).value_or(0);
    if (!(found <= bits && found > bits - 0.09)) ++different;
  }
  CHECK(on_ball > 100);
  CHECK(different == 0);
  CHECK(!integrator.bits({{0, 0, 0}, {0.1, -1, 0.3}}, scene));
  CHECK(!integrator.bits({{0, 0, 0}, {0, 1, 0}}, scene));
  CHECK(integrator.radiance({{0, 0, 0}, {0.1, -1, 0.3}}, scene) == Color{0});
}

TEST_CASE("distances of surfaces are lower bounds, and tight where the field is a distance") {
  const Marched ball{marched_ball, around_both};
  // Divided by a Lipschitz constant of 1, which 32 operations round upwards by 4u each, u = 2^-53.
  constexpr double least = 1 - 32 * 4 * 0x1p-53;
  CHECK((least * 0.5 <= ball.distance_bound({0, 0, 2.5}) && ball.distance_bound({0, 0, 2.5}) <= 0.5));
  CHECK((-1 <= ball.distance_bound({0, 0, 4}) && ball.distance_bound({0, 0, 4}) <= -least));
  // Outside of the box, the distance is by way of the nearest point in it.
  CHECK(ball.distance_bound({0, 0, -1}) <= 4);
  CHECK(ball.distance_bound({0, 0, -1}) >= 3);
  CHECK(ball.distance_bound({5, 3, 2}) <= length(Vec3{5, 3, -2}) - 1);
  const Box box{.min = {0, 0, 0}, .max = {2, 4, 6}};
  CHECK(box.distance_bound({3, 5, 3}) == std::sqrt(2));
  CHECK(box.distance_bound({1, 1, 0.5}) == -0.5);
  CHECK(Plane{{0, 2, 0}, 2}.distance_bound({7, 4, 1}) == 3);
  CHECK(Sphere{{1, 0, 0}, 2}.distance_bound({4, 0, 0}) == 1);
  CHECK(Sphere{{1, 0, 0}, -2}.distance_bound({4, 0, 0}) == 1);

  const AnyScene scene = marched_and_floor();
  const SceneDistances distances(scene, "test");
  Random random(7);
  WrongCases wrong(random);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    const Point point{random.real(-2, 2), random.real(-1, 2), random.real(1, 6)};
    const double bound = distances.distance_bound(point);
    const Vec3 direction = normalize(random.point(1));
    if (!(bound > 0)) continue;
    ++found;
    // Bounds are off by 2^-50 of sizes (Sphere::distance_bound), here below 10 for a point and a surface
    // together, and with u = 2^-53 the direction's length by 4.5u (camera.cpp).
    const double sure = bound * (1 - 4.501 * 0x1p-53) - 0x1p-50 * 10;
    wrong.add(scene.occluded({point, direction}, {0, sure}), point, direction, bound);
  }
  CHECK(found > 100);
  CHECK(wrong == 0);

  // Distances can only be had of a scene all of whose surfaces tell one, but for its lights.
  AnyScene others = marched_and_floor();
  others.add(Disk{.position = {0, 0, 9}}, Material{.emission = Color{1}});
  CHECK(SceneDistances(others, "test").distance_bound({0, 0, 4}) == distances.distance_bound({0, 0, 4}));
  others.add(Disk{.position = {0, 0, 9}}, Color{1});
  CHECK_THAT(
      message_of<std::invalid_argument>([&] { SceneDistances(others, "test: "); }),
      ContainsSubstring("test: surface 4 of the scene, counted from 0 in the order of its types, tells"));
}

TEST_CASE("ambient occlusion by distance is right beside an endless wall, to 1/1000, as page 37 says") {
  AnyScene scene;
  scene.add(Plane{{0, 1, 0}, 0}, Color{0.5f});
  scene.add(Plane{{-1, 0, 0}, -1}, Color{0.5f});  // x = 1
  double largest = 0;
  for (int i = 0; i <= 4096; ++i) {
    const double c = i / 4096.0, truth = 1 - (std::acos(c) - c * std::sqrt(1 - c * c)) / std::numbers::pi;
    const double found = DistanceOcclusionIntegrator(scene, 1).free_share({1 - c, 0, 0}, {0, 1, 0});
    largest = std::max(largest, std::abs(found - truth));
  }
  CHECK(largest > 0.001);
  CHECK(largest < 0.00101);
  CHECK_THAT(bytes_of(PROTOSTAR_SOURCE_DIR "/docs/stages/37_marched_shadow.md"),
             ContainsSubstring("most 0.00101 of full light beside any wall"));
  for (const double distance : {0.5, 1.5, 4.0}) {
    const DistanceOcclusionIntegrator integrator(scene, distance);
    for (const double a : {0.01, 0.3, 0.7, 1.3, 2.5}) {
      const double c = std::min(a / distance, 1.0);
      const double truth = 1 - (std::acos(c) - c * std::sqrt(1 - c * c)) / std::numbers::pi;
      CHECK(integrator.radiance({{1 - a, 1, 0}, {0, -1, 0}}, scene).r ==
            Approx(truth).epsilon(0x1p-24).margin(0.00101));
    }
  }
  CHECK(DistanceOcclusionIntegrator(scene, 1).radiance({{0, 1, 0}, {0, 1, 0}}, scene) == Color{1});
}

TEST_CASE("a soft shadow by distance is that of a straight edge, and right in full light and full shadow") {
  AnyScene scene;
  scene.add(Box{.min = {2, -9, -9}, .max = {3, 0, 9}}, Color{0.5f});
  const Sphere lamp{.center = {10, 0, 0}, .radius = 1};
  scene.add(lamp, Material{.emission = Color{1}});
  const DistanceShadowIntegrator integrator(scene);
  for (int i = -30; i <= 30; ++i) {
    // A ray at the height y over the edge: nearest to the cone's border at x = 3 if y > 0, otherwise at x
    // = 2.
    const double y = 0.02 * i, s = y / ((y > 0 ? 3 : 2) * 0.1);
    Sphere level = lamp;
    level.center.y = y;
    const double seen = integrator.seen_share({0, y, 0}, level);
    CAPTURE(y, s, seen);
    // A step changes s by at most (1 + k |s|)/8, k = 1/10, and the share by 2/π of that (seen_share).
    CHECK(std::abs(seen - seen_of_disk(s)) <= (1 + 0.1 * std::abs(s)) / 8 * 2 / std::numbers::pi);
    level.radius = -level.radius;  // turns its normals, and changes nothing else
    CHECK(integrator.seen_share({0, y, 0}, level) == seen);
    if (s >= 1) CHECK(seen == 1);
    if (s < -1.1) CHECK(seen == 0);
  }
}

TEST_CASE("light by distance is that of all spheres which the hit faces, where nothing hides them") {
  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}}, Color{0.5f});
  scene.add(Sphere{.center = {0, -3, 0}, .radius = 1}, Material{.emission = Color{9}});
  scene.add(Sphere{.center = {0, 3, 0}, .radius = 1}, Material{.emission = Color{1, 2, 3}});
  scene.add(Sphere{.center = {0, 8, 0}, .radius = 2}, Material{.emission = Color{16}});
  // A sphere straight above has π (r/d)² of the irradiance of a sky as bright. Floats round at 2^-24 of it:
  // light of two lamps, its products with their colors, the sum, and the product with the surface's color.
  const Color radiance = DistanceShadowIntegrator(scene).radiance({{1, 1, 0}, {-1, -1, 0}}, scene);
  for (int k = 0; k < 3; ++k) {
    const double expected = 0.5 * ((1.0 + k) / 9 + 1);
    CHECK(std::abs(radiance[k] - expected) <= 4 * 0x1p-24 * expected);
  }
}

TEST_CASE("pictures of distances refuse scenes that do not tell them, and other scenes than theirs") {
  AnyScene scene = marched_and_floor();
  const DistanceOcclusionIntegrator integrator(scene, 1);
  CHECK_THROWS_AS(integrator.radiance(Ray{{0, 0, 0}, {0, 0, 1}}, marched_and_floor()), std::logic_error);
  CHECK(message_of<std::invalid_argument>([&] { DistanceOcclusionIntegrator(scene, 0).validate(); }) ==
        "DistanceOcclusionIntegrator: distance must be finite and greater than 0; it is 0");
  CHECK(message_of<std::invalid_argument>([&] { MarchEvaluationsIntegrator(scene, -1).validate(); }) ==
        "MarchEvaluationsIntegrator: most must be greater than 0; it is -1");
  scene.add(Disk{.position = {0, 0, 9}}, Color{1});
  CHECK_THROWS_AS(integrator.radiance(Ray{{0, 0, 0}, {0, 0, 1}}, scene), std::logic_error);
  CHECK(
      message_of<std::invalid_argument>([&] { DistanceShadowIntegrator{scene}; }) ==
      "DistanceShadowIntegrator: surface 3 of the scene, counted from 0 in the order of its types, tells no "
      "distance; marched surfaces, boxes, spheres and planes do, and surfaces with double "
      "distance_bound(const Point&) const");
  CHECK_NOTHROW(MarchEvaluationsIntegrator(scene));
  // Lamps that are no spheres at rest, also such as AreaLights does not know: each would be left out.
  const AnySurface lamps[] = {Disk{.position = {0, 0, 9}}, Moving<Sphere>({{0, 0, 9}, 1}, {1, 0, 0}),
                              Box{.min = {0, 0, 9}, .max = {1, 1, 10}}, Marched{marched_ball, around_both}};
  for (const AnySurface& lamp : lamps) {
    AnyScene lit = marched_and_floor();
    lit.add(lamp, Material{.emission = Color{1}});
    CHECK(message_of<std::invalid_argument>([&] { DistanceShadowIntegrator{lit}; }) ==
          "DistanceShadowIntegrator: surfaces that emit light must be spheres that do not move; another is "
          "in the scene");
  }
}

TEST_CASE("colors of a heat map grow brighter from black to white") {
  CHECK(heat_color(0) == Color{0});
  CHECK(heat_color(std::nan("")) == Color{0});
  CHECK(heat_color(1) == Color{1});
  CHECK(heat_color(7) == Color{1});
  CHECK(heat_color(0.6) == heat_colors[3]);
  double before = -1;
  for (int i = 0; i <= 100; ++i) {
    const Color color = heat_color(i / 100.0);
    const double luminance = 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
    CHECK(luminance > before);
    before = luminance;
  }
}

TEST_CASE("the legend of the heat maps shows their colors for equal parts, as gamma 2.2 encodes them") {
  const std::string legend = bytes_of(PROTOSTAR_SOURCE_DIR "/docs/figures/marching/heat_legend.svg");
  const Encoder encode(Gamma{2.2}, 255);
  std::size_t at = legend.find("<rect x=");
  for (int i = 0; i <= 16; ++i, at = legend.find("<rect x=", at + 1)) {
    REQUIRE(at != std::string::npos);
    const Color color = heat_color(i / 16.0);
    char fill[32];
    std::snprintf(fill, sizeof fill, "fill=\"#%02x%02x%02x\"", static_cast<unsigned>(encode(color.r)),
                  static_cast<unsigned>(encode(color.g)), static_cast<unsigned>(encode(color.b)));
    CHECK_THAT(legend.substr(at, 100), ContainsSubstring(fill));
  }
  CHECK(at == std::string::npos);
}

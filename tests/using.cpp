// Tests of the promises that docs/using.md makes about its programs.
#define main lens_example  // the programs are run as examples
#include "examples/lens.cpp"
#undef main
#define main marched_example
#include "examples/marched.cpp"
#undef main

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "support/drawn_alike.hpp"
#include "support/random.hpp"

namespace {

/// Sign changes of f(t) = F(origin + t · direction) for t > 0, found from values at steps of 0.005, for a
/// unit direction and an origin in the box. is_sure unless some may have been missed: two crossings within a
/// step, or one next to the origin or to the end of the box.
struct Changes {
  std::vector<double> t;
  bool is_sure = true;
};

Changes changes_along(const Waves& waves, const Ray& ray, bool leaves) {
  constexpr double step = 0.005;
  const double bend =
      waves.height * step * step;  // twice the deviation of f from its tangent, since |f''| <= height
  const auto slope_at = [&](double t) { return dot(waves.gradient(ray.at(t)), ray.direction); };
  Changes changes;
  double before = leaves ? slope_at(0) : waves.F(ray.origin);
  changes.is_sure = leaves ? std::abs(before) > waves.height * step : std::abs(before) > 2 * step;
  for (int i = 1;; ++i) {
    const double t = i * step;
    const Point p = ray.at(t);
    const double f = waves.F(p);
    if (std::abs(p.x) > waves.size || std::abs(p.z) > waves.size || std::abs(p.y) > 3 * waves.height) {
      if (std::abs(before) < 4 * step) changes.is_sure = false;
      return changes;
    }
    if (before * f < 0)
      changes.t.push_back(t - step / 2);
    else if (std::abs(f) < bend || std::abs(before) < bend)
      changes.is_sure &= std::abs(slope_at(t)) > waves.height * step;
    before = f;
  }
}

}  // namespace

TEST_CASE(
    "a marched surface is hit where its equation changes sign, and after leaving it at the next change") {
  Scene<Waves> scene;
  scene.add(Waves{}, Color{1});
  const Waves& waves = scene.surfaces<Waves>()[0];
  const auto fast = accelerate(scene);
  Random random(20);
  int crossings[2][3] = {};
  for (int i = 0; i < 4000; ++i) {
    const Ray ray{.origin = Point{random.real(-6, 6), random.real(-0.7, 0.7), random.real(-6, 6)},
                  .direction = normalize(random.direction() * Vec3{1, random.real(0.01, 1), 1})};
    const auto check = [&](const Ray& along, bool leaves) {
      const Changes changes = changes_along(waves, along, leaves);
      if (!changes.is_sure) return;
      std::size_t count = 0;
      scene.crossings(along, Interval{}, [&](const Intersection& crossing) {
        // Within half a step, but for roundings. With u = 2^-53, points within 10 of a t up to 29 are off by
        // u of both: F by 13u, and by 7u in itself; t is the next double or the last, 29u, before or behind.
        // A ray that leaves a point starts with its F. Measured are 8u.
        constexpr double u = 0x1p-53, of_F = 13 + 7, of_t = 29;
        if (count < changes.t.size()) CHECK(std::abs(crossing.t - changes.t[count]) <= 0.0025 + 3 * of_t * u);
        CHECK(std::abs(waves.F(crossing.point())) <= 2 * (of_F + of_t) * u);
        ++count;
      });
      CHECK(count == changes.t.size());
      const auto first = scene.intersect(along), first_of_tree = fast.intersect(along);
      CHECK(first.has_value() == (count > 0));
      CHECK((first ? first->t : 0) == (first_of_tree ? first_of_tree->t : 0));
      crossings[leaves][std::min<std::size_t>(count, 2)] += 1;
    };
    check(ray, false);
    if (const auto hit = scene.intersect(ray))
      check(hit->leave(normalize(random.direction() * Vec3{1, 0.25, 1})), true);
  }
  // Rays without a crossing, with one, and with several.
  for (const auto& row : crossings)
    for (const int rays : row) CHECK(rays > 100);
}

TEST_CASE("a ray that leaves a marched surface does not hit it where it starts, at any angle") {
  Scene<Waves> scene;
  scene.add(Waves{}, Color{1});
  Random random(21);
  int left = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto hit = scene.intersect(
        {.origin = Point{random.real(-9, 9), 2, random.real(-9, 9)}, .direction = {0, -1, 0}});
    REQUIRE(hit);
    // Above a crest and below a trough, the waves bend away from their tangent plane.
    const Point p = hit->point();
    const bool is_crest = std::sin(p.x) > 0.05 && std::sin(p.z) > 0.05,
               is_trough = std::sin(p.x) < -0.05 && std::sin(p.z) < -0.05;
    if (!is_crest && !is_trough) continue;
    const Vec3 n = hit->normal(), along = normalize(cross(n, random.direction()));
    const Vec3 direction = along + std::exp2(random.real(-40, 0)) * (is_crest ? n : -n);
    const auto again = scene.intersect(hit->leave(direction));
    CHECK_FALSE((again && again->t < 0.02));  // up to there, it is above the crest or below the trough
    ++left;
  }
  CHECK(left > 5000);
}

TEST_CASE("points in focus are at one place in all passes of a lens, and tiles draw each pass") {
  Random random(22);
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Material{.diffuse = Color{1}, .reflect = 0.5});
  scene.add(Sphere{.center = {1, 0.5, 3}, .radius = 0.5}, Color{1, 0, 0});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(PointLight{.position = {2, 5, 0}, .power = Color{500}});
  for (int i = 0; i < 20; ++i) {
    const Camera camera = Camera::look_at(random.point(0.5), Point{0, 0, 5} + random.point(1));
    const double distance = random.real(1, 6);
    const Vec3 offset = random.real(-0.3, 0.3) * camera.right + random.real(-0.3, 0.3) * camera.up;
    const Camera pass = through_lens(camera, offset, distance);
    CHECK(pass(0, 0).origin == camera.position + offset);
    for (const double u : {-1.0, 0.0, 0.7})
      for (const double v : {-0.8, 0.1}) {
        const Point in_focus =
            camera.position + distance * (u * camera.right + v * camera.up + camera.forward);
        const Ray ray = pass(u, v);
        const Vec3 way = in_focus - ray.origin;
        // With u = 2^-53, points and directions are sums of up to four terms, of which each is rounded by up
        // to 5u, and twice for the lens; ways and unit vectors are off by 8u of themselves.
        const double terms =
            length(camera.position) + distance * (std::abs(u) * length(camera.right) +
                                                  std::abs(v) * length(camera.up) + length(camera.forward));
        CHECK(length(way - length(way) * ray.direction) <= (13 * terms + 8 * length(way)) * 0x1p-53);
      }
    const DrawnAlike alike = drawn_alike(scene, pass);
    CHECK(alike.different == 0);
    CHECK(alike.lit > 500);
  }
}

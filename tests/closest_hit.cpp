#include <cmath>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include <protostar/accel/render_tiles.hpp>

#include "support/catch.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

/// A ray, and spheres many of which cross it at almost the same t: nested, touching each other, equal, or
/// different in the last digits.
struct Case {
  Ray ray;
  Interval range;
  SceneVector<Sphere> spheres;
};

Case next_case(Random& random) {
  Case c;
  c.ray = {random.point(2), random.point(1)};
  if (random.real(0, 1) < 0.3) c.range.max = random.real(0, 4);
  for (int i = 0; i < 8; ++i) {
    const Sphere last = c.spheres.empty() ? Sphere{{0, 0, 0}, 1} : c.spheres.back();
    const double kind = random.real(0, 1);
    Sphere next{random.point(2), random.real(0.1, 2)};
    if (kind < 0.2) next = last;
    if (kind < 0.4) next.radius = std::nextafter(last.radius, random.real(0, 4)), next.center = last.center;
    if (kind < 0.6) next.center = last.center + (last.radius - next.radius) * normalize(c.ray.direction);
    if (kind > 0.9) next.radius = -next.radius;
    c.spheres.push_back(next);
  }
  if (random.real(0, 1) < 0.3) {  // the ray leaves one of the spheres
    const Sphere& left = c.spheres[2];
    c.ray.origin = left.center + std::abs(left.radius) * normalize(random.point(1));
    c.ray.departure = left.departure();
  }
  if (random.real(0, 1) < 0.3)  // the range ends next to a crossing, or at it
    if (const Roots roots = roots_of(c.spheres[3], c.ray); roots.count() > 0)
      c.range.max = std::nextafter(roots[0], random.real(0, 2 * roots[0]));
  return c;
}

/// Returns the first crossing by comparing all roots of all spheres.
SurfaceCrossing closest_of_all(const Case& c, const Material& material) {
  SurfaceCrossing first;
  for (const Sphere& sphere : c.spheres) {
    const Roots roots = roots_of(sphere, c.ray);
    for (int i = 0; i < roots.count(); ++i) {
      if (!lies_inside(sphere, c.ray, {roots[i], i}, c.range)) continue;
      const SurfaceCrossing crossing = crossing_on(sphere, {roots[i], i}, material);
      if (first.surface == nullptr || precedes(c.ray, crossing, first)) first = crossing;
    }
  }
  return first;
}

}  // namespace

TEST_CASE("the closest hit is the first of all roots inside the range", "[closest_hit]") {
  Random random(7);
  int hits = 0, last = 0, limited = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Case c = next_case(random);
    const SceneVector<Material> materials(c.spheres.size());
    const SurfaceCrossing expected = closest_of_all(c, materials[0]);
    SurfaceCrossing first;
    CHECK(search_closest_hit(c.spheres, materials, c.ray, c.range, first) <= c.range.max);
    REQUIRE(first.surface == expected.surface);
    if (first.surface == nullptr) continue;
    REQUIRE(first.crossing.t == expected.crossing.t);
    REQUIRE(first.crossing.root == expected.crossing.root);
    const auto index = static_cast<const Sphere*>(first.surface) - c.spheres.data();
    REQUIRE(first.material == &materials[static_cast<std::size_t>(index)]);
    ++hits;
    if (index > 0) ++last;
    if (c.range.max < infinity) ++limited;
  }
  CHECK(hits > 5000);
  CHECK(last > 2000);
  CHECK(limited > 500);
}

TEST_CASE("a surface that is tested later replaces the closest hit only if its t is smaller",
          "[closest_hit]") {
  const Ray ray{{0, 0, 0}, {0, 0, 1}};
  const SceneVector<Material> materials(1);
  const SceneVector<Sphere> spheres{Sphere{{0, 0, 3}, 1}};
  const SceneVector<Plane> touching{Plane{{0, 0, 1}, 2}}, before{Plane{{0, 0, 1}, std::nextafter(2, 0)}};
  SurfaceCrossing first;
  Interval range;
  range.max = search_closest_hit(spheres, materials, ray, range, first);
  range.max = search_closest_hit(touching, materials, ray, range, first);
  CHECK(first.surface == spheres.data());
  range.max = search_closest_hit(before, materials, ray, range, first);
  CHECK(first.surface == before.data());
}

TEST_CASE("a ray that leaves a sphere counts as starting on it, however far its origin is rounded",
          "[closest_hit]") {
  const SceneVector<Sphere> spheres{Sphere{{1e17, 0, 0}, 1}};
  const SceneVector<Material> materials(1);
  const Ray along{.origin = {1e17, 0, 0}, .direction = {0, 0, 1}, .departure = spheres[0].departure()};
  SurfaceCrossing first;
  CHECK(search_closest_hit(spheres, materials, along, Interval{}, first) == infinity);
  CHECK(first.surface == nullptr);
}

namespace {

/// Shows how far the exact root of a hit is from 5: the number of the root must be right.
struct RefinedRoot : FirstHit<RefinedRoot> {
  using ShadesEachHit = RefinedRoot;

  [[nodiscard]] Color shade(const Intersection& hit, const auto&) const {
    return Color{static_cast<float>(0x1p25 * (hit.refined() - 5))};
  }
};

}  // namespace

TEST_CASE("the closest hits of a packet know which root of their sphere they are, also after a doubt") {
  const Sphere around{.radius = 9},
      in_front{{0.5, 0, 4}, 0.25};  // rays leave the first, and enter the others
  const Sphere behind{{-0.5, 0, 6}, 0.25}, grazed{{1, 0, 5}, 1 + 0x1p-50};  // grazed by the middle ray alone
  const auto check = [](std::initializer_list<Sphere> spheres, const char* what) {
    CAPTURE(what);
    Scene<Sphere> scene;
    for (const Sphere& sphere : spheres) scene.add(sphere, Color{1});
    const RefinedRoot integrator;
    RenderStatistics statistics;
    Image plain(65, 49), tiled(65, 49);
    render(plain, Camera{}, [&](const Ray& ray) { return integrator.radiance(ray, scene); });
    render(tiled, Camera{}, scene, integrator, {.statistics = &statistics});
    CHECK(different_pixels(plain, tiled) == 0);
    return statistics.in_doubt;
  };
  check({around, in_front}, "a near root after a far one");
  check({in_front, around}, "a far root after a near one");
  CHECK(check({around, around, in_front}, "a far root after a doubt") > 1000);
  CHECK(check({around, grazed}, "a near root after a doubt") > 0);
  CHECK(check({grazed, around, behind}, "a near root after a doubt, before a far one") > 0);
}

#include <cmath>
#include <limits>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

Sphere random_sphere(Random& random) {
  return {.center = random.point(10), .radius = std::exp(random.real(-5, 5))};
}

/// Returns a ray from anywhere, with a direction of any length, towards a point in or near the sphere.
Ray random_ray(Random& random, const Sphere& sphere) {
  const Point origin = random.point(20);
  const Point target = sphere.center + 1.5 * sphere.radius * random.point(1);
  return {origin, std::exp(random.real(-10, 10)) * (target - origin)};
}

}  // namespace

TEST_CASE("the closest hit of a sphere is where the ray enters it") {
  const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
  struct {
    const char* what;
    Ray ray;
    Interval range;
    std::optional<double> expected;
  } const rows[] = {
      {"head-on", {{0, 0, 0}, {0, 0, 1}}, {}, 2},
      {"head-on, t in half units", {{0, 0, 0}, {0, 0, 0.5}}, {}, 4},
      {"head-on, t in thousands", {{0, 0, 0}, {0, 0, 1000}}, {}, 0.002},
      {"off its center", {{0, 0.6, 0}, {0, 0, 1}}, {}, 2.2},
      {"touching", {{0, 1, 0}, {0, 0, 1}}, {}, 3},
      {"passing by", {{0, 1.0000001, 0}, {0, 0, 1}}, {}, std::nullopt},
      {"from its center, where it leaves", {{0, 0, 3}, {0, 1, 0}}, {}, 1},
      {"from inside", {{0, 0, 2.5}, {0, 0, 1}}, {}, 1.5},
      {"behind", {{0, 0, 5}, {0, 0, 1}}, {}, std::nullopt},
      {"behind, in a range that reaches there", {{0, 0, 5}, {0, 0, 1}}, {-10, 0}, -3},
      {"beyond the range", {{0, 0, 0}, {0, 0, 1}}, {0, 1.5}, std::nullopt},
      {"at the end of the range", {{0, 0, 0}, {0, 0, 1}}, {0, 2}, std::nullopt},
      {"the far side, where the range leaves out the near", {{0, 0, 0}, {0, 0, 1}}, {2, infinity}, 4},
      {"neither side, in a range between them", {{0, 0, 0}, {0, 0, 1}}, {2, 4}, std::nullopt},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    const auto t = sphere.intersect(row.ray, row.range);
    CHECK(t.has_value() == row.expected.has_value());
    // All numbers are exact, but for 0.6: with u = 2^-53, D = 9 − 8.36 is off by 20u, its root by 12u, q =
    // 3.8 by 16u, c = 8.36 by 18u, and c/q by 16u.
    const double most = row.ray.origin.y == 0.6 ? 16 * 0x1p-53 : 0;
    if (t && row.expected) CHECK(std::abs(*t - *row.expected) <= most);
  }
}

TEST_CASE("the hit points of a sphere lie on the sphere") {
  Random random(3);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 50000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Ray ray = random_ray(random, sphere);
    for (const double t : roots_of(sphere, ray)) {
      ++hits;
      // t has a relative error of 2^-30. With u = 2^-53, the point is rounded by u of the way and u of
      // itself, its distance from the center by 4.5u of the radius.
      const double way = std::abs(t) * length(ray.direction);
      const double certain =
          Roots::relative_error * way + (way + length(ray.at(t)) + 4.5 * sphere.radius) * 0x1p-53;
      wrong.add(!(std::abs(length(ray.at(t) - sphere.center) - sphere.radius) <= certain), sphere, ray, t,
                certain);
    }
  }
  CHECK(hits > 50000);
  CHECK(wrong == 0);
}

TEST_CASE("hits of a sphere agree with arithmetic of more digits") {
  Random random(4);
  int hits = 0, misses = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 50000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Ray ray = random_ray(random, sphere);
    // The quadratic equation in its usual form: a t² + b t + c = 0.
    using Real = long double;
    const Real o[] = {Real{ray.origin.x} - sphere.center.x, Real{ray.origin.y} - sphere.center.y,
                      Real{ray.origin.z} - sphere.center.z};
    const Real d[] = {ray.direction.x, ray.direction.y, ray.direction.z};
    const Real a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const Real b = 2 * (o[0] * d[0] + o[1] * d[1] + o[2] * d[2]);
    const Real c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - Real{sphere.radius} * sphere.radius;
    const Real discriminant = b * b - 4 * a * c;
    if (std::abs(discriminant) < 0x1p-30L * b * b) continue;  // too close to tangent for this reference
    Real t = -1;
    if (discriminant > 0) {
      t = (-b - std::sqrt(discriminant)) / (2 * a);
      if (!(t > 0)) t = (-b + std::sqrt(discriminant)) / (2 * a);
    }
    const auto found = sphere.intersect(ray);
    wrong.add(found.has_value() != (t > 0), sphere, ray);
    // With v = 2^-64, the reference is off by 8v of b² in D, and so by 2^15 · 4v of b in the root.
    wrong.add(found && !(std::abs(*found - t) <= Roots::relative_error * t + 0x1p-47L * std::abs(b) / a),
              sphere, ray);
    ++(found ? hits : misses);
  }
  CHECK(hits > 10000);
  CHECK(misses > 10000);
  CHECK(wrong == 0);
}

TEST_CASE("a tangent ray crosses a sphere twice at one t") {
  CHECK(list(roots_of(Sphere{.center = {0, 0, 3}, .radius = 1}, {{0, 1, 0}, {0, 0, 1}})) ==
        std::vector<double>{3, 3});
  CHECK(list(roots_of(Sphere{.center = {0, 0, 0}, .radius = 2}, {{2, -1, 0}, {0, 4, 0}})) ==
        std::vector<double>{0.25, 0.25});
  CHECK(list(roots_of(Sphere{.center = {0, 0, 3}, .radius = 1}, {{0, 1, 3}, {0, 0, 1}})) ==
        std::vector<double>{0, 0});
}

TEST_CASE("the normal of a sphere is a unit vector, outwards; a negative radius turns it inwards only") {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Sphere inverse{.center = sphere.center, .radius = -sphere.radius};
    const Ray ray = random_ray(random, sphere);
    REQUIRE(list(roots_of(sphere, ray)) == list(roots_of(inverse, ray)));
    for (const double t : roots_of(sphere, ray)) {
      const Point point = ray.at(t);
      // Bound for the length from the docstring of normal_at.
      const double T = std::abs(t) * length(ray.direction), P = length(point);
      const double bound = (0x1p-30 * T + 0x1p-53 * (T + P)) / sphere.radius + 0x1p-51;
      const Vec3 normal = sphere.normal_at(point);
      REQUIRE(std::abs(length(normal) - 1) <= bound);
      REQUIRE(dot(sphere.normal_at(point), point - sphere.center) > 0);
      REQUIRE(inverse.normal_at(point) == -sphere.normal_at(point));
    }
  }
}

TEST_CASE(
    "a ray that leaves a sphere outwards never hits it again, and one that leaves it inwards does once") {
  Random random(6);
  int outwards = 0, inwards = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 50000; ++i) {
    const Sphere sphere = random_sphere(random);
    const Ray ray = random_ray(random, sphere);
    const auto t = sphere.intersect(ray);
    if (!t) continue;
    const Point point = ray.at(*t);
    // Every second direction is nearly tangent.
    Vec3 direction = random.direction();
    if (i % 2 == 0) {
      const Vec3 n = sphere.normal_at(point);
      direction += (std::pow(10.0, random.real(-15, -3)) - dot(n, direction)) * n;
      if (i % 4 == 0) direction -= 2 * dot(n, direction) * n;
    }
    const Ray left{point, std::exp(random.real(-10, 10)) * direction, sphere.departure()};
    int crossings = 0;
    each_crossing(sphere, left, {}, [&](const Crossing&) { ++crossings; });
    const bool is_inwards = dot(left.direction, sphere.center - point) > 0;
    ++(is_inwards ? inwards : outwards);
    wrong.add(crossings != (is_inwards ? 1 : 0), sphere, ray, left);
    wrong.add(first_crossing(sphere, left, {}).has_value() != is_inwards, sphere, ray, left);
    if (is_inwards) {
      const Point other = left.at(first_crossing(sphere, left, {})->t);
      // The point is as far from the sphere as 2^-30 of the way to it, the other one as 2^-30 of the chord
      // more; and both as they are rounded.
      const double way = length(point - ray.origin), radius = sphere.radius;
      const double certain =
          Roots::relative_error * (way + 2 * radius) + (way + 2 * length(point) + 8 * radius) * 0x1p-53;
      wrong.add(!(std::abs(length(other - sphere.center) - radius) <= certain), sphere, ray, left, other);
    }
  }
  CHECK(outwards > 5000);
  CHECK(inwards > 5000);
  CHECK(wrong == 0);
}

TEST_CASE("a ray that leaves a sphere hits another one like any other ray") {
  const Sphere left{.center = {0, 0, 0}, .radius = 1}, other{.center = {0, 0, 0}, .radius = 2};
  CHECK(other.intersect({{1, 0, 0}, {1, 0, 0}, left.departure()}) == 1.0);
  CHECK(other.intersect({{1, 0, 0}, {-1, 0, 0}, left.departure()}) == 3.0);
}

TEST_CASE("a ray without direction, or with a number that is not finite, crosses no sphere") {
  const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
  std::vector<Ray> rays{{{0, 0, 0}, {0, 0, 0}}, {{0, 0, 3}, {0, 0, 0}}, {{0, 0, 2}, {0, 0, 0}}};
  for (const double bad : {infinity, -infinity, not_a_number})
    for (int axis = 0; axis < 3; ++axis) {
      Ray ray{{0, 0, 0}, {0, 0, 1}};
      ray.origin[axis] = bad;
      rays.push_back(ray);
      ray = {{0, 0, 0}, {0, 0, 1}};
      ray.direction[axis] = bad;
      rays.push_back(ray);
      rays.push_back({Point{bad}, Vec3{bad}});
      rays.push_back({{0, 0, 3}, Vec3{bad}});
    }
  for (Ray ray : rays) {
    CHECK_FALSE(sphere.intersect(ray));
    CHECK_FALSE(sphere.intersect(ray, {-infinity, infinity}));
    ray.departure = sphere.departure();
    CHECK_FALSE(sphere.intersect(ray));
    CHECK_FALSE(sphere.intersect(ray, {-infinity, infinity}));
  }
}

TEST_CASE("the length of a ray's direction changes t, and not the surface that is hit") {
  const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
  for (const double size : {1e-140, 1e-60, 1e-9, 1.0, 1e9, 1e60, 1e140}) {
    CAPTURE(size);
    const auto t = sphere.intersect({{0, 0.6, 0}, {0, 0, size}});
    REQUIRE(t);
    // With u = 2^-53, D = 0.64 of squares of 3 is off by 63u, its root by 39u, q = 3.8 by 46u, c = 8.36 by
    // 18u; c/q by 34u, and its product by 2u.
    CHECK(std::abs(*t * size - 2.2) <= 36 * 0x1p-53);
    CHECK_FALSE(sphere.intersect({{0, 1.1, 0}, {0, 0, size}}));
  }
}

TEST_CASE("an invalid sphere is refused with the field's name") {
  for (const double bad : {0.0, -0.0, 0x1p-401, -0x1p-401, 1e121, -1e121, infinity, -infinity, not_a_number})
    CHECK_THAT(message_of<std::invalid_argument>([&] { Sphere{.radius = bad}.validate(); }),
               ContainsSubstring("Sphere: radius"));
  for (const double bad : {1e121, -1e121, infinity, -infinity, not_a_number})
    CHECK_THAT(message_of<std::invalid_argument>([&] {
                 Sphere{.center = {0, bad, 0}}.validate();
               }),
               ContainsSubstring("Sphere: center"));
  CHECK_NOTHROW(Sphere{.radius = -2}.validate());
  CHECK_NOTHROW(Sphere{.center = Point{0x1p400}, .radius = 0x1p-400}.validate());
  CHECK_NOTHROW(Sphere{.radius = -0x1p400}.validate());
}

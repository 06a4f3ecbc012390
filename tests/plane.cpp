#include <cmath>
#include <limits>
#include <protostar/surfaces/plane.hpp>
#include <stdexcept>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {}

TEST_CASE("a plane is the points x with normal · x = distance") {
  const Plane ground{.normal = {0, 1, 0}, .distance = -1};
  struct {
    const char* what;
    Plane plane;
    Ray ray;
    Interval range;
    std::optional<double> expected;
  } const rows[] = {
      {"down to the ground", ground, {{0, 0, 0}, {0, -1, 0}}, {}, 1},
      {"down to the ground, t in halves", ground, {{0, 0, 0}, {0, -0.5, 0}}, {}, 2},
      {"from below", ground, {{5, -3, 2}, {1, 1, 1}}, {}, 2},
      {"away from it", ground, {{0, 0, 0}, {0, 1, 0}}, {}, std::nullopt},
      {"away from it, in a range that reaches back", ground, {{0, 0, 0}, {0, 1, 0}}, {-2, 0}, -1},
      {"beyond the range", ground, {{0, 0, 0}, {0, -1, 0}}, {0, 0.5}, std::nullopt},
      {"at the end of the range", ground, {{0, 0, 0}, {0, -1, 0}}, {0, 1}, std::nullopt},
      {"parallel", ground, {{0, 0, 0}, {1, 0, 1}}, {-infinity, infinity}, std::nullopt},
      {"in it", ground, {{0, -1, 0}, {1, 0, 1}}, {-infinity, infinity}, std::nullopt},
      {"a normal of any length", {{0, 0, -4}, -12}, {{0, 0, 1}, {0, 0, 1}}, {}, 2},
      {"oblique", {{1, 2, 2}, 9}, {{0, 0, 0}, {1, 2, 2}}, {}, 1},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK(row.plane.intersect(row.ray, row.range) == row.expected);
  }
}

TEST_CASE("the hit points of a plane lie on the plane") {
  Random random(7);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Plane plane{.normal = std::exp(random.real(-20, 20)) * random.direction(),
                      .distance = random.real(-10, 10)};
    const Ray ray{random.point(10), std::exp(random.real(-10, 10)) * random.direction()};
    const auto t = plane.intersect(ray);
    if (!t) continue;
    ++hits;
    const Point p = ray.at(*t);
    const double error = std::abs(dot(plane.normal, p) - plane.distance);
    // With u = 2^-53, products with the normal are off by 3u of theirs, and their sums by u, in the height of
    // the origin, in the slope times t, and here; t by 2u and the point by u: at most 10u of each.
    const double sizes = length(plane.normal) * (length(p) + length(ray.origin)) + std::abs(plane.distance);
    wrong.add(!(error <= 10 * 0x1p-53 * sizes), plane, ray, p, error);
  }
  CHECK(hits > 5000);
  CHECK(wrong == 0);
}

TEST_CASE("the normal of a plane is a unit vector, whatever the length it was given with") {
  for (const double size : {1e-140, 1e-9, 1.0, 1e9, 1e140}) {
    const Vec3 n = Plane{.normal = size * Vec3{2, -3, 6}}.normal_at({1, 2, 3});
    // With u = 2^-53, the products with the size are off by u, normalize by 4.5u (camera.cpp), the quotient
    // by u.
    CHECK(length(n - Vec3{2, -3, 6} / 7.0) <= 6.501 * 0x1p-53);
  }
}

TEST_CASE("a ray that leaves a plane never hits it again") {
  Random random(8);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Plane plane{.normal = random.direction(), .distance = random.real(-10, 10)};
    const Ray ray{random.point(10), random.direction()};
    const auto hit = plane.intersect(ray);
    if (!hit) continue;
    ++hits;
    const Ray left{ray.at(*hit), random.direction(), plane.departure()};
    wrong.add(plane.intersect(left, {-infinity, infinity}).has_value(), plane, ray, left);
  }
  CHECK(hits > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("a segment crosses a plane if it ends behind it, however near, and leads to it") {
  // The end is at 1 + k 2^-40 of the way to the plane, which double decides from 2^-28 of the way on.
  const double side = GENERATE(-1.0, 1.0), normal = GENERATE(-3.0, 3.0);
  const Plane plane{.normal = {0, normal, 0}, .distance = normal * side * 0.75};
  for (const double k :
       {-0x1p38, -0x1p13, -0x1p12, -0x1p11, -1.0, 0.0, 1.0, 0x1p11, 0x1p12, 0x1p13, 0x1p38}) {
    const Ray ray{.origin = {0, 0, 0}, .direction = {0.5, side * 0.75 * (1 + k * 0x1p-40), 0}};
    Ray away = ray;
    away.direction.y = -away.direction.y;
    INFO(k);
    CHECK(any_hit(plane, ray, {0, 1}) == (k > 0));
    CHECK_FALSE(any_hit(plane, away, {0, 1}));
    const auto known = crossed_by_each(plane, ray, true, true);
    CHECK(known.in_doubt == (std::abs(k) < 0x1p12));
    if (!known.in_doubt) CHECK(known.crossed == (k > 0));
  }
}

TEST_CASE("a plane has the same departure as every multiple of its equation, and as no other plane") {
  const Plane plane{.normal = {1, -2, 3}, .distance = 5};
  const Ray left{{5, 0, 0}, {1, 1, 1}, plane.departure()};
  for (const double factor : {1.0, -1.0, 2.0, -0.5, 3.0, -7.0, 1e3, 0x1p-900}) {
    const Plane multiple{.normal = factor * plane.normal, .distance = factor * plane.distance};
    CAPTURE(factor);
    CHECK(multiple.departure() == plane.departure());
    CHECK_FALSE(multiple.intersect(left, {-infinity, infinity}));
  }
  const Plane through_origin{.normal = {0, 1, 0}, .distance = 0},
      reversed{.normal = {0, -1, 0}, .distance = 0};
  CHECK(through_origin.departure() == reversed.departure());

  const Plane parallel{.normal = {1, -2, 3}, .distance = 6};
  CHECK(parallel.departure() != plane.departure());
  CHECK(parallel.intersect(left) == 0.5);
  const Plane mirrored{.normal = {1, -2, 3}, .distance = -5};
  CHECK(mirrored.departure() != plane.departure());

  // Numbers that are more than 2^1022 apart.
  const auto departure = [](double x, double y, double distance) {
    return Plane{.normal = {x, y, 0}, .distance = distance}.departure();
  };
  CHECK(departure(0x1p1000, 0x3p-80, 0) == departure(-0x1p900, -0x3p-180, 0));
  CHECK(departure(0x1p1000, 0x3p-80, 0) != departure(0x1p1000, 0x5p-80, 0));
  CHECK(departure(0x1p1000, 1, 0x3p-80) != departure(0x1p1000, 1, 0x5p-80));
  CHECK(departure(0x1p1000, 1, 0x3p-80) != departure(0x1p1000, 1, 0));
}

TEST_CASE("the distance of a point from a plane does not depend on the length of the normal") {
  for (const double size : {0x1p-1070, 1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    const Plane plane{.normal = size * Vec3{0, -3, 4}, .distance = 10 * size};
    CAPTURE(size);
    // With u = 2^-53, numbers of the plane are off by u, products by 2u, and sums by u: in units of the size,
    // 20 and 10 by 80u, and 6, 4 and 10 by 60u. That over the length 5, and the length's own 4.5u of 2 and 4.
    CHECK(std::abs(plane.distance_bound({7, 0, 5}) - 2) <= (80 / 5.0 + 4.501 * 2) * 0x1p-53);
    CHECK(std::abs(plane.distance_bound({7, 2, -1}) + 4) <= (60 / 5.0 + 4.501 * 4) * 0x1p-53);
  }
}

TEST_CASE("a ray without direction, or with a number that is not finite, crosses no plane") {
  const Plane plane{.normal = {0, 0, 1}, .distance = 3};
  CHECK_FALSE(plane.intersect({{0, 0, 0}, {0, 0, 0}}, {-infinity, infinity}));
  CHECK_FALSE(plane.intersect({{0, 0, 3}, {0, 0, 0}}, {-infinity, infinity}));
  for (const double bad : {infinity, -infinity, not_a_number})
    for (int axis = 0; axis < 3; ++axis) {
      Ray origin{{0, 0, 0}, {0, 0, 1}}, direction = origin;
      origin.origin[axis] = bad;
      direction.direction[axis] = bad;
      CAPTURE(bad, axis);
      CHECK_FALSE(plane.intersect(origin));
      CHECK_FALSE(plane.intersect(origin, {-infinity, infinity}));
      CHECK_FALSE(plane.intersect(direction));
    }
}

TEST_CASE("an invalid plane is refused with the field's name") {
  for (const Vec3& bad : {Vec3{0}, Vec3{0, not_a_number, 0}, Vec3{0, infinity, 0}, Vec3{-infinity, 1, 0}})
    CHECK_THAT(message_of<std::invalid_argument>([&] { Plane{.normal = bad}.validate(); }),
               ContainsSubstring("Plane: normal"));
  for (const double bad : {1e121, -1e121, infinity, -infinity, not_a_number})
    CHECK_THAT(message_of<std::invalid_argument>([&] { Plane{.distance = bad}.validate(); }),
               ContainsSubstring("Plane: distance"));
  CHECK_NOTHROW(Plane{.normal = {0, -5, 0}, .distance = -3}.validate());
  CHECK_NOTHROW(Plane{.normal = {0, 1e200, 0}, .distance = 1e300}.validate());
  CHECK_THROWS_AS((Plane{.normal = {0, 1e-100, 0}, .distance = 1e30}.validate()), std::invalid_argument);
}

#include <protostar/intersection.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "support/catch.hpp"

using namespace protostar;

namespace {
Scene<Sphere, Plane> ball_on_scaled_ground() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1, 0.5f, 0.25f});
  scene.add(Plane{.normal = {0, 2, 0}, .distance = -2}, Color{0, 1, 0});
  return scene;
}
}  // namespace

TEST_CASE("an intersection has the point, normal and color of the hit") {
  const auto scene = ball_on_scaled_ground();
  const auto ball = scene.intersect({{0, 0, 0}, {0, 0, 2}});
  REQUIRE(ball);
  CHECK(ball->t == 1);
  CHECK(ball->point() == Point{0, 0, 2});
  CHECK(ball->normal() == Vec3{0, 0, -1});
  CHECK(ball->color() == Color{1, 0.5f, 0.25f});

  const auto ground = scene.intersect({{5, 2, 7}, {0, -1, 0}});
  REQUIRE(ground);
  CHECK(ground->t == 3);
  CHECK(ground->point() == Point{5, -1, 7});
  CHECK(ground->normal() == Vec3{0, 1, 0});
  CHECK(ground->color() == Color{0, 1, 0});
}

TEST_CASE("the normal is the surface's own, the facing normal points to the side from which the ray comes") {
  const auto scene = ball_on_scaled_ground();
  const auto inside = scene.intersect({{0, 0, 3}, {0, 0, 1}});
  REQUIRE(inside);
  CHECK(inside->normal() == Vec3{0, 0, 1});
  CHECK(inside->facing_normal() == Vec3{0, 0, -1});
  const auto outside = scene.intersect({{0, 0, 6}, {0, 0, -1}});
  REQUIRE(outside);
  CHECK(outside->normal() == Vec3{0, 0, 1});
  CHECK(outside->facing_normal() == Vec3{0, 0, 1});
  const auto below = scene.intersect({{0, -9, 0}, {0, 1, 0}});
  REQUIRE(below);
  CHECK(below->normal() == Vec3{0, 1, 0});
  CHECK(below->facing_normal() == Vec3{0, -1, 0});
}

TEST_CASE("a ray that leaves an intersection starts at its point and has the departure of its surface") {
  const auto scene = ball_on_scaled_ground();
  const auto ball = scene.intersect({{0, 0, 0}, {0, 0, 1}});
  REQUIRE(ball);
  const Ray through = ball->leave({0, 0, 0.25});
  CHECK(through.origin == Point{0, 0, 2});
  CHECK(through.direction == Vec3{0, 0, 0.25});
  CHECK(through.departure == Sphere{.center = {0, 0, 3}, .radius = 1}.departure());
  const auto far_side = scene.intersect(through);
  REQUIRE(far_side);
  CHECK(far_side->t == 8);
  CHECK_FALSE(scene.intersect(ball->leave({0, 0, -1})));
  CHECK_FALSE(scene.intersect(ball->leave({1, 0, 0})));
  const auto ground = scene.intersect(ball->leave({0, -1, 0}));
  REQUIRE(ground);
  CHECK(ground->color() == Color{0, 1, 0});
  CHECK(ground->t == 1);
}

TEST_CASE("a ray that is made where it is kept is the one that leaves the intersection") {
  const auto scene = ball_on_scaled_ground();
  for (const Vec3& direction : {Vec3{0, 0, 1}, Vec3{0, -1, 0.25}}) {
    const auto hit = scene.intersect({.origin = {0, 0, 0}, .direction = direction, .time = 0.75});
    REQUIRE(hit);
    const Ray expected = hit->leave({0.5, 0, -2});
    Ray kept{
        .origin = {7, 7, 7},
        .direction = {7, 7, 7},
        .departure = {.kind = Departure::Kind::object, .primitive = 7, .object = &scene, .surface = &scene},
        .is_reversed = true,
        .time = 7};
    hit->leave({0.5, 0, -2}, kept);
    CHECK(kept.origin == expected.origin);
    CHECK(kept.direction == expected.direction);
    CHECK(kept.departure == expected.departure);
    CHECK(kept.departure.surface == expected.departure.surface);
    CHECK(kept.transform == nullptr);
    CHECK_FALSE(kept.is_reversed);
    CHECK(kept.time == 0.75);
  }
}

TEST_CASE("crossings at the ray's origin have no order") {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {-2, 1, -2}, .radius = 3}, Color{1});
  scene.add(Plane{.normal = {0, 2, 1}, .distance = 0}, Color{1});
  std::vector<Intersection> at_origin;
  scene.crossings({Point{0}, {1, 0, 1}}, {-infinity, infinity}, [&](const Intersection& crossing) {
    if (crossing.t == 0) at_origin.push_back(crossing);
  });
  REQUIRE(at_origin.size() == 2);
  for (const Intersection& a : at_origin)
    for (const Intersection& b : at_origin) CHECK_FALSE(a < b);
}

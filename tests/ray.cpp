#include <protostar/ray.hpp>

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE("a ray is the points origin + t · direction") {
  const Ray ray{{1, 2, 3}, {0, 0, 2}};
  CHECK(ray.at(0) == Point{1, 2, 3});
  CHECK(ray.at(1.5) == Point{1, 2, 6});
  CHECK(ray.at(-1) == Point{1, 2, 1});
}

TEST_CASE("the default ray starts at the coordinate origin, along z, in free space") {
  const Ray ray;
  CHECK(ray.origin == Point{0, 0, 0});
  CHECK(ray.direction == Vec3{0, 0, 1});
  CHECK(ray.departure == Departure{});
  CHECK(ray.departure.kind == Departure::Kind::none);
}

TEST_CASE("departures are equal if kind, object and geometry are") {
  const int object = 0;
  const Departure sphere{.kind = Departure::Kind::sphere, .geometry = {1, 2, 3, 4}};
  CHECK(sphere == Departure{.kind = Departure::Kind::sphere, .geometry = {1, 2, 3, 4}});
  CHECK(sphere != Departure{.kind = Departure::Kind::plane, .geometry = {1, 2, 3, 4}});
  CHECK(sphere != Departure{.kind = Departure::Kind::sphere, .geometry = {1, 2, 3, 5}});
  CHECK(Departure{.kind = Departure::Kind::object, .object = &object} !=
        Departure{.kind = Departure::Kind::object});
}

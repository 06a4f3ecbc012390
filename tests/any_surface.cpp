#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/cylinder.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

static_assert(std::is_convertible_v<Sphere, AnySurface> && std::is_convertible_v<Cylinder, AnySurface>);
static_assert(!std::is_convertible_v<int, AnySurface>);
static_assert(std::is_nothrow_move_constructible_v<AnySurface> &&
              std::is_nothrow_move_assignable_v<AnySurface>);

namespace {

struct CountsCopies {
  int* copies;
  explicit CountsCopies(int* c) : copies(c) {}
  CountsCopies(const CountsCopies& other) : copies(other.copies) { ++*copies; }
  CountsCopies(CountsCopies&&) = default;
  std::optional<double> intersect(const Ray&, Interval) const { return {}; }
  Vec3 normal_at(Point) const { return {}; }
};
}  // namespace

TEST_CASE("AnySurface answers as the surface that it holds") {
  const Sphere sphere{.center = {0, 0, 3}, .radius = -2};
  const AnySurface any = sphere;
  CHECK(any.intersect(ray_along_z) == sphere.intersect(ray_along_z));
  CHECK(any.intersect(ray_along_z, {.min = 1}) == 5.0);
  CHECK_FALSE(any.intersect(ray_along_z, {.min = 1, .max = 5}));
  CHECK(any.normal_at({0, 0, 1}) == Vec3{0, 0, 1});
  CHECK(any.departure() == sphere.departure());
  std::vector<double> list;
  any.each_crossing(ray_along_z, {}, [&](const Crossing& crossing) { list.push_back(crossing.t); });
  CHECK(list == std::vector<double>{1, 5});
  list.clear();
  any.each_crossing({{0, 2, 0}, {0, 0, 1}}, {},
                    [&](const Crossing& crossing) { list.push_back(crossing.t); });
  CHECK(list == std::vector<double>{3, 3});  // tangent: a double root
}

TEST_CASE("AnySurface is a value: a copy has a copy of the surface, and a move copies nothing") {
  int copies = 0;
  const AnySurface original{CountsCopies(&copies)};
  CHECK(copies == 0);
  AnySurface copy = original;
  CHECK(copies == 1);
  AnySurface moved = std::move(copy);
  CHECK(copies == 1);

  copy = Sphere{.center = {0, 0, 3}};  // a value that was moved from may be assigned to
  CHECK(copy.intersect(ray_along_z) == 2.0);
  moved = copy;
  copy = Plane{.normal = {0, 0, 1}, .distance = 7};
  CHECK(moved.intersect(ray_along_z) == 2.0);
  CHECK(copy.intersect(ray_along_z) == 7.0);
  const AnySurface& itself = copy;
  copy = itself;
  CHECK(copy.intersect(ray_along_z) == 7.0);
}

TEST_CASE(
    "the departure of a user-defined surface differs in a copy of its AnySurface, and is kept by a move") {
  AnySurface any = Cylinder{};
  const Departure departure = any.departure();
  const AnySurface copy = any;
  CHECK(copy.departure() != departure);
  const AnySurface moved = std::move(any);
  CHECK(moved.departure() == departure);
}

TEST_CASE("AnySurface validates the surface that it holds") {
  CHECK_THAT(message_of<std::invalid_argument>([] { AnySurface{Sphere{.radius = 0}}.validate(); }),
             ContainsSubstring("Sphere: radius"));
  CHECK_NOTHROW(AnySurface{Sphere{}}.validate());
  CHECK_NOTHROW(AnySurface{Cylinder{}}.validate());
}

TEST_CASE("a scene of AnySurface gives the same answers as a scene of spheres and planes") {
  Random random(10);
  Scene<Sphere, Plane> typed;
  Scene<AnySurface> any;
  const auto add = [&](const auto& surface) {
    const Color color = random.color();
    typed.add(surface, color);
    any.add(surface, color);
  };
  for (int i = 0; i < 20; ++i) add(Sphere{.center = random.point(5), .radius = random.real(-2, 2)});
  add(Sphere{.center = {0, -1000, 0}, .radius = 999});
  for (int i = 0; i < 4; ++i) add(Plane{.normal = random.direction(), .distance = random.real(-8, 8)});

  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    Ray ray{random.point(6), std::exp(random.real(-3, 3)) * random.direction()};
    for (int depth = 0; depth < 2; ++depth) {
      const auto a = typed.intersect(ray), b = any.intersect(ray);
      wrong.add(a.has_value() != b.has_value() || typed.occluded(ray) != a.has_value() ||
                    any.occluded(ray) != a.has_value(),
                ray);
      std::vector<std::pair<double, float>> list, other;
      typed.crossings(ray, {}, [&](const Intersection& hit) { list.emplace_back(hit.t, hit.color().r); });
      any.crossings(ray, {}, [&](const Intersection& hit) { other.emplace_back(hit.t, hit.color().r); });
      wrong.add(list != other, ray);
      if (!a || !b) break;
      ++hits;
      wrong.add(
          a->t != b->t || a->point() != b->point() || a->normal() != b->normal() || a->color() != b->color(),
          ray);
      const Vec3 on = random.direction();
      const Ray left = a->leave(on), other_left = b->leave(on);
      wrong.add(left.departure != other_left.departure || left.origin != other_left.origin, ray, left);
      ray = left;
    }
  }
  CHECK(hits > 10000);
  CHECK(wrong == 0);
}

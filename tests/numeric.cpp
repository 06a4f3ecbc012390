#include <algorithm>
#include <cmath>
#include <limits>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/numeric/exact_number.hpp>
#include <protostar/render.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "stress/exact.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/random.hpp"

using namespace protostar;
using exact::Number;

namespace {

constexpr double smallest_double = std::numeric_limits<double>::denorm_min();
constexpr double largest_double = std::numeric_limits<double>::max();

/// Returns a random number in (−1, 1) times a random power of two from 2^-60 to 2^59.
double any_number(Random& random) {
  const double mantissa = random.real(-1, 1);
  return std::ldexp(mantissa, static_cast<int>(random.bits() % 120) - 60);
}

/// Returns a random double-double.
DoubleDouble any_pair(Random& random) {
  const double high = any_number(random);
  return fast_two_sum(high, std::ldexp(high * random.real(-1, 1), -53));
}

Number value(DoubleDouble x) { return Number(x.hi) + Number(x.lo); }
Number size_of(const Number& x) { return x.sign() < 0 ? -x : x; }

/// Returns true if |a − b| ≤ |bound|.
bool within(const Number& a, const Number& b, const Number& bound) {
  return (size_of(a - b) - size_of(bound)).sign() <= 0;
}

constexpr double u2 = 0x1p-106;  // u²

const Sphere unit_sphere{.center = {0, 0, 3}, .radius = 1};

}  // namespace

// ---- Touching

TEST_CASE("a tangent ray hits a sphere, and a ray that misses it by 2^-105 does not") {
  const Vec3 ahead{0, 0, 1};
  CHECK(list(roots_of(unit_sphere, {{1, 0, 0}, ahead})) == std::vector<double>{3, 3});
  CHECK(list(roots_of(unit_sphere, {{0, -1, 0}, ahead})) == std::vector<double>{3, 3});
  CHECK(list(roots_of(unit_sphere, {{1, 0x1p-52, 0}, ahead})).empty());
  CHECK(list(roots_of(unit_sphere, {{1, 0x1p-200, 0}, ahead})).empty());
  CHECK(list(roots_of(unit_sphere, {{std::nextafter(1, 2), 0, 0}, ahead})).empty());
  CHECK(roots_of(unit_sphere, {{std::nextafter(1, 0), 0, 0}, ahead}).count() == 2);
}

TEST_CASE("tangent rays are recognized at every scale and for directions of every length") {
  for (const int length : {-700, -300, 0, 300, 700})
    for (const int direction : {-700, -300, 0, 300, 700}) {
      CAPTURE(length, direction);
      if (std::abs(length - direction) > 1000) continue;
      const double unit = std::ldexp(1, length);
      const Vec3 d{0, 0, std::ldexp(1, direction)};
      const Sphere sphere{unit * unit_sphere.center, unit};
      CHECK(list(roots_of(sphere, {{unit, 0, 0}, d})) ==
            std::vector<double>(2, std::ldexp(3, length - direction)));
      CHECK(list(roots_of(sphere, {{unit, 0x1p-52 * unit, 0}, d})).empty());
    }
}

// ---- Order, and the ends of a range

TEST_CASE("the outer of two spheres that touch from inside is hit first, however small the gap is") {
  const Sphere inner = unit_sphere, outer{.center = {0, 0, 3 + 0x1p-50}, .radius = 1 + 0x1p-50};
  // At a distance of x from the axis the gap is about 2^-51 x².
  for (const double x : {0x1p-2, 0x1p-10, 0x1p-20, 0x1p-26, 0x1p-40}) {
    CAPTURE(x);
    Scene<Sphere> scene;
    scene.add(inner, Color{0});
    scene.add(outer, Color{1});
    const auto first = scene.intersect(Ray{{x, 0, 0}, {0, 0, 1}});
    REQUIRE(first);
    CHECK(first->color() == Color{1});
  }
}

TEST_CASE("the closest hit of several at equal t is that of the earlier surface") {
  Scene<Sphere, Plane> scene;
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 2}, Color{2});
  scene.add(unit_sphere, Color{0});
  scene.add(Sphere{.center = {0, 0, 4}, .radius = 2}, Color{1});
  const auto first = scene.intersect(Ray{{0, 0, 0}, {0, 0, 1}});
  REQUIRE(first);
  CHECK(first->color() == Color{0});
}

TEST_CASE("a surface through a light does not hide it, and one 2^-107 in front of it does") {
  const Sphere sphere{.center = {0, 0, 0}, .radius = 1};
  const Interval segment{.min = 0.75, .max = 1};  // the near root is 1/2
  CHECK_FALSE(sphere.intersect(Ray{{-3, 0, 0}, {4, 0, 0}}, segment));
  CHECK(sphere.intersect(Ray{{-3, 0x1p-52, 0}, {4, 0, 0}}, segment));
  CHECK(sphere.intersect(Ray{{-3, 0x1p-20, 0}, {4, 0, 0}}, segment));
  CHECK_FALSE(sphere.intersect(Ray{{-3, 0, 0}, {4, 0, 0}}, {.min = 1}));

  const Plane plane{.normal = {1, 1, 0}, .distance = 3};
  CHECK_FALSE(plane.intersect(Ray{{0, 0, 0}, {1, 2, 5}}, Interval{0, 1}));
  CHECK(plane.intersect(Ray{{0, 0, 0}, {1, std::nextafter(2, 3), 5}}, Interval{0, 1}));
  CHECK_FALSE(plane.intersect(Ray{{0, 0, 0}, {1, std::nextafter(2, 1), 5}}, Interval{0, 1}));
}

TEST_CASE("planes that differ in the last place of one number are told apart") {
  const Plane plane{.normal = {0, 3, 0}, .distance = 1.75};
  int apart = 0;
  for (double distance = plane.distance; apart < 8; ++apart) {
    const double next = std::nextafter(distance, 2);
    const Plane before{plane.normal, distance}, behind{plane.normal, next};
    CAPTURE(distance);
    Scene<Plane> scene;
    scene.add(behind, Color{1});
    scene.add(before, Color{0});
    const auto first = scene.intersect(Ray{{0, -1, 0}, {0, 1, 0}});
    REQUIRE(first);
    CHECK(first->color() == Color{0});
    CHECK(roots_of(behind, {{0, distance / 3, 0}, {0, 1, 0}, before.departure()}).count() == 1);
    distance = next;
  }
}

TEST_CASE("a ray that leaves a plane does not hit it or a multiple of its equation, but hits other planes") {
  for (const double size : {1e-300, 1e-200, 1.0, 1e200, 1e300}) {
    CAPTURE(size);
    const Plane plane{.normal = {0, size, 3 * size}, .distance = size};
    const Plane multiple{.normal = -4.0 * plane.normal, .distance = -4 * plane.distance};
    const Plane other{.normal = plane.normal, .distance = 2 * size};
    const Ray leaving{{0, 1, 0}, {1, 1, 1}, plane.departure()};
    CHECK(roots_of(plane, leaving).count() == 0);
    CHECK(roots_of(multiple, leaving).count() == 0);
    CHECK(roots_of(other, leaving).count() == 1);
  }
}

TEST_CASE("crossings at equal t are ordered by surface and then by root, also for tangent rays") {
  Scene<Sphere> scene;
  for (const int id : {0, 1}) scene.add(unit_sphere, Color{static_cast<float>(id)});
  std::vector<Intersection> crossings;
  scene.crossings(Ray{{1, 0, 0}, {0, 0, 1}}, {}, [&](const Intersection& hit) { crossings.push_back(hit); });
  std::stable_sort(crossings.begin(), crossings.end());
  std::vector<float> order;
  for (const Intersection& hit : crossings) order.push_back(hit.color().r);
  CHECK(order == std::vector<float>{0, 0, 1, 1});
}

// ---- Every input has a defined answer

TEST_CASE("a ray with a number that is not finite, or with no direction, crosses nothing") {
  const Ray good{{0, 0, 0}, {0, 0, 1}};
  const Plane plane{.normal = {0, 0, 1}, .distance = 3};
  std::vector<Ray> bad{{good.origin, Vec3{0}}, {good.origin, Vec3{-0.0}}};
  for (const double x : {not_a_number, infinity, -infinity})
    for (int axis = 0; axis < 3; ++axis) {
      bad.insert(bad.end(), 2, good);
      bad[bad.size() - 1].origin[axis] = x;
      bad[bad.size() - 2].direction[axis] = x;
    }
  REQUIRE(roots_of(unit_sphere, good).count() == 2);
  REQUIRE(roots_of(plane, good).count() == 1);
  for (Ray ray : bad) {
    CAPTURE(ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z);
    CHECK(roots_of(unit_sphere, ray).count() == 0);
    CHECK(roots_of(plane, ray).count() == 0);
    ray.departure = unit_sphere.departure();
    CHECK_FALSE(unit_sphere.intersect(ray));
  }
}

TEST_CASE("spheres of huge, tiny, distant and denormal numbers are crossed like any other") {
  const Vec3 ahead{0, 0, 1};
  struct Row {
    const char* what;
    Ray ray;
    Sphere sphere;
    std::vector<double> t;
  };
  const Row rows[] = {
      {"squares overflow", {{0, 0, -3e200}, ahead}, {Point{0}, 1e200}, {3e200 - 1e200, 3e200 + 1e200}},
      {"squares underflow", {{0, 0, -3e-200}, ahead}, {Point{0}, 1e-200}, {3e-200 - 1e-200, 3e-200 + 1e-200}},
      {"the largest_double",
       {{0, 0, 0}, ahead},
       {Point{0}, largest_double},
       {-largest_double, largest_double}},
      {"center − origin overflows",
       {{0, 0, -largest_double}, {0, 0, 4}},
       {{0, 0, largest_double}, largest_double},
       {largest_double / 4, 3 * (largest_double / 4)}},
      {"the smallest_double",
       {{0, 0, -3 * smallest_double}, ahead},
       {Point{0}, smallest_double},
       {2 * smallest_double, 4 * smallest_double}},
      {"a small sphere far away", {{0, 0, -1e60}, ahead}, {Point{0}, 1e-60}, {1e60, 1e60}},
      {"a small sphere far away, beside the ray", {{1e-59, 0, -1e60}, ahead}, {Point{0}, 1e-60}, {}},
      {"A r² overflows", {{0, 0, 0}, {0, 0, 0x1p50}}, {Point{0}, 0x1p468}, {-0x1p418, 0x1p418}},
      {"a long direction", {{0, 0, 0}, {0, 0, 0x1p1000}}, unit_sphere, {0x1p-999, 0x1p-998}},
      {"a short direction", {{0, 0, 0}, {0, 0, 0x1p-1000}}, unit_sphere, {0x1p1001, 0x1p1002}},
      {"a denormal direction",
       {{0, 0, 0}, {0, 0, 0x1p-1022 / 4}},
       {{0, 0, 3 * 0x1p-100}, 0x1p-100},
       {0x1p925, 0x1p926}},
  };
  for (const Row& row : rows) {
    CAPTURE(row.what);
    const std::vector<double> t = list(roots_of(row.sphere, row.ray));
    REQUIRE(t.size() == row.t.size());
    for (std::size_t i = 0; i < t.size(); ++i)
      CHECK(std::abs(t[i] - row.t[i]) <= 0x1p-30 * std::abs(row.t[i]));
  }
  // A root too large for a double lies in no range.
  CHECK_FALSE(Sphere{{0, 0, 3e200}, 1e200}.intersect({{0, 0, 0}, {0, 0, 1e-200}}));
}

TEST_CASE("a plane is crossed at every scale") {
  struct Row {
    Ray ray;
    Plane plane;
    double t;
  };
  const Row rows[] = {
      {{{0, 0, 0}, {0, 1e-100, 0}}, {{0, 1e100, 0}, 1e-300}, 1e-300},
      {{{0, 0, 0}, {0, 1e-290, 0}}, {{0, 1e290, 0}, 1e-300}, 1e-300},
      {{{0, -1e-300, 0}, {0, 1e-290, 0}}, {{0, 1e290, 0}, 0}, 1e-10},
      {{{0, -1e300, 0}, {0, 1e300, 0}}, {{0, 1e-300, 0}, 1}, 2},
      {{{0, 1e308, 0}, {0, -1e308, 0}}, {{0, 1e308, 0}, 0}, 1},
  };
  for (const Row& row : rows) {
    CAPTURE(row.t);
    const Roots roots = roots_of(row.plane, row.ray);
    REQUIRE(roots.count() == 1);
    CHECK(std::abs(roots[0] - row.t) <= 0x1p-30 * row.t);
  }
  CHECK(roots_of(Plane{{1, 1, 0}, 0}, {{0, 0, 0}, {1, -1, 5}}).count() == 0);            // parallel
  CHECK(roots_of(Plane{{1, 1, 0}, 0}, {{0, 0, 0}, {1, -1 + 0x1p-53, 5}}).count() == 1);  // nearly parallel
  CHECK(list(roots_of(Plane{{1, 1, 0}, 0}, {{3, -3, 0}, {1, 2, 5}})) ==
        std::vector<double>{0});  // starts on it
}

// ---- Refinement, and how often it is needed

TEST_CASE("a refined t is accurate to one unit in the last place") {
  Scene<Sphere> scene;
  scene.add(unit_sphere, Color{1});
  // With x = 1 − 2^-40, √(1 − x²) = 2^-20 √(2 − 2^-40).
  const auto hit = scene.intersect(Ray{{1 - 0x1p-40, 0, 0}, {0, 0, 1}});
  REQUIRE(hit);
  const double truth = static_cast<double>(3 - std::sqrt(2 - 0x1p-40L) * 0x1p-20L);
  CHECK(std::abs(hit->refined() - truth) <= std::nextafter(truth, 4) - truth);
}

TEST_CASE("the fallback counters count decisions that double leaves in doubt") {
  struct Row {
    const char* what;
    double x;
    std::uint64_t exact;
  };
  const Row rows[] = {{"through the sphere", 0.3, 0},
                      {"past it", 1.5, 0},
                      {"hardly into it", 1 - 0x1p-47, 1},
                      {"touching it", 1, 1}};
  for (const Row& row : rows) {
    CAPTURE(row.what);
    fallbacks = {};
    (void)roots_of(unit_sphere, {{row.x, 0, 0}, {0, 0, 1}});
    CHECK(fallbacks.exact == row.exact);
  }
}

// ---- Arithmetic

TEST_CASE("the error-free transforms have no rounding error") {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const double a = any_number(random), b = any_number(random);
    REQUIRE((value(two_sum(a, b)) - Number(a) - Number(b)).sign() == 0);
    REQUIRE((value(two_product(a, b)) - Number(a) * Number(b)).sign() == 0);
    const bool in_order = std::abs(a) >= std::abs(b);
    REQUIRE((value(in_order ? fast_two_sum(a, b) : fast_two_sum(b, a)) - Number(a) - Number(b)).sign() == 0);
    REQUIRE(two_sum(a, b).hi == a + b);
    REQUIRE(two_product(a, b).hi == a * b);
  }
}

TEST_CASE("double-double operations keep their error bounds: sum 3u², product 5u², quotient 10u², root 4u²") {
  Random random(2);
  const double slack = 1 + 0x1p-48;  // allows for terms in u³
  for (int i = 0; i < 100000; ++i) {
    const DoubleDouble a = any_pair(random), near_a = {-a.hi, a.lo * random.real(-1, 1)};
    const DoubleDouble b = i % 2 == 0 ? any_pair(random) : fast_two_sum(near_a.hi, near_a.lo);
    const Number A = value(a), B = value(b);
    REQUIRE(within(value(a + b), A + B, Number(3 * slack * u2) * (A + B)));
    REQUIRE(within(value(a * b), A * B, Number(5 * slack * u2) * A * B));
    REQUIRE(within(value(a / b) * B, A, Number(10 * slack * u2) * A));
    const DoubleDouble root = sqrt(abs(a));
    // |s − √a| ≤ 4u² √a is equivalent to |s² − a| ≤ 8u² a, up to a term in u⁴.
    REQUIRE(within(value(root) * value(root), size_of(A), Number(8 * slack * u2) * A));
  }
}

TEST_CASE("ExactNumber is exact at any size, and converts to double-double within 2^-103") {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double a = any_number(random), b = any_number(random), c = any_number(random),
                 d = any_number(random);
    // ab − cd, and the equal b (a + c) − c (b + d), in which terms cancel.
    const ExactNumber x = ExactNumber(a) * ExactNumber(b) - ExactNumber(c) * ExactNumber(d);
    const ExactNumber y = ExactNumber(b) * (ExactNumber(a) + ExactNumber(c)) -
                          ExactNumber(c) * (ExactNumber(b) + ExactNumber(d));
    const Number truth = Number(a) * Number(b) - Number(c) * Number(d);
    REQUIRE(x.sign() == truth.sign());
    REQUIRE((x - y).sign() == 0);
    REQUIRE((x - y + ExactNumber(0x1p-300)).sign() == 1);
    REQUIRE(within(value(DoubleDouble(x)), truth, Number(0x1p-103) * truth));
    const ExactNumber square = x * y;
    REQUIRE(within(value(DoubleDouble(square)), truth * truth, Number(0x1p-103) * truth * truth));
  }
  CHECK(ExactNumber(0).sign() == 0);
  CHECK((ExactNumber(1) - ExactNumber(1)).sign() == 0);
  CHECK((ExactNumber(1) + ExactNumber(0x1p-200) - ExactNumber(1)).sign() == 1);
  ExactNumber small(3);
  for (int i = 0; i < 20; ++i) small = small * ExactNumber(0x1p-1000);
  CHECK(small.sign() == 1);
  CHECK((ExactNumber(1) + small - ExactNumber(1)) == small);
  for (int i = 0; i < 20; ++i) small = small * ExactNumber(0x1p1000);
  CHECK(small == ExactNumber(3));
  const ExactNumber huge(0x1.fffffffffffffp1023), denormal(0x1p-1074);
  CHECK((huge * huge + denormal * denormal - huge * huge) == denormal * denormal);
}

TEST_CASE("pictures of glass and of shadows never need exact arithmetic") {
  const auto scene = three_spheres();
  Image image(320, 240);
  fallbacks = {};
  render(image, Camera{}, scene, TransparencyIntegrator{}, {.threads = 1});
  render(image, Camera{}, scene, ShadowIntegrator{}, {.threads = 1});
  CHECK(fallbacks.exact == 0);
}

#include <cmath>
#include <protostar/accel/packet.hpp>
#include <protostar/scene.hpp>
#include <protostar/surface.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/cylinder.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {
/// Horizontal sheets at the heights 0, 1, ..., count − 1, which provide all their crossings.
struct Sheets {
  int count = 3;
  std::optional<double> intersect(const Ray& ray, Interval range) const {
    std::optional<double> first;
    crossings(ray, range, [&](double t) {
      if (!first) first = t;
    });
    return first;
  }
  Vec3 normal_at(Point) const { return {0, 1, 0}; }
  void crossings(const Ray& ray, Interval range, auto&& visit) const {
    for (int i = 0; i < count; ++i) {
      const double t = ((ray.direction.y > 0 ? i : count - 1 - i) - ray.origin.y) / ray.direction.y;
      if (range.contains(t)) visit(t);
    }
  }
};

struct NoNormal {
  std::optional<double> intersect(const Ray&, Interval) const { return {}; }
};
struct ChangesWhenAsked {
  std::optional<double> intersect(const Ray&, Interval) { return {}; }
  Vec3 normal_at(Point) const { return {}; }
};
struct PlainNumber {  // a bare double cannot express a miss
  double intersect(const Ray&, Interval) const { return -1; }
  Vec3 normal_at(Point) const { return {}; }
};

/// The cone x² + y² = z², which offers its equation and no roots. A is a difference, which may cancel.
struct EquationOfCone {
  QuadricForm form{.squares = {1, 1, -1}, .constant = 0};

  std::optional<double> intersect(const Ray& ray, Interval range) const { return first_t(*this, ray, range); }
  Vec3 normal_at(const Point& point) const { return unit_along(form.times(point)); }
  auto equation(const auto& line) const { return quadric_equation(line, form); }
  bool is_left_by(const Ray& ray) const { return ray.departure.is_from(this); }
  Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }
};

static_assert(Surface<Cylinder> && Surface<Sheets> && Surface<Sphere> && Surface<Plane> &&
              Surface<AnySurface>);
static_assert(!Surface<NoNormal> && !Surface<ChangesWhenAsked> && !Surface<PlainNumber> && !Surface<int>);
static_assert(!knows_departure<Cylinder> && !SurfaceWithRoots<Cylinder> && !CompositeSurface<Cylinder> &&
              !SurfaceWithEquation<Cylinder>);
static_assert(SurfaceWithEquation<EquationOfCone> && !SurfaceWithRoots<EquationOfCone>);
static_assert(CompositeSurface<AnySurface> && SurfaceWithEquation<Sphere> && SurfaceWithEquation<Plane>);

}  // namespace

TEST_CASE("a surface that has only intersect is crossed near to far, once at each crossing") {
  const Cylinder cylinder{.radius = 2};
  CHECK(crossings_of(cylinder, {{-5, 0, 0}, {1, 0, 0}}) == std::vector<double>{3, 7});
  CHECK(crossings_of(cylinder, {{-5, 0, 0}, {1, 0, 0}}, {.max = 5}) == std::vector<double>{3});
  CHECK(crossings_of(cylinder, {{-5, 0, 0}, {1, 0, 0}}, {.min = 3}) == std::vector<double>{7});
  CHECK(crossings_of(cylinder, {{0, 0, 0}, {0, 0, 4}}) == std::vector<double>{0.5});
  CHECK(crossings_of(cylinder, {{0, 0, 0}, {0, 1, 0}}).empty());
}

TEST_CASE("a surface of more than two crossings may provide them itself") {
  CHECK(crossings_of(Sheets{}, {{0, -1, 0}, {0, 1, 0}}) == std::vector<double>{1, 2, 3});
  CHECK(crossings_of(Sheets{}, {{0, 3, 0}, {0, -1, 0}}, {.max = 3}) == std::vector<double>{1, 2});
  CHECK(crossings_of(AnySurface{Sheets{}}, {{0, -1, 0}, {0, 1, 0}}) == std::vector<double>{1, 2, 3});
}

TEST_CASE("a surface without a departure function is recognized by its address") {
  const Cylinder cylinder, twin;
  CHECK(departure_of(cylinder).kind == Departure::Kind::object);
  CHECK(departure_of(cylinder) == departure_of(cylinder));
  CHECK(departure_of(cylinder) != departure_of(twin));
  const Sphere sphere;
  CHECK(departure_of(sphere) == sphere.departure());
}

TEST_CASE("beyond_departure cuts off the departure's root if it is computed ahead, and nothing otherwise") {
  const Cylinder cylinder;
  const auto range_beyond = [&](double offset, double direction) {
    return beyond_departure(cylinder, {{1 + offset, 0, 0}, {direction, 0, 0}, departure_of(cylinder)}, {});
  };
  CHECK(range_beyond(0, 1).min == 0);
  CHECK(range_beyond(0, -1).min == 0);
  CHECK(range_beyond(0x1p-50, 1).min == 0);    // outwards, from slightly outside
  CHECK(range_beyond(-0x1p-50, -1).min == 0);  // inwards, from slightly inside
  for (const double inwards : {-1.0, 1.0}) {   // the root 0 is computed ahead
    const double min = range_beyond(-inwards * 0x1p-50, inwards).min;
    CHECK(min > 0);
    CHECK(min < 0x1p-48);
  }
  // The range keeps its own min if that is larger.
  CHECK(beyond_departure(cylinder, {{1 + 0x1p-50, 0, 0}, {-1, 0, 0}}, {.min = 0.5, .max = 3}).min == 0.5);
  CHECK(beyond_departure(cylinder, {{1 + 0x1p-50, 0, 0}, {-1, 0, 0}}, {.min = 0.5, .max = 3}).max == 3);
}

TEST_CASE("a user-defined surface that is left outwards is not hit again, and inwards once more") {
  Random random(9);
  int outwards = 0, inwards = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 50000; ++i) {
    const Cylinder cylinder{.radius = std::exp(random.real(-4, 4))};
    const Ray ray{random.point(20), random.direction()};
    const auto t = cylinder.intersect(ray, {});
    if (!t) continue;
    const Ray left{ray.at(*t), random.direction(), departure_of(cylinder)};
    const double slope = dot(left.direction, cylinder.normal_at(left.origin));
    if (std::abs(slope) < 1e-4) continue;  // nearly tangent: beyond_departure guarantees nothing
    ++(slope < 0 ? inwards : outwards);
    const std::size_t expected = slope < 0 ? 1 : 0;
    wrong.add(crossings_of(cylinder, left).size() != expected, cylinder, ray, left);
    wrong.add(first_crossing(cylinder, left, {}).has_value() != (expected == 1), cylinder, ray, left);
    // AnySurface recognizes the copy that it holds.
    const AnySurface any = cylinder;
    const Ray left_any{left.origin, left.direction, departure_of(any)};
    wrong.add(crossings_of(any, left_any) != crossings_of(cylinder, left), cylinder, ray, left, left_any);
  }
  CHECK(outwards > 1000);
  CHECK(inwards > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("a ray that departs from another surface hits a user-defined surface like any other ray") {
  const Cylinder cylinder, twin;
  CHECK(first_crossing(cylinder, {{0, 0, 0}, {1, 0, 0}, departure_of(twin)}, {})->t == 1.0);
  CHECK(first_crossing(cylinder, {{0, 0, 0}, {1, 0, 0}, Sphere{}.departure()}, {})->t == 1.0);
}

TEST_CASE("a segment that ends next to a user-defined surface with an equation crosses it exactly or not") {
  const EquationOfCone cone;
  const Quadric same{cone.form};
  Scene<EquationOfCone> scene;
  scene.add(cone, Color{1});
  Random random(11);
  WrongCases wrong(random);
  int crossed = 0;
  constexpr int lanes = simd::double_lanes, count = 4000;
  for (int i = 0; i < count; ++i) {
    const Point origin = random.point(std::ldexp(1, -static_cast<int>(random.bits() % 20)));
    const double angle = random.real(-3.2, 3.2), z = random.real(0.5, 1.5);
    const Point end{z * std::cos(angle), z * std::sin(angle), z};
    const Ray ray{.origin = origin, .direction = end - origin};
    const bool expected = first_crossing(same, ray, {0, 1}).has_value();
    crossed += expected;
    wrong.add(any_hit(cone, ray, {0, 1}) != expected || scene.occluded(ray, {0, 1}) != expected, ray);
    wrong.add(any_hit(cone, ray, {}) != first_crossing(same, ray, {}).has_value(), ray);

    const auto e = cone.equation(ray);
    const RoundedQuadratic<simd::Doubles, simd::Doubles> in_lanes{e.A, e.b, e.c, e.w, e.D, e.E};
    const auto one = crossed_by_each(e, true, true);
    const auto all = crossed_by_each(in_lanes, simd::LaneMask(true), true);
    wrong.add(!one.in_doubt && one.crossed != expected, ray);
    for (int lane = 0; lane < lanes; ++lane)
      wrong.add((simd::bits(all.in_doubt) >> lane & 1) != one.in_doubt ||
                    (simd::bits(all.crossed) >> lane & 1) != one.crossed,
                ray, lane);
  }
  CHECK(wrong == 0);
  CHECK(crossed > count / 2);
  CHECK(count - crossed > count / 8);

  // Away from the end of the segment, double decides.
  const auto e = cone.equation(Ray{.origin = {0, 0, 3}, .direction = {2, 0.5, 0.25}});
  CHECK_FALSE(crossed_by_each(e, true, true).in_doubt);
}

TEST_CASE("a user-defined surface that asks a sphere has the sphere's crossings, wherever its range begins") {
  struct Ball {
    Sphere sphere;
    std::optional<double> intersect(const Ray& ray, Interval range) const {
      return sphere.intersect(ray, range);
    }
    Vec3 normal_at(Point point) const { return sphere.normal_at(point); }
  };
  Random random(31);
  WrongCases other_crossings(random), missed_walls(random);
  for (int i = 0; i < 2000; ++i) {
    const Ball ball{{.center = {0, 0, 3}, .radius = 1}};
    const Point at = ball.sphere.center + random.point(0.5);
    const Ray ray{.origin = random.point(1), .direction = at - random.point(1)};
    std::vector<double> own, of_sphere;
    each_crossing(ball, ray, Interval{}, [&](const Crossing& crossing) { own.push_back(crossing.t); });
    each_crossing(ball.sphere, ray, Interval{},
                  [&](const Crossing& crossing) { of_sphere.push_back(crossing.t); });
    other_crossings.add(own != of_sphere, ray.origin, ray.direction);
    if (of_sphere.size() != 2) continue;
    const Ray inwards{
        .origin = ray.at(of_sphere[0]), .direction = ray.direction, .departure = departure_of(ball)};
    missed_walls.add(!first_t(ball, inwards, Interval{}), ray.origin, ray.direction);
  }
  CHECK(other_crossings == 0);
  CHECK(missed_walls == 0);
}

TEST_CASE("a user-defined surface that answers with the beginning of its range has no hit there") {
  struct Stuck {
    std::optional<double> intersect(const Ray&, Interval range) const { return range.min; }
    Vec3 normal_at(Point) const { return {0, 0, 1}; }
  };
  for (const double begin : {0.0, 1.0, 1e300})
    CHECK_FALSE(first_t(Stuck{}, Ray{{0, 0, 0}, {0, 0, 1}}, {begin, infinity}));
}

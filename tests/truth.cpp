#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>

#include <cmath>
#include <vector>

#include "stress/truth.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using exact::Number;

namespace {

/// Number as a ball and as an exact number.
struct Both {
  exact::Ball ball;
  Number exact;
};
Both operator+(const Both& a, const Both& b) { return {a.ball + b.ball, a.exact + b.exact}; }
Both operator-(const Both& a, const Both& b) { return {a.ball - b.ball, a.exact - b.exact}; }
Both operator*(const Both& a, const Both& b) { return {a.ball * b.ball, a.exact * b.exact}; }
Both both(double x) { return {x, x}; }

/// Returns a random number in (−1, 1) times a random power of two from 2^-60 to 2^59.
Both any_both(Random& random) {
  const double mantissa = random.real(-1, 1);
  return both(std::ldexp(mantissa, static_cast<int>(random.bits() % 120) - 60));
}

/// Returns a number that has lost its last digits, with an error up to its bound.
Both uncertain(Random& random) {
  const Both large = both(std::ldexp(1, static_cast<int>(random.bits() % 110))), small = any_both(random);
  return large + small * any_both(random) - large;
}

}  // namespace

TEST_CASE("numbers of 128 digits keep their error bound, or are reported as unknown") {
  Random random(1);
  int known = 0, unknown = 0;
  WrongCases wrong(random);
  const auto look = [&](const Both& x) {
    if (!x.ball.is_known()) {
      ++unknown;
      return;
    }
    ++known;
    wrong.add(!x.ball.may_be(x.exact) || x.ball.sign() != x.exact.sign(), static_cast<long double>(x.ball));
    const exact::Quad truth(x.exact), off = static_cast<long double>(x.ball) - truth;
    wrong.add((off < 0 ? -off : off) > exact::Quad(0x1p-62) * (truth < 0 ? -truth : truth),
              static_cast<long double>(x.ball));
  };
  for (int i = 0; i < 20000; ++i) {
    const Both a = any_both(random), b = any_both(random), c = any_both(random), d = any_both(random);
    look(a);
    look(a + b);
    look(a * b - c * d);
    const Both square = (a + b) * (a + b);
    look(square - a * a - both(2) * a * b - b * b);  // 0
    look((a * a + b * b) * (c * c + d * d) - (a * c + b * d) * (a * c + b * d));
    const Both x = uncertain(random), y = uncertain(random);
    look(x);
    look(x * d);
    look(x * y);
    look(x * a + y * b);
    look(x * x - y);
  }
  CHECK(wrong == 0);
  CHECK(known > 100000);
  CHECK(unknown > 5000);
}

TEST_CASE("a number of 128 digits is unknown if none of them is certain, and 0 is known") {
  const exact::Ball one = 1.0, tiny = 0x1p-200, small = 0x1p-100;
  CHECK((one + small - one).is_known());
  CHECK((one + small - one).may_be(0x1p-100));
  CHECK_FALSE((one + small - one).may_be(0x1p-101));
  CHECK_FALSE((one + tiny - one).is_known());
  CHECK_FALSE((tiny * (one + tiny - one) + one - one).is_known());
  CHECK((one - one).is_known());
  CHECK((one - one).sign() == 0);
  CHECK((exact::Ball(0.0) * (one + tiny - one)).sign() == 0);
  CHECK((-one).sign() == -1);
  CHECK(exact::Ball(0x1p-1074).may_be(0x1p-1074));
  CHECK(exact::Ball(-0x1.fffffffffffffp+1023).may_be(-0x1.fffffffffffffp+1023));
}

TEST_CASE("exact numbers decide cases that 128 digits leave in doubt") {
  // The ray misses the sphere by about 2^-200, or hits it by as much.
  const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
  for (const double off : {-0x1p-200, 0x1p-200}) {
    const Ray ray{.origin = {1, off, 0}, .direction = {off, 0, 1}};
    CHECK_FALSE(exact::first_level(ray, sphere, false));
    CHECK(exact::truth_of(ray, sphere, false).count == (off < 0 ? 2 : 0));
  }
  // The origin is 2^-200 in front of the plane.
  const Plane plane{.normal = {1, 1, 0}, .distance = 1};
  const Ray ray{.origin = {1, 0x1p-200, 0}, .direction = {0, -1, 0}};
  CHECK_FALSE(exact::first_level(ray, plane, false));
  CHECK(exact::truth_of(ray, plane, false).root[0].t == 0x1p-200L);
  // The ray misses the parallelogram at an edge by about 2^-200, or hits it by as much.
  const Parallelogram parallelogram{.position = {0, 0, 3}, .edge_u = {1, 0, 0}, .edge_v = {0, 1, 0}};
  for (const double off : {-0x1p-200, 0x1p-200})
    for (const Ray& to_edge : {Ray{{1, 0.5, 0}, {off, 0, 1}}, Ray{{0.5, 1, 0}, {0, off, 1}}}) {
      CHECK_FALSE(exact::first_level(to_edge, parallelogram, false));
      CHECK(exact::truth_of(to_edge, parallelogram, false).count == (off < 0 ? 1 : 0));
    }
  // The ray misses the triangle at an edge by about 2^-200, or hits it by as much.
  const Triangle triangle{{0, 0, 3}, {1, 0, 3}, {0, 1, 3}};
  for (const double off : {-0x1p-200, 0x1p-200}) {
    const Ray to_edge{{0.5, -2.5, 0}, {off, 1, 1}};
    CHECK_FALSE(exact::first_level(to_edge, triangle, false));
    CHECK(exact::truth_of(to_edge, triangle, false).count == (off < 0 ? 1 : 0));
  }
}

namespace {

/// Returns the true roots of a ray; checks that the first level agrees with them where it decides.
std::vector<double> true_roots(const Ray& ray, const auto& surface, bool leaves = false) {
  CHECK(exact::wrong_in_first_level(ray, surface, leaves) == nullptr);
  std::vector<double> roots;
  for (const auto& root : exact::second_level(ray, surface, leaves))
    roots.push_back(static_cast<double>(root.t));
  return roots;
}

}  // namespace

TEST_CASE("the true roots of an instance are those of the transformed surface") {
  using Roots = std::vector<double>;
  const Affine stretched = Affine{}.scaled_by({1, 1, 2}).moved_by({0, 0, 5});
  const Ray along_z{{0, 0, 0}, {0, 0, 1}};
  CHECK(true_roots(along_z, Placed(Sphere{}, stretched)) == Roots{3, 7});
  CHECK(true_roots({{1, 0, 0}, {0, 0, 1}}, Placed(Sphere{}, stretched)) == Roots{5, 5});
  CHECK(true_roots({{1 + 0x1p-52, 0, 0}, {0, 0, 1}}, Placed(Sphere{}, stretched)).empty());
  CHECK(true_roots({{0, 0, 3}, {0, 0, 2}}, Placed(Sphere{}, stretched), true) == Roots{2});
  CHECK(true_roots(along_z, Placed(Plane{{0, 0, 1}, 1}, stretched)) == Roots{7});
  const Affine sheared{{1, 0, 0}, {0, 1, 0}, {1, 0, -1}, {0, 0, 5}};
  CHECK(true_roots({{1, 0, 0}, {0, 0, 1}}, Placed(Plane{{1, 0, 0}, 0}, sheared)) == Roots{4});
}

TEST_CASE("the true roots of a triangle at its outline are those for an infinitesimally moved origin") {
  using Roots = std::vector<double>;
  const Triangle right{{0, 0, 3}, {1, 0, 3}, {0, 1, 3}}, turned{right.a, right.c, right.b};
  for (const Triangle& s : {right, turned}) {
    CHECK(true_roots({{0.25, 0.25, 0}, {0, 0, 2}}, s) == Roots{1.5});
    CHECK(true_roots({{0.25, 0.25, 0}, {0, 0, -2}}, s) == Roots{-1.5});
    CHECK(true_roots({{0, 0.5, 0}, {0, 0, 1}}, s) == Roots{3});  // on the edge x = 0
    CHECK(true_roots({{0.5, 0, 0}, {0, 0, 1}}, s) == Roots{3});  // on the edge y = 0
    CHECK(true_roots({{0, 0, 0}, {0, 0, 1}}, s) == Roots{3});    // on both edges
    CHECK(true_roots({{0.5, 0.5, 0}, {0, 0, 1}}, s).empty());
    CHECK(true_roots({{1, 0, 0}, {0, 0, 1}}, s).empty());
    CHECK(true_roots({{0, 1, 0}, {0, 0, 1}}, s).empty());
    CHECK(true_roots({{-1, 0.5, 3}, {1, 0, 0}}, s).empty());  // in its plane
    CHECK(true_roots({{0.25, 0.25, 3}, {0, 0, 1}}, s, true).empty());
  }
  CHECK(true_roots({{0.25, 0.25, 0}, {0, 0, 1}}, Triangle{right.a, right.b, right.b}).empty());
}

TEST_CASE("the true roots of a CSG tree are where its inside ends, and not at shared faces") {
  using Roots = std::vector<double>;
  using Operation = Csg::Operation;
  const auto with = [](Operation operation, const SolidTree::Solid& a, const SolidTree::Solid& b) {
    return Made({.operation = operation, .operands = {{.solid = a}, {.solid = b}}});
  };
  const Box left{{0, -1, -1}, {2, 1, 1}}, right{{2, -1, -1}, {3, 1, 1}}, part{{1, -1, -1}, {2, 1, 1}};
  const Quadric below{{.squares = Vec3{0}, .linear = {0.5, 0, 0}, .constant = -1}};  // x < 1
  const Ray along_x{{-1, 0, 0}, {1, 0, 0}};
  CHECK(true_roots(along_x, with(Operation::either, left, right)) == Roots{1, 4});
  CHECK(true_roots(along_x, with(Operation::all, left, right)).empty());
  CHECK(true_roots(along_x, with(Operation::first_alone, left, part)) == Roots{1, 2});
  CHECK(true_roots(along_x, with(Operation::first_alone, left, left)).empty());
  CHECK(true_roots(along_x, with(Operation::first_alone, left, Sphere{{2, 0, 0}, 1})) == Roots{1, 2});
  CHECK(true_roots(along_x, with(Operation::all, left, below)) == Roots{1, 2});
  CHECK(true_roots(along_x, with(Operation::either, left, below)) == Roots{3});
  CHECK(true_roots({{0, 0, 0}, {-1, 0, 0}}, with(Operation::either, left, below)) == Roots{-2});
  const Ray leaving{{0, 0, 0}, {1, 0, 0}, left.departure(0)};
  CHECK(true_roots(leaving, with(Operation::first_alone, left, part), true) == Roots{1});
}

#include <protostar/numeric/scale.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("a crossing too far away for a double does not turn a solid of a CSG tree inside out") {
  const Quadric cylinder{{{1, 0, 1}, Vec3{0}, Vec3{0}, -1}},
      paraboloid{{{0, 0, 1}, Vec3{0}, {-0.5, 0, 0}, 0}};
  const Box box{{-3, -3, -0.5}, {3, 3, 0.5}};
  for (const double aside : {0.0, 1e-300, 1e-310, -1e-310, 0x1p-1074}) {
    CAPTURE(aside);
    // Inside of the cylinder from −1e310 to 1e310 or so, and inside of the paraboloid from 0 on.
    const Ray up{{0.5, -9, 0}, {aside, 1, 0}}, along{{-9, 1, 0}, {1, 0, aside}};
    CHECK_FALSE(difference_of({box, cylinder}).intersect(up));
    CHECK(intersection_of({box, cylinder}).intersect(up) == 6);
    CHECK(difference_of({box, paraboloid}).intersect(along) == 6);
    CHECK(intersection_of({box, paraboloid}).intersect(along) == 9);
  }
}

TEST_CASE("a CSG tree is crossed at the same points along directions of any length") {
  const double far = 0x1p399;
  const Sphere large{{far, 0, 0}, far}, around{Point{0}, far}, small{Point{0}, 0x1p-300};
  const Box wide{{0, -far, -far}, {far, far, far}};
  const std::vector<Csg> trees{large,
                               difference_of({large, small}),
                               intersection_of({large, small}),
                               union_of({large, small}),
                               intersection_of({wide, small}),
                               difference_of({small, wide}),
                               intersection_of({around, small}),
                               difference_of({small, around}),
                               union_of({intersection_of({around, small}), wide})};
  const auto crossings = [](const Csg& tree, const Ray& ray) {
    std::vector<Crossing> all;
    tree.each_crossing(ray, {-infinity, infinity},
                       [&](const Crossing& crossing) { all.push_back(crossing); });
    return all;
  };
  const auto are_alike = [](const Crossing& a, const Crossing& b) {  // each t is off by at most one error
    return a.primitive == b.primitive && std::abs(a.t - b.t) <= 3 * Roots::relative_error * std::abs(a.t);
  };
  WrongCases wrong;
  for (const Csg& tree : trees)
    for (const double x : {-0x1p-320, 0x1p-310, -0x1p-200})
      for (const Vec3& towards : {Vec3{1, 0, 0}, Vec3{-0.5, 0, 0}, Vec3{0.75, 0x1p-40, 0}})
        for (const int shorter : {99, 550, 650, 1000, 1030}) {
          std::vector<Crossing> expected = crossings(tree, {{x, 0, 0}, towards});
          for (Crossing& crossing : expected) crossing.t = std::ldexp(crossing.t, shorter);
          std::erase_if(expected, [](const Crossing& crossing) { return !std::isfinite(crossing.t); });
          const std::vector<Crossing> found = crossings(tree, {{x, 0, 0}, scaled(towards, -shorter)});
          wrong.add(!std::equal(found.begin(), found.end(), expected.begin(), expected.end(), are_alike), "x",
                    x, "direction", towards.x, towards.y, "shorter by 2^", shorter);
        }
  CHECK(wrong == 0);
}

TEST_CASE("next to a face of a CSG tree, t has all digits along a direction of any length") {
  const Box box{{0, -1, -1}, {2, 1, 1}};
  const Csg tree = union_of({box, Sphere{{50, 0, 0}, 1}});
  for (const int nearness : {300, 1000, 1022, 1030, 1050, 1074})
    for (const int shorter : {200, 650, 1000, 1022}) {
      CAPTURE(nearness, shorter);
      const Ray ray{{-std::ldexp(1.25, -nearness), 0.125, 0.25}, {std::ldexp(0.75, -shorter), 0, 0}};
      const auto found = tree.first_crossing(ray, {});
      REQUIRE(found);
      const double t = -ray.origin.x / ray.direction.x;
      CHECK(std::abs(found->t - t) <= 2 * Roots::relative_error * t);
    }
}

TEST_CASE("a CSG tree in an instance is touched by a ray of a short direction where it touches the tree") {
  const Csg tree = union_of({Sphere{}, Sphere{{50, 0, 0}, 1}});
  const Instance instance{tree, Affine{}.moved_by({4, 0, 0})};
  for (const int shorter : {0, 99, 150, 400}) {
    CAPTURE(shorter);
    const Vec3 direction = scaled({0, 1, 0}, -shorter);
    for (const auto& found : {tree.first_crossing({{1, -2, 0}, direction}, {}),
                              instance.first_crossing({{5, -2, 0}, direction}, {})})
      CHECK_FALSE(found);  // in at a point, and out again
    const auto through = instance.first_crossing({{5 - 0x1p-50, -2, 0}, direction}, {});
    REQUIRE(through);
    CHECK(std::abs(std::ldexp(through->t, -shorter) - 2) < 0x1p-24);
  }
}

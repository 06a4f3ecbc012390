// Bounds of surfaces that are rounded, compared without rounding.
#include <cmath>
#include <protostar/numeric/exact_number.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/moving.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a power of 2 from 2^-40 to 2^40.
double power_of_2(Random& random) { return std::exp2(random.real(-40, 40)); }

Box box_of_any_size(Random& random) {
  const Point at = power_of_2(random) * random.point(1);
  return {at, at + power_of_2(random) * (random.point(1) + Vec3(1))};
}

/// Tests whether a number lies between two others.
bool lies_between(double least, const ExactNumber& x, double most) {
  return (x - least).sign() >= 0 && (ExactNumber(most) - x).sign() >= 0;
}

/// Calls visit(corner) for the corners of a box.
void each_corner(const Bounds& box, const auto& visit) {
  for (int i = 0; i < 8; ++i) {
    Point corner;
    for (int k = 0; k < 3; ++k) corner[k] = i >> k & 1 ? box.max[k] : box.min[k];
    visit(corner);
  }
}

}  // namespace

TEST_CASE("the bounds of an instance contain the images of its surface's bounds") {
  Random random(1);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const Box box = box_of_any_size(random);
    Affine map;
    map.x = random.direction(), map.y = normalize(cross(map.x, random.direction()));
    map.z = cross(map.x, map.y), map.translation = power_of_2(random) * random.point(1);
    const Bounds bounds = Instance(box, map).bounds();
    each_corner(box.bounds(), [&](const Point& corner) {
      for (int k = 0; k < 3; ++k) {
        const ExactNumber image = ExactNumber(corner.x) * map.x[k] + ExactNumber(corner.y) * map.y[k] +
                                  ExactNumber(corner.z) * map.z[k] + map.translation[k];
        wrong.add(!lies_between(bounds.min[k], image, bounds.max[k]), box, map, k);
      }
    });
  }
  CHECK(wrong == 0);
}

TEST_CASE("the bounds of a moving surface contain its bounds where it starts and ends") {
  Random random(2);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const Box box = box_of_any_size(random);
    const Vec3 velocity = power_of_2(random) * random.point(1);
    const Shutter during{random.real(-2, 0), random.real(0, 2)};
    const Bounds bounds = Moving<Box>(box, velocity, during).bounds();
    for (const double time : {during.opens, during.closes})
      each_corner(box.bounds(), [&](const Point& corner) {
        for (int k = 0; k < 3; ++k) {
          const ExactNumber place = ExactNumber(time) * velocity[k] + corner[k];
          wrong.add(!lies_between(bounds.min[k], place, bounds.max[k]), box, velocity, time, k);
        }
      });
  }
  CHECK(wrong == 0);
}

TEST_CASE("the bounds of a disk reach at least as far as its outline") {
  Random random(3);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const Disk disk{.position = i % 2 ? Point{0} : power_of_2(random) * random.point(1),
                    .normal = power_of_2(random) * random.point(1),
                    .radius = power_of_2(random)};
    const Bounds bounds = disk.bounds();
    // On axis k it reaches r √(1 − n_k²/n²).
    ExactNumber square = 0.0;
    for (int k = 0; k < 3; ++k) square = square + ExactNumber(disk.normal[k]) * disk.normal[k];
    for (int k = 0; k < 3; ++k) {
      const ExactNumber across = square - ExactNumber(disk.normal[k]) * disk.normal[k];
      for (const double end : {bounds.min[k], bounds.max[k]}) {
        const ExactNumber reach = ExactNumber(end) - disk.position[k];
        wrong.add((reach * reach * square - ExactNumber(disk.radius) * disk.radius * across).sign() < 0, disk,
                  k);
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a box is halved across its longest side, unless no number lies between its ends") {
  const auto sides = [](const Vec3& size) {
    const auto halves = halves_of({{1, 2, 4}, Point{1, 2, 4} + size});
    REQUIRE(halves);
    const auto& [lower, upper] = *halves;
    CHECK(lower.min == Point{1, 2, 4});
    CHECK(upper.max == Point{1, 2, 4} + size);
    return lower.max - upper.min;  // of each half, the other sides are those of the box
  };
  CHECK(sides({8, 4, 2}) == Vec3{0, 4, 2});
  CHECK(sides({4, 8, 2}) == Vec3{4, 0, 2});
  CHECK(sides({4, 2, 8}) == Vec3{4, 2, 0});
  CHECK(sides({8, 8, 8}) == Vec3{0, 8, 8});
  CHECK(halves_of({{1, 2, 4}, {9, 6, 6}})->at(0).max.x == 5);

  const double next = std::nextafter(1.0, 2.0);
  CHECK_FALSE(halves_of({Point{1}, Point{next}}));
  CHECK_FALSE(halves_of({Point{1}, Point{1}}));
  CHECK(halves_of({Point{1}, Point{std::nextafter(next, 2.0)}}));
}

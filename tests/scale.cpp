// Tests of powers of two that scale numbers to about 1 (numeric/scale.hpp).
#include <protostar/numeric/scale.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("a vector's exponent is that of its largest component, for all doubles") {
  Random random(61);
  WrongCases wrong(random);
  for (int exponent = -1074; exponent < 1024; ++exponent) {
    const double size = std::ldexp(random.real(1, 2), exponent);  // with fewer digits below 2^-1022
    Vec3 v = size * 0x1p-1 * random.direction();
    v[(exponent + 1074) % 3] = exponent % 2 ? -size : size;
    int expected = 0;
    const double fraction = std::frexp(size, &expected);
    wrong.add(exponent_of({v}) != expected || fraction < 0.5, v, fraction);
    wrong.add(exponent_of({Vec3{0}, v, -v}) != expected, v);
  }
  CHECK(wrong == 0);
  CHECK(exponent_of({Vec3{0}}) < -1074);
}

TEST_CASE("scaled vectors have the same bits as by ldexp") {
  Random random(62);
  WrongCases wrong(random);
  for (int i = 0; i < 20'000; ++i) {
    const int size = static_cast<int>(random.bits() % 2098) - 1074,
              by = static_cast<int>(random.bits() % 4400) - 2200;
    const Vec3 v{std::ldexp(random.real(-1, 1), size), std::ldexp(random.real(-1, 1), size), 0};
    const Vec3 result = scaled(v, by);
    for (int axis = 0; axis < 3; ++axis) wrong.add(result[axis] != std::ldexp(v[axis], by), v, result);
  }
  CHECK(wrong == 0);
}

TEST_CASE("of_moderate_size keeps a vector of moderate size, and scales others to about 1") {
  Random random(63);
  for (const double size : {5e-324, 1e-310, 0x1p-101, 0x1p-99, 1.0, 0x1p99, 0x1p101, 0x1p1022}) {
    const Vec3 v = size * Vec3{1, -0.0, 1}, moderate = of_moderate_size(v);
    CAPTURE(size);
    CHECK((0x1p-100 < moderate.x && moderate.x < 0x1p100));
    CHECK(moderate.x == moderate.z);
    CHECK(moderate.y == 0);
    if (0x1p-100 < size && size < 0x1p99) CHECK(moderate == v);
  }
}

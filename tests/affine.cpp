#include <protostar/numeric/affine.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("an affine map is given by the images of the axes and of the coordinate origin") {
  const Affine map{{0, 2, 0}, {-3, 0, 0}, {1, 0, 1}, {10, 20, 30}};
  CHECK(map.point({0, 0, 0}) == Point{10, 20, 30});
  CHECK(map.point({1, 0, 0}) == Point{10, 22, 30});
  CHECK(map.point({1, 2, 3}) == Point{7, 22, 33});
  CHECK(map.vector({1, 2, 3}) == Vec3{-3, 2, 3});
  CHECK(Affine{}.point({1, 2, 3}) == Point{1, 2, 3});
}

TEST_CASE("affine maps are applied in the order in which they are written") {
  CHECK(Affine{}.scaled_by({2, 3, 4}).moved_by({1, 1, 1}).point({1, 1, 1}) == Point{3, 4, 5});
  CHECK(Affine{}.moved_by({1, 1, 1}).scaled_by({2, 3, 4}).point({1, 1, 1}) == Point{4, 6, 8});
  CHECK(Affine{}.scaled_by({2, 1, 1}).rotated_about({0, 0, 5}, 90).point({1, 0, 0}) == Point{0, 2, 0});
  CHECK(Affine{}.moved_by({1, 0, 0}).rotated_about({0, 0, 1}, 90).point({1, 0, 0}) == Point{0, 2, 0});
}

TEST_CASE("a rotation by 90 degrees takes x to y, y to z and z to x, each about the third axis") {
  CHECK(Affine{}.rotated_about({0, 0, 1}, 90).vector({1, 0, 0}) == Vec3{0, 1, 0});
  CHECK(Affine{}.rotated_about({1, 0, 0}, 90).vector({0, 1, 0}) == Vec3{0, 0, 1});
  CHECK(Affine{}.rotated_about({0, 1e-200, 0}, 90).vector({0, 0, 1}) == Vec3{1, 0, 0});
  CHECK(Affine{}.rotated_about({0, 0, 1e200}, -180).vector({1, 2, 3}) == Vec3{-1, -2, 3});
  Random random(61);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = random.direction();
    const Affine turn = Affine{}.rotated_about(2.0 * axis, random.real(-400, 400));
    CHECK(length(turn.vector(axis) - axis) < 1e-15);
    CHECK(std::abs(dot(turn.x, turn.y)) + std::abs(dot(turn.z, turn.y)) < 2e-15);
    CHECK(length(cross(turn.x, turn.y) - turn.z) < 2e-15);
  }
}

TEST_CASE("the inverse of a map of whole numbers is its cofactors over the determinant, each rounded once") {
  Random random(62);
  int singular = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const int sizes[] = {static_cast<int>(random.bits() % 800) - 400,
                         static_cast<int>(random.bits() % 800) - 400,
                         static_cast<int>(random.bits() % 800) - 400};
    const Vec3 x = random.whole_vector(3), y = random.whole_vector(3), z = random.whole_vector(3);
    const Affine map{scaled(x, sizes[0]), scaled(y, sizes[1]), scaled(z, sizes[2])};
    const AffineInverse inverse(map);
    const double determinant = dot(x, cross(y, z));
    singular += determinant == 0;
    wrong.add(inverse.exists() != (determinant != 0), map, determinant);
    if (determinant == 0) continue;
    const Vec3 rows[] = {cross(y, z), cross(z, x), cross(x, y)};
    for (int k = 0; k < 3; ++k) {
      Vec3 unit{0};
      unit[k] = 1;
      for (int r = 0; r < 3; ++r)
        wrong.add(inverse.vector(unit)[r] != std::ldexp(rows[r][k] / determinant, -sizes[r]), map,
                  determinant, unit);
    }
  }
  CHECK(singular > 300);
  CHECK(wrong == 0);
}

TEST_CASE(
    "a line mapped in doubles is off the exact one by no more than its errors, whatever the magnitudes") {
  Random random(65);
  WrongCases wrong(random);
  const auto vector = [&](double least, double most) {
    const auto number = [&] { return random.real(-1, 1) * std::exp2(random.real(least, most)); };
    return Vec3{number(), number(), number()};
  };
  const auto is_within = [](double found, double error, const ExactNumber& expected,
                            const ExactNumber& weight) {
    const ExactNumber off = ExactNumber(found) * weight - expected, most = ExactNumber(error) * weight;
    return (most - off).sign() >= 0 && (most + off).sign() >= 0;
  };
  int mapped = 0, tiny = 0;
  for (int i = 0; i < 20000; ++i) {
    const double sizes[] = {3, 300, 390};
    const double size = sizes[i % 3];
    Affine map{vector(-size, size), vector(-size, size), vector(-size, size), vector(-390, 390)};
    if (i % 2 == 0) map.translation = Vec3{0};
    const AffineInverse inverse(map);
    if (!inverse.exists()) continue;
    const bool is_tiny = i % 4 < 2;  // so that the rounding of the numbers underflows
    const double least = is_tiny ? -1073 : -390, most = is_tiny ? -1000 : 390;
    RoundedLine from{.origin = vector(least, most), .direction = vector(least, most)};
    if (i % 8 < 4) from.origin_error = 0x1p-40 * abs(from.origin);
    if (i % 16 < 8) from.direction_error = 0x1p-40 * abs(from.direction);
    const ExactNumber share(random.real(-1, 1));
    const RoundedLine line = inverse.line(from);
    if (!is_finite(line.origin) || !is_finite(line.direction)) continue;
    const ExactLine expected =
        inverse.line(ExactLine{exact_vector(from.origin) + share * exact_vector(from.origin_error),
                               exact_vector(from.direction) + share * exact_vector(from.direction_error)});
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      wrong.add(!is_within(line.origin[k], line.origin_error[k], expected.origin[axis], expected.weight), map,
                from.origin);
      wrong.add(
          !is_within(line.direction[k], line.direction_error[k], expected.direction[axis], expected.weight),
          map, from.direction);
    }
    ++mapped, tiny += is_tiny;
  }
  CHECK(tiny > 5000);
  CHECK(mapped > 15000);
  CHECK(wrong == 0);
}

TEST_CASE("a singular map has no inverse, and a nearly singular one has") {
  const double almost = 1 - 0x1p-53;
  CHECK(AffineInverse(Affine{{1, 1, 0}, {1, almost, 0}, {0, 0, 1}}).exists());
  CHECK_FALSE(AffineInverse(Affine{{1, 1, 0}, {almost, almost, 0}, {0, 0, 1}}).exists());
  CHECK_FALSE(AffineInverse(Affine{}.scaled_by({1, 0, 1})).exists());
  CHECK(AffineInverse(Affine{}.scaled_by({0x1p1000, 0x1p-1000, 1})).exists());
  CHECK_FALSE(AffineInverse(Affine{}.scaled_by({1, 0x1p-1070, 1})).exists());  // its inverse overflows
  for (const double bad : {infinity, std::nan("")}) {
    CHECK_FALSE(AffineInverse(Affine{}.scaled_by({1, bad, 1})).exists());
    CHECK_FALSE(AffineInverse(Affine{}.moved_by({bad, 0, 0})).exists());
  }
}

TEST_CASE("the inverse of an affine map takes points and vectors back") {
  Random random(63);
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const Affine map = Affine{}
                           .scaled_by({random.real(0.5, 2), random.real(-2, -0.5), random.real(0.5, 2)})
                           .rotated_about(random.direction(), random.real(0, 360))
                           .moved_by(random.point(5));
    const Point p = random.point(5);
    const AffineInverse inverse(map);
    worst =
        std::max({worst, length(inverse.point(map.point(p)) - p), length(inverse.vector(map.vector(p)) - p)});
  }
  CHECK(worst < 5e-14);
}

TEST_CASE("a mapped normal is orthogonal to the mapped tangent vectors") {
  Random random(64);
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const Affine map{random.direction(), 3.0 * random.direction(), random.direction()};
    if (std::abs(dot(map.x, cross(map.y, map.z))) < 0.1) continue;
    const Vec3 normal = random.direction(), along = normalize(cross(normal, random.direction()));
    const Vec3 mapped = AffineInverse(map).mapped_normal(normal);
    worst = std::max(worst, std::abs(dot(normalize(mapped), map.vector(along))));
    CHECK(dot(mapped, map.vector(normal)) > 0);
  }
  CHECK(worst < 1e-13);
}

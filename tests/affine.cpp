#include <protostar/numeric/affine.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a map of whole numbers below 2^11 whose inverse has whole numbers below 2^22, times powers of two.
/// Hence products with whole numbers below 2^10 are exact both ways.
Affine unimodular(Random& random) {
  const auto number = [&] { return static_cast<double>(random.whole(30)); };
  const auto factor = [&] {
    return std::ldexp(random.whole(1) < 0 ? -1 : 1, static_cast<int>(random.whole(3)));
  };
  const Affine below{{1, number(), number()}, {0, 1, number()}, {0, 0, 1}};
  const Vec3 x{1, 0, 0}, y{number(), 1, 0}, z{number(), number(), 1};  // with determinant 1, as below
  const double by_x = factor(), by_y = factor(), by_z = factor();
  return Affine{below.vector(x), below.vector(y), below.vector(z)}.scaled_by({by_x, by_y, by_z});
}

}  // namespace

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
  // With u = 2^-53, the unit axis a is off by 4.5u (camera.cpp), and the sine s and cosine c by 0.51u each.
  // Hence s (a × e) is off by 5.5u |s|, (1 − c)(a · e) a by 12u (1 − c), their sum by 25.2u, by at most u
  // more for adding c e, and by 0.7u for c and s: each column by 27u. The axis is turned by √3 · 27u for the
  // sum of columns, and 3√3 u for its roundings; dots of columns are off by 2 · 27u + 3u, and a cross product
  // and the third by 3 · 27u + 2√2 u. Roundings rarely add up: measured are 9u, 11u and 11u.
  constexpr double u = 0x1p-53;
  Random random(61);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = random.direction();
    const Affine turn = Affine{}.rotated_about(2.0 * axis, random.real(-400, 400));
    CHECK(length(turn.vector(axis) - axis) <= 53 * u);
    CHECK(std::abs(dot(turn.x, turn.y)) + std::abs(dot(turn.z, turn.y)) <= 114 * u);
    CHECK(length(cross(turn.x, turn.y) - turn.z) <= 84 * u);
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
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const Affine map = unimodular(random).moved_by(random.whole_vector(1000));
    const Point p = random.whole_vector(1000);
    const AffineInverse inverse(map);
    wrong.add(inverse.point(map.point(p)) != p, map, p, inverse.point(map.point(p)));
    wrong.add(inverse.vector(map.vector(p)) != p, map, p, inverse.vector(map.vector(p)));
  }
  CHECK(wrong == 0);
}

TEST_CASE("a mapped normal is orthogonal to the mapped tangent vectors") {
  Random random(64);
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const Affine map = unimodular(random);
    const Vec3 normal = random.whole_vector(9), along = cross(normal, random.whole_vector(9));
    const Vec3 mapped = AffineInverse(map).mapped_normal(normal);
    wrong.add(dot(mapped, map.vector(along)) != 0, map, normal, along, mapped);
    wrong.add(dot(mapped, map.vector(normal)) != dot(normal, normal), map, normal, mapped);
  }
  CHECK(wrong == 0);
}

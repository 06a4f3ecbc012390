#include <protostar/numeric/radians.hpp>
#include <protostar/sampling/radians_of_each.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns the relative error in units of 2^-53.
double units(double x, long double expected) {
  return expected == 0 ? (x == 0 ? 0 : 1e9)
                       : static_cast<double>(std::abs(x - expected) / std::abs(expected)) * 0x1p53;
}

}  // namespace

TEST_CASE("sine and cosine in radians have errors below 2 units of roundoff") {
  CHECK(sine_and_cosine(0).sine == 0);
  CHECK(sine_and_cosine(0).cosine == 1);
  if (!long_double_judges()) return;
  Random random(1);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    // Any angle, tiny ones, and some close to a multiple of π/2, where one of the two is tiny. There only the
    // C library's reduction, by a π of 64 digits, is not good enough, and so the judge reduces by hand.
    const double quarter = std::numbers::pi / 2;
    double angle = random.real(-7, 7);
    if (i % 3 == 1) angle = std::exp2(random.real(-1000, 2));
    if (i % 3 == 2) angle = std::round(random.real(-4.4, 4.4)) * quarter + std::exp2(random.real(-50, -10));
    if (std::abs(angle) > 7) continue;
    const double n = std::round(angle / quarter);
    const long double rest = (static_cast<long double>(angle) - n * static_cast<long double>(quarter)) -
                             n * static_cast<long double>(0x1.1a62633145c07p-54);
    const long double s = std::sin(rest), c = std::cos(rest);
    const int turns = (static_cast<int>(n) + 8) % 4;
    const auto [sine, cosine] = sine_and_cosine(angle);
    most = std::max({most,
                     units(sine, turns == 0   ? s
                                 : turns == 1 ? c
                                 : turns == 2 ? -s
                                              : -c),
                     units(cosine, turns == 0   ? c
                                   : turns == 1 ? -s
                                   : turns == 2 ? -c
                                                : s)});
  }
  CHECK(most > 0.5);
  CHECK(most < 2);
}

TEST_CASE("the polar angle has an error below 4 units of roundoff") {
  CHECK(polar_angle(0, 0) == 0);
  CHECK(polar_angle(0, 1) == 0);
  CHECK(polar_angle(0, -1) == std::numbers::pi);
  CHECK(polar_angle(1, 0) == std::numbers::pi / 2);
  CHECK(polar_angle(-1, 0) == -std::numbers::pi / 2);
  CHECK(polar_angle(1, 1) == std::numbers::pi / 4);
  if (!long_double_judges()) return;
  Random random(2);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    const double size = i % 2 == 0 ? 0 : random.real(-300, 300);
    const double y = random.real(-1, 1), x = random.real(-1, 1) * std::exp2(size);
    most = std::max(most, units(polar_angle(y, x), std::atan2(static_cast<long double>(y), x)));
  }
  CHECK(most > 0.5);
  CHECK(most < 4);
}

TEST_CASE("the polar angle of a number that is not finite is NaN, alone and of several at once") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, infinity})
    for (const double other : {0.0, 1.0, -1.0, nan, infinity}) {
      CAPTURE(bad, other);
      CHECK(std::isnan(polar_angle(bad, other)));
      CHECK(std::isnan(polar_angle(other, bad)));
      CHECK(std::isnan(polar_angle_of_each(bad, other)[0]));
      if (!(other < 0)) CHECK(std::isnan(polar_angle_of_each(other, bad)[0]));
    }
  CHECK(polar_angle_of_each(0, 0)[0] == 0);
}

TEST_CASE("sines, cosines and polar angles of several numbers at once have the bits of those one by one") {
  Random random(64);
  WrongCases wrong;
  const auto number = [&]() -> double {
    if (const auto rare = random.whole(9); std::abs(rare) <= 1) return static_cast<double>(rare);
    return random.real(-1, 1) * std::exp2(random.real(-60, 60));
  };
  for (int i = 0; i < cases(2000, 1000000); ++i) {
    const std::size_t count = 1 + static_cast<std::size_t>(i) % 8;
    FewNumbers angles{}, y{}, x{};
    for (std::size_t k = 0; k < count; ++k) {
      angles[k] = random.real(0, std::numbers::pi);
      y[k] = std::abs(number());
      x[k] = i % 3 == 0 ? y[k] * random.real(-1.01, 1.01) : number();
    }
    const auto [sines, cosines] = sines_and_cosines_of_each(angles, count);
    const FewNumbers polar = polar_angles_of_each(y, x, count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto [sine, cosine] = sine_and_cosine(angles[k]);
      wrong.add(sines[k] != sine || cosines[k] != cosine, "sine and cosine", angles[k]);
      wrong.add(polar[k] != polar_angle(y[k], x[k]), "angle", y[k], x[k]);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("sine and cosine of each of several angles have the bits of the one alone") {
  using simd::Doubles;
  Random random(5);
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    // Half of the angles are near the eighths of a turn, where the nearest quarter changes.
    const auto angle = [&](int) {
      if (random.real(0, 1) < 0.5) return random.real(-7, 7);
      return std::numbers::pi / 4 * std::round(random.real(-8.4, 8.4)) + std::exp2(random.real(-60, -20));
    };
    const Doubles angles = Doubles::of_each(angle);
    const auto [sines, cosines] = sine_and_cosine_of_each(angles);
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const auto [sine, cosine] = sine_and_cosine(angles[lane]);
      wrong.add(sines[lane] != sine || cosines[lane] != cosine, angles[lane]);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a half angle has digits for small angles and for those close to a half turn") {
  if (!long_double_judges()) return;
  Random random(3);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    const double y = std::exp2(random.real(-300, 0)), x = random.real(-1, 1);
    const auto [sine, cosine] = half_angle(y, x);
    // For an angle close to π, the cosine is the sine of half of what is missing.
    const long double small = std::atan2(static_cast<long double>(y), std::abs(x)) / 2;
    most = std::max(
        {most, units(x < 0 ? cosine : sine, std::sin(small)), units(x < 0 ? sine : cosine, std::cos(small))});
  }
  CHECK(most > 0.5);
  // r is off by 2u, its quotient with x by u more, the larger one by 1.75u in itself; the other one by 2u for
  // r, 1.75u, and u for each of two quotients. Measured are 3u.
  CHECK(most <= 5.75);
}

TEST_CASE("precise angles are those of exact addition") {
  // arctan(1/2) + arctan(1/3) = π/4, and Machin's 4 arctan(1/5) − arctan(1/239) = π/4.
  using namespace detail;
  const DoubleDouble euler = precise_angle_of(1, 2) + precise_angle_of(1, 3);
  const DoubleDouble machin = DoubleDouble(4) * precise_angle_of(1, 5) - precise_angle_of(1, 239);
  const DoubleDouble eighth{pi.hi / 4, pi.lo / 4};
  CHECK(std::abs((euler - eighth).hi) < 0x1p-98);
  CHECK(std::abs((machin - eighth).hi) < 0x1p-98);
}

// These values would differ between machines if the functions came from the C library.
TEST_CASE("angles in radians have the same bits on every machine") {
  CHECK(sine_and_cosine(1).sine == 0x1.aed548f090ceep-1);
  CHECK(sine_and_cosine(1).cosine == 0x1.14a280fb5068cp-1);
  CHECK(polar_angle(0.3, -0.7) == 0x1.5e4c36ca0118ap+1);
}

#include <protostar/numeric/trigonometry.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

constexpr double pi = std::numbers::pi;

/// Returns the distance of a number from the expected one, in units of its last place.
double error(double x, long double expected) {
  const double unit = std::ldexp(1.0, std::max(std::ilogb(x), -1022) - 52);
  return static_cast<double>(std::abs(static_cast<long double>(x) - expected) / unit);
}

/// Sine and cosine by the C library, after quarter turns are subtracted, which is exact in long double.
struct Judge {
  long double sine, cosine;
  explicit Judge(double degrees) {
    const long double turned = std::remainder(static_cast<long double>(degrees), 360.0L);
    const long double quarters = std::round(turned / 90);
    const long double angle = (turned - 90 * quarters) * std::numbers::pi_v<long double> / 180;
    const long double s = std::sin(angle), c = std::cos(angle);
    const int turns = static_cast<int>(quarters + 4) % 4;
    sine = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
    cosine = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
  }
};

}  // namespace

TEST_CASE("sine, cosine and tangent of common angles are exact") {
  struct {
    double degrees, sine, cosine, tangent;
  } const rows[] = {{0, 0, 1, 0},
                    {90, 1, 0, infinity},
                    {180, 0, -1, 0},
                    {270, -1, 0, -infinity},
                    {-90, -1, 0, -infinity},
                    {-180, 0, -1, 0},
                    {360, 0, 1, 0},
                    {-450, -1, 0, -infinity},
                    {3.6e22, 0, 1, 0}};
  for (const auto& row : rows) {
    CAPTURE(row.degrees);
    CHECK(sine_of_degrees(row.degrees) == row.sine);
    CHECK(cosine_of_degrees(row.degrees) == row.cosine);
    CHECK(tangent_of_degrees(row.degrees) == row.tangent);
  }
  for (const double turns : {0.0, 360.0, -720.0}) {
    CHECK(sine_of_degrees(turns + 30) == 0.5);
    CHECK(sine_of_degrees(turns + 150) == 0.5);
    CHECK(sine_of_degrees(turns - 30) == -0.5);
    CHECK(cosine_of_degrees(turns + 60) == 0.5);
    CHECK(cosine_of_degrees(turns + 120) == -0.5);
    CHECK(tangent_of_degrees(turns + 45) == 1);
    CHECK(tangent_of_degrees(turns + 135) == -1);
    CHECK(tangent_of_degrees(turns - 45) == -1);
  }
}

TEST_CASE("sine, cosine and tangent have errors of little more than their rounding") {
  if (!long_double_judges()) return;
  Random random(1);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    const double size = i % 4 == 0 ? std::exp2(random.real(-300, 60)) : i % 4 == 1 ? 1000 : 180;
    const double degrees = random.real(-size, size);
    const Judge judge(degrees);
    most = std::max({most, error(sine_of_degrees(degrees), judge.sine),
                     error(cosine_of_degrees(degrees), judge.cosine),
                     error(tangent_of_degrees(degrees), judge.sine / judge.cosine)});
  }
  CHECK(most > 0.45);
  CHECK(most < 0.51);
}

TEST_CASE("the arc tangent covers all quadrants, and is exact on axes and diagonals") {
  struct {
    double y, x, angle;
  } const rows[] = {
      {0.0, 1, 0},       {1, 1, pi / 4},         {1, 0.0, pi / 2},         {1, -1, 3 * pi / 4},
      {0.0, -1, pi},     {-0.0, -1, -pi},        {-1, -1, -3 * pi / 4},    {-1, 0.0, -pi / 2},
      {-1, 1, -pi / 4},  {0.0, 0.0, 0},          {0.0, -0.0, pi},          {-0.0, -0.0, -pi},
      {1, -0.0, pi / 2}, {1e300, 1e300, pi / 4}, {5e-324, 5e-324, pi / 4}, {1e-300, -1e-300, 3 * pi / 4}};
  for (const auto& [y, x, angle] : rows) {
    CAPTURE(y, x);
    CHECK(arc_tangent(y, x) == angle);
    CHECK(std::signbit(arc_tangent(y, x)) == std::signbit(y));
  }
}

TEST_CASE("the arc cosine of 1, 0 and −1 is exact, and beyond ±1 equals that of ±1") {
  CHECK(arc_cosine(1) == 0);
  CHECK(arc_cosine(0) == pi / 2);
  CHECK(arc_cosine(-0.0) == pi / 2);
  CHECK(arc_cosine(-1) == pi);
  CHECK(arc_cosine(std::nextafter(1, 2)) == 0);
  CHECK(arc_cosine(std::nextafter(-1, -2)) == pi);
  CHECK(arc_cosine(infinity) == 0);
  CHECK(arc_cosine(-infinity) == pi);
}

TEST_CASE("arc tangent and arc cosine have errors of little more than their rounding") {
  if (!long_double_judges()) return;
  Random random(2);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    // Sizes of about 1, of any magnitude, and both huge or tiny, where sums overflow and products vanish.
    const double size = i % 3 == 0 ? 0 : i % 3 == 1 ? random.real(-400, 400) : i % 2 == 0 ? 1023.5 : -1020;
    const double y = random.real(-1, 1) * std::exp2(size),
                 x = random.real(-1, 1) * std::exp2(i % 3 == 1 ? random.real(-400, 400) : size);
    most = std::max(most, error(arc_tangent(y, x), std::atan2(static_cast<long double>(y), x)));
    const double near_one = 1 - std::exp2(random.real(-52, 1));
    const double cosine = i % 3 == 0 ? near_one : i % 3 == 1 ? -near_one : random.real(-1, 1);
    most = std::max(most, error(arc_cosine(cosine), std::acos(static_cast<long double>(cosine))));
  }
  CHECK(most > 0.45);
  CHECK(most < 0.51);
}

TEST_CASE("angles of numbers that are not finite are NaN") {
  for (const double bad : {infinity, -infinity, not_a_number}) {
    CHECK(std::isnan(sine_of_degrees(bad)));
    CHECK(std::isnan(cosine_of_degrees(bad)));
    CHECK(std::isnan(tangent_of_degrees(bad)));
    CHECK(std::isnan(arc_tangent(bad, 1)));
    CHECK(std::isnan(arc_tangent(1, bad)));
  }
  CHECK(std::isnan(arc_cosine(not_a_number)));
}

// These values would differ between machines if the functions came from the C library.
TEST_CASE("angles have the same bits on every machine") {
  CHECK(tangent_of_degrees(20) == 0x1.74b49cf3902d4p-2);
  CHECK(tangent_of_degrees(26.56505117707799) == 0x1.0000000000000p-1);
  CHECK(tangent_of_degrees(30) == 0x1.279a74590331cp-1);
  CHECK(sine_of_degrees(1) == 0x1.1df0b2b89dd1ep-6);
  CHECK(cosine_of_degrees(200.5) == -0x1.df937f47ca07cp-1);
  CHECK(arc_tangent(0.3, -0.7) == 0x1.5e4c36ca0118ap+1);
  CHECK(arc_cosine(0.1) == 0x1.787b22ce3f590p+0);
}

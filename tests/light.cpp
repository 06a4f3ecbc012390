#include <cmath>
#include <limits>
#include <numbers>
#include <protostar/light.hpp>
#include <stdexcept>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {
constexpr float four_pi = 4 * std::numbers::pi_v<float>;
constexpr double inf = std::numeric_limits<double>::infinity(),
                 not_a_number = std::numeric_limits<double>::quiet_NaN();
}  // namespace

TEST_CASE("a point light of 4π watts brings 1 W/m² to what faces it at distance 1") {
  const PointLight light{.position = {0, 1, 0}, .power = Color{four_pi, 2 * four_pi, 0}};
  const Color e = light.irradiance({0, 0, 0}, {0, 1, 0});
  CHECK(std::abs(e.r - 1) < 1e-6f);
  CHECK(std::abs(e.g - 2) < 1e-6f);
  CHECK(e.b == 0);
}

TEST_CASE("irradiance falls with the square of the distance and the cosine of the angle") {
  struct {
    Point position;
    double expected;
  } const rows[] = {
      {{0, 2, 0}, 0.25},
      {{0, 10, 0}, 0.01},
      {{0, 0.1, 0}, 100},
      {{1, 1, 0}, std::sqrt(0.5) / 2},
      {{0, 1, std::sqrt(3.0)}, 0.5 / 4},
  };
  for (const auto& row : rows) {
    const Color e = PointLight{row.position, Color{four_pi}}.irradiance({0, 0, 0}, {0, 1, 0});
    CHECK(std::abs(e.r / row.expected - 1) < 1e-6);
  }
}

TEST_CASE("a light behind a surface, in its plane or at the point itself brings nothing") {
  for (const Point& position : {Point{0, -1, 0}, Point{3, -1e-9, 0}, Point{1, 0, 1}, Point{0, 0, 0}})
    CHECK(PointLight{position, Color{1}}.irradiance({0, 0, 0}, {0, 1, 0}) == Color{0});
}

TEST_CASE("a sphere around a point light receives its power") {
  // The mean over the sphere of E · 4πR² is Φ, wherever in the sphere the light is. (a property of the
  // formula that uses neither its cosine nor its distance one by one)
  Random random(2);
  const PointLight light{.position = {0.5, 0.3, -0.2}, .power = Color{7}};
  double sum = 0;
  constexpr int samples = 100000;
  constexpr double radius = 2;
  for (int i = 0; i < samples; ++i) {
    const Vec3 out = random.direction();
    sum += double{light.irradiance(radius * out, -out).r};
  }
  CHECK(std::abs(sum / samples * 4 * std::numbers::pi * radius * radius / 7 - 1) < 0.01);
}

TEST_CASE("a light that makes no sense is refused with the field's name") {
  for (const double bad : {inf, -inf, not_a_number}) {
    const PointLight light{.position = {0, bad, 0}, .power = Color{1}};
    CHECK_THAT(message_of<std::invalid_argument>([&] { light.validate(); }),
               ContainsSubstring("PointLight: position"));
  }
  for (const double bad : {inf, not_a_number, -1.0}) {
    const PointLight light{.position = {0, 0, 0}, .power = Color{1, 1, static_cast<float>(bad)}};
    CHECK_THAT(message_of<std::invalid_argument>([&] { light.validate(); }),
               ContainsSubstring("PointLight: power"));
  }
  CHECK_NOTHROW(PointLight{}.validate());  // dark, but a light
}

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <protostar/light.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

const Point world_origin{0};
const Vec3 upwards{0, 1, 0};

/// Returns a light's irradiance at the origin, on a surface that faces up and on one that faces the light.
double lit(const Light& light) { return double{light.irradiance(world_origin, upwards).r}; }
double lit_facing(const Light& light) { return double{light.perpendicular_irradiance(world_origin).r}; }

/// Relative error of an irradiance: a light's color, its factor and their product are rounded to float, by
/// 2^-24 of themselves each; the errors in double are less than 2^-40 together.
constexpr double irradiance_error = 3.001 * 0x1p-24;

bool near(double a, double b) { return std::abs(a - b) <= irradiance_error * std::abs(b); }

std::string refusal(const auto& light) {
  return message_of<std::invalid_argument>([&] { static_cast<void>(Light(light)); });
}
}  // namespace

TEST_CASE("a point light of 4π watts gives 1 W/m² on a surface that faces it at distance 1") {
  const Light light = PointLight{.position = {0, 1, 0}, .power = Color{four_pi, 2 * four_pi, 0}};
  const Color e = light.irradiance(world_origin, upwards);
  CHECK(near(double{e.r}, 1));
  CHECK(near(double{e.g}, 2));
  CHECK(e.b == 0);
}

TEST_CASE("irradiance falls with the square of the distance and the cosine of the angle") {
  struct {
    Point position;
    double facing, cosine;
  } const rows[] = {
      {{0, 2, 0}, 0.25, 1},
      {{0, 10, 0}, 0.01, 1},
      {{0, 0.1, 0}, 100, 1},
      {{1, 1, 0}, 0.5, std::sqrt(0.5)},
      {{0, 1, std::sqrt(3.0)}, 0.25, 0.5},
  };
  for (const auto& row : rows) {
    const Light light = PointLight{row.position, Color{four_pi}};
    CHECK(near(lit(light), row.facing * row.cosine));
    CHECK(near(lit_facing(light), row.facing));
  }
}

TEST_CASE("the irradiance of a constant light depends on the cosine alone") {
  struct {
    Point position;
    double cosine;
  } const rows[] = {{{0, 2, 0}, 1},
                    {{0, 1000, 0}, 1},
                    {{0, 0.1, 0}, 1},
                    {{1, 1, 0}, std::sqrt(0.5)},
                    {{0, 7, 7 * std::sqrt(3.0)}, 0.5}};
  for (const auto& row : rows) {
    const Light light = ConstantLight{row.position, Color{3}};
    CHECK(near(lit(light), 3 * row.cosine));
    CHECK(near(lit_facing(light), 3));
    CHECK(light.towards(world_origin) == row.position);
    CHECK(light.occlusion_range().max == 1);
  }
}

TEST_CASE("a constant light gives no more than its irradiance to a point as near as doubles tell") {
  for (const double distance : {0x1p-500, 0x1p-537, 0x1p-600, 0x1p-1074}) {
    CAPTURE(distance);
    CHECK(near(lit(ConstantLight{{0, distance, 0}, Color{3}}), 3));
    CHECK(lit(ConstantLight{{distance, distance, 0}, Color{3}}) <= 3);
  }
}

TEST_CASE("a directional light shines from its direction, of any length, at every point") {
  for (const double length : {1.0, 5.0, 1e-200, 1e200}) {
    CAPTURE(length);
    const Light light = DirectionalLight{.direction = length * Vec3{1, 1, 0}, .intensity = Color{2}};
    for (const Point& point : {world_origin, Point{1e6, -3, 5}}) {
      CHECK(near(double{light.irradiance(point, upwards).r}, std::sqrt(2.0)));
      CHECK(near(double{light.irradiance(point, normalize(Vec3{1, 1, 0})).r}, 2));
      CHECK(near(double{light.perpendicular_irradiance(point).r}, 2));
      CHECK(light.irradiance(point, Vec3{0, -1, 0}) == Color{0});
      // Divided by its largest number, a direction of any length is {1, 1, 0} before it is normalized.
      CHECK(light.towards(point) == normalize(Vec3{1, 1, 0}));
    }
    CHECK(light.occlusion_range().min == 0);
    CHECK(light.occlusion_range().max == infinity);  // occluders may be at any distance
  }
}

TEST_CASE("a spotlight is a point light inside its cone, and dark outside") {
  struct {
    double degrees;  // from the axis to the point that is lit
    double angle, fade, share;
  } const rows[] = {
      {0, 30, 0, 1},           {29.999, 30, 0, 1},  {30.001, 30, 0, 0},  {90, 30, 0, 0},
      {180, 30, 0, 0},         {0, 30, 10, 1},      {19.999, 30, 10, 1}, {25, 30, 10, 0.5},
      {27.5, 30, 10, 0.15625},  // the smoothstep x²(3 − 2x) of ¼
      {22.5, 30, 10, 0.84375},  // the smoothstep of ¾
      {30.001, 30, 10, 0},     {0, 30, 30, 1},      {15, 30, 30, 0.5},   {100, 120, 0, 1},
      {125, 120, 0, 0},        {179.99, 180, 0, 1}, {90, 180, 180, 0.5}, {0, 30, 60, 0.5},
  };
  for (const auto& row : rows) {
    CAPTURE(row.degrees, row.angle, row.fade);
    const double radians = row.degrees * std::numbers::pi / 180;
    // The light is at (0, 2, 0), with its axis turned away from straight down.
    const Vec3 axis{std::sin(radians), -std::cos(radians), 0};
    const Light light = SpotLight{.position = {0, 2, 0},
                                  .direction = 3.0 * axis,
                                  .angle = row.angle,
                                  .power = Color{four_pi},
                                  .fade = row.fade};
    CHECK(near(lit(light), 0.25 * row.share));
    CHECK(near(lit_facing(light), 0.25 * row.share));
    CHECK((lit(light) == 0) == (row.share == 0));
    CHECK(light.towards(world_origin) == Vec3{0, 2, 0});
    CHECK(light.occlusion_range().max == 1);
  }
}

TEST_CASE("the edge of a spotlight's cone is lit, unless the light fades") {
  // The cosines of 90° and of a direction at a right angle to the axis are exactly 0.
  const auto at_edge = [](double fade) {
    return lit(SpotLight{
        .position = {0, 2, 0}, .direction = {1, 0, 0}, .angle = 90, .power = Color{four_pi}, .fade = fade});
  };
  CHECK(near(at_edge(0), 0.25));
  CHECK(at_edge(10) == 0);
}

TEST_CASE("a light behind a surface, in its plane or at the point itself gives no irradiance") {
  for (const Point& position : {Point{0, -1, 0}, Point{3, -1e-9, 0}, Point{1, 0, 1}, Point{0, 0, 0}}) {
    CHECK(lit(PointLight{position, Color{1}}) == 0);
    CHECK(lit(ConstantLight{position, Color{1}}) == 0);
    CHECK(lit(SpotLight{.position = position, .angle = 180, .power = Color{1}}) == 0);
    if (position != world_origin) CHECK(lit(DirectionalLight{position, Color{1}}) == 0);
  }
}

TEST_CASE("the irradiance very near a light is clamped so that sums stay finite") {
  const float most = std::numeric_limits<float>::max();
  for (const Color power : {Color{1, 0, 0.5f}, Color{most, 0, 0.5f * most}, Color{1e-30f, 0, 0.5e-30f}}) {
    const Light light = PointLight{.position = {0, 1e-100, 0}, .power = power};
    const Color brought = light.irradiance(world_origin, upwards);
    CHECK(near(double{brought.r}, double{std::min(power.r * 0x1p20f, 1.0f) * most_irradiance}));
    CHECK(brought.g == 0);
    CHECK(near(2 * double{brought.b}, double{brought.r}));
    CHECK(light.perpendicular_irradiance(world_origin) == brought);
  }
  // A directional light that is too bright is clamped as well, and a light without a color stays dark.
  CHECK(near(lit(DirectionalLight{.intensity = Color{most}}), double{most_irradiance}));
  CHECK(lit(PointLight{.position = {0, 1e-100, 0}}) == 0);
  float sum = 0;
  for (int i = 0; i < 1 << 20; ++i) sum += most_irradiance;
  CHECK(std::isfinite(sum));
}

TEST_CASE("lights of all kinds bring a finite irradiance to points as near as doubles tell") {
  for (const double distance : {0x1p-511, 0x1p-537, 0x1p-538, 0x1p-600, 0x1p-1074}) {
    CAPTURE(distance);
    // The square of 2^-538 is 0: a surface that faces the light is dark, and any other as if it faced it.
    const double facing = distance < 0x1p-537 ? 0 : 1;
    for (const Point& at : {Point{0, distance, 0}, Point{distance, distance, 0}}) {
      const double most = double{most_irradiance};
      for (const Light& light :
           {Light(PointLight{at, Color{3}}),
            Light(SpotLight{.position = at, .direction = {0, -1, 0}, .angle = 60, .power = Color{3}})}) {
        CHECK(near(lit(light), most));
        CHECK(near(lit_facing(light), facing * most));
      }
      CHECK(near(lit_facing(ConstantLight{at, Color{3}}), facing * 3));
    }
  }
}

TEST_CASE("a sphere around a point light receives its power") {
  // The mean of E · 4πR² over the sphere is Φ, wherever in the sphere the light is: a property of the formula
  // that tests cosine and distance together.
  Random random(2);
  const Light light = PointLight{.position = {0.5, 0.3, -0.2}, .power = Color{7}};
  double sum = 0;
  constexpr int samples = 100000;
  constexpr double radius = 2;
  for (int i = 0; i < samples; ++i) {
    const Vec3 out = random.direction();
    sum += double{light.irradiance(radius * out, -out).r};
  }
  CHECK(std::abs(sum / samples * 4 * std::numbers::pi * radius * radius / 7 - 1) < 0.01);
}

TEST_CASE("an invalid light is refused with the field's name") {
  const std::string place = ": position must have numbers at most 2^400 (2.6e120) in magnitude";
  for (const double bad : {infinity, -infinity, not_a_number, 1e121}) {
    CHECK(refusal(PointLight{.position = {0, bad, 0}}) == "PointLight" + place);
    CHECK(refusal(ConstantLight{.position = {0, 0, bad}}) == "ConstantLight" + place);
    CHECK(refusal(SpotLight{.position = {bad, 0, 0}}) == "SpotLight" + place);
  }
  for (const double bad : {infinity, -infinity, not_a_number}) {
    CHECK(refusal(DirectionalLight{.direction = {0, bad, 0}}) ==
          "DirectionalLight: direction must be finite and not zero");
    CHECK(refusal(SpotLight{.direction = {0, bad, 0}}) == "SpotLight: direction must be finite and not zero");
  }
  CHECK(refusal(DirectionalLight{.direction = Vec3{0}}) ==
        "DirectionalLight: direction must be finite and not zero");
  CHECK(refusal(SpotLight{.direction = Vec3{0}}) == "SpotLight: direction must be finite and not zero");
  for (const double bad : {infinity, not_a_number, -1.0}) {
    const Color light{1, 1, static_cast<float>(bad)};
    CHECK(refusal(PointLight{.power = light}) == "PointLight: power must be finite and not negative");
    CHECK(refusal(SpotLight{.power = light}) == "SpotLight: power must be finite and not negative");
    CHECK(refusal(ConstantLight{.intensity = light}) ==
          "ConstantLight: intensity must be finite and not negative");
    CHECK(refusal(DirectionalLight{.intensity = light}) ==
          "DirectionalLight: intensity must be finite and not negative");
  }
  for (const double bad : {0.0, -1.0, 180.1, infinity, not_a_number})
    CHECK(refusal(SpotLight{.angle = bad}) == "SpotLight: angle must be above 0 and at most 180 degrees");
  for (const double bad : {-1.0, infinity, not_a_number})
    CHECK(refusal(SpotLight{.angle = 30, .fade = bad}) == "SpotLight: fade must be finite and not negative");
  // Dark lights are valid.
  CHECK(refusal(PointLight{}).empty());
  CHECK(refusal(ConstantLight{}).empty());
  CHECK(refusal(DirectionalLight{}).empty());
  CHECK(refusal(SpotLight{}).empty());
}

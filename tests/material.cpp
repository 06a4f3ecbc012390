#include <cmath>
#include <limits>
#include <memory>
#include <protostar/environment_image.hpp>
#include <protostar/material.hpp>
#include <protostar/shown.hpp>
#include <protostar/texture_image.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"

using namespace protostar;

namespace {

std::string refusal(const Material& material) {
  return message_of<std::invalid_argument>([&] { material.validate(); });
}
}  // namespace

TEST_CASE("a checker has its first color where 0 < u, v < size, and changes with every square") {
  const Color first{1, 0, 0}, second{0, 1, 0};
  struct {
    double size, u, v;
    bool is_first;
  } const rows[] = {
      {1, 0.5, 0.5, true},
      {1, 1.5, 0.5, false},
      {1, 0.5, 1.5, false},
      {1, 1.5, 1.5, true},
      {1, -0.5, 0.5, false},
      {1, 0.5, -0.5, false},
      {1, -0.5, -0.5, true},
      {1, -1.5, 0.5, true},
      {1, -7.5, -4.5, false},
      {2, 1.5, 1.5, true},
      {2, 2.5, 1.5, false},
      {0.25, 0.3, 0.1, false},
      // A line between two squares belongs to the square on its greater side.
      {1, 0, 0, true},
      {1, 1, 0, false},
      {1, 0, -1, false},
      {1, -1, -1, true},
      {1, -0.0, 0, true},
      {1, -1e-300, 0.5, false},
      {1, 1 - 0x1p-53, 0.5, true},
      // Beyond the range of integers.
      {1, 0x1p52 + 1, 0.5, false},
      {1, -0x1p52 - 1, 0.5, false},
      {1, -0x1p52, 0.5, true},
      {1, 0x1p80, 0.5, true},
      {1, 1e300, 1e300, true},
      {1e-300, 1e-299, 0, true},
      {1e300, 1e299, -1e299, false},
  };
  for (const auto& row : rows) {
    CAPTURE(row.size, row.u, row.v);
    const Checker checker{first, second, row.size};
    CHECK(checker(row.u, row.v) == (row.is_first ? first : second));
    CHECK(checker(row.v, row.u) == checker(row.u, row.v));
    CHECK(Texture(checker)(row.u, row.v) == checker(row.u, row.v));
  }
}

TEST_CASE("an invalid material is refused with the field's name") {
  for (const double bad : {-1.0, infinity, not_a_number}) {
    CAPTURE(bad);
    const Color light{0.5f, static_cast<float>(bad), 0};
    const std::string of_light = "; it is (0.5, " + shown(bad) + ", 0)", of_number = "; it is " + shown(bad);
    CHECK(refusal({.diffuse = light}) ==
          "Material: diffuse color must be finite and not negative" + of_light);
    CHECK(refusal({.specular = light}) ==
          "Material: specular color must be finite and not negative" + of_light);
    CHECK(refusal({.emission = light}) == "Material: emission must be finite and not negative" + of_light);
    CHECK(refusal({.glossy = light}) == "Material: glossy color must be finite and not negative" + of_light);
    CHECK(refusal({.roughness = bad}) == "Material: roughness must be from 0 to 1" + of_number);
    CHECK(refusal({.shininess = bad}) == "Material: shininess must be finite and not negative" + of_number);
    CHECK(refusal({.reflect = bad}) ==
          "Material: reflect must be finite as a float and not negative" + of_number);
    CHECK(refusal({.refract = bad}) ==
          "Material: refract must be finite as a float and not negative" + of_number);
    CHECK(refusal({.ior = bad}) ==
          "Material: ior must be from 2^-400 (3.9e-121) to 2^400 (2.6e120)" + of_number);
  }
  CHECK(refusal({.reflect = 1e39}) ==
        "Material: reflect must be finite as a float and not negative; it is 1e+39");
  CHECK(refusal({.refract = 1e39}) ==
        "Material: refract must be finite as a float and not negative; it is 1e+39");
  for (const double bad : {0.0, 0x1p-401, 1e121})
    CHECK(refusal({.ior = bad}) ==
          "Material: ior must be from 2^-400 (3.9e-121) to 2^400 (2.6e120); it is " + shown(bad));
  CHECK(refusal({.roughness = 1.5}) == "Material: roughness must be from 0 to 1; it is 1.5");
  CHECK(refusal({.roughness = std::nextafter(1, 2)}) ==
        "Material: roughness must be from 0 to 1; it is 1.0000000000000002");
  CHECK(refusal({.shininess = 0x1p30, .blur = Blur::phong}).empty());
  CHECK(refusal({.shininess = 0x1p31}).empty());
  CHECK(refusal({.shininess = 0x1p31, .blur = Blur::phong}) ==
        "Material: shininess of a blurred mirror must be at most 2^30; it is 2147483648");
  CHECK(refusal({.roughness = 0}).empty());
  CHECK(refusal({.roughness = 1}).empty());
  CHECK(refusal({}).empty());
  CHECK(refusal({.diffuse = Color{9},
                 .specular = Color{16},
                 .shininess = 0,
                 .reflect = 2,
                 .refract = 3,
                 .emission = Color{7},
                 .glossy = Color{2}})
            .empty());
}

TEST_CASE("an invalid checker is refused as a part of its material") {
  for (const double bad : {0.0, -1.0, 0x1p-401, 1e121, infinity, not_a_number})
    CHECK(refusal({.texture = Checker{.size = bad}}) ==
          "Checker: size must be from 2^-400 (3.9e-121) to 2^400 (2.6e120); it is " + shown(bad));
  for (const double bad : {-1.0, infinity, not_a_number}) {
    const Color light{0.5f, static_cast<float>(bad), 0};
    const std::string rule = " color must be finite and not negative; it is (0.5, " + shown(bad) + ", 0)";
    CHECK(refusal({.texture = Checker{.first = light}}) == "Checker: first" + rule);
    CHECK(refusal({.texture = Checker{.second = light}}) == "Checker: second" + rule);
  }
  CHECK(refusal({.texture = Checker{.first = Color{9}, .size = 0x1p-400}}).empty());
}

TEST_CASE("a texture, a normal map and an environment of an image have one") {
  STATIC_REQUIRE_FALSE(std::is_default_constructible_v<ImageTexture>);
  STATIC_REQUIRE_FALSE(std::is_default_constructible_v<ImageNormalMap>);
  STATIC_REQUIRE_FALSE(std::is_default_constructible_v<EnvironmentImage>);
  const std::shared_ptr<Image> none;
  const auto refused = [](const auto& make) { return message_of<std::invalid_argument>(make); };
  const std::string message = "SharedImage: the pointer to an image must not be null";
  CHECK(refused([&] { static_cast<void>(ImageTexture{none}); }) == message);
  CHECK(refused([&] { static_cast<void>(ImageNormalMap{{nullptr}}); }) == message);
  CHECK(refused([&] { static_cast<void>(EnvironmentImage{.image = none}); }) == message);

  ImageTexture texture{std::make_shared<Image>(1, 1)};
  const ImageTexture taken = std::move(texture);  // copies the pointer
  CHECK(texture(0.5, 0.5) == taken(0.5, 0.5));
  CHECK(refused([&] { texture.image = none; }) == message);
  CHECK(texture(0.5, 0.5) == Color{0});
}

#include <cmath>
#include <limits>
#include <protostar/tone.hpp>
#include <stdexcept>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/pictures.hpp"
#include "support/test_image.hpp"

using namespace protostar;

namespace {
Image row_of(const std::vector<Color>& colors) {
  Image image(static_cast<int>(colors.size()), 1);
  for (int x = 0; x < image.width(); ++x) image(x, 0) = colors[static_cast<std::size_t>(x)];
  return image;
}

void check_tone(Tone tone, const std::vector<Color>& before, const std::vector<Color>& after) {
  Image image = row_of(before);
  apply(tone, image);
  const Image expected = row_of(after);
  for (int x = 0; x < image.width(); ++x) {
    CAPTURE(x);
    CHECK(image(x, 0) == expected(x, 0));
  }
}
}  // namespace

TEST_CASE("the tone clip leaves the light unchanged") {
  const std::vector<Color> light{{0, 0, 0}, {0.5f, 1, 4}, {16, 0, 0}};
  check_tone(Tone::clip, light, light);
}

TEST_CASE("scale-pixel divides a pixel by its largest channel, if that is above 1") {
  check_tone(Tone::scale_pixel,
             {{0, 0, 0}, {0.5f, 0.25f, 0}, {0.5f, 1, 0.25f}, {0.5f, 1, 4}, {16, 8, 0}, {2, 2, 2}},
             {{0, 0, 0}, {0.5f, 0.25f, 0}, {0.5f, 1, 0.25f}, {0.125f, 0.25f, 1}, {1, 0.5f, 0}, {1, 1, 1}});
}

TEST_CASE("scale-image divides all pixels by the largest channel of the image") {
  check_tone(Tone::scale_image, {{0, 0, 0}, {0.5f, 1, 0.25f}, {0.5f, 1, 4}},
             {{0, 0, 0}, {0.125f, 0.25f, 0.0625f}, {0.125f, 0.25f, 1}});
  check_tone(Tone::scale_image, {{0, 0.25f, 0}, {0.125f, 0, 0}}, {{0, 1, 0}, {0.5f, 0, 0}});
  check_tone(Tone::scale_image, {{0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}});
}

TEST_CASE("infinite light is scaled like the largest float") {
  const float infinite = std::numeric_limits<float>::infinity(), most = std::numeric_limits<float>::max();
  for (const Tone tone : {Tone::scale_pixel, Tone::scale_image}) {
    Image image(1, 1);
    image(0, 0) = {infinite, 0.5f * most, 0};
    apply(tone, image);
    CHECK(image(0, 0) == Color{1, 0.5f, 0});
  }
}

TEST_CASE("a channel that is NaN stays one, and hides no other channel") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Tone tone : {Tone::scale_pixel, Tone::scale_image}) {
    Image image = row_of({{nan, 4, 2}, {1, nan, 4}, {2, 4, nan}, {nan, nan, nan}});
    apply(tone, image);
    CHECK(image(0, 0).g == 1);
    CHECK(image(0, 0).b == 0.5f);
    CHECK(image(1, 0).r == 0.25f);
    CHECK(image(1, 0).b == 1);
    CHECK(image(2, 0).r == 0.5f);
    CHECK(image(2, 0).g == 1);
    CHECK(std::isnan(image(2, 0).b));
    CHECK(std::isnan(image(3, 0).r));
  }
}

TEST_CASE("a tone is applied to every pixel") {
  for (const Tone tone : {Tone::scale_pixel, Tone::scale_image}) {
    Image image(7, 5);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x) image(x, y) = Color{static_cast<float>(x + 7 * y + 2)};
    apply(tone, image);
    const float most = 7 * 5 + 1;
    CHECK(count_pixels(image, [&](int x, int y) {
            return image(x, y) !=
                   Color{tone == Tone::scale_pixel ? 1.0f : static_cast<float>(x + 7 * y + 2) / most};
          }) == 0);
  }
}

TEST_CASE("exposure is a factor on all light") {
  Image image = random_image(7, 5, 3);
  const Image before = image;
  expose(image, 1);
  CHECK(different_pixels(image, before) == 0);
  expose(image, 2.5);
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) != 2.5f * before(x, y); }) == 0);
  image(0, 0) = Color{std::numeric_limits<float>::infinity()};
  expose(image, 1e-60);  // 0 as a float
  CHECK(image(0, 0) == Color{0});
  expose(image, 0);
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; }) == 0);
}

TEST_CASE("an exposure that is negative or beyond float is refused, and leaves the image unchanged") {
  Image image = random_image(7, 5, 3);
  const Image before = image;
  const double inf = std::numeric_limits<double>::infinity();
  struct {
    double exposure;
    const char* found;
  } const rows[] = {
      {-1, "it is -1"},   {-1e-60, "it is -1e-60"}, {1e39, "it is 1e+39"},  // infinity as a float
      {inf, "it is inf"}, {-inf, "it is -inf"},     {std::numeric_limits<double>::quiet_NaN(), "nan"}};
  for (const auto& row : rows)
    CHECK_THAT(message_of<std::invalid_argument>([&] { expose(image, row.exposure); }),
               ContainsSubstring("expose: exposure must be from 0 to 3.4e38, the largest float; ") &&
                   ContainsSubstring(row.found));
  CHECK(different_pixels(image, before) == 0);
  CHECK_NOTHROW(expose(image, std::numeric_limits<float>::max()));
}

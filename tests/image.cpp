#include <climits>
#include <protostar/image.hpp>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "support/catch.hpp"
#include "support/errors.hpp"

using namespace protostar;

TEST_CASE("a new image is black") {
  const Image image(3, 2);
  CHECK(image.width() == 3);
  CHECK(image.height() == 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) CHECK(image(x, y) == Color{0});
}

TEST_CASE("image(x, y) is the color of one pixel, with rows from the top") {
  Image image(3, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) image(x, y) = Color{static_cast<float>(10 * y + x)};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) CHECK(image(x, y) == Color{static_cast<float>(10 * y + x)});
  CHECK(&image(2, 0) - &image(0, 0) == 2);
  CHECK(&image(0, 1) - &image(0, 0) == 3);
}

TEST_CASE("a const image can only be read, and a copy is independent") {
  static_assert(std::is_same_v<decltype(std::declval<Image&>()(0, 0)), Color&>);
  static_assert(std::is_same_v<decltype(std::declval<const Image&>()(0, 0)), const Color&>);
  Image image(1, 1);
  const Image copy = image;
  image(0, 0) = Color{1};
  CHECK(copy(0, 0) == Color{0});
}

TEST_CASE("an image size below 1, or above 2^28 pixels, is refused before memory is allocated") {
  struct {
    int width, height;
  } const rows[] = {{0, 1},
                    {1, 0},
                    {-1, 1},
                    {1, -1},
                    {-3, -3},
                    {INT_MIN, INT_MIN},
                    {1 << 28, 2},
                    {1 << 14, (1 << 14) + 1},
                    {INT_MAX, 1},
                    {1, INT_MAX},
                    {INT_MAX, INT_MAX}};
  for (const auto& row : rows) {
    // If memory were requested first, std::length_error or std::bad_alloc would be thrown instead.
    const std::string message = message_of<std::invalid_argument>([&] { Image(row.width, row.height); });
    CHECK_THAT(message,
               ContainsSubstring("Image: " + std::to_string(row.width) + "x" + std::to_string(row.height)));
    CHECK_THAT(message, ContainsSubstring("2^28"));
  }
}

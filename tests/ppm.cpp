#include <limits>
#include <protostar/ppm.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/random.hpp"
#include "support/test_image.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using namespace std::string_literals;

namespace {
/// Returns an image of red, green / blue, and a mixture of black, half and more than white.
Image four_pixels() {
  Image image(2, 2);
  image(0, 0) = {1, 0, 0};
  image(1, 0) = {0, 1, 0};
  image(0, 1) = {0, 0, 1};
  image(1, 1) = {0, 0.5f, 7};
  return image;
}

std::string saved(const Image& image, const Transfer& transfer, const PpmOptions& options) {
  const TemporaryFolder folder;
  save_ppm(image, folder / "a.ppm", transfer, options);
  CHECK(folder.count() == 1);
  return bytes_of(folder / "a.ppm");
}

/// Reads the numbers of a file's pixels back and counts those that are not the encoder's.
WrongCases wrong_codes(const Image& image, const Transfer& transfer, const PpmOptions& options) {
  const std::string bytes = saved(image, transfer, options);
  std::istringstream file(bytes);
  std::string magic;
  int width = 0, height = 0, max_code = 0;
  file >> magic >> width >> height >> max_code;
  CHECK(magic == (options.plain ? "P3" : "P6"));
  CHECK(width == image.width());
  CHECK(height == image.height());
  CHECK(max_code == (options.bits == 8 ? 255 : 65535));
  CHECK(file.get() == '\n');
  const Encoder encode(transfer, max_code);
  const auto next = [&] {
    int code = -1;
    if (options.plain)
      file >> code;
    else if (options.bits == 8)
      code = file.get();
    else
      code = file.get() * 256, code += file.get();  // the most significant byte first
    return code;
  };
  WrongCases wrong;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        const int code = next();
        wrong.add(code != encode(image(x, y)[channel]), "pixel", x, y, image(x, y), "channel", channel,
                  "has code", code);
      }
  if (options.plain) file >> std::ws;
  CHECK(file.peek() == std::istringstream::traits_type::eof());
  return wrong;
}
}  // namespace

TEST_CASE("a binary PPM is its header and three bytes for each pixel, rows from the top") {
  CHECK(saved(four_pixels(), Linear{}, {}) ==
        "P6\n2 2\n255\n"
        "\xff\x00\x00\x00\xff\x00"
        "\x00\x00\xff\x00\x80\xff"s);
}

TEST_CASE("a plain PPM has the tutorial's layout") {
  CHECK(saved(four_pixels(), Linear{}, {.plain = true}) ==
        "P3\n2 2\n255\n"
        "255\t0\t0\t\t0\t255\t0\t\t\n"
        "0\t0\t255\t\t0\t128\t255\t\t\n");
}

TEST_CASE("a PPM of 16 bits has the most significant byte first") {
  CHECK(saved(four_pixels(), Linear{}, {.bits = 16}) ==
        "P6\n2 2\n65535\n"
        "\xff\xff\x00\x00\x00\x00\x00\x00\xff\xff\x00\x00"
        "\x00\x00\x00\x00\xff\xff\x00\x00\x80\x00\xff\xff"s);
  CHECK(saved(four_pixels(), Linear{}, {.bits = 16, .plain = true}) ==
        "P3\n2 2\n65535\n"
        "65535\t0\t0\t\t0\t65535\t0\t\t\n"
        "0\t0\t65535\t\t0\t32768\t65535\t\t\n");
}

TEST_CASE("a PPM is encoded with the given transfer, by default sRGB") {
  Image image(1, 1);
  image(0, 0) = {0.5f, 0.18f, 0.002f};
  CHECK(saved(image, Gamma{2.2}, {.plain = true}) == "P3\n1 1\n255\n186\t117\t15\t\t\n");
  CHECK(saved(image, Srgb{}, {.plain = true}) == "P3\n1 1\n255\n188\t118\t7\t\t\n");
  const TemporaryFolder folder;
  save_ppm(image, folder / "a.ppm");
  CHECK(bytes_of(folder / "a.ppm") == "P6\n1 1\n255\n\xbc\x76\x07");
}

TEST_CASE("every code of a PPM equals the encoder's, for images of any shape") {
  struct {
    int width, height;
  } const sizes[] = {{1, 1}, {1, 300}, {300, 1}, {31, 17}, {4095, 2}, {4096, 2}, {4097, 2}, {9000, 1}};
  std::uint64_t seed = 15;
  for (const auto& size : sizes)
    for (const int bits : {8, 16})
      for (const bool plain : {false, true}) {
        CAPTURE(size.width, size.height, bits, plain);
        CHECK(wrong_codes(random_image(size.width, size.height, ++seed), Srgb{}, {bits, plain, {}}) == 0);
      }
}

TEST_CASE("a row of the longest codes is written whole") {
  for (const int width : {4095, 4096, 4097, 8192}) {
    Image white(width, 1);
    for (int x = 0; x < width; ++x) white(x, 0) = Color{1};
    CAPTURE(width);
    CHECK(wrong_codes(white, Linear{}, {.bits = 16, .plain = true}) == 0);
  }
}

TEST_CASE("invalid light is written as 0, and light above 1 as the maximum") {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  Image image(2, 1);
  image(0, 0) = {nan, -1, -inf};
  image(1, 0) = {inf, 1.0001f, -0.0f};
  CHECK(saved(image, Srgb{}, {.plain = true}) == "P3\n2 1\n255\n0\t0\t0\t\t255\t255\t0\t\t\n");
}

TEST_CASE("invalid PPM options are refused and leave the old file unchanged") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.ppm", "old");
  const Image image(1, 1);
  for (const int bits : {0, 1, 12, -8, 32})
    CHECK_THAT(
        message_of<std::invalid_argument>([&] { save_ppm(image, folder / "a.ppm", Srgb{}, {.bits = bits}); }),
        ContainsSubstring("save_ppm: bits"));
  CHECK_THAT(message_of<std::invalid_argument>([&] { save_ppm(image, folder / "a.ppm", Gamma{0}); }),
             ContainsSubstring("Encoder: gamma must be finite"));
  CHECK(bytes_of(folder / "a.ppm") == "old");
  CHECK(folder.count() == 1);
}

TEST_CASE("rows that repeat the row above are written like all others") {
  const TemporaryFolder folder;
  Image image(7, 9);
  Random random(5);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 7; ++x)
      image(x, y) = y % 3 != 0 ? image(x, y - 1) : y == 6 ? Color{0.5f} : random.color();
  image(6, 8).b += 0.25f;  // a row that nearly repeats
  for (const bool plain : {false, true})
    for (const int bits : {8, 16}) {
      save_ppm(image, folder / "a.ppm", Srgb{}, {.bits = bits, .plain = plain});
      save_ppm(image, folder / "b.ppm", Srgb{}, {.bits = bits, .plain = plain, .repeat_rows = false});
      CHECK(bytes_of(folder / "a.ppm") == bytes_of(folder / "b.ppm"));
    }
}

TEST_CASE("stopping save_ppm leaves the old file unchanged") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.ppm", "old");
  save_ppm(Image(100, 100), folder / "a.ppm", Srgb{}, {.stop = [] { return true; }});
  CHECK(bytes_of(folder / "a.ppm") == "old");
  CHECK(folder.count() == 1);
}

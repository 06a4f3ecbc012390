#if __has_include(<stb_image_write.h>)  // protostar::png is optional

#include <protostar/io/hdr.hpp>
#include <protostar/io/image_texture.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/test_image.hpp"

using namespace protostar;

namespace {
Image saved_and_loaded(const Image& image) {
  const TemporaryFolder folder;
  save_hdr(image, folder / "a.hdr");
  CHECK(folder.count() == 1);
  return load_image(folder / "a.hdr");
}
}  // namespace

TEST_CASE("an HDR file has a header with its format, and its size") {
  const TemporaryFolder folder;
  save_hdr(Image(3, 2), folder / "a.hdr");
  const std::string bytes = bytes_of(folder / "a.hdr");
  CHECK(bytes.starts_with("#?RADIANCE\n"));
  CHECK_THAT(bytes, ContainsSubstring("FORMAT=32-bit_rle_rgbe\n"));
  CHECK((bytes.ends_with("\n\n-Y 2 +X 3\n" + std::string(4 * 6, '\0'))));
}

TEST_CASE("light in an HDR file is rounded to eight bits of the largest channel") {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const float most = 255 * 0x1p119f;
  struct {
    Color light, kept;
  } const rows[] = {
      {{0, 0, 0}, {0, 0, 0}},
      {{1, 0.5f, 0.25f}, {1, 0.5f, 0.25f}},
      {{255, 128, 1}, {255, 128, 1}},
      {{255, 127.4f, 0.6f}, {255, 127, 1}},
      {{255.4f, 0.4f, 2.5f}, {255, 0, 3}},
      {{255.6f, 3, 5.1f}, {256, 4, 6}},  // the largest takes another bit, so the others lose one
      {{1e4f, 1, 40}, {9984, 0, 64}},    // in steps of 64
      {{0x1p-100f, 0, 0x1p-101f}, {0x1p-100f, 0, 0x1p-101f}},
      {{0.9e-32f, 0, 0}, {0, 0, 0}},
      {{-1, 2, nan}, {0, 2, 0}},
      {{inf, 1, 0x1p126f}, {most, 0, 0x1p126f}},
      {{std::numeric_limits<float>::max(), 0, 0}, {most, 0, 0}},
  };
  Image image(static_cast<int>(std::size(rows)), 1);
  for (int x = 0; x < image.width(); ++x) image(x, 0) = rows[x].light;
  const Image loaded = saved_and_loaded(image);
  REQUIRE(loaded.width() == image.width());
  for (int x = 0; x < image.width(); ++x) {
    CAPTURE(x, loaded(x, 0).r, loaded(x, 0).g, loaded(x, 0).b);
    CHECK(loaded(x, 0) == rows[x].kept);
  }
}

TEST_CASE("every pixel of an HDR file is within 1/256 of its largest channel, for images of any shape") {
  struct {
    int width, height;
  } const sizes[] = {{1, 1}, {7, 3}, {8, 3}, {129, 70}, {32767, 1}, {32768, 2}};  // with and without runs
  for (const auto& size : sizes) {
    CAPTURE(size.width, size.height);
    Random random(5);
    Image image(size.width, size.height);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        image(x, y) = x % 16 < 8 ? Color{1, 2, 3}
                                 : static_cast<float>(std::exp2(random.real(-60, 60))) * random.color();
    const Image loaded = saved_and_loaded(image);
    REQUIRE(loaded.width() == size.width);
    REQUIRE(loaded.height() == size.height);
    CHECK(count_pixels(image, [&](int x, int y) {
            const Color a = image(x, y), error = abs(a - loaded(x, y));
            return std::max({error.r, error.g, error.b}) > std::max({a.r, a.g, a.b}) / 256;
          }) == 0);
    CHECK(different_pixels(saved_and_loaded(loaded), loaded) == 0);
  }
}

TEST_CASE("a truncated HDR file is refused, flat or run-length coded") {
  const TemporaryFolder folder;
  for (const std::string name :
       {"tests/fuzz/corpus_image/flat.hdr", "tests/fuzz/corpus_image/narrow.hdr",
        "tests/fuzz/corpus_image/runs.hdr", "tests/fuzz/pool/b.hdr", "scenes/dusk.hdr"}) {
    const std::string bytes = bytes_of(std::string(PROTOSTAR_SOURCE_DIR) + "/" + name);
    CHECK(load_image(std::string(PROTOSTAR_SOURCE_DIR) + "/" + name).width() > 0);
    const std::size_t most_prefixes = 200;
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / most_prefixes) {
      CAPTURE(name, size);
      put_bytes(folder / "a.hdr", bytes.substr(0, size));
      CHECK_THAT(message_of<std::runtime_error>([&] { static_cast<void>(load_image(folder / "a.hdr")); }),
                 ContainsSubstring("a.hdr': "));
    }
  }
}

TEST_CASE("an error in an HDR file is reported with its place, what was found and what is allowed") {
  const std::string start = "#?RADIANCE\n", format = "FORMAT=32-bit_rle_rgbe\n", size = "\n-Y 2 +X 8\n";
  const std::string line = std::string("\2\2\0\x08", 4) + "\x88\x80\x88\x40\x88\x20\x88\x81";  // one color
  struct {
    std::string bytes, error;
  } const rows[] = {
      {start, "the file ends after 11 bytes, inside of the header"},
      {start + size + line + line, "there is no line FORMAT=32-bit_rle_rgbe in the header"},
      {start + "FORMAT=32-bit_rle_xyze\n" + size, "\"FORMAT=32-bit_rle_xyze\" is not FORMAT=32-bit_rle_rgbe"},
      {start + format + "\n+X 8 -Y 2\n", "\"+X 8 -Y 2\" is not a size, -Y HEIGHT +X WIDTH"},
      {start + format + "\n-Y 2 +X 8 9\n", "\"-Y 2 +X 8 9\" is not a size, -Y HEIGHT +X WIDTH"},
      {start + format + "\n-Y 99999999999 +X 8\n", "\"-Y 99999999999 +X 8\" is not a size"},
      {start + format + "\n-Y 0 +X 8\n", "the picture has 8x0 pixels; allowed are sides of at least 1"},
      {start + format + "\n-Y -2 +X 8\n", "the picture has 8x-2 pixels"},
      {start + format + "\n-Y 10000 +X 10000\n",
       "the picture has 10000x10000 pixels; allowed are sides of at least 1 and at most 67108864 pixels"},
      {start + format + "\n-Y 100 +X 7\n",
       "there are 0 bytes of pixels; a picture of this size takes 2800 or more"},
      {start + format + size + line, "there are 12 bytes of pixels; a picture of this size takes 24 or more"},
      {start + format + size + line + line.substr(0, 4) + "\x81\x80\x81\x80\x81\x80\x81\x80",
       "the file ends after 69 bytes, inside of scanline 1 of 2"},
      {start + format + size + line + std::string("\2\2\0\x09", 4) + line.substr(4),
       "scanline 1 of 2 has 9 pixels; the picture is 8 wide"},
      {start + format + size + line + line.substr(0, 4) + '\0' + line.substr(5),
       "scanline 1 of 2 has a run of 0 pixels at byte 61; allowed are 1 to 8"},
      {start + format + size + line + line.substr(0, 4) + "\x89" + line.substr(5),
       "scanline 1 of 2 has a run of 9 pixels at byte 61; allowed are 1 to 8"},
      {start + format + size + line + "\1\1\1\7" + std::string(28, '\x80'),
       "scanline 1 of 2 has a repeated pixel (1, 1, 1, n), the old form of a run, which is not read"},
  };
  const TemporaryFolder folder;
  for (const auto& row : rows) {
    put_bytes(folder / "a.hdr", row.bytes);
    CAPTURE(row.error);
    CHECK_THAT(message_of<std::runtime_error>([&] { static_cast<void>(load_image(folder / "a.hdr")); }),
               ContainsSubstring("cannot read '" + (folder / "a.hdr").string() + "': " + row.error));
  }
  put_bytes(folder / "a.hdr", start + format + size + line + std::string(8, '\x80') + line + line);
  const Image mixed = load_image(folder / "a.hdr");  // a flat scanline next to a run-length coded one
  CHECK(mixed(0, 0) == Color{1, 0.5f, 0.25f});
  CHECK(mixed(0, 1) == Color{0.5f, 0.5f, 0.5f});
}

TEST_CASE("all light that an HDR file can hold is finite") {
  std::string bytes = "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 256 +X 2\n";
  for (int e = 0; e < 256; ++e)
    bytes += std::string("\xff\x01\x02") + static_cast<char>(e) + "\2\1\1" + static_cast<char>(e);
  const Image image = image_from_bytes(bytes, "a.hdr");
  for (int e = 1; e < 256; ++e) {
    CHECK(image(0, e) ==
          Color{std::ldexp(255.0f, e - 136), std::ldexp(1.0f, e - 136), std::ldexp(2.0f, e - 136)});
    CHECK(std::isfinite(image(0, e).r));
  }
  CHECK(image(0, 0) == Color{0});
}

TEST_CASE("saving an HDR file leaves the old file unchanged if it is stopped or fails") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.hdr", "old");
  save_hdr(Image(8, 8), folder / "a.hdr", [] { return true; });
  CHECK_THAT(message_of<std::system_error>([&] { save_hdr(Image(1, 1), folder / "none/a.hdr"); }),
             ContainsSubstring("none/a.hdr"));
  CHECK(bytes_of(folder / "a.hdr") == "old");
  CHECK(folder.count() == 1);
}

#endif

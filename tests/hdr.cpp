#if __has_include(<stb_image_write.h>)  // protostar::png is optional

#include <protostar/io/hdr.hpp>
#include <protostar/io/image_texture.hpp>

#include <cmath>
#include <limits>
#include <stop_token>
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

TEST_CASE("an HDR file says what it is, and of what size") {
  const TemporaryFolder folder;
  save_hdr(Image(3, 2), folder / "a.hdr");
  const std::string bytes = bytes_of(folder / "a.hdr");
  CHECK(bytes.starts_with("#?RADIANCE\n"));
  CHECK_THAT(bytes, ContainsSubstring("FORMAT=32-bit_rle_rgbe\n"));
  CHECK((bytes.ends_with("\n\n-Y 2 +X 3\n" + std::string(4 * 6, '\0'))));
}

TEST_CASE("light in an HDR file is the nearest that eight bits of the largest channel give") {
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
      {{255.6f, 3, 5.1f}, {256, 4, 6}},  // the largest takes another bit, and so the others lose one
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

TEST_CASE("every pixel of an HDR file is the image's to 1/256 of its largest channel, in any shape") {
  struct {
    int width, height;
  } const sizes[] = {{1, 1}, {7, 3}, {8, 3}, {129, 70}, {32767, 1}, {32768, 2}};  // with runs and without
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

TEST_CASE("an HDR file that is stopped or cannot be written leaves the old one as it was") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.hdr", "old");
  std::stop_source source;
  source.request_stop();
  save_hdr(Image(8, 8), folder / "a.hdr", source.get_token());
  CHECK_THAT(message_of<std::system_error>([&] { save_hdr(Image(1, 1), folder / "none/a.hdr"); }),
             ContainsSubstring("none/a.hdr"));
  CHECK(bytes_of(folder / "a.hdr") == "old");
  CHECK(folder.count() == 1);
}

#endif

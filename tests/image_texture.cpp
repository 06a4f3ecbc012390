#if __has_include(<stb_image.h>)  // protostar::png is optional

#include <protostar/io/hdr.hpp>
#include <protostar/io/image_texture.hpp>
#include <protostar/io/png.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/pictures.hpp"

using namespace protostar;

namespace {
/// A picture whose pixels are all different: codes of 1 to 6 of 255.
Image six_pixels() {
  Image image(3, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) image(x, y) = Color{static_cast<float>(1 + x + 3 * y)} / 255.0f;
  return image;
}
}  // namespace

TEST_CASE("a texture repeats, and has its picture's left edge at u = 0 and the top row at v = 0") {
  const TemporaryFolder folder;
  save_hdr(six_pixels(), folder / "a.hdr");
  const Image pixels = load_image(folder / "a.hdr");
  struct {
    double u, v;
    int x, y;
  } const rows[] = {
      {0, 0, 0, 0},       {0.1, 0.1, 0, 0},   {0.4, 0.1, 1, 0}, {0.9, 0.4, 2, 0},
      {0.1, 0.6, 0, 1},   {0.9, 0.9, 2, 1},   {1, 1, 0, 0},     {1.4, 0.1, 1, 0},
      {-0.1, 0.1, 2, 0},  {-0.1, -0.1, 2, 1}, {-1, -2, 0, 0},   {1e6 + 0.4, 7, 1, 0},
      {-1e-300, 0, 2, 0}, {0, -1e-300, 0, 1}, {1e300, 0, 0, 0}, {1 - 0x1p-53, 0, 2, 0},
      {0, 0.5, 0, 1},
  };
  for (const auto& row : rows) {
    CAPTURE(row.u, row.v);
    CHECK(image_texture(folder / "a.hdr")(row.u, row.v) == pixels(row.x, row.y));
    CHECK(image_texture(folder / "a.hdr", 4, 0.5)(4 * row.u, row.v / 2) == pixels(row.x, row.y));
  }
  const Texture texture = image_texture(folder / "a.hdr");
  for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    CHECK(texture(bad, bad) == pixels(0, 0));
}

TEST_CASE("a PNG's codes are decoded from sRGB") {
  Image image(256, 1);
  for (int x = 0; x < 256; ++x) {
    const float code = static_cast<float>(x) / 255;
    image(x, 0) = {code, 1 - code, 0.5f};
  }
  const TemporaryFolder folder;
  save_png(image, folder / "a.png", Linear{});
  const Image loaded = load_image(folder / "a.png");
  REQUIRE(loaded.width() == 256);
  REQUIRE(loaded.height() == 1);
  for (int x = 0; x < 256; ++x) {
    const double code = x / 255.0;
    const double light = code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
    CHECK(std::abs(loaded(x, 0).r - light) < 1e-6 * light + 1e-12);
    CHECK(loaded(x, 0).g == loaded(255 - x, 0).r);
    CHECK(loaded(x, 0).b == loaded(128, 0).r);
  }
  // What is saved as sRGB comes back with the same codes.
  save_png(loaded, folder / "b.png", Srgb{});
  CHECK(different_pixels(load_image(folder / "b.png"), loaded) == 0);
}

TEST_CASE("a JPEG is decoded as well, and a file is what its first bytes say") {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.hdr").string();  // whatever its name
  const unsigned char gray[3 * 64 * 64] = {};
  REQUIRE(stbi_write_jpg(path.c_str(), 64, 64, 3, gray, 90));
  const Image loaded = load_image(path);
  CHECK(loaded.width() == 64);
  CHECK(loaded.height() == 64);
  CHECK(loaded(5, 50) == Color{0});
}

TEST_CASE("a picture that cannot be read is named, with the reason") {
  const TemporaryFolder folder;
  put_bytes(folder / "empty.png", "");
  put_bytes(folder / "words.jpg", "no picture at all");
  save_png(six_pixels(), folder / "a.png");
  save_hdr(six_pixels(), folder / "a.hdr");
  const auto cut = [&](const std::string& name, const std::string& to) {
    const std::string bytes = bytes_of(folder / name);
    put_bytes(folder / to, bytes.substr(0, bytes.size() - 20));
  };
  cut("a.png", "cut.png");
  const auto error = [&](const std::string& name) {
    return message_of<std::runtime_error>([&] { static_cast<void>(image_texture(folder / name)); });
  };
  for (const std::string name : {"empty.png", "words.jpg", "cut.png"}) {
    CAPTURE(name, error(name));
    CHECK(error(name).starts_with("cannot read '" + (folder / name).string() + "': "));
  }
  CHECK_THAT(error("words.jpg"), ContainsSubstring("unknown image type"));
  CHECK_THAT(message_of<std::system_error>([&] { static_cast<void>(load_image(folder / "none.png")); }),
             ContainsSubstring("none.png': No such file"));
  CHECK(error("").starts_with("cannot read '"));  // a folder
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THAT(
        message_of<std::invalid_argument>([&] { static_cast<void>(image_texture(folder / "a.png", bad)); }),
        ContainsSubstring("image_texture: size_u and size_v"));
    CHECK_THAT(message_of<std::invalid_argument>(
                   [&] { static_cast<void>(image_texture(folder / "a.png", 1, bad)); }),
               ContainsSubstring("image_texture: size_u and size_v"));
  }
}

#endif

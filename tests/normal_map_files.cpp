#if __has_include(<stb_image.h>)  // protostar::png is optional

#include <protostar/encode.hpp>
#include <protostar/io/hdr.hpp>
#include <protostar/io/image_normal_map.hpp>
#include <protostar/io/png.hpp>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

using namespace protostar;

namespace {

/// Returns an image of one pixel to the right of a light blue one.
Image of_pixel(const Color& color) {
  Image image(2, 1);
  image(0, 0) = {0.5f, 0.5f, 1}, image(1, 0) = color;
  return image;
}

/// Returns the direction of the right pixel of a file's normal map.
Vec3 right_of(const NormalMap& map) { return map(0.75, 0.5); }

}  // namespace

TEST_CASE("a PNG of a normal map is read without a decoding of sRGB; no code of 8 bits is level") {
  const TemporaryFolder folder;
  const auto path = folder / "a.png";
  save_png(of_pixel({128 / 255.0f, 51 / 255.0f, 255 / 255.0f}), path, Linear{});
  const Vec3 direction = right_of(image_normal_map(path));
  // Twice the rounding of 128/255 and of 51/255 to float, 2^-25 and 2^-27.
  CHECK(std::abs(direction.x - 1 / 255.0) <= 0x1p-24);
  CHECK(std::abs(direction.y - (2 * 51 / 255.0 - 1)) <= 0x1p-26);
  CHECK(direction.z == 1);
  CHECK(direction.x > 0.0039);  // 127 is as much below ½ as 128 is above
}

TEST_CASE("an HDR of a normal map can be level, and is as large as asked for") {
  const TemporaryFolder folder;
  const auto path = folder / "a.hdr";
  save_hdr(of_pixel({0.75f, 0.5f, 1}), path);
  CHECK(image_normal_map(path)(0.25, 0.5) == Vec3{0, 0, 1});
  CHECK(right_of(image_normal_map(path)) == Vec3{0.5, 0, 1});
  const NormalMap wide = image_normal_map(path, 4, 2);
  CHECK(wide(1.9, 0) == Vec3{0, 0, 1});
  CHECK(wide(2.1, 1.9) == Vec3{0.5, 0, 1});
  CHECK_THROWS_AS(image_normal_map(path, 0, 1), std::invalid_argument);
}

TEST_CASE("a pixel whose normal does not lead out of the surface is named") {
  const TemporaryFolder folder;
  const auto path = folder / "a.hdr";
  for (const Color& color : {Color{0.5f, 0.5f, 0.5f}, Color{0.9f, 0.5f, 0.25f}, Color{0}}) {
    save_hdr(of_pixel(color), path);
    CHECK_THAT(
        message_of<std::runtime_error>([&] { static_cast<void>(image_normal_map(path)); }),
        ContainsSubstring("a.hdr' is no normal map: the blue of pixel 1,0, counted from 0 at the upper "
                          "left, is ") &&
            ContainsSubstring("allowed is above 0.5"));
  }
  save_hdr(of_pixel({0.5f, 0.5f, 0.51f}), path);
  CHECK(right_of(image_normal_map(path)).z > 0);
}

TEST_CASE("scenes/make_normal_map writes the bricks of the scenes") {
  const std::filesystem::path project = PROTOSTAR_SOURCE_DIR;
  const Outcome made =
      run({.program = project / "scenes/make_normal_map", .arguments = {}, .folder = project});
  if (made.status == 127) {  // exit status of env if it does not find python3
    WARN("not tested: python3 is not installed");
    return;
  }
  REQUIRE(made.status == 0);
  const Image image = image_from_bytes(made.out, "bricks.png"),
              stored = load_image(project / "scenes" / "bricks.png");
  REQUIRE((image.width() == stored.width() && image.height() == stored.height()));
  int different = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) different += image(x, y) != stored(x, y);
  CHECK(different == 0);
  const Outcome refused =
      run({.program = project / "scenes/make_normal_map", .arguments = {"64"}, .folder = project});
  CHECK(refused.status == 2);
  CHECK_THAT(refused.err, ContainsSubstring("usage"));
}

#endif

#if __has_include(<stb_image_write.h>)  // protostar::png is optional

#include <protostar/io/png.hpp>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <system_error>

#include "compare_images/read_image.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/test_image.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("a PNG starts with its signature and decodes to the encoder's codes") {
  for (const Transfer& transfer : {Transfer{Srgb{}}, Transfer{Linear{}}, Transfer{Gamma{2.2}}}) {
    const Image image = random_image(37, 23, 17);
    const TemporaryFolder folder;
    save_png(image, folder / "a.png", transfer);
    CHECK(folder.count() == 1);
    const std::string bytes = bytes_of(folder / "a.png");
    CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");

    CHECK(bytes[25] == 2);  // the header says: red, green and blue
    const Picture picture = read_image((folder / "a.png").string());
    REQUIRE(picture.width == 37);
    REQUIRE(picture.height == 23);
    const Encoder encode(transfer, 255);
    WrongCases wrong;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        for (int channel = 0; channel < 3; ++channel)
          wrong.add(picture.pixels[static_cast<std::size_t>(y * picture.width + x)]
                                  [static_cast<std::size_t>(channel)] != encode(image(x, y)[channel]),
                    y, x);
    CHECK(wrong == 0);
  }
}

TEST_CASE("a PNG that cannot be written is an error and leaves the old file unchanged") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.png", "old");
  CHECK_THAT(message_of<std::invalid_argument>([&] { save_png(Image(1, 1), folder / "a.png", Gamma{-1}); }),
             ContainsSubstring("Encoder: gamma must be finite"));
  CHECK_THAT(message_of<std::system_error>([&] { save_png(Image(1, 1), folder / "none/a.png"); }),
             ContainsSubstring("none/a.png"));
  CHECK(bytes_of(folder / "a.png") == "old");
  CHECK(folder.count() == 1);
}

TEST_CASE("a PNG may be as large as stb_image_write allows") {
  struct {
    int width, height;
    bool allowed;
  } const rows[] = {{1, 1, true},
                    {16384, 16384, true},
                    {5'592'405, 1, true},
                    {5'592'406, 1, false},  // a row of more than 2^24 - 1 bytes
                    {1, 238'609'294, true},
                    {1, 238'609'295, false},  // more than 2^30 / 9 * 8 bytes, 4 in each row
                    {268'435'456, 1, false},
                    {1, 268'435'456, false}};
  for (const auto& row : rows) {
    CAPTURE(row.width, row.height);
    const std::string message = message_of<std::length_error>([&] { check_png_size(row.width, row.height); });
    CHECK(message == (row.allowed
                          ? ""
                          : "save_png: an image of " + std::to_string(row.width) + "x" +
                                std::to_string(row.height) + " is too large for PNG; save it as .ppm"));
  }
}

#endif

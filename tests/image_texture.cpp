#if __has_include(<stb_image.h>)  // protostar::png is optional

#include <protostar/io/hdr.hpp>
#include <protostar/io/image_texture.hpp>
#include <protostar/io/png.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "fuzz/read_any_image.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {
/// Returns an image whose pixels are all different: codes 1 to 6 of 255.
Image six_pixels() {
  Image image(3, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) image(x, y) = Color{static_cast<float>(1 + x + 3 * y)} / 255.0f;
  return image;
}

namespace fs = std::filesystem;

const fs::path tests = fs::path(PROTOSTAR_SOURCE_DIR) / "tests";

/// Fills the part of the stack that functions called next use with bytes other than 0.
void write_on_the_stack() {
  volatile unsigned char there[1 << 16];
  for (volatile unsigned char& byte : there) byte = 0xaa;
}

/// Returns the message of the error in an image's bytes, or an empty string.
std::string error_in_image(const std::string& bytes) {
  return message_of<std::runtime_error>([&] { static_cast<void>(image_from_bytes(bytes, "a")); });
}

/// Returns four bytes, the most significant first.
std::string big_endian_bytes(std::size_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255u);
  return bytes;
}

std::string chunk(const std::string& type_and_data) {
  return big_endian_bytes(type_and_data.size() - 4) + type_and_data +
         big_endian_bytes(detail::crc_32(type_and_data));
}

/// Returns a gray PNG of 8 bits.
std::string png(std::size_t width, std::size_t height, std::string rows) {
  int size = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> packed(
      stbi_zlib_compress(reinterpret_cast<unsigned char*>(rows.data()), static_cast<int>(rows.size()), &size,
                         8),
      std::free);
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR" + big_endian_bytes(width) + big_endian_bytes(height) + std::string("\x08\0\0\0\0", 5)) +
         chunk("IDAT" + std::string(packed.get(), packed.get() + size)) + chunk("IEND");
}

}  // namespace

TEST_CASE("an image texture repeats, and has its left edge at u = 0 and its top row at v = 0") {
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
    // Rounded to float; this reference is off by less than 2^-48 of itself.
    CHECK(std::abs(loaded(x, 0).r - light) <= (0x1p-24 + 0x1p-48) * light);
    CHECK(loaded(x, 0).g == loaded(255 - x, 0).r);
    CHECK(loaded(x, 0).b == loaded(128, 0).r);
  }
  // Light saved as sRGB comes back with the same codes.
  save_png(loaded, folder / "b.png", Srgb{});
  CHECK(different_pixels(load_image(folder / "b.png"), loaded) == 0);
}

TEST_CASE("a JPEG is decoded as well, and the format is recognized by the first bytes") {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.hdr").string();  // the extension is ignored
  const unsigned char gray[3 * 64 * 64] = {};
  REQUIRE(stbi_write_jpg(path.c_str(), 64, 64, 3, gray, 90));
  const Image loaded = load_image(path);
  CHECK(loaded.width() == 64);
  CHECK(loaded.height() == 64);
  CHECK(loaded(5, 50) == Color{0});
}

TEST_CASE("every prefix of an image file is refused, or gives the whole picture") {
  int files = 0;
  for (const char* folder : {"fuzz/corpus_image", "fuzz/pool"})
    for (const auto& entry : fs::directory_iterator(tests / folder)) {
      if (entry.path().extension() == ".obj") continue;
      const std::string bytes = bytes_of(entry.path());
      const Image whole = load_image(entry.path());
      CAPTURE(entry.path());
      CHECK(count_pixels(whole, [&](int x, int y) { return !is_finite(Vec3(whole(x, y))); }) == 0);
      ++files;
      for (std::size_t size = 0; size < bytes.size(); ++size) {
        CAPTURE(size);
        try {
          const Image image = image_from_bytes(bytes.substr(0, size), "a");
          CHECK(image.width() == whole.width());
          CHECK(different_pixels(image, whole) == 0);
        } catch (const std::runtime_error& error) {
          CHECK(std::string(error.what()).starts_with("cannot read 'a': "));
        }
      }
    }
  CHECK(files > 20);
}

TEST_CASE("the fuzzing corpus of images, with bytes changed at random, is read or refused with a message") {
  Random random(7);
  for (const auto& entry : fs::directory_iterator(tests / "fuzz/corpus_image")) {
    const std::string bytes = bytes_of(entry.path());
    CAPTURE(entry.path());
    CHECK_NOTHROW(read_any_image(bytes));
    CHECK(with_right_checksums(bytes) == bytes);
    for (int i = 0; i < 100; ++i) {
      std::string changed = bytes;
      for (std::uint64_t k = 1 + random.bits() % 3; k > 0; --k)
        changed[random.bits() % changed.size()] = static_cast<char>(random.bits());
      CHECK_NOTHROW(read_any_image(with_right_checksums(changed)));
    }
  }
}

TEST_CASE("a JPEG with a missing part is refused") {
  const std::string bytes = bytes_of(tests / "fuzz/corpus_image/baseline.jpg");
  const std::string restarts = bytes_of(tests / "fuzz/corpus_image/restarts.jpg");
  const std::string scans = bytes_of(tests / "fuzz/corpus_image/three_scans.jpg");
  const auto without = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t begin = text.find(from), end = to.empty() ? text.size() : text.find(to, begin + 1);
    REQUIRE(begin != std::string::npos);
    REQUIRE(end != std::string::npos);
    return text.erase(begin, end - begin);
  };
  const std::string end = "\xff\xd9", scan = "\xff\xda", huffman = "\xff\xc4", quantizers = "\xff\xdb",
                    frame = "\xff\xc0";
  CHECK(error_in_image(bytes) == "");
  CHECK_THAT(error_in_image(without(bytes, end, "")),
             ContainsSubstring("inside of a JPEG, whose last marker is FF D9"));
  CHECK_THAT(error_in_image(without(bytes, scan, end)),
             ContainsSubstring("no scan of a JPEG has its component 1"));
  CHECK_THAT(error_in_image(without(bytes, frame, huffman)),
             ContainsSubstring("names a component that its frame does not have"));
  CHECK_THAT(error_in_image(without(bytes, huffman, scan)),
             ContainsSubstring("needs a table that is not there"));
  CHECK_THAT(error_in_image(without(bytes, quantizers, frame)),
             ContainsSubstring("needs a table that is not there"));
  CHECK_THAT(error_in_image(bytes.substr(0, bytes.find(scan) + 14) + end),
             ContainsSubstring(" bytes of a scan; a picture of this size takes 9 or more"));
  CHECK_THAT(error_in_image(without(restarts, "\xff\xd1", "\xff\xd2")),
             ContainsSubstring("has 4 restart markers, and not 5"));
  CHECK(error_in_image(scans) == "");
  const std::size_t last = scans.rfind(scan);
  CHECK_THAT(error_in_image(scans.substr(0, last) + end),
             ContainsSubstring("no scan of a JPEG has its component 3"));
  std::string large = bytes;
  large.replace(large.find(frame) + 5, 4, "\xff\xff\xff\xff");
  CHECK_THAT(error_in_image(large), ContainsSubstring("the picture has 65535x65535 pixels"));
  large.replace(large.find(frame) + 5, 4, std::string("\x20\0\x20\0", 4));
  CHECK_THAT(error_in_image(large),
             ContainsSubstring(" bytes of a scan; a picture of this size takes 393216 or more"));
}

TEST_CASE("a PNG with a missing or wrong part is refused") {
  const std::string row(5, '\0'), rows = row + row + row;
  CHECK(error_in_image(png(4, 3, rows)) == "");
  CHECK_THAT(error_in_image(png(4, 4, rows)), ContainsSubstring("not enough pixels"));
  CHECK_THAT(
      error_in_image(png(12000, 12000, rows)),
      ContainsSubstring("the picture has 12000x12000 pixels; allowed are sides of at least 1 and at most "
                        "67108864 pixels"));
  CHECK_THAT(error_in_image(png(0, 3, rows)), ContainsSubstring("the picture has 0x3 pixels"));
  CHECK_THAT(error_in_image(png(8192, 8192, rows)),
             ContainsSubstring("bytes of pixels; a picture of this size takes 65035 or more"));
  CHECK_THAT(error_in_image(png(4, 3, std::string(std::size_t{64} << 20, '\0'))),
             ContainsSubstring("there are more pixels than its size says"));
  CHECK(error_in_image(png(4, 3, rows + row)) == "");  // some files have a little more
  std::string damaged = png(4, 3, rows);
  damaged[damaged.find("IDAT") + 8] ^= 1;
  CHECK_THAT(error_in_image(damaged),
             ContainsSubstring("chunk \"IDAT\" at byte 33 has another checksum than its bytes"));
  CHECK_THAT(error_in_image(png(4, 3, rows).erase(8, 25)), ContainsSubstring("IHDR is the first chunk"));
}

TEST_CASE("colors that are missing in a palette are black") {
  const std::string bytes = bytes_of(tests / "fuzz/corpus_image/palette_outside.png");
  write_on_the_stack();
  const Image image = image_from_bytes(bytes, "a");
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) == Color{0}; }) > 20);
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; }) > 0);
}

TEST_CASE("load_image accepts a lower limit for the number of pixels") {
  const fs::path path = tests / "fuzz/corpus_image/baseline.jpg";  // 33 × 19
  CHECK(load_image(path, 627).width() == 33);
  CHECK_THAT(message_of<std::runtime_error>([&] { static_cast<void>(load_image(path, 626)); }),
             ContainsSubstring(
                 "the picture has 33x19 pixels; allowed are sides of at least 1 and at most 626 pixels"));
}

TEST_CASE("an endless device is refused as an image") {
  for (const std::string path : {"/dev/zero", "/dev/urandom"})
    CHECK_THAT(message_of<std::runtime_error>([&] { static_cast<void>(load_image(path)); }),
               ContainsSubstring("cannot read '" + path + "': the file does not begin as"));
}

TEST_CASE("messages show the name of an image without control characters") {
  CHECK_THAT(message_of<std::system_error>([&] { static_cast<void>(load_image("a\x1b[31m\n.png")); }),
             ContainsSubstring("cannot read 'a\\x1b[31m\\x0a.png': "));
  CHECK_THAT(message_of<std::runtime_error>([&] { static_cast<void>(image_from_bytes("", "a\x07")); }),
             ContainsSubstring("cannot read 'a\\x07': "));
}

TEST_CASE("an image that cannot be read is reported, with its path and the reason") {
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
  CHECK_THAT(error("words.jpg"),
             ContainsSubstring("the file does not begin as a PNG, a JPEG or a Radiance HDR does"));
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

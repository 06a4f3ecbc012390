#include <bit>
#include <cstring>
#include <limits>
#include <protostar/pfm.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/test_image.hpp"

using namespace protostar;

TEST_CASE("a PFM is its header and the floats as they are, rows from the bottom") {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  Image image(2, 2);
  image(0, 0) = {1, 2, 3};
  image(1, 0) = {4, 5, 6};
  image(0, 1) = {-1, 0.1f, 1e-40f};
  image(1, 1) = {inf, nan, -0.0f};
  const TemporaryFolder folder;
  save_pfm(image, folder / "a.pfm");
  CHECK(folder.count() == 1);
  const std::string bytes = bytes_of(folder / "a.pfm");

  const std::string header =
      std::endian::native == std::endian::little ? "PF\n2 2\n-1.0\n" : "PF\n2 2\n1.0\n";
  REQUIRE(bytes.size() == header.size() + 12 * sizeof(float));
  CHECK(bytes.substr(0, header.size()) == header);
  const float expected[] = {-1, 0.1f, 1e-40f, inf, nan, -0.0f, 1, 2, 3, 4, 5, 6};
  CHECK(std::memcmp(bytes.data() + header.size(), expected, sizeof expected) == 0);
}

TEST_CASE("every float of a PFM equals the image's, for images of any shape") {
  struct {
    int width, height;
  } const sizes[] = {{1, 1}, {3, 500}, {65535, 2}, {65536, 2}, {65537, 2}, {140000, 1}};
  std::uint64_t seed = 16;
  for (const auto& size : sizes) {
    CAPTURE(size.width, size.height);
    const Image image = random_image(size.width, size.height, ++seed);
    const TemporaryFolder folder;
    save_pfm(image, folder / "a.pfm");
    const std::string bytes = bytes_of(folder / "a.pfm");
    const std::size_t row = static_cast<std::size_t>(size.width) * sizeof(Color);
    const std::size_t rows = static_cast<std::size_t>(size.height);
    REQUIRE(bytes.size() > row * rows);
    const char* pixels = bytes.data() + bytes.size() - row * rows;
    CHECK(pixels[-1] == '\n');
    for (int y = 0; y < size.height; ++y)
      CHECK(std::memcmp(pixels + row * (rows - 1 - static_cast<std::size_t>(y)), &image(0, y), row) == 0);
  }
}

TEST_CASE("stopping save_pfm leaves the old file unchanged") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.pfm", "old");
  save_pfm(Image(100, 100), folder / "a.pfm", [] { return true; });
  CHECK(bytes_of(folder / "a.pfm") == "old");
  CHECK(folder.count() == 1);
}

// Compares two pictures, byte by byte, and draws their differences.
//
//   compare_images A B [DIFF.png]
//
// Reads PNG and PPM. Prints how many pixels differ and by how many levels at most. DIFF.png, written
// if any pixel differs, is black at equal channels; a channel that differs by n levels is 95 + 10 n there, so
// that a single level is visible. The exit status is 0 if the pictures are equal, 1 if they differ, 2 if
// something failed.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>

#include "picture.hpp"
#include "read_image.hpp"
#include "write_png.hpp"

namespace {

constexpr int equal = 0, different = 1, failed = 2;

Picture difference_image(const Picture& a, const Picture& b) {
  Picture result = a;
  for (std::size_t i = 0; i < result.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const int levels = std::abs(a.pixels[i][c] - b.pixels[i][c]);
      result.pixels[i][c] = static_cast<std::uint8_t>(levels == 0 ? 0 : std::min(255, 95 + 10 * levels));
    }
  return result;
}

int compare(int argc, char** argv) {
  if (argc != 3 && argc != 4) throw std::runtime_error("usage: compare_images A B [DIFF.png]");
  const Picture a = read_image(argv[1]), b = read_image(argv[2]);
  if (!same_size(a, b)) {
    std::printf("sizes differ: %dx%d and %dx%d\n", a.width, a.height, b.width, b.height);
    return different;
  }
  const Difference found = difference(a, b);
  if (found.pixels == 0) {
    std::puts("equal");
    return equal;
  }
  std::printf("%d of %d pixels differ, by at most %d of 255 levels\n", found.pixels, a.width * a.height,
              found.largest);
  if (argc == 4) write_png(argv[3], difference_image(a, b));
  return different;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return compare(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_images: %s\n", error.what());
    return failed;
  }
}

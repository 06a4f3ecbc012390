// Writes a picture as PNG.
//
//   convert_image IN OUT.png
//
// Reads PNG and PPM. The exit status is 0, 1 with a message if something failed, or 2 for other arguments.
#include <cstdio>
#include <exception>

#include "read_image.hpp"
#include "write_png.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: convert_image IN OUT.png\n", stderr);
    return 2;
  }
  try {
    write_png(argv[2], read_image(argv[1]));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "convert_image: %s\n", error.what());
    return 1;
  }
}

// What libFuzzer calls with bytes of its own; tests/image_texture.cpp does so with the corpus.
#include <cstddef>
#include <cstdint>
#include <string>

#include "read_any_image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  read_any_image(with_right_checksums(std::string(bytes, bytes + size)));
  return 0;
}

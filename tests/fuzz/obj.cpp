// What libFuzzer calls with bytes of its own; tests/obj.cpp does so with the corpus.
#include <cstddef>
#include <cstdint>
#include <string>

#include "read_any_obj.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  read_any_obj(std::string(bytes, bytes + size));
  return 0;
}

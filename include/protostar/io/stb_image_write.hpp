// Includes stb_image_write for the headers beside this one. Not part of the core: link protostar::png.
#pragma once

// Compiled as static functions of this translation unit, which do not conflict with another copy of
// stb_image_write in a program.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
#undef STB_IMAGE_WRITE_IMPLEMENTATION
#undef STB_IMAGE_WRITE_STATIC

#include <algorithm>
#include <cstddef>
#include <vector>

#include "../output_file.hpp"
#include "../stop_token.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Appends bytes of a file to the vector<char> at `to`; stb_image_write calls it with that as context.
inline void append_bytes(void* to, void* data, int size) {
  const char* bytes = static_cast<const char*>(data);
  auto& all = *static_cast<std::vector<char>*>(to);
  all.insert(all.end(), bytes, bytes + size);
}

/// Replaces a file by these bytes, or leaves it as it was if stop is requested before they are written.
inline void save_bytes(const std::vector<char>& bytes, const FileName& path, const StopToken& stop) {
  OutputFile file(path);
  constexpr std::size_t block = 1 << 20;  // bytes written at a time
  for (std::size_t begin = 0; begin < bytes.size(); begin += block) {
    if (stop.stop_requested()) return;
    file.write(bytes.data() + begin, std::min(block, bytes.size() - begin));
  }
  file.commit();
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

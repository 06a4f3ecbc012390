// Images as PNG files, through stb_image_write. Not part of the core: link protostar::png.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <new>
#include <vector>

// As static functions of this translation unit, so that they meet no other copy of stb_image_write in a
// program.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
#undef STB_IMAGE_WRITE_IMPLEMENTATION
#undef STB_IMAGE_WRITE_STATIC

#include "../encode.hpp"
#include "../image.hpp"
#include "../output_file.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Saves an image as PNG with 8 bits per channel, encoded by the transfer and rounded to the nearest code.
///
/// The file is replaced as a whole or not at all (see OutputFile, also for its errors): it is made in memory
/// first. Throws std::length_error for an image that stb_image_write cannot count in an int, 2^31 bytes or
/// more.
inline void save_png(const Image& image, const std::filesystem::path& path,
                     const Transfer& transfer = Srgb{}) {
  const Encoder encode(transfer, 255);
  const std::int64_t row_bytes = std::int64_t{image.width()} * 3;
  if ((row_bytes + 1) * image.height() > std::numeric_limits<int>::max())
    throw std::length_error("save_png: the image is too large for PNG, " + std::to_string(image.width()) +
                            "x" + std::to_string(image.height()) + "; save it as .ppm");
  std::vector<std::uint8_t> codes;
  codes.reserve(static_cast<std::size_t>(row_bytes * image.height()));
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (const float channel : {image(x, y).r, image(x, y).g, image(x, y).b})
        codes.push_back(static_cast<std::uint8_t>(encode(channel)));

  std::vector<char> png;
  const auto append = [](void* to, void* data, int size) {
    const char* bytes = static_cast<const char*>(data);
    static_cast<std::vector<char>*>(to)->insert(static_cast<std::vector<char>*>(to)->end(), bytes,
                                                bytes + size);
  };
  if (!stbi_write_png_to_func(append, &png, image.width(), image.height(), 3, codes.data(),
                              static_cast<int>(row_bytes)))
    throw std::bad_alloc();  // the only reason that it has
  OutputFile file(path);
  file.write(png.data(), png.size());
  file.commit();
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Writes PNG through stb_image_write.
#pragma once

#include <stdexcept>
#include <string>

// stb_image_write as static functions of this translation unit.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

#include "picture.hpp"

/// Writes a picture as PNG. Throws std::runtime_error if stb reports an error; stb does not see a full disk.
inline void write_png(const std::string& path, const Picture& picture) {
  if (!stbi_write_png(path.c_str(), picture.width, picture.height, 3, picture.pixels.data(),
                      3 * picture.width))
    throw std::runtime_error(path + ": cannot be written");
}

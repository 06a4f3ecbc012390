// Reads PNG, and PPM in its binary form P6, through stb_image.
#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>

// stb_image as static functions of this translation unit, so that they do not conflict with another copy in a
// program.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_PNM
#include <stb_image.h>

#include "picture.hpp"

/// Reads a picture. Throws std::runtime_error, with the path and the reason, if it cannot be read.
inline Picture read_image(const std::string& path) {
  Picture picture;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> bytes(
      stbi_load(path.c_str(), &picture.width, &picture.height, &channels, 3), stbi_image_free);
  if (!bytes) throw std::runtime_error(path + ": " + stbi_failure_reason());
  picture.pixels.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  for (std::size_t i = 0; i < picture.pixels.size(); ++i)
    picture.pixels[i] = {bytes.get()[3 * i], bytes.get()[3 * i + 1], bytes.get()[3 * i + 2]};
  return picture;
}

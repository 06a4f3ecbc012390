// stb_image is compiled here alone, as static functions, so that it does not conflict with another copy in a
// program.
#include "read_image.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <stdexcept>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_PNM
#include <stb_image.h>

namespace {

/// Reads the rest of a plain PPM, behind the letters P3. Throws std::runtime_error if it is not complete.
Picture read_plain_ppm(std::ifstream& file, const std::string& path) {
  Picture picture;
  int max_code = 0;
  file >> picture.width >> picture.height >> max_code;
  if (!file || picture.width < 1 || picture.height < 1 || max_code != 255)
    throw std::runtime_error(path + ": is no plain PPM with a largest number of 255");
  for (long i = 0; i < static_cast<long>(picture.width) * picture.height; ++i) {
    int r = -1, g = -1, b = -1;
    file >> r >> g >> b;
    if (!file || std::min({r, g, b}) < 0 || std::max({r, g, b}) > 255)
      throw std::runtime_error(path + ": has a pixel that is incomplete or not from 0 to 255");
    picture.pixels.push_back(
        {static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(b)});
  }
  return picture;
}

}  // namespace

Picture read_image(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (file.get() == 'P' && file.get() == '3') return read_plain_ppm(file, path);
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

// Textures from files: .png, .jpg and .hdr, through stb_image. Not part of the core: link protostar::png.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

// As static functions of this translation unit, so that they meet no other copy of stb_image in a program.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_HDR
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#include <stb_image.h>
#undef STB_IMAGE_IMPLEMENTATION
#undef STB_IMAGE_STATIC

#include "../encode.hpp"
#include "../image.hpp"
#include "../material.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// An image as a texture, whose copies share it. It lies on 0 ≤ u < size_u and 0 ≤ v < size_v, its left edge
/// at u = 0 and its top row at v = 0, and repeats in both directions; a place has the color of the pixel that
/// contains it.
struct ImageTexture {
  std::shared_ptr<const Image> image;
  double size_u = 1, size_v = 1;  ///< in units of u and v; finite and greater than 0

  [[nodiscard]] Color operator()(double u, double v) const {
    return (*image)(pixel(u / size_u, image->width()), pixel(v / size_v, image->height()));
  }

 private:
  /// Which of the pixels contains x, where one copy of them reaches from 0 to 1; the first for NaN.
  static int pixel(double x, int count) {
    const double place = (x - std::floor(x)) * count;
    // A little less than 0 may be rounded to 1, behind the last pixel.
    return place > 0 ? std::min(static_cast<int>(place), count - 1) : 0;
  }
};

/// The linear light of a picture in a file: of a .png or .jpg, 8 bits per channel decoded from sRGB, without
/// its transparency; of a .hdr, as it is. What it is, is told by the file's first bytes, not by its name.
///
/// Throws std::system_error if the file cannot be opened and std::runtime_error if it holds no such picture;
/// both name the path and the reason.
[[nodiscard]] inline Image load_image(const std::filesystem::path& path) {
  const auto failure = [&] { return "cannot read '" + path.string() + "'"; };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.string().c_str(), "rb"),
                                                             std::fclose);
  if (!file) throw std::system_error(errno, std::generic_category(), failure());

  int width = 0, height = 0, channels = 0;
  const auto pixels_of = [&](auto* codes, const auto& light_of) {
    const std::unique_ptr<std::remove_pointer_t<decltype(codes)>, void (*)(void*)> owned(codes,
                                                                                         stbi_image_free);
    if (!codes) throw std::runtime_error(failure() + ": " + stbi_failure_reason());
    Image image(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x, codes += 3)
        image(x, y) = {light_of(codes[0]), light_of(codes[1]), light_of(codes[2])};
    return image;
  };
  if (stbi_is_hdr_from_file(file.get()))
    return pixels_of(stbi_loadf_from_file(file.get(), &width, &height, &channels, 3),
                     [](float light) { return light; });

  std::array<float, 256> light;
  for (std::size_t code = 0; code < light.size(); ++code)
    light[code] = static_cast<float>(decode(Srgb{}, static_cast<double>(code) / 255));
  return pixels_of(stbi_load_from_file(file.get(), &width, &height, &channels, 3),
                   [&](stbi_uc code) { return light[code]; });
}

/// The picture in a file as a texture of the given size in units of u and v. Errors are those of load_image;
/// std::invalid_argument if a size is not finite and greater than 0.
[[nodiscard]] inline Texture image_texture(const std::filesystem::path& path, double size_u = 1,
                                           double size_v = 1) {
  const auto is_size = [](double size) { return size > 0 && std::isfinite(size); };
  if (!is_size(size_u) || !is_size(size_v))
    throw std::invalid_argument("image_texture: size_u and size_v must be finite and greater than 0");
  return ImageTexture{std::make_shared<const Image>(load_image(path)), size_u, size_v};
}

}  // namespace protostar::inline PROTOSTAR_ABI

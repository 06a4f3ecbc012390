// Reads normal maps from .png, .jpg and .hdr files through stb_image. Not part of the core: link
// protostar::png.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "../encode.hpp"
#include "../image.hpp"
#include "../magnitude.hpp"
#include "../material.hpp"
#include "../shown.hpp"
#include "../texture_image.hpp"
#include "image_texture.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Reads the linear numbers of a normal map from its file: the codes of a PNG or a JPEG over 255, without a
/// decoding of sRGB, and the numbers of an HDR. Throws the errors of load_image, and std::runtime_error if
/// the blue of a pixel is not above 1/2: its normal would not lead out of the surface.
[[nodiscard]] inline Image load_normal_map(const std::filesystem::path& path,
                                           std::int64_t most_pixels = most_image_pixels) {
  Image image = load_image(path, most_pixels, Linear{});
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (const Color& c = image(x, y); !(c.b > 0.5f))
        throw std::runtime_error(shown(
            "'" + path.string() + "' is no normal map: the blue of pixel " + std::to_string(x) + "," +
            std::to_string(y) + ", counted from 0 at the upper left, is " + shown(static_cast<double>(c.b)) +
            "; allowed is above 0.5, for a normal that leads out of the surface"));
  return image;
}

/// Returns the normal map in a file, of the given size in units of u and v. Throws the errors of
/// load_normal_map, and std::invalid_argument if size_u or size_v is not a size (magnitude.hpp).
[[nodiscard]] inline NormalMap image_normal_map(const std::filesystem::path& path, double size_u = 1,
                                                double size_v = 1) {
  require_rule(is_size(size_u) && is_size(size_v), "image_normal_map: size_u and size_v must be", size_rule);
  return ImageNormalMap{
      {std::make_shared<const Image>(load_normal_map(path)), size_u, size_v, path.string()}};
}

}  // namespace protostar::inline PROTOSTAR_ABI

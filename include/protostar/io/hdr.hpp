// Writes images as Radiance HDR files (.hdr), through stb_image_write: linear light in 32 bits per pixel. Not
// part of the core: link protostar::png.
#pragma once

#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "../image.hpp"
#include "stb_image_write.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Returns the nearest color that the format can hold. Its channels are whole multiples, of at most 255, of
/// 2^(e − 8), where 2^e is above the largest channel and at most twice as large, and e is at most 127.
/// stb_image_write truncates fractions; this color has none.
[[nodiscard]] inline Color nearest_rgbe(const Color& light) {
  const auto limited = [](float x) { return x > 0 ? std::min(x, 255 * 0x1p119f) : 0; };  // NaN is not above 0
  const Color c{limited(light.r), limited(light.g), limited(light.b)};
  const float largest = std::max({c.r, c.g, c.b});
  // stb_image_write writes 0 below this limit. The format itself could hold some smaller values: its least
  // exponent is 2^-128.
  if (largest < 1e-32f) return Color{0};
  int e = 0;
  std::frexp(largest, &e);
  const auto rounded = [&](float x) { return std::ldexp(std::round(std::ldexp(x, 8 - e)), e - 8); };
  if (rounded(largest) == std::ldexp(1.0f, e)) ++e;
  return {rounded(c.r), rounded(c.g), rounded(c.b)};
}

}  // namespace detail

/// Saves an image as Radiance HDR: linear light, with eight bits for the largest channel of a pixel and the
/// same unit for the others. Each channel is rounded to the nearest; negative values and NaN become 0, and
/// values above 255 · 2^119, about 1.7e38, become that bound.
///
/// Builds the file in memory, then replaces the target as a whole or not at all (see OutputFile, also for its
/// errors). If stop is requested while it is written, returns early and leaves the target as it was.
inline void save_hdr(const Image& image, const FileName& path, const StopToken& stop = {}) {
  std::vector<float> light;
  light.reserve(3 * static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()));
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Color color = detail::nearest_rgbe(image(x, y));
      light.insert(light.end(), {color.r, color.g, color.b});
    }
  std::vector<char> bytes;
  if (!stbi_write_hdr_to_func(detail::append_bytes, &bytes, image.width(), image.height(), 3, light.data()))
    throw std::bad_alloc();
  detail::save_bytes(bytes, path, stop);
}

}  // namespace protostar::inline PROTOSTAR_ABI

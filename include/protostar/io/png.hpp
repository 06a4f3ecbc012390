// Writes images as PNG files, through stb_image_write. Not part of the core: link protostar::png.
#pragma once

#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "../encode.hpp"
#include "../image.hpp"
#include "stb_image_write.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Throws std::length_error if save_png cannot write an image of this size: rows of more than 2^24 − 1 bytes,
/// or more than 954 million bytes in all. PNG has neither limit; stb_image_write counts in int.
inline void check_png_size(int width, int height) {
  // stb_image_write adds up the bytes of a row, each at most 128 in magnitude, to choose among filters, and
  // doubles a buffer that holds up to nine bits for each byte of the rows, which begin with a filter byte.
  constexpr std::int64_t most_in_row = std::numeric_limits<int>::max() / 128;
  constexpr std::int64_t most_bytes = (std::int64_t{1} << 30) / 9 * 8;
  const std::int64_t row_bytes = std::int64_t{width} * 3;
  if (row_bytes > most_in_row || (row_bytes + 1) * height > most_bytes)
    throw std::length_error("save_png: an image of " + std::to_string(width) + "x" + std::to_string(height) +
                            " is too large for PNG; save it as .ppm");
}

/// Saves an image as PNG with 8 bits per channel, encoded by the transfer and rounded to the nearest code.
///
/// Builds the file in memory, then replaces the target as a whole or not at all (see OutputFile, also for its
/// errors). If stop is requested while it is written, returns early and leaves the target as it was. Throws
/// std::length_error for an image that is too large (check_png_size).
inline void save_png(const Image& image, const FileName& path, const Transfer& transfer = Srgb{},
                     const StopToken& stop = {}) {
  check_png_size(image.width(), image.height());
  const std::int64_t row_bytes = std::int64_t{image.width()} * 3;
  const Encoder encode(transfer, 255);
  std::vector<std::uint8_t> codes;
  codes.reserve(static_cast<std::size_t>(row_bytes * image.height()));
  std::vector<std::uint16_t> row(static_cast<std::size_t>(row_bytes));
  for (int y = 0; y < image.height(); ++y) {
    encode(&image(0, y), image.width(), row.data());
    for (const std::uint16_t code : row) codes.push_back(static_cast<std::uint8_t>(code));
  }

  std::vector<char> png;
  if (!stbi_write_png_to_func(detail::append_bytes, &png, image.width(), image.height(), 3, codes.data(),
                              static_cast<int>(row_bytes)))
    throw std::bad_alloc();  // stb_image_write fails for no other reason
  detail::save_bytes(png, path, stop);
}

}  // namespace protostar::inline PROTOSTAR_ABI

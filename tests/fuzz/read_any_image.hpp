// Fuzzing of the image reader: any bytes give an image, all of whose pixels are finite, or an error message.
#pragma once

#include <cmath>
#include <cstddef>
#include <protostar/io/image_texture.hpp>
#include <stdexcept>
#include <string>

/// Returns a PNG whose chunks have the right checksums, so that changed bytes are not refused for these
/// alone. Other bytes are returned unchanged.
inline std::string with_right_checksums(std::string bytes) {
  using namespace protostar::detail;
  if (!is_png(bytes)) return bytes;
  for (std::size_t at = 8; bytes.size() - at >= 12;) {
    const std::size_t length = big_endian(bytes.substr(at, 4));
    if (length > bytes.size() - at - 12) break;
    const std::uint32_t checksum = crc_32(bytes.substr(at + 4, 4 + length));
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + 8 + length + i] = static_cast<char>(checksum >> (24 - 8 * i) & 255u);
    at += 12 + length;
  }
  return bytes;
}

/// Reads bytes as an image file. Ends the program if the image or the message is not as it should be.
inline void read_any_image(const std::string& bytes) {
  using namespace protostar;
  constexpr std::int64_t most_pixels = 1 << 18;
  try {
    const Image image = image_from_bytes(bytes, "image", most_pixels);
    if (std::int64_t{image.width()} * image.height() > most_pixels) __builtin_trap();
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        const Color& pixel = image(x, y);
        if (!(pixel.r >= 0 && pixel.g >= 0 && pixel.b >= 0)) __builtin_trap();
        if (std::isinf(pixel.r) || std::isinf(pixel.g) || std::isinf(pixel.b)) __builtin_trap();
      }
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).size() > 1000) __builtin_trap();  // a message is shorter than long files
    if (shown(error.what()) != error.what()) __builtin_trap();
  }
}

// Checks that a PNG is whole, which stb_image does not before it decodes it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "image_file.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

inline bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

/// The checksum that stands behind each chunk of a PNG (CRC-32, ISO 3309).
inline std::uint32_t crc_32(std::string_view bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> remainders{};
    for (std::uint32_t i = 0; i < remainders.size(); ++i) {
      std::uint32_t r = i;
      for (int bit = 0; bit < 8; ++bit) r = (r & 1u) != 0 ? r >> 1 ^ 0xedb88320u : r >> 1;
      remainders[i] = r;
    }
    return remainders;
  }();
  std::uint32_t r = 0xffffffffu;
  for (const char c : bytes) r = table[(r ^ static_cast<unsigned char>(c)) & 0xffu] ^ r >> 8;
  return ~r;
}

/// A PNG for stb_image, and the most bytes that it needs in one piece.
struct CheckedPng {
  std::string bytes;
  std::size_t most_block = 0;
};

/// Returns a PNG of which all chunks are there up to the last, the checksums of those that make the picture
/// are right, and a palette has 256 colors: stb_image takes what a shorter one lacks from memory that nobody
/// has written. The missing ones are black. Throws std::runtime_error for what is wrong, and for more pixels
/// than are allowed.
inline CheckedPng checked_png(const ImageBytes& png, std::int64_t most_pixels) {
  CheckedPng checked{.bytes = std::string(png.all().substr(0, 8))};
  std::int64_t least_bytes = 0, found_bytes = 0;  // of the compressed pixels
  for (std::size_t at = 8;;) {
    const std::string where = "a chunk of a PNG";
    const std::uint32_t length = big_endian(png.part(at, 4, where));
    const std::string_view chunk = png.part(at + 4, std::size_t{4} + length, where);  // with its type
    const std::uint32_t checksum = big_endian(png.part(at + 8 + length, 4, where));
    const std::string_view type = chunk.substr(0, 4), data = chunk.substr(4);
    const bool is_critical = 'A' <= type[0] && type[0] <= 'Z';
    const std::string name = "chunk \"" + std::string(type) + "\" at byte " + std::to_string(at);
    if (is_critical && crc_32(chunk) != checksum) png.refuse(name + " has another checksum than its bytes");
    if ((at == 8) != (type == "IHDR")) png.refuse(name + " is not in its place; IHDR is the first chunk");
    if (type == "IHDR") {
      if (length != 13) png.refuse(name + " has " + std::to_string(length) + " bytes; 13 are allowed");
      const std::int64_t width = big_endian(data.substr(0, 4)), height = big_endian(data.substr(4, 4));
      png.require_pixels(width, height, most_pixels);
      // Of each row there are at least the bits of one channel, and the number of a filter. A byte of deflate
      // stands for at most 1032: 258 bytes in two bits.
      const int depth = static_cast<unsigned char>(data[8]);
      least_bytes = height * (1 + (width * depth + 7) / 8) / 1032;
      // stb_image takes for a pixel at most 8 bytes and one for a row, or all that is compressed, and twice
      // as much when it turns out that there is more; it begins with 4096 bytes.
      checked.most_block =
          std::max(2 * static_cast<std::size_t>(9 * width * height), 2 * png.size()) + (1 << 16);
    }
    if (type == "IDAT") found_bytes += length;
    if (type == "PLTE" && 0 < length && length < 768 && length % 3 == 0) {
      checked.bytes.append(std::string("\0\0\3\0", 4))
          .append(chunk)
          .append(768 - length, '\0')
          .append(4, '\0');
    } else {
      checked.bytes.append(png.all().substr(at, std::size_t{12} + length));
    }
    if (type == "IEND") break;
    at += std::size_t{12} + length;
  }
  png.require_bytes(least_bytes, found_bytes, "pixels");
  return checked;
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

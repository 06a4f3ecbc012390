// Checks that a PNG is complete, which stb_image does not do before decoding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "image_file.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

inline bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

/// Returns the checksum that follows each chunk of a PNG (CRC-32, ISO 3309).
inline std::uint32_t crc_32(std::string_view bytes) {
  std::uint32_t r = 0xffffffffu;
  for (const char c : bytes) {
    r ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) r = r >> 1 ^ (r & 1u) * 0xedb88320u;
  }
  return ~r;
}

/// Returns a PNG whose chunks are all there up to the last, with right checksums of the critical ones, and
/// whose palette, if any, is extended to 256 colors with black: stb_image takes missing ones from
/// uninitialized memory. Throws std::runtime_error if the PNG is damaged or has more pixels than most_pixels.
inline std::string checked_png(ImageBytes png, std::int64_t most_pixels) {
  std::string checked(png.take(8, "its first bytes"));
  std::int64_t least_bytes = 0, found_bytes = 0;  // number of bytes of compressed pixels
  for (std::string_view type; type != "IEND";) {
    const std::string where = "a chunk of a PNG";
    const std::size_t at = png.at();
    const std::uint32_t length = png.number(4, where);
    const std::string_view chunk = png.take(std::size_t{4} + length, where);  // with its type
    const std::uint32_t checksum = png.number(4, where);
    type = chunk.substr(0, 4);
    const bool is_critical = 'A' <= type[0] && type[0] <= 'Z';
    const std::string name = "chunk \"" + std::string(type) + "\" at byte " + std::to_string(at);
    if (is_critical && crc_32(chunk) != checksum) png.refuse(name + " has another checksum than its bytes");
    if ((at == 8) != (type == "IHDR")) png.refuse(name + " is not in its place; IHDR is the first chunk");
    if (type == "IHDR") {
      if (length != 13) png.refuse(name + " has " + std::to_string(length) + " bytes; 13 are allowed");
      const std::int64_t width = big_endian(chunk.substr(4, 4)), height = big_endian(chunk.substr(8, 4));
      png.require_pixels(width, height, most_pixels);
      // A row has at least the bits of one channel, and a byte that names its filter. A byte of deflate
      // stands for at most 1032: two bits for 258 bytes.
      least_bytes = height * (1 + (width * big_endian(chunk.substr(12, 1)) + 7) / 8) / 1032;
    }
    if (type == "IDAT") found_bytes += length;
    if (type == "PLTE" && 0 < length && length < 768 && length % 3 == 0)
      checked.append(std::string("\0\0\3\0", 4)).append(chunk).append(768 - length + 4, '\0');
    else
      checked.append(png.all().substr(at, std::size_t{12} + length));
  }
  png.require_bytes(least_bytes, found_bytes, "pixels");
  return checked;
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

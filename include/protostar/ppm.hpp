// Images as PPM files (§2.2.2).
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "encode.hpp"
#include "image.hpp"
#include "output_file.hpp"
#include "plain_vector.hpp"
#include "stop_token.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Options of save_ppm.
struct PpmOptions {
  int bits = 8;             ///< bits per channel, 8 or 16: a maximum value of 255 or 65535
  bool plain = false;       ///< decimal numbers (P3), laid out as in the tutorial, instead of bytes (P6)
  bool repeat_rows = true;  ///< a row equal to the one above is written again without encoding
  StopToken stop = {};      ///< if requested, save_ppm returns early and leaves the file as it was
};

namespace detail {

/// Decimal digits of a code with a tab behind them, so that a number is copied and not computed.
struct DecimalText {
  char characters[7]{};
  std::uint8_t length = 0;
};

/// Returns the texts of the codes from 0 on.
inline PlainVector<DecimalText> decimal_texts(std::size_t count) {
  PlainVector<DecimalText> texts(count);
  for (std::size_t code = 0; code < count; ++code) {
    char* const begin = texts[code].characters;
    char* const end = std::to_chars(begin, begin + 5, code).ptr;
    *end = '\t';
    texts[code].length = static_cast<std::uint8_t>(end + 1 - begin);
  }
  return texts;
}

/// Writes the codes of `count` pixels as decimal numbers, a tab behind each and one more behind each pixel:
/// at most 19 characters a pixel. May overwrite 6 more. Returns their end.
inline char* write_decimals(const std::uint16_t* codes, int count, const PlainVector<DecimalText>& decimals,
                            char* end) {
  const DecimalText* const texts = decimals.data();
  for (int i = 0; i < count; ++i, codes += 3) {
    for (int channel = 0; channel < 3; ++channel) {
      const DecimalText& text = texts[codes[channel]];
      std::memcpy(end, text.characters, sizeof text.characters);
      end += text.length;
    }
    *end++ = '\t';
  }
  return end;
}

/// Writes codes as bytes, each as two, the most significant first, or as one. Returns their end.
inline char* write_bytes(const std::uint16_t* codes, int count, bool wide, char* bytes) {
  for (int i = 0; !wide && i < count; ++i) bytes[i] = static_cast<char>(codes[i] & 0xff);
  for (int i = 0; wide && i < count; ++i) {
    bytes[2 * i] = static_cast<char>(codes[i] >> 8);
    bytes[2 * i + 1] = static_cast<char>(codes[i] & 0xff);
  }
  return bytes + (wide ? 2 : 1) * count;
}

}  // namespace detail

/// Saves an image as PPM, each channel encoded by the transfer and rounded to the nearest code.
///
/// The file is replaced as a whole or not at all (see OutputFile, also for its errors). Throws
/// std::invalid_argument for bits other than 8 and 16 or a gamma that is not finite and greater than 0.
inline void save_ppm(const Image& image, const FileName& path, const Transfer& transfer = Srgb{},
                     const PpmOptions& options = {}) {
  if (options.bits != 8 && options.bits != 16) throw std::invalid_argument("save_ppm: bits must be 8 or 16");
  const bool wide = options.bits == 16;
  const Encoder encode(transfer, wide ? 65535 : 255);

  OutputFile file(path);
  file.write((options.plain ? "P3\n" : "P6\n") + std::to_string(image.width()) + " " +
             std::to_string(image.height()) + "\n" + std::to_string(encode.max_code()) + "\n");

  const auto decimals = detail::decimal_texts(options.plain ? encode.max_code() + std::size_t{1} : 0);
  constexpr int block = 4096;  // pixels encoded at a time, for rows of any width
  std::uint16_t codes[3 * block];
  char buffer[block * 19 + 6];
  const std::size_t row_bytes = static_cast<std::size_t>(image.width()) * sizeof(Color);
  const auto is_like_the_row_above = [&](int y) {
    return y > 0 && std::memcmp(&image(0, y), &image(0, y - 1), row_bytes) == 0;
  };
  char* end = buffer;
  for (int y = 0; y < image.height(); ++y) {
    if (options.repeat_rows && image.width() <= block && is_like_the_row_above(y)) {
      if (options.stop.stop_requested()) return;
      file.write(buffer, static_cast<std::size_t>(end - buffer));  // still the row above
      continue;
    }
    for (int x = 0; x < image.width(); x += block) {
      if (options.stop.stop_requested()) return;
      const int count = std::min(image.width() - x, block);
      encode(&image(x, y), count, codes);
      end = options.plain ? detail::write_decimals(codes, count, decimals, buffer)
                          : detail::write_bytes(codes, 3 * count, wide, buffer);
      if (options.plain && x + count == image.width()) *end++ = '\n';
      file.write(buffer, static_cast<std::size_t>(end - buffer));
    }
  }
  file.commit();
}

}  // namespace protostar::inline PROTOSTAR_ABI

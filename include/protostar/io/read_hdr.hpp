// Reads Radiance HDR files (.hdr): linear light, each pixel in three mantissas of 8 bits and their exponent.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "../image.hpp"
#include "image_file.hpp"
#include "text.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

inline bool is_hdr(std::string_view bytes) {
  return bytes.starts_with("#?RADIANCE\n") || bytes.starts_with("#?RGBE\n");
}

/// Reader of an .hdr: the constructor reads the header, image() the scanlines. A scanline is flat, with four
/// bytes for each pixel; or its four channels follow each other, each as runs: a count up to 128 and as many
/// bytes, or 128 plus a count of up to 127 and the byte that is repeated.
class HdrReader {
 public:
  HdrReader(const ImageBytes& bytes, std::int64_t most_pixels) : bytes_(bytes) { read_header(most_pixels); }

  [[nodiscard]] Image image() {
    // Least size of a scanline in bytes: flat, four for each pixel; with runs, four that announce them, and
    // for each channel two for a run of 127.
    const std::int64_t flat = 4 * std::int64_t{width_},
                       runs = 4 + 4 * 2 * ((std::int64_t{width_} + 126) / 127);
    bytes_.require_bytes(height_ * (may_have_runs() ? std::min(flat, runs) : flat),
                         static_cast<std::int64_t>(bytes_.rest().size()), "pixels");
    std::array<float, 256> unit{};  // by exponent; 0 for exponent 0, with any mantissa
    for (int e = 1; e < 256; ++e) unit[static_cast<std::size_t>(e)] = std::ldexp(1.0f, e - 136);
    Image image(width_, height_);
    std::vector<unsigned char> line(4 * static_cast<std::size_t>(width_));
    for (row_ = 0; row_ < height_; ++row_) {
      read_scanline(line);
      for (int x = 0; x < width_; ++x) {
        const unsigned char* const rgbe = &line[4 * static_cast<std::size_t>(x)];
        const auto light = [&](int channel) { return static_cast<float>(rgbe[channel]) * unit[rgbe[3]]; };
        image(x, row_) = {light(0), light(1), light(2)};
      }
    }
    return image;
  }

 private:
  std::string_view line() { return bytes_.take_until('\n', "the header"); }

  void read_header(std::int64_t most_pixels) {
    (void)line();  // checked by is_hdr
    bool has_format = false;
    for (std::string_view text = line(); !text.empty(); text = line()) {
      if (!text.starts_with("FORMAT=")) continue;
      if (text != "FORMAT=32-bit_rle_rgbe")
        bytes_.refuse('"' + std::string(text.substr(0, 60)) + "\" is not FORMAT=32-bit_rle_rgbe");
      has_format = true;
    }
    if (!has_format) bytes_.refuse("there is no line FORMAT=32-bit_rle_rgbe in the header");
    const std::string_view size = line();
    std::string_view rest = size;
    const auto side = [&](std::string_view axis) {
      const bool is_axis = taken_word(rest) == axis;
      const auto length = number_of<int>(taken_word(rest));
      return is_axis ? length : std::nullopt;
    };
    const auto height = side("-Y"), width = side("+X");
    if (!height || !width || !taken_word(rest).empty())
      bytes_.refuse('"' + std::string(size.substr(0, 60)) + "\" is not a size, -Y HEIGHT +X WIDTH");
    bytes_.require_pixels(*width, *height, most_pixels);
    width_ = *width;
    height_ = *height;
  }

  /// Returns true if scanlines may have runs; at other widths they are flat.
  [[nodiscard]] bool may_have_runs() const { return 8 <= width_ && width_ < 32768; }

  [[nodiscard]] std::string place() const {
    return "scanline " + std::to_string(row_) + " of " + std::to_string(height_);
  }

  void read_scanline(std::vector<unsigned char>& line) {
    const std::string_view rest = bytes_.rest();
    if (may_have_runs() && rest.starts_with("\x02\x02") && rest.size() > 2 &&
        static_cast<unsigned char>(rest[2]) < 128) {
      if (const std::uint32_t width = bytes_.number(4, place()) & 0xffff;
          width != static_cast<std::uint32_t>(width_))
        bytes_.refuse(place() + " has " + std::to_string(width) + " pixels; the picture is " +
                      std::to_string(width_) + " wide");
      for (std::size_t channel = 0; channel < 4; ++channel) read_runs(line, channel);
    } else {
      const std::string_view flat = bytes_.take(line.size(), place());
      std::copy(flat.begin(), flat.end(), line.begin());
      for (std::size_t i = 0; i < line.size(); i += 4)
        if (line[i] == 1 && line[i + 1] == 1 && line[i + 2] == 1)
          bytes_.refuse(place() +
                        " has a repeated pixel (1, 1, 1, n), the old form of a run, which is not read");
    }
  }

  void read_runs(std::vector<unsigned char>& line, std::size_t channel) {
    const std::size_t width = static_cast<std::size_t>(width_);
    const std::string where = place();
    for (std::size_t x = 0; x < width;) {
      const std::size_t start = bytes_.at();
      const std::uint32_t code = bytes_.number(1, where);
      const bool is_repeated = code > 128;
      const std::size_t count = is_repeated ? code - 128 : code;
      if (count == 0 || count > width - x)
        bytes_.refuse(place() + " has a run of " + std::to_string(count) + " pixels at byte " +
                      std::to_string(start) + "; allowed are 1 to " + std::to_string(width - x));
      const std::string_view values = bytes_.take(is_repeated ? 1 : count, where);
      for (std::size_t i = 0; i < count; ++i, ++x)
        line[4 * x + channel] = static_cast<unsigned char>(values[is_repeated ? 0 : i]);
    }
  }

  ImageBytes bytes_;
  int width_ = 0, height_ = 0, row_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail

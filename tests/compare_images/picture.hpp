// Pictures as files hold them, and the difference of two.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

/// Codes of red, green and blue in rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> pixels;
};

inline bool same_size(const Picture& a, const Picture& b) {
  return a.width == b.width && a.height == b.height;
}

struct Difference {
  int pixels = 0;   ///< number of pixels that differ in any channel
  int largest = 0;  ///< largest difference of a channel, in levels
};

/// Returns the difference of two pictures of the same size.
inline Difference difference(const Picture& a, const Picture& b) {
  Difference result;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    if (a.pixels[i] != b.pixels[i]) ++result.pixels;
    for (std::size_t c = 0; c < 3; ++c)
      result.largest = std::max(result.largest, std::abs(a.pixels[i][c] - b.pixels[i][c]));
  }
  return result;
}

/// Returns a part of a picture, whose upper left pixel is at column left and row top.
inline Picture part_of(const Picture& whole, int left, int top, int width, int height) {
  Picture part{width, height, {}};
  for (int y = top; y < top + height; ++y)
    for (int x = left; x < left + width; ++x)
      part.pixels.push_back(whole.pixels.at(static_cast<std::size_t>(y * whole.width + x)));
  return part;
}

// Comparison of pictures.
#pragma once

#include <protostar/image.hpp>

/// Returns the number of pixels that satisfy a condition on (x, y).
inline int count_pixels(const protostar::Image& image, auto&& condition) {
  int count = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (condition(x, y)) ++count;
  return count;
}

/// Returns the number of pixels that differ between two pictures of one size.
inline int different_pixels(const protostar::Image& a, const protostar::Image& b) {
  return count_pixels(a, [&](int x, int y) { return a(x, y) != b(x, y); });
}

// A test picture for file formats.
#pragma once

#include <protostar/image.hpp>

#include "random.hpp"

/// Returns random light, some of it below 0 and above 1.
inline protostar::Image random_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  protostar::Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image(x, y) = 1.5f * random.color() - 0.2f;
  return image;
}

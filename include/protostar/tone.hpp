// Tone: the exposure of linear light, and the treatment of light above 1, before it is encoded.
#pragma once

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "image.hpp"
#include "shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Treatment of channels above 1: a file of codes holds at most 1, and only one of linear light (PFM, HDR)
/// more.
enum class Tone {
  clip,         ///< the encoder cuts each channel at 1
  scale_pixel,  ///< a pixel is divided by its largest channel if above 1, so that it keeps its hue
  scale_image,  ///< the image is divided by its largest channel, if that is above 0
};

namespace detail {

/// Throws std::invalid_argument, which names the caller, unless an exposure is from 0 to the largest float: a
/// larger one would be infinite as a float, and black times it NaN.
inline void require_exposure(const std::string& caller, double exposure) {
  if (!(exposure >= 0 && exposure <= std::numeric_limits<float>::max()))
    throw std::invalid_argument(caller + ": exposure must be from 0 to 3.4e38, the largest float; it is " +
                                shown(exposure));
}

}  // namespace detail

/// Multiplies all light by a factor, and clamps it to the largest float; a factor of 1 leaves the image as it
/// is, with what is infinite. Throws std::invalid_argument unless the factor is from 0 to the largest float.
inline void expose(Image& image, double exposure) {
  detail::require_exposure("expose", exposure);
  if (exposure == 1) return;
  const auto factor = static_cast<float>(exposure);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      image(x, y) = factor > 0 ? clamped(factor * image(x, y)) : Color{0};  // 0 · ∞ is NaN
}

/// Applies a tone to an image.
inline void apply(Tone tone, Image& image) {
  if (tone == Tone::clip) return;
  float largest = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Color light = clamped(image(x, y));  // infinite light as the largest float
      const float channel = std::max({0.0f, light.r, light.g, light.b});  // NaN counts as 0
      largest = std::max(largest, channel);
      if (tone == Tone::scale_pixel && channel > 1) image(x, y) = light / channel;
    }
  if (tone != Tone::scale_image || !(largest > 0)) return;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) image(x, y) = clamped(image(x, y)) / largest;
}

}  // namespace protostar::inline PROTOSTAR_ABI

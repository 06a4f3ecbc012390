// The pixels of an image on the film of a camera, with the places of their samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "camera.hpp"
#include "render_options.hpp"
#include "sampling/exact_sum.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Position in a pixel, from (0, 0) at its top left to (1, 1).
struct PixelSample {
  double x, y;
};

/// Returns n positions in a pixel, the same for every pixel: each of n columns and n rows of equal size has
/// one. The i-th is in the middle of column i, and of the row whose number is the rank of i's binary digits,
/// read backwards, among those of 0 to n − 1 (Hammersley's points, the fraction of each moved to the middle
/// of a row). For n ≤ 1 it is the pixel's center alone.
[[nodiscard, gnu::cold]] inline std::vector<PixelSample> pixel_samples(int n) {
  if (n <= 1) return {{0.5, 0.5}};
  const auto count = static_cast<std::uint32_t>(n);
  std::uint32_t power = 1;
  while (power < count) power *= 2;
  std::vector<PixelSample> samples(count);
  std::uint32_t rank = 0;
  for (std::uint32_t row = 0; row < power; ++row) {
    std::uint32_t i = 0;  // binary digits of row, read backwards
    for (std::uint32_t from = 1, to = power / 2; from < power; from *= 2, to /= 2)
      if (row & from) i |= to;
    if (i < count) samples[i] = {(i + 0.5) / n, (rank++ + 0.5) / n};
  }
  return samples;
}

/// Pixels of an image, which is a whole picture or a part of one.
class PixelGrid {
 public:
  /// Throws std::invalid_argument if the number of samples is negative, or if the picture that the image is
  /// cropped from does not contain it.
  [[gnu::cold]] PixelGrid(int width, int height, const RenderOptions& options = {})
      : crop_(options.crop.width == 0 && options.crop.height == 0 ? Crop{0, 0, width, height} : options.crop),
        samples_(pixel_samples(options.samples)) {
    if (options.samples < 0 || options.samples > most_samples_of_pixel)
      throw std::invalid_argument("RenderOptions: samples must be from 0 to " +
                                  std::to_string(most_samples_of_pixel) + "; it is " +
                                  std::to_string(options.samples));
    const auto holds = [](int whole, int first, int size) {
      return first >= 0 && first <= whole && size <= whole - first;
    };
    if (!holds(crop_.width, crop_.x, width) || !holds(crop_.height, crop_.y, height))
      throw std::invalid_argument(
          "RenderOptions: crop must be the size of a picture that holds the image; " + std::to_string(width) +
          "x" + std::to_string(height) + " at " + std::to_string(crop_.x) + ", " + std::to_string(crop_.y) +
          " is not inside " + std::to_string(crop_.width) + "x" + std::to_string(crop_.height));
  }

  /// Returns the film's u at a position in column x of the image, or v in row y; position 0 is the left or
  /// upper edge, 1 the other.
  [[nodiscard]] double u(int x, double position) const {
    return Camera::u_at(crop_.x + x + position, crop_.width, crop_.height);
  }
  [[nodiscard]] double v(int y, double position) const {
    return Camera::v_at(crop_.y + y + position, crop_.height);
  }

  /// Returns u at the right edge of the whole picture; v at its upper edge is 1.
  [[nodiscard]] double largest_u() const { return Camera::u_at(crop_.width, crop_.width, crop_.height); }

  [[nodiscard]] int samples() const { return static_cast<int>(samples_.size()); }
  [[nodiscard]] const PixelSample& sample(int i) const { return samples_[static_cast<std::size_t>(i)]; }

  /// Returns the ray of a camera through the i-th sample of pixel (x, y).
  [[nodiscard]] Ray ray(const Camera& camera, int x, int y, int i) const {
    return camera(u(x, sample(i).x), v(y, sample(i).y));
  }

  /// Returns the mean of light(i) over the samples i: a single one as it is, of several an exact sum, divided
  /// and rounded once.
  [[nodiscard]] Color mean(const auto& light) const {
    if (samples() == 1) return light(0);
    ExactColorSum sum;
    for (int i = 0; i < samples(); ++i) sum.add(light(i));
    return sum.mean(static_cast<std::uint32_t>(samples()));
  }

 private:
  Crop crop_;
  std::vector<PixelSample> samples_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

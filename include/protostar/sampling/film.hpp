// Film: the exact sums of the samples of each pixel, in two independent halves that tell the error.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "../image.hpp"
#include "../plain_vector.hpp"
#include "estimate.hpp"
#include "exact_sum.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Sums of the radiance of a pixel's samples. Sample i belongs to scrambling_of(i). Errors are those of
/// samplers whose two scramblings are independent, such as SobolSampler; of HammersleySampler and
/// StratifiedSampler, which are not, they tell nothing, and Film refuses to tell them. Their samples must be
/// fewer than 2^32 together.
struct PixelSums {
  std::array<ExactColorSum, scramblings> sums;
  std::array<std::uint32_t, scramblings> counts{};

  /// Adds the radiance of sample i.
  void add(std::uint32_t i, const Color& radiance) {
    sums[scrambling_of(i)].add(radiance);
    ++counts[scrambling_of(i)];
  }

  /// Adds `count` samples of a scrambling, given as their sum.
  void add_sum(std::uint32_t scrambling, const ExactColorSum& sum, std::uint32_t count) {
    sums[scrambling] += sum;
    counts[scrambling] += count;
  }

  PixelSums& operator+=(const PixelSums& other) {
    for (std::size_t i = 0; i < scramblings; ++i) sums[i] += other.sums[i], counts[i] += other.counts[i];
    return *this;
  }

  friend bool operator==(const PixelSums& a, const PixelSums& b) {
    return a.sums == b.sums && a.counts == b.counts;
  }

  [[nodiscard]] std::uint32_t count() const { return counts[0] + counts[1]; }

  /// Returns the mean of all samples, each channel rounded once; black for none.
  [[nodiscard]] Color mean() const {
    ExactColorSum all = sums[0];
    all += sums[1];
    return all.mean(count());
  }

  /// Returns an estimate of the squared error of a channel of the mean, or infinity if a scrambling has no
  /// samples: w² (a − b)² for the means a and b of the scramblings, where the larger one holds the share w of
  /// the samples. Its expectation is w² (Var a + Var b). For equally many samples w = 1/2, and it is that of
  /// the squared error (PictureError); otherwise it is larger. Its rounding error is below 2^-50 |mean| |a −
  /// b|.
  [[nodiscard]] double squared_error(std::size_t channel) const {
    static_assert(scramblings == 2);
    if (counts[0] == 0 || counts[1] == 0) return std::numeric_limits<double>::infinity();
    const double share = static_cast<double>(std::max(counts[0], counts[1])) / count();
    const double difference = share * (sums[0].channels[channel].value() / counts[0] -
                                       sums[1].channels[channel].value() / counts[1]);
    return difference * difference;
  }

  /// Returns the mean of the squared errors of the channels.
  [[nodiscard]] double squared_error() const {
    return (squared_error(0) + squared_error(1) + squared_error(2)) / 3;
  }

  /// Returns the standard error of each channel of the mean: the root of squared_error, which estimates a
  /// standard deviation from two values and so is itself often off by half, or nearly 0.
  [[nodiscard]] Color standard_error() const {
    return {to_float(std::sqrt(squared_error(0))), to_float(std::sqrt(squared_error(1))),
            to_float(std::sqrt(squared_error(2)))};
  }
};

/// Sums of the pixels of a picture, or of the part of it that a tile tells.
///
/// An error can be told if all samples are those of a sampler with independent scramblings (PixelSums):
/// SobolSampler, HaltonSampler or IndependentSampler. add_samples notes if others are added.
class Film {
 public:
  /// Makes a film without samples. Throws std::invalid_argument for a tile without pixels or with more than
  /// Image::max_pixels.
  explicit Film(const Tile& area)
      : area_(area),
        pixels_(
            Image::require_size("Film", std::int64_t{area.x1} - area.x0, std::int64_t{area.y1} - area.y0)) {}

  [[nodiscard]] const Tile& tile() const { return area_; }

  /// Returns the pixel in column x and row y of the picture, which has to be in the tile.
  [[nodiscard]] PixelSums& operator()(int x, int y) { return pixels_[index(x, y)]; }
  [[nodiscard]] const PixelSums& operator()(int x, int y) const { return pixels_[index(x, y)]; }

  /// Adds the samples of another film. Throws std::invalid_argument if its tile is another.
  Film& operator+=(const Film& other) {
    if (other.area_.x0 != area_.x0 || other.area_.y0 != area_.y0 || other.area_.x1 != area_.x1 ||
        other.area_.y1 != area_.y1)
      throw std::invalid_argument("Film: only films of one tile can be added");
    for (std::size_t i = 0; i < pixels_.size(); ++i) pixels_[i] += other.pixels_[i];
    tells_error_ = tells_error_ && other.tells_error_;
    return *this;
  }

  /// Returns true if tiles, sums and numbers of samples are equal.
  friend bool operator==(const Film& a, const Film& b) {
    return a.area_.x0 == b.area_.x0 && a.area_.y0 == b.area_.y0 && a.area_.x1 == b.area_.x1 &&
           a.area_.y1 == b.area_.y1 && a.pixels_ == b.pixels_;
  }

  /// Returns the picture: the mean of each pixel's samples; black without any.
  [[nodiscard]] Image mean() const {
    return image_of([](const PixelSums& pixel) { return pixel.mean(); });
  }

  /// Notes that the film has samples, added already or soon, of which no error can be told
  /// (SamplerChoice::needs_number).
  void lose_error() { tells_error_ = false; }

  /// Returns the standard error of each pixel's channels. Throws std::logic_error if none can be told.
  [[nodiscard]] Image standard_error() const {
    require_error();
    return image_of([](const PixelSums& pixel) { return pixel.standard_error(); });
  }

  /// Returns the estimate of the picture's error, if its pixels are independent of each other. It adds up the
  /// pixels in rows, so it is the same wherever it is computed. Throws std::logic_error if none can be told.
  [[nodiscard]] PictureError error() const {
    require_error();
    PictureError error;
    for (const PixelSums& pixel : pixels_) error.add(pixel.squared_error());
    return error;
  }

 private:
  void require_error() const {
    if (!tells_error_)
      throw std::logic_error(
          "Film: its samples tell no error, since they depend on each other or on their number, as those of "
          "HammersleySampler and StratifiedSampler; draw all of them with SobolSampler, HaltonSampler or "
          "IndependentSampler");
  }

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - area_.y0) * static_cast<std::size_t>(area_.width()) +
           static_cast<std::size_t>(x - area_.x0);
  }

  [[nodiscard]] Image image_of(const auto& color) const {
    Image image(area_.width(), area_.height());
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) image(x, y) = color((*this)(area_.x0 + x, area_.y0 + y));
    return image;
  }

  Tile area_;
  PlainVector<PixelSums> pixels_;
  bool tells_error_ = true;
};

}  // namespace protostar::inline PROTOSTAR_ABI

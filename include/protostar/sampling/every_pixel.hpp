// Pictures each pixel of which is known to within an error, with a probability that is proven.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "../image.hpp"
#include "../parallel.hpp"
#include "../plain_vector.hpp"
#include "../render_options.hpp"
#include "../shown.hpp"
#include "estimate.hpp"
#include "exact_sum.hpp"
#include "film.hpp"
#include "hash.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Rule for the channels of all pixels of a picture: draw until each is known to within an error. With a
/// probability of at least 95 % none of them is further off, whatever is drawn, as long as light is clamped
/// and the numbers of samplers are as random as they look.
///
/// Samples come in blocks, each of which has a seed of its own, and in a block in two scramblings. The mean
/// of a block's samples in one scrambling is an observation of BernsteinSequence: observations are
/// independent of each other, and their mean is the truth, though the samples of a scrambling depend on each
/// other. The 5 % are shared by all channels of all pixels alike: 5 %/3P each.
///
/// Sums are in fixed point, in which each sample has an error of up to 2^-48 (ExactSum): all light below
/// 2^-48 counts as black. So the means may be off by as much however many samples there are, and the
/// sequences do not see it. Therefore their target is the error that is asked for less 2^-48, and 2^-48 is
/// added to the errors that they tell; an error of 2^-48 or less is refused. The picture's value is the mean
/// as a float, and its rounding to one is a part of the error too.
class EveryPixel {
 public:
  /// Makes the rule for the pixels of a tile: no channel, clamped to [0, clamp], may be off by more than the
  /// error, in linear light. Throws std::invalid_argument unless both are finite, the error is greater than
  /// 2^-48, and the clamp greater than 0.
  EveryPixel(double error, double clamp, const Tile& area)
      : rule_(most_of(clamp), target_of(error), (1 - PictureError::confidence) / channels(area)),
        in_observation_(samples_of_observation(rule_)),
        area_(area) {}

  /// Returns the number of samples of each pixel in a block, which make one observation for each scrambling.
  [[nodiscard]] std::uint32_t samples_of_block() const { return scramblings * in_observation_; }

  /// Returns the least number of samples of each pixel that the rule takes, however little they differ.
  [[nodiscard]] double least_samples() const {
    return std::ceil(rule_.least_observations() / scramblings) * samples_of_block();
  }

  /// Returns the seed of block i of a picture: another one for each block.
  [[nodiscard]] static std::uint64_t seed_of_block(std::uint64_t seed, std::uint64_t i) {
    return i == 0 ? seed : sampling::mix(seed + i * sampling::golden);
  }

  /// Moves the samples of a block to those of the picture, which leaves the block empty. Returns the largest
  /// error that a channel of the picture's means may have. Both films have the tile of the rule, and the
  /// block samples_of_block() samples in each pixel.
  [[nodiscard]] double add(Film& block, Film& picture, const RenderOptions& options) {
    if (sequences_.empty())
      sequences_.resize(static_cast<std::size_t>(channels(area_)), BernsteinSequence(rule_));
    PlainVector<double> largest(static_cast<std::size_t>(area_.height()), 0);
    detail::for_each_in_parallel(area_.height(), {.threads = options.threads}, [&](int row) {
      BernsteinSequence* sequence = sequences_.begin() + std::ptrdiff_t{3} * row * area_.width();
      double& most = largest[static_cast<std::size_t>(row)];
      const int y = area_.y0 + row;
      for (int x = area_.x0; x < area_.x1; ++x) {
        PixelSums &drawn = block(x, y), &sums = picture(x, y);
        sums += drawn;
        const Color mean = sums.mean();
        for (std::size_t channel = 0; channel < 3; ++channel, ++sequence) {
          for (std::size_t s = 0; s < scramblings; ++s)
            sequence->add(drawn.sums[s].channels[channel].value() / drawn.counts[s]);
          most = std::max(most,
                          sequence->error_of(mean[static_cast<int>(channel)]) + ExactSum::largest_rounding);
        }
        drawn = {};
      }
    });
    return *std::max_element(largest.begin(), largest.end());
  }

 private:
  /// Returns the largest value of a channel with a clamp: a sum counts no number above ExactSum::most.
  static double most_of(double clamp) {
    if (!(clamp > 0 && std::isfinite(clamp)))
      throw std::invalid_argument("EveryPixel: clamp must be finite and greater than 0; it is " +
                                  shown(clamp));
    return std::min<double>(clamp, ExactSum::most);
  }

  /// Returns the part of an error that is left to the sequences.
  static double target_of(double error) {
    if (!(error > ExactSum::largest_rounding))
      throw std::invalid_argument(
          "EveryPixel: error must be greater than 2^-48 (3.6e-15), with which a sample may count; it is " +
          shown(error));
    return error - ExactSum::largest_rounding;
  }

  static double channels(const Tile& area) { return 3.0 * area.width() * area.height(); }

  /// Returns how many samples m make an observation, a power of two.
  ///
  /// The rule takes at least about L C/(.75 E) observations, for C = most, and 2 L s²/E² of variance s². At
  /// an edge of contrast 1, a sample has a variance of up to 1/4, and the mean of m samples that are spread
  /// evenly m^-1.5 times that. Both numbers of observations are equal for m^1.5 = .375/(E C); more samples
  /// than that in an observation would cost more where little differs than they save at edges.
  static std::uint32_t samples_of_observation(const BernsteinRule& rule) {
    const double ratio = 0.375 / (rule.target() * rule.most()), square = ratio * ratio;
    std::uint32_t m = 1;
    while (m < 64 && 8.0 * m * m * m <= square) m *= 2;
    return m;
  }

  BernsteinRule rule_;
  std::uint32_t in_observation_;
  Tile area_;
  PlainVector<BernsteinSequence> sequences_;  ///< of the channels of the pixels, in rows
};

}  // namespace protostar::inline PROTOSTAR_ABI

// Hammersley's points, the same in every pixel: pictures without noise.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "../platform.hpp"
#include "../simd/vectors.hpp"
#include "sampler.hpp"
#include "sobol_sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace sampling {

/// Returns the rank of i among 0 to count − 1, ordered by their binary digits read backwards: the number of
/// all k < count that come before i. k comes before i if both agree in their lowest digits up to some digit,
/// which is 1 in i and 0 in k; these are the k that leave the rest i mod 2^digit when divided by
/// 2^(digit + 1).
[[nodiscard]] constexpr std::uint32_t rank_of_reversed(std::uint32_t i, std::uint32_t count) {
  std::uint32_t rank = 0;
  for (std::uint64_t bit = 1; bit <= i; bit *= 2) {
    const std::uint64_t rest = i % bit;
    if ((i & bit) != 0) rank += static_cast<std::uint32_t>((count - rest + 2 * bit - 1) / (2 * bit));
  }
  return rank;
}

}  // namespace sampling

/// Sampler whose first two numbers of set 0 are Hammersley's points, the fraction of each moved to the middle
/// of a column and of a row: each of as many columns and rows as there are samples has one, in its middle. A
/// single one is the middle of the pixel.
///
/// Points are the same for every pixel, and for every seed. All other numbers are those of SobolSampler for
/// the pixel (0, 0): for every pixel the same too, so that a soft shadow, or what is out of focus, consists
/// of as many sharp ones as there are samples, and has no noise. Its error shows in no difference between
/// pixels, which is why no estimate of errors can use it.
template <class Word>
class BasicHammersleySampler {
 public:
  using NeedsNumber = void;      ///< the numbers depend on how many samples there are
  using HasCommonPlaces = void;  ///< the first two numbers of set 0 are the same in every pixel

  explicit BasicHammersleySampler(const BasicSampleIndex<Word>& at)
      : others_({.seed = at.seed, .sample = at.sample, .samples = at.samples}),
        samples_(std::max(at.samples, std::uint32_t{1})),
        sample_(at.sample % samples_) {}

  [[nodiscard]] auto operator()(std::uint32_t set) const {
    SampleSet<double> numbers = others_(set);
    if (set == 0) {
      numbers[0] = (sample_ + 0.5) / samples_;
      numbers[1] = (sampling::rank_of_reversed(sample_, samples_) + 0.5) / samples_;
    }
    if constexpr (std::is_same_v<Word, std::uint32_t>)
      return numbers;
    else
      return SampleSet<simd::Doubles>{numbers[0], numbers[1], numbers[2], numbers[3]};
  }

 private:
  SobolSampler others_;
  std::uint32_t samples_, sample_;
};
using HammersleySampler = BasicHammersleySampler<std::uint32_t>;
static_assert(Sampler<HammersleySampler>);

}  // namespace protostar::inline PROTOSTAR_ABI

// Independent random numbers: the error falls as samples^-1/2, whatever is integrated.
#pragma once

#include <array>
#include <cstdint>

#include "../platform.hpp"
#include "../simd/words.hpp"
#include "hash.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace sampling {

/// Returns four words that look independent of each other and of those of any other key, set and part.
template <class LongWord>
[[nodiscard]] auto independent_words(LongWord key, std::uint32_t set, std::uint32_t part) {
  const LongWord first = set_key(key, set, part), second = mix(first + LongWord(golden));
  return std::array{simd::low_word(first), simd::high_word(first), simd::low_word(second),
                    simd::high_word(second)};
}

}  // namespace sampling

/// Sampler without any order among its numbers.
template <class Word>
class BasicIndependentSampler {
 public:
  explicit BasicIndependentSampler(const BasicSampleIndex<Word>& at)
      : key_(sampling::pixel_key(at.seed, at.x, at.y)), sample_(at.sample) {}

  [[nodiscard]] auto operator()(std::uint32_t set) const {
    const auto [a, b, c, d] = sampling::independent_words(key_, set, sample_);
    return SampleSet<decltype(simd::to_unit(a))>{simd::to_unit(a), simd::to_unit(b), simd::to_unit(c),
                                                 simd::to_unit(d)};
  }

 private:
  decltype(simd::widened(Word())) key_;
  std::uint32_t sample_;
};
using IndependentSampler = BasicIndependentSampler<std::uint32_t>;
static_assert(Sampler<IndependentSampler>);

}  // namespace protostar::inline PROTOSTAR_ABI

// Halton's points, scrambled: coordinates are the digits of the index in the bases 2, 3, 5 and 7, read
// backwards.
//
// Any run of 2^a · 3^b · 5^c · 7^d indices has one point in each of as many boxes. Errors fall as for Sobol's
// points, but later, since such numbers are large; and the digits take longer to compute.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../platform.hpp"
#include "../simd/words.hpp"
#include "hash.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace sampling {

/// Returns the digits of an index in a prime base, scrambled and read backwards, as a word n of which
/// (n + ½) · 2^-32 is the coordinate.
///
/// The scrambling is nested: a digit d becomes (c + m d) modulo the base, for an offset c and a factor m ≠ 0
/// that belong to the digits before it. For two digits d ≠ d', each pair of different results comes from just
/// one c and m, so that any two points lie as if the digits were permuted at random, in all ways alike.
///
/// An index has infinitely many digits, all but the first few of them 0. They are not computed: u is a random
/// number between 0 and 1, in units of 2^-32, whose digits are the offsets after the digits so far. As long
/// as the index has zeros, the results are the digits of u; after another digit there is a new u. The
/// coordinate is (results so far + u)/base^count. It is uniform but for 2^-29: all digits are, but for u's
/// rounding.
template <std::uint32_t base>
[[nodiscard]] std::uint32_t scrambled_digits(std::uint32_t index, std::uint64_t key) {
  constexpr std::uint64_t most = (std::uint64_t{1} << 32) / base;
  std::uint64_t results = 0, power = 1;  // base^count
  std::uint64_t node = mix(key + base * golden);
  auto u = simd::high_word(node);
  // The digits that fit into a word: an index from base^13 = 1.2 · 10^9 on (base 5) lacks its highest digit.
  for (; index != 0 && power <= most; index /= base, power *= base) {
    const std::uint32_t digit = index % base;
    const std::uint64_t shifted = std::uint64_t{u} * base;  // u's first digit, and the rest
    std::uint64_t result = shifted >> 32;
    u = simd::low_word(shifted);
    if (digit != 0) {
      const std::uint64_t hash = mix(node + power);
      const std::uint64_t factor = 1 + ((hash >> 32) * (base - 1) >> 32);
      result = (result + factor * digit) % base;
      node = hash + digit * golden;
      u = simd::high_word(mix(node));
    }
    results = results * base + result;
  }
  return static_cast<std::uint32_t>((results << 32 | u) / power);
}

}  // namespace sampling

/// Sampler of Halton's points in four dimensions, scrambled for each pixel and set by itself.
///
/// As with Sobol's points, even and odd samples belong to two scramblings, and the first 2^k indices are
/// shuffled among themselves; so each block of 2^k is a run of indices.
class HaltonSampler {
 public:
  explicit HaltonSampler(const SampleIndex& at)
      : key_(sampling::pixel_key(at.seed, at.x, at.y)),
        scrambling_(scrambling_of(at.sample)),
        index_(at.sample / scramblings) {}

  [[nodiscard]] SampleSet<double> operator()(std::uint32_t set) const {
    const std::uint64_t key = sampling::set_key(key_, set, scrambling_);
    const std::uint32_t low = simd::low_word(key), high = simd::high_word(key);
    const auto seed = [&](std::size_t i) { return sampling::seed_of(low, sampling::factors[i]); };
    const std::uint32_t last = sampling::word_of(low, high, sampling::factors[2]);
    const std::uint32_t index = simd::reversed(sampling::shuffled(simd::reversed(index_), seed(0)));
    return {simd::to_unit(simd::reversed(sampling::nested(index, seed(1))) ^ last),
            simd::to_unit(sampling::scrambled_digits<3>(index, key)),
            simd::to_unit(sampling::scrambled_digits<5>(index, key)),
            simd::to_unit(sampling::scrambled_digits<7>(index, key))};
  }

 private:
  std::uint64_t key_;
  std::uint32_t scrambling_, index_;
};
static_assert(Sampler<HaltonSampler>);

}  // namespace protostar::inline PROTOSTAR_ABI

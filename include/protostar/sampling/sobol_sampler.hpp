// Sobol's points, scrambled: the error falls as samples^-1.5 for smooth light on two numbers of one set, and
// as samples^-0.75 at edges; light that depends on several sets together has the rate of independent samples.
//
// Sobol's points are a digital sequence: the digits of coordinate d are sums modulo 2 of digits of the index,
//   digits of the coordinate = C_d · digits of the index,
// with a matrix C_d of zeros and ones for each coordinate. In the first two coordinates, each of the 2^k
// boxes of size 2^-a × 2^-b with a + b = k has exactly one of the first 2^k points, and one of each further
// 2^k. In four coordinates, each box of volume 2^(3 − k) has 8 of them.
//
// A nested uniform scrambling (hash.hpp) of each coordinate keeps these properties and makes the points
// random: each is uniform in the unit cube, so that the mean of any function of them is right on average.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/words.hpp"
#include "hash.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace sampling {

// The matrices take digits of the index from its lowest, and the results have the first digit after the point
// lowest.

/// Returns the digits of the second coordinate; those of the first are the index itself.
///
/// The matrix is Pascal's triangle modulo 2: digit i of the result is the sum of all digits k of the index
/// for which the number of ways to choose i from k is odd. By Lucas' theorem it is odd if k has every binary
/// digit that i has. The condition is one for each of the five digits of i and k by itself, so the sum is
/// done digit by digit: a step adds the digits k with 2^b to those without.
[[nodiscard]] constexpr std::uint32_t pascal(std::uint32_t x) {
  x = x ^ (x >> 1 & 0x55555555);
  x = x ^ (x >> 2 & 0x33333333);
  x = x ^ (x >> 4 & 0x0f0f0f0f);
  x = x ^ (x >> 8 & 0x00ff00ff);
  return x ^ x >> 16;
}

/// Columns of a coordinate's matrix.
using Columns = std::array<std::uint32_t, 32>;

/// Columns of the four matrices. The third and fourth are those of Joe and Kuo (2008): a primitive polynomial
/// x^s + … + 1 and s odd numbers m. Column k < s holds m_k · 2^-(k + 1); each further column is the sum
/// modulo 2 of column k − s shifted by s digits, and of column k − i for each power x^(s − i) of the
/// polynomial with 0 < i ≤ s. Here these are x² + x + 1 with m = 1, 3 and x³ + x + 1 with m = 1, 3, 1.
inline constexpr std::array<Columns, 4> sobol_columns = [] {
  std::array<Columns, 4> all{};
  for (std::size_t k = 0; k < 32; ++k) {
    all[0][k] = std::uint32_t{1} << k;
    all[1][k] = pascal(all[0][k]);
  }
  const auto fill = [](Columns& columns, const auto& m, std::uint32_t powers) {
    const std::size_t s = std::size(m);
    for (std::size_t k = 0; k < s; ++k) columns[k] = m[k] << (31 - k);
    for (std::size_t k = s; k < 32; ++k) {
      columns[k] = columns[k - s] >> s;
      for (std::size_t i = 1; i <= s; ++i)
        if ((powers >> (s - i) & 1) != 0) columns[k] ^= columns[k - i];
    }
    for (std::uint32_t& column : columns) column = simd::reversed(column);
  };
  fill(all[2], std::array<std::uint32_t, 2>{1, 3}, 0b111);
  fill(all[3], std::array<std::uint32_t, 3>{1, 3, 1}, 0b1011);
  return all;
}();

/// Returns the sum modulo 2 of the columns that a group of digits of the index chooses.
[[nodiscard]] constexpr std::uint32_t sum_of_columns(const Columns& columns, std::size_t first,
                                                     std::size_t digits) {
  std::uint32_t sum = 0;
  for (std::size_t k = first; k < 32 && digits != 0; ++k, digits /= 2)
    if (digits % 2 != 0) sum ^= columns[k];
  return sum;
}

/// Sums of columns of all four matrices side by side, for every group of four digits of an index.
inline constexpr auto sums_of_all = [] {
  std::array<std::array<std::array<std::uint32_t, 4>, 16>, 8> table{};
  for (std::size_t group = 0; group < 8; ++group)
    for (std::size_t digits = 0; digits < 16; ++digits)
      for (std::size_t d = 0; d < 4; ++d)
        table[group][digits][d] = sum_of_columns(sobol_columns[d], 4 * group, digits);
  return table;
}();

/// Returns a coordinate, in units of 2^-32, from its digits with the first one lowest. `low` and `high` are
/// the halves of a set's key. With one factor they give the seed of the nested scrambling, and with the other
/// a word that is added modulo 2.
template <class Word>
[[nodiscard]] Word scrambled(Word digits, Word low, Word high, Word factor, Word last_factor) {
  return simd::reversed(nested(digits, seed_of(low, factor))) ^ word_of(low, high, last_factor);
}

/// Returns the four numbers of the point with an index, scrambled by the halves of a set's key. The four
/// coordinates are computed side by side in lanes, where there are any.
[[nodiscard]] inline SampleSet<double> sobol_numbers(std::uint32_t index, std::uint32_t low,
                                                     std::uint32_t high) {
  if constexpr (simd::double_lanes > 1) {
    using FourWords = simd::Lanes<std::uint32_t, 4>;
    FourWords digits(0u);
    for (std::size_t group = 0; index != 0; ++group, index /= 16)
      digits = digits ^ FourWords::load(sums_of_all[group][index % 16].data());
    return simd::to_units(scrambled(digits, FourWords(low), FourWords(high), FourWords::load(factors + 1),
                                    FourWords::load(factors + 5)));
  } else {
    std::array<std::uint32_t, 4> digits{};
    for (std::size_t group = 0; index != 0; ++group, index /= 16)
      for (std::size_t d = 0; d < 4; ++d) digits[d] ^= sums_of_all[group][index % 16][d];
    SampleSet<double> numbers;
    for (std::size_t d = 0; d < 4; ++d)
      numbers[d] = simd::to_unit(scrambled(digits[d], low, high, factors[1 + d], factors[5 + d]));
    return numbers;
  }
}

#if defined(PROTOSTAR_VECTORS) && defined(__AVX2__)
/// Sums of columns for every group of digits of the index that a look-up takes: of the first and second
/// matrix, and of the third and fourth.
inline constexpr auto sums_by_group = [] {
  constexpr std::size_t step = simd::digits_looked_up;
  std::array<std::array<simd::LookUpTables, 2>, 32 / step> tables{};
  for (std::size_t group = 0; group < tables.size(); ++group)
    for (std::size_t d = 0; d < 4; ++d)
      for (std::size_t digits = 0; digits < std::size_t{1} << step; ++digits)
        tables[group][d / 2][(d % 2 << step) + digits] =
            sum_of_columns(sobol_columns[d], group * step, digits);
  return tables;
}();

/// Returns the numbers of a point in each lane, for indices of at most some digits. Two coordinates go
/// together, in twice as many lanes.
[[nodiscard]] inline SampleSet<simd::Doubles> sobol_numbers(simd::Words index, int digits, simd::Words low,
                                                            simd::Words high) {
  using simd::TwoWords;
  TwoWords first(0u), last(0u), rest = simd::joined(index, index);
  for (std::size_t group = 0; digits > 0; ++group, digits -= simd::digits_looked_up) {
    const TwoWords entries = simd::entries_of(rest);
    first = first ^ simd::looked_up(sums_by_group[group][0], entries);
    last = last ^ simd::looked_up(sums_by_group[group][1], entries);
    rest = rest >> simd::digits_looked_up;
  }
  const TwoWords lows = simd::joined(low, low), highs = simd::joined(high, high);
  const auto two = [&](TwoWords sums, std::size_t i) {
    const auto both = [](const std::uint32_t* f) { return simd::joined(f[0], f[1]); };
    return scrambled(sums, lows, highs, both(factors + 1 + i), both(factors + 5 + i));
  };
  first = two(first, 0), last = two(last, 2);
  return {simd::to_unit(simd::half_of<0>(first)), simd::to_unit(simd::half_of<1>(first)),
          simd::to_unit(simd::half_of<0>(last)), simd::to_unit(simd::half_of<1>(last))};
}
#else
/// Returns the numbers of a point in each lane.
[[nodiscard]] inline SampleSet<simd::Doubles> sobol_numbers(simd::Words index, int, simd::Words low,
                                                            simd::Words high) {
  SampleSet<simd::Doubles> numbers;
  for (int lane = 0; lane < simd::double_lanes; ++lane) {
    const SampleSet<double> of_lane = sobol_numbers(index[lane], low[lane], high[lane]);
    for (std::size_t d = 0; d < 4; ++d) numbers[d].set(lane, of_lane[d]);
  }
  return numbers;
}
#endif

}  // namespace sampling

/// Sampler of Sobol's points in four dimensions, scrambled for each pixel and set by itself.
///
/// Even samples are points of one scrambling, odd ones of another (scramblings). The points of two sets are
/// shuffled against each other: index i of the scrambling takes point j of the set, the first 2^k indices the
/// first 2^k points.
///
/// Each number of each sample takes each of its 2^32 values for exactly 2^32 of all 2^64 seeds, which makes
/// means over seeds unbiased. Seeds and keys of a set correspond one to one (hash.hpp). For each lower half
/// of the key, the scrambled digits are fixed, and a word is added to them modulo 2 that takes all values as
/// the higher half does. This proves it for functions of one number; the four numbers of a sample have more
/// digits than seeds, and it remains that the hash functions make them look independent.
template <class Word>
class BasicSobolSampler {
 public:
  explicit BasicSobolSampler(const BasicSampleIndex<Word>& at)
      : key_(sampling::pixel_key(at.seed, at.x, at.y)),
        scrambling_(scrambling_of(at.sample)),
        index_(at.sample / scramblings) {}

  [[nodiscard]] auto operator()(std::uint32_t set) const {
    const auto key = sampling::set_key(key_, set, scrambling_);
    const Word low = simd::low_word(key), high = simd::high_word(key);
    const Word order = sampling::seed_of(low, Word(sampling::factors[0]));
    const Word index = simd::reversed(sampling::shuffled(Word(simd::reversed(index_)), order));
    if constexpr (std::is_same_v<Word, std::uint32_t>)
      return sampling::sobol_numbers(index, low, high);
    else
      return sampling::sobol_numbers(index, static_cast<int>(std::bit_width(index_)), low, high);
  }

 private:
  decltype(simd::widened(Word())) key_;
  std::uint32_t scrambling_, index_;
};
using SobolSampler = BasicSobolSampler<std::uint32_t>;
static_assert(Sampler<SobolSampler>);

}  // namespace protostar::inline PROTOSTAR_ABI

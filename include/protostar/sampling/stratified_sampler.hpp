// Random numbers, one in each cell of a grid: the error falls as samples^-1 for smooth light in two
// dimensions.
//
// The number of samples has to be known in advance, and a picture that is stopped before has holes.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../simd/words.hpp"
#include "../vec3.hpp"
#include "hash.hpp"
#include "independent_sampler.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace sampling {

/// Returns place i of 0 to count − 1 in a random order of these, count ≤ 2^31. Each i gets each place with
/// the same probability, since all are turned by a random offset at the end.
///
/// The order is a bijection of all numbers with as many digits as count − 1: multiplying with odd numbers and
/// adding mixes digits upwards, adding higher digits modulo 2 mixes them downwards. Results that are too
/// large are put in again: following them from a number below count, the first that is below count again is
/// another one for each.
template <class Word>
[[nodiscard]] Word shuffled_place(std::uint32_t i, std::uint32_t count, Word first, Word second) {
  const int digits = std::max(1, static_cast<int>(std::bit_width(count - 1)));
  const Word mask = static_cast<std::uint32_t>((std::uint64_t{1} << digits) - 1);
  const auto down = static_cast<std::uint32_t>((digits + 1) / 2);
  const auto mixed = [&](Word x) {
    x = (x + first) * (second | Word(1u)) & mask;
    x = x ^ x >> down;
    x = (x + (second >> 8)) * (first >> 8 | Word(1u)) & mask;
    x = x ^ x >> down;
    x = (x + (first >> 16)) * (second >> 16 | Word(1u)) & mask;
    return x ^ x >> down;
  };
  const Word limit = count;
  Word x = mixed(i);
  for (;;) {
    const auto too_large = limit <= x;
    if (!any(too_large)) break;
    x = select(too_large, mixed(x), x);
  }
  // The offset: count times a number between 0 and 1, rounded down.
  using LongWord = decltype(simd::widened(x));
  const Word offset = simd::high_word(simd::widened(first ^ second * Word(factors[0])) * LongWord(count));
  x = x + offset;
  return select(limit <= x, x - limit, x);
}

/// Grid of cells.
struct Grid {
  std::uint32_t columns, rows;
};

/// Returns the grid for n samples: with n cells, if n has divisors whose ratio is at most 2, and otherwise
/// with the least number of rows that gives at least n cells for √n columns.
[[nodiscard]] inline Grid grid_of(std::uint32_t n) {
  const auto root = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(n)));
  for (std::uint32_t columns = root; 2 * std::uint64_t{columns} * columns >= n; --columns)
    if (n % columns == 0) return {columns, n / columns};
  return {root, (n + root - 1) / root};
}

}  // namespace sampling

/// Sampler of two pairs of numbers in each set, of which each pair has at most one of the pixel's samples in
/// each cell of a grid. The samples take the cells of both pairs in an order of their own.
///
/// If the grid has more cells than there are samples, some cells are left out, all with the same probability.
/// Each sample's number is uniform. A sample beyond the number of samples begins another round, with new
/// orders.
template <class Word>
class BasicStratifiedSampler {
 public:
  using NeedsNumber = void;  ///< the numbers depend on how many samples there are

  explicit BasicStratifiedSampler(const BasicSampleIndex<Word>& at)
      : key_(sampling::pixel_key(at.seed, at.x, at.y)),
        samples_(std::clamp(at.samples, std::uint32_t{1}, std::uint32_t{1} << 30)),
        sample_(at.sample),
        grid_(sampling::grid_of(samples_)) {}

  [[nodiscard]] auto operator()(std::uint32_t set) const {
    // Parts of a set count from 0 for the places in the cells, and from the end for orders.
    const auto [a, b, c, d] = sampling::independent_words(key_, set, sample_);
    const auto [e, f, g, h] = sampling::independent_words(key_, set, ~(sample_ / samples_));
    using Number = decltype(simd::to_unit(a));
    SampleSet<Number> numbers;
    const auto put_pair = [&](std::size_t i, Word in_x, Word in_y, Word first, Word second) {
      const Word cell =
          sampling::shuffled_place(sample_ % samples_, grid_.columns * grid_.rows, first, second);
      const Word row = cell / Word(grid_.columns), column = cell - row * Word(grid_.columns);
      numbers[i] = within(column, in_x, grid_.columns);
      numbers[i + 1] = within(row, in_y, grid_.rows);
    };
    put_pair(0, a, b, e, f);
    put_pair(2, c, d, g, h);
    return numbers;
  }

 private:
  /// Returns (cell + number)/count. The sum has at most 17 + 33 digits and is exact; it is at least 2^-33
  /// below count, so that the rounded quotient is below 1.
  static auto within(Word cell, Word number, std::uint32_t count) {
    const auto whole = simd::to_unit(cell) * 0x1p32 - 0.5;
    return (whole + simd::to_unit(number)) / static_cast<double>(count);
  }

  decltype(simd::widened(Word())) key_;
  std::uint32_t samples_, sample_;
  sampling::Grid grid_;
};
using StratifiedSampler = BasicStratifiedSampler<std::uint32_t>;
static_assert(Sampler<StratifiedSampler>);

}  // namespace protostar::inline PROTOSTAR_ABI

// Sums of light without rounding: the same bytes in whatever order samples are added, and however they are
// split among threads, shards and machines.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "../bit_cast.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Sum of fewer than 2^32 floats in fixed point. Integers add up without rounding, so the sum depends on the
/// numbers and how often each was added, and on no order or grouping.
///
/// A number x counts as the multiple of 2^-47 nearest to it, of two as near the even one, and the sum is an
/// integer of 128 bits in units of 2^-47.
/// - Range: numbers beyond ±2^47, infinite ones too, count as ±2^47, which is 2^94 units; fewer than 2^32
///   numbers keep the sum's magnitude below 2^126.
/// - Resolution: a float of at least 2^-24 has the last of its 24 digits at 2^-47 or above, and counts
///   without error. A smaller one counts with an error of at most 2^-48.
/// - NaN counts as 0: a sample that failed leaves the others of its pixel as they are.
/// Negative numbers count like positive ones; filters with negative lobes give them.
class ExactSum {
 public:
  static constexpr float most = 0x1p47f;  ///< largest magnitude of a number that is added

  /// Largest error with which a number of magnitude up to `most` counts.
  static constexpr double largest_rounding = 0x1p-48;

  /// Magnitude up to which a number is added as one word: 2^62 units.
  static constexpr float most_in_word = 0x1p15f;

  /// Integer high · 2^64 + low in units of 2^-47: in two's complement, whose words are equal for equal sums.
  struct Words {
    std::int64_t high = 0;
    std::uint64_t low = 0;

    friend constexpr bool operator==(const Words& a, const Words& b) {
      return a.high == b.high && a.low == b.low;
    }
  };

  /// Constructs 0.
  constexpr ExactSum() = default;

  /// Constructs a sum from its words.
  constexpr explicit ExactSum(const Words& words) : words_(words) {}

  /// Returns n · 2^exponent units of 2^-47 as a sum, for an exponent from 0 to 63.
  [[nodiscard]] static constexpr ExactSum of_units(std::int64_t n, int exponent) {
    return ExactSum({n >> 1 >> (63 - exponent), static_cast<std::uint64_t>(n) << exponent});
  }

  [[nodiscard]] constexpr Words words() const { return words_; }

  /// Returns the number that counts for a float.
  [[nodiscard]] static float bounded(float x) { return x == x ? std::clamp(x, -most, most) : 0; }

  /// Adds a number.
  void add(float x) {
    if (std::abs(x) <= most_in_word)
      add_in_word(x);
    else
      add_large(x);
  }

  /// Adds a number that is known to lie in [-most_in_word, most_in_word].
  ///
  /// Adding 48 and taking it away rounds x. Up to 16, x + 48 lies between 32 and 64, where doubles are the
  /// multiples of 2^-47. Beyond, x is a multiple of 2^-19, and the sum is exact.
  void add_in_word(float x) {
    const double rounded = (static_cast<double>(x) + 48) - 48;
    *this += of_units(static_cast<std::int64_t>(rounded * 0x1p47), 0);
  }

  /// Adds the numbers of another sum, or of this one once more; together they must be fewer than 2^32.
  constexpr ExactSum& operator+=(ExactSum other) {
    words_.low += other.words_.low;
    words_.high += words_.low < other.words_.low ? 1 : 0;  // the carry, first: for g++ one instruction
    words_.high += other.words_.high;
    return *this;
  }

  friend constexpr bool operator==(const ExactSum& a, const ExactSum& b) { return a.words_ == b.words_; }

  /// Returns the double nearest to the sum, of two as near the one with an even last digit.
  [[nodiscard]] double value() const { return quotient<double>(1); }

  /// Returns the float nearest to sum/count, of two as near the one with an even last digit; 0 for no
  /// numbers. The mean of equal floats that count without error is that float.
  [[nodiscard]] float mean(std::uint32_t count) const { return count == 0 ? 0 : quotient<float>(count); }

 private:
  /// Adds a number beyond ±most_in_word, or NaN: a float that large is a multiple of 2^-8, which is 2^39
  /// units. Out of line, it takes no registers from what adds ordinary light.
  [[gnu::noinline]] void add_large(float x) {
    *this += of_units(static_cast<std::int64_t>(bounded(x) * 0x1p8f), 39);
  }

  /// Returns sum/count, rounded once.
  ///
  /// The sum's magnitude, below 2^126, is shifted up until its highest binary digit is that of 2^126. The
  /// upper word, of 63 digits, is divided by count < 2^32: a quotient of 31 digits at least, and all 63 for a
  /// count of 1. If something is left, an odd last digit tells so, which is below all that the rounding to
  /// Float keeps or ties on: 25 digits of any quotient, and 54 of a sum.
  template <class Float>
  [[nodiscard]] Float quotient(std::uint32_t count) const {
    const bool is_negative = words_.high < 0;
    auto high = static_cast<std::uint64_t>(words_.high), low = words_.low;
    if (is_negative) low = ~low + 1, high = ~high + (low == 0 ? 1 : 0);
    const int shift = (high != 0 ? std::countl_zero(high) : 64 + std::countl_zero(low)) - 1;
    if (shift < 64)
      high = high << shift | low >> (64 - shift), low <<= shift;
    else
      high = low << (shift - 64), low = 0;
    const bool is_rest = (high % count | low) != 0;
    const auto digits = static_cast<Float>(static_cast<std::int64_t>(high / count | (is_rest ? 1 : 0)));
    // A power of two, by its exponent. The product is exact, also as a float: it is 2^-79 at least.
    const double unit = detail::bit_cast<double>(static_cast<std::uint64_t>(1023 + 17 - shift) << 52);
    return static_cast<Float>(static_cast<double>(digits) * (is_negative ? -unit : unit));
  }

  Words words_;
};

/// Sums of the channels of colors.
struct ExactColorSum {
  std::array<ExactSum, 3> channels;

  /// Adds a color. One comparison tells that each channel is added as a word: its square is at most the sum
  /// of the squares, which is NaN if a channel is.
  void add(Color color) {
    constexpr float square = ExactSum::most_in_word * ExactSum::most_in_word;
    if (color.r * color.r + color.g * color.g + color.b * color.b < square) [[likely]] {
      channels[0].add_in_word(color.r);
      channels[1].add_in_word(color.g);
      channels[2].add_in_word(color.b);
    } else {
      channels[0].add(color.r), channels[1].add(color.g), channels[2].add(color.b);
    }
  }

  constexpr ExactColorSum& operator+=(const ExactColorSum& other) {
    for (std::size_t i = 0; i < channels.size(); ++i) channels[i] += other.channels[i];
    return *this;
  }

  friend constexpr bool operator==(const ExactColorSum& a, const ExactColorSum& b) {
    return a.channels == b.channels;
  }

  /// Returns the mean of `count` colors, as many as were added, each channel rounded once (ExactSum::mean).
  [[nodiscard]] Color mean(std::uint32_t count) const {
    return {channels[0].mean(count), channels[1].mean(count), channels[2].mean(count)};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

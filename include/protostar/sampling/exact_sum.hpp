// Sums of light without rounding: the same bytes in whatever order samples are added, and however they are
// split among threads, shards and machines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Sum of fewer than 2^32 floats in fixed point. Integers add up without rounding, so the sum depends on the
/// numbers and how often each was added, and on no order or grouping.
///
/// A number x counts as the multiple of 2^-47 nearest to it, of two as near the even one, as q = x · 2^47 in
/// two words:
///   high += ⌊q / 2^31⌋,   low += q − 2^31 ⌊q / 2^31⌋.
/// - Range: numbers beyond ±2^15, infinite ones too, count as ±2^15. Then |q| ≤ 2^62, so a number adds 2^31
///   or less to the magnitude of each word, and fewer than 2^32 numbers keep both below 2^63.
/// - Resolution: a float of at least 2^-24 has the last of its 24 digits at 2^-47 or above, and counts
///   without error. A smaller one counts with an error of at most 2^-48.
/// - NaN counts as 0: a sample that failed leaves the others of its pixel as they are.
/// Negative numbers count like positive ones; filters with negative lobes give them.
class ExactSum {
 public:
  static constexpr float most = 0x1p15f;  ///< largest magnitude of a number that is added

  /// Largest error with which a number of magnitude up to `most` counts.
  static constexpr double largest_rounding = 0x1p-48;

  /// Integer high · 2^31 + low in units of 2^-47. It is canonical, and so tells equal sums by equal words, if
  /// 0 ≤ low < 2^31.
  struct Words {
    std::int64_t high = 0, low = 0;

    friend constexpr bool operator==(const Words& a, const Words& b) {
      return a.high == b.high && a.low == b.low;
    }
  };

  /// Constructs 0.
  constexpr ExactSum() = default;

  /// Constructs a sum from its words.
  constexpr explicit ExactSum(const Words& words) : words_(words) {}

  /// Returns the canonical words: low's digits above the 31st are carried to high.
  [[nodiscard]] constexpr Words words() const {
    return {words_.high + (words_.low >> digits), words_.low & mask};
  }

  /// Returns the number that counts for a float.
  [[nodiscard]] static float bounded(float x) { return x == x ? std::clamp(x, -most, most) : 0; }

  /// Adds a number.
  void add(float x) { add_bounded(bounded(x)); }

  /// Adds a number that is known to lie in [-most, most].
  ///
  /// Adding 48 and taking it away rounds x. Up to 16, x + 48 lies between 32 and 64, where doubles are the
  /// multiples of 2^-47. Beyond, x is a multiple of 2^-19, and the sum is exact.
  void add_bounded(float x) {
    const double rounded = (static_cast<double>(x) + 48) - 48;
    const auto units = static_cast<std::int64_t>(rounded * 0x1p47);
    words_.high += units >> digits;
    words_.low += units & mask;
  }

  /// Adds the numbers of another sum; together they must be fewer than 2^32.
  constexpr ExactSum& operator+=(const ExactSum& other) {
    words_.high += other.words_.high, words_.low += other.words_.low;
    return *this;
  }

  friend constexpr bool operator==(const ExactSum& a, const ExactSum& b) { return a.words() == b.words(); }

  /// Returns the sum with a relative error of at most 2^-52. Up to 2^53 high is exact, and only the sum of
  /// both words is rounded. A larger one is rounded too, and low is less than one of its units.
  [[nodiscard]] double value() const {
    const Words sum = words();
    return static_cast<double>(sum.high) * 0x1p-16 + static_cast<double>(sum.low) * 0x1p-47;
  }

  /// Returns the float nearest to sum/count, of two as near the one with an even last digit; 0 for no
  /// numbers. The mean of equal floats that count without error is that float.
  ///
  /// The quotient grows by long division, 31 binary digits at a time, until it has at least 33, or nothing is
  /// left. A rest then is told by an odd last digit, which is below all that the rounding to 24 digits keeps
  /// or ties on. Each step stays below 2^63: a rest is less than count < 2^32, and a quotient that goes on
  /// less than 2^32.
  [[nodiscard]] float mean(std::uint32_t count) const {
    if (count == 0) return 0;
    Words sum = words();
    const bool is_negative = sum.high < 0;
    if (is_negative) sum = ExactSum({-sum.high, -sum.low}).words();
    auto next = static_cast<std::uint64_t>(sum.low);
    std::uint64_t quotient = static_cast<std::uint64_t>(sum.high) / count;
    std::uint64_t rest = static_cast<std::uint64_t>(sum.high) % count;
    double unit = 0x1p-16;
    for (; quotient >> 32 == 0 && (rest | next) != 0; unit *= 0x1p-31, next = 0) {
      const std::uint64_t shifted = rest << digits | next;
      quotient = quotient << digits | shifted / count;
      rest = shifted % count;
    }
    const auto magnitude = static_cast<float>(quotient | ((rest | next) != 0 ? 1u : 0u));
    return to_float((is_negative ? -1.0 : 1.0) * (static_cast<double>(magnitude) * unit));  // both exact
  }

 private:
  static constexpr int digits = 31;
  static constexpr std::int64_t mask = (std::int64_t{1} << digits) - 1;

  Words words_;
};

/// Sums of the channels of colors.
struct ExactColorSum {
  std::array<ExactSum, 3> channels;

  /// Adds a color. One comparison tells that all channels are in range: each square is at most the sum, which
  /// is NaN if a channel is.
  void add(Color color) {
    constexpr float square = ExactSum::most * ExactSum::most;
    if (!(color.r * color.r + color.g * color.g + color.b * color.b < square)) [[unlikely]]
      color = {ExactSum::bounded(color.r), ExactSum::bounded(color.g), ExactSum::bounded(color.b)};
    channels[0].add_bounded(color.r);
    channels[1].add_bounded(color.g);
    channels[2].add_bounded(color.b);
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

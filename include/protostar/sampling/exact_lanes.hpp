// Exact sums of several pixels at once, one in each lane.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../simd/simd.hpp"
#include "exact_sum.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// ExactSum in each of N lanes, for fewer than 2^22 numbers, by additions of double alone, each of which is
/// exact: parts of the numbers are added that have few digits.
///
/// Each number is rounded as in ExactSum and divided into its nearest multiple of 2^-16 and the rest. The
/// first parts and their sums are multiples of 2^-16 of magnitude below 2^15 · 2^22 = 2^37, and the rests
/// multiples of 2^-47 of magnitude up to 2^-17 · 2^22 = 2^5: 53 digits hold both.
template <int N>
class ExactLanes {
 public:
  using Floats = simd::Lanes<float, N>;
  using Doubles = simd::Lanes<double, N>;

  /// Adds a number in each lane.
  void add(Floats x) {
    if (any(!(abs(x) <= Floats(ExactSum::most)))) [[unlikely]]
      for (int lane = 0; lane < N; ++lane) x.set(lane, ExactSum::bounded(x[lane]));
    const Doubles number = simd::to_double(x);
    // From 2^36 to 2^37 doubles are the multiples of 2^-16, and from 32 to 64 those of 2^-47.
    const Doubles first = (number + Doubles(0x1.8p36)) - Doubles(0x1.8p36);
    const Doubles rest = ((number - first) + Doubles(48)) - Doubles(48);
    first_ += first;
    rest_ += rest;
  }

  /// Returns the sum in a lane.
  [[nodiscard]] ExactSum operator[](int lane) const {
    return ExactSum(
        {static_cast<std::int64_t>(first_[lane] * 0x1p16), static_cast<std::int64_t>(rest_[lane] * 0x1p47)});
  }

 private:
  Doubles first_ = 0.0, rest_ = 0.0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

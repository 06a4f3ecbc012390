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

  /// Returns ExactSum::mean in each lane, for 0 < count < 2^22, by one division of double where that is
  /// certain to give the nearest float.
  ///
  /// Let s be the sum, rounded to double, and q be s/count, rounded. q is off by less than 2^-52 of itself,
  /// so its float is certain if all doubles within 2^-51 round to the same. It is certain too if s is exact
  /// and q · count = s, as for many sums of few floats. If q is not in the middle between two floats, it is
  /// on the same side of each middle as the quotient, since these middles are doubles and rounding to double
  /// keeps the order. If q is such a middle, it has 25 digits and q · count no more than 47: it is exact, and
  /// q is the quotient.
  [[nodiscard]] Floats mean(std::uint32_t count) const {
    const Doubles n = static_cast<double>(count), s = first_ + rest_, q = s / n;
    const Doubles other = s - first_, error = (first_ - (s - other)) + (rest_ - other);  // of s, exactly
    const auto is_near =
        simd::mask_for<double>(simd::to_float(q * (1 - 0x1p-51)) == simd::to_float(q * (1 + 0x1p-51)));
    const auto is_sure = is_near || (error == Doubles(0.0) && q * n == s);
    Floats mean = simd::to_float(q);
    for (const int lane : lanes_in(!is_sure)) mean.set(lane, (*this)[lane].mean(count));
    return mean;
  }

 private:
  Doubles first_ = 0.0, rest_ = 0.0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

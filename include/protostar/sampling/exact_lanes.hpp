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
/// Each number is rounded as in ExactSum and divided into its nearest multiple of 2^16, the nearest multiple
/// of 2^-16 of what is left, and the rest:
/// - The first parts are 0 up to 2^15, and 2^47 at most: their sums are multiples of 2^16 below 2^69.
/// - The second ones are 2^15 at most: multiples of 2^-16 below 2^37.
/// - The rests are 2^-17 at most: multiples of 2^-47, up to 2^5.
/// 53 digits hold each of them.
template <int N>
class ExactLanes {
 public:
  using Floats = simd::Lanes<float, N>;
  using Doubles = simd::Lanes<double, N>;

  /// Adds a number in each lane.
  void add(Floats x) {
    Doubles number = simd::to_double(x);
    if (any(!(abs(x) <= Floats(ExactSum::most_in_word)))) [[unlikely]] {
      const Floats most = ExactSum::most;
      number = simd::to_double(select(x == x, min(max(x, -most), most), Floats(0.0f)));
      const Doubles large = nearest(number, 0x1p16);
      large_ += large;
      number = number - large;
    }
    const Doubles medium = nearest(number, 0x1p-16);
    medium_ += medium;
    small_ += nearest(number - medium, 0x1p-47);
  }

  /// Returns the sum in a lane.
  [[nodiscard]] ExactSum operator[](int lane) const {
    const auto units = [&](const Doubles& parts, double unit) {
      return static_cast<std::int64_t>(parts[lane] * (1 / unit));
    };
    ExactSum sum = ExactSum::of_units(units(large_, 0x1p16), 63);
    sum += ExactSum::of_units(units(medium_, 0x1p-16), 31);
    sum += ExactSum::of_units(units(small_, 0x1p-47), 0);
    return sum;
  }

  /// Returns ExactSum::mean in each lane, for 0 < count < 2^22, by one division of double where that is
  /// certain to give the nearest float.
  ///
  /// Let s be the sum, rounded to double, and q be s/count, rounded. The sum of the large and medium parts is
  /// exact below 2^37; otherwise ExactSum::mean is asked. q is off by less than 2^-52 of itself, so its float
  /// is certain if all doubles within 2^-51 round to the same. It is certain too if s is exact and q · count
  /// = s, as for many sums of few floats. If q is not in the middle between two floats, it is on the same
  /// side of each middle as the quotient, since these middles are doubles and rounding to double keeps the
  /// order. If q is such a middle, it has 25 digits and q · count no more than 47: it is exact, and q is the
  /// quotient.
  [[nodiscard]] Floats mean(std::uint32_t count) const {
    const Doubles n = static_cast<double>(count), first = large_ + medium_, s = first + small_, q = s / n;
    const Doubles other = s - first, error = (first - (s - other)) + (small_ - other);  // of s, exactly
    const auto is_near =
        simd::mask_for<double>(simd::to_float(q * (1 - 0x1p-51)) == simd::to_float(q * (1 + 0x1p-51)));
    const auto is_sure = abs(first) < Doubles(0x1p37) && (is_near || (error == Doubles(0.0) && q * n == s));
    Floats mean = simd::to_float(q);
    for (const int lane : lanes_in(!is_sure)) mean.set(lane, (*this)[lane].mean(count));
    return mean;
  }

 private:
  /// Returns the nearest multiple of a unit, a power of two, for a number of magnitude below 2^51 units:
  /// plus 3 · 2^51 units, it lies between 2^52 and 2^53 of them, where doubles are whole multiples.
  [[nodiscard]] static Doubles nearest(Doubles number, double unit) {
    const Doubles middle = 0x3p51 * unit;
    return (number + middle) - middle;
  }

  Doubles large_ = 0.0, medium_ = 0.0, small_ = 0.0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

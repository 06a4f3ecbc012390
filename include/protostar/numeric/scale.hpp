// Powers of two that bring numbers of any size to about 1, without rounding.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "../bit_cast.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the exponent e for which the largest component of some vectors, times 2^-e, is in [1/2, 1); if all
/// are 0, an exponent below that of any double. It may be any number if a component is not finite.
[[nodiscard]] inline int exponent_of(std::initializer_list<Vec3> vectors) {
  double largest = 0;
  for (const Vec3& v : vectors) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (largest == 0) return -2000;
  // Read from the bits of the double, if it is neither denormal nor infinite.
  if (0x1p-1000 < largest && largest < 0x1p1023)
    return static_cast<int>(detail::bit_cast<std::uint64_t>(largest) >> 52) - 1022;
  int exponent = 0;
  std::frexp(largest, &exponent);
  return exponent;
}

/// Returns 2^exponent, built from its bits, for |exponent| ≤ 1000.
[[nodiscard]] inline double power_of_two(int exponent) {
  return detail::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

/// Returns v · 2^exponent.
[[nodiscard]] inline Vec3 scaled(const Vec3& v, int exponent) {
  if (-1000 < exponent && exponent < 1000) return v * power_of_two(exponent);
  return {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
}

/// Returns x · 2^exponent.
[[nodiscard]] inline double scaled(double x, int exponent) { return scaled(Vec3{x, 0, 0}, exponent).x; }

/// Tests whether products of a few such vectors, or of those in each lane, stay in the range of double.
template <class V>
[[nodiscard]] auto is_of_moderate_size(const V& v) {
  using std::abs;
  const auto size = abs(v.x) + abs(v.y) + abs(v.z);
  return 0x1p-100 < size && size < 0x1p100;
}

/// Returns the exponent of a vector (exponent_of), or 0 if it is of moderate size and need not be scaled.
[[nodiscard]] inline int immoderate_exponent(const Vec3& v) {
  return is_of_moderate_size(v) ? 0 : exponent_of({v});
}

/// Returns v if it is of moderate size, and otherwise a vector of a length of about 1 in its direction.
[[nodiscard]] inline Vec3 of_moderate_size(const Vec3& v) {
  return is_of_moderate_size(v) ? v : scaled(v, -exponent_of({v}));
}

/// Two numbers, as those of a vector in a plane, times a power of two with which the square of the larger one
/// does not underflow. It is 2^600 if both are below 2^-400, which brings numbers from 2^-1074 on to 2^-474
/// or more, and otherwise 1.
struct LiftedPair {
  double lift, x, y, square, length;

  LiftedPair(double first, double second)
      : lift(std::max(std::abs(first), std::abs(second)) < 0x1p-400 ? 0x1p600 : 1),
        x(first * lift),
        y(second * lift),
        square(x * x + y * y),
        length(std::sqrt(square)) {}
};

}  // namespace protostar::inline PROTOSTAR_ABI

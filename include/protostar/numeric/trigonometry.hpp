// Angles that are the same on every machine: sine, cosine and tangent of degrees, arc tangent and arc cosine.
//
// The functions of C libraries differ in their last bits. This file uses only operations that IEEE 754 rounds
// correctly, in double-double, so that a result has hardly more error than its own rounding: below 0.51 units
// in its last place. The names are not those of <cmath>, with which a program that says `using namespace
// protostar` would mix them up. u = 2^-53.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "double_double.hpp"
#include "power.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline constexpr DoubleDouble pi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};

/// Returns 1 − s/((n+1)(n+2)) + s²/((n+1)(n+2)(n+3)(n+4)) − …, which with s = θ² is cos θ for n = 0 and sin θ
/// / θ for n = 1. For |θ| ≤ π/4 the first term left out, s¹¹/22! or less, is below 2^-77; the roundings, of
/// which each step shrinks the earlier ones, stay below 2^-100.
[[nodiscard]] inline DoubleDouble alternating_series(DoubleDouble s, int n) {
  DoubleDouble sum = 1;
  for (int k = n + 20; k > n; k -= 2) sum = DoubleDouble(1) - sum * s / DoubleDouble(k * (k - 1));
  return sum;
}

struct SineAndCosine {
  DoubleDouble sine, cosine;
};

/// Returns sine and cosine, each with a relative error below 2^-75; exact if it is 0, 1 or −1. Both are NaN
/// if degrees is not finite.
[[nodiscard]] inline SineAndCosine sine_and_cosine_of_degrees(double degrees) {
  if (!std::isfinite(degrees)) return {degrees - degrees, degrees - degrees};
  // Whole and quarter turns are taken off exactly: the rest has no more digits than degrees.
  const double turned = std::remainder(degrees, 360);
  const double quarters = std::round(turned / 90);
  const DoubleDouble angle = DoubleDouble(turned - 90 * quarters) * pi / DoubleDouble(180);
  const DoubleDouble square = angle * angle;
  const DoubleDouble sine = angle * alternating_series(square, 1), cosine = alternating_series(square, 0);
  switch (static_cast<int>(quarters)) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case -1:
      return {-cosine, sine};
    default:
      return {-sine, -cosine};
  }
}

/// Returns arctan z = z − z³/3 + z⁵/5 − … in double-double for |z| ≤ 1/8: the first term left out is below
/// 2^-116 of it.
[[nodiscard]] inline DoubleDouble arc_tangent_series(DoubleDouble z) {
  const DoubleDouble s = z * z;
  DoubleDouble sum;
  for (int n = 37; n > 0; n -= 2) sum = quotient(1, n) - s * sum;
  return z * sum;
}

/// Returns arctan(k/8) for k from 0 to 8, each from the one before:
///   arctan a − arctan b = arctan((a − b)/(1 + a b)),   here of (1/8)/(1 + k(k − 1)/64).
[[nodiscard]] inline const DoubleDouble& arc_tangent_of_eighths(int k) {
  static const struct Table {
    DoubleDouble angles[9];

    Table() {
      for (int i = 1; i <= 8; ++i)
        angles[i] = angles[i - 1] + arc_tangent_series(quotient(8, 64 + i * (i - 1)));
    }
  } table;
  return table.angles[k];
}

/// Returns the angle between the x axis and (x, y) ≠ 0, with the sign of y; series(z) is the arc tangent of
/// z, |z| ≤ 1/16. All else is double-double. The numbers must be about 1, or 0: their products must not
/// underflow.
///
/// In the eighth of the plane between the x axis and the diagonal it is arctan(k/8) for the k/8 next to y/x,
/// plus, by the formula of arc_tangent_of_eighths, the arctan of z = (y − x k/8)/(x + y k/8), |z| ≤ 1/16.
[[nodiscard]] inline DoubleDouble angle_by(const auto& series, DoubleDouble y, DoubleDouble x) {
  DoubleDouble low = abs(y), high = abs(x);
  const bool is_steep = low.hi > high.hi;
  if (is_steep) std::swap(low, high);
  const double eighths = std::round(8 * low.hi / high.hi);
  const DoubleDouble part(eighths / 8);
  const DoubleDouble z = (low - high * part) / (high + low * part);
  DoubleDouble angle = arc_tangent_of_eighths(static_cast<int>(eighths)) + series(z);
  if (is_steep) angle = DoubleDouble(pi.hi / 2, pi.lo / 2) - angle;
  if (x.hi < 0) angle = pi - angle;
  return std::signbit(y.hi) ? -angle : angle;
}

/// Returns the angle of angle_by with a relative error below 2^-60. In the series z (1 − z²/3 + …), the terms
/// after the 1 are below 1/768, and their evaluation in double has an error of less than 5.5u of that,
/// 2^-60.1: 2u as z² is without the lower half of z, one in each of two products, half of one in −1/3, and
/// one in the sum. The series up to z¹⁴/15 lacks less than 2^-68.
[[nodiscard]] inline DoubleDouble angle_of(DoubleDouble y, DoubleDouble x) {
  const auto series = [](DoubleDouble z) {
    const double s = z.hi * z.hi;
    const double rest =
        s * polynomial({-1 / 3.0, 1 / 5.0, -1 / 7.0, 1 / 9.0, -1 / 11.0, 1 / 13.0, -1 / 15.0}, s);
    return z * fast_two_sum(1.0, rest);
  };
  return angle_by(series, y, x);
}

/// Returns the angle of angle_by with a relative error below 2^-97, ten times as slow: numerator and
/// denominator of z and their quotient have errors of 16u², the series and the angles in the table of at most
/// 100u², since each step of a series shrinks the error of the step before.
[[nodiscard]] inline DoubleDouble precise_angle_of(DoubleDouble y, DoubleDouble x) {
  return angle_by(arc_tangent_series, y, x);
}

}  // namespace detail

/// Returns the sine of an angle in degrees; NaN if the angle is not finite.
[[nodiscard]] inline double sine_of_degrees(double degrees) {
  return static_cast<double>(detail::sine_and_cosine_of_degrees(degrees).sine);
}

/// Returns the cosine of an angle in degrees; NaN if the angle is not finite.
[[nodiscard]] inline double cosine_of_degrees(double degrees) {
  return static_cast<double>(detail::sine_and_cosine_of_degrees(degrees).cosine);
}

/// Returns the tangent of an angle in degrees: 1 for 45, infinite for 90, NaN if the angle is not finite.
/// (For 45, sine and cosine agree to 2^-74, and no double but 1 is so near to their quotient.)
[[nodiscard]] inline double tangent_of_degrees(double degrees) {
  const auto [sine, cosine] = detail::sine_and_cosine_of_degrees(degrees);
  if (cosine.hi == 0) return std::copysign(std::numeric_limits<double>::infinity(), sine.hi);
  return static_cast<double>(sine / cosine);
}

/// Returns the angle from the x axis to (x, y), in radians from −π to π, with the sign of y; for x > 0, the
/// arc tangent of y/x. For (0, 0) it is 0, or ±π if x is a negative zero; NaN if a number is not finite.
/// Angles below 2^-900 are only accurate to 2^-950.
[[nodiscard]] inline double arc_tangent(double y, double x) {
  if (!std::isfinite(x) || !std::isfinite(y)) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0 && y == 0) return std::copysign(std::signbit(x) ? detail::pi.hi : 0, y);
  const int exponent = std::ilogb(std::max(std::abs(x), std::abs(y)));
  return static_cast<double>(detail::angle_of(std::ldexp(y, -exponent), std::ldexp(x, -exponent)));
}

/// Returns the angle in [0, π], in radians, whose cosine is x. For x beyond ±1, which rounding now and then
/// gives to components of a unit vector, it is that of ±1.
[[nodiscard]] inline double arc_cosine(double x) {
  if (std::isnan(x)) return x;
  const double cosine = std::clamp(x, -1.0, 1.0);
  return static_cast<double>(detail::angle_of(sqrt(DoubleDouble(1) - two_product(cosine, cosine)), cosine));
}

}  // namespace protostar::inline PROTOSTAR_ABI

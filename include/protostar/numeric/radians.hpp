// Sine, cosine and polar angle in radians, in double alone: five times as fast as the functions of
// trigonometry.hpp, with errors of a few units in the last place. Bytes depend on no machine. u = 2^-53.
#pragma once

#include <cmath>
#include <utility>

#include "double_double.hpp"
#include "power.hpp"
#include "trigonometry.hpp"

namespace protostar::inline PROTOSTAR_ABI {

struct SineCosine {
  double sine = 0, cosine = 1;
};

namespace detail {

/// Terms of the series of sine, cosine and arc tangent in s = x², after the first: the sine is x + x s (…),
/// the cosine 1 + s (…), and the arc tangent x + x s (…).
inline constexpr double sine_terms[] = {
    -1 / 6.0,        1 / 120.0,        -1 / 5040.0,          1 / 362880.0,
    -1 / 39916800.0, 1 / 6227020800.0, -1 / 1307674368000.0, 1 / 355687428096000.0};
inline constexpr double cosine_terms[] = {
    -1 / 2.0,       1 / 24.0,        -1 / 720.0,         1 / 40320.0,
    -1 / 3628800.0, 1 / 479001600.0, -1 / 87178291200.0, 1 / 20922789888000.0};
inline constexpr double arc_tangent_terms[] = {-1 / 3.0,  1 / 5.0,  -1 / 7.0, 1 / 9.0,
                                               -1 / 11.0, 1 / 13.0, -1 / 15.0};

}  // namespace detail

/// Returns sine and cosine of an angle with |angle| ≤ 7, each with a relative error below 2u.
///
/// n quarter turns are subtracted: n · π.hi/2 by a fused operation, whose result is small beside both and
/// hence exact, then n · π.lo/2, which leaves an error of half a unit in the last place of the rest, |rest| ≤
/// π/4 + 2^-50. The series up to rest^17/17! and rest^16/16! lack less than 2^-58. The terms after the first
/// are below 0.11 |rest| and 0.31, so their roundings together count less than half of one of the result.
[[nodiscard]] inline SineCosine sine_and_cosine(double angle) {
  const double quarters = std::rint(angle * (2 / detail::pi.hi));
  const double rest = std::fma(-quarters, detail::pi.lo / 2, std::fma(-quarters, detail::pi.hi / 2, angle));
  const double s = rest * rest;
  const double sine = std::fma(rest * s, detail::polynomial(detail::sine_terms, s), rest);
  const double cosine = std::fma(s, detail::polynomial(detail::cosine_terms, s), 1.0);
  // Angles are mostly drawn by chance: a branch for each quarter would seldom be foreseen.
  constexpr double sign[2] = {1, -1};
  const double both[2] = {sine, cosine};
  const auto quarter = static_cast<unsigned>(static_cast<int>(quarters)) % 4;
  return {both[quarter % 2] * sign[quarter / 2], both[(quarter + 1) % 2] * sign[(quarter + 1) / 2 % 2]};
}

/// Returns the angle from the x axis to (x, y), from −π to π with the sign of y, with a relative error below
/// 4u; 0 for (0, 0), and NaN if a number is not finite. The numbers and their products with 1/8 must be in
/// the range of double.
///
/// By the formula of detail::angle_by. The numerator of z is rounded once, by a fused operation, and z has an
/// error below 3u; the series lacks less than 2^-70. Added to arctan(k/8), which is at least twice as large
/// as z, or 0, the error is below 3u; the difference from π/2 or π, which is at least as large as the angle
/// subtracted, adds u at most.
[[nodiscard]] inline double polar_angle(double y, double x) {
  double low = std::abs(y), high = std::abs(x);
  const bool is_steep = low > high;
  if (is_steep) std::swap(low, high);
  const double ratio = low / high;
  if (!(ratio <= 1)) return high == 0 ? 0 : ratio;
  const double eighths = std::rint(8 * ratio);
  const double part = eighths / 8;
  const double z = std::fma(-high, part, low) / std::fma(low, part, high), s = z * z;
  const double series = std::fma(z * s, detail::polynomial(detail::arc_tangent_terms, s), z);
  double angle = detail::arc_tangent_of_eighths(static_cast<int>(eighths)).hi + series;
  if (is_steep) angle = (detail::pi.hi / 2 - angle) + detail::pi.lo / 2;
  if (x < 0) angle = (detail::pi.hi - angle) + detail::pi.lo;
  return std::signbit(y) ? -angle : angle;
}

/// Returns sine and cosine of half of the angle in [0, π] whose sine and cosine are proportional to y ≥ 0 and
/// x, without cancellation: the larger of the two from the sum of like signs, the other from 2 sin cos = y/r.
[[nodiscard]] inline SineCosine half_angle(double y, double x) {
  const double r = std::sqrt(x * x + y * y);
  const double large = std::sqrt((1 + std::abs(x) / r) / 2), small = y / r / (2 * large);
  return x < 0 ? SineCosine{large, small} : SineCosine{small, large};
}

}  // namespace protostar::inline PROTOSTAR_ABI

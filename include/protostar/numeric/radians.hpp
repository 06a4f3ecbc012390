// Sine, cosine and polar angle in radians, in double alone: five times as fast as the functions of
// trigonometry.hpp, with errors of a few units in the last place. Bytes depend on no machine. u = 2^-53.
//
// Series are templates of T, double or simd::Doubles, so that lanes (radians_of_each.hpp) have the bits of
// one number.
#pragma once

#include <cmath>
#include <utility>

#include "double_double.hpp"
#include "power.hpp"
#include "trigonometry.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Sine and cosine of an angle, by default of 0.
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

/// Returns the nearest whole number, the even one of two.
[[nodiscard]] inline double nearest_whole(double x) { return std::rint(x); }

/// Angle, |angle| ≤ 7, without its whole quarter turns: their number, and sine and cosine of the rest, each
/// with a relative error below 2u.
///
/// n quarter turns are subtracted: n · π.hi/2 by a fused operation, whose result is small beside both and
/// hence exact, then n · π.lo/2, which leaves an error of half a unit in the last place of the rest, |rest| ≤
/// π/4 + 2^-50. The series up to rest^17/17! and rest^16/16! lack less than 2^-58. The terms after the first
/// are below 0.11 |rest| and 0.31, so their roundings together count less than half of one of the result.
template <class T>
struct ReducedAngle {
  T quarters, sine, cosine;

  [[gnu::always_inline]] explicit ReducedAngle(T angle) : quarters(nearest_whole(angle * T(2 / pi.hi))) {
    using std::fma;
    const T rest = fma(-quarters, T(pi.lo / 2), fma(-quarters, T(pi.hi / 2), angle)), s = rest * rest;
    sine = fma(rest * s, polynomial(sine_terms, s), rest);
    cosine = fma(s, polynomial(cosine_terms, s), T(1.0));
  }
};

/// Returns arctan(low/high) − arctan(part), for low ≤ high and a part that is off their ratio by at most
/// 1/16: the arc tangent of z, by the formula of angle_by. The numerator of z is rounded once, by a fused
/// operation, and z has an error below 3u; the series lacks less than 2^-70.
template <class T>
[[nodiscard, gnu::always_inline]] inline T arc_tangent_beyond(const T& part, const T& low, const T& high) {
  using std::fma;
  const T z = fma(-high, part, low) / fma(low, part, high), s = z * z;
  return fma(z * s, polynomial(arc_tangent_terms, s), z);
}

}  // namespace detail

/// Returns sine and cosine of an angle with |angle| ≤ 7, each with a relative error below 2u.
[[nodiscard]] inline SineCosine sine_and_cosine(double angle) {
  const auto [quarters, sine, cosine] = detail::ReducedAngle(angle);
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
/// In the eighth of the plane between the x axis and the diagonal it is arctan(k/8), for the k/8 next to the
/// ratio, and what is beyond. The first is at least twice as large as the second, or 0, so that the error of
/// the sum is below 3u; the difference from π/2 or π, which is at least as large as the angle subtracted,
/// adds u at most.
[[nodiscard]] inline double polar_angle(double y, double x) {
  double low = std::abs(y), high = std::abs(x);
  const bool is_steep = low > high;
  if (is_steep) std::swap(low, high);
  const double ratio = low / high;
  if (!(ratio <= 1)) return high == 0 ? low : ratio;  // 0 or NaN
  const double eighths = detail::nearest_whole(8 * ratio);
  double angle = detail::arc_tangent_of_eighths(static_cast<int>(eighths)).hi +
                 detail::arc_tangent_beyond(eighths / 8, low, high);
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

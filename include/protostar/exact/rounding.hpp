// Operations on the ends of enclosures: doubles, double-doubles, and lanes of doubles.
//
// Rounding is to nearest, as everywhere. A result c of one operation is moved outward by more than its error
// could be, which needs no other rounding mode and gives the same bits in every lane and on every machine.
// u = 2^-53.
#pragma once

#include <cmath>

#include "../interval.hpp"
#include "../numeric/double_double.hpp"
#include "../simd/simd.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI::rounding {

using protostar::select;
using simd::select;

[[nodiscard]] inline double min(double a, double b) { return b < a ? b : a; }
[[nodiscard]] inline double max(double a, double b) { return a < b ? b : a; }
[[nodiscard]] inline double abs(double a) { return std::abs(a); }
[[nodiscard]] inline double copysign(double a, double b) { return std::copysign(a, b); }
[[nodiscard]] inline double sqrt(double a) { return std::sqrt(a); }

[[nodiscard]] inline DoubleDouble min(DoubleDouble a, DoubleDouble b) { return b < a ? b : a; }
[[nodiscard]] inline DoubleDouble max(DoubleDouble a, DoubleDouble b) { return a < b ? b : a; }
[[nodiscard]] inline DoubleDouble abs(DoubleDouble a) { return protostar::abs(a); }
[[nodiscard]] inline DoubleDouble sqrt(DoubleDouble a) { return protostar::sqrt(a); }

/// Returns a single truth value; for a mask of lanes simd::any returns whether one of them is true.
[[nodiscard]] inline bool any(bool so) { return so; }

using simd::abs;
using simd::any;
using simd::copysign;
using simd::max;
using simd::min;
using simd::sqrt;

/// Returns the nearest integer, of two equally near ones the even one. The sum of 2^52 and a smaller
/// magnitude is rounded to an integer; doubles of 2^52 or more are integers already. NaN and ∞ remain.
template <class R>
[[nodiscard]] R nearest_integer(R x) {
  const R size = abs(x);
  return select(size < R(0x1p52), copysign((size + R(0x1p52)) - R(0x1p52), x), x);
}

/// Returns the largest integer that is at most x.
template <class R>
[[nodiscard]] R floor(R x) {
  const R nearest = nearest_integer(x);
  return select(x < nearest, nearest - R(1.0), nearest);
}

/// Direction in which numbers are rounded to integers.
enum class To { nearest, down };

/// Returns the integers nearest to x in each lane, or the largest that are at most x: by one instruction
/// where the processor has one.
template <To to, int N>
[[nodiscard]] simd::Lanes<double, N> to_integer(simd::Lanes<double, N> x) {
#if defined(PROTOSTAR_VECTORS) && defined(__AVX__)
  constexpr int direction = to == To::nearest ? _MM_FROUND_TO_NEAREST_INT : _MM_FROUND_TO_NEG_INF;
  constexpr int mode = direction | _MM_FROUND_NO_EXC;
  using V = decltype(x.v);
#if defined(__AVX512F__)
  if constexpr (N == 8) return (V)_mm512_maskz_roundscale_pd(0xff, (__m512d)x.v, mode);
#endif
  if constexpr (N == 4) return (V)_mm256_round_pd((__m256d)x.v, mode);
#endif
  using L = simd::Lanes<double, N>;
  return to == To::nearest ? nearest_integer<L>(x) : floor<L>(x);
}

template <int N>
[[nodiscard]] simd::Lanes<double, N> nearest_integer(simd::Lanes<double, N> x) {
  return to_integer<To::nearest>(x);
}
template <int N>
[[nodiscard]] simd::Lanes<double, N> floor(simd::Lanes<double, N> x) {
  return to_integer<To::down>(x);
}
[[nodiscard]] inline DoubleDouble floor(DoubleDouble x) {
  const double high = floor(x.hi);
  return high == x.hi ? fast_two_sum(high, floor(x.lo)) : DoubleDouble(high);
}

/// Returns the nearest integer, of two equally near ones the larger.
[[nodiscard]] inline DoubleDouble nearest_integer(DoubleDouble x) {
  const DoubleDouble below = floor(x), part = x - below;
  return part < DoubleDouble(0.5) ? below : below + DoubleDouble(1.0);
}

/// Tests whether a number is finite: for double-doubles also the lower part, which is NaN after an overflow.
[[nodiscard]] inline bool is_known(double x) { return std::abs(x) < infinity; }
[[nodiscard]] inline bool is_known(DoubleDouble x) {
  return std::abs(x.hi) < infinity && std::abs(x.lo) < infinity;
}
template <int N>
[[nodiscard]] auto is_known(simd::Lanes<double, N> x) {
  return abs(x) < simd::Lanes<double, N>(infinity);
}

// Bounds below and above the exact result of an operation that was rounded to c.
//
// double: the error is at most half a unit in the last place of c, and 2^-52 |c| is a whole unit or more, so
// that c − 2^-52 |c| is rounded to the double below c or to a smaller one. For |c| < 2^-1022 sums are exact.
//
// Double-double: the largest relative error is that of a quotient, 10u². 2^-102 |c| is 16u² |c.hi|, of which
// the subtraction, with an error of 3u², leaves 13u² (1 − u).

/// Returns the distance by which a result c is moved outward: more than its relative error, times |c|.
[[nodiscard]] inline double share_of(double c) { return 0x1p-52 * std::abs(c); }
[[nodiscard]] inline double share_of(DoubleDouble c) { return 0x1p-102 * std::abs(c.hi); }
template <int N>
[[nodiscard]] simd::Lanes<double, N> share_of(simd::Lanes<double, N> c) {
  return simd::Lanes<double, N>(0x1p-52) * abs(c);
}

/// Returns a lower bound of the exact result of an operation that was rounded to c; −∞ if c is infinite or
/// NaN. Sums are bounded as they are; products, quotients and roots may underflow, and need a slack.
template <class B>
[[nodiscard]] B below(B c) {
  return max(B(-infinity), c - share_of(c));
}
/// Returns a lower bound of the exact result where the error of c may be larger by a slack ≥ 0.
template <class B>
[[nodiscard]] B below(B c, double slack) {
  return max(B(-infinity), c - (share_of(c) + slack));
}
[[nodiscard]] inline DoubleDouble below(DoubleDouble c, double slack = 0) {
  const DoubleDouble moved = c - DoubleDouble(share_of(c) + slack);
  return is_known(moved) ? moved : DoubleDouble(-infinity);
}

/// Returns an upper bound of the exact result of an operation that was rounded to c; ∞ if c is infinite or
/// NaN.
template <class B>
[[nodiscard]] B above(B c) {
  return min(B(infinity), c + share_of(c));
}
/// Returns an upper bound of the exact result where the error of c may be larger by a slack ≥ 0.
template <class B>
[[nodiscard]] B above(B c, double slack) {
  return min(B(infinity), c + (share_of(c) + slack));
}
[[nodiscard]] inline DoubleDouble above(DoubleDouble c, double slack = 0) {
  const DoubleDouble moved = c + DoubleDouble(share_of(c) + slack);
  return is_known(moved) ? moved : DoubleDouble(infinity);
}

/// Largest error of a product or quotient by underflow, beyond its share of the result: 2^-1075 in double.
/// 2^-1022 is not denormal, which some processors are slow with. In double-double low parts underflow where a
/// product is below 2^-968, and errors are then below 2^-1020.
template <class B>
inline constexpr double underflow = 0x1p-1022;
template <>
inline constexpr double underflow<DoubleDouble> = 0x1p-900;

/// Magnitude above which a divisor's quotients have no larger error by underflow than `underflow`. In double
/// it is 0, since only the quotient underflows. In double-double the products of the long division underflow
/// too, each by less than 2^-1073; their sum, less than 2^-1060, is divided by the divisor.
template <class B>
inline constexpr double least_divisor = 0;
template <>
inline constexpr double least_divisor<DoubleDouble> = 0x1p-160;

/// Largest error of a root by underflow. The root of a double-double below 2^-900 is as good as its double,
/// off by less than 2^-52 · 2^-450.
template <class B>
inline constexpr double root_underflow = 0;
template <>
inline constexpr double root_underflow<DoubleDouble> = 0x1p-500;

}  // namespace protostar::inline PROTOSTAR_ABI::rounding

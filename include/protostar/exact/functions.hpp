// Sine, cosine, exponential and logarithm of the number types of fields, with proven bounds.
//
// They use only operations that IEEE 754 rounds correctly, so that a result has the same bits on every
// machine and in every lane. Sine and cosine hold for |x| ≤ 2^20, the exponential for |x| ≤ 600, and the
// logarithm for x from 2^-800 to 2^800. Enclosures for other arguments are all values that the function can
// have, and the error of plain values is taken as infinite. The bounds hold as well if a compiler fuses
// products with sums. u = 2^-53.
#pragma once

#include <cmath>
#include <cstddef>

#include "../numeric/double_double.hpp"
#include "../numeric/power.hpp"
#include "../numeric/radians.hpp"
#include "enclosure.hpp"
#include "lipschitz.hpp"
#include "plain.hpp"
#include "slope.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline constexpr double largest_angle = 0x1p20, largest_exponent = 600, largest_power = 0x1p800;

/// Bounds of the errors of the functions below: absolute for sine and cosine, relative for the exponential,
/// and for the logarithm the sum of a relative and an absolute one.
template <class B>
inline constexpr double sine_error = 0x1p-51;
template <>
inline constexpr double sine_error<DoubleDouble> = 0x1p-98;
template <class B>
inline constexpr double exponential_error = 0x1p-51;
template <>
inline constexpr double exponential_error<DoubleDouble> = 0x1p-98;
template <class B>
inline constexpr double relative_logarithm_error = 0x1p-50;
template <>
inline constexpr double relative_logarithm_error<DoubleDouble> = 0x1p-103;
template <class B>
inline constexpr double absolute_logarithm_error = 0;
template <>
inline constexpr double absolute_logarithm_error<DoubleDouble> = 0x1p-97;

/// π/2 and ln 2 as sums of doubles. All but the last have 33 bits or less, so that their products with whole
/// numbers below 2^20 are exact. The sums are off by less than 2^-121 and 2^-86, the precise ones by 2^-155.
inline constexpr double half_pi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
inline constexpr double precise_half_pi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69,
                                             0x1.b839a252049c1p-104};
inline constexpr double ln_2_parts[] = {0x1.62e42feep-1, 0x1.a39ef35793c76p-33};
inline constexpr double precise_ln_2[] = {0x1.62e42feep-1, 0x1.a39ef356p-33, 0x1.93c76730p-65,
                                          0x1.f97b57a079a19p-103};

/// Returns c[0] + c[1] x + c[2] x² + …, with products and sums that are rounded one by one, where polynomial
/// (numeric/power.hpp) fuses them.
template <class R, std::size_t n>
[[nodiscard]] R series(const double (&c)[n], const R& x) {
  R sum = c[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) sum = sum * x + R(c[i]);
  return sum;
}

/// Sine and cosine of x, computed together: at(0) returns sin x and at(1) returns sin(x + π/2) = cos x, for
/// |x| ≤ 2^20, with absolute errors below 2^-51.
///
/// k is the integer next to x · 2/π, |k| < 2^20. Then r = x − k π/2 is at most π/4 in magnitude, and 2^-30
/// more at most by the rounding of k. The first difference below is exact: for k ≠ 0 its terms are multiples
/// of 2^-53, and it is below 1. The second is rounded by 2^-54 at most, and so is the third, of which the
/// product and the error of π/2 add 2^-100: r is off by 1.01u.
///
/// Series up to r^17/17! and r^16/16! lack less than 2^-62 and 2^-58. The sine is r + r p, |r p| ≤ 0.09, the
/// cosine 1 + s q, |s q| ≤ 0.31; p and q have relative errors below 3u, of their first coefficients and the
/// sums with the rest, s = r² has u, and products u each, so that r p is off by 0.5u and s q by 1.6u. The
/// last sum, at most 1, is rounded by half a u. The error of r counts in full for the sine, and 0.71 times
/// for the cosine, whose slope is at most that: 2.1u and 2.9u in all.
template <class R>
class Sines {
 public:
  explicit Sines(const R& x) {
    turns_ = rounding::nearest_integer(x * R(0x1.45f306dc9c883p-1));
    const R r = ((x - turns_ * R(half_pi[0])) - turns_ * R(half_pi[1])) - turns_ * R(half_pi[2]);
    const R s = r * r;
    sine_ = r + r * (s * series(sine_terms, s));
    cosine_ = R(1.0) + s * series(cosine_terms, s);
  }

  [[nodiscard]] R at(double quarter) const {
    using rounding::select;
    // Quarter turns: −2, −1, 0, 1 or 2.
    const R turns = turns_ + R(quarter), turn = turns - R(4.0) * rounding::nearest_integer(turns * R(0.25));
    const R size = rounding::abs(turn), value = select(size == R(1.0), cosine_, sine_);
    return select(size == R(2.0) || turn == R(-1.0), -value, value);
  }

 private:
  R turns_, sine_, cosine_;
};

/// Returns x − k · parts, in the order of the parts, which is that of their sizes.
template <std::size_t n>
[[nodiscard]] DoubleDouble reduced(DoubleDouble x, double k, const double (&parts)[n]) {
  for (const double part : parts) x = x - two_product(k, part);
  return x;
}

/// Returns sin(x + quarter · π/2) in double-double, for quarter 0 or 1 and |x| ≤ 2^20, with an absolute error
/// below 2^-98, by the way of Sines: r has four roundings of 3u² of numbers below 1, and π/2 an error of
/// 2^-155 times k < 2^20. Series up to θ^27/27! and θ^26/26! lack less than 2^-104. Each step of them has
/// errors of 20u² of a term below 0.31, the product with the square and the quotient, and 3u² of the
/// difference: below 15u² in the end, and the sine's product with r adds 5u².
[[nodiscard, gnu::noinline]] inline DoubleDouble sine_of(DoubleDouble x, double quarter) {
  const double k = rounding::nearest_integer(x.hi * 0x1.45f306dc9c883p-1);
  const DoubleDouble r = reduced(x, k, precise_half_pi), s = r * r;
  const double turns = k + quarter, turn = turns - 4 * rounding::nearest_integer(turns / 4);
  const bool is_cosine = std::abs(turn) == 1;
  DoubleDouble sum = 1;
  for (int j = is_cosine ? 26 : 27; j > 1; j -= 2)
    sum = DoubleDouble(1) - sum * s / DoubleDouble(j * (j - 1));
  const DoubleDouble value = is_cosine ? sum : r * sum;
  return std::abs(turn) == 2 || turn == -1 ? -value : value;
}

template <>
class Sines<DoubleDouble> {
 public:
  explicit Sines(DoubleDouble x) : x_(x) {}
  [[nodiscard]] DoubleDouble at(double quarter) const { return sine_of(x_, quarter); }

 private:
  DoubleDouble x_;
};

/// Returns e^x for |x| ≤ 600, with a relative error below 2^-51; for other x that of the nearer of ±600, and
/// for NaN that of −600.
///
/// e^x = 2^k e^r for the integer k next to x / ln 2 and r = x − k ln 2, |r| < 0.35. The first difference is
/// exact, as that of Sines; the second, with its product, is off by u/3. The series up to r^13/13! lacks
/// less than 2^-57. r + r² q is off by 0.6u, of q below 0.07/r² with 4u and a sum below 0.42, and the sum
/// with 1 by u of itself. Relative to e^r ≥ 0.7 that is u + 0.6u/0.7 + u/3.
[[nodiscard]] inline double exponential_of(double x) {
  x = rounding::min(rounding::max(-largest_exponent, x), largest_exponent);  // also for NaN
  const double k = rounding::nearest_integer(x * log2_e.hi);
  const double r = (x - k * ln_2_parts[0]) - k * ln_2_parts[1];
  const double rest =
      r + r * r *
              series({1 / 2.0, 1 / 6.0, 1 / 24.0, 1 / 120.0, 1 / 720.0, 1 / 5040.0, 1 / 40320.0, 1 / 362880.0,
                      1 / 3628800.0, 1 / 39916800.0, 1 / 479001600.0, 1 / 6227020800.0},
                     r);
  return std::ldexp(1 + rest, static_cast<int>(k));
}

/// Returns e^x in double-double for |x| ≤ 600, with a relative error below 2^-98; for other x that of the
/// nearer of ±600.
///
/// e^x = 2^(k/32) e^t for the integer k next to 32 x / ln 2, |k| < 2^15, and |t| < 0.011; t is off by 12u² of
/// that. The series up to t^12/12! lacks less than 2^-115; its last step has an error of 3u² and 20u² of t.
/// The power has 60u² (root_power_of_two), the product with it 5u².
[[nodiscard, gnu::noinline]] inline DoubleDouble exponential_of(DoubleDouble x) {
  if (x.hi > largest_exponent) x = largest_exponent;
  if (x.hi < -largest_exponent) x = -largest_exponent;
  const double k = rounding::nearest_integer(x.hi * log2_e.hi * root_steps);
  const DoubleDouble t = reduced(x, k / root_steps, precise_ln_2);
  DoubleDouble sum = 1;
  for (int j = 12; j > 0; --j) sum = DoubleDouble(1) + t * sum / DoubleDouble(j);
  const double whole = rounding::floor(k / root_steps);
  const DoubleDouble power = root_power_of_two(static_cast<int>(k - whole * root_steps)) * sum;
  return {std::ldexp(power.hi, static_cast<int>(whole)), std::ldexp(power.lo, static_cast<int>(whole))};
}

/// Returns ln x for x from 2^-800 to 2^800, with a relative error below 2^-50; for other x that of the nearer
/// of 2^±800, and for NaN that of 2^-800.
///
/// x = 2^k m with m from √½ to √2, and ln x = k ln 2 + 2z (1 + s/3 + s²/5 + …) with z = (m − 1)/(m + 1), s =
/// z². m − 1 is exact, so z has 2u, the bracket u and u/20, and their product u: 4.1u of 2|z| · 1.01, which
/// is at most 0.35, and the whole for k = 0. |s| < 0.0295, so that the series up to s^10/21 lacks less than
/// 2^-60. For other k |ln x| > 0.34, and k ln 2 is at most twice as large; its first product is exact, the
/// second and the error of ln 2 count less than 2^-32 u, and the two sums 2u and u of it at most: below 8u.
[[nodiscard]] inline double logarithm_of(double x) {
  const double in_range = rounding::min(rounding::max(1 / largest_power, x), largest_power);  // also for NaN
  int exponent = 0;
  double m = std::frexp(in_range, &exponent);  // in [1/2, 1)
  if (m < 0x1.6a09e667f3bcdp-1) m *= 2, --exponent;
  const double z = (m - 1) / (m + 1), s = z * z, k = exponent;
  const double rest = 2 * z *
                      (1 + s * series({1 / 3.0, 1 / 5.0, 1 / 7.0, 1 / 9.0, 1 / 11.0, 1 / 13.0, 1 / 15.0,
                                       1 / 17.0, 1 / 19.0, 1 / 21.0},
                                      s));
  return k * ln_2_parts[0] + (rest + k * ln_2_parts[1]);
}

/// Returns ln x in double-double for x from 2^-800 to 2^800, with an error below 2^-97 + 2^-103 |ln x|;
/// beyond, that of the nearer end.
///
/// With y = ln x in double and e = e^y: ln x − y = ln(x/e) = 2 artanh d with d = (x − e)/(x + e). |d| <
/// 2^-41, so that 2d lacks less than 2^-122. The error of e counts 2^-98, and the sum has 3u² of itself.
[[nodiscard, gnu::noinline]] inline DoubleDouble logarithm_of(DoubleDouble x) {
  if (x.hi > largest_power) x = largest_power;
  if (x.hi < 1 / largest_power) x = 1 / largest_power;
  const DoubleDouble y = logarithm_of(x.hi), e = exponential_of(y);
  return y + DoubleDouble(2) * ((x - e) / (x + e));
}

template <int N>
[[nodiscard]] simd::Lanes<double, N> exponential_of(simd::Lanes<double, N> x) {
  for (int lane = 0; lane < N; ++lane) x.set(lane, exponential_of(x[lane]));
  return x;
}
template <int N>
[[nodiscard]] simd::Lanes<double, N> logarithm_of(simd::Lanes<double, N> x) {
  for (int lane = 0; lane < N; ++lane) x.set(lane, logarithm_of(x[lane]));
  return x;
}

/// Enclosures of sine and cosine over an interval of a: at(0) returns those of sin a and at(1) those of
/// sin(a + π/2) = cos a; [−1, 1] if the interval is not within ±2^20. With turns = (a + quarter · π/2) / 2π
/// the sine is 1 where turns − ¼ is an integer, and −1 where turns + ¼ is one. If there is no such place in
/// the interval, the extremes are at its ends.
template <class B>
class SinesOver {
 public:
  explicit SinesOver(const Enclosure<B>& a) : a_(a), first_(a.lower), last_(a.upper) {}

  [[nodiscard]] Enclosure<B> at(double quarter) const {
    constexpr double per_angle = 0x1.45f306dc9c883p-3;  // the double nearest to 1/2π
    const Enclosure<B> turns =
        a_ * Enclosure<B>(rounding::below(per_angle), rounding::above(per_angle)) + 0.25 * quarter;
    const auto meets_integer = [](const Enclosure<B>& x) { return x.lower <= rounding::floor(x.upper); };
    const B first = first_.at(quarter), last = last_.at(quarter), error(sine_error<B>);
    const B least = rounding::below(rounding::min(first, last) - error),
            most = rounding::above(rounding::max(first, last) + error);
    const Enclosure<B> values{
        rounding::select(meets_integer(turns + 0.25), B(-1.0), rounding::max(B(-1.0), least)),
        rounding::select(meets_integer(turns - 0.25), B(1.0), rounding::min(B(1.0), most))};
    return select(a_.magnitude() <= B(largest_angle), values, Enclosure<B>{B(-1.0), B(1.0)});
  }

 private:
  Enclosure<B> a_;
  Sines<B> first_, last_;
};

}  // namespace detail

template <class R>
[[nodiscard]] Plain<R> sin(const Plain<R>& a) {
  return Plain<R>::of(detail::Sines<R>(a.value).at(0));
}
template <class R>
[[nodiscard]] Plain<R> cos(const Plain<R>& a) {
  return Plain<R>::of(detail::Sines<R>(a.value).at(1));
}
template <class R>
[[nodiscard]] Plain<R> exp(const Plain<R>& a) {
  return Plain<R>::of(detail::exponential_of(a.value));
}
template <class R>
[[nodiscard]] Plain<R> log(const Plain<R>& a) {
  return Plain<R>::of(detail::logarithm_of(a.value));
}

template <class B>
[[nodiscard]] Enclosure<B> sin(const Enclosure<B>& a) {
  return detail::SinesOver<B>(a).at(0);
}
template <class B>
[[nodiscard]] Enclosure<B> cos(const Enclosure<B>& a) {
  return detail::SinesOver<B>(a).at(1);
}

/// Returns e^a. The lower end is 0 if a may be below −600, and the upper one ∞ if a may be above 600.
template <class B>
[[nodiscard]] Enclosure<B> exp(const Enclosure<B>& a) {
  const B end(detail::largest_exponent), part(2 * detail::exponential_error<B>);
  const B first = detail::exponential_of(a.lower), last = detail::exponential_of(a.upper);
  return {rounding::select(-end <= a.lower, rounding::below(first - first * part), B(0.0)),
          rounding::select(a.upper <= end, rounding::above(last + last * part), B(infinity))};
}

/// Returns the natural logarithm of a; all numbers if a may be below 2^-800 or above 2^800.
template <class B>
[[nodiscard]] Enclosure<B> log(const Enclosure<B>& a) {
  const B first = detail::logarithm_of(a.lower), last = detail::logarithm_of(a.upper);
  const B part(2 * detail::relative_logarithm_error<B>), most(2 * detail::absolute_logarithm_error<B>);
  const Enclosure<B> values{rounding::below(first - (rounding::abs(first) * part + most)),
                            rounding::above(last + (rounding::abs(last) * part + most))};
  return select(B(1 / detail::largest_power) <= a.lower && a.upper <= B(detail::largest_power), values,
                Enclosure<B>::whole());
}

template <class B>
[[nodiscard]] Slope<Enclosure<B>> sin(const Slope<Enclosure<B>>& a) {
  const detail::SinesOver<B> over(a.value);
  return {over.at(0), over.at(1) * a.slope};
}
template <class B>
[[nodiscard]] Slope<Enclosure<B>> cos(const Slope<Enclosure<B>>& a) {
  const detail::SinesOver<B> over(a.value);
  return {over.at(1), -over.at(0) * a.slope};
}
template <class N>
[[nodiscard]] Slope<N> exp(const Slope<N>& a) {
  const N power = exp(a.value);
  return {power, power * a.slope};
}
template <class N>
[[nodiscard]] Slope<N> log(const Slope<N>& a) {
  return {log(a.value), a.slope / a.value};
}

[[nodiscard]] inline Variation sin(const Variation& a) {
  const bool holds = a.value.magnitude() + a.error <= detail::largest_angle;
  return composed(a, sin(a.value), cos(a.value), -sin(a.value), 1,
                  holds ? detail::sine_error<double> : infinity);
}
[[nodiscard]] inline Variation cos(const Variation& a) {
  const bool holds = a.value.magnitude() + a.error <= detail::largest_angle;
  return composed(a, cos(a.value), -sin(a.value), -cos(a.value), 1,
                  holds ? detail::sine_error<double> : infinity);
}
[[nodiscard]] inline Variation exp(const Variation& a) {
  const bool holds = a.value.magnitude() + a.error <= detail::largest_exponent;
  // The largest approximate argument has the largest power, and the largest derivative.
  const double largest = exp(Enclosure<double>(a.value.upper) + a.error).upper;
  const Enclosure<double> powers = exp(a.value);
  return composed(a, powers, powers, powers, largest,
                  holds ? largest * detail::exponential_error<double> : infinity);
}
[[nodiscard]] inline Variation log(const Variation& a) {
  const Enclosure<double> near = a.value + Enclosure<double>{-a.error, a.error}, values = log(near);
  const bool holds = values.magnitude() < infinity;
  const Enclosure<double> slopes = Enclosure<double>(1.0) / a.value;
  return composed(a, log(a.value), slopes, -square(slopes), (Enclosure<double>(1.0) / near).magnitude(),
                  holds ? values.magnitude() * detail::relative_logarithm_error<double> : infinity);
}

}  // namespace protostar::inline PROTOSTAR_ABI

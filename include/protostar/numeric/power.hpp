// Powers that are the same on every machine.
//
// std::pow differs from one C library to the next, in its last bit and sometimes more. This file uses only
// operations that IEEE 754 rounds correctly: x^y = 2^(y log2 x), in double-double if cancellation or a large
// exponent would show, and in exact arithmetic if a comparison needs more. u = 2^-53.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "double_double.hpp"
#include "exact_number.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline constexpr int root_steps = 32;  ///< number of equal ratios from 1 to 2
inline constexpr DoubleDouble ln_2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
inline constexpr DoubleDouble log2_e{0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56};

/// Returns 2^(i/32) for i from 0 to 32, products of at most five of √2, √√2, …; 1 and 2 are exact. Each of
/// these roots has an error below 8u², since a root halves the error of its argument and adds 4u². With the
/// products' 5u² each, a power has an error below 5 · 8u² + 4 · 5u² = 60u² < 2^-100.
[[nodiscard]] inline const DoubleDouble& root_power_of_two(int i) {
  static const struct Table {
    DoubleDouble powers[root_steps + 1];

    Table() {
      for (DoubleDouble& power : powers) power = 1.0;
      powers[root_steps] = 2.0;
      for (std::size_t step = root_steps / 2; step >= 1; step /= 2) {
        const DoubleDouble root = sqrt(powers[2 * step]);
        for (std::size_t j = step; j < root_steps; ++j)
          if ((j & step) != 0) powers[j] = powers[j] * root;
      }
    }
  } table;
  return table.powers[i];
}

/// Returns c0 + c1 x + c2 x² + ….
template <std::size_t N, class T>
[[nodiscard]] T polynomial(const double (&c)[N], T x) {
  using std::fma;
  T sum = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = fma(sum, x, T(c[i]));
  return sum;
}

}  // namespace detail

/// Returns a/b for doubles, with a relative error below 2u²: the remainder of a rounded quotient is a double.
/// It does not underflow if a is 0, or |a| and |a/b| are above 2^-900.
[[nodiscard]] inline DoubleDouble quotient(double a, double b) {
  const double rounded = a / b;
  return {rounded, std::fma(-rounded, b, a) / b};
}

/// Returns log2 x for a positive, finite x.hi that is not denormal, with a relative error below 2^-65; exact
/// if x is a power of two.
///
/// x = 2^n · (1 + z)/(1 − z) for a multiple n of 1/32 within 1/64 + 2^-13 of log2 x, and
///   log2 x = n + 2 log2(e) · z · (1 + s/3 + s²/5 + …)   with   s = z² < 2^-15.
/// The series up to s⁷/15 lacks less than 2^-120 of itself. Its terms after the 1 are below 2^-16.5, and
/// their evaluation in double has an error of 8u of that, 2^-66.5. All else, in double-double, is below
/// 2^-90: for n = 0, 1 is exact and z as good as a quotient; for other n, |log2 x| > 1/65, against which the
/// table's 60u² have a weight of at most 65.
[[nodiscard]] inline DoubleDouble log2(DoubleDouble x) {
  int exponent = 0;
  const double m = std::frexp(x.hi, &exponent);  // in [1/2, 1)
  const DoubleDouble mantissa{m, std::ldexp(x.lo, -exponent)};

  // 32 log2 m, from two terms of the same series around √½, where it is −16; they lack at most 0.003.
  constexpr double middle = 0x1.6a09e667f3bcdp-1;
  const double rough = (m - middle) / (m + middle);
  const double steps =
      std::round(std::fma(64 * detail::log2_e.hi, std::fma(rough, rough * rough / 3, rough), -16));
  const DoubleDouble& power = detail::root_power_of_two(detail::root_steps + static_cast<int>(steps));
  const DoubleDouble nearest{power.hi / 2, power.lo / 2};

  // Two digits of a long division, accurate to 2^-100 like the rounding of the second.
  const DoubleDouble sum = mantissa + nearest, difference = mantissa - nearest;
  const double digit = difference.hi / sum.hi;
  const DoubleDouble z = fast_two_sum(digit, (difference - sum * digit).hi / sum.hi);
  const double s = z.hi * z.hi;
  const double rest =
      s * detail::polynomial({1 / 3.0, 1 / 5.0, 1 / 7.0, 1 / 9.0, 1 / 11.0, 1 / 13.0, 1 / 15.0}, s);
  const DoubleDouble series =
      DoubleDouble(2 * detail::log2_e.hi, 2 * detail::log2_e.lo) * z * fast_two_sum(1.0, rest);
  return DoubleDouble(exponent + steps / detail::root_steps) + series;
}

/// Returns 2^x, with a relative error below 2^-63; exact if x is an integer. Infinity from 1024 on, 0 below
/// −1000: in between, the range of double takes less than 2^-74 of a result from its lower part.
///
/// 2^x = 2^n · e^t for the multiple n of 1/32 next to x, and t = (x − n) ln 2, |t| < 2^-6.5. The series of
/// e^t up to t^11/11! lacks less than 2^-103. Its terms after t are below 2^-14, and their evaluation in
/// double has an error of less than 6u of that, 2^-64.4: 2u as t² is without the lower half of t, one in each
/// of two products, and one in the sum. All else is double-double.
[[nodiscard]] inline DoubleDouble exp2(DoubleDouble x) {
  if (!(x.hi < 1024)) return x.hi >= 1024 ? std::numeric_limits<double>::infinity() : x.hi;
  if (x.hi < -1000) return 0.0;
  const double n = std::round(detail::root_steps * x.hi) / detail::root_steps;
  const double whole = std::floor(n);
  const DoubleDouble t = (x - DoubleDouble(n)) * detail::ln_2;
  const double rest = t.hi * t.hi *
                      detail::polynomial({1 / 2.0, 1 / 6.0, 1 / 24.0, 1 / 120.0, 1 / 720.0, 1 / 5040.0,
                                          1 / 40320.0, 1 / 362880.0, 1 / 3628800.0, 1 / 39916800.0},
                                         t.hi);
  const DoubleDouble power = detail::root_power_of_two(static_cast<int>(detail::root_steps * (n - whole))) *
                             (DoubleDouble(1) + (t + DoubleDouble(rest)));
  return {std::ldexp(power.hi, static_cast<int>(whole)), std::ldexp(power.lo, static_cast<int>(whole))};
}

/// Returns x^y for a positive, finite x.hi that is not denormal, with the range of exp2. An error of y log2 x
/// counts in the power times ln 2, so the relative error is below 2^-63 + |y log2 x| · 2^-65: below 2^-57.4
/// for results between 2^-150 and 2^150, and below 2^-54 for all others. Exact if x is a power of two and the
/// result is one.
[[nodiscard]] inline DoubleDouble pow(DoubleDouble x, DoubleDouble y) { return exp2(y * log2(x)); }

/// Returns x^n for 0 ≤ x ≤ 1 and n ≥ 0, or for several such numbers x, by squaring. Written as n factors x it
/// has n − 1 products, each with an error of u, so its relative error is below n u for n < 2^20. If a product
/// underflows, both it and x^n are below 2^-1000.
template <class T>
[[nodiscard]] T whole_power(T x, int n) {
  T power = 1.0;
  for (; n > 1; n /= 2) {
    if (n % 2 != 0) power = power * x;
    x = x * x;
  }
  return n == 1 ? power * x : power;
}

namespace detail {

/// Returns log2 x for a double x > 0 with an error of at most 2^(1 − 53·(terms − 1)), digit by digit:
/// squaring a number in [1, 2) doubles its logarithm, and if the square is 2 or more, the next binary digit
/// is 1. Each square is cut to that many terms, an error of less than 2^(2 − 53·terms), which counts half as
/// much in each next digit. Exact if x is a power of two.
[[nodiscard, gnu::cold]] inline ExactNumber log2_digits(double x, int terms) {
  int exponent = 0;
  ExactNumber rest = 2 * std::frexp(x, &exponent);
  ExactNumber sum = exponent - 1;
  const int digits = 53 * (terms - 1);
  for (int i = 1; i <= digits; ++i) {
    ExactNumber square = rest * rest;
    rest = {};
    for (int term = 0; term < terms; ++term) {
      const double leading = DoubleDouble(square).hi;
      rest += leading;
      square += -leading;
    }
    if ((rest - ExactNumber(2)).sign() < 0) continue;
    rest = rest * ExactNumber(0.5);
    sum += std::ldexp(1, -i);
  }
  return sum;
}

}  // namespace detail

/// Tests whether (p/q)^y > x^z for positive, finite doubles, by as many digits of y (log2 p − log2 q) and z
/// log2 x as it takes. The two must not be equal, unless p/q and x are powers of two.
[[nodiscard, gnu::cold]] inline bool power_exceeds(double p, double q, double y, double x, double z) {
  int exponent = 0;
  const auto mantissa = [&](double number) { return std::frexp(number, &exponent); };
  const bool is_exact = mantissa(p) == mantissa(q) && mantissa(x) == 0.5;  // the digits of p and q cancel
  for (int terms = 4;; terms *= 2) {
    const ExactNumber power =
        ExactNumber(y) * (detail::log2_digits(p, terms) - detail::log2_digits(q, terms));
    const double difference = DoubleDouble(power - ExactNumber(z) * detail::log2_digits(x, terms)).hi;
    // Three logarithms, each with half of the error allowed for it here, and the rounding of the difference.
    const double error = (2 * y + z) * std::ldexp(1, 2 - 53 * (terms - 1));
    if (is_exact || std::abs(difference) > error) return difference > 0;
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Numbers of 113 bits to judge the number types of distance fields. Nothing here comes from the library.
#pragma once

#include <cmath>
#include <cstddef>

#include "stress/exact.hpp"

/// Number of 113 bits and the exponents of Quad, with the operations of fields: each with a relative error
/// below 2^-108, or below 2^-106 absolutely for functions with values about 1.
struct TrueNumber {
  exact::Quad value = 0;

  TrueNumber() = default;
  TrueNumber(double number) : value(number) {}

  static TrueNumber of(exact::Quad number) {
    TrueNumber x;
    x.value = number;
    return x;
  }

  explicit operator double() const { return static_cast<double>(value); }

  friend TrueNumber operator-(TrueNumber a) { return of(-a.value); }
  friend TrueNumber operator+(TrueNumber a, TrueNumber b) { return of(a.value + b.value); }
  friend TrueNumber operator-(TrueNumber a, TrueNumber b) { return of(a.value - b.value); }
  friend TrueNumber operator*(TrueNumber a, TrueNumber b) { return of(a.value * b.value); }
  friend TrueNumber operator/(TrueNumber a, TrueNumber b) { return of(a.value / b.value); }

  friend TrueNumber min(TrueNumber a, TrueNumber b) { return b.value < a.value ? b : a; }
  friend TrueNumber max(TrueNumber a, TrueNumber b) { return a.value < b.value ? b : a; }
  friend TrueNumber abs(TrueNumber a) { return a.value < 0 ? -a : a; }
  friend TrueNumber square(TrueNumber a) { return a * a; }

  friend TrueNumber sqrt(TrueNumber a) {
    if (!(a.value > 0)) return 0.0;
    // A power of 4 brings the number into the range of double.
    exact::Quad x = a.value, scale = 1;
    while (x > 0x1p500) x *= exact::Quad(0x1p-500), scale *= exact::Quad(0x1p250);
    while (x < 0x1p-500) x *= exact::Quad(0x1p500), scale *= exact::Quad(0x1p-250);
    exact::Quad root = std::sqrt(static_cast<double>(x));
    for (int step = 0; step < 2; ++step) root = (root + x / root) / 2;
    return of(root * scale);
  }

  /// Returns an integer that is nearest to a number below 2^100.
  static exact::Quad nearest(exact::Quad x) {
    constexpr exact::Quad big = exact::Quad(0x1p111) * 3;  // 2^112 + 2^111, whose last bit counts 1
    return x + big - big;
  }
  friend TrueNumber fold(TrueNumber a) { return abs(of(a.value - 2 * nearest(a.value / 2))); }
  friend TrueNumber wrap(TrueNumber a) { return of(a.value - nearest(a.value)); }

  friend TrueNumber smooth_min(TrueNumber a, TrueNumber b, double k) {
    const TrueNumber h = max(k - abs(a - b), 0.0);
    return min(a, b) - h * h / (TrueNumber(4) * k);
  }

  template <std::size_t n>
  friend TrueNumber length_of(const TrueNumber (&v)[n]) {
    TrueNumber sum;
    for (const TrueNumber& x : v) sum = sum + x * x;
    return sqrt(sum);
  }
  template <std::size_t n>
  friend TrueNumber signed_length_of(const TrueNumber (&q)[n]) {
    TrueNumber outside[n], largest = q[0];
    for (std::size_t i = 0; i < n; ++i) outside[i] = max(q[i], 0.0), largest = max(largest, q[i]);
    return length_of(outside) + min(largest, 0.0);
  }

  /// Returns the sine of a + quarter · π/2 by its series.
  static TrueNumber sine(TrueNumber a, int quarter) {
    const exact::Quad k = nearest(a.value / exact::Quad(half_pi_parts[0]));
    exact::Quad r = a.value;
    for (const double part : half_pi_parts) r -= k * exact::Quad(part);
    const int turn = (static_cast<int>(static_cast<long long>(k) % 4) + quarter + 4) % 4;
    exact::Quad sum = 1;
    for (int j = turn % 2 == 1 ? 36 : 37; j > 1; j -= 2) sum = 1 - sum * r * r / (j * (j - 1));
    return of((turn >= 2 ? -sum : sum) * (turn % 2 == 1 ? exact::Quad(1) : r));
  }
  friend TrueNumber sin(TrueNumber a) { return sine(a, 0); }
  friend TrueNumber cos(TrueNumber a) { return sine(a, 1); }

  friend TrueNumber exp(TrueNumber a) {
    exact::Quad k = nearest(a.value / exact::Quad(ln_2_parts[0])), r = a.value, sum = 1;
    for (const double part : ln_2_parts) r -= k * exact::Quad(part);
    for (int j = 32; j > 0; --j) sum = 1 + r * sum / j;
    for (; k > 0; k -= 1) sum *= 2;
    for (; k < 0; k += 1) sum /= 2;
    return of(sum);
  }

  /// Returns the logarithm, of a double by the C library, with two steps of Newton's method.
  friend TrueNumber log(TrueNumber a) {
    TrueNumber y = std::log(static_cast<double>(a.value));
    for (int step = 0; step < 2; ++step) y = y + 2.0 * ((a - exp(y)) / (a + exp(y)));
    return y;
  }

 private:
  static constexpr double half_pi_parts[] = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54,
                                             -0x1.f1976b7ed8fbcp-110, 0x1.4cf98e804177dp-164};
  static constexpr double ln_2_parts[] = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56, 0x1.7b57a079a1934p-111,
                                          -0x1.ace93a4ebe5d1p-165};
};

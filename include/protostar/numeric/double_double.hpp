// Double-double arithmetic: numbers of twice the precision of double, as unevaluated sums of two doubles.
//
// u = 2^-53 is the unit roundoff of double. Sources: Dekker 1971, Knuth (TAOCP 2, 4.2.2), and for the bounds
// Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
// arithmetic", 2017.
#pragma once

#include <cmath>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns x in a form that a compiler cannot look through. Error-free transforms need each operation rounded
/// as it is written. A compiler that may contract (g++ does unless told -ffp-contract=off) would fuse a
/// product with the addition that takes it, and the transform's error term would belong to another sum.
[[nodiscard]] inline double opaque(double x) {
#if defined(__GNUC__) && defined(__SSE2__)
  __asm__("" : "+x"(x));
  return x;
#elif defined(__wasm__)
  return x;  // WebAssembly has no instruction that fuses them
#else
  volatile double hidden = x;
  return hidden;
#endif
}

/// Number hi + lo, where hi is the double nearest to the sum: |lo| ≤ u |hi|.
struct DoubleDouble {
  double hi = 0, lo = 0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double value) : hi(value) {}
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}

  /// Returns the nearest double.
  constexpr explicit operator double() const { return hi + lo; }

  [[nodiscard]] constexpr int sign() const { return hi > 0 ? 1 : hi < 0 ? -1 : 0; }
};

/// Returns a + b exactly (Knuth), unless it overflows.
[[nodiscard]] inline DoubleDouble two_sum(double a, double b) {
  a = opaque(a), b = opaque(b);
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Returns a + b exactly (Dekker), for |a| ≥ |b| or a = 0.
[[nodiscard]] inline DoubleDouble fast_two_sum(double a, double b) {
  a = opaque(a), b = opaque(b);
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// Returns a · b exactly, unless it overflows or its lowest bit lies below 2^-1074.
[[nodiscard]] inline DoubleDouble two_product(double a, double b) {
  const double product = opaque(a * b);
  return {product, std::fma(a, b, -product)};
}

// Relative errors: sum 3u² + 13u³, product 5u², quotient 10u², root 4u².
[[nodiscard]] inline DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble high = two_sum(a.hi, b.hi), low = two_sum(a.lo, b.lo);
  const DoubleDouble sum = fast_two_sum(high.hi, high.lo + low.hi);
  return fast_two_sum(sum.hi, sum.lo + low.lo);
}
[[nodiscard]] inline DoubleDouble operator-(DoubleDouble a) { return {-a.hi, -a.lo}; }
[[nodiscard]] inline DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + -b; }
[[nodiscard]] inline DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble high = two_product(a.hi, b.hi);
  return fast_two_sum(high.hi, high.lo + std::fma(a.hi, b.lo, a.lo * b.hi));
}
[[nodiscard, gnu::noinline]] inline DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
  // Long division: two digits of 53 bits, and a third to round the second.
  const double first = a.hi / b.hi;
  DoubleDouble rest = a - b * first;
  const double second = rest.hi / b.hi;
  rest = rest - b * second;
  return fast_two_sum(first, second) + DoubleDouble(rest.hi / b.hi);
}
/// Returns √a for a ≥ 0: the double root s and one Newton step, (a − s²) / 2s.
[[nodiscard, gnu::noinline]] inline DoubleDouble sqrt(DoubleDouble a) {
  const double s = std::sqrt(a.hi);
  if (!(s > 0)) return {};
  return fast_two_sum(s, (a - two_product(s, s)).hi / (2 * s));
}
[[nodiscard]] inline DoubleDouble abs(DoubleDouble a) { return a.hi < 0 ? -a : a; }

// Comparisons are exact, as hi is the double nearest to the sum; with NaN they are false.
[[nodiscard]] inline bool operator<(DoubleDouble a, DoubleDouble b) {
  return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
}
[[nodiscard]] inline bool operator<=(DoubleDouble a, DoubleDouble b) {
  return a.hi < b.hi || (a.hi == b.hi && a.lo <= b.lo);
}

}  // namespace protostar::inline PROTOSTAR_ABI

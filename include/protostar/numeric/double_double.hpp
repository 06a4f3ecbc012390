// Double-double arithmetic: numbers of twice the precision of double, as unevaluated sums of two doubles, or
// such a number in each lane. Lanes have the bits of a single number.
//
// u = 2^-53 is the unit roundoff of double. Sources: Dekker 1971, Knuth (TAOCP 2, 4.2.2), and for the bounds
// Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
// arithmetic", 2017, and for that of the product Muller and Rideau, who improved it in 2022
// (docs/derivations.md, Double-double).
#pragma once

#include <cmath>
#include <type_traits>

#include "../interval.hpp"
#include "../platform.hpp"
#include "../simd/opaque.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template <class T>
struct DoubleDoubleOf;

/// Returns a + b exactly (Knuth), unless it overflows.
template <class T>
[[nodiscard]] inline DoubleDoubleOf<T> two_sum(T a, std::type_identity_t<T> b) {
  a = opaque(a), b = opaque(b);
  const T sum = a + b;
  const T b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Returns a + b exactly (Dekker), for |a| ≥ |b| or a = 0.
template <class T>
[[nodiscard]] inline DoubleDoubleOf<T> fast_two_sum(T a, std::type_identity_t<T> b) {
  a = opaque(a), b = opaque(b);
  const T sum = a + b;
  return {sum, b - (sum - a)};
}

/// Returns a · b exactly, unless it overflows or its lowest bit lies below 2^-1074.
template <class T>
[[nodiscard]] inline DoubleDoubleOf<T> two_product(T a, std::type_identity_t<T> b) {
  using std::fma;
  const T product = opaque(a * b);
  return {product, fma(a, b, -product)};
}

/// Number hi + lo, where hi is the double nearest to the sum: |lo| ≤ u |hi|. T is double, or simd::Doubles
/// for a number in each lane.
///
/// Relative errors: sum 3u² + 13u³, product 5u², quotient 10u², root 4u².
template <class T>
struct DoubleDoubleOf {
  T hi{}, lo{};

  constexpr DoubleDoubleOf() = default;
  constexpr DoubleDoubleOf(T value) : hi(value) {}
  constexpr DoubleDoubleOf(T high, T low) : hi(high), lo(low) {}

  /// Returns the nearest double.
  constexpr explicit operator T() const { return hi + lo; }

  [[nodiscard]] constexpr int sign() const { return hi > 0 ? 1 : hi < 0 ? -1 : 0; }

  [[nodiscard]] friend DoubleDoubleOf operator+(DoubleDoubleOf a, DoubleDoubleOf b) {
    const DoubleDoubleOf high = two_sum(a.hi, b.hi), low = two_sum(a.lo, b.lo);
    const DoubleDoubleOf sum = fast_two_sum(high.hi, high.lo + low.hi);
    return fast_two_sum(sum.hi, sum.lo + low.lo);
  }
  [[nodiscard]] friend DoubleDoubleOf operator-(DoubleDoubleOf a) { return {-a.hi, -a.lo}; }
  [[nodiscard]] friend DoubleDoubleOf operator-(DoubleDoubleOf a, DoubleDoubleOf b) { return a + -b; }
  [[nodiscard]] friend DoubleDoubleOf operator*(DoubleDoubleOf a, DoubleDoubleOf b) {
    using std::fma;
    const DoubleDoubleOf high = two_product(a.hi, b.hi);
    return fast_two_sum(high.hi, high.lo + fma(a.hi, b.lo, a.lo * b.hi));
  }
  [[nodiscard, gnu::noinline]] friend DoubleDoubleOf operator/(DoubleDoubleOf a, DoubleDoubleOf b) {
    // Long division: two digits of 53 bits, and a third to round the second.
    const T first = a.hi / b.hi;
    DoubleDoubleOf rest = a - b * first;
    const T second = rest.hi / b.hi;
    rest = rest - b * second;
    return fast_two_sum(first, second) + DoubleDoubleOf(rest.hi / b.hi);
  }

  // Comparisons are exact, as hi is the double nearest to the sum; with NaN they are false.
  [[nodiscard]] friend auto operator<(DoubleDoubleOf a, DoubleDoubleOf b) {
    return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
  }
  [[nodiscard]] friend auto operator<=(DoubleDoubleOf a, DoubleDoubleOf b) {
    return a.hi < b.hi || (a.hi == b.hi && a.lo <= b.lo);
  }
};

using DoubleDouble = DoubleDoubleOf<double>;

/// Returns √a for a ≥ 0: the double root s and one Newton step, (a − s²) / 2s.
[[nodiscard, gnu::noinline]] inline DoubleDouble sqrt(DoubleDouble a) {
  const double s = std::sqrt(a.hi);
  if (!(s > 0)) return {};
  return fast_two_sum(s, (a - two_product(s, s)).hi / (2 * s));
}
[[nodiscard]] inline DoubleDouble abs(DoubleDouble a) { return a.hi < 0 ? -a : a; }

/// Returns the largest double that is at most a.
[[nodiscard]] inline double double_below(DoubleDouble a) {
  return a.lo < 0 ? std::nextafter(a.hi, -infinity) : a.hi;
}

/// Returns the smallest double that is at least a.
[[nodiscard]] inline double double_above(DoubleDouble a) { return -double_below(-a); }

}  // namespace protostar::inline PROTOSTAR_ABI

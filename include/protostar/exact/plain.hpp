// Numbers that are rounded as the processor does: the type for plain values of a field.
//
// Plain<double> is a double, and Plain<simd::Doubles> one for each lane, with the same bits. They have the
// operations of enclosures (enclosure.hpp), so that a field is written once. They are a type of their own
// since sin(x) of a double, in a program that says `using namespace protostar`, might be that of the C
// library, whose last bits no bound holds for. There are no comparisons: a field chooses by min and max.
#pragma once

#include <cstddef>

#include "rounding.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Number of type R, which is double or lanes of doubles.
template <class R>
struct Plain {
  R value;

  Plain() : value(0.0) {}
  Plain(double number) : value(number) {}

  /// Returns a number of type R: a double, or one for each lane.
  [[nodiscard]] static Plain of(const R& number) {
    Plain plain;
    plain.value = number;
    return plain;
  }

  friend Plain operator-(Plain a) { return of(-a.value); }
  friend Plain operator+(Plain a, Plain b) { return of(a.value + b.value); }
  friend Plain operator-(Plain a, Plain b) { return of(a.value - b.value); }
  friend Plain operator*(Plain a, Plain b) { return of(a.value * b.value); }
  friend Plain operator/(Plain a, Plain b) { return of(a.value / b.value); }

  friend Plain min(Plain a, Plain b) { return of(rounding::min(a.value, b.value)); }
  friend Plain max(Plain a, Plain b) { return of(rounding::max(a.value, b.value)); }
  friend Plain abs(Plain a) { return of(rounding::abs(a.value)); }
  friend Plain square(Plain a) { return a * a; }

  /// Returns the square root; 0 for negative numbers.
  friend Plain sqrt(Plain a) { return of(rounding::sqrt(rounding::max(a.value, R(0.0)))); }

  /// Returns the distance to the nearest even number, from 0 to 1, without rounding (Enclosure's fold tells
  /// why).
  friend Plain fold(Plain a) {
    return of(rounding::abs(a.value - rounding::nearest_integer(a.value * R(0.5)) * R(2.0)));
  }

  /// Returns the difference from the nearest integer, from −1/2 to 1/2, without rounding: both are multiples
  /// of the last place of a or of 1.
  friend Plain wrap(Plain a) { return of(a.value - rounding::nearest_integer(a.value)); }

  /// Returns the polynomial smooth minimum of Quilez, min(a, b) − max(k − |a − b|, 0)²/(4k), for k > 0.
  friend Plain smooth_min(Plain a, Plain b, double k) {
    const Plain h = max(k - abs(a - b), 0.0);
    return min(a, b) - h * h * (0.25 / k);
  }

  /// Returns the length of a vector.
  template <std::size_t n>
  friend Plain length_of(const Plain (&v)[n]) {
    Plain sum = v[0] * v[0];
    for (std::size_t i = 1; i < n; ++i) sum = sum + v[i] * v[i];
    return of(rounding::sqrt(sum.value));
  }

  /// Returns the signed distance of q from the vectors without a positive component: |max(q, 0)| outside, and
  /// the largest component, which is negative, inside.
  template <std::size_t n>
  friend Plain signed_length_of(const Plain (&q)[n]) {
    Plain outside[n], largest = q[0];
    for (std::size_t i = 0; i < n; ++i) outside[i] = max(q[i], 0.0), largest = max(largest, q[i]);
    return length_of(outside) + min(largest, 0.0);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

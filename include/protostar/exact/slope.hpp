// Values of a field on a segment of a line together with its slope, the derivative along the line.
//
// A Slope<Enclosure<B>> holds enclosures of the values F(t) of a function for all t in an interval, and of
// its slopes there. Start with t itself, Slope{interval, 1.0}: coordinate k of a point on a ray is
// Slope{origin[k] + t * direction[k], direction[k]}.
//
// At a kink of min, max, abs or fold the slope is the hull of those on both sides. It contains
// Clarke's generalized gradient, so that the mean value theorem holds (Lebourg 1975): (F(b) − F(a)) / (b − a)
// is in the slope over [a, b].
#pragma once

#include <cstddef>

#include "enclosure.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Enclosures of the values and of the slopes of a function of one variable; N is an Enclosure.
template <class N>
struct Slope {
  N value, slope;

  Slope() = default;

  /// Constructs a constant.
  Slope(double number) : value(number), slope(0.0) {}

  Slope(const N& values, const N& slopes) : value(values), slope(slopes) {}

  friend Slope operator-(const Slope& a) { return {-a.value, -a.slope}; }
  friend Slope operator+(const Slope& a, const Slope& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Slope operator-(const Slope& a, const Slope& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Slope operator+(const Slope& a, double b) { return {a.value + b, a.slope}; }
  friend Slope operator+(double a, const Slope& b) { return b + a; }
  friend Slope operator-(const Slope& a, double b) { return {a.value - b, a.slope}; }
  friend Slope operator-(double a, const Slope& b) { return {a - b.value, -b.slope}; }
  friend Slope operator*(const Slope& a, const Slope& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend Slope operator*(const Slope& a, double b) { return {a.value * b, a.slope * b}; }
  friend Slope operator*(double a, const Slope& b) { return b * a; }
  friend Slope operator/(const Slope& a, const Slope& b) {
    const N quotient = a.value / b.value;
    return {quotient, (a.slope - quotient * b.slope) / b.value};
  }
  friend Slope operator/(const Slope& a, double b) { return {a.value / b, a.slope / b}; }

  friend Slope min(const Slope& a, const Slope& b) {
    return {min(a.value, b.value), of_smaller(a.value, b.value, a.slope, b.slope)};
  }
  friend Slope max(const Slope& a, const Slope& b) {
    return {max(a.value, b.value), of_smaller(b.value, a.value, a.slope, b.slope)};
  }
  friend Slope abs(const Slope& a) {
    return {abs(a.value), of_smaller(-a.value, a.value, a.slope, -a.slope)};
  }
  friend Slope square(const Slope& a) { return {square(a.value), a.value * a.slope * 2.0}; }

  /// Returns the square root; its slope is not bounded where the value may be 0.
  friend Slope sqrt(const Slope& a) {
    const N root = sqrt(a.value);
    return {root, a.slope / (root * 2.0)};
  }

  /// Returns the distance to the nearest even number. It rises from each even number to the next odd one.
  friend Slope fold(const Slope& a) {
    const auto first = rounding::floor(a.value.lower), last = rounding::floor(a.value.upper);
    const auto half = first * decltype(first)(0.5);
    const auto rises = half <= rounding::floor(half);
    const N falling = -a.slope;
    return {fold(a.value), select(last <= first, select(rises, a.slope, falling), hull(a.slope, falling))};
  }

  /// Returns the difference from the nearest integer, and the slope of its branches, as if there were no jump
  /// between them. A field made with wrap has to be continuous where wrap jumps, as the distance from the
  /// nearest of several copies is; then its slopes hold.
  friend Slope wrap(const Slope& a) { return {wrap(a.value), a.slope}; }

  /// Returns the smooth minimum for k > 0. Its slope is w a' + (1 − w) b' with w = ½ + (b − a)/2k, cut to
  /// [0, 1].
  friend Slope smooth_min(const Slope& a, const Slope& b, double k) {
    const N weight = clamp((b.value - a.value) / (2 * k) + 0.5, 0, 1);
    const N mixed = b.slope + weight * (a.slope - b.slope), outer = hull(a.slope, b.slope);
    return {smooth_min(a.value, b.value, k), common(mixed, outer)};
  }

  /// Returns the length of v, and its slope v · v' / |v|, which is at most Σ |v'_i| in magnitude, also where
  /// |v| may be 0. The slope is one quotient, so that it has one sign if v · v' has.
  template <std::size_t n>
  friend Slope length_of(const Slope (&v)[n]) {
    N values[n];
    for (std::size_t i = 0; i < n; ++i) values[i] = v[i].value;
    N product = v[0].value * v[0].slope;
    auto largest = v[0].slope.magnitude();
    for (std::size_t i = 1; i < n; ++i) {
      product = product + v[i].value * v[i].slope;
      largest = rounding::above(largest + v[i].slope.magnitude());
    }
    const N length = length_of(values);
    return {length, unit_component(product, length, largest)};
  }

  /// Returns the signed distance of q from the vectors without a positive component. As one operation it has
  /// the slope of |max(q, 0)| outside and of the largest component inside; the slopes of the two terms,
  /// added, would be twice as large.
  template <std::size_t n>
  friend Slope signed_length_of(const Slope (&q)[n]) {
    Slope parts[n], largest = q[0];
    for (std::size_t i = 0; i < n; ++i) parts[i] = max(q[i], 0.0), largest = max(largest, q[i]);
    const Slope outside = length_of(parts);
    const auto zero = N(0.0);
    return {outside.value + min(largest.value, 0.0),
            of_smaller(zero, largest.value, outside.slope, largest.slope)};
  }

 private:
  /// Returns p where all of a is below b, q where all of b is below a, and else the hull of both.
  static N of_smaller(const N& a, const N& b, const N& p, const N& q) {
    return select(a.upper < b.lower, p, select(b.upper < a.lower, q, hull(p, q)));
  }
};

template <class N>
Slope(N, N) -> Slope<N>;

}  // namespace protostar::inline PROTOSTAR_ABI

// Interval arithmetic with outward rounding.
//
// An Enclosure<B> is an interval that surely contains a number. Arithmetic and functions of enclosures
// contain the exact results for all numbers in their arguments, so that a formula written once, for any
// number type, gives bounds of all its values. B is double, DoubleDouble, or simd::Lanes of doubles. A
// result that is not known, after an overflow or a division by 0, is (−∞, ∞), never NaN.
//
//   const Enclosure<double> x(1, 2);
//   const auto y = sqrt(x * x + 1.0) - 0.3;   // y.lower ≤ √(x² + 1) − 0.3 ≤ y.upper for each x in [1, 2]
//
// + − * / (with doubles too), unary −, min, max, abs, sqrt, square, fold, wrap, smooth_min, length_of,
// signed_length_of; hull, select. Sine, cosine, exponential and logarithm are in functions.hpp.
#pragma once

#include <cmath>
#include <cstddef>

#include "rounding.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Interval lower ≤ x ≤ upper that surely contains a number x. Its ends are of type B, and may be infinite.
/// Constants of a formula are doubles, and count as exact.
template <class B>
struct Enclosure {
  using Truth = decltype(B{} < B{});  ///< bool, or a mask with a truth value for each lane

  B lower, upper;

  /// Constructs [0, 0].
  Enclosure() : Enclosure(0.0) {}

  /// Constructs an interval that is a single finite number.
  Enclosure(double number) : lower(number), upper(number) {}

  /// Constructs the interval [least, most], for least ≤ most in each lane.
  Enclosure(const B& least, const B& most) : lower(least), upper(most) {}

  /// Returns the interval that is a single number.
  [[nodiscard]] static Enclosure at(const B& number) { return {number, number}; }

  /// Returns the interval of all numbers.
  [[nodiscard]] static Enclosure whole() { return {B(-infinity), B(infinity)}; }

  /// Tests whether the interval contains a number.
  [[nodiscard]] Truth contains(const B& x) const { return lower <= x && x <= upper; }

  /// Returns the middle, rounded.
  [[nodiscard]] B middle() const { return B(0.5) * (lower + upper); }

  /// Returns the largest magnitude of its numbers.
  [[nodiscard]] B magnitude() const { return rounding::max(-lower, upper); }

  friend Enclosure operator-(const Enclosure& a) { return {-a.upper, -a.lower}; }
  friend Enclosure operator+(const Enclosure& a, const Enclosure& b) {
    return {rounding::below(a.lower + b.lower), rounding::above(a.upper + b.upper)};
  }
  friend Enclosure operator-(const Enclosure& a, const Enclosure& b) { return a + -b; }

  friend Enclosure operator*(const Enclosure& a, const Enclosure& b) {
    return spanned(a, b, a.lower * b.lower, a.lower * b.upper, a.upper * b.lower, a.upper * b.upper);
  }
  friend Enclosure operator*(const Enclosure& a, double b) {
    return scaled(a, b, a.lower * B(b), a.upper * B(b));
  }
  friend Enclosure operator*(double a, const Enclosure& b) { return b * a; }

  friend Enclosure operator/(const Enclosure& a, const Enclosure& b) {
    const Enclosure quotient =
        spanned(a, b, a.lower / b.lower, a.lower / b.upper, a.upper / b.lower, a.upper / b.upper);
    return select(b.may_be_tiny(), whole(), quotient);
  }
  friend Enclosure operator/(const Enclosure& a, double b) {
    return std::abs(b) <= rounding::least_divisor<B> ? whole() : scaled(a, b, a.lower / B(b), a.upper / B(b));
  }

  friend Enclosure min(const Enclosure& a, const Enclosure& b) {
    return {rounding::min(a.lower, b.lower), rounding::min(a.upper, b.upper)};
  }
  friend Enclosure max(const Enclosure& a, const Enclosure& b) {
    return {rounding::max(a.lower, b.lower), rounding::max(a.upper, b.upper)};
  }
  friend Enclosure abs(const Enclosure& a) {
    return {rounding::max(B(0.0), rounding::max(a.lower, -a.upper)), a.magnitude()};
  }

  friend Enclosure square(const Enclosure& a) {
    const Enclosure size = abs(a);
    return {rounding::max(B(0.0), rounding::below(size.lower * size.lower, rounding::underflow<B>)),
            above_unless_zero(size.upper, size.upper * size.upper, rounding::underflow<B>)};
  }

  /// Returns the square root. Negative numbers have the root 0, for all number types of fields.
  friend Enclosure sqrt(const Enclosure& a) {
    const B least = rounding::max(a.lower, B(0.0)), most = rounding::max(a.upper, B(0.0));
    return {rounding::max(B(0.0), rounding::below(rounding::sqrt(least), rounding::root_underflow<B>)),
            above_unless_zero(most, rounding::sqrt(most), rounding::root_underflow<B>)};
  }

  /// Returns the distance to the nearest even number, which is between 0 and 1: mirrored repetition with the
  /// period 2. The ends are not rounded: a number x and the even number next to it are multiples of the last
  /// place of x or of 1, and so is their difference, which is at most 1. For numbers of 2^50 or more the
  /// result is [0, 1].
  friend Enclosure fold(const Enclosure& a) {
    const B one(1.0), first = rounding::floor(a.lower), last = rounding::floor(a.upper);
    const Truth is_straight = last <= first, rises = is_even(first);                // from `first` on
    const Truth rises_at_end = (is_straight && rises) || (!is_straight && !rises);  // with one kink inside
    const B at_lower = rounding::select(rises, a.lower - first, first + one - a.lower),
            at_upper = rounding::select(rises_at_end, a.upper - last, last + one - a.upper);
    const Truth has_two = first + one < last;
    const Enclosure folded{
        rounding::select(has_two || (!is_straight && !rises), B(0.0), rounding::min(at_lower, at_upper)),
        rounding::select(has_two || (!is_straight && rises), one, rounding::max(at_lower, at_upper))};
    return select(a.magnitude() < B(0x1p50), folded, Enclosure{B(0.0), one});
  }

  /// Returns the difference from the nearest integer, from −1/2 to 1/2, for repetition. The function jumps
  /// halfway between integers. The ends are not rounded; the result is [−1/2, 1/2] if the interval contains a
  /// jump, or numbers of 2^50 or more.
  friend Enclosure wrap(const Enclosure& a) {
    const B first = rounding::nearest_integer(a.lower), last = rounding::nearest_integer(a.upper);
    return select(!(first < last) && a.magnitude() < B(0x1p50), Enclosure{a.lower - first, a.upper - last},
                  Enclosure{B(-0.5), B(0.5)});
  }

  /// Returns the polynomial smooth minimum of Quilez, min(a, b) − max(k − |a − b|, 0)²/(4k), for k > 0. It
  /// increases with a and with b, so its ends are those at the ends of both: below, with the largest square
  /// that roundings allow, and above with the least. Infinite ends may give NaN for a − b, which counts as
  /// the 0 or ∞ that is on the safe side.
  friend Enclosure smooth_min(const Enclosure& a, const Enclosure& b, double k) {
    using rounding::above, rounding::below;
    constexpr double slack = rounding::underflow<B>;
    const B zero(0.0), width(k), divisor(4 * k);
    const B least = rounding::max(zero, below(rounding::abs(a.lower - b.lower))),
            most = above(rounding::abs(a.upper - b.upper));
    const B large = rounding::max(zero, above(width - least)),
            small = rounding::max(zero, below(width - most));
    const B most_cut = above(above(large * large, slack) / divisor, slack),
            least_cut =
                rounding::max(zero, below(rounding::max(zero, below(small * small, slack)) / divisor, slack));
    return {below(rounding::min(a.lower, b.lower) - most_cut),
            above(rounding::min(a.upper, b.upper) - least_cut)};
  }

  /// Returns the length of a vector.
  template <std::size_t n>
  friend Enclosure length_of(const Enclosure (&v)[n]) {
    Enclosure sum = square(v[0]);
    for (std::size_t i = 1; i < n; ++i) sum = sum + square(v[i]);
    return sqrt(sum);
  }

  /// Returns the signed distance of q from the octant (or quadrant) of the vectors without a positive
  /// component: |max(q, 0)| outside, and the largest component, which is negative, inside.
  template <std::size_t n>
  friend Enclosure signed_length_of(const Enclosure (&q)[n]) {
    Enclosure outside[n], largest = q[0];
    for (std::size_t i = 0; i < n; ++i) outside[i] = max(q[i], 0.0), largest = max(largest, q[i]);
    return length_of(outside) + min(largest, 0.0);
  }

  /// Returns the smallest interval that contains both.
  friend Enclosure hull(const Enclosure& a, const Enclosure& b) {
    return {rounding::min(a.lower, b.lower), rounding::max(a.upper, b.upper)};
  }

  /// Returns the numbers in both intervals, which are to be enclosures of one number, so that there are some.
  friend Enclosure common(const Enclosure& a, const Enclosure& b) {
    return {rounding::max(a.lower, b.lower), rounding::min(a.upper, b.upper)};
  }

  /// Returns a / length for numbers with |a| ≤ largest · length, which holds for the component a of a vector
  /// with that length and largest = 1. The result is in [−largest, largest], and has one sign if a has,
  /// even if the enclosure of the length begins at 0. Quotients of ends 0/0 and ∞/∞ are NaN, for which
  /// rounding::below and above return −∞ and ∞; the result then ends at 0 or at ±largest.
  friend Enclosure unit_component(const Enclosure& a, const Enclosure& length, const B& largest = B(1.0)) {
    const B zero(0.0), least = a.lower, most = a.upper;
    const auto over = [&](const B& end, Truth by_lower) {
      return end / or_zero(rounding::select(by_lower, length.lower, length.upper));
    };
    const B low = rounding::below(over(least, least < zero), rounding::underflow<B>);
    const B high = rounding::above(over(most, zero < most), rounding::underflow<B>);
    return {rounding::max(rounding::select(zero <= least, zero, -largest), low),
            rounding::min(rounding::select(most <= zero, zero, largest), high)};
  }

  /// Returns the part of a that is in [least, most]; the nearer end of it for what lies outside.
  friend Enclosure clamp(const Enclosure& a, double least, double most) {
    const auto one = [&](const B& x) { return rounding::min(rounding::max(x, B(least)), B(most)); };
    return {one(a.lower), one(a.upper)};
  }

  /// Returns a where the answer is true, and b elsewhere.
  friend Enclosure select(Truth so, const Enclosure& a, const Enclosure& b) {
    return {rounding::select(so, a.lower, b.lower), rounding::select(so, a.upper, b.upper)};
  }

 private:
  /// Tests whether it contains a number by which a quotient may have any error: 0, or a tiny one.
  [[nodiscard]] Truth may_be_tiny() const {
    constexpr double least = rounding::least_divisor<B>;
    return lower <= B(least) && B(-least) <= upper;
  }

  /// Returns a divisor ≥ 0, or 0 instead if it is so small that quotients have no bound of their underflow.
  static B or_zero(const B& divisor) {
    constexpr double least = rounding::least_divisor<B>;
    if constexpr (least == 0)
      return divisor;
    else
      return rounding::select(divisor < B(least), B(0.0), divisor);
  }

  /// Tests whether an integer is even.
  static Truth is_even(const B& x) {
    const B half = x * B(0.5);
    return half <= rounding::floor(half);
  }

  /// Returns 0 if x ≤ 0, and otherwise an upper bound of the exact result that was rounded to c: for squares
  /// and roots of x ≥ 0, which are 0 only for x = 0.
  static B above_unless_zero(const B& x, const B& c, double slack) {
    return rounding::select(x <= B(0.0), B(0.0), rounding::above(c, slack));
  }

  /// Returns the product or quotient of a and a number b, from those of the lower and upper end of a. For
  /// finite b ≠ 0 the sign of b tells which of them is the smaller.
  static Enclosure scaled(const Enclosure& a, double b, const B& first, const B& second) {
    if (!(b != 0 && std::abs(b) < infinity)) return spanned(a, b, first, first, second, second);
    const bool is_positive = b > 0;
    const B zero(0.0);
    const B least = rounding::below(is_positive ? first : second, rounding::underflow<B>);
    const B most = rounding::above(is_positive ? second : first, rounding::underflow<B>);
    const Truth may_be_negative = is_positive ? a.lower < zero : zero < a.upper;
    const Truth may_be_positive = is_positive ? zero < a.upper : a.lower < zero;
    return {rounding::select(may_be_negative, least, rounding::max(least, zero)),
            rounding::select(may_be_positive, most, rounding::min(most, zero))};
  }

  /// Returns the interval of the products or quotients of a and b, from those of their ends, p to s. Signs of
  /// the factors tell the sign of the result, which underflow does not change; an end that is exactly 0 stays
  /// so. If infinite ends make one of p to s NaN, or their sum, the result is all numbers.
  static Enclosure spanned(const Enclosure& a, const Enclosure& b, const B& p, const B& q, const B& r,
                           const B& s) {
    const B zero(0.0);
    const B least =
        rounding::below(rounding::min(rounding::min(p, q), rounding::min(r, s)), rounding::underflow<B>);
    const B most =
        rounding::above(rounding::max(rounding::max(p, q), rounding::max(r, s)), rounding::underflow<B>);
    const Truth may_be_negative = (a.lower < zero && zero < b.upper) || (zero < a.upper && b.lower < zero);
    const Truth may_be_positive = (a.lower < zero && b.lower < zero) || (zero < a.upper && zero < b.upper);
    const B sum = p + q + r + s;
    return select(sum <= B(infinity),  // false for NaN
                  Enclosure{rounding::select(may_be_negative, least, rounding::max(least, zero)),
                            rounding::select(may_be_positive, most, rounding::min(most, zero))},
                  whole());
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

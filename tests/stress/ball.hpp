// Ball arithmetic: numbers of 128 binary digits with an error bound, enough to judge nearly every case, and
// much faster than exact numbers. Nothing here comes from the library.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "exact.hpp"

namespace exact {

/// Number ± (digits ± error) · 2^exponent, whose highest of 128 digits is 1; or 0, exactly; or unknown.
///
/// Doubles are exact, and so are results of at most 128 digits. The error counts units of the last digit. If
/// it exceeds 2^56, as it may when two numbers nearly cancel, the number is unknown. Hence a known number has
/// a certain sign, and a relative error of at most 2^-71.
class Ball {
 public:
  Ball() = default;

  Ball(double value) {
    if (!std::isfinite(value)) throw std::domain_error("exact: a number that is not finite");
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const int field = static_cast<int>(bits >> 52) & 0x7ff;
    std::uint64_t significand = bits & ((std::uint64_t(1) << 52) - 1);
    if (field != 0) significand |= std::uint64_t(1) << 52;
    if (significand == 0) return;
    const int zeros = std::countl_zero(significand);
    negative_ = value < 0;
    digits_ = Uint128(significand << zeros) << 64;
    exponent_ = std::max(field, 1) - 1075 - zeros - 64;
  }

  [[nodiscard]] bool is_known() const { return error_ <= largest_error; }
  /// Returns the sign of a known number.
  [[nodiscard]] int sign() const { return digits_ == 0 ? 0 : negative_ ? -1 : 1; }

  friend Ball operator-(Ball a) {
    a.negative_ = !a.negative_;
    return a;
  }

  friend Ball operator+(const Ball& a, const Ball& b) {
    if (a.digits_ == 0) return b;
    if (b.digits_ == 0) return a;
    if (!a.is_known() || !b.is_known()) return unknown();
    const bool in_order = a.exponent_ != b.exponent_ ? a.exponent_ > b.exponent_ : a.digits_ >= b.digits_;
    const Ball& large = in_order ? a : b;
    const Ball& small = in_order ? b : a;

    // In units of the larger number's last digit. Less than one unit is cut off the smaller number, and less
    // than one off its error.
    const int shift = large.exponent_ - small.exponent_;
    const Uint128 moved = shift < 128 ? small.digits_ >> shift : 0;
    const bool is_cut = shift > 0 && (shift >= 128 || small.digits_ << (128 - shift) != 0);
    Ball sum = large;
    sum.error_ += (shift < 64 ? small.error_ >> shift : 0) + (shift > 0 && small.error_ > 0) + is_cut;

    if (a.negative_ == b.negative_) {
      sum.digits_ += moved;
      if (sum.digits_ < moved) {  // one digit more, so the last is cut off
        sum.error_ = (sum.error_ + 1) / 2 + (sum.digits_ & 1);
        sum.digits_ = sum.digits_ >> 1 | highest;
        ++sum.exponent_;
      }
      return sum.is_known() ? sum : unknown();
    }
    sum.digits_ -= moved;
    if (sum.digits_ == 0) return sum.error_ == 0 ? Ball() : unknown();
    const int zeros = leading_zeros(sum.digits_);
    if (sum.error_ > largest_error >> std::min(zeros, 63)) return unknown();
    sum.digits_ <<= zeros;
    sum.exponent_ -= zeros;
    sum.error_ = sum.error_ == 0 ? 0 : sum.error_ << zeros;
    return sum;
  }
  friend Ball operator-(const Ball& a, const Ball& b) { return a + -b; }

  friend Ball operator*(const Ball& a, const Ball& b) {
    if (a.digits_ == 0 || b.digits_ == 0) return {};
    if (!a.is_known() || !b.is_known()) return unknown();
    const auto low = [](Uint128 x) { return Uint128(static_cast<std::uint64_t>(x)); };
    const Uint128 a1 = a.digits_ >> 64, a0 = low(a.digits_), b1 = b.digits_ >> 64, b0 = low(b.digits_);
    const Uint128 outer = a1 * b0, inner = a0 * b1, last = a0 * b0;
    const Uint128 middle = (last >> 64) + low(outer) + low(inner);

    Ball product;
    product.negative_ = a.negative_ != b.negative_;
    product.exponent_ = a.exponent_ + b.exponent_ + 128;
    product.digits_ = a1 * b1 + (outer >> 64) + (inner >> 64) + (middle >> 64);
    Uint128 rest = middle << 64 | low(last);
    // (x ± e)(y ± f) is off by at most xf + ye + ef. With x, y < 2^128, and ef < 2^112, this is at most
    // e + f + 1 units of 2^128.
    product.error_ = a.error_ + b.error_ + (a.error_ + b.error_ > 0);
    if ((product.digits_ & highest) == 0) {
      product.digits_ = product.digits_ << 1 | rest >> 127;
      rest <<= 1;
      --product.exponent_;
      product.error_ *= 2;
    }
    product.error_ += rest != 0;
    return product.is_known() ? product : unknown();
  }

  /// Returns the value of a known number from its first 64 digits, with a relative error below 2^-62.
  explicit operator long double() const {
    const auto value = static_cast<long double>(static_cast<std::uint64_t>(digits_ >> 64));
    return std::ldexp(negative_ ? -value : value, exponent_ + 64);
  }

  /// Returns true if the exact number is within the error of this one, or this one is unknown.
  [[nodiscard]] bool may_be(const Number& exact) const {
    if (!is_known()) return true;
    const Number unit = power_of_two(exponent_), off = exact - whole(digits_) * (negative_ ? -unit : unit);
    return (square(off) - square(whole(error_) * unit)).sign() <= 0;
  }

 private:
  static constexpr std::uint64_t largest_error = std::uint64_t(1) << 56;
  static constexpr Uint128 highest = Uint128(1) << 127;

  static Ball unknown() {
    Ball ball;
    ball.digits_ = highest;
    ball.error_ = ~std::uint64_t(0);
    return ball;
  }

  static int leading_zeros(Uint128 x) {
    const auto high = static_cast<std::uint64_t>(x >> 64);
    return high != 0 ? std::countl_zero(high) : 64 + std::countl_zero(static_cast<std::uint64_t>(x));
  }

  static Number whole(Uint128 digits) {
    Number number;
    for (int shift = 96; shift >= 0; shift -= 32)
      number = number * 0x1p32 + static_cast<double>(static_cast<std::uint32_t>(digits >> shift));
    return number;
  }
  static Number power_of_two(int exponent) {
    Number power = 1.0;
    for (; exponent > 1000; exponent -= 1000) power = power * 0x1p1000;
    for (; exponent < -1000; exponent += 1000) power = power * 0x1p-1000;
    return power * std::ldexp(1.0, exponent);
  }

  bool negative_ = false;
  int exponent_ = 0;
  std::uint64_t error_ = 0;
  Uint128 digits_ = 0;
};

inline Ball square(const Ball& x) { return x * x; }

}  // namespace exact

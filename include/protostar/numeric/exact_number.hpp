// Numbers without rounding, for signs that no fixed precision decides, and vectors of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "../plain_vector.hpp"
#include "../vec3.hpp"
#include "double_double.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integer times a power of two, of any size: sums, differences and products of finite doubles are exact.
///
/// The integer is stored in digits of 32 bits, the lowest first, without zeros at either end, so that equal
/// numbers have equal digits. A sum of products of k doubles has at most 66 k digits, the range of double k
/// times, which bounds the work for a formula whatever its numbers are.
class ExactNumber {
 public:
  /// Constructs 0.
  ExactNumber() = default;

  /// Converts a finite double; others, which callers exclude, count as 0.
  ExactNumber(double value) : is_negative_(value < 0) {
    if (value == 0 || !std::isfinite(value)) return;
    int exponent = 0;
    const double fraction = std::frexp(std::abs(value), &exponent);  // in [1/2, 1)
    const auto bits = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    const int shift = (exponent - 53) & 31;  // 0 to 31, also for negative exponents
    const std::uint64_t low = bits << shift, high = shift == 0 ? 0 : bits >> (64 - shift);
    lowest_ = (exponent - 53 - shift) / 32;
    digits_.resize(3);
    digits_[0] = static_cast<std::uint32_t>(low), digits_[1] = static_cast<std::uint32_t>(low >> 32);
    digits_[2] = static_cast<std::uint32_t>(high);
    trim();
  }

  /// Returns 1, 0 or -1.
  [[nodiscard]] int sign() const { return digits_.empty() ? 0 : is_negative_ ? -1 : 1; }

  /// Number value · 2^exponent with an error of at most 2^-103 of itself; the exponent keeps value in the
  /// range of double.
  struct Approximation {
    DoubleDouble value;  ///< 0, or from 1 to 2^32 in magnitude
    int exponent = 0;

    /// Converts to double-double; infinite above the range of double, and less precise below 2^-1000.
    explicit operator DoubleDouble() const {
      const double high = std::ldexp(value.hi, exponent);
      return std::isinf(high) ? DoubleDouble(high) : DoubleDouble(high, std::ldexp(value.lo, exponent));
    }
  };

  /// Returns the leading five digits, which are at least 129 bits. Each addition has an error of at most 3u²
  /// of its sum, and the partial sums together are less than twice the whole: 6u² in all.
  [[nodiscard]] Approximation approximation() const {
    if (digits_.empty()) return {};
    DoubleDouble sum;
    const std::size_t last = digits_.size() - 1, first = last - std::min<std::size_t>(last, 4);
    double unit = std::ldexp(1.0, -32 * static_cast<int>(last - first));
    for (std::size_t i = first; i <= last; ++i, unit *= 0x1p32) sum = DoubleDouble(digits_[i] * unit) + sum;
    return {is_negative_ ? -sum : sum, 32 * (lowest_ + static_cast<int>(last))};
  }

  /// Converts to double-double with an error of at most 2^-103 of the number; infinite above the range of
  /// double, and less precise below 2^-1000.
  explicit operator DoubleDouble() const { return DoubleDouble(approximation()); }

  friend ExactNumber operator-(ExactNumber a) {
    a.is_negative_ = !a.is_negative_;
    return a;
  }
  friend ExactNumber operator+(const ExactNumber& a, const ExactNumber& b) {
    return sum(a, b, b.is_negative_);
  }
  friend ExactNumber operator-(const ExactNumber& a, const ExactNumber& b) {
    return sum(a, b, !b.is_negative_);
  }
  ExactNumber& operator+=(const ExactNumber& b) { return *this = *this + b; }

  friend ExactNumber operator*(const ExactNumber& a, const ExactNumber& b) {
    ExactNumber product;
    if (a.digits_.empty() || b.digits_.empty()) return product;
    product.is_negative_ = a.is_negative_ != b.is_negative_;
    product.lowest_ = a.lowest_ + b.lowest_;
    product.digits_.resize(a.digits_.size() + b.digits_.size(), 0);
    for (std::size_t i = 0; i < a.digits_.size(); ++i) {
      // A product of two digits plus two more digits is less than 2^64.
      const std::uint64_t digit = a.digits_[i];
      std::uint64_t carry = 0;
      std::uint32_t* to = &product.digits_[i];
      for (const std::uint32_t other : b.digits_) {
        carry += digit * other + *to;
        *to++ = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
      *to = static_cast<std::uint32_t>(carry);
    }
    product.trim();
    return product;
  }

  friend bool operator==(const ExactNumber& a, const ExactNumber& b) {
    return a.sign() == b.sign() && (a.sign() == 0 || a.lowest_ == b.lowest_) && a.digits_ == b.digits_;
  }

 private:
  /// Returns one past the place of the highest digit.
  [[nodiscard]] int end() const { return lowest_ + static_cast<int>(digits_.size()); }

  /// Returns the digit at a place, or 0 if there is none.
  [[nodiscard]] std::uint32_t digit(int place) const {
    return place < lowest_ || place >= end() ? 0 : digits_[static_cast<std::size_t>(place - lowest_)];
  }

  /// Removes zeros at both ends.
  void trim() {
    std::size_t first = 0, end = digits_.size();
    while (end > 0 && digits_[end - 1] == 0) --end;
    while (first < end && digits_[first] == 0) ++first;
    if (first > 0)
      for (std::size_t i = first; i < end; ++i) digits_[i - first] = digits_[i];
    digits_.resize(end - first);
    lowest_ += static_cast<int>(first);
  }

  /// Returns a + b, where b is taken with the given sign.
  [[nodiscard]] static ExactNumber sum(const ExactNumber& a, const ExactNumber& b, bool b_is_negative) {
    if (b.digits_.empty()) return a;
    ExactNumber result;
    result.is_negative_ = a.is_negative_;
    result.lowest_ = std::min(a.lowest_, b.lowest_);
    const int end = std::max(a.end(), b.end());
    result.digits_.resize(static_cast<std::size_t>(end - result.lowest_) + 1);
    std::uint32_t* to = result.digits_.data();
    const bool subtracts = a.is_negative_ != b_is_negative;
    std::int64_t carry = 0;  // the sum at a place lies between -2^32 and 2^33
    for (int place = result.lowest_; place < end; ++place) {
      const std::int64_t other = b.digit(place);
      carry += a.digit(place) + (subtracts ? -other : other);
      *to++ = static_cast<std::uint32_t>(carry & 0xffffffff);
      carry >>= 32;
    }
    *to = static_cast<std::uint32_t>(carry);
    if (carry < 0) result.negate_digits();
    result.trim();
    return result;
  }

  /// Turns digits that are those of a negative number in two's complement into those of its magnitude.
  void negate_digits() {
    is_negative_ = !is_negative_;
    bool carries = true;
    for (std::uint32_t& digit : digits_) digit = ~digit + carries, carries = carries && digit == 0;
  }

  PlainVector<std::uint32_t> digits_;  ///< the lowest first, without zeros at either end
  int lowest_ = 0;                     ///< the lowest digit counts 2^(32 · lowest_)
  bool is_negative_ = false;
};

/// Vector without rounding.
using ExactVector = std::array<ExactNumber, 3>;

[[nodiscard]] inline ExactVector exact_vector(const Vec3& v) { return {v.x, v.y, v.z}; }

[[nodiscard]] inline ExactVector operator+(const ExactVector& a, const ExactVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[nodiscard]] inline ExactVector operator-(const ExactVector& a, const ExactVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline ExactVector operator*(const ExactNumber& factor, const ExactVector& v) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}
[[nodiscard]] inline ExactNumber dot(const ExactVector& a, const ExactVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline ExactVector exact_difference(const Vec3& a, const Vec3& b) {
  return exact_vector(a) - exact_vector(b);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Exact numbers as a reference for the library. Nothing here comes from the library.
//
// Every double is a whole number times a power of two, so sums, differences and products of doubles are
// numbers of finitely many digits; here of base 2^64. Only a quotient or a root has to be rounded, to the 113
// bits of Quad.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace exact {

#if __LDBL_MANT_DIG__ == 113
using Quad = long double;
#else
__extension__ using Quad = __float128;  // g++ and clang on x86-64
#endif
__extension__ using Uint128 = unsigned __int128;

/// Returns factor · 2^(64 n).
inline Quad times_digits(Quad factor, int n) {
  Quad base = n < 0 ? Quad(0x1p-64) : Quad(0x1p64);
  for (unsigned left = static_cast<unsigned>(std::abs(n)); left > 0; left >>= 1, base *= base)
    if (left & 1) factor *= base;
  return factor;
}

/// Number ± (digits[0] + digits[1] · 2^64 + …) · 2^(64 exponent); neither the first nor the last digit is 0.
class Number {
 public:
  Number() = default;

  Number(double value) {
    if (!std::isfinite(value)) throw std::domain_error("exact: a number that is not finite");
    if (value == 0) return;
    negative_ = value < 0;
    int e = 0;
    const double mantissa =
        std::frexp(std::abs(value), &e);  // value = mantissa · 2^e, 53 bits behind the point
    e -= 53;
    exponent_ = e >= 0 ? e / 64 : -((63 - e) / 64);
    const Uint128 bits = Uint128(static_cast<std::uint64_t>(std::ldexp(mantissa, 53)))
                         << (e - 64 * exponent_);
    digits_[0] = static_cast<std::uint64_t>(bits);
    digits_[1] = static_cast<std::uint64_t>(bits >> 64);
    size_ = 2;
    trim();
  }

  Number(const Number& other) { *this = other; }
  Number& operator=(const Number& other) {
    negative_ = other.negative_, exponent_ = other.exponent_, size_ = other.size_;
    std::copy_n(other.digits_, size_, digits_);
    return *this;
  }

  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : negative_ ? -1 : 1; }

  friend Number operator-(Number a) {
    a.negative_ = !a.negative_;
    return a;
  }
  friend Number operator+(const Number& a, const Number& b) {
    if (a.size_ == 0) return b;
    if (b.size_ == 0) return a;
    if (a.negative_ == b.negative_) return sum_of_sizes(a, b);
    const int larger = compare_sizes(a, b);
    return larger == 0 ? Number() : larger > 0 ? difference_of_sizes(a, b) : difference_of_sizes(b, a);
  }
  friend Number operator-(const Number& a, const Number& b) { return a + -b; }

  friend Number operator*(const Number& a, const Number& b) {
    Number product;
    if (a.size_ == 0 || b.size_ == 0) return product;
    product.negative_ = a.negative_ != b.negative_;
    product.exponent_ = a.exponent_ + b.exponent_;
    product.clear(a.size_ + b.size_);
    for (int i = 0; i < a.size_; ++i) {
      std::uint64_t carry = 0;
      for (int j = 0; j < b.size_; ++j) {
        const Uint128 sum = Uint128(a.digits_[i]) * b.digits_[j] + product.digits_[i + j] + carry;
        product.digits_[i + j] = static_cast<std::uint64_t>(sum);
        carry = static_cast<std::uint64_t>(sum >> 64);
      }
      product.digits_[i + b.size_] = carry;
    }
    product.trim();
    return product;
  }

  /// Returns the value to 2^-111: three digits hold at least 129 bits.
  explicit operator Quad() const { return times_digits(leading(), exponent_ + dropped()); }

  /// Returns the square root of a number that is not negative, to 2^-110.
  [[nodiscard]] Quad sqrt() const {
    if (sign() < 0) throw std::domain_error("exact: the root of a negative number");
    if (sign() == 0) return 0;
    Quad value = leading();
    int n = exponent_ + dropped();
    if (n % 2 != 0) value *= Quad(0x1p64), --n;
    Quad root = std::sqrt(static_cast<double>(value));
    for (int step = 0; step < 2; ++step) root = (root + value / root) / 2;
    return times_digits(root, n / 2);
  }

 private:
  static constexpr int capacity = 160;

  void clear(int size) {
    if (size > capacity) throw std::length_error("exact: a number with too many digits");
    size_ = size;
    std::fill_n(digits_, size, 0);
  }

  void trim() {
    while (size_ > 0 && digits_[size_ - 1] == 0) --size_;
    int zeros = 0;
    while (zeros < size_ && digits_[zeros] == 0) ++zeros;
    if (zeros == 0) return;
    std::copy(digits_ + zeros, digits_ + size_, digits_);
    size_ -= zeros;
    exponent_ += zeros;
  }

  /// Returns the digit that counts units of 2^(64 place).
  [[nodiscard]] std::uint64_t digit(int place) const {
    const int i = place - exponent_;
    return i >= 0 && i < size_ ? digits_[i] : 0;
  }
  [[nodiscard]] int end() const { return exponent_ + size_; }

  [[nodiscard]] int dropped() const { return std::max(0, size_ - 3); }
  [[nodiscard]] Quad leading() const {
    Quad value = 0;
    for (int i = size_ - 1; i >= dropped(); --i) value = value * Quad(0x1p64) + Quad(digits_[i]);
    return negative_ ? -value : value;
  }

  static int compare_sizes(const Number& a, const Number& b) {
    for (int place = std::max(a.end(), b.end()) - 1; place >= std::min(a.exponent_, b.exponent_); --place)
      if (a.digit(place) != b.digit(place)) return a.digit(place) > b.digit(place) ? 1 : -1;
    return 0;
  }

  static Number sum_of_sizes(const Number& a, const Number& b) {
    Number sum;
    sum.negative_ = a.negative_;
    sum.exponent_ = std::min(a.exponent_, b.exponent_);
    sum.clear(std::max(a.end(), b.end()) - sum.exponent_ + 1);
    std::uint64_t carry = 0;
    for (int i = 0; i < sum.size_; ++i) {
      const Uint128 s = Uint128(a.digit(sum.exponent_ + i)) + b.digit(sum.exponent_ + i) + carry;
      sum.digits_[i] = static_cast<std::uint64_t>(s);
      carry = static_cast<std::uint64_t>(s >> 64);
    }
    sum.trim();
    return sum;
  }

  static Number difference_of_sizes(const Number& larger, const Number& smaller) {
    Number difference;
    difference.negative_ = larger.negative_;
    difference.exponent_ = std::min(larger.exponent_, smaller.exponent_);
    difference.clear(larger.end() - difference.exponent_);
    std::uint64_t borrow = 0;
    for (int i = 0; i < difference.size_; ++i) {
      const std::uint64_t x = larger.digit(difference.exponent_ + i);
      const Uint128 y = Uint128(smaller.digit(difference.exponent_ + i)) + borrow;
      difference.digits_[i] = static_cast<std::uint64_t>(x - y);
      borrow = x < y ? 1 : 0;
    }
    difference.trim();
    return difference;
  }

  bool negative_ = false;
  int exponent_ = 0;
  int size_ = 0;
  std::uint64_t digits_[capacity];
};

inline Number square(const Number& x) { return x * x; }

/// Returns the sign of a + i √x + k √y, where i and k are -1, 0 or 1 and x, y ≥ 0; decided without a root, by
/// squaring only terms of known sign.
inline int sign_of_sum(const Number& a, int i, const Number& x, int k, const Number& y) {
  if (x.sign() == 0) i = 0;
  if (y.sign() == 0) k = 0;
  const int roots = i == 0 || k == 0 || i == k ? (i != 0 ? i : k) : i * (x - y).sign();
  if (roots == 0 || a.sign() == 0 || a.sign() == roots) return a.sign() != 0 ? a.sign() : roots;
  // Both parts have opposite signs, so the larger of a² and x + y + 2ik √(xy) decides.
  if (i == 0 || k == 0) return a.sign() * (square(a) - (i != 0 ? x : y)).sign();
  const Number rest = square(a) - x - y, twice = Number(4) * x * y;  // compared with 2ik √(xy)
  const int wanted = i * k;
  const int larger = rest.sign() * wanted <= 0 ? (rest.sign() != 0 ? rest.sign() : -wanted)
                                               : wanted * (square(rest) - twice).sign();
  return a.sign() * larger;
}

}  // namespace exact

// Numbers without rounding, for the sign that no fixed precision decides.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "double_double.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// An exact sum of doubles that do not overlap, from the smallest to the largest, none of them 0: its sign is
/// that of the last one. Sums, differences and products are exact unless a term overflows or falls below
/// 2^-1074. Source: Shewchuk, "Adaptive Precision Floating-Point Arithmetic", 1997 (grow-expansion,
/// scale-expansion).
class Expansion {
 public:
  Expansion() = default;
  Expansion(double value) {
    if (value != 0) terms_.push_back(value);
  }

  [[nodiscard]] int sign() const { return terms_.empty() ? 0 : terms_.back() > 0 ? 1 : -1; }

  /// The sum in double-double, to 2^-103. Each addition is good to 3u² of its sum; the terms are not even
  /// adjacent, so that the smaller partial sums together are no larger than the whole: 6u² in all.
  [[gnu::cold, gnu::noinline]] explicit operator DoubleDouble() const {
    DoubleDouble sum;
    for (const double term : terms_) sum = DoubleDouble(term) + sum;
    return sum;
  }

  [[gnu::cold, gnu::noinline]] Expansion& operator+=(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      const DoubleDouble sum = two_sum(value, terms_[i]);
      if (sum.lo != 0) terms_[kept++] = sum.lo;  // never behind i: each term leaves at most one
      value = sum.hi;
    }
    terms_.resize(kept);
    if (value != 0) terms_.push_back(value);
    return *this;
  }

  [[gnu::cold, gnu::noinline]] friend Expansion operator+(Expansion a, const Expansion& b) {
    for (const double term : b.terms_) a += term;
    return a;
  }

  [[gnu::cold, gnu::noinline]] friend Expansion operator-(Expansion a) {
    for (double& term : a.terms_) term = -term;
    return a;
  }

  [[gnu::cold, gnu::noinline]] friend Expansion operator-(Expansion a, const Expansion& b) {
    for (const double term : b.terms_) a += -term;
    return a;
  }

  [[gnu::cold, gnu::noinline]] friend Expansion operator*(const Expansion& a, const Expansion& b) {
    Expansion product;
    for (const double x : a.terms_)
      for (const double y : b.terms_) {
        const DoubleDouble xy = two_product(x, y);
        product += xy.lo;
        product += xy.hi;
      }
    product.compress();
    return product;
  }

  /// Multiplies by 2^exponent; what falls below 2^-1074 is lost.
  [[gnu::cold, gnu::noinline]] void scale(int exponent) {
    for (double& term : terms_) term = std::ldexp(term, exponent);
    std::erase(terms_, 0.0);
  }

  [[gnu::cold, gnu::noinline]] friend bool operator==(const Expansion& a, const Expansion& b) {
    return (a - b).sign() == 0;
  }

 private:
  /// Puts the same sum into as few terms as carry its bits (Shewchuk, compress): downwards, each term takes
  /// up what fits of the next, and upwards again.
  [[gnu::cold, gnu::noinline]] void compress() {
    if (terms_.size() < 2) return;
    std::vector<double> down;
    double carry = terms_.back();
    for (std::size_t i = terms_.size() - 1; i-- > 0;) {
      const DoubleDouble sum = fast_two_sum(carry, terms_[i]);
      carry = sum.hi;
      if (sum.lo == 0) continue;
      down.push_back(carry);
      carry = sum.lo;
    }
    terms_.clear();
    for (std::size_t i = down.size(); i-- > 0;) {
      const DoubleDouble sum = fast_two_sum(down[i], carry);
      if (sum.lo != 0) terms_.push_back(sum.lo);
      carry = sum.hi;
    }
    terms_.push_back(carry);
  }

  std::vector<double> terms_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

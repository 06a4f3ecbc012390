// Numbers known to lie within a radius of a double: arithmetic that carries its own error bound.
//
// u = 2^-53. The result of an operation contains all results for numbers that its operands contain: the
// double result is rounded by at most u of itself, and the radii are carried through. The sum of the parts of
// a radius is rounded by less than 2^-50 of itself, as all of them are positive.
#pragma once

#include <cmath>
#include <optional>

#include "../platform.hpp"
#include "exact_number.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Set of all numbers within radius of middle. If an operation overflows, the radius is infinite or NaN, and
/// the number has no sign.
struct RoundedNumber {
  double middle = 0, radius = 0;

  RoundedNumber() = default;
  RoundedNumber(double value) : middle(value) {}
  RoundedNumber(double center, double error) : middle(center), radius(error) {}

  [[gnu::always_inline]] friend RoundedNumber operator-(const RoundedNumber& a) {
    return {-a.middle, a.radius};
  }
  [[gnu::always_inline]] friend RoundedNumber operator+(const RoundedNumber& a, const RoundedNumber& b) {
    return rounded(a.middle + b.middle, a.radius + b.radius);
  }
  [[gnu::always_inline]] friend RoundedNumber operator-(const RoundedNumber& a, const RoundedNumber& b) {
    return rounded(a.middle - b.middle, a.radius + b.radius);
  }
  [[gnu::always_inline]] friend RoundedNumber operator*(const RoundedNumber& a, const RoundedNumber& b) {
    return rounded(a.middle * b.middle,
                   std::abs(a.middle) * b.radius + a.radius * (std::abs(b.middle) + b.radius) + underflow);
  }

  // Operations with an exact number.
  [[gnu::always_inline]] friend RoundedNumber operator-(double a, const RoundedNumber& b) {
    return rounded(a - b.middle, b.radius);
  }
  [[gnu::always_inline]] friend RoundedNumber operator-(const RoundedNumber& a, double b) {
    return rounded(a.middle - b, a.radius);
  }
  [[gnu::always_inline]] friend RoundedNumber operator+(const RoundedNumber& a, double b) {
    return rounded(a.middle + b, a.radius);
  }
  [[gnu::always_inline]] friend RoundedNumber operator*(double a, const RoundedNumber& b) {
    return rounded(a * b.middle, std::abs(a) * b.radius + underflow);
  }

  /// Returns a/b, where b has a sign: a'/b' − a/b = (a' − a)/b' + (a/b) (b − b')/b' for all a' and b' that
  /// they contain.
  friend RoundedNumber operator/(const RoundedNumber& a, const RoundedNumber& b) {
    const double quotient = a.middle / b.middle, least = std::abs(b.middle) - b.radius;
    return rounded(quotient, (a.radius + std::abs(quotient) * b.radius) / least + underflow);
  }

  /// Returns √a for a > 0, using |√a' − √a| = |a' − a|/(√a' + √a).
  friend RoundedNumber sqrt(const RoundedNumber& a) {
    const double root = std::sqrt(a.middle);
    return rounded(root, a.radius / root);
  }

  /// Returns true if the quotient of each contained number and middle is within 2^-31 of 1, or if the number
  /// is 0.
  [[nodiscard]] bool is_certain() const {
    return radius <= 0x1p-31 * std::abs(middle) && std::abs(middle) <= 0x1p1023;
  }

 private:
  /// Upper bound for the total loss of the few products whose results are below 2^-1022: 2^-1075 each.
  static constexpr double underflow = 0x1p-1072;

  [[nodiscard, gnu::always_inline]] static RoundedNumber rounded(double middle, double radius) {
    return {middle, (radius + 0x1p-53 * std::abs(middle)) * (1 + 0x1p-49)};
  }
};

/// Returns 1, 0 or -1 if all contained numbers have this sign, else empty.
[[nodiscard]] inline std::optional<int> sign_of(const RoundedNumber& a) {
  if (a.middle > a.radius) return 1;
  if (a.middle < -a.radius) return -1;
  if (a.middle == 0 && a.radius == 0) return 0;
  return std::nullopt;
}
[[nodiscard]] inline std::optional<int> sign_of(const ExactNumber& a) { return a.sign(); }

}  // namespace protostar::inline PROTOSTAR_ABI

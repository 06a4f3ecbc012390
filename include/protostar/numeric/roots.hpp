// Crossings of a line with a surface, as roots of its equation, and their accuracy.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "../interval.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// At most two crossings of a line with a surface, near ≤ far; if the line touches it, both are equal. The
/// library's surfaces give certified roots: which of them exist is exact, and each t has the sign of the true
/// root, is 0 only if the true root is, and is within 2^-30 |t| of it, as far as the range of double allows.
class Roots {
 public:
  static constexpr double relative_error = 0x1p-30;

  constexpr Roots() = default;
  constexpr explicit Roots(double t) : t_{t, t}, count_(1) {}
  constexpr Roots(double first, double second) : t_{first, second}, count_(2) {}

  [[nodiscard]] constexpr int count() const { return count_; }
  [[nodiscard]] constexpr double operator[](int i) const { return t_[i]; }
  [[nodiscard]] constexpr const double* begin() const { return t_; }
  [[nodiscard]] constexpr const double* end() const { return t_ + count_; }

  /// Returns the first root inside an interval, by the values of t without their errors.
  [[nodiscard]] constexpr std::optional<double> first_in(Interval range) const {
    for (const double t : *this)
      if (range.contains(t)) return t;
    return std::nullopt;
  }

 private:
  double t_[2] = {0, 0};
  int count_ = 0;
};

/// Returns the roots of A t² − 2 b t + c = 0, given q = b ± √(b² − A c) without cancellation: one is q/A, and
/// the other c/q, since their product is c/A.
[[nodiscard]] inline Roots roots_from(double A, double c, double q) {
  const double t1 = c / q, t2 = q / A;
  return t1 < t2 ? Roots{t1, t2} : Roots{t2, t1};
}

/// Returns the roots of A t² − 2 b t + c = 0 with A ≠ 0 (A.1.1, the simplified form), given the discriminant
/// D = b² − A c, for surfaces content with the accuracy of double. None if D < 0 or a number is NaN.
[[nodiscard]] inline Roots quadratic_roots(double A, double b, double c, double D) {
  if (!(D >= 0)) return {};
  const double q = b + std::copysign(std::sqrt(D), b);
  if (q == 0) return {0, 0};  // b = 0 and D = 0, so c = 0 too: the line touches at its origin
  return roots_from(A, c, q);
}

/// Returns an upper bound for any root that may precede one given as t: each has an error of 2^-30 of itself
/// or, if that vanishes, of less than the smallest double.
[[nodiscard]] inline double upper_bound_of(double t) {
  return t + (4 * Roots::relative_error * std::abs(t) + std::numeric_limits<double>::denorm_min());
}

/// Number of decisions that double could not make, in this thread, since it was last set to {}.
struct Fallbacks {
  std::uint64_t exact = 0;          ///< decided without rounding
  std::uint64_t double_double = 0;  ///< decided in double-double
  /// Left open by double-double, for surfaces whose roots are enclosed, marched ones and tori: a ray that
  /// touches one, which is taken for a hit, and crossings that are equal to the last digit, which are taken
  /// in the order of the scene.
  std::uint64_t undecided = 0;
};
inline thread_local Fallbacks fallbacks;

}  // namespace protostar::inline PROTOSTAR_ABI

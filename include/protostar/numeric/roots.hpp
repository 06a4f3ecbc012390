// The crossings of a line with a surface, as roots of its equation.
#pragma once

#include <cmath>
#include <optional>

#include "../interval.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// At most two crossings of a line with a surface: near ≤ far; where the line touches, both are the same. A
/// range for loops.
class Roots {
 public:
  constexpr Roots() = default;
  constexpr explicit Roots(double t) : t_{t, t}, count_(1) {}
  constexpr Roots(double near, double far) : t_{near, far}, count_(2) {}

  [[nodiscard]] constexpr const double* begin() const { return t_; }
  [[nodiscard]] constexpr const double* end() const { return t_ + count_; }

  /// The first that lies inside an interval.
  [[nodiscard]] constexpr std::optional<double> first_in(Interval range) const {
    for (const double t : *this)
      if (range.contains(t)) return t;
    return std::nullopt;
  }

 private:
  double t_[2] = {0, 0};
  int count_ = 0;
};

/// The roots of A t² − 2 b t + c = 0 (A.1.1, the simplified form), given its discriminant D = b² − A c, which
/// the caller often knows without the cancellation of that difference. None where D < 0 or a number is NaN.
///
/// b ± √D cancels for one of the signs. The other gives q and the root q/A, and c/q is the second, since the
/// product of the roots is c/A.
[[nodiscard]] inline Roots quadratic_roots(double A, double b, double c, double D) {
  if (!(D >= 0)) return {};
  const double q = b + std::copysign(std::sqrt(D), b);
  if (q == 0) return {0, 0};  // b = 0 and D = 0, so c = 0 too: the line touches at its origin
  const double t1 = c / q, t2 = q / A;
  return t1 < t2 ? Roots{t1, t2} : Roots{t2, t1};
}

}  // namespace protostar::inline PROTOSTAR_ABI

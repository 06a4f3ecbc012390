// The crossings of a line with a surface, as roots of its equation, and how sure they are.
#pragma once

#include <cmath>
#include <cstdint>

#include "../interval.hpp"
#include "double_double.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// At most two crossings of a line with a surface: near ≤ far; where the line touches, both are the same.
/// Which of them exist is exact. Each t has the sign of the true root, is 0 only where that is 0, and is
/// within 2^-30 |t| of it.
class Roots {
 public:
  static constexpr double relative_error = 0x1p-30;

  constexpr Roots() = default;
  constexpr explicit Roots(double t) : t_{t, t}, count_(1) {}
  constexpr Roots(double near, double far) : t_{near, far}, count_(2) {}

  [[nodiscard]] constexpr int count() const { return count_; }
  [[nodiscard]] constexpr double operator[](int i) const { return t_[i]; }
  [[nodiscard]] constexpr const double* begin() const { return t_; }
  [[nodiscard]] constexpr const double* end() const { return t_ + count_; }

 private:
  double t_[2] = {0, 0};
  int count_ = 0;
};

/// How a root is worked out when double does not decide: in double-double, or from exact coefficients.
enum class Precision : std::uint8_t { double_double, exact };

/// The same roots, in double-double, each with a relative error of at most relative_error. At
/// Precision::exact that is at most 2^-97; at Precision::double_double it depends on the ray, and infinity
/// says that nothing could be decided.
struct RefinedRoots {
  DoubleDouble t[2];
  int count = 0;
  double relative_error = infinity;
};

/// How often double did not decide, in this thread, since it was last set to {}.
struct Fallbacks {
  std::uint64_t double_double = 0;  ///< roots worked out in double-double
  std::uint64_t exact = 0;          ///< of those, worked out again from exact coefficients
};
inline thread_local Fallbacks fallbacks;

/// The sign of a − b for two roots with these relative errors, or 0 if they are too near to each other to
/// tell.
[[nodiscard]] inline int order(DoubleDouble a, double a_error, DoubleDouble b, double b_error) {
  const DoubleDouble difference = a - b;
  const double uncertain = std::abs(a.hi) * a_error + std::abs(b.hi) * b_error;
  // The factor covers the roundings of this line and of the difference, 3u² of it, where the errors are
  // larger.
  return std::abs(difference.hi) > 1.5 * uncertain ? difference.sign() : 0;
}

}  // namespace protostar::inline PROTOSTAR_ABI

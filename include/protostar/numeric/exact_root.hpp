// Roots of equations without rounding, their exact order, and their values in double-double.
#pragma once

#include <algorithm>
#include <cmath>

#include "exact_number.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Root (b + sign·√D) / A, with A > 0, D ≥ 0 and a sign of 1 or -1, of a quadratic equation or, with D = 0,
/// of a linear one. A root that no formula gives, as of a surface that is marched, is only enclosed: it is
/// off that number by at most `error`.
struct ExactRoot {
  ExactNumber A, b, D;
  int sign = 1;
  ExactNumber error{};  ///< at least 0
};

/// Returns a double as an exact root.
[[nodiscard]] inline ExactRoot exact_root_of(double t) { return {.A = 1.0, .b = t, .D = {}}; }

/// Returns a root that lies between a and b ≥ a: their middle, off by at most half of b − a. The middle is
/// rounded by 3u² = 3 · 2^-106 of itself, for which 2^-103 of it is added; 2^-40 of the width is more than
/// the roundings of the width and of the error.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_root_between(const DoubleDouble& a,
                                                                            const DoubleDouble& b) {
  const DoubleDouble width = b - a, middle = a + DoubleDouble(0.5) * width;
  return {.A = 1.0,
          .b = ExactNumber(middle.hi) + ExactNumber(middle.lo),
          .D = {},
          .error = width.hi * (0.5 + 0x1p-40) + 0x1p-103 * std::abs(middle.hi)};
}

namespace detail {

/// Returns the sign of P + x√X + y√Y for x and y of 1 or -1, and X, Y ≥ 0.
[[nodiscard, gnu::cold, gnu::noinline]] inline int sign_of_sum(const ExactNumber& P, int x,
                                                               const ExactNumber& X, int y,
                                                               const ExactNumber& Y) {
  const int p = P.sign();
  const int u = x == y ? ((X + Y).sign() != 0 ? x : 0) : x * (X - Y).sign();  // sign of U = x√X + y√Y
  if (u == 0 || u == p) return p;
  if (p == 0) return u;
  // P and U have opposite signs, and the larger square wins. U² − P² = R + 2xy √(XY) with R = X + Y − P²; if
  // these two terms have opposite signs as well, again the larger square wins.
  const ExactNumber R = X + Y - P * P, XY = X * Y;
  const int r = R.sign(), v = x * y * XY.sign();
  int wins = r == 0 ? v : r;
  if (r * v < 0) wins = r * (R * R - ExactNumber(4) * XY).sign();
  return wins > 0 ? u : wins < 0 ? p : 0;
}

/// Returns the sign of r + shift − s, whatever the errors of both are.
[[nodiscard, gnu::cold, gnu::noinline]] inline int sign_of_difference(const ExactRoot& r,
                                                                      const ExactNumber& shift,
                                                                      const ExactRoot& s) {
  const ExactNumber b = shift.sign() == 0 ? r.b : r.b + r.A * shift;
  // Roots along one ray mostly have the same A = d·d; then the difference is multiplied by A > 0.
  if (r.A == s.A) return sign_of_sum(b - s.b, r.sign, r.D, -s.sign, s.D);
  // Otherwise, the difference is multiplied by both A.
  return sign_of_sum(b * s.A - s.b * r.A, r.sign, r.D * s.A * s.A, -s.sign, s.D * r.A * r.A);
}

}  // namespace detail

/// Returns the sign of r − s. If the errors of enclosed roots leave it open, it is 0, as for equal roots, and
/// fallbacks.undecided counts it.
[[nodiscard, gnu::cold, gnu::noinline]] inline int order(const ExactRoot& r, const ExactRoot& s) {
  const ExactNumber error = r.error + s.error;
  const int sign = detail::sign_of_difference(r, -error, s);
  if (error.sign() == 0 || sign == detail::sign_of_difference(r, error, s)) return sign;
  ++fallbacks.undecided;
  return 0;
}

/// Returns a root in double-double, with an error of at most 2^-97 of itself, besides that of an enclosed
/// root; infinite above the range of double, and less precise below 2^-1000.
///
/// If b and sign·√D have different signs, (b + sign·√D) (b − sign·√D) = b² − D avoids cancellation.
/// Approximations have an error of 2^-103; √D has half of it and 4u², a sum of two numbers of one sign 3u²
/// more, a product 5u² and a quotient 10u².
[[nodiscard, gnu::cold, gnu::noinline]] inline DoubleDouble refined(const ExactRoot& root) {
  using Approximation = ExactNumber::Approximation;
  const auto quotient = [](const Approximation& a, const Approximation& b) {
    return Approximation{a.value / b.value, a.exponent - b.exponent};
  };
  const Approximation A = root.A.approximation();
  if (root.D.sign() == 0) return DoubleDouble(quotient(root.b.approximation(), A));

  const Approximation D = root.D.approximation(), b = root.b.approximation();
  Approximation q{sqrt(D.value), D.exponent / 2};  // exponents are even; in the end q = b ± √D, of one sign
  const int b_sign = root.b.sign();
  if (b_sign < 0) q.value = -q.value;
  if (b_sign != 0) {
    // If the exponents differ by more than 1000, the sum is as good as the larger number.
    const int exponent = std::max(b.exponent, q.exponent);
    const auto moved = [&](const Approximation& x) {
      return DoubleDouble(Approximation{x.value, x.exponent - exponent});
    };
    q = {moved(b) + moved(q), exponent};
  } else if (root.sign < 0) {
    q.value = -q.value;
  }
  if (b_sign == 0 || b_sign == root.sign) return DoubleDouble(quotient(q, A));
  const ExactNumber numerator = root.b * root.b - root.D;
  if (numerator.sign() == 0) return {};
  return DoubleDouble(quotient(quotient(numerator.approximation(), q), A));
}

}  // namespace protostar::inline PROTOSTAR_ABI

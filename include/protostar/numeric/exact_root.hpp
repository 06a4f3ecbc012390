// Roots as they are, without rounding, and their exact order.
#pragma once

#include <cmath>

#include "expansion.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The number 2^exponent · (b + sign·√D) / A with A > 0, D ≥ 0 and a sign of 1 or -1: a root of a quadratic
/// or, with D = 0, of a linear equation.
struct ExactRoot {
  Expansion A, b, D;
  int sign = 1;
  int exponent = 0;
};

/// A double as such a number.
[[nodiscard]] inline ExactRoot exact_root_of(double t) { return {.A = 1.0, .b = t, .D = {}}; }

namespace detail {

/// The sign of P + x√X + y√Y for x and y of 1 or -1, and X, Y ≥ 0.
[[nodiscard, gnu::cold, gnu::noinline]] inline int sign_of_sum(const Expansion& P, int x, const Expansion& X,
                                                               int y, const Expansion& Y) {
  const int p = P.sign();
  const int u = x == y ? ((X + Y).sign() != 0 ? x : 0) : x * (X - Y).sign();  // of U = x√X + y√Y
  if (u == 0 || u == p) return p;
  if (p == 0) return u;
  // P and U pull apart, and the larger square wins. U² − P² = R + 2xy √(XY) with R = X + Y − P²: if its two
  // parts pull apart as well, again the larger square wins.
  const Expansion R = X + Y - P * P, XY = X * Y;
  const int r = R.sign(), v = x * y * XY.sign();
  int wins = r == 0 ? v : r;
  if (r * v < 0) wins = r * (R * R - Expansion(4) * XY).sign();
  return wins > 0 ? u : wins < 0 ? p : 0;
}

}  // namespace detail

/// The only root of a linear equation, b/A · 2^exponent, in double-double; none where A is 0.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_linear_root(const ExactRoot& exact) {
  RefinedRoots roots;
  roots.relative_error = 0x1p-97;  // two conversions and a quotient, of a few u² each
  if (exact.A.sign() == 0) return roots;
  const DoubleDouble t = DoubleDouble(exact.b) / DoubleDouble(exact.A);
  roots.count = 1;
  roots.t[0] = {std::ldexp(t.hi, exact.exponent), std::ldexp(t.lo, exact.exponent)};
  return roots;
}

/// The sign of r − s, exactly, unless a term falls below 2^-1074.
[[nodiscard, gnu::cold, gnu::noinline]] inline int order(const ExactRoot& r, ExactRoot s) {
  // A root of 0 has no size, and its exponent may be any.
  const bool is_zero = r.b.sign() == 0 && r.D.sign() == 0;
  const int exponent = is_zero ? 0 : s.exponent - r.exponent;
  s.b.scale(exponent), s.D.scale(2 * exponent);
  // Roots along one ray mostly have the same A = d·d. Times A > 0, then, the difference is
  if (r.A == s.A) return detail::sign_of_sum(r.b - s.b, r.sign, r.D, -s.sign, s.D);
  // and otherwise, times the product of both,
  return detail::sign_of_sum(r.b * s.A - s.b * r.A, r.sign, r.D * s.A * s.A, -s.sign, s.D * r.A * r.A);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Equations of surfaces along a line without rounding, and their roots.
#pragma once

#include "exact_root.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Line of the points (origin + t · direction) / weight, with weight > 0, without rounding.
struct ExactLine {
  ExactVector origin, direction;
  ExactNumber weight = 1.0;
};

/// Returns the line through a point along a direction, both with finite numbers.
[[nodiscard]] inline ExactLine exact_line(const Point& origin, const Vec3& direction) {
  return {.origin = exact_vector(origin), .direction = exact_vector(direction)};
}

/// Linear equation slope · t = height; if the slope is 0, it has no root.
struct ExactLinear {
  ExactNumber height, slope;
  bool is_on_surface = true;  ///< true if the root lies on the surface
};

/// Quadratic equation A t² − 2 b t + c = 0; linear if A is 0.
struct ExactQuadratic {
  ExactNumber A, b, c;

  /// Returns A t = 2 b, which remains of the equation if the line starts on the surface, where c = 0.
  [[nodiscard]] ExactLinear without_root_at_0() const { return {.height = b + b, .slope = A}; }

  /// Returns the equation that remains if A is 0.
  [[nodiscard]] ExactLinear without_square() const { return {.height = c, .slope = b + b}; }
};

/// Returns the root; the slope must not be 0. Its number is 0, for callers that take any equation.
[[nodiscard]] inline ExactRoot exact_root_of(const ExactLinear& e, int /* root */ = 0) {
  const bool turns = e.slope.sign() < 0;
  return {.A = turns ? -e.slope : e.slope, .b = turns ? -e.height : e.height, .D = {}};
}

/// Returns the near root (0) or the far one (1); they must exist.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_root_of(const ExactQuadratic& e, int root) {
  if (e.A.sign() == 0) return exact_root_of(e.without_square());
  const bool turns = e.A.sign() < 0;
  return {.A = turns ? -e.A : e.A,
          .b = turns ? -e.b : e.b,
          .D = e.b * e.b - e.A * e.c,
          .sign = root == 0 ? -1 : 1};
}

/// Returns the roots, each converted to the nearest double up to 2^-97 of itself.
[[nodiscard, gnu::cold, gnu::noinline]] inline Roots roots_of(const ExactLinear& e) {
  if (e.slope.sign() == 0 || !e.is_on_surface) return {};
  return Roots{static_cast<double>(refined(exact_root_of(e)))};
}
[[nodiscard, gnu::cold, gnu::noinline]] inline Roots roots_of(const ExactQuadratic& e) {
  if (e.A.sign() == 0) return roots_of(e.without_square());
  const ExactRoot near = exact_root_of(e, 0);
  if (near.D.sign() < 0) return {};
  return {static_cast<double>(refined(near)), static_cast<double>(refined(exact_root_of(e, 1)))};
}

}  // namespace protostar::inline PROTOSTAR_ABI

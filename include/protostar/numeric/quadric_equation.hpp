// Crossings of a line with a quadric: their existence is exact, and t is certified (Roots).
//
// A quadric is the set of zeros of f(p) = p·Mp + 2 l·p + k, for a symmetric matrix M. On the points origin +
// t·d of a line, with g = M·origin + l, half of the gradient at the origin, f is
//   A t² − 2 b t + c   with   A = d·Md,  b = −d·g,  c = f(origin) = origin·g + l·origin + k.
// If A is 0, the equation is linear. A line that starts on the quadric has c = 0 by definition, whatever its
// digits say; its roots are 0 and 2b/A, and only the second is a crossing other than the start.
//
// Double nearly always decides; if its error bound does not allow it, everything is evaluated without
// rounding. docs/derivations.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <cmath>
#include <optional>

#include "../vec3.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Ten numbers of f(p) = squares·(x², y², z²) + 2 products·(yz, zx, xy) + 2 linear·p + constant. They form a
/// symmetric 4×4 matrix, whose last row and column are linear and constant.
struct QuadricForm {
  Vec3 squares{1};
  Vec3 products{0};
  Vec3 linear{0};
  double constant = -1;

  /// Returns M v.
  [[nodiscard]] Vec3 times(const Vec3& v) const {
    return {squares.x * v.x + products.z * v.y + products.y * v.z,
            products.z * v.x + squares.y * v.y + products.x * v.z,
            products.y * v.x + products.x * v.y + squares.z * v.z};
  }
};

[[nodiscard]] inline QuadricForm abs(const QuadricForm& form) {
  return {abs(form.squares), abs(form.products), abs(form.linear), std::abs(form.constant)};
}
[[nodiscard]] inline bool is_finite(const QuadricForm& form) {
  return is_finite(form.squares) && is_finite(form.products) && is_finite(form.linear) &&
         std::isfinite(form.constant);
}

/// Returns the equation in numbers of type T. With o and d of a line of weight w, A = d·Md, b = −d·(M o + w
/// l) and c = o·(M o + w l) + w l·o + w² k.
template <class T>
[[nodiscard]] QuadraticEquation<T> quadric_equation(const LineOf<T>& line, const QuadricForm& form) {
  const auto squares = given<T>(form.squares), products = given<T>(form.products),
             l = line.weight * given<T>(form.linear);
  const VectorOf<T>&o = line.origin, &d = line.direction;
  const auto M_times = [&](const VectorOf<T>& v) -> VectorOf<T> {
    return {squares[0] * v[0] + products[2] * v[1] + products[1] * v[2],
            products[2] * v[0] + squares[1] * v[1] + products[0] * v[2],
            products[1] * v[0] + products[0] * v[1] + squares[2] * v[2]};
  };
  const VectorOf<T> Mo = M_times(o), g{Mo[0] + l[0], Mo[1] + l[1], Mo[2] + l[2]};
  return {.A = dot(d, M_times(d)),
          .b = -dot(d, g),
          .c = dot(o, g) + dot(l, o) + line.weight * line.weight * Given<T>(form.constant)};
}

/// Tests whether f is negative along a line for t → ∞: by the sign of A, or if A is 0 by that of b, or of c,
/// which is 0 if the line starts on the quadric. Empty if rounded numbers do not decide.
template <class T>
[[nodiscard]] std::optional<bool> ends_negative(const QuadraticEquation<T>& e, bool starts_on_it) {
  const auto A = sign_of(e.A), b = sign_of(e.b), c = starts_on_it ? std::optional(0) : sign_of(e.c);
  if (!A) return std::nullopt;
  if (*A != 0) return *A < 0;
  if (!b) return std::nullopt;
  if (*b != 0) return *b > 0;
  return c ? std::optional(*c < 0) : std::nullopt;
}

/// Equation in double. A, b and c have errors of at most 6u, 7u and 9u of their sizes, their values with all
/// numbers made positive; for a rounded line, 8u, 9u and 11u.
struct RoundedQuadricEquation {
  double A, b, c, A_size, b_size, c_size;
  bool in_range;  ///< true if nothing overflows, and underflow is negligible for E > 2^-348

  RoundedQuadricEquation(const Point& origin, const Vec3& direction, const QuadricForm& form)
      : RoundedQuadricEquation(origin, direction, abs(origin), abs(direction), form) {}

  RoundedQuadricEquation(const RoundedLine& line, const QuadricForm& form)
      : RoundedQuadricEquation(line.origin, line.direction, line.origin_size(), line.direction_size(), form) {
  }

  /// Evaluates the equation; o and d are upper bounds for the magnitudes of the line's numbers.
  RoundedQuadricEquation(const Point& origin, const Vec3& direction, const Vec3& o, const Vec3& d,
                         const QuadricForm& form) {
    const Vec3 g = form.times(origin) + form.linear;
    A = dot(direction, form.times(direction));
    b = -dot(direction, g);
    c = dot(origin, g) + dot(form.linear, origin) + form.constant;
    const QuadricForm sizes = abs(form);
    const Vec3 g_sizes = sizes.times(o) + sizes.linear;
    A_size = dot(d, sizes.times(d));
    b_size = dot(d, g_sizes);
    c_size = dot(o, g_sizes) + dot(sizes.linear, o) + sizes.constant;
    in_range = A_size < 0x1p400 && b_size < 0x1p400 && c_size < 0x1p400 && d.x + d.y + d.z < 0x1p200 &&
               o.x + o.y + o.z < 0x1p200;
  }

  /// Returns true if A is accurate enough for a quotient with it.
  [[nodiscard]] bool is_A_certain() const { return std::abs(A) > 0x1p-18 * A_size && A_size > 0x1p-400; }

  /// Returns the equation with A > 0, and with its bounds.
  ///
  /// The error of D is at most 16u b_size² + 17u A_size c_size, or for a rounded line 20u and 21u; E is 32u
  /// of both. The error of q is 2^-31.9 |q| from √D, as for the sphere; √D |q| > 2^31 E makes |q| > 2^-9
  /// b_size, so the error of b, at most 9u b_size, is negligible. The error of c is at most 11u c_size <
  /// 2^-31.5 |c|. b² > 2^12 E makes |b| > 2^-18 b_size, so its error is below 2^-32.1 |b|.
  [[nodiscard]] RoundedQuadratic<double, double> with_positive_A() const {
    const double E = 0x1p-48 * (b_size * b_size + A_size * c_size), sign = A < 0 ? -1 : 1;
    const bool is_known = in_range && E > 0x1p-348 && is_A_certain();
    return {.A = sign * A,
            .b = sign * b,
            .c = sign * c,
            .w = c_size > 0x1p-400 ? c_size : infinity,
            .D = b * b - A * c,
            .E = is_known ? E : infinity};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

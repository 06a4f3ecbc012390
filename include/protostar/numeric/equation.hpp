// Equations of surfaces along a line, in numbers of any type, and their roots.
//
// A surface writes its equation once, for numbers of a type T. In rounded numbers (RoundedNumber) the
// equation tells whether and where the line crosses, or is undecided; without rounding (ExactNumber) it
// always decides.
#pragma once

#include <cmath>
#include <concepts>
#include <optional>
#include <type_traits>

#include "exact_root.hpp"
#include "roots.hpp"
#include "rounded_number.hpp"
#include "vector_of.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Type of a given number in formulas with numbers of type T: T, or for rounded numbers double, which is
/// exact and costs less.
template <class T>
using Given = std::conditional_t<std::same_as<T, RoundedNumber>, double, T>;

/// Returns a given vector in numbers of type Given<T>.
template <class T>
[[nodiscard]] VectorOf<Given<T>> given(const Vec3& v) {
  return vector_of<Given<T>>(v);
}

/// Line of the points (origin + t · direction) / weight, with weight > 0. For rounded numbers the weight is
/// 1, so products of it and a given number are exact.
template <class T>
struct LineOf {
  VectorOf<T> origin, direction;
  Given<T> weight;
};

/// Line without rounding.
using ExactLine = LineOf<ExactNumber>;

/// Line in doubles, with upper bounds for the error of each.
struct RoundedLine {
  Point origin{0};
  Vec3 direction{0};
  Vec3 origin_error{0}, direction_error{0};

  /// Returns s = |x| + 2^53 · error for each component x, so that its error is at most 2^-53 s. A bound for
  /// exact components holds if their magnitudes are replaced by s, and one unit of 2^-53 is added for each.
  [[nodiscard]] Vec3 origin_size() const { return abs(origin) + 0x1p53 * origin_error; }
  [[nodiscard]] Vec3 direction_size() const { return abs(direction) + 0x1p53 * direction_error; }

  [[nodiscard]] LineOf<RoundedNumber> with_errors() const {
    const auto numbers = [](const Vec3& v, const Vec3& error) -> VectorOf<RoundedNumber> {
      return {RoundedNumber(v.x, error.x), RoundedNumber(v.y, error.y), RoundedNumber(v.z, error.z)};
    };
    return {numbers(origin, origin_error), numbers(direction, direction_error), 1};
  }
};

/// Returns the line through a point along a direction, both with finite numbers.
template <class T>
[[nodiscard]] LineOf<T> line_of(const Point& origin, const Vec3& direction) {
  return {vector_of<T>(origin), vector_of<T>(direction), Given<T>(1)};
}

/// Linear equation slope · t = height; if the slope is 0, it has no root.
template <class T>
struct LinearEquation {
  T height, slope;
  std::optional<bool> is_on_surface = true;  ///< true if the root lies on the surface; empty: undecided
};

/// Quadratic equation A t² − 2 b t + c = 0; linear if A is 0.
template <class T>
struct QuadraticEquation {
  T A, b, c;

  /// Returns A t = 2 b, which is left of the equation if the line starts on the surface, where c = 0.
  [[nodiscard]] LinearEquation<T> without_root_at_0() const { return {.height = b + b, .slope = A}; }
};

/// Returns the root of an equation without rounding; the slope must not be 0.
[[nodiscard]] inline ExactRoot exact_root_of(const LinearEquation<ExactNumber>& e, int = 0) {
  const bool turns = e.slope.sign() < 0;
  return {.A = turns ? -e.slope : e.slope, .b = turns ? -e.height : e.height, .D = {}};
}

/// Returns the near root (0) or the far one (1) without rounding; they must exist.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_root_of(
    const QuadraticEquation<ExactNumber>& e, int root) {
  if (e.A.sign() == 0) return exact_root_of(LinearEquation<ExactNumber>{.height = e.c, .slope = e.b + e.b});
  const bool turns = e.A.sign() < 0;
  return {.A = turns ? -e.A : e.A,
          .b = turns ? -e.b : e.b,
          .D = e.b * e.b - e.A * e.c,
          .sign = root == 0 ? -1 : 1};
}

/// Returns the roots without rounding, each converted to the nearest double up to 2^-97 of itself.
[[nodiscard, gnu::cold, gnu::noinline]] inline Roots roots_of(const LinearEquation<ExactNumber>& e) {
  if (e.slope.sign() == 0 || e.is_on_surface == false) return {};
  return Roots{static_cast<double>(refined(exact_root_of(e)))};
}
[[nodiscard, gnu::cold, gnu::noinline]] inline Roots roots_of(const QuadraticEquation<ExactNumber>& e) {
  if (e.A.sign() == 0) return roots_of(LinearEquation<ExactNumber>{.height = e.c, .slope = e.b + e.b});
  const ExactRoot near = exact_root_of(e, 0);
  if (near.D.sign() < 0) return {};
  return {static_cast<double>(refined(near)), static_cast<double>(refined(exact_root_of(e, 1)))};
}

/// Returns the certified roots; empty if rounded numbers do not decide.
[[nodiscard]] inline std::optional<Roots> roots_of(const LinearEquation<RoundedNumber>& e) {
  if (e.is_on_surface == false) return Roots{};
  const auto slope = sign_of(e.slope);
  if (slope == 0) return Roots{};
  if (!slope || !e.is_on_surface) return std::nullopt;
  const RoundedNumber t = e.height / e.slope;
  return t.is_certain() ? std::optional(Roots{t.middle}) : std::nullopt;
}
[[nodiscard]] inline std::optional<Roots> roots_of(const QuadraticEquation<RoundedNumber>& e) {
  const auto A = sign_of(e.A), D = sign_of(e.b * e.b - e.A * e.c);
  if (!A || *A == 0 || !D || *D == 0) return std::nullopt;
  if (*D < 0) return Roots{};
  // q is the one of b ± √D that does not cancel. One root is q/A, and the other c/q, since their product is
  // c/A. These are the roots whatever sign b has.
  const RoundedNumber root = sqrt(e.b * e.b - e.A * e.c), q = e.b.middle < 0 ? e.b - root : e.b + root;
  if (sign_of(q).value_or(0) == 0) return std::nullopt;
  const RoundedNumber one = e.c / q, other = q / e.A;
  if (!one.is_certain() || !other.is_certain() || !sign_of(one - other)) return std::nullopt;
  return one.middle < other.middle ? Roots{one.middle, other.middle} : Roots{other.middle, one.middle};
}

}  // namespace protostar::inline PROTOSTAR_ABI

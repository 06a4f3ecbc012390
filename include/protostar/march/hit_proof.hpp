// Proof of a crossing: the field has one slope up to it and another sign behind it, so it is the first and
// the only one there.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "../numeric/roots.hpp"
#include "field_line.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Largest width of an enclosure of t, as a share of t: roots are known to that, and t in the middle is
/// closer yet.
inline constexpr double enclosure_width = Roots::relative_error;

/// First crossing of a march, or how it ended without one.
struct MarchedRoot {
  enum class Answer : std::uint8_t {
    miss,      ///< proven: no crossing
    hit,       ///< proven: the first crossing lies in [min, max], and the field is beyond 0 at max
    undecided  ///< the field comes nearer to 0 at [min, max] than double-double tells; taken for a hit
  };

  Answer answer = Answer::miss;
  double min = 0, max = 0;

  /// Returns the middle of the enclosure, which has the sign of the root.
  [[nodiscard]] double t() const { return 0.5 * (min + max); }
};

namespace detail {

/// A value of F in double at a parameter.
struct FieldValue {
  double t, v;
};

/// Returns true if an enclosure of t is narrow enough.
[[nodiscard]] inline bool is_narrow(double a, double b) {
  return b - a <= enclosure_width * std::min(std::abs(a), std::abs(b));
}

/// Proves the first crossing near a guess, from a parameter `start` up to which F > 0 is proven. Behind the
/// crossing, F(guess + δ) < −E; over [start, guess + δ] the slope is never above 0; before it, F(guess − δ) >
/// E. F falls all along, hence the first root lies between the two. Nothing is divided by the slope, which
/// may vanish, and at a kink all its slopes count. δ begins where F, by the slope, is three times its error
/// E: a value there, off by E, is still beyond 2E, and so beyond E if the guess is off by no more than E
/// divided by the slope. It is at least 2^-50 of t, four last places, so that guess ± δ differ from the
/// guess. Four tries take δ to 64 times that, which bounds the work for worse guesses. Values behind the end
/// of the box have no bound of their error, and prove nothing.
template <class Line>
[[nodiscard]] std::optional<MarchedRoot> proven_root(Line& line, double start, double guess, double slope) {
  const double error = line.error(), least = std::max(3 * error / -slope, 0x1p-50 * std::abs(guess));
  const auto decided_on = [&](double side) -> std::optional<double> {
    double delta = least;
    for (int i = 0; i < 4; ++i, delta *= 4) {
      const double t = std::max(start, guess + side * delta);
      if (side < 0 && (t == start || line.value(t) > error)) return t;
      if (side > 0 && line.value(t) < -error) return t;
    }
    return std::nullopt;
  };
  const auto max = decided_on(1);
  if (!max || *max > line.span().max) return std::nullopt;
  if (!(line.template slope<double>(start, *max).slope.upper <= 0)) return std::nullopt;
  const double min = decided_on(-1).value_or(start);
  if (!is_narrow(min, *max)) return std::nullopt;
  return MarchedRoot{MarchedRoot::Answer::hit, min, *max};
}

/// Looks for a crossing by the line through two values of F, of which the first is above 0 and no root lies
/// before it; if `second` is above 0 as well, none lies before that. The secant method finds a guess in a few
/// steps. Returns nothing if they do not converge, or nothing is proven.
template <class Line>
[[nodiscard]] std::optional<MarchedRoot> root_by_secant(Line& line, FieldValue first, FieldValue second,
                                                        double end) {
  const double start = second.v > 0 ? second.t : first.t;
  double slope = (second.v - first.v) / (second.t - first.t);
  for (int i = 0; i < 8; ++i) {
    if (!(slope < 0)) return std::nullopt;
    const double next = second.t - second.v / slope;
    if (!(start <= next && next < end)) return std::nullopt;
    // The error of the next guess is about the product of the last two: below 2^-48 of t if they are about
    // 2^-18 and 2^-30 of it.
    const bool converges = i > 0 && std::abs(next - second.t) < 0x1p-30 * std::abs(next);
    if (converges || std::abs(second.v) <= 2 * line.error()) return proven_root(line, start, next, slope);
    const FieldValue at_next{next, line.value(next)};
    if (at_next.v == second.v || next == second.t) return proven_root(line, start, next, slope);
    slope = (at_next.v - second.v) / (next - second.t);
    second = at_next;
  }
  return std::nullopt;
}

/// Narrows a segment [a, b] over which F falls, is above 0 at a and below at b, by values between: a third of
/// them by the secant from either side, and a third by bisection. Returns nothing if the enclosure remains
/// too wide. Double-double is the last to ask: a root so near to the origin that it is not enclosed to 2^-30
/// of itself, as behind a departure at a grazing angle, needs no more than 2^-30 of the size of the bounds.
///
/// The proof needs 2^-30 (is_narrow). The search goes on to 2^-42, for 12 more bits of t, which cost a value
/// or two where the secant converges. Values are taken at 2^-45 on both sides of the secant's root, which
/// leaves a segment of 2^-44, less than 2^-42. Every three steps halve the segment if the sign in its middle
/// is certain, and leave ¾ of it otherwise: 200 steps halve it 66 times, more often than a double has digits.
template <class B, class Line>
[[nodiscard]] std::optional<MarchedRoot> narrowed_root(Line& line, double a, double b) {
  Enclosure<B> at_a = line.enclosed(B(a)), at_b = line.enclosed(B(b));
  /// Moves an end to t, if the sign of F is certain there.
  const auto take = [&](double t) {
    if (!(a < t && t < b)) return false;
    const Enclosure<B> at_t = line.enclosed(B(t));
    if (B(0.0) < at_t.lower) return a = t, at_a = at_t, true;
    if (at_t.upper < B(0.0)) return b = t, at_b = at_t, true;
    return false;
  };
  for (int i = 0; i < 200 && b - a > 0x1p-42 * std::min(std::abs(a), std::abs(b)); ++i) {
    const double v_a = static_cast<double>(at_a.lower + at_a.upper),
                 v_b = static_cast<double>(at_b.lower + at_b.upper);
    // On both sides of the secant's root, where F is four times its error. Values are doubled here.
    const double unsure = std::is_same_v<B, double> ? 8 * line.error() * ((b - a) / (v_a - v_b)) : 0;
    const double secant = a + (b - a) * (v_a / (v_a - v_b)), side = std::max(0x1p-45 * std::abs(b), unsure);
    const double middle = 0.5 * (a + b);
    if (i % 3 == 0) {
      take(secant - side);
    } else if (i % 3 == 1) {
      take(secant + side);
    } else if (!take(middle)) {
      const double quarter = 0.25 * (b - a);
      const bool moved = take(middle - quarter);
      if (!take(middle + quarter) && !moved) break;
    }
  }
  const bool is_last = std::is_same_v<B, DoubleDouble> && b - a <= enclosure_width * line.extent();
  if (!is_narrow(a, b) && !is_last) return std::nullopt;
  return MarchedRoot{MarchedRoot::Answer::hit, a, b};
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

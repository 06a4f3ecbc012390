// Proof of a crossing: the field has one slope up to it and another sign behind it, so it is the first and
// the only one there.
#pragma once

#include <cstdint>
#include <type_traits>

#include "../numeric/roots.hpp"
#include "field_line.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Largest width of an enclosure of the t of a root, as a share of t.
inline constexpr double enclosure_width = Roots::relative_error;

/// First crossing of a march, or how it ended without one.
struct MarchedRoot {
  enum class Answer : std::uint8_t {
    miss,      ///< proven: no crossing
    hit,       ///< proven: the first crossing lies in [min, max], which is rounded outward to doubles
    undecided  ///< the field comes nearer to 0 at [min, max] than double-double tells; taken for a hit
  };

  Answer answer = Answer::miss;
  double min = 0, max = 0;

  /// Returns the middle of the enclosure, which has the sign of the root, as both ends have; or 0 for a root
  /// so near to 0 that its sign is not known. Roots of other surfaces there have the same t, and are compared
  /// by their enclosures.
  [[nodiscard]] double t() const { return min < 0 && 0 < max ? 0 : min + 0.5 * (max - min); }
};

namespace detail {

/// A value of F in double at a parameter, or at one in each lane.
template <class R>
struct FieldValue {
  R t, v;
};

/// First crossings of a line, or of one in each lane, where `met` says so: enclosed in [min, max].
template <class R, class M>
struct ProvenRoots {
  M met = false;
  R min = 0.0, max = 0.0;
};

/// Tests whether an enclosure [a, b] of t is at most enclosure_width · |t| wide for each t in it.
template <class R>
[[nodiscard]] auto is_narrow(const R& a, const R& b) {
  return b - a <= R(enclosure_width) * rounding::min(rounding::abs(a), rounding::abs(b));
}

/// Returns the lanes of those that ask where F is proven to fall from `start` to `end`, by an enclosure of
/// the slope, or if F'' ≥ −b by a value behind the end, at c: F + ½ b t² is convex, so for x < y in [start,
/// end]
///   (F(y) − F(x))/(y − x) ≤ (F(c) − F(end))/(c − end) + ½ b (c + end − x − y) ≤ … + b (c − start).
/// The difference of two values is off by 2E, and 2E more exceed its rounding, u of itself. c is half as far
/// behind the end as the start is before it: a choice.
template <class Line, class R, class M>
[[nodiscard, gnu::flatten]] M falls_over(Line& line, M open, const R& start, const R& end) {
  M falls = false;
  if (line.is_bend_known()) {
    const R at_end = line.value(end, open),
            c = rounding::min(end + R(0.5) * (end - start), R(line.span().max));
    const M asks = open && end < c;
    const R rise = line.value(c, asks) - at_end + R(4.0) * line.error();
    falls = asks && line.bend() * (c - start) * R(1 + 0x1p-40) <= -rise / (c - end);
    line.proven(MarchProof::fall, falls, start, end);
  }
  const M rest = open && !falls;
  if (!rounding::any(rest)) return falls;
  return falls || (rest && line.template slope<R>(start, end, rest).slope.upper <= R(0.0));
}

/// Proves the first crossing near a guess, from a parameter `start` up to which F > 0 is proven, in the lanes
/// that ask. Behind the crossing, F(guess + δ) < −E; over [start, guess + δ] F falls (falls_over);
/// before it, F(guess − δ) > E. F falls all along, hence the first root lies between the two. Nothing is
/// divided by the slope, which may vanish, and at a kink all its slopes count. δ begins where F, by the
/// slope, is three times its error E: a value there, off by E, is still beyond 2E, and so beyond E if the
/// guess is off by no more than E divided by the slope. It is at least 2^-50 of t, four last places, so that
/// guess ± δ differ from the guess. Four tries take δ to 64 times that, which bounds the work for worse
/// guesses. Values behind the end of the box have no bound of their error, and prove nothing.
template <class Line, class R, class M>
[[nodiscard, gnu::flatten, gnu::noinline]] ProvenRoots<R, M> proven_root(Line& line, M open, const R& start,
                                                                         const R& guess, const R& slope) {
  const R error = line.error();
  const R least = rounding::max(R(3.0) * error / -slope, R(0x1p-50) * rounding::abs(guess));
  ProvenRoots<R, M> root{.met = open, .min = start, .max = guess};
  M asks = open;
  R delta = least;
  for (int i = 0; i < 4 && rounding::any(asks); ++i, delta = delta * R(4.0)) {
    const R t = rounding::max(start, guess + delta);
    root.max = rounding::select(asks, t, root.max);
    asks = asks && !(line.value(t, asks) < -error);
  }
  root.met = root.met && !asks && root.max <= R(line.span().max);
  if (!rounding::any(root.met)) return root;
  root.met = falls_over(line, root.met, start, root.max);
  asks = root.met, delta = least;
  for (int i = 0; i < 4 && rounding::any(asks); ++i, delta = delta * R(4.0)) {
    const R t = rounding::max(start, guess - delta);
    asks = asks && !(t == start);  // min is that already
    if (!rounding::any(asks)) break;
    const M is_before = asks && line.value(t, asks) > error;
    root.min = rounding::select(is_before, t, root.min);
    asks = asks && !is_before;
  }
  root.met = root.met && is_narrow(root.min, root.max);
  return root;
}

/// Looks for a crossing by the line through two values of F, of which the first is above 0 and no root lies
/// before it; if `second` is above 0 as well, none lies before that. The secant method finds a guess in a few
/// steps. Nothing is met in lanes where they do not converge, or nothing is proven.
template <class Line, class R, class M>
[[nodiscard, gnu::flatten, gnu::noinline]] ProvenRoots<R, M> root_by_secant(Line& line, M open,
                                                                            const FieldValue<R>& first,
                                                                            FieldValue<R> second) {
  const R start = rounding::select(second.v > R(0.0), second.t, first.t), end(line.span().max);
  R slope = (second.v - first.v) / (second.t - first.t), guess = second.t, steepness = slope;
  M ready = false;
  for (int i = 0; i < 8; ++i) {
    const R next = second.t - second.v / slope;
    open = open && slope < R(0.0) && start <= next && next < end;
    // The error of the next guess is about the product of the last two: below 2^-48 of t if they are about
    // 2^-18 and 2^-30 of it.
    M ends = rounding::abs(second.v) <= R(2.0) * line.error();
    if (i > 0) ends = ends || rounding::abs(next - second.t) < R(0x1p-30) * rounding::abs(next);
    guess = rounding::select(open, next, guess), steepness = rounding::select(open, slope, steepness);
    ready = ready || (open && ends);
    open = open && !ends;
    if (!rounding::any(open)) break;
    const R v = line.value(next, open);
    ends = v == second.v || next == second.t;
    ready = ready || (open && ends);
    open = open && !ends;
    slope = rounding::select(open, (v - second.v) / (next - second.t), slope);
    second = {rounding::select(open, next, second.t), rounding::select(open, v, second.v)};
  }
  if (!rounding::any(ready)) return {};
  return proven_root(line, ready, start, guess, steepness);
}

/// Narrows a segment [a, b] over which F falls, is above 0 at a and below at b, by values between: a third of
/// them by the secant from either side, and a third by bisection, in the lanes that ask. Nothing is met where
/// the enclosure remains too wide. Double-double is the last to ask: a root so near to the origin that it is
/// not enclosed to 2^-30 of itself, as behind a departure at a grazing angle, needs no more than 2^-30 of the
/// size of the bounds.
///
/// The proof needs 2^-30 (is_narrow). The search goes on to 2^-42, for 12 more bits of t, which cost a value
/// or two where the secant converges. Values are taken at 2^-45 on both sides of the secant's root, which
/// leaves a segment of 2^-44, less than 2^-42. Every three steps halve the segment if the sign in its middle
/// is certain, and leave ¾ of it otherwise: 200 steps halve it 66 times, more often than a double has digits.
///
/// B is the number type of the enclosures, of a and of b. Between a and b, values are taken at doubles alone:
/// where the segment lies between two doubles, it is narrow enough already.
template <class B, class Line, class M>
[[nodiscard]] ProvenRoots<B, M> narrowed_root(Line& line, M open, B a, B b) {
  using R = typename Line::Number;
  using rounding::any, rounding::select;
  const M asked = open;
  const B zero(0.0);
  Enclosure<B> at_a = line.enclosed(a, open), at_b = line.enclosed(b, open);
  /// Moves an end to t in lanes where the sign of F is certain there. Returns these lanes.
  const auto take = [&](const B& t, M lanes) {
    lanes = lanes && a < t && t < b;
    if (!any(lanes)) return lanes;
    const Enclosure<B> at_t = line.enclosed(t, lanes);
    const M is_before = lanes && zero < at_t.lower, is_behind = lanes && at_t.upper < zero;
    a = select(is_before, t, a), at_a = select(is_before, at_t, at_a);
    b = select(is_behind, t, b), at_b = select(is_behind, at_t, at_b);
    return is_before || is_behind;
  };
  for (int i = 0; i < 200; ++i) {
    const R left(a), right(b), width = right - left;
    open = open && width > R(0x1p-42) * rounding::min(rounding::abs(left), rounding::abs(right));
    if (!any(open)) break;
    const R v_a = static_cast<R>(at_a.lower + at_a.upper), v_b = static_cast<R>(at_b.lower + at_b.upper);
    // On both sides of the secant's root, where F is four times its error. Values are doubled here.
    const R unsure = std::is_same_v<B, R> ? R(8.0) * line.error() * (width / (v_a - v_b)) : R(0.0);
    const R secant = left + width * (v_a / (v_a - v_b)),
            side = rounding::max(R(0x1p-45) * rounding::abs(right), unsure);
    const R middle = R(0.5) * (left + right);
    if (i % 3 == 0) {
      take(secant - side, open);
    } else if (i % 3 == 1) {
      take(secant + side, open);
    } else {
      const M stays = open && !take(middle, open);
      if (!any(stays)) continue;
      const R quarter = R(0.25) * width;
      const M moved = take(middle - quarter, stays), moved_back = take(middle + quarter, stays);
      open = open && !(stays && !moved && !moved_back);
    }
  }
  const R left(a), right(b);
  const M is_last = std::is_same_v<B, DoubleDouble> && right - left <= R(enclosure_width) * line.extent();
  return {.met = asked && (is_narrow(left, right) || is_last), .min = a, .max = b};
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

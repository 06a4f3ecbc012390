// Rules of a march that hold for one ray as for each of several in lanes: lengths of steps, and what an
// enclosure proves of a segment.
#pragma once

#include "../exact/enclosure.hpp"
#include "../exact/slope.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Lengths of steps by balls, and when other steps are tried instead. They are chosen for speed and not
/// derived; bench_marching counts the evaluations that they take. They change the last digits of t, but no
/// proof depends on them: each step is proven by its balls alone.
struct StepRules {
  /// Largest radius, as a multiple of its error, of a ball that is too small for steps: the error takes 1/65
  /// or more from it.
  static constexpr double least_ball = 64;
  /// Lower bound of F, as a multiple of its error, above which balls take over from segments. A value is then
  /// above 127 errors and the radius of its ball above 126, far more than least_ball, so that segments do not
  /// take over again at once.
  static constexpr double worth_balls = 128;

  /// Share of the field's extent below which a ball is slow, and the most slow balls before segments take
  /// over, each of which takes as long as several values.
  static constexpr double slow_ball = 0.02;
  static constexpr int most_slow = 40;

  /// Rules of the secant method. It is tried where balls shrink steadily, or are smaller than `secant_ball`
  /// of the extent, and again after they have shrunk to `again` of their size: a kink before the crossing, at
  /// which it fails, may still be there if balls are only a little smaller. After `most_failed` tries that
  /// failed, segments take over.
  static constexpr double secant_ball = 0.01, again = 0.03;
  static constexpr int most_failed = 3;

  /// Most segments of a march between two looks at balls. A march creeps if they bring it farther neither by
  /// least_progress of the extent nor to twice its t; by the second, a ray that leaves along the surface gets
  /// on from a small t. A march that creeps in double goes on in double-double, and there it is undecided.
  /// The way through the box is at most 2√3 extents, along a diagonal, and t doubles fewer than 2^11 times in
  /// the range of double, so that fewer than 2^12 looks find progress in each precision.
  static constexpr int most_segments = 3000;
  static constexpr double least_progress = 0x1p-8;

  /// Returns the growth of balls, after a step of length `way` by which the radius has changed by `gain`: the
  /// quotient g of the radii of two balls that touch, if the radius goes on to change as much. With the trend
  /// m = gain/way, the next ball has the radius r' = r + m (r + r'), so that g = (1 + m)/(1 − m): 0 where the
  /// way goes straight to a plane, m = −1, and 1 beside one. It is cut to 2^-11 … 19, for m from −0.999 to
  /// 0.9. NaN becomes 2^-11, and so does the quotient below 0 of an m that rounding makes larger than 1.
  template <class R>
  [[nodiscard]] static R growth(const R& gain, const R& way) {
    return rounding::min(rounding::max(R(0x1p-11), (way + gain) / (way - gain)), R(19.0));
  }

  /// Returns the next step as a multiple of the radius, 1 + 0.9 g: after 1 + g radii, with the growth g, the
  /// next ball would just touch this one.
  template <class R>
  [[nodiscard]] static R stretch(const R& growth) {
    return R(1.0) + R(0.9) * growth;
  }

  /// Returns a distance in t behind the second of two values within which F > 0 is proven, for the plain
  /// values v₀ = `first` at t₀ and v₁ = `second` at t₁ = t₀ + `way`, off by E = `error` each, and F'' ≥ −b, b
  /// = `bend`: F + ½ b t² is convex, and lies above the line through its two values behind them. With w = t₁
  /// − t₀ and q ≤ (F₁ − F₀)/w,
  ///   F(t₁ + s) ≥ F₁ + q s − ½ b s (s + w) = F₁ + p s − ½ b s²,   p = q − ½ b w.
  /// This stays above 0 up to (p + r)/b = 2F₁/(r − p), r = √(p² + 2 b F₁); the first is taken for p > 0 and
  /// the second otherwise, so that nothing cancels. It is ∞ for b = 0 and p ≥ 0.
  ///
  /// Values are off by E: F₁ ≥ v₁ − E, and q = (v₁ − v₀ − 2E)/w. Roundings are relative and below 2^-40, but
  /// in p, and in v₁ − v₀, where they are at most 2u of the terms. Where q < 0 these do not cancel in p;
  /// otherwise q ≤ L|d|, and terms of p that cancel are as small, up to a factor 2. So p is off by 8u L|d| at
  /// most, and F by 8u L|d| s, with s ≤ 2T less than 3E ≥ 18u L|d| T: F₁ is taken as v₁ − 4E.
  template <class R>
  [[nodiscard]] static R free_behind(const R& first, const R& way, const R& second, const R& error,
                                     const R& bend) {
    const R slope = (second - first - R(2.0) * error) / way - R(0.5) * bend * way;
    const R least = rounding::max(second - R(4.0) * error, R(0.0));
    const R root = rounding::sqrt(slope * slope + R(2.0) * bend * least);
    const auto rises = R(0.0) < slope;
    return R(1 - 0x1p-38) * rounding::select(rises, slope + root, R(2.0) * least) /
           rounding::select(rises, bend, root - slope);
  }

  /// Returns true if F falls so steeply that a proof of its fall up to the root is in sight (falls_over): its
  /// slope m/reach, with the trend m = (g − 1)/(g + 1) < 0 for the growth g, is at least 3/2 as steep as what
  /// the bend adds to it at most over the way to the root, radius/|m|.
  template <class R>
  [[nodiscard]] static auto is_steep(const R& growth, const R& radius, const R& reach, const R& bend) {
    const R less = growth - R(1.0), more = growth + R(1.0);
    return R(1.5) * bend * reach * radius * (more * more) <= less * less;
  }

  /// Tests whether balls shrink about as fast as at the last step, by the growth of both, g and h, so that F
  /// is nearly straight: their trends, which differ by 2 (g − h) / ((g + 1) (h + 1)), differ by less than a
  /// quarter of (1 − g)/(1 + g). Balls that shrink by less than 4 % are too far from a root for a secant. The
  /// answer decides how many steps are taken, and not what is hit.
  template <class R>
  [[nodiscard]] static auto is_straight(const R& growth, const R& last) {
    return growth < R(0.96) && rounding::abs(growth - last) < R(0.125) * (R(1.0) - growth) * (R(1.0) + last);
  }
};

/// Proof that F > 0 over a segment, if `is_empty`, and a lower bound of F at its end, `at_end`.
template <class B>
struct SegmentProof {
  typename Enclosure<B>::Truth is_empty;
  B at_end;

  /// Takes F over the segment, lower bounds of F > 0 at its left end and of F at its right end, and its
  /// width.
  ///
  /// F lies above its range; above the line of the steepest fall from the left end; above that of the
  /// steepest rise to the right end; and hence above the point at which the two meet, which is
  /// (hi F₀ − lo F₁ + lo hi width) / (hi − lo) for a fall of lo ≤ 0 and a rise of hi ≥ 0. Only the sign of
  /// that is needed. Slopes of one sign are enclosed by [lo, 0] or [0, hi] as well.
  [[gnu::flatten]] SegmentProof(const Slope<Enclosure<B>>& over, const B& left, const B& right,
                                const Enclosure<B>& width) {
    using E = Enclosure<B>;
    const B zero(0.0);
    const E fall = E::at(rounding::min(over.slope.lower, zero)),
            rise = E::at(rounding::max(over.slope.upper, zero));
    const B from_left = (E::at(left) + fall * width).lower, from_right = (E::at(right) - rise * width).lower;
    const B least = rounding::max(over.value.lower, rounding::max(from_left, from_right));
    const B meeting = (rise * E::at(left) - fall * E::at(right) + fall * rise * width).lower;
    is_empty = zero < least || (zero < left && zero < right && zero < meeting);
    at_end =
        rounding::max(rounding::max(right, least), (E::at(left) + E::at(over.slope.lower) * width).lower);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail

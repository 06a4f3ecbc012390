// A march along a ray that proves each of its steps: to the first crossing with a surface, or past it.
//
// Far from the surface, values in double prove balls empty, whose radii are (v − E) / (L |d|) along the ray.
// Steps are longer than a radius where the radius grows or shrinks steadily (over-relaxation), and they count
// if the balls at both ends cover what is between them. Where second derivatives are bounded, the line
// through two values proves more of the way behind them. Near the surface, where balls are small, an
// enclosure of value and slope proves a whole segment. Segments double where they succeed and are halved
// where they fail, so that a ray which passes at a distance g takes about log 1/g of them. Double-double
// decides where double cannot.
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>

#include "hit_proof.hpp"
#include "step_rules.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// March along one line, or along one in each lane, from where F > 0 to the first root. `Line` is a FieldLine
/// or FieldLines. Lanes march together, and each takes the steps that its line takes alone: it waits while
/// others go on. One that needs more than double goes on alone, from where it is. In double-double, the
/// parameter t has as many digits as F: an edge of a surface may lie between two doubles, and a ray may cross
/// the surface twice there.
template <class Line>
class March {
 public:
  using R = typename Line::Number;  ///< double, or simd::Doubles
  using M = typename Line::Truth;   ///< bool, or a mask of lanes

  /// Number type of the parameter at which a march begins: one line alone may begin between two doubles.
  using Begin = std::conditional_t<std::same_as<R, double>, DoubleDouble, R>;

  /// Starts at the parameter t of the line, up to which all roots have been found. If `known` is above 0, F
  /// is at least `known` at t. A march that comes to the end of the line proves a miss; one that comes to
  /// `stop` goes no farther, since no root behind it is wanted. The steps, and with them the digits of the
  /// root, do not depend on `stop`.
  March(Line& line, const Begin& t, double stop, const R& known = 0.0)
      : line_(line), begin_(t), t_(t), known_(known), before_(t), end_(line.span().max), stop_(stop) {}

  /// Marches in double, in the lanes `live`. Returns the lanes in which double proves nothing more before the
  /// march has ended. In all others the march has met its first root, or come to its end.
  [[nodiscard]] M in_double(M live) {
    M to_segments = live && R(0.0) < known_, to_balls = live && !to_segments, fails = false;
    while (any(live)) {
      before_ = select(live, t_, before_);
      if (any(to_balls)) to_segments = to_segments || march_by_balls(to_balls);
      if (!any(to_segments)) break;
      const Segments after = march_by_segments(t_, roots_, to_segments);
      fails = fails || after.fail;
      to_balls = live = after.are_worth_balls, to_segments = false;
    }
    return fails;
  }

  /// Returns the first root of a single line, or a miss; in double, and where that does not suffice in
  /// double-double.
  [[nodiscard]] MarchedRoot root() {
    if (begin_.lo != 0) return precise_root(begin_, -infinity);
    return in_double(true) ? precise_root(t_, before_) : found();
  }

  /// Returns the first root of a single line whose march goes on in double-double, from t. `before` is the t
  /// at which the march last tried balls, or -infinity if it has not.
  [[nodiscard]] MarchedRoot precise_root(DoubleDouble t, double before) {
    for (;;) {
      ProvenRoots<DoubleDouble, bool> root;
      const Segments after = march_by_segments(t, root, true);
      t_ = double_below(t);
      if (root.met) return hit(root);
      if (after.fail) return undecided();
      if (!after.are_worth_balls) return {};
      // Far away, where double proves nothing on the whole line, the way from t_ to t may have roots that
      // were found before: the march goes on from t.
      if (!(line_.error() < infinity)) continue;
      // Elsewhere F > 0 from t_ to t as well, and the march goes on from t_ in double. Where balls are faster
      // again, F(t) is above 128 of its errors, and one error is more than F changes by over two last places
      // of t. Otherwise this march by segments has brought t farther than a last place: to twice its value,
      // or by 2^-8 of the extent, more than ten last places where the error is finite.
      if (!(t_ > before)) return undecided();
      if (!in_double(true)) return found();
      t = t_, before = before_;
    }
  }

  /// Returns the roots that have been met in double.
  [[nodiscard]] const ProvenRoots<R, M>& roots() const { return roots_; }

  /// Returns the enclosure of the root of a single line, with all digits. F is above 0 where it begins and
  /// below 0 where it ends; for an undecided root both ends are the t of the march.
  [[nodiscard]] const Enclosure<DoubleDouble>& enclosure() const { return enclosure_; }

  /// Return the t at which the march is, and the t at which it last tried balls.
  [[nodiscard]] const R& t() const { return t_; }
  [[nodiscard]] const R& before() const { return before_; }

 private:
  /// Lanes that do not end with a march by segments.
  struct Segments {
    M are_worth_balls;  ///< balls are faster again
    M fail;             ///< this precision proves nothing more
  };

  /// Returns what a march in double has found.
  [[nodiscard]] MarchedRoot found() {
    return roots_.met ? hit(ProvenRoots<DoubleDouble, bool>{true, roots_.min, roots_.max}) : MarchedRoot{};
  }

  [[nodiscard]] MarchedRoot hit(const ProvenRoots<DoubleDouble, bool>& root) {
    enclosure_ = {root.min, root.max};
    return {MarchedRoot::Answer::hit, double_below(root.min), double_above(root.max)};
  }

  [[nodiscard]] MarchedRoot undecided() {
    ++fallbacks.undecided;
    line_.proven(MarchProof::touch, true, t_, t_);
    enclosure_ = {t_, t_};
    return {MarchedRoot::Answer::undecided, t_, t_};
  }

  /// Adds found roots to others. Returns the lanes that have met theirs.
  template <class B>
  M meet(const ProvenRoots<B, M>& found, ProvenRoots<B, M>& roots) {
    line_.proven(MarchProof::sign_change, found.met, found.min, found.max);
    roots.min = select(found.met, found.min, roots.min);
    roots.max = select(found.met, found.max, roots.max);
    roots.met = roots.met || found.met;
    return found.met;
  }

  /// Sets the parameter `at` of the march to t, as the way there is proven empty. Returns the lanes that are
  /// to go farther: a march ends at the end of its line, and where no more of it is wanted.
  template <class B>
  M advance(B& at, M lanes, const B& t) const {
    at = select(lanes, t, at);
    return lanes && !(B(end_) <= t || B(stop_) <= t);
  }

  /// Returns t + h. In double-double the sum is rounded to double, so that a march may go on in double from
  /// there, unless h is below 2^-50 of t: then rounding could change the step by an eighth of it or more.
  [[nodiscard]] static R stepped(const R& t, const R& h) { return t + h; }
  [[nodiscard]] static DoubleDouble stepped(const DoubleDouble& t,
                                            double h) requires std::same_as<R, double> {
    const DoubleDouble next = t + DoubleDouble(h);
    return h < 0x1p-50 * std::abs(t.hi) ? next : DoubleDouble(next.hi);
  }

  /// Marches by balls. Returns the lanes where segments do better; F > 0 is proven where they stop, if they
  /// have moved at all. The field is inlined (flatten), here and in hit_proof.hpp: g++ 12 calls some of its
  /// operations otherwise, and vectors then go through memory.
  [[nodiscard, gnu::flatten]] M march_by_balls(M live) {
    using Rules = StepRules;
    const R error = line_.error(), reach = line_.reach(), extent = line_.extent(), bend = line_.bend();
    const bool bends = line_.is_bend_known();
    const R near = R(Rules::least_ball) * error * reach;
    R v = line_.value(t_, live), radius = (v - error) * reach, growth(0.0), next_try(infinity);
    R free = radius;  // distance behind t_ within which F > 0
    R failed(0.0), slow(0.0);
    M to_segments = live && !(radius > near);
    live = live && radius > near;
    FieldValue<R> first{t_, v}, second = first;  // at both ends, in lanes that wait for the secant method
    M is_turned_back = false;                    // lanes whose step was not covered go where it is free
    while (any(live)) {
      M tries_any = false, crosses_any = false;
      while (any(live)) {
        // There are branches where lanes mostly agree, so that one line alone does not wait for selections.
        const R ball = t_ + free;
        R t = rounding::min(t_ + rounding::max(radius * Rules::stretch(growth), free), end_);
        if (any(is_turned_back)) [[unlikely]]
          t = select(is_turned_back, ball, t);
        const M misses = live && !is_turned_back && t == end_ && ball >= end_;
        if (any(misses)) [[unlikely]] {
          const M by_ball = misses && t_ + radius >= end_;
          line_.proven(MarchProof::ball, by_ball, t_, end_);
          line_.proven(MarchProof::bend, misses && !by_ball, t_, end_);
          live = live && !misses;
          if (!any(live)) break;
        }
        const R next_v = line_.value(t, live), next_radius = (next_v - error) * reach;
        const M is_covered = is_turned_back || t - t_ <= free + next_radius;
        const M crosses = live && !is_covered && next_v < -error && failed < R(Rules::most_failed - 1);
        // At the border of a ball, F may be too near to 0 to be proven positive: then it stays behind.
        const M moves = live && is_covered && next_radius > R(0.0);
        M leaves = live && is_covered && !(next_radius > R(0.0));
        const M by_ball = moves && is_turned_back && t <= t_ + radius;
        const M by_two = moves && !is_turned_back && t - t_ <= radius + next_radius;
        is_turned_back = live && !is_covered && !crosses;
        const FieldValue<R> before{t_, v};
        M goes_on = false, tries = false;
        if (any(moves)) [[likely]] {
          const R gain = next_radius - radius, way = t - t_, last = growth;
          growth = select(moves, Rules::growth(gain, way), growth);  // first: the next t waits for it
          v = select(moves, next_v, v), radius = select(moves, next_radius, radius);
          line_.proven(MarchProof::ball, by_ball, t_, t);
          line_.proven(MarchProof::two_balls, by_two, t_, t);
          line_.proven(MarchProof::bend, moves && !by_ball && !by_two, t_, t);
          const R ahead =
              bends ? rounding::max(radius, Rules::free_behind(before.v, way, v, error, bend)) : radius;
          free = select(moves, ahead, free);
          goes_on = advance(t_, moves, t);
          const M is_slow = goes_on && radius < R(Rules::slow_ball) * extent;
          slow = select(is_slow, slow + R(1.0), slow);
          const M is_too_slow = is_slow && slow > R(Rules::most_slow);
          leaves = leaves || is_too_slow, goes_on = goes_on && !is_too_slow;
          const M is_near = bends
                                ? Rules::is_steep(growth, radius, reach, bend)
                                : Rules::is_straight(growth, last) || radius < R(Rules::secant_ball) * extent;
          tries = goes_on && growth < R(1.0) && is_near && radius < next_try && radius < extent;
        }
        if (any(tries || crosses)) [[unlikely]] {
          first = {select(tries || crosses, before.t, first.t), select(tries || crosses, before.v, first.v)};
          second = {select(tries || crosses, t, second.t), select(tries || crosses, next_v, second.v)};
          tries_any = tries_any || tries, crosses_any = crosses_any || crosses;
          goes_on = goes_on && !tries;
        }
        leaves = leaves || (goes_on && !(radius > near));
        to_segments = to_segments || leaves;
        live = (goes_on && !leaves) || is_turned_back;
      }
      const M asked = tries_any || crosses_any;
      if (!any(asked)) break;
      const M met = meet(root_by_secant(line_, asked, first, second), roots_);
      failed = select(asked && !met, failed + R(1.0), failed);
      next_try = select(tries_any, R(Rules::again) * radius, next_try);
      is_turned_back = crosses_any && !met;
      const M go_on = tries_any && !met && failed < R(Rules::most_failed) && radius > near;
      to_segments = to_segments || (tries_any && !met && !go_on);
      live = is_turned_back || go_on;
    }
    return to_segments;
  }

  /// Marches by segments from the parameter `at`, with enclosures in B, in the lanes `live`, until balls are
  /// faster again, B proves nothing more, a root is met, or the march ends. A segment is empty if enclosures
  /// of its values and slopes prove it (SegmentProof). It has one root if F falls all along and is below 0 at
  /// its end; narrowed_root narrows it. All other segments are halved.
  template <class B>
  [[nodiscard]] Segments march_by_segments(B& at, ProvenRoots<B, M>& roots, M live) {
    using E = Enclosure<B>;
    const B zero(0.0);
    const B start = at;
    const R begin(at), reach = line_.reach(), worth = R(StepRules::worth_balls) * line_.error();
    // A segment is as short as it can be at the last digits of t in double, or of points in double-double.
    const double digits = std::same_as<B, R> ? 0x1p-53 : 0;
    B least = line_.enclosed(at, live).lower;
    const M is_known = live && R(0.0) < known_;
    least = select(is_known && least < B(known_), B(known_), least);
    Segments after{.are_worth_balls = false, .fail = live && !(zero < least)};
    live = live && !after.fail;
    R h = select(is_known, R(0.5) * begin,
                 rounding::max(R(0x1p-50) * rounding::abs(begin), R(2.0) * static_cast<R>(least) * reach));
    M has_crossed = false;
    B crossed = at;
    for (int i = 0; i < StepRules::most_segments && any(live); ++i) {
      const B t = rounding::min(stepped(at, h), B(end_));
      const M is_stuck = live && !(at < t);
      after.fail = after.fail || is_stuck, live = live && !is_stuck;
      if (!any(live)) break;
      const Slope<E> over = line_.slope(at, t, live);
      const E right = line_.enclosed(t, live);
      const SegmentProof<B> proof(over, least, right.lower, E::at(t) - E::at(at));
      const M is_empty = live && proof.is_empty;
      const M crosses = live && !is_empty && over.slope.upper <= zero && right.upper < zero;
      const M is_halved = live && !is_empty && !crosses;
      crossed = select(crosses, t, crossed), has_crossed = has_crossed || crosses;
      least = select(is_empty, proof.at_end, least);
      known_ = select(is_empty, R(0.0), known_);
      line_.proven(MarchProof::segment, is_empty, at, t);
      const M goes_on = advance(at, is_empty, t);
      h = select(is_halved, R(0.5) * h, R(2.0) * h);
      const R proven = static_cast<R>(least);
      const M are_worth = goes_on && proven > worth && proven * reach > R(0.5) * h;
      after.are_worth_balls = after.are_worth_balls || are_worth;
      const M is_tiny = is_halved && h < R(digits) * rounding::abs(R(at)) + line_.resolution();
      after.fail = after.fail || is_tiny;
      live = (goes_on && !are_worth) || (is_halved && !is_tiny);
    }
    if (any(has_crossed)) {
      const M met = meet(narrowed_root(line_, has_crossed, at, crossed), roots);
      after.fail = after.fail || (has_crossed && !met);
    }
    const M comes_farther = R(at - start) > R(StepRules::least_progress) * line_.extent() ||
                            (begin >= R(0.0) && R(at) > R(2.0) * begin);
    const M creeps = live && !comes_farther;
    after.fail = after.fail || creeps;
    after.are_worth_balls = after.are_worth_balls || (live && !creeps);
    return after;
  }

  template <class T>
  static T select(M so, const T& a, const T& b) {
    return rounding::select(so, a, b);
  }
  static bool any(M so) { return rounding::any(so); }

  Line& line_;
  Begin begin_;
  R t_, known_, before_, end_;
  double stop_;
  ProvenRoots<R, M> roots_;
  Enclosure<DoubleDouble> enclosure_;
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

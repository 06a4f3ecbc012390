// Marches of several rays at once, each with the same bits as the march of its ray alone (march.hpp).
//
// The lanes take steps by balls, the secant method and the proof of the crossing together, and segments
// where balls are small. Each lane takes the steps that its ray takes alone. A lane waits while others go on.
// One that needs more than double leaves the packet: its ray goes on alone from where it is.
#pragma once

#include <bit>

#include "../simd/vectors.hpp"
#include "march.hpp"
#include "step_rules.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// March of the rays of a packet along a field from their origins on. None leaves the surface, and none is
/// mapped by an instance. Each evaluation in a lane is told to the trace as that of a single march.
template <class F, class Trace>
class PacketMarch {
 public:
  using Doubles = simd::Doubles;
  using LaneMask = simd::LaneMask;

  /// Crossings that are enclosed in [min, max], and what is left to be done for the other rays. A ray in none
  /// of the masks misses.
  struct Answer {
    LaneMask met = false;        ///< rays whose first crossing is proven
    LaneMask crosses = false;    ///< rays along which F falls from above 0 at `at` to below 0 at `max`
    LaneMask precisely = false;  ///< rays that go on alone from `at`, in double-double
    LaneMask alone = false;      ///< rays that have to begin anew, alone
    Doubles min = 0.0, max = 0.0;
    Doubles begin = 0.0, at = 0.0, end = 0.0;  ///< where the last look at balls was, the march is, and ends
  };

  /// Marches not farther than `stop`; nothing behind it is wanted.
  PacketMarch(const F& field, const MarchSetup& setup, const simd::Vectors& origin,
              const simd::Vectors& direction, double stop, Trace& trace)
      : field_(field),
        trace_(trace),
        origin_(origin),
        direction_(direction),
        span_(span_in(setup.inside, origin, direction)),
        scale_(setup, length(origin), length(direction),
               simd::max(simd::abs(span_.min), simd::abs(span_.max)), 0.0, 0.0),
        stop_(stop) {}

  /// Marches the active rays.
  [[nodiscard]] Answer march(LaneMask active) {
    const LaneMask is_known = scale_.error < infinity && is_finite(origin_) && is_finite(direction_);
    Answer answer{.alone = active && !is_known};
    const Doubles begin = simd::max(Doubles(0.0), span_.min);
    LaneMask live = active && is_known && span_.min < span_.max && begin < span_.max &&
                    simd::abs(span_.min) < infinity && span_.max < infinity && begin < stop_;
    answer.begin = answer.at = begin, answer.end = span_.max;
    if (!any(live)) return answer;
    Values at{begin, values(begin, live)};
    const LaneMask is_outside = at.v - (scale_.error + 0x1p-50 * simd::abs(at.v)) > 0.0;
    answer.alone = answer.alone || (live && !is_outside);
    live = live && is_outside;
    while (any(live)) {
      const LaneMask to_segments = march_by_balls(live, at, answer);
      live = any(to_segments) ? march_by_segments(to_segments, at, answer) : LaneMask(false);
      answer.begin = select(live, at.t, answer.begin);
    }
    answer.at = at.t;
    return answer;
  }

 private:
  /// A value of F in double at a parameter, in each lane.
  struct Values {
    Doubles t, v;
  };

  static LaneMask is_finite(const simd::Vectors& v) {
    const auto one = [](Doubles x) { return simd::abs(x) < infinity; };
    return one(v.x) && one(v.y) && one(v.z);
  }

  /// Returns the parameters inside a box, as inside_of does.
  static Span<Doubles> span_in(const Bounds& box, const simd::Vectors& origin,
                               const simd::Vectors& direction) {
    Span<Doubles> span;
    span.narrow(origin.x, direction.x, box.min.x, box.max.x);
    span.narrow(origin.y, direction.y, box.min.y, box.max.y);
    span.narrow(origin.z, direction.z, box.min.z, box.max.z);
    return span;
  }

  /// Returns F(t); the lanes that ask for it are told to the trace.
  [[nodiscard]] Doubles values(Doubles t, LaneMask asked) {
    for (simd::Bits left = bits(asked); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      trace_.evaluated(Evaluation::value, t[lane], t[lane]);
    }
    return plain_values(field_, origin_ + t * direction_);
  }

  /// Takes the steps of March::march_by_balls in each lane, from where F > 0 is proven, and those of
  /// root_by_secant. Returns the lanes where segments do better.
  [[nodiscard]] LaneMask march_by_balls(LaneMask live, Values& at, Answer& answer) {
    using Rules = StepRules;
    const Doubles error = scale_.error, reach = scale_.reach, extent = scale_.extent, end = span_.max;
    const Doubles near = Doubles(Rules::least_ball) * error * reach;
    Doubles radius = (at.v - error) * reach, stretch = 1.0, trend = -1.0, next_try = infinity, failed = 0.0,
            slow = 0.0;
    LaneMask to_segments = live && !(radius > near);
    live = live && radius > near;
    Values first = at, second = at;   // at both ends, in lanes that wait for the secant method
    LaneMask is_turned_back = false;  // lanes whose step was not covered: they take that of their ball
    while (any(live)) {
      LaneMask waits = false, has_crossed = false;
      while (any(live)) {
        const Doubles ball = at.t + radius, far = at.t + radius * stretch;
        const Doubles t = select(is_turned_back, ball, simd::min(far, end));
        live = live && !(!is_turned_back && t == end && ball >= end);  // the others miss
        if (!any(live)) break;
        const Values next{t, values(t, live)};
        const Doubles next_radius = (next.v - error) * reach;
        const LaneMask is_covered = is_turned_back || t - at.t <= radius + next_radius;
        const LaneMask crosses =
            live && !is_covered && next.v < -error && failed < Doubles(Rules::most_failed - 1);
        is_turned_back = live && !is_covered && !crosses;
        LaneMask moves = live && is_covered;
        const Doubles gain = next_radius - radius, way = t - at.t;
        const Doubles next_trend = Rules::trend(gain, way);
        const LaneMask is_straight = Rules::is_straight(next_trend, trend);
        const Values before = at;
        // At the border of a ball, F may be too near to 0 to be proven positive: then it stays behind.
        LaneMask leaves = moves && !(next_radius > 0.0);
        moves = moves && !leaves;
        at = {select(moves, next.t, at.t), select(moves, next.v, at.v)};
        radius = select(moves, next_radius, radius), trend = select(moves, next_trend, trend);
        stretch = select(moves, Rules::stretch(gain, way), stretch);
        moves = moves && !(t >= end || t >= stop_);
        const LaneMask is_slow = moves && radius < Rules::slow_ball * extent;
        slow = select(is_slow, slow + 1.0, slow);
        const LaneMask is_too_slow = is_slow && slow > Doubles(Rules::most_slow);
        moves = moves && !is_too_slow;
        const LaneMask tries = moves && trend < 0.0 &&
                               (is_straight || radius < Rules::secant_ball * extent) && radius < next_try &&
                               radius < extent;
        if (any(tries || crosses)) {
          first = {select(tries || crosses, before.t, first.t), select(tries || crosses, before.v, first.v)};
          second = {select(tries || crosses, next.t, second.t), select(tries || crosses, next.v, second.v)};
          has_crossed = has_crossed || crosses, waits = waits || tries;
          moves = moves && !tries;
        }
        leaves = leaves || is_too_slow || (moves && !(radius > near));
        to_segments = to_segments || leaves;
        live = (moves && !leaves) || is_turned_back;
      }
      const LaneMask asked = waits || has_crossed;
      if (!any(asked)) break;
      const LaneMask found = root_by_secant(asked, first, second, answer);
      answer.met = answer.met || found;
      failed = select(asked, failed + 1.0, failed);
      next_try = select(waits, Rules::again * radius, next_try);
      is_turned_back = has_crossed && !found;
      const LaneMask go_on = waits && !found && failed < Doubles(Rules::most_failed) && radius > near;
      to_segments = to_segments || (waits && !found && !go_on);
      live = is_turned_back || go_on;
    }
    return to_segments;
  }

  /// Takes the steps of March::march_by_segments in each lane. Returns the lanes where balls are faster
  /// again.
  [[nodiscard]] LaneMask march_by_segments(LaneMask live, Values& at, Answer& answer) {
    const Doubles error = scale_.error, reach = scale_.reach, end = span_.max, begin = at.t;
    const Doubles worth = Doubles(StepRules::worth_balls) * error;
    const auto below = [&](Doubles v) { return v - (error + 0x1p-50 * simd::abs(v)); };
    const auto above = [&](Doubles v) { return v + (error + 0x1p-50 * simd::abs(v)); };
    Doubles least = below(at.v);
    LaneMask to_balls = false, fails = live && !(least > 0.0);
    live = live && !fails;
    Doubles h = simd::max(0x1p-50 * simd::abs(at.t), 2.0 * least * reach);
    for (int i = 0; i < StepRules::most_segments && any(live); ++i) {
      const Doubles t = simd::min(at.t + h, end);
      const LaneMask is_stuck = live && !(t > at.t);
      fails = fails || is_stuck, live = live && !is_stuck;
      if (!any(live)) break;
      const Slope<Enclosure<Doubles>> over = over_segments(at.t, t, live);
      const Doubles v = values(t, live);
      using E = Enclosure<Doubles>;
      const SegmentProof<Doubles> proof(over, least, below(v), E::at(t) - E::at(at.t));
      const LaneMask is_empty = live && proof.is_empty;
      at = {select(is_empty, t, at.t), select(is_empty, v, at.v)};
      least = select(is_empty, proof.at_end, least);
      LaneMask goes_on = is_empty && !(t >= end || t >= stop_);  // the others miss
      const LaneMask has_crossed = live && !is_empty && over.slope.upper <= 0.0 && above(v) < 0.0;
      answer.max = select(has_crossed, t, answer.max);
      answer.crosses = answer.crosses || has_crossed;
      const LaneMask is_halved = live && !is_empty && !has_crossed;
      h = select(is_halved, 0.5 * h, 2.0 * h);
      const LaneMask are_worth = goes_on && least > worth && least * reach > 0.5 * h;
      to_balls = to_balls || are_worth, goes_on = goes_on && !are_worth;
      const LaneMask is_tiny = is_halved && h < 0x1p-53 * simd::abs(at.t) + scale_.resolution;
      fails = fails || is_tiny;
      live = goes_on || (is_halved && !is_tiny);
    }
    const LaneMask creeps = live && !(at.t - begin > Doubles(StepRules::least_progress) * scale_.extent);
    answer.precisely = answer.precisely || fails || creeps;
    return to_balls || (live && !creeps);
  }

  /// Takes the steps of root_by_secant, and proves the crossings. Returns the lanes where that succeeds.
  [[nodiscard]] LaneMask root_by_secant(LaneMask open, const Values& first, Values second, Answer& answer) {
    const Doubles error = scale_.error, start = select(second.v > 0.0, second.t, first.t);
    Doubles slope = (second.v - first.v) / (second.t - first.t), guess = second.t, steepness = slope;
    LaneMask ready = false;
    for (int i = 0; i < 8; ++i) {
      const Doubles next = second.t - second.v / slope;
      open = open && slope < 0.0 && start <= next && next < span_.max;
      LaneMask ends = simd::abs(second.v) <= 2.0 * error;
      if (i > 0) ends = ends || simd::abs(next - second.t) < 0x1p-30 * simd::abs(next);
      LaneMask goes_on = open && !ends;
      guess = select(open, next, guess), steepness = select(open, slope, steepness);
      ready = ready || (open && ends);
      if (!any(goes_on)) break;
      const Doubles v = values(next, goes_on);
      ends = v == second.v || next == second.t;
      ready = ready || (goes_on && ends);
      goes_on = goes_on && !ends;
      slope = select(goes_on, (v - second.v) / (next - second.t), slope);
      second = {select(goes_on, next, second.t), select(goes_on, v, second.v)};
      open = goes_on;
    }
    return any(ready) ? proven_root(ready, start, guess, steepness, answer) : ready;
  }

  /// Proves crossings as proven_root does, and sets their enclosures. Returns the lanes where that succeeds.
  [[nodiscard]] LaneMask proven_root(LaneMask open, Doubles start, Doubles guess, Doubles slope,
                                     Answer& answer) {
    const Doubles error = scale_.error;
    const Doubles least = simd::max(3.0 * error / -slope, 0x1p-50 * simd::abs(guess));
    Doubles last = guess, delta = least;
    LaneMask asks = open;
    for (int i = 0; i < 4 && any(asks); ++i, delta = delta * 4.0) {
      const Doubles t = simd::max(start, guess + delta);
      last = select(asks, t, last);
      asks = asks && !(values(t, asks) < -error);
    }
    open = open && !asks && last <= span_.max;
    if (!any(open)) return open;
    open = open && over_segments(start, last, open).slope.upper <= 0.0;
    Doubles min = start;
    asks = open, delta = least;
    for (int i = 0; i < 4 && any(asks); ++i, delta = delta * 4.0) {
      const Doubles t = simd::max(start, guess - delta);
      asks = asks && !(t == start);  // min is that already
      const LaneMask is_before = asks && values(t, asks) > error;
      min = select(is_before, t, min);
      asks = asks && !is_before;
    }
    open = open && last - min <= enclosure_width * simd::min(simd::abs(min), simd::abs(last));
    for (simd::Bits left = bits(open); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      trace_.proven(MarchProof::sign_change, min[lane], last[lane]);
    }
    answer.min = select(open, min, answer.min), answer.max = select(open, last, answer.max);
    return open;
  }

  /// Returns F over [a, b], and the slopes there, in each lane, as FieldLine::slope does.
  [[nodiscard]] Slope<Enclosure<Doubles>> over_segments(Doubles a, Doubles b, LaneMask asked) {
    for (simd::Bits left = bits(asked); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      trace_.evaluated(Evaluation::slope, a[lane], b[lane]);
    }
    using E = Enclosure<Doubles>;
    const E t{a, b};
    const auto coordinate = [&](Doubles o, Doubles d) {
      const E along = E::at(d);
      return Slope<E>{E::at(o) + t * along, along};
    };
    const Slope<E> f =
        field_(FieldPoint<Slope<E>>{coordinate(origin_.x, direction_.x), coordinate(origin_.y, direction_.y),
                                    coordinate(origin_.z, direction_.z)});
    return {f.value - E(0.0), f.slope};  // less the level, which is 0
  }

  const F& field_;
  Trace& trace_;
  simd::Vectors origin_, direction_;
  Span<Doubles> span_;
  LineScale<Doubles> scale_;
  double stop_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail

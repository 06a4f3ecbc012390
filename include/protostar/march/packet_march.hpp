// Marches of several rays at once, each with the bits of a march alone (march.hpp).
//
// The lanes take steps by balls, the secant method and the proof of the crossing together. Each lane takes
// the steps that its ray takes alone. A lane waits while others go on, and one that needs segments leaves the
// packet: its ray goes on alone from where it is.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>

#include "../simd/vectors.hpp"
#include "march.hpp"

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
    LaneMask met = false;          ///< rays whose first crossing is proven
    LaneMask to_segments = false;  ///< rays that balls have brought to `at`, and that go on by segments
    LaneMask alone = false;        ///< rays that have to begin anew, alone
    Doubles min = 0.0, max = 0.0;
    Doubles begin = 0.0, at = 0.0, end = 0.0;  ///< parameters where a march begins, is, and ends
  };

  /// Marches not farther than `stop`; nothing behind it is wanted.
  PacketMarch(const F& field, const MarchSetup& setup, const simd::Vectors& origin,
              const simd::Vectors& direction, double stop, Trace& trace)
      : field_(field), trace_(trace), origin_(origin), direction_(direction), stop_(stop) {
    set_span(setup.inside);
    // The formulas of FieldLine, whose comments derive them.
    const Doubles o = length(origin), d = length(direction);
    const Doubles T = simd::max(simd::abs(span_min_), simd::abs(span_max_));
    constexpr double u = 0x1p-53, more = 1 + 0x1p-40;
    const Doubles off = u * (2.0 * o + 6.0 * T * d);
    const double L = setup.bound.lipschitz;
    reach_ = Doubles(1 - 0x1p-40) / (L * d);
    error_ = select(off < setup.margin / 2 && d > 0x1p-450 && reach_ > 0.0 && reach_ < infinity,
                    (L * off + setup.bound.error) * more, Doubles(infinity));
    const Vec3 size = setup.inside.max - setup.inside.min;
    extent_ = Doubles(std::max({size.x, size.y, size.z})) / (2.0 * d);
  }

  /// Marches the active rays.
  [[nodiscard]] Answer march(LaneMask active) {
    const LaneMask is_known = error_ < infinity && is_finite(origin_) && is_finite(direction_);
    Answer answer{.alone = active && !is_known};
    const Doubles begin = simd::max(Doubles(0.0), span_min_);
    LaneMask live = active && is_known && span_min_ < span_max_ && begin < span_max_ &&
                    simd::abs(span_min_) < infinity && span_max_ < infinity && begin < stop_;
    answer.begin = answer.at = begin, answer.end = span_max_;
    if (any(live)) march_by_balls(live, answer);
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

  /// Sets the parameters inside a box, as inside_of does.
  void set_span(const Bounds& box) {
    span_min_ = -infinity, span_max_ = infinity;
    LaneMask is_empty = false;
    const auto narrow = [&](Doubles o, Doubles d, double low, double high) {
      const LaneMask is_along = d == 0.0;
      is_empty = is_empty || (is_along && !(low <= o && o <= high));
      const Doubles a = (low - o) / d, b = (high - o) / d;
      span_min_ = select(is_along, span_min_, simd::max(span_min_, simd::min(a, b)));
      span_max_ = select(is_along, span_max_, simd::min(span_max_, simd::max(a, b)));
    };
    narrow(origin_.x, direction_.x, box.min.x, box.max.x);
    narrow(origin_.y, direction_.y, box.min.y, box.max.y);
    narrow(origin_.z, direction_.z, box.min.z, box.max.z);
    span_max_ = select(is_empty, Doubles(-infinity), span_max_);
  }

  /// Returns F(t); the lanes that ask for it are told to the trace.
  [[nodiscard]] Doubles values(Doubles t, LaneMask asked) {
    for (simd::Bits left = bits(asked); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      trace_.evaluated(Evaluation::value, t[lane], t[lane]);
    }
    return plain_values(field_, origin_ + t * direction_);
  }

  /// Takes the steps of March::march_by_balls in each lane, and those of root_by_secant.
  void march_by_balls(LaneMask live, Answer& answer) {
    const Doubles error = error_, reach = reach_, extent = extent_, end = span_max_;
    const Doubles near = 64.0 * error * reach;
    Values at{answer.begin, values(answer.begin, live)};
    const LaneMask is_outside = at.v - (error + 0x1p-50 * simd::abs(at.v)) > 0.0;
    answer.alone = answer.alone || (live && !is_outside);
    live = live && is_outside;
    Doubles radius = (at.v - error) * reach, trend = -1.0, next_try = infinity, failed = 0.0, slow = 0.0;
    const LaneMask are_balls = radius > near;
    answer.to_segments = live && !are_balls;
    live = live && are_balls;
    Values first = at, second = at;   // at both ends, in lanes that wait for the secant method
    LaneMask is_turned_back = false;  // lanes whose step was not covered: they take that of their ball
    while (any(live)) {
      LaneMask waits = false, has_crossed = false;
      while (any(live)) {
        const Doubles ball = at.t + radius;
        const Doubles far = at.t + radius * (1.0 + 0.9 * (1.0 + trend) / (1.0 - trend));
        const Doubles t = select(is_turned_back, ball, simd::min(far, end));
        live = live && !(!is_turned_back && t == end && ball >= end);  // the others miss
        if (!any(live)) break;
        const Values next{t, values(t, live)};
        const Doubles next_radius = (next.v - error) * reach;
        const LaneMask is_covered = is_turned_back || t - at.t <= radius + next_radius;
        const LaneMask crosses = live && !is_covered && next.v < -error && failed < 2.0;
        is_turned_back = live && !is_covered && !crosses;
        first = {select(crosses, at.t, first.t), select(crosses, at.v, first.v)};
        second = {select(crosses, next.t, second.t), select(crosses, next.v, second.v)};
        has_crossed = has_crossed || crosses;

        LaneMask moves = live && is_covered;
        const Doubles change = (next_radius - radius) / (t - at.t);
        const Doubles slope = simd::select(change < -0.999, Doubles(-0.999), simd::min(change, Doubles(0.9)));
        const LaneMask is_straight = slope < -0.02 && simd::abs(slope - trend) < -0.25 * slope;
        const Values before = at;
        at = {select(moves, next.t, at.t), select(moves, next.v, at.v)};
        radius = select(moves, next_radius, radius), trend = select(moves, slope, trend);
        LaneMask leaves = moves && !(radius > 0.0);
        moves = moves && !leaves;
        answer.at = select(moves, t, answer.at);
        moves = moves && !(t >= end || t >= stop_);
        const LaneMask is_slow = moves && radius < 0.02 * extent;
        slow = select(is_slow, slow + 1.0, slow);
        const LaneMask is_too_slow = is_slow && slow > 12.0;
        moves = moves && !is_too_slow;
        const LaneMask tries = moves && trend < 0.0 && (is_straight || radius < 0.01 * extent) &&
                               radius < next_try && radius < extent;
        first = {select(tries, before.t, first.t), select(tries, before.v, first.v)};
        second = {select(tries, at.t, second.t), select(tries, at.v, second.v)};
        waits = waits || tries;
        moves = moves && !tries;
        leaves = leaves || is_too_slow || (moves && !(radius > near));
        answer.to_segments = answer.to_segments || leaves;
        live = (moves && !leaves) || is_turned_back;
      }
      const LaneMask asked = waits || has_crossed;
      if (!any(asked)) return;
      const LaneMask found = root_by_secant(asked, first, second, answer);
      answer.met = answer.met || found;
      failed = select(asked, failed + 1.0, failed);
      next_try = select(waits, 0.25 * radius, next_try);
      is_turned_back = has_crossed && !found;
      const LaneMask go_on = waits && !found && failed < 3.0 && radius > near;
      answer.to_segments = answer.to_segments || (waits && !found && !go_on);
      live = is_turned_back || go_on;
    }
  }

  /// Takes the steps of root_by_secant, and proves the crossings. Returns the lanes where that succeeds.
  [[nodiscard]] LaneMask root_by_secant(LaneMask open, const Values& first, Values second, Answer& answer) {
    const Doubles error = error_, start = select(second.v > 0.0, second.t, first.t);
    Doubles slope = (second.v - first.v) / (second.t - first.t), guess = second.t, steepness = slope;
    LaneMask ready = false;
    for (int i = 0; i < 8; ++i) {
      const Doubles next = second.t - second.v / slope;
      open = open && slope < 0.0 && start <= next && next < span_max_;
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
    const Doubles error = error_;
    const Doubles least = simd::max(3.0 * error / -slope, 0x1p-50 * simd::abs(guess));
    Doubles last = guess, delta = least;
    LaneMask asks = open;
    for (int i = 0; i < 4 && any(asks); ++i, delta = delta * 4.0) {
      const Doubles t = simd::max(start, guess + delta);
      last = select(asks, t, last);
      asks = asks && !(values(t, asks) < -error);
    }
    open = open && !asks;
    if (!any(open)) return open;
    open = open && slopes_over(start, last, open).upper <= 0.0;
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

  /// Returns the slopes over [a, b] in each lane.
  [[nodiscard]] Enclosure<Doubles> slopes_over(Doubles a, Doubles b, LaneMask asked) {
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
    return f.slope;
  }

  const F& field_;
  Trace& trace_;
  simd::Vectors origin_, direction_;
  Doubles span_min_, span_max_, error_, reach_, extent_;
  double stop_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail

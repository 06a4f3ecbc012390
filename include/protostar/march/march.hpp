// A march along a ray that proves each of its steps: to the first crossing with a surface, or past it.
//
// Far from the surface, values in double prove balls empty, whose radii are (v − E) / (L |d|) along the ray.
// Steps are longer than a radius where the radius grows or shrinks steadily (over-relaxation), and they count
// if the balls at both ends cover what is between them. Near the surface, where balls are small, an enclosure
// of value and slope proves a whole segment. Segments double where they succeed and are halved where they
// fail, so that a ray which passes at a distance g takes about log 1/g of them. Double-double decides
// where double cannot.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "hit_proof.hpp"
#include "step_rules.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// March along one line, from where F > 0 to its first root.
template <class Line>
class March {
 public:
  /// Starts at t, up to which no root is left, and where F is at least `known`, if that is above 0. A march
  /// to `end` proves a miss; one that comes to `stop` goes no farther, since no root behind it is wanted. The
  /// steps, and with them the digits of the root, do not depend on `stop`.
  March(Line& line, double t, double known, double end, double stop)
      : line_(line), t_(t), known_(known), end_(end), stop_(stop) {}

  /// Returns the first root.
  [[nodiscard]] MarchedRoot root() { return root_from(t_, known_ > 0 ? Next::segment : Next::ball); }

  /// Returns the first root of a march in which F is proven to fall over [t, end of segment] and to change
  /// its sign. The last look at balls was at `before`.
  [[nodiscard]] MarchedRoot root_in_segment(double before, double end_of_segment) {
    const auto root = narrowed_root<double>(line_, t_, end_of_segment);
    return root && finish(*root) ? root_ : precise_root(before);
  }

  /// Returns the first root of a march that goes on in double-double. The last look at balls was at `before`.
  [[nodiscard]] MarchedRoot precise_root(double before) { return root_from(before, Next::precise_segment); }

 private:
  using Answer = MarchedRoot::Answer;

  /// Step with which a march goes on.
  enum class Next : std::uint8_t { ball, segment, precise_segment };

  [[nodiscard]] MarchedRoot root_from(double before, Next next) {
    for (;;) {
      if (next != Next::ball || !march_by_balls()) {
        const bool is_in_double = next != Next::precise_segment;
        if (!is_done() && !(is_in_double && march_by_segments<double>()) && !is_done() &&
            !march_by_segments<DoubleDouble>())
          return undecided();
      }
      if (is_done()) return root_;
      if (!(t_ > before)) return undecided();
      before = t_, next = known_ > 0 ? Next::segment : Next::ball;
    }
  }

  [[nodiscard]] bool is_done() const { return is_done_; }

  /// Ends the march with a root, or with a miss.
  bool finish(const MarchedRoot& root = {}) {
    root_ = root;
    if (root.answer == Answer::hit) line_.trace().proven(MarchProof::sign_change, root.min, root.max);
    return is_done_ = true;
  }

  [[nodiscard]] MarchedRoot undecided() {
    ++fallbacks.undecided;
    line_.trace().proven(MarchProof::touch, t_, t_);
    return {Answer::undecided, t_, t_};
  }

  /// Goes on to t, as the way there is proven empty; ends the march there if no more of the ray is wanted.
  bool advance_to(double t, MarchProof proof) {
    line_.trace().proven(proof, t_, t);
    t_ = t;
    return t >= end_ || t >= stop_ ? finish() : false;
  }

  /// Marches by balls until the march ends, and returns true, or until segments do better. F(t) > 0 is proven
  /// where it stops, if it has moved at all.
  [[nodiscard]] bool march_by_balls() {
    using Rules = StepRules;
    const double error = line_.error(), reach = line_.reach(), extent = line_.extent();
    FieldValue at{t_, line_.value(t_)};
    double radius = (at.v - error) * reach, stretch = 1, trend = -1, next_try = infinity;
    int failed = 0, slow = 0;
    while (radius > Rules::least_ball * error * reach) {
      double t = std::min(at.t + radius * stretch, end_);
      if (t == end_ && at.t + radius >= end_) return advance_to(end_, MarchProof::ball);
      FieldValue next{t, line_.value(t)};
      double next_radius = (next.v - error) * reach;
      MarchProof proof = MarchProof::two_balls;
      if (!(t - at.t <= radius + next_radius)) {
        if (next.v < -error && failed < Rules::most_failed - 1) {
          if (const auto root = root_by_secant(line_, at, next, end_)) return finish(*root);
          ++failed;
        }
        t = at.t + radius;
        next = {t, line_.value(t)};
        next_radius = (next.v - error) * reach;
        proof = MarchProof::ball;
      }
      const double gain = next_radius - radius, way = t - at.t;
      const double last = std::exchange(trend, Rules::trend(gain, way));
      const FieldValue before = at;
      at = next, radius = next_radius, stretch = Rules::stretch(gain, way);
      // At the border of a ball, F may be too near to 0 to be proven positive: then it stays behind.
      if (!(radius > 0)) return false;
      if (advance_to(t, proof)) return true;
      if (radius < Rules::slow_ball * extent && ++slow > Rules::most_slow) return false;
      const bool is_near = Rules::is_straight(trend, last) || radius < Rules::secant_ball * extent;
      if (trend < 0 && is_near && radius < next_try && radius < extent) {
        if (const auto root = root_by_secant(line_, before, at, end_)) return finish(*root);
        next_try = Rules::again * radius;
        if (++failed >= Rules::most_failed) return false;
      }
    }
    return false;
  }

  /// Marches by segments until the march ends or balls are faster again, and returns true, or until this
  /// precision proves nothing more.
  template <class B>
  [[nodiscard]] bool march_by_segments() {
    using E = Enclosure<B>;
    const B zero(0.0);
    const double begin = t_;
    E at = line_.enclosed(B(t_));
    const bool is_known = known_ > 0;
    if (is_known && at.lower < B(known_)) at.lower = B(known_);
    if (!(zero < at.lower)) return false;
    const double reach = line_.reach(), worth = StepRules::worth_balls * line_.error();
    double h =
        is_known ? 0.5 * t_ : std::max(2 * static_cast<double>(at.lower) * reach, 0x1p-50 * std::abs(t_));
    for (int i = 0; i < StepRules::most_segments; ++i) {
      const double t = std::min(t_ + h, end_);
      if (!(t > t_)) return false;
      const Slope<Enclosure<B>> over = line_.slope(B(t_), B(t));
      E right = line_.enclosed(B(t));
      const E width = E::at(B(t)) - E::at(B(t_));
      const SegmentProof<B> proof(over, at.lower, right.lower, width);
      if (proof.is_empty) {
        right.lower = proof.at_end;
        known_ = 0;
        if (advance_to(t, MarchProof::segment)) return true;
        at = right;
        h *= 2;
        const double proven = static_cast<double>(at.lower);
        if (proven > worth && proven * reach > 0.5 * h) return true;
        continue;
      }
      if (over.slope.upper <= zero && right.upper < zero) {
        const auto root = narrowed_root<B>(line_, t_, t);
        return root && finish(*root);
      }
      h *= 0.5;
      if (h < 0x1p-53 * std::abs(t_) + line_.resolution()) return false;
    }
    return t_ - begin > StepRules::least_progress * line_.extent();
  }

  Line& line_;
  double t_, known_, end_, stop_;
  MarchedRoot root_{};
  bool is_done_ = false;
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

// A march along a ray that proves each of its steps: to the first crossing with a surface, or past it.
//
// Far from the surface, values in double prove balls empty, whose radii are (v − E) / (L |d|) along the ray.
// Steps are longer than a radius where the radius grows or shrinks steadily (over-relaxation), and they count
// if the balls at both ends cover what is between them. Near the surface, where balls are small, an enclosure
// of value and slope proves a whole segment. Segments double where they succeed and are halved where they
// fail, so that a ray which passes at a distance g takes about log 1/g of them. Double-double tells what
// double does not.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "hit_proof.hpp"

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
  [[nodiscard]] MarchedRoot root() { return root_from(t_, known_ > 0); }

  /// Returns the first root of a march that has come here from `before`, and that goes on by segments or by
  /// balls.
  [[nodiscard]] MarchedRoot root_from(double before, bool by_segments) {
    for (;;) {
      if (by_segments || !march_by_balls()) {
        if (!is_done() && !march_by_segments<double>() && !is_done() && !march_by_segments<DoubleDouble>())
          return undecided();
      }
      if (is_done()) return root_;
      if (!(t_ > before)) return undecided();
      before = t_, by_segments = known_ > 0;
    }
  }

 private:
  using Answer = MarchedRoot::Answer;

  /// Most segments of a march between two looks at balls. A march that they do not bring farther by
  /// least_progress of the extent creeps: in double it goes on in double-double, and there it is undecided.
  /// The two are not derived: they bound the time of a march, to 2^9 times as many segments in each
  /// precision.
  static constexpr int most_segments = 3000;
  static constexpr double least_progress = 0x1p-8;

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
  ///
  /// The lengths of steps, and when others try, are choices for speed, measured and not derived. They move
  /// the last digits of t, and prove nothing: each step counts by its balls alone.
  [[nodiscard]] bool march_by_balls() {
    const double error = line_.error(), reach = line_.reach(), extent = line_.extent();
    // Balls that are hardly larger than their error: it takes 1/65 or more from the radius of a smaller one.
    const double near = 64 * error * reach;
    FieldValue at{t_, line_.value(t_)};
    double radius = (at.v - error) * reach, trend = -1, next_try = infinity;
    int failed = 0, slow = 0;
    while (radius > near) {
      // At a trend of −1, as on the way to a plane, the next ball touches the root: the step is the radius.
      double t = std::min(at.t + radius * (1 + 0.9 * (1 + trend) / (1 - trend)), end_);
      if (t == end_ && at.t + radius >= end_) return advance_to(end_, MarchProof::ball);
      FieldValue next{t, line_.value(t)};
      double next_radius = (next.v - error) * reach;
      MarchProof proof = MarchProof::two_balls;
      if (!(t - at.t <= radius + next_radius)) {
        if (next.v < -error && failed < 2) {
          if (const auto root = root_by_secant(line_, at, next, end_)) return finish(*root);
          ++failed;
        }
        t = at.t + radius;
        next = {t, line_.value(t)};
        next_radius = (next.v - error) * reach;
        proof = MarchProof::ball;
      }
      const double slope = std::clamp((next_radius - radius) / (t - at.t), -0.999, 0.9);
      const bool is_straight = slope < -0.02 && std::abs(slope - trend) < -0.25 * slope;
      const FieldValue before = at;
      at = next, radius = next_radius, trend = slope;
      // At the border of a ball, F may be too near to 0 to be proven positive: then it stays behind.
      if (!(radius > 0)) return false;
      if (advance_to(t, proof)) return true;
      if (radius < 0.02 * extent && ++slow > 12) return false;
      if (trend < 0 && (is_straight || radius < 0.01 * extent) && radius < next_try && radius < extent) {
        if (const auto root = root_by_secant(line_, before, at, end_)) return finish(*root);
        next_try = 0.25 * radius;
        if (++failed >= 3) return false;
      }
    }
    return false;
  }

  /// Returns a lower bound of F over a segment of a width, given F at both ends, and over the segment. F lies
  /// above its range; above the line of the steepest fall from the left end; above that of the steepest rise
  /// to the right end; and hence above the point at which the two meet, which is
  /// (hi F₀ − lo F₁ + lo hi width) / (hi − lo). Only the sign of that counts: it stands for the bound.
  template <class B>
  [[nodiscard]] static B least(const Slope<Enclosure<B>>& over, const Enclosure<B>& left,
                               const Enclosure<B>& right, const Enclosure<B>& width) {
    using E = Enclosure<B>;
    const B zero(0.0), lo = over.slope.lower, hi = over.slope.upper;
    B low = over.value.lower;
    const auto raise = [&](const B& bound) {
      if (low < bound) low = bound;
    };
    if (zero <= lo) {
      raise(left.lower);
    } else if (hi <= zero) {
      raise(right.lower);
    } else {
      raise((E::at(left.lower) + E::at(lo) * width).lower);
      raise((E::at(right.lower) - E::at(hi) * width).lower);
      const auto meeting =
          E::at(hi) * E::at(left.lower) - E::at(lo) * E::at(right.lower) + E::at(lo) * E::at(hi) * width;
      if (zero < left.lower && zero < right.lower && zero < meeting.lower) raise(B(0x1p-1000));
    }
    return low;
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
    // Balls take over where the bound of F is above 128 errors: then a value is above 127, and its ball of a
    // radius above 126 is not left again at once as one of less than 64 (march_by_balls).
    const double reach = line_.reach(), worth = 128 * line_.error();
    double h =
        is_known ? 0.5 * t_ : std::max(2 * static_cast<double>(at.lower) * reach, 0x1p-50 * std::abs(t_));
    for (int i = 0; i < most_segments; ++i) {
      const double t = std::min(t_ + h, end_);
      if (!(t > t_)) return false;
      const Slope<Enclosure<B>> over = line_.slope(B(t_), B(t));
      E right = line_.enclosed(B(t));
      const E width = E::at(B(t)) - E::at(B(t_));
      const B low = least(over, at, right, width);
      if (zero < low) {
        const B carried = (E::at(at.lower) + E::at(over.slope.lower) * width).lower;
        for (const B& bound : {low, carried})
          if (right.lower < bound) right.lower = bound;
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
    return t_ - begin > least_progress * line_.extent();
  }

  Line& line_;
  double t_, known_, end_, stop_;
  MarchedRoot root_{};
  bool is_done_ = false;
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

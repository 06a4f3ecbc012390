// Judge of a march: proves by subdivision that a field is above 0 up to the enclosure of a crossing and below
// 0 behind it, or above 0 all along, or that neither is so.
#pragma once

#include <protostar/march/hit_proof.hpp>
#include <utility>
#include <vector>

#include "true_fields.hpp"

namespace marching {

enum class Verdict {
  right,
  missed,     ///< there is a crossing where the march found none
  not_there,  ///< there is no crossing; on a ray that leaves the surface, acne
  off,        ///< the first crossing is not in the enclosure
  along,      ///< the ray runs in the surface, or in the level set that it leaves
  unknown     ///< the judge's digits do not tell
};

/// Ray with what a march says of it.
struct Claim {
  protostar::Ray ray;
  bool leaves = false;        ///< the ray starts at the surface, and the level is the value there
  double begin = 0, end = 0;  /// part of the ray that contains all of the surface
  protostar::MarchedRoot root;
};

/// A truth along a ray, turned so that it is above 0 at first.
template <class Truth, class T>
class TrueLine {
 public:
  enum class Sign { positive, negative, unknown, along };

  TrueLine(const Truth& truth, const Claim& claim)
      : truth_(truth), ray_(claim.ray), begin_(claim.begin), leaves_(claim.leaves) {
    if (leaves_) level_ = Range<T>::from(over<Quad>(0, 0, {}).v);
  }

  /// Turns the truth, and returns the end of what lies before the first root for certain: `begin`, or for a
  /// ray that leaves the surface a parameter up to which the slope is above 0. Returns a negative number if
  /// no sign is certain.
  [[nodiscard]] T start(T end) {
    const auto turned = [&](const Range<T>& x) {
      is_negative_ = x.hi < 0;
      return x.lo > 0 || x.hi < 0;
    };
    if (!leaves_) return turned(at(begin_, begin_).v) ? begin_ : T(-1);
    for (T h = end; h > (std::same_as<T, double> ? T(1e-12) : T(1e-30)); h /= 8)
      if (turned(at(0, h).s)) return h;
    return -1;
  }
  void turn(bool is_negative) { is_negative_ = is_negative; }
  [[nodiscard]] bool is_turned() const { return is_negative_; }

  [[nodiscard]] Along<T> at(T a, T b) const {
    const Along<T> f = over<T>(a, b, level_);
    return is_negative_ ? -f : f;
  }

  /// Returns the sign at a point.
  [[nodiscard]] Sign sign_at(T t) const {
    const Range<T> v = at(t, t).v;
    return v.lo > 0 ? Sign::positive : v.hi < 0 ? Sign::negative : Sign::unknown;
  }

  /// Returns `positive` if the truth is above 0 all over the parts, and `negative` if it is below 0
  /// somewhere. Parts that are not decided are left, the others taken.
  [[nodiscard]] Sign sign_over(std::vector<std::pair<T, T>>& parts) const {
    constexpr bool is_quick = std::same_as<T, double>;
    std::vector<std::pair<T, T>> open;
    Sign sign = Sign::positive;
    for (int i = 0; !parts.empty(); ++i) {
      const auto [a, b] = parts.back();
      parts.pop_back();
      const Sign here = sign_of(a, b);
      if (here == Sign::positive) continue;
      if (here == Sign::negative) return here;
      const T middle = (a + b) / 2;
      if (here == Sign::along || i > (is_quick ? 400 : 20000) ||
          b - a < (is_quick ? T(0x1p-30) : T(0x1p-95))) {
        if (sign != Sign::along) sign = here;
        open.push_back({a, b});
        continue;
      }
      parts.push_back({middle, b});
      parts.push_back({a, middle});
    }
    parts = std::move(open);
    return sign;
  }

 private:
  template <class N>
  [[nodiscard]] Along<N> over(N a, N b, const Range<N>& level) const {
    const Range<N> t{a, b};
    const auto coordinate = [&](int k) {
      const Range<N> o(N(ray_.origin[k])), d(N(ray_.direction[k]));
      return Along<N>{t.is_zero() ? o : o + t * d, d};
    };
    return truth_(coordinate(0), coordinate(1), coordinate(2)) - Along<N>{level, {}};
  }

  /// Returns the sign over [a, b]. It is above 0 if its values are, or it is at both ends and the slopes,
  /// from lo to hi, have one sign or are too flat: F lies above the lines from both ends, which meet at (hi
  /// F(a) − lo F(b) + lo hi (b − a)) / (hi − lo).
  [[nodiscard]] Sign sign_of(T a, T b) const {
    const Along<T> all = at(a, b);
    if (all.v.lo > 0) return Sign::positive;
    if (all.v.hi < 0) return Sign::negative;
    const Range<T> first = at(a, a).v, last = at(b, b).v;
    if (first.hi < 0 || last.hi < 0) return Sign::negative;
    const auto& [lo, hi] = all.s;
    if (lo >= 0 && first.lo > 0) return Sign::positive;
    if (hi <= 0 && last.lo > 0) return Sign::positive;
    if (first.lo > 0 && last.lo > 0) {
      using R = Range<T>;
      const R meeting = R(hi) * R(first.lo) - R(lo) * R(last.lo) + R(lo) * R(hi) * (R(b) - R(a));
      if (meeting.lo > 0) return Sign::positive;
    }
    return all.s.is_zero() ? Sign::along : Sign::unknown;
  }

  const Truth& truth_;
  const protostar::Ray& ray_;
  Range<T> level_;
  T begin_;
  bool leaves_, is_negative_ = false;
};

/// Judge of the claims about one truth, first in double, and where that does not tell, in Quad.
template <class Truth>
class Judge {
 public:
  explicit Judge(const Truth& truth) : truth_(truth) {}

  [[nodiscard]] Verdict verdict(const Claim& claim) const {
    using Answer = protostar::MarchedRoot::Answer;
    using Sign = typename TrueLine<Truth, double>::Sign;
    Lines lines{{truth_, claim}, {truth_, claim}};
    Quad start = lines.quick.start(claim.end);
    if (start >= 0) {
      lines.precise.turn(lines.quick.is_turned());
    } else {
      start = lines.precise.start(claim.end);
      if (start < 0) return lines.precise.at(0, Quad(1e-30)).s.is_zero() ? Verdict::along : Verdict::unknown;
      lines.quick.turn(lines.precise.is_turned());
    }
    const bool is_hit = claim.root.answer == Answer::hit;
    const auto not_told = [](Sign sign) { return sign == Sign::along ? Verdict::along : Verdict::unknown; };
    switch (const Sign sign = over(lines, start, is_hit ? claim.root.min : claim.end)) {
      case Sign::positive:
        break;
      case Sign::negative:
        return is_hit ? Verdict::off : Verdict::missed;
      default:
        return not_told(sign);
    }
    if (!is_hit) return Verdict::right;
    Sign behind = lines.quick.sign_at(claim.root.max);
    if (behind == Sign::unknown) behind = sign_of(lines.precise.sign_at(claim.root.max));
    if (behind == Sign::negative) return Verdict::right;
    if (behind == Sign::unknown) return Verdict::unknown;
    const Sign rest = over(lines, start, claim.end);
    return rest == Sign::positive   ? Verdict::not_there
           : rest == Sign::negative ? Verdict::off
                                    : not_told(rest);
  }

  /// Returns true if the truth is 0 behind the place of an answer, to all digits, and so is its slope: the
  /// ray lies in a face.
  [[nodiscard]] bool runs_in_surface(const Claim& claim) const {
    const Quad t = claim.root.max, more = Quad(0x1p-40);
    const Along<Quad> f = TrueLine<Truth, Quad>(truth_, claim).at(t + more, t + 2 * more);
    return f.s.is_zero() && f.v.lo <= 0 && 0 <= f.v.hi;
  }

  /// Returns the magnitude of the truth at a parameter, at most.
  [[nodiscard]] double largest_at(const Claim& claim, double t) const {
    const Range<Quad> v = TrueLine<Truth, Quad>(truth_, claim).at(t, t).v;
    return static_cast<double>(std::max(-v.lo, v.hi));
  }

 private:
  struct Lines {
    TrueLine<Truth, double> quick;
    TrueLine<Truth, Quad> precise;
  };

  static typename TrueLine<Truth, double>::Sign sign_of(typename TrueLine<Truth, Quad>::Sign sign) {
    return static_cast<typename TrueLine<Truth, double>::Sign>(sign);
  }

  /// Returns the sign between two parameters. Doubles are not before the first, and not behind the second.
  static auto over(const Lines& lines, Quad from, Quad to) {
    using Sign = typename TrueLine<Truth, double>::Sign;
    if (!(from < to)) return Sign::positive;
    std::vector<std::pair<Quad, Quad>> open;
    auto first = static_cast<double>(from), last = static_cast<double>(to);
    if (first < from) first = ranges::above(first);
    if (last > to) last = ranges::below(last);
    if (first < last) {
      std::vector<std::pair<double, double>> parts{{first, last}};
      const Sign sign = lines.quick.sign_over(parts);
      if (sign == Sign::negative) return sign;
      for (const auto& [a, b] : parts) open.push_back({a, b});
      if (from < first) open.push_back({from, first});
      if (last < to) open.push_back({last, to});
    } else {
      open.push_back({from, to});
    }
    return sign_of(lines.precise.sign_over(open));
  }

  const Truth& truth_;
};

}  // namespace marching

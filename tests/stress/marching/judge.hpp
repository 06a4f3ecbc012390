// Judge of a march: proves by subdivision that a field is above 0 up to the enclosure of a crossing and below
// 0 behind it, or above 0 all along, or that neither is so.
#pragma once

#include <optional>
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

/// End of a part of a ray that has no root but a departure at 0, and the sign of the truth there.
struct Start {
  double t;
  bool is_negative;
};

/// Limits of a subdivision in numbers of type T. Parts that it leaves open are asked in the next type, which
/// has more digits.
struct Tier {
  int most_steps;
  double least_width;  ///< of a part
};
template <class T>
inline constexpr Tier tier{20000, 0x1p-95};
template <>
inline constexpr Tier tier<double>{400, 0x1p-30};
template <>
inline constexpr Tier tier<long double>{60, 0x1p-40};

enum class Sign { positive, negative, unknown, along };

/// Parts of a ray, each from one parameter to another.
template <class T>
using Parts = std::vector<std::pair<T, T>>;

/// A truth along a ray, turned so that it is above 0 at first.
template <class Truth, class T>
class TrueLine {
 public:
  TrueLine(const Truth& truth, const Claim& claim, const Range<Quad>& level)
      : truth_(truth),
        ray_(claim.ray),
        level_(Range<T>::from(level)),
        begin_(claim.begin),
        leaves_(claim.leaves) {}

  /// Returns the end of what lies before the first root for certain: `begin`, or for a ray that leaves the
  /// surface a parameter above `least` up to which the slope has one sign. Returns nothing if no sign is
  /// certain.
  [[nodiscard]] std::optional<Start> start(double end, double least) const {
    const auto start_if_signed = [](double t, const Range<T>& x) {
      return x.lo > 0 || x.hi < 0 ? std::optional(Start{t, x.hi < 0}) : std::nullopt;
    };
    if (!leaves_) return start_if_signed(begin_, at(T(begin_), T(begin_)).v);
    for (double h = end; h > least; h /= 8)
      if (const auto found = start_if_signed(h, at(T(0), T(h)).s)) return found;
    return {};
  }
  void turn(bool is_negative) { is_negative_ = is_negative; }

  [[nodiscard]] Along<T> at(T a, T b) const {
    const Along<T> f = over(a, b);
    return is_negative_ ? -f : f;
  }

  /// Returns the sign at a point.
  [[nodiscard]] Sign sign_at(T t) const {
    const Range<T> v = at(t, t).v;
    return v.lo > 0 ? Sign::positive : v.hi < 0 ? Sign::negative : Sign::unknown;
  }

  /// Returns `positive` if the truth is above 0 all over the parts, and `negative` if it is below 0
  /// somewhere. Parts that are not decided are left, neighbors as one, and the others taken.
  [[nodiscard]] Sign sign_over(Parts<T>& parts) const {
    Parts<T> open;
    Sign sign = Sign::positive;
    for (int i = 0; !parts.empty(); ++i) {
      const auto [a, b] = parts.back();
      parts.pop_back();
      const Sign here = sign_of(a, b);
      if (here == Sign::positive) continue;
      if (here == Sign::negative) return here;
      const T middle = (a + b) / 2;
      if (here == Sign::along || i > tier<T>.most_steps || b - a < T(tier<T>.least_width)) {
        if (sign != Sign::along) sign = here;
        if (!open.empty() && open.back().second == a)
          open.back().second = b;
        else
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
  [[nodiscard]] Along<T> over(T a, T b) const {
    const Range<T> t{a, b};
    const auto coordinate = [&](int k) {
      const Range<T> o(T(ray_.origin[k])), d(T(ray_.direction[k]));
      return Along<T>{t.is_zero() ? o : o + t * d, d};
    };
    return truth_(coordinate(0), coordinate(1), coordinate(2)) - Along<T>{level_, {}};
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
  double begin_;
  bool leaves_, is_negative_ = false;
};

/// Judge of the claims about one truth, in double; where that does not tell, in long double; and where that
/// does not tell either, in Quad.
template <class Truth>
class Judge {
 public:
  explicit Judge(const Truth& truth) : truth_(truth) {}

  [[nodiscard]] Verdict verdict(const Claim& claim) const {
    using Answer = protostar::MarchedRoot::Answer;
    Lines lines(truth_, claim);
    const std::optional<Start> start = lines.start(claim.end);
    if (!start) return lines.precise.at(0, Quad(1e-30)).s.is_zero() ? Verdict::along : Verdict::unknown;
    lines.turn(start->is_negative);
    const bool is_hit = claim.root.answer == Answer::hit;
    const auto not_told = [](Sign sign) { return sign == Sign::along ? Verdict::along : Verdict::unknown; };
    switch (const Sign sign = lines.sign_over(start->t, is_hit ? claim.root.min : claim.end)) {
      case Sign::positive:
        break;
      case Sign::negative:
        return is_hit ? Verdict::off : Verdict::missed;
      default:
        return not_told(sign);
    }
    if (!is_hit) return Verdict::right;
    const Sign behind = lines.sign_at(claim.root.max);
    if (behind == Sign::negative) return Verdict::right;
    if (behind == Sign::unknown) return Verdict::unknown;
    const Sign rest = lines.sign_over(start->t, claim.end);
    return rest == Sign::positive   ? Verdict::not_there
           : rest == Sign::negative ? Verdict::off
                                    : not_told(rest);
  }

  /// Returns true if the truth is 0 behind the place of an answer, to all digits, and so is its slope: the
  /// ray lies in a face.
  [[nodiscard]] bool runs_in_surface(const Claim& claim) const {
    const Quad t = claim.root.max, more = Quad(0x1p-40);
    const Along<Quad> f = Lines(truth_, claim).precise.at(t + more, t + 2 * more);
    return f.s.is_zero() && f.v.lo <= 0 && 0 <= f.v.hi;
  }

  /// Returns the magnitude of the truth at a parameter, at most.
  [[nodiscard]] double largest_at(const Claim& claim, double t) const {
    const Range<Quad> v = Lines(truth_, claim).precise.at(t, t).v;
    return static_cast<double>(std::max(-v.lo, v.hi));
  }

 private:
  /// A truth along a ray in numbers of three precisions, of which each is asked what the ones before it do
  /// not tell.
  struct Lines {
    TrueLine<Truth, double> quick;
    TrueLine<Truth, long double> finer;
    TrueLine<Truth, Quad> precise;

    Lines(const Truth& truth, const Claim& claim) : Lines(truth, claim, level_of(truth, claim)) {}
    Lines(const Truth& truth, const Claim& claim, const Range<Quad>& level)
        : quick(truth, claim, level), finer(truth, claim, level), precise(truth, claim, level) {}

    [[nodiscard]] std::optional<Start> start(double end) const {
      const std::optional<Start> start = quick.start(end, 1e-12);
      return start ? start : precise.start(end, 1e-30);
    }
    void turn(bool is_negative) {
      quick.turn(is_negative), finer.turn(is_negative), precise.turn(is_negative);
    }
    [[nodiscard]] Sign sign_at(double t) const {
      Sign sign = quick.sign_at(t);
      if (sign == Sign::unknown) sign = finer.sign_at(t);
      return sign == Sign::unknown ? precise.sign_at(t) : sign;
    }
    [[nodiscard]] Sign sign_over(double from, double to) const {
      if (!(from < to)) return Sign::positive;
      const auto is_told = [](Sign sign) { return sign == Sign::positive || sign == Sign::negative; };
      Parts<double> parts{{from, to}};
      if (const Sign sign = quick.sign_over(parts); is_told(sign)) return sign;
      Parts<long double> finer_parts(parts.begin(), parts.end());
      if (const Sign sign = finer.sign_over(finer_parts); is_told(sign)) return sign;
      Parts<Quad> precise_parts(finer_parts.begin(), finer_parts.end());
      return precise.sign_over(precise_parts);
    }
  };

  /// Returns the value where a ray leaves the surface, or 0.
  static Range<Quad> level_of(const Truth& truth, const Claim& claim) {
    return claim.leaves ? TrueLine<Truth, Quad>(truth, claim, {}).at(0, 0).v : Range<Quad>();
  }

  const Truth& truth_;
};

}  // namespace marching

// All crossings of a ray with the surface of a field, also of a ray that leaves the surface; and their order
// among those of other surfaces.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "../numeric/exact_root.hpp"
#include "march.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Parameter t from which a march begins: no root lies between the last root and t. If `known` is above 0, F
/// is at least `known` at t.
struct MarchStart {
  DoubleDouble t;
  double known = 0;
};

/// Sets the sign of a line so that F(t) > 0. Returns false if double-double does not tell the sign of F(t).
template <class Line>
[[nodiscard]] bool is_turned_at(Line& line, double t) {
  const auto is_known = [&](const auto& F, const auto& zero) {
    if (F.upper < zero) line.turn_to(-line.sign());
    return zero < F.lower || F.upper < zero;
  };
  return is_known(line.enclosed(t), 0.0) || is_known(line.enclosed(DoubleDouble(t)), DoubleDouble(0.0));
}

/// Returns a parameter behind t at which double-double tells the sign of F, and sets the sign of the line so
/// that F > 0 there; or the end of the line. It is the first of some that are tried, at distances from t that
/// double from try to try.
template <class Line>
[[nodiscard]] double decided_behind(Line& line, double t) {
  const double end = line.span().max;
  for (double h = std::max(0x1p-52 * std::abs(t), line.resolution()); t + h < end; h *= 2)
    if (is_turned_at(line, t + h)) return t + h;
  return end;
}

/// Returns where the march of a ray that leaves the surface begins. It leaves the level set through its
/// origin, and the next crossing is the first t > 0 with F(t) = F(0). The root 0 of F − F(0) is divided out:
/// by the mean value theorem (F(t) − F(0)) / t lies in the slopes over [0, t]. If these are never below 0, or
/// never above, over [0, h], the departure is the only root there, and |F(h) − F(0)| is at least h times the
/// least slope, without cancellation. If no h proves that, the ray leaves along the surface, which is counted
/// as undecided; the march then begins where F surely differs from F(0).
template <class Line>
[[nodiscard]] MarchStart deflated_start(Line& line) {
  line.leave_level();
  const auto start_at = [&](double h, const auto& slope) -> std::optional<MarchStart> {
    const double lo = static_cast<double>(slope.lower), hi = static_cast<double>(slope.upper);
    if (!(lo >= 0 || hi <= 0)) return std::nullopt;
    if (!(lo >= 0)) line.turn_to(-line.sign());
    line.proven(MarchProof::deflation, true, 0, h);
    // The slope is rounded to double, and so are the products: less than 4u, of which 2^-50 is 8.
    return MarchStart{h, (lo >= 0 ? lo : -hi) * h * (1 - 0x1p-50)};
  };
  // The enclosure of the slopes over [0, h] is as wide as h and the rounding of the points make it. From
  // 2^-43 of the bounds on, 2^10 last places of double, and from 2^-97 on, 2^9 of double-double, a smaller h
  // makes it hardly narrower and would prove no more.
  double h = line.extent() / 4;
  for (; h > 0x1p-43 * line.extent(); h /= 8)
    if (const auto start = start_at(h, line.slope(0.0, h).slope)) return *start;
  for (; h > 0x1p-97 * line.extent(); h /= 8)
    if (const auto start = start_at(h, line.slope(DoubleDouble(0.0), DoubleDouble(h)).slope)) return *start;
  ++fallbacks.undecided;
  return {decided_behind(line, 0)};
}

/// Calls visit(const MarchedRoot&, const Enclosure<DoubleDouble>&) for the roots of a line in t > begin, near
/// to far, with their enclosures in double-double, until it returns true. If double-double does not tell the
/// sign of F(begin), `begin` is visited as a root, too, unless it is 0, as for a ray that leaves the surface.
/// A touch behind it, with the same sign of F on both sides, is visited twice. Roots behind `stop` need not
/// be visited.
template <class Line>
void each_root(Line& line, double begin, double stop, bool leaves, const auto& visit) {
  const double end = line.span().max;
  if (!(begin < end)) return;
  MarchStart at{begin};
  if (leaves) {
    at = deflated_start(line);
  } else if (!is_turned_at(line, begin)) {
    ++fallbacks.undecided;
    if (begin == 0) {
      at = deflated_start(line);
    } else {
      line.proven(MarchProof::touch, true, begin, begin);
      if (visit(MarchedRoot{MarchedRoot::Answer::undecided, begin, begin}, Enclosure<DoubleDouble>(begin)))
        return;
      at = {decided_behind(line, begin)};
    }
  }
  bool may_be_departure = at.t.hi > begin;
  while (at.t < DoubleDouble(end) && at.t < DoubleDouble(stop)) {
    March march(line, at.t, stop, at.known);
    const MarchedRoot root = march.root();
    if (root.answer == MarchedRoot::Answer::miss) return;
    if (root.answer == MarchedRoot::Answer::hit) {
      if (visit(root, march.enclosure())) return;
      line.turn_to(-line.sign());
      at = {march.enclosure().upper};
    } else {
      // A march that does not get away from the departure has found no other root.
      const bool is_departure = may_be_departure && root.min == at.t.hi;
      if (!is_departure && visit(root, march.enclosure())) return;
      const double sign = line.sign();
      at = {decided_behind(line, root.max)};
      if (!is_departure && line.sign() == sign && visit(root, march.enclosure())) return;
    }
    may_be_departure = false;
  }
}

/// Returns a root of F, for comparisons with the roots of other surfaces, from its enclosure by a march, in
/// which there is no other root. Halving narrows it to about 2^-95 of itself, as far as double-double tells
/// the sign of F. F changes its sign at the root, so that the sign at one end tells that at the other.
template <class Line>
[[nodiscard, gnu::noinline, gnu::cold]] ExactRoot exact_root_in(Line& line,
                                                                const Enclosure<DoubleDouble>& root) {
  const DoubleDouble zero(0.0);
  DoubleDouble a = root.lower, b = root.upper;
  const auto at_a = line.enclosed(a), at_b = line.enclosed(b);
  const bool falls = zero < at_a.lower || at_b.upper < zero, rises = at_a.upper < zero || zero < at_b.lower;
  if (falls == rises) return exact_root_between(a, b);
  /// Moves an end to a share of the segment, if the sign of F is certain there.
  const auto take = [&](double share) {
    const DoubleDouble m = a + DoubleDouble(share) * (b - a);
    if (!(a < m && m < b)) return false;
    const auto at_m = line.enclosed(m);
    if (zero < at_m.lower) return (falls ? a : b) = m, true;
    if (at_m.upper < zero) return (falls ? b : a) = m, true;
    return false;
  };
  // Points are off by a few 2^-104 of t; at distances down to 2^-97 signs of F are mostly still certain.
  while ((b - a).hi > 0x1p-97 * std::abs(a.hi)) {
    if (take(0.5)) continue;
    const bool moved = take(0.25);
    if (!take(moved ? 2.0 / 3 : 0.75) && !moved) break;
  }
  return exact_root_between(a, b);
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

// Crossings of a line with an axis-aligned box: their existence and faces are exact, and t is certified
// (Roots).
//
// A point origin + t·d of the line is between the box's two faces on axis i from t = (min_i − o_i)/d_i to
// (max_i − o_i)/d_i, or the other way round for d_i < 0; for d_i = 0, always or never. It is in the box from
// the last of these entries to the first of the exits. Double nearly always decides; if its error bound does
// not allow it, the quotients are compared without rounding. docs/derivations.md derives the bound.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "../vec3.hpp"
#include "equation.hpp"
#include "roots.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Face of a box. Its number is 2·axis if the coordinate on that axis is the smallest, 2·axis + 1 if it is
/// the largest.
struct BoxFace {
  int number;

  [[nodiscard]] int axis() const { return number / 2; }
  [[nodiscard]] bool is_upper() const { return number % 2 != 0; }

  /// Returns the coordinate on axis() that all points of the face share.
  [[nodiscard]] double place(const Point& min, const Point& max) const {
    return is_upper() ? max[axis()] : min[axis()];
  }
};

/// Exact knowledge about the start of a line relative to a box.
struct BoxStart {
  int face = -1;           ///< number of the face in whose plane it starts, up to rounding; −1: none
  bool is_at_0 = true;     ///< true if it crosses that plane at t = 0, regardless of its digits
  bool is_in_box = false;  ///< true if it starts in the box, which it then only leaves
};

/// Roots of a line with a box, and their faces: none; entry and exit; or the exit alone if the line starts in
/// the box.
struct BoxRoots {
  Roots roots;
  BoxFace face[2] = {{0}, {0}};
};

/// Returns the equation of a face's plane in numbers of type T; its slope is 0 if the line is parallel to it.
template <class T>
[[nodiscard]] LinearEquation<T> face_equation(const LineOf<T>& line, const Point& min, const Point& max,
                                              BoxFace face, const BoxStart& start) {
  const auto axis = static_cast<std::size_t>(face.axis());
  if (face.number == start.face && start.is_at_0) return {.height = T(0), .slope = line.direction[axis]};
  return {.height = line.weight * Given<T>(face.place(min, max)) - line.origin[axis],
          .slope = line.direction[axis]};
}

/// Returns the roots in numbers of type T; empty if rounded numbers do not decide. If the line crosses two
/// faces at once, the one with the lower number is taken, unless the other is start.face.
template <class T>
[[nodiscard, gnu::cold, gnu::noinline]] std::optional<BoxRoots> box_roots_along(const LineOf<T>& line,
                                                                                const Point& min,
                                                                                const Point& max,
                                                                                const BoxStart& start) {
  const auto equation = [&](int face) { return face_equation(line, min, max, {face}, start); };
  int slopes[3];
  // Sign of a's root minus b's root, computed as the sign of (h_a s_b − h_b s_a) s_a s_b.
  const auto order = [&](int a, int b) {
    const auto of_a = equation(a), of_b = equation(b);
    const auto sign = sign_of(of_a.height * of_b.slope - of_b.height * of_a.slope);
    return sign ? std::optional(*sign * slopes[BoxFace{a}.axis()] * slopes[BoxFace{b}.axis()]) : sign;
  };
  int entry = -1, exit = -1;
  // Takes a face if its root comes after that of the face taken so far, or for sign = -1 before it. Returns
  // false if rounded numbers do not decide.
  const auto take = [&](int& taken, int face, int sign) {
    if (taken < 0) {
      taken = face;
      return true;
    }
    const auto later = order(face, taken);
    if (!later) return false;
    if (sign * *later > 0 || (*later == 0 && face == start.face)) taken = face;
    return true;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int lower = 2 * axis, upper = lower + 1;
    const auto slope = sign_of(line.direction[static_cast<std::size_t>(axis)]);
    if (!slope) return std::nullopt;
    slopes[axis] = *slope;
    if (*slope == 0) {
      if (start.is_in_box) continue;
      const auto below = sign_of(equation(lower).height), above = sign_of(equation(upper).height);
      if ((below && *below > 0) || (above && *above < 0)) return BoxRoots{};
      if (!below || !above) return std::nullopt;
      continue;
    }
    if (!start.is_in_box && !take(entry, *slope > 0 ? lower : upper, 1)) return std::nullopt;
    if (!take(exit, *slope > 0 ? upper : lower, -1)) return std::nullopt;
  }
  if (exit < 0) return BoxRoots{};  // the direction is 0
  const std::optional<Roots> last = roots_of(equation(exit));
  if (!last) return std::nullopt;
  if (start.is_in_box) return BoxRoots{.roots = *last, .face = {{exit}, {exit}}};

  const auto side = order(entry, exit);
  if (!side) return std::nullopt;
  if (*side > 0) return BoxRoots{};
  const std::optional<Roots> first = roots_of(equation(entry));
  if (!first) return std::nullopt;
  return BoxRoots{.roots = {(*first)[0], (*last)[0]}, .face = {{entry}, {exit}}};
}

namespace detail {

/// Returns the roots without rounding, for lines that double does not decide. If a number is not finite,
/// there is none.
[[nodiscard, gnu::cold, gnu::noinline]] inline BoxRoots box_roots_in_doubt(const Point& origin,
                                                                           const Vec3& direction,
                                                                           const Point& min, const Point& max,
                                                                           const BoxStart& start) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(min) || !is_finite(max)) return {};
  ++fallbacks.exact;
  return *box_roots_along(line_of<ExactNumber>(origin, direction), min, max, start);
}

/// Largest of some quotients, and whether it certainly is the largest. A quotient of a rounded difference has
/// an error of at most 2u of itself (u = 2^-53). In a comparison of two, 2^-50 = 8u of each exceeds these
/// errors and the rounding of the comparison.
struct LastQuotient {
  double t = -std::numeric_limits<double>::max();
  int face = -1;
  bool is_sure = true;

  static bool surely_precedes(double a, double b) { return b - a > 0x1p-50 * (std::abs(a) + std::abs(b)); }

  void add(double quotient, int of_face) {
    if (surely_precedes(quotient, t)) return;
    is_sure = surely_precedes(t, quotient);
    if (quotient > t) t = quotient, face = of_face;
  }
};

}  // namespace detail

/// Returns the roots of a line whose numbers are rounded, and their faces; empty if double does not decide.
///
/// A quotient h/d has an error below (h_error + |h/d| d_error)/(|d| − d_error) + 2u |h/d|, where h = place −
/// o has the error of o and u |h|. The code takes twice that, which covers the roundings of the bound. Two
/// quotients closer together than both bounds, or one less accurate than 2^-31 of itself, are not decided.
[[nodiscard]] inline std::optional<BoxRoots> rounded_box_roots(const RoundedLine& line, const Point& min,
                                                               const Point& max) {
  struct Quotient {
    double t, error;
    int face;
  };
  Quotient entry{-infinity, 0, -1}, exit{infinity, 0, -1};
  double next_entry = -infinity, next_exit = infinity;  // bounds of the quotients not taken
  for (int axis = 0; axis < 3; ++axis) {
    const double d = line.direction[axis], d_error = line.direction_error[axis];
    const double least = std::abs(d) - d_error;
    if (!(least > 0)) return std::nullopt;
    const auto quotient = [&](int face) {
      const double h = BoxFace{face}.place(min, max) - line.origin[axis], t = h / d;
      const double h_error = line.origin_error[axis] + 0x1p-53 * std::abs(h);
      return Quotient{t, 2 * ((h_error + std::abs(t) * d_error) / least + 0x1p-52 * std::abs(t)), face};
    };
    const Quotient in = quotient(d > 0 ? 2 * axis : 2 * axis + 1),
                   out = quotient(d > 0 ? 2 * axis + 1 : 2 * axis);
    if (in.t > entry.t) {
      next_entry = std::max(next_entry, entry.t + entry.error);
      entry = in;
    } else {
      next_entry = std::max(next_entry, in.t + in.error);
    }
    if (out.t < exit.t) {
      next_exit = std::min(next_exit, exit.t - exit.error);
      exit = out;
    } else {
      next_exit = std::min(next_exit, out.t - out.error);
    }
  }
  if (entry.t - entry.error > exit.t + exit.error) return BoxRoots{};
  const auto is_certain = [](const Quotient& q) {
    return q.error < 0x1p-31 * std::abs(q.t) && 0x1p-900 < std::abs(q.t) && std::abs(q.t) < 0x1p900;
  };
  if (!(entry.t + entry.error < exit.t - exit.error) || !(entry.t - entry.error > next_entry) ||
      !(exit.t + exit.error < next_exit) || !is_certain(entry) || !is_certain(exit))
    return std::nullopt;
  return BoxRoots{.roots = {entry.t, exit.t}, .face = {{entry.face}, {exit.face}}};
}

/// Returns the certified roots and their faces. A line that touches an edge or a vertex meets the box. If it
/// crosses two faces at once, the one with the lower number is taken, unless the other is start.face.
[[nodiscard]] inline BoxRoots box_roots(const Point& origin, const Vec3& direction, const Point& min,
                                        const Point& max, const BoxStart& start = {}) {
  using detail::LastQuotient;
  // True if quotients of such numbers and 0 neither overflow nor vanish; NaN is not in range.
  const auto in_range = [](double x) { return x == 0 || (0x1p-500 < std::abs(x) && std::abs(x) < 0x1p500); };
  LastQuotient entry, exit;  // exit has the exits' negatives; the largest is the first exit's
  bool is_sure = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = min[axis] - origin[axis], above = max[axis] - origin[axis], d = direction[axis];
    is_sure = is_sure && in_range(below) && in_range(above) && in_range(d);
    if (d == 0) {
      if (!start.is_in_box && (below > 0 || above < 0)) return {};
      continue;
    }
    const int lower = 2 * axis, upper = lower + 1;
    const auto root = [&](double height, int face) {
      return face == start.face && start.is_at_0 ? 0.0 : height / d;
    };
    if (d > 0)
      entry.add(root(below, lower), lower), exit.add(-root(above, upper), upper);
    else
      entry.add(root(above, upper), upper), exit.add(-root(below, lower), lower);
  }
  if (is_sure && start.is_in_box && exit.is_sure && exit.face >= 0)
    return {.roots = Roots{-exit.t}, .face = {{exit.face}, {exit.face}}};
  if (is_sure && !start.is_in_box) {
    if (LastQuotient::surely_precedes(-exit.t, entry.t)) return {};
    if (entry.is_sure && exit.is_sure && LastQuotient::surely_precedes(entry.t, -exit.t))
      return {.roots = {entry.t, -exit.t}, .face = {{entry.face}, {exit.face}}};
  }
  return detail::box_roots_in_doubt(origin, direction, min, max, start);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Where a line enters a box along the axes and where it leaves it: exactly whether, through which faces, and
// t as certain as Roots says.
//
// A point origin + t·d of the line is between the box's two faces on axis i from t = (min_i − o_i)/d_i to
// (max_i − o_i)/d_i, or the other way round for d_i < 0; for d_i = 0, always or never. It is in the box from
// the last of these entries to the first of the exits. Double decides nearly always; where its error bound
// does not allow that, the quotients are compared without rounding. docs/numerics.md derives the bound.
#pragma once

#include <cmath>
#include <limits>

#include "../vec3.hpp"
#include "exact_root.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A face of a box by its number: 2·axis where the coordinate is the smallest, 2·axis + 1 where it is the
/// largest.
struct BoxFace {
  int number;

  [[nodiscard]] int axis() const { return number / 2; }
  [[nodiscard]] bool is_upper() const { return number % 2 != 0; }

  /// The coordinate that all its points have on its axis.
  [[nodiscard]] double place(const Point& min, const Point& max) const {
    return is_upper() ? max[axis()] : min[axis()];
  }
};

/// No root, or two: where the line enters the box, and where it leaves it.
struct BoxRoots {
  Roots roots;
  BoxFace face[2] = {{0}, {0}};
};

namespace detail {

/// The root of a face whose axis the line is not at a right angle to, in these units of length and direction.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_face_root(double origin, double direction,
                                                                         double place, int lengths,
                                                                         int directions) {
  const Expansion height = Expansion(std::ldexp(place, -lengths)) - Expansion(std::ldexp(origin, -lengths));
  return {.A = std::ldexp(std::abs(direction), -directions),
          .b = direction < 0 ? -height : height,
          .D = {},
          .exponent = lengths - directions};
}

}  // namespace detail

/// The root of a face that the line crosses, without rounding.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_box_root(const Point& origin,
                                                                        const Vec3& direction,
                                                                        const Point& min, const Point& max,
                                                                        BoxFace face) {
  const double o = origin[face.axis()], d = direction[face.axis()], place = face.place(min, max);
  return detail::exact_face_root(o, d, place, exponent_of({{o, place, 0}}), exponent_of({{d, 0, 0}}));
}

/// The same in double-double.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_box_root(const Point& origin,
                                                                             const Vec3& direction,
                                                                             const Point& min,
                                                                             const Point& max, BoxFace face) {
  ++fallbacks.exact;
  return refined_linear_root(exact_box_root(origin, direction, min, max, face));
}

namespace detail {

/// The sign of the difference of two faces' roots. Powers of two keep the products in the range of double.
[[nodiscard, gnu::cold, gnu::noinline]] inline int order_of_faces(const Point& origin, const Vec3& direction,
                                                                  const Point& min, const Point& max,
                                                                  BoxFace a, BoxFace b) {
  const auto length = [&](BoxFace face) { return Vec3{origin[face.axis()], face.place(min, max), 0}; };
  const int lengths = exponent_of({length(a), length(b)});
  const int directions = exponent_of({{direction[a.axis()], direction[b.axis()], 0}});
  const auto root = [&](BoxFace face) {
    return exact_face_root(origin[face.axis()], direction[face.axis()], face.place(min, max), lengths,
                           directions);
  };
  return order(root(a), root(b));
}

/// The roots where double does not decide, of a line that no axis excludes on which its direction is 0.
/// Numbers that are not finite, and a direction of 0, cross nothing.
[[nodiscard, gnu::cold, gnu::noinline]] inline BoxRoots box_roots_in_doubt(const Point& origin,
                                                                           const Vec3& direction,
                                                                           const Point& min, const Point& max,
                                                                           int preferred) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(min) || !is_finite(max) ||
      direction == Vec3{0})
    return {};
  ++fallbacks.exact;
  const auto order = [&](int a, int b) { return order_of_faces(origin, direction, min, max, {a}, {b}); };
  int entry = -1, exit = -1;
  const auto is_taken = [&](int face, int other, int sign) {
    if (other < 0) return true;
    const int later = sign * order(face, other);
    return later > 0 || (later == 0 && face == preferred);
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) continue;
    const int lower = 2 * axis, upper = lower + 1;
    const bool is_backwards = direction[axis] < 0;
    if (const int face = is_backwards ? upper : lower; is_taken(face, entry, 1)) entry = face;
    if (const int face = is_backwards ? lower : upper; is_taken(face, exit, -1)) exit = face;
  }
  if (order(entry, exit) > 0) return {};
  const auto t = [&](int face) {
    const ExactRoot root = exact_box_root(origin, direction, min, max, {face});
    return static_cast<double>(refined_linear_root(root).t[0]);
  };
  return {.roots = {t(entry), t(exit)}, .face = {{entry}, {exit}}};
}

/// The last of some quotients, and whether it surely is the last. A quotient of a difference has an error of
/// at most 2u of itself (u = 2^-53). Of two that are compared, 2^-50 = 8u of each are more than that and the
/// rounding of the comparison.
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

/// The roots, certified, and their faces. A line that touches an edge or a vertex meets the box. Where it
/// crosses two faces at once, the one with the lowest number is taken, but for one that is preferred.
[[nodiscard]] inline BoxRoots box_roots(const Point& origin, const Vec3& direction, const Point& min,
                                        const Point& max, int preferred = -1) {
  using detail::LastQuotient;
  // Where quotients of such numbers and 0 neither overflow nor vanish. NaN is not in range.
  const auto in_range = [](double x) { return x == 0 || (0x1p-500 < std::abs(x) && std::abs(x) < 0x1p500); };
  LastQuotient entry, exit;  // of the exits' negatives: their last is the first exit's
  bool is_sure = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = min[axis] - origin[axis], above = max[axis] - origin[axis], d = direction[axis];
    is_sure = is_sure && in_range(below) && in_range(above) && in_range(d);
    if (d == 0) {
      if (below > 0 || above < 0) return {};
      continue;
    }
    const int lower = 2 * axis, upper = lower + 1;
    if (d > 0)
      entry.add(below / d, lower), exit.add(-above / d, upper);
    else
      entry.add(above / d, upper), exit.add(-below / d, lower);
  }
  if (is_sure && LastQuotient::surely_precedes(-exit.t, entry.t)) return {};
  if (is_sure && entry.is_sure && exit.is_sure && LastQuotient::surely_precedes(entry.t, -exit.t))
    return {.roots = {entry.t, -exit.t}, .face = {{entry.face}, {exit.face}}};
  return detail::box_roots_in_doubt(origin, direction, min, max, preferred);
}

}  // namespace protostar::inline PROTOSTAR_ABI

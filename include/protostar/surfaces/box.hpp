// A solid box between the points min and max, with faces perpendicular to the axes.
//
// A line is between the planes of the two faces on an axis from one of its roots with these planes to the
// other. It is in the box from the last of the three entries to the first of the three exits. Double nearly
// always decides; if its error bound does not allow it, the roots are compared without rounding.
// docs/derivations.md derives the bound.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "../magnitude.hpp"
#include "../numeric/planar_equation.hpp"
#include "../shown.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"
#include "planar.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A box along the axes; min is nowhere above max. It may be flat.
///
/// Its primitives are its faces: 0 and 1 at the smallest and largest x, 2 and 3 for y, 4 and 5 for z. Hits,
/// and the faces that are hit, are decided exactly.
///
/// A ray that leaves a face of the box starts on it, however its origin is rounded. If it leads inward, it
/// crosses the box exactly once more, at t > 0: at the first plane of a face that it crosses from inside or,
/// if the digits put that at t ≤ 0 because the ray starts in an edge, at the smallest positive double. If it
/// leads outward or along the face, it does not cross the box. A ray that departs from the plane of a face,
/// but not from this box, starts anywhere in that plane: it does not cross this face, which is at t = 0, and
/// its digits decide on the other faces.
struct Box {
  Point min{-1}, max{1};

  /// Returns t of the closest hit in the range, at which the ray enters the box or, from inside, leaves it.
  /// Touching an edge or a vertex is a hit. If faces are crossed at once, the one with the lowest index
  /// counts. A ray that departs from the plane of a face does not hit that face, and if it does not lead to
  /// the box's side of the plane, it does not hit the box.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    return first_of_all(*this, ray, range);
  }

  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    const Start start = start_of(ray);
    if (start.face >= 0 && !leads_inwards(ray, start.face)) return;
    const Met met = with_line(ray, [&](const auto& line) { return this->met(ray, line, start); });
    for (int i = 0; i < met.roots.count(); ++i) {
      Crossing crossing{.t = met.roots[i], .primitive = met.faces[i]};
      if (start.is_in_box) crossing.t = std::max(crossing.t, smallest_t);
      if (crossing.primitive != start.face && lies_inside(*this, ray, crossing, range)) visit(crossing);
    }
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    const Start start = start_of(ray);
    const ExactRoot root = root_on(crossing.primitive, ray, start);
    return start.is_in_box && root.b.sign() <= 0 ? exact_root_of(smallest_t) : root;
  }

  /// Returns the outward unit normal of a face.
  [[nodiscard]] Vec3 normal_at(const Point&, int face) const {
    Vec3 normal{0};
    normal[face / 2] = is_upper(face) ? 1 : -1;
    return normal;
  }

  /// Returns how far a point is from min along the two axes that follow the face's own in the cycle x, y, z.
  [[nodiscard]] Uv uv_at(const Point& point, int face) const {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    return {point[u] - min[u], point[v] - min[v]};
  }
  [[nodiscard]] Tangents tangents_at(const Point&, int face) const {
    const int axis = face / 2;
    Tangents axes;
    axes.u[(axis + 1) % 3] = 1, axes.v[(axis + 2) % 3] = 1;
    return axes;
  }

  [[nodiscard]] int primitive_count() const { return 6; }

  /// Returns false: the inside is bounded on every ray.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  /// Returns the box, widened by near().
  [[nodiscard]] Bounds bounds() const { return outward({min - near(), max + near()}); }

  /// Returns the distance of a point from the box, less than 0 inside; rounded.
  [[nodiscard]] double distance_bound(const Point& point) const {
    double squares = 0, largest = -infinity;
    for (int k = 0; k < 3; ++k) {
      const double beyond = std::max(min[k] - point[k], point[k] - max[k]);
      squares += std::max(beyond, 0.0) * std::max(beyond, 0.0);
      largest = std::max(largest, beyond);
    }
    return largest > 0 ? std::sqrt(squares) : largest;
  }

  /// Returns the plane of a face; surfaces and faces in one plane are left together.
  [[nodiscard]] Departure departure(int face) const {
    Departure departure = departure_across(face / 2, place(face));
    departure.primitive = face, departure.object = this;
    return departure;
  }

  /// Throws std::invalid_argument if min is above max on an axis, or a number is not a coordinate
  /// (magnitude.hpp).
  void validate() const {
    const auto refuse = [](const std::string& what) { throw std::invalid_argument("Box: " + what); };
    for (int axis = 0; axis < 3; ++axis) {
      if (!is_coordinate(min[axis])) refuse(coordinate("min", min, axis) + " must be " + coordinate_rule);
      if (!is_coordinate(max[axis])) refuse(coordinate("max", max, axis) + " must be " + coordinate_rule);
      if (min[axis] > max[axis])
        refuse(coordinate("min", min, axis) + " must not be above " + coordinate("max", max, axis));
    }
  }

 private:
  /// Formats as in "min.x = 0.1", with enough digits to tell the number from any other double.
  [[nodiscard]] static std::string coordinate(const std::string& name, const Point& point, int axis) {
    return name + '.' + "xyz"[axis] + " = " + shown(point[axis]);
  }

  static constexpr double smallest_t = std::numeric_limits<double>::denorm_min();

  [[nodiscard]] static bool is_upper(int face) { return face % 2 != 0; }

  /// Returns the coordinate on the axis of a face that all its points share.
  [[nodiscard]] double place(int face) const { return is_upper(face) ? max[face / 2] : min[face / 2]; }

  /// Returns the distance from the plane of a face up to which a ray that departs from this plane is taken to
  /// start in it, whatever its digits say. A hit point is off by 2^-52 of its coordinates, here or outside of
  /// an instance, and by more if the ray that hit it came from much farther away. 2^-20 of the box's size is
  /// enough for coordinates up to 2^32 times that size; a point farther off starts where its digits say. The
  /// bounds are wider by the same distance, so that they contain what a ray from such a point crosses.
  [[nodiscard]] double near() const {
    const Vec3 size = max - min;
    return 0x1p-20 * std::max({size.x, size.y, size.z});
  }

  /// Exact knowledge about the start of a line.
  struct Start {
    int face = -1;           ///< face in whose plane it starts, up to rounding; −1: none
    bool is_at_0 = true;     ///< true if it crosses that plane at t = 0, regardless of its digits
    bool is_in_box = false;  ///< true if it starts in the box, which it then only leaves
  };

  /// Derives the start of a ray from the ray's departure.
  [[nodiscard]] Start start_of(const Ray& ray) const {
    const Departure& departed = ray.departure;
    if (!departed.is_planar()) return {};
    if (departed.object == this) return {.face = departed.primitive, .is_in_box = true};
    for (int face = 0; face < 6; ++face) {
      const bool may_be_parallel = departed.geometry[static_cast<std::size_t>(face / 2)] != 0;
      if (may_be_parallel && departed == departure(face))
        return {.face = face, .is_at_0 = std::abs(ray.origin[face / 2] - place(face)) <= near()};
    }
    return {};
  }

  /// Returns true if the ray leads from a face into the box; never if the box is flat on the face's axis.
  [[nodiscard]] bool leads_inwards(const Ray& ray, int face) const {
    const int axis = face / 2;
    if (!(min[axis] < max[axis])) return false;
    const int sign = with_line(ray, [&](const auto& line) { return sign_along(axis, ray, line); });
    return is_upper(face) ? sign < 0 : sign > 0;
  }

  /// Returns the sign of a ray's direction along an axis.
  template <class Line>
  [[nodiscard]] static int sign_along(int axis, const Ray& ray, const Line& line) {
    const double d = line.direction[axis];
    if constexpr (std::same_as<Line, RoundedLine>)
      if (!(std::abs(d) > line.direction_error[axis]))
        return exact_line(ray).direction[static_cast<std::size_t>(axis)].sign();
    return (d > 0) - (d < 0);
  }

  /// Returns true if a ray perpendicular to an axis is between the faces on that axis.
  [[nodiscard]] bool is_between(int axis, const Ray& ray) const {
    const double o = ray.origin[axis];
    if (ray.transform == nullptr) return min[axis] <= o && o <= max[axis];
    const ExactLine line = exact_line(ray);
    const ExactNumber& place = line.origin[static_cast<std::size_t>(axis)];
    return (place - line.weight * min[axis]).sign() >= 0 && (place - line.weight * max[axis]).sign() <= 0;
  }

  /// Root t on the plane of a face, which differs from the exact one by at most `error`.
  struct FaceRoot {
    double t = 0, error = 0;
    int face = -1;
  };

  /// Returns the root of a line on the plane of a face, h/d with h = place − o.
  ///
  /// With errors of o and d, a quotient has an error below (o_error + u |h| + |h/d| d_error)/(|d| − d_error)
  /// + u |h/d|. The bound has 8u |h/d| for the roundings, whose error is at most 2u |h/d|, and twice the
  /// rest, which covers the roundings of the bound. It is infinite if the quotient may have overflowed or
  /// vanished.
  template <class Line>
  [[nodiscard, gnu::always_inline]] FaceRoot rounded_root(int face, const Line& line) const {
    const int axis = face / 2;
    const double h = place(face) - line.origin[axis], d = line.direction[axis], t = h / d, size = std::abs(t);
    double error = 0x1p-50 * size;
    if constexpr (std::same_as<Line, RoundedLine>) {
      const double least = std::abs(d) - line.direction_error[axis];
      const double carried = line.origin_error[axis] + size * line.direction_error[axis];
      error = least > 0 ? error + 2 * carried / least : infinity;
    }
    return {t, h == 0 || (0x1p-900 < size && size < 0x1p900) ? error : infinity, face};
  }

  /// Returns the root of a ray on the plane of a face without rounding.
  [[nodiscard]] ExactRoot root_on(int face, const Ray& ray, const Start& start) const {
    if (face == start.face && start.is_at_0) return exact_root_of(0.0);
    const auto& [x, y, z, distance] = departure(face).geometry;
    return exact_root_of(plane_equation(exact_line(ray), {x, y, z}, distance));
  }

  /// Returns the order of the roots on two faces, or the root on one, without rounding.
  [[nodiscard, gnu::cold, gnu::noinline]] int exact_order(int a, int b, const Ray& ray,
                                                          const Start& start) const {
    ++fallbacks.exact;
    return order(root_on(a, ray, start), root_on(b, ray, start));
  }
  [[nodiscard, gnu::cold, gnu::noinline]] double exact_t(int face, const Ray& ray, const Start& start) const {
    ++fallbacks.exact;
    return static_cast<double>(refined(root_on(face, ray, start)));
  }

  /// Roots of a ray with the box, and their faces: none; entry and exit; or the exit alone if the ray starts
  /// in the box. If the ray crosses two faces at once, the one with the lower number is taken, unless the
  /// other is start.face.
  struct Met {
    Roots roots;
    int faces[2] = {0, 0};
  };

  [[nodiscard, gnu::always_inline]] Met met(const Ray& ray, const auto& line, const Start& start) const {
    const Vec3 sum = line.origin + line.direction + min + max;  // not finite if a number is not
    if (!is_finite(sum) && !(is_proper(ray) && is_finite(min) && is_finite(max))) return {};
    const auto order = [&](const FaceRoot& a, const FaceRoot& b) {
      const double gap = a.t - b.t;
      if (std::abs(gap) > a.error + b.error) return gap > 0 ? 1 : -1;
      return exact_order(a.face, b.face, ray, start);
    };
    // Takes a face if its root comes after that of the face taken so far, or for sign = -1 before it.
    const auto take = [&](FaceRoot& taken, int face, int sign) {
      const bool is_start = face == start.face;
      const FaceRoot root = is_start && start.is_at_0 ? FaceRoot{.face = face} : rounded_root(face, line);
      const int later = taken.face < 0 ? 1 : sign * order(root, taken);
      if (later > 0 || (later == 0 && is_start)) taken = root;
    };
    FaceRoot entry, exit;
    for (int axis = 0; axis < 3; ++axis) {
      const int sign = sign_along(axis, ray, line), lower = 2 * axis, upper = lower + 1;
      if (sign == 0 && !start.is_in_box && !is_between(axis, ray)) return {};
      if (sign == 0) continue;
      take(exit, sign > 0 ? upper : lower, -1);
      if (start.is_in_box) continue;
      take(entry, sign > 0 ? lower : upper, 1);
      if (entry.t - entry.error > exit.t + exit.error) return {};
    }
    if (exit.face < 0) return {};  // the direction is 0
    const auto t_of = [&](const FaceRoot& root) {
      return root.error <= 0x1p-31 * std::abs(root.t) && root.error < infinity
                 ? root.t
                 : exact_t(root.face, ray, start);
    };
    if (start.is_in_box) return {.roots = Roots{t_of(exit)}, .faces = {exit.face}};
    const int gap = order(entry, exit);
    if (gap > 0) return {};
    const double first = t_of(entry);
    return {.roots = {first, gap == 0 ? first : t_of(exit)}, .faces = {entry.face, exit.face}};
  }
};

static_assert(CompositeSurface<Box> && is_made_of_primitives<Box> && SurfaceWithBounds<Box> && Solid<Box>);

}  // namespace protostar::inline PROTOSTAR_ABI

// Surfaces that are marched: the points where a field is 0, as a distance field is on a surface (§3.2).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../exact/distance_field.hpp"
#include "../exact/recorded.hpp"
#include "../magnitude.hpp"
#include "../march/field_bounds.hpp"
#include "../march/field_lines.hpp"
#include "../march/field_roots.hpp"
#include "../ray_lanes.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"
#include "field_jumps.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Field as a plain function of a point, in double: the library knows no more of it than its values.
template <class F>
concept PlainField = !DistanceField<F> && std::copy_constructible<F> && requires(const F& field, Point p) {
  { field(p) } -> std::convertible_to<double>;
};

/// Surface of a field: the points inside the bounds where the field is 0. The inside is the points where it
/// is below 0. It is made of the field and the bounds: `Marched{field, Bounds{...}}`. Points in the bounds
/// surely count, also in a face of them. Points outside may count as well, up to a distance of 2^-10 of the
/// largest side and two last places of t.
///
/// A DistanceField is a generic function of a point, as [](const auto& p) { return length(p) - 1.0; }. From
/// it the library derives how fast it changes, and how much it is rounded, and each hit is proven: t is
/// enclosed to 2^-30 of itself, nothing lies before it, and a miss is a miss. Where a ray comes nearer to the
/// surface than double-double tells, about 2^-95, it hits, and fallbacks.undecided counts it. A ray that
/// leaves at a grazing angle may cross the surface again so near that t is enclosed only to 2^-30 of the size
/// of the bounds; its order among crossings of other surfaces as near is not proven.
///
/// A field has to be continuous: one made with wrap jumps at the borders of its cells unless it looks at the
/// neighbors too, and proofs of a field that jumps do not hold. Most jumps are found and refused, but a small
/// one may not be found (field_jumps.hpp).
///
/// A plain function of a Point takes a Lipschitz constant besides, and nothing is proven then.
template <class F>
class Marched;

/// Surface of a DistanceField, marched with a proof.
template <DistanceField F>
class Marched<F> {
 public:
  /// Number of evaluations over boxes for the Lipschitz constant if none is given: a choice. A distance needs
  /// few of them; a field that is none takes all, and more may make its constant smaller, and marches faster.
  /// The constant holds with any number.
  static constexpr int usual_evaluations = 20000;

  /// Makes the surface; derives the field's Lipschitz constant and rounding with at most `evaluations`
  /// evaluations over boxes.
  /// Throws std::invalid_argument if the bounds are not finite, or empty, or the field is not valid, has no
  /// bounded slope or value in them, or is found to jump.
  Marched(F field, const Bounds& bounds, int evaluations = usual_evaluations) : field_(std::move(field)) {
    validate_each(field_);
    // Rounded points of rays may lie outside of `inside` by as much again.
    setup_.margin = 0x1p-10 * detail::largest_side(bounds);
    setup_.inside = detail::widened(bounds, setup_.margin);
    setup_.bound = lipschitz_bound(field_, detail::widened(setup_.inside, setup_.margin), evaluations);
    if (!std::isfinite(setup_.bound.lipschitz) || !std::isfinite(setup_.bound.error))
      throw std::invalid_argument(
          "Marched: in the bounds the field must have finite values, and slopes that are finite; found a "
          "slope of up to " +
          shown(setup_.bound.lipschitz) + " and an error of up to " + shown(setup_.bound.error));
    detail::refuse_jumps(field_, setup_.inside, setup_.bound);
  }

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit gradient at a point of the surface, towards where the field is above 0. At an edge,
  /// where the gradient jumps, it is one between those of both sides, and if it vanishes, it is (0, 0, 1).
  [[nodiscard]] Vec3 normal_at(const Point& point) const {
    Vec3 gradient{0};
    for (int k = 0; k < 3; ++k) {
      using E = Enclosure<double>;
      const auto coordinate = [&](int i) {
        const double one = i == k ? 1 : 0;
        return Slope<E>{E{point[i], point[i]}, E{one, one}};
      };
      const Slope<E> f = field_(FieldPoint<Slope<E>>{coordinate(0), coordinate(1), coordinate(2)});
      gradient[k] = f.slope.middle();
    }
    return unit_along(gradient);
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    NoTrace trace;
    const auto root = first_root(ray, range, trace);
    return root ? std::optional(root->first) : std::nullopt;
  }

  /// Returns the first crossings of the active rays in a range, with the bits of single rays, which march
  /// together if the range begins at 0 and none may depart. The trace is told of evaluations in turn.
  template <class Trace>
  [[nodiscard]] FirstOfLanes first_of_lanes(const RayLanes& rays, Interval range, Trace& trace) const {
    using simd::Doubles, simd::LaneMask;
    FirstOfLanes first{.t = infinity, .is_there = false, .in_doubt = false};
    LaneMask alone = rays.active;
    if (range.min == 0 && !rays.may_depart) {
      FieldLines lines(field_, setup_, rays.origin, rays.direction, trace);
      const Doubles begin = lines.begin();
      const LaneMask is_known = lines.is_known();
      const LaneMask live = rays.active && is_known && begin < lines.span().max && begin < range.max;
      const LaneMask is_outside = live && lines.enclosed(begin, live).lower > 0.0;
      detail::March march(lines, begin, range.max);
      const LaneMask precisely = march.in_double(is_outside);
      const auto& roots = march.roots();
      const Doubles t = roots.min + 0.5 * (roots.max - roots.min),
                    margin = 2 * Roots::relative_error * abs(t);
      first.is_there = roots.met && 0.0 < t - margin && t + margin < range.max;
      first.t = select(first.is_there, t, first.t);
      // A march that finds nothing inside the range goes on behind it, alone.
      alone = (rays.active && !is_known) || (live && !is_outside) ||
              (roots.met && !first.is_there && t - margin < range.max);
      set_one_by_one(first, precisely, [&](int lane) -> std::optional<Crossing> {
        const Ray ray = rays.ray(lane);
        FieldLine line(field_, setup_, ray, trace);
        detail::March one(line, march.t()[lane], range.max);
        const MarchedRoot root = one.precise_root(march.t()[lane], march.before()[lane]);
        if (root.answer == MarchedRoot::Answer::miss) return std::nullopt;
        const Crossing crossing{root.t(), 0};
        return lies_inside(*this, ray, crossing, range) ? crossing : first_crossing(ray, range);
      });
    }
    set_one_by_one(first, alone, [&](int lane) -> std::optional<Crossing> {
      const auto root = first_root(rays.ray(lane), range, trace);
      return root ? std::optional(root->first) : std::nullopt;
    });
    return first;
  }

  [[nodiscard]] FirstOfLanes first_of_lanes(const RayLanes& rays, Interval range) const {
    NoTrace trace;
    return first_of_lanes(rays, range, trace);
  }

  /// Calls visit(const Crossing&) for all crossings in the range, near to far. A touch is two.
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    NoTrace trace;
    each(ray, range, trace, [&](const Crossing& crossing, const MarchedRoot&) {
      if (lies_inside(*this, ray, crossing, range)) visit(crossing);
      return false;
    });
  }

  /// Returns a crossing, enclosed in double-double.
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    NoTrace trace;
    FieldLine line(field_, setup_, ray, trace);
    if (is_left_by(ray)) line.leave_level();
    ExactRoot root = detail::enclosed_root(line, crossing.t / line.unit());
    root.b = root.b * line.unit(), root.error = root.error * line.unit();
    return root;
  }

  /// Marches along a ray, and tells a trace of each step (march_steps.hpp). Returns the first crossing in the
  /// range, with its enclosure, or a miss.
  template <class Trace>
  [[nodiscard]] MarchedRoot march(const Ray& ray, Interval range, Trace& trace) const {
    const auto root = first_root(ray, range, trace);
    return root ? root->second : MarchedRoot{};
  }

  /// Returns this surface, recognized by its address.
  [[nodiscard]] Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }
  [[nodiscard]] bool is_left_by(const Ray& ray) const { return ray.departure.is_from(this); }

  /// Returns true if the field is proven to be above 0 all over the faces of the bounds: then the surface is
  /// closed.
  [[nodiscard]] bool is_solid() const {
    const Bounds& box = setup_.inside;
    int remaining = most_face_evaluations;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {box.min[axis], box.max[axis]}) {
        Bounds face = box;
        face.min[axis] = face.max[axis] = side;
        if (!is_positive_over(face, remaining)) return false;
      }
    return true;
  }
  /// Returns false: the far end of a ray is outside the bounds.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  /// Returns the bounds as they were given, with a margin in which faces that lie in them are seen.
  [[nodiscard]] Bounds bounds() const { return detail::widened(setup_.inside, 0x1p-20 * setup_.margin); }

  /// Returns a lower bound of the distance from a point to the surface, less than 0 where the field is;
  /// rounded. It is 0 on the surface, and as tight as the field is near to a distance.
  [[nodiscard]] double distance_bound(const Point& point) const {
    return detail::distance_bound(point, setup_.inside, setup_.bound.lipschitz,
                                  [&](const Point& p) { return plain_value(field_, p); });
  }

  [[nodiscard]] const F& field() const { return field_; }
  /// Writes down the field, for a program that evaluates it again (exact/recorded.hpp).
  void record_field(FieldTape& tape) const {
    if constexpr (FieldOver<F, Recorded>) tape.record(field_);
  }
  [[nodiscard]] const MarchSetup* march_setup() const { return &setup_; }

 private:
  /// Calls visit(const Crossing&, const MarchedRoot&) for the crossings of a ray's line, near to far, until
  /// it returns true, and crossings at t < 0 only if the range has some. They do not depend on the range
  /// otherwise: it only ends the search.
  void each(const Ray& ray, Interval range, auto& trace, const auto& visit) const {
    if (!is_proper(ray)) return;
    FieldLine line(field_, setup_, ray, trace);
    const Interval span = line.span();
    if (!(span.min < span.max)) return;
    const bool leaves = is_left_by(ray);
    int index = 0;
    const auto visit_next = [&](const MarchedRoot& root) {
      const MarchedRoot of_ray{root.answer, root.min * line.unit(), root.max * line.unit()};
      const Crossing crossing{of_ray.t(), index++};
      return visit(crossing, of_ray);
    };
    if (range.min < 0 && leaves && span.min < 0) {
      std::vector<MarchedRoot> behind;
      const Ray back = ray.reversed();
      FieldLine line_back(field_, setup_, back, trace);
      detail::each_root(line_back, 0, -range.min / line.unit(), true, [&](const MarchedRoot& root) {
        behind.push_back({root.answer, -root.max, -root.min});
        return false;
      });
      for (auto root = behind.rbegin(); root != behind.rend(); ++root)
        if (visit_next(*root)) return;
    }
    const double begin = leaves ? 0 : range.min < 0 ? span.min : std::max(0.0, span.min);
    detail::each_root(line, begin, range.max / line.unit(), leaves, visit_next);
  }

  [[nodiscard]] std::optional<std::pair<Crossing, MarchedRoot>> first_root(const Ray& ray, Interval range,
                                                                           auto& trace) const {
    std::optional<std::pair<Crossing, MarchedRoot>> first;
    each(ray, range, trace, [&](const Crossing& crossing, const MarchedRoot& root) {
      if (lies_inside(*this, ray, crossing, range)) first = std::pair(crossing, root);
      return first.has_value();
    });
    return first;
  }

  /// Number of evaluations after which a surface counts as no solid, without a proof: a choice, which bounds
  /// the time for a field that comes near to 0 on a face.
  static constexpr int most_face_evaluations = 1 << 16;

  /// Tests whether F > 0 all over a part of a face, by halves, in at most `remaining` evaluations.
  [[nodiscard]] bool is_positive_over(const Bounds& part, int& remaining) const {
    if (--remaining < 0) return false;
    using E = Enclosure<double>;
    const auto over = [&](int k) { return E{part.min[k], part.max[k]}; };
    const E values = field_(FieldPoint<E>{over(0), over(1), over(2)});
    if (values.lower > 0) return true;
    if (values.upper < 0) return false;
    const Point middle = 0.5 * (part.min + part.max);
    const Vec3 size = part.max - part.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (!(part.min[axis] < middle[axis] && middle[axis] < part.max[axis])) return false;
    Bounds low = part, high = part;
    low.max[axis] = high.min[axis] = middle[axis];
    return is_positive_over(low, remaining) && is_positive_over(high, remaining);
  }

  F field_;
  MarchSetup setup_;
};

/// Surface of a field that is a constant, as decltype(field) names it: Scene<Marched<decltype(field)>> takes
/// Marched{field, ...}.
template <class F>
class Marched<const F> : public Marched<F> {
 public:
  using Marched<F>::Marched;
  Marched(Marched<F> surface) : Marched<F>(std::move(surface)) {}
};

template <DistanceField F>
Marched(F, const Bounds&) -> Marched<F>;
template <DistanceField F>
Marched(F, const Bounds&, int) -> Marched<F>;
template <PlainField F>
Marched(F, const Bounds&, double) -> Marched<F>;

/// Surface of a plain function of a point, marched without a proof. The user's constant says how fast the
/// function changes at most: |f(p) − f(q)| ≤ lipschitz · |p − q|. If it does not hold, a ray may pass through
/// the surface. Even if it holds, nothing is proven: a ray hits where it comes closer to the surface than
/// 2^-40 of the bounds' size, and while a ray that starts is as close, it hits nothing.
template <PlainField F>
class Marched<F> {
 public:
  /// Makes the surface. Throws std::invalid_argument if the bounds are not finite or are empty, the field is
  /// not valid, or the constant is not a number from 2^-400 to 2^400.
  Marched(F field, const Bounds& bounds, double lipschitz)
      : field_(std::move(field)), size_(detail::largest_side(bounds)), lipschitz_(lipschitz) {
    if (!is_size(lipschitz))
      throw std::invalid_argument("Marched: lipschitz is " + shown(lipschitz) + "; it must be a number " +
                                  size_rule);
    validate_each(field_);
    bounds_ = detail::widened(bounds, 0x1p-10 * size_);
  }

  /// Distance at which a ray hits, as a share of the bounds' size: a choice, as nothing is known of the
  /// field's rounding. It is 2^12 last places of a coordinate as large as the bounds, 2^-52 of it, enough for
  /// a field of some hundred operations that do not cancel; and far below a pixel.
  static constexpr double closest = 0x1p-40;

  /// Number of steps after which a march ends as a hit: a choice, which bounds the time of a ray that passes
  /// close along a surface.
  static constexpr int most_steps = 1 << 16;

  /// Returns t of the first crossing in the range that the march finds, in steps of |f| / lipschitz. A change
  /// of sign is narrowed by bisection. A march of more than most_steps ends as a hit.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    if (!is_proper(ray)) return std::nullopt;
    const detail::LineInBox line(ray, bounds_, 0x1p-10 * size_);
    // Steps do not depend on `stop`, and with them the digits of t.
    const double end = line.span.max, stop = range.max / line.unit;
    const auto value = [&](double t) {
      return static_cast<double>(field_(line.origin + t * line.direction));
    };
    const auto in_range = [&](double t) {
      return range.contains(t * line.unit) ? std::optional(t * line.unit) : std::nullopt;
    };
    const double speed = lipschitz_ * line.d, close = closest * size_ * lipschitz_;
    double t = std::max(line.span.min, range.min / line.unit);
    if (!(t < end && t < stop)) return std::nullopt;
    double v = value(t);
    for (double step = close / speed; std::abs(v) <= close; step *= 2) {  // the surface that the ray leaves
      if (!(t + step < end)) return std::nullopt;
      v = value(t += step);
    }
    for (int i = 0; i < most_steps; ++i) {
      // A step below the last digit of t, as far from the coordinate origin, is the next double.
      const double step = std::max(t + std::abs(v) / speed, std::nextafter(t, infinity));
      const double next = std::min(step, end), v_next = value(next);
      if ((v < 0) != (v_next < 0)) return in_range(root_between(value, t, next));
      t = next, v = v_next;
      if (std::abs(v) <= close) break;
      if (!(t < end && t < stop)) return std::nullopt;
    }
    return in_range(t);
  }

  /// Returns the unit gradient at a point, by differences over h = 2^-17 of the bounds' size: their error is
  /// about h², that of rounding u/h, and they are equal at h³ = u = 2^-53.
  [[nodiscard]] Vec3 normal_at(const Point& point) const {
    const double h = 0x1p-17 * size_;
    Vec3 gradient{0};
    for (int k = 0; k < 3; ++k) {
      Point a = point, b = point;
      a[k] -= h, b[k] += h;
      gradient[k] = static_cast<double>(field_(b)) - static_cast<double>(field_(a));
    }
    return unit_along(gradient);
  }

  /// Returns a lower bound of the distance from a point to the surface, if the Lipschitz constant holds; less
  /// than 0 where the field is.
  [[nodiscard]] double distance_bound(const Point& point) const {
    return detail::distance_bound(point, bounds_, lipschitz_,
                                  [&](const Point& p) { return static_cast<double>(field_(p)); });
  }

  /// Returns the bounds as they were given, with a margin.
  [[nodiscard]] Bounds bounds() const { return detail::widened(bounds_, 0x1p-20 * size_); }

  /// Returns this surface, recognized by its address. It is left as any place close to it is.
  [[nodiscard]] Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }

 private:
  /// Returns the place between a and b where a value changes its sign, to the last digits of t: a double has
  /// 53, and 60 halvings are more.
  [[nodiscard]] static double root_between(const auto& value, double a, double b) {
    const bool is_inside = value(a) < 0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (a + b);
      ((value(middle) < 0) == is_inside ? a : b) = middle;
    }
    return b;
  }

  F field_;
  Bounds bounds_{};
  double size_, lipschitz_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

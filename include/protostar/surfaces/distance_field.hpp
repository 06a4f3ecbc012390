// Surfaces of distance fields, which are marched with a proof; and by plain_field.hpp those of plain
// functions.
#pragma once

#include <algorithm>
#include <cmath>
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
#include "../ray_lanes.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"
#include "field_crossings.hpp"
#include "field_jumps.hpp"
#include "marched.hpp"
#include "plain_field.hpp"

namespace protostar::inline PROTOSTAR_ABI {

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
    crossings_of(ray).each(range, trace, [&](const Crossing& crossing, const auto&...) {
      if (lies_inside(*this, ray, crossing, range)) visit(crossing);
      return false;
    });
  }

  /// Returns a crossing, enclosed in double-double.
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return crossings_of(ray).exact_root(crossing);
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
  [[nodiscard]] detail::FieldCrossings<F> crossings_of(const Ray& ray) const {
    return {field_, setup_, ray, is_left_by(ray)};
  }

  [[nodiscard]] std::optional<std::pair<Crossing, MarchedRoot>> first_root(const Ray& ray, Interval range,
                                                                           auto& trace) const {
    std::optional<std::pair<Crossing, MarchedRoot>> first;
    crossings_of(ray).each(range, trace, [&](const Crossing& crossing, const MarchedRoot& root, const auto&) {
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
    const auto halves = halves_of(part);
    return halves && is_positive_over((*halves)[0], remaining) && is_positive_over((*halves)[1], remaining);
  }

  F field_;
  MarchSetup setup_;
};

template <DistanceField F>
Marched(F, const Bounds&) -> Marched<F>;
template <DistanceField F>
Marched(F, const Bounds&, int) -> Marched<F>;

}  // namespace protostar::inline PROTOSTAR_ABI

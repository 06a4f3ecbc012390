// Surfaces of plain functions of a point, which are marched without a proof.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <stdexcept>
#include <utility>

#include "../exact/distance_field.hpp"
#include "../magnitude.hpp"
#include "../march/field_bounds.hpp"
#include "../march/field_line.hpp"
#include "../shown.hpp"
#include "../surface.hpp"
#include "coordinates.hpp"
#include "marched.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Field as a plain function of a point, in double: the library knows no more of it than its values.
template <class F>
concept PlainField = !DistanceField<F> && std::copy_constructible<F> && requires(const F& field, Point p) {
  { field(p) } -> std::convertible_to<double>;
};

/// Surface of a plain function of a point, marched without a proof. The user's constant says how fast the
/// function changes at most: |f(p) − f(q)| ≤ lipschitz · |p − q|. If it does not hold, a ray may pass through
/// the surface. Even if it holds, nothing is proven: a ray hits where it comes closer to the surface than
/// 2^-40 of the bounds' size; a ray that starts as close as that hits nothing before it has got away.
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

template <PlainField F>
Marched(F, const Bounds&, double) -> Marched<F>;

namespace detail {

/// Tests whether a Marched can be made of a field and what follows it.
template <class F, class... Rest>
concept MakesMarched = (DistanceField<F> || PlainField<F>)&&std::constructible_from<Marched<F>, F, Rest...>;

/// Names arguments of which no Marched can be made.
template <class F, class... Rest>
struct NotMarched {};

}  // namespace detail

/// Stops the compiler with a sentence on why no surface can be made of the arguments.
template <class F, class... Rest>
class Marched<detail::NotMarched<F, Rest...>> : public detail::NoSurface {
  static_assert(DistanceField<F> || PlainField<F>,
                "Marched: the field is no function of a point that returns a number; write "
                "[](const auto& p) { return length(p) - 1.0; }, or take a const Point& and give a "
                "Lipschitz constant");
  static_assert(!PlainField<F>,
                "Marched: a function of a Point alone is followed by the bounds and a Lipschitz constant, "
                "which is 1 for a distance: Marched{field, Bounds{...}, 1.0}; one for any number type takes "
                "a const auto& and has neither `if` nor functions of std");
  static_assert(!DistanceField<F>,
                "Marched: the field is followed by the bounds: Marched{field, Bounds{...}}");

 public:
  Marched(const auto&...) {}
};

template <class F, class... Rest>
requires(!detail::MakesMarched<F, Rest...>) Marched(F, Rest...)
->Marched<detail::NotMarched<F, Rest...>>;

}  // namespace protostar::inline PROTOSTAR_ABI

// A distance field along a ray: F(t) = ±(f(origin + t · direction) − level), in double with a bound of its
// error, and enclosed in double or in double-double.
//
// With u = 2^-53, o the origin, d the direction and T the largest |t|: o + t·d comes out wrong by at most
// u (|o| + 2T|d|), and f changes at most L times as much, L being its Lipschitz constant. Steps of a march
// are sums t + s and differences of two t, which are rounded by u T twice and by 2u T once. Together with the
// rounding E_f of f itself, the error of F for all of these is at most
//   E = L u (2|o| + 6T|d|) + E_f.
// Hence a plain evaluation v proves F ≥ v − E there, and F > 0 at all parameters nearer to it than
// (v − E) / (L |d|).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "../bounds.hpp"
#include "../exact/distance_field.hpp"
#include "../interval.hpp"
#include "enclosed_line.hpp"
#include "march_steps.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Set-up of a field for marches: the box in which it is looked at, and what has been derived for a box that
/// is larger by `margin` on each side, a Lipschitz constant and a bound of the rounding of an evaluation.
struct MarchSetup {
  Bounds inside;
  double margin = 0;
  FieldBound bound;
};

namespace detail {

/// Returns the parameters of a line inside a box; they are not in order if there are none. They are rounded,
/// so the margin of a march has to be far wider than that.
[[nodiscard]] inline Interval inside_of(const Bounds& box, const Point& origin, const Vec3& direction) {
  Interval span{-infinity, infinity};
  for (int k = 0; k < 3; ++k) {
    const double o = origin[k], d = direction[k], low = box.min[k], high = box.max[k];
    if (d == 0) {
      if (!(low <= o && o <= high)) return {infinity, -infinity};
      continue;
    }
    const double a = (low - o) / d, b = (high - o) / d;
    span.min = std::max(span.min, std::min(a, b));
    span.max = std::min(span.max, std::max(a, b));
  }
  return span;
}

}  // namespace detail

/// A field F(t) along a ray. The sign turns it so that F > 0 on the side from which a march comes, and the
/// level makes F(0) = 0 for a ray that leaves its surface. Trace is told of each evaluation
/// (march_steps.hpp). It borrows all of them.
template <class F, class Trace>
class FieldLine {
 public:
  /// Precondition: the ray is proper.
  FieldLine(const F& field, const MarchSetup& setup, const Ray& ray, Trace& trace)
      : field_(field), ray_(ray), trace_(trace), line_(rounded_line(ray)) {
    in_double_ = detail::enclosed_line(line_);
    span_ = detail::inside_of(setup.inside, line_.origin, line_.direction);
    const double o = norm(line_.origin), d = norm(line_.direction);
    const double o_error = norm(line_.origin_error), d_error = norm(line_.direction_error);
    const double T = std::max(std::abs(span_.min), std::abs(span_.max));
    constexpr double u = 0x1p-53, more = 1 + 0x1p-40;  // more than the rounding of these formulas
    const double off = u * (2 * o + 6 * T * d) + 2 * (o_error + T * d_error);
    // The set-up says nothing of points that may come out beyond the margin: then only enclosures count.
    const double L = setup.bound.lipschitz;
    error_ = off < setup.margin / 2 ? (L * off + setup.bound.error) * more : infinity;
    reach_ = (1 - 0x1p-40) / (L * (d + d_error));
    // Squares of components that count are then above 2^-953, and lose nothing by underflow below 2^-1022.
    if (!(d > 0x1p-450 && reach_ > 0 && reach_ < infinity)) error_ = infinity;
    extent_ = largest(setup.inside.max - setup.inside.min) / (2 * d);
    // Points in double-double are off by a few 2^-104 of |o| + T|d|: by less than that in t.
    resolution_ = 0x1p-100 * (o / d + T);
  }

  FieldLine(const FieldLine&) = delete;
  FieldLine& operator=(const FieldLine&) = delete;

  /// Returns the part of the line inside the box of the field; empty if its ends are not in order.
  [[nodiscard]] Interval span() const { return span_; }

  /// Bound of the error of value(t), infinite if double proves nothing on this line.
  [[nodiscard]] double error() const { return error_; }

  /// Number by which a proven value is multiplied for the distance in t to which F keeps its sign.
  [[nodiscard]] double reach() const { return reach_; }

  /// Half the size of the field's box, as a difference of t.
  [[nodiscard]] double extent() const { return extent_; }

  /// Difference in t that lies below the digits of points in double-double.
  [[nodiscard]] double resolution() const { return resolution_; }

  [[nodiscard]] Trace& trace() { return trace_; }

  /// Turns F around: a march goes on behind a crossing, or leaves inward.
  void turn_to(double sign) { sign_ = sign; }
  [[nodiscard]] double sign() const { return sign_; }

  /// Takes f at t = 0 for the level. Its own error enters that of each value.
  void leave_level() {
    level_ = plain(0);
    level_error_ = error_;
    error_ *= 2;
    has_level_ = true;
  }

  /// Returns F(t) in double, off by at most error().
  [[nodiscard]] double value(double t) {
    const double v = sign_ * (plain(t) - level_);
    tell(Evaluation::value, t, t, v, v);
    return v;
  }

  /// Returns F(t), enclosed; in double by the bound of its error. The difference from the level and the sums
  /// here are rounded, each by u of its result.
  template <class B>
  [[nodiscard]] Enclosure<B> enclosed(B t) {
    if constexpr (std::is_same_v<B, double>) {
      const double v = value(t), error = error_ + 0x1p-50 * std::abs(v);
      return {v - error, v + error};
    } else {
      const Enclosure<B> v = turned(over(Enclosure<B>::at(t)) - level<B>());
      tell(Evaluation::precise_value, t.hi, t.hi, v.lower, v.upper);
      return v;
    }
  }

  /// Returns F over [a, b], enclosed, and the slope there: all F' lie in it, and so do all quotients (F(y) −
  /// F(x)) / (y − x), at kinks as well.
  template <class B>
  [[nodiscard]] Slope<Enclosure<B>> slope(B a, B b) {
    const auto& along = line<B>();
    const Enclosure<B> t{a, b};
    const auto coordinate = [&](int k) {
      return Slope<Enclosure<B>>{along.origin[k] + t * along.direction[k], along.direction[k]};
    };
    const Slope<Enclosure<B>> f =
        field_(FieldPoint<Slope<Enclosure<B>>>{coordinate(0), coordinate(1), coordinate(2)});
    const Slope<Enclosure<B>> result{turned(f.value - level<B>()), turned(f.slope)};
    tell(std::is_same_v<B, double> ? Evaluation::slope : Evaluation::precise_slope, static_cast<double>(a),
         static_cast<double>(b), result.value.lower, result.value.upper, result.slope.lower,
         result.slope.upper);
    return result;
  }

 private:
  /// Tells the trace of an evaluation over [a, b], and a trace that takes results of these.
  void tell(Evaluation kind, double a, double b, const auto&... result) {
    if constexpr (std::is_base_of_v<MarchListener, Trace>)
      trace_.evaluated(kind, a, b, {static_cast<double>(result)...});
    else
      trace_.evaluated(kind, a, b);
  }

  /// Returns the length of a vector, by operations that are rounded alike everywhere.
  [[nodiscard]] static double norm(const Vec3& v) { return std::sqrt(dot(v, v)); }
  [[nodiscard]] static double largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

  [[nodiscard]] double plain(double t) const {
    return plain_value(field_, line_.origin + t * line_.direction);
  }

  /// Returns f over an interval of t.
  template <class B>
  [[nodiscard]] Enclosure<B> over(const Enclosure<B>& t) {
    const auto& along = line<B>();
    const auto coordinate = [&](int k) { return along.origin[k] + t * along.direction[k]; };
    return field_(FieldPoint<Enclosure<B>>{coordinate(0), coordinate(1), coordinate(2)});
  }

  template <class B>
  [[nodiscard]] const detail::EnclosedLine<B>& line() {
    if constexpr (std::is_same_v<B, double>) {
      return in_double_;
    } else {
      if (!precise_) precise_ = detail::enclosed_exact_line(ray_);
      return *precise_;
    }
  }

  template <class B>
  [[nodiscard]] Enclosure<B> level() {
    if constexpr (std::is_same_v<B, double>) {
      const double error = level_error_ + 0x1p-50 * std::abs(level_);
      return {level_ - error, level_ + error};
    } else {
      if (!has_level_) return {};
      if (!precise_level_) precise_level_ = over(Enclosure<B>());
      return *precise_level_;
    }
  }

  template <class B>
  [[nodiscard]] Enclosure<B> turned(const Enclosure<B>& x) const {
    return sign_ > 0 ? x : -x;
  }

  const F& field_;
  const Ray& ray_;
  Trace& trace_;
  RoundedLine line_;
  detail::EnclosedLine<double> in_double_;
  std::optional<detail::EnclosedLine<DoubleDouble>> precise_;
  std::optional<Enclosure<DoubleDouble>> precise_level_;
  Interval span_;
  double error_ = 0, reach_ = 0, extent_ = 0, resolution_ = 0;
  double sign_ = 1, level_ = 0, level_error_ = 0;
  bool has_level_ = false;
};

}  // namespace protostar::inline PROTOSTAR_ABI

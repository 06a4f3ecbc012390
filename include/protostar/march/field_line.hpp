// A distance field along a ray: F(t) = ±(f(origin + t · direction) − level), in double with a bound of its
// error, and enclosed in double or in double-double.
//
// With u = 2^-53, o the origin, d the direction and T the largest |t|: o + t·d comes out wrong by at most
// u (|o| + 2T|d|), and f changes at most L times as much, L being its Lipschitz constant. Steps of a march
// are sums t + s and differences of two t, which are rounded by u T twice and by 2u T once. Together with the
// rounding E_f of f itself, the error of F for all of these is at most
//   E = L u (2|o| + 6T|d|) + E_f.
// Hence a plain evaluation v proves F ≥ v − E there, and F > 0 at all parameters nearer to it than
// (v − E) / (L |d|). If second derivatives of f along unit vectors are at least −K, those of F are at least
// −K |d|², its bend: F + ½ K |d|² t² is convex, and two values bound F from below behind them as well
// (march_steps.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "../bounds.hpp"
#include "../exact/distance_field.hpp"
#include "../exact/rounding.hpp"
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

/// Parameters t from min to max of a line, or of one in each lane; none if they are not in order.
template <class R>
struct Span {
  R min = R(-infinity), max = R(infinity);

  /// Cuts the span to the part where a coordinate o + t d is between two numbers.
  void narrow(const R& o, const R& d, double low, double high) {
    const auto is_along = d == R(0.0), is_between = R(low) <= o && o <= R(high);
    const R a = (R(low) - o) / d, b = (R(high) - o) / d;
    const R least = rounding::select(is_between, min, R(infinity));
    const R most = rounding::select(is_between, max, R(-infinity));
    min = rounding::select(is_along, least, rounding::max(min, rounding::min(a, b)));
    max = rounding::select(is_along, most, rounding::min(max, rounding::max(a, b)));
  }
};

/// Returns the parameters of a line inside a box, or of one in each lane; they are not in order if there are
/// none. They are rounded.
template <class R>
[[nodiscard]] Span<R> span_inside(const Bounds& box, const auto& origin, const auto& direction) {
  Span<R> span;
  span.narrow(origin.x, direction.x, box.min.x, box.max.x);
  span.narrow(origin.y, direction.y, box.min.y, box.max.y);
  span.narrow(origin.z, direction.z, box.min.z, box.max.z);
  return span;
}

/// Error of points o + t·d of a line, or of one in each lane, for |t| ≤ T, from the lengths of o and d and of
/// their errors: that of their rounding, twice as much for other roundings of t (above), and twice that of o
/// and d.
template <class R>
struct PointError {
  R off;
  decltype(R() < R()) is_known;  ///< true if points in double may be relied upon

  /// Takes the margin by which the box of a field is larger than its bounds, in which points surely count.
  ///
  /// Points that are off by half the margin are too far: the set-up of a field says nothing of those beyond
  /// its margin. Otherwise the line inside the box, by span_inside, contains what is in the bounds: an end of
  /// it, at a face, is rounded by 2u |t·d|, and 6u T|d| is in `off`, so that this is a sixth of the margin at
  /// most; and a line that is outside there by a quarter of the margin or more does not turn back, since its
  /// direction is off by 2^-20 of itself at most.
  PointError(double margin, const R& o, const R& d, const R& T, const R& o_error, const R& d_error)
      : off(R(0x1p-53) * (R(2) * o + R(6) * T * d) + R(2) * (o_error + T * d_error)),
        is_known(off < R(margin / 2) && d_error < R(0x1p-20) * d) {}
};

/// Returns the length of a vector, by operations that are rounded alike everywhere.
[[nodiscard]] inline double norm(const Vec3& v) { return std::sqrt(dot(v, v)); }

/// Line of a ray, and the part of it inside a box that is larger than the bounds of a field by a margin.
struct LineInBox : ModerateLine {
  Interval span;  ///< empty if its ends are not in order
  double o = norm(origin), d = norm(direction), d_error = norm(direction_error);
  PointError<double> points;

  /// Where points in double may come out beyond the margin, as from far away, the ends of the span are
  /// enclosed. A line without errors misses a box if it is beside it all along, or up to where t, forward or
  /// backward, exceeds the range of double.
  LineInBox(const Ray& ray, const Bounds& box, double margin)
      : ModerateLine(ray),
        span(span_of(box)),
        points(margin, o, d, largest_t(), norm(origin_error), d_error) {
    const bool is_beside = span.min == infinity || span.max == -infinity;
    if (!points.is_known && !(is_beside && ray.transform == nullptr))
      span = inside_of(box, enclosed_exact_line(ray, *this, unit));
  }

  /// Returns the largest |t| on the span.
  [[nodiscard]] double largest_t() const { return std::max(std::abs(span.min), std::abs(span.max)); }

 private:
  [[nodiscard]] Interval span_of(const Bounds& box) const {
    const auto rounded = span_inside<double>(box, origin, direction);
    return {rounded.min, rounded.max};
  }
};

/// Returns a lower bound of the second derivatives of f, or of −f if the sign is −1, along unit vectors.
[[nodiscard]] inline double least_curvature(const FieldBound& bound, double sign) {
  return sign > 0 ? bound.curvature.lower : -bound.curvature.upper;
}

/// Numbers of a march along a line, or along one in each lane.
template <class R>
struct LineScale {
  R error;       ///< bound of the error of plain values, infinite if double proves nothing on this line
  R reach;       ///< a proven value times this is the distance in t to which F keeps its sign
  R bend;        ///< second derivatives along unit vectors times this are those by t, at most
  R extent;      ///< half the size of the field's box, as a difference of t
  R resolution;  ///< difference in t below the digits of points in double-double

  /// Takes the errors of points on a line, the lengths of its origin and direction, with its error, and the
  /// largest |t| on it.
  LineScale(const MarchSetup& setup, const PointError<R>& points, const R& o, const R& d, const R& T,
            const R& d_error) {
    constexpr double more = 1 + 0x1p-40;  // more than the rounding of these formulas
    const R L(setup.bound.lipschitz);
    reach = R(1 - 0x1p-40) / (L * (d + d_error));
    bend = (d + d_error) * (d + d_error) * R(more);
    const auto is_known = points.is_known && R(0.0) < reach && reach < R(infinity);
    error = rounding::select(is_known, (L * points.off + R(setup.bound.error)) * R(more), R(infinity));
    const Vec3 size = setup.inside.max - setup.inside.min;
    extent = R(std::max({size.x, size.y, size.z})) / (R(2) * d);
    // Points in double-double are off by a few 2^-104 of |o| + T|d|: by less than that in t.
    resolution = R(0x1p-100) * (o / d + T);
  }
};

}  // namespace detail

/// Field F(t) = sign · (f(origin + t · direction) − level) along a ray. The sign makes F > 0 on the side from
/// which a march comes, and the level makes F(0) = 0 for a ray that leaves its surface; it is 0 for others.
/// The trace is told of each evaluation (march_steps.hpp). Field, set-up, ray and trace are borrowed.
template <class F, class Trace>
class FieldLine {
 public:
  using Number = double;
  using Truth = bool;

  /// Precondition: the ray is proper.
  FieldLine(const F& field, const MarchSetup& setup, const Ray& ray, Trace& trace)
      : field_(field),
        bound_(setup.bound),
        ray_(ray),
        trace_(trace),
        line_(ray, setup.inside, setup.margin),
        scale_(setup, line_.points, line_.o, line_.d, line_.largest_t(), line_.d_error) {
    in_double_ = detail::enclosed_line(line_);
  }

  FieldLine(const FieldLine&) = delete;
  FieldLine& operator=(const FieldLine&) = delete;

  /// Returns the part of the line inside the box of the field; empty if its ends are not in order.
  [[nodiscard]] Interval span() const { return line_.span; }

  /// Returns the factor from parameters t of this line to those of the ray.
  [[nodiscard]] double unit() const { return line_.unit; }

  /// Returns a bound of the error of value(t); infinite if double proves nothing on this line.
  [[nodiscard]] double error() const { return scale_.error; }

  /// Returns the factor from a proven value of F to the distance in t within which F keeps its sign.
  [[nodiscard]] double reach() const { return scale_.reach; }

  /// Tests whether second derivatives of F are known to be bounded from below.
  [[nodiscard]] bool is_bend_known() const { return detail::least_curvature(bound_, sign_) > -infinity; }

  /// Returns a number b ≥ 0 for which second derivatives of F by t are at least −b, if there is one
  /// (is_bend_known).
  [[nodiscard]] double bend() const {
    return scale_.bend * std::max(0.0, -detail::least_curvature(bound_, sign_));
  }

  /// Returns half the largest side of the field's box, as a difference of t.
  [[nodiscard]] double extent() const { return scale_.extent; }

  /// Returns a difference in t that is below the digits of points in double-double.
  [[nodiscard]] double resolution() const { return scale_.resolution; }

  /// Tells the trace of a proof about the parameters [a, b] of this line, if `is_proven`.
  void proven(MarchProof proof, bool is_proven, const DoubleDouble& a, const DoubleDouble& b) {
    if (is_proven) trace_.proven(proof, told(a), told(b));
  }

  /// Sets the sign of F, 1 or −1: it changes where a march goes on behind a crossing, or leaves inward.
  void turn_to(double sign) { sign_ = sign, is_kept_ = false; }
  [[nodiscard]] double sign() const { return sign_; }

  /// Makes f at t = 0 the level. The error of the level enters that of each value.
  void leave_level() {
    level_ = plain(0);
    level_error_ = scale_.error;
    scale_.error *= 2;
    has_level_ = true, is_kept_ = false;
  }

  /// Returns F(t) in double, off by at most error(). The last value is kept: where one part of a march ends,
  /// the next begins with it. `asked` is for marches in lanes (field_lines.hpp): one line alone asks.
  [[nodiscard]] double value(double t, bool /*asked*/ = true) {
    if (is_kept_ && t == kept_t_) return kept_;
    kept_ = sign_ * (plain(t) - level_), kept_t_ = t, is_kept_ = true;
    tell(Evaluation::value, t, t, kept_, kept_);
    return kept_;
  }

  /// Returns an enclosure of F(t): in double the value with its error on both sides, in double-double by
  /// arithmetic of enclosures. The difference from the level and the sums here are rounded by u of their
  /// results, for which 2^-50 |F| stands.
  template <class B>
  [[nodiscard]] Enclosure<B> enclosed(B t, bool /*asked*/ = true) {
    if constexpr (std::is_same_v<B, double>) {
      const double v = value(t), error = scale_.error + 0x1p-50 * std::abs(v);
      return {v - error, v + error};
    } else {
      const Enclosure<B> v = turned(over(Enclosure<B>::at(t)) - level<B>());
      tell(Evaluation::precise_value, t, t, v.lower, v.upper);
      return v;
    }
  }

  /// Returns enclosures of the values and slopes of F over the parameters [a, b]. All derivatives by t lie in
  /// that of the slopes, and so do all quotients (F(y) − F(x)) / (y − x), at kinks as well.
  template <class B>
  [[nodiscard, gnu::noinline]] Slope<Enclosure<B>> slope(B a, B b, bool /*asked*/ = true) {
    const auto& along = line<B>();
    const Enclosure<B> t{a, b};
    const auto coordinate = [&](int k) {
      return Slope<Enclosure<B>>{along.origin[k] + t * along.direction[k], along.direction[k]};
    };
    const Slope<Enclosure<B>> f =
        field_(FieldPoint<Slope<Enclosure<B>>>{coordinate(0), coordinate(1), coordinate(2)});
    const Slope<Enclosure<B>> result{turned(f.value - level<B>()), turned(f.slope)};
    tell(std::is_same_v<B, double> ? Evaluation::slope : Evaluation::precise_slope, a, b, result.value.lower,
         result.value.upper, result.slope.lower * B(1 / unit()), result.slope.upper * B(1 / unit()));
    return result;
  }

 private:
  /// Tells the trace of an evaluation over [a, b] of this line, and a MarchListener also of its result.
  void tell(Evaluation kind, const DoubleDouble& a, const DoubleDouble& b, const auto&... result) {
    if constexpr (std::is_base_of_v<MarchListener, Trace>)
      trace_.evaluated(kind, told(a), told(b), {static_cast<double>(result)...});
    else
      trace_.evaluated(kind, told(a), told(b));
  }

  /// Returns a parameter of the line as one of the ray, with the digits that the trace takes.
  [[nodiscard]] auto told(const DoubleDouble& t) const {
    const DoubleDouble of_ray(t.hi * unit(), t.lo * unit());
    if constexpr (std::is_base_of_v<MarchListener, Trace>)
      return of_ray;
    else
      return static_cast<double>(of_ray);
  }

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
      if (!precise_) precise_ = detail::enclosed_exact_line(ray_, line_, unit());
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
  const FieldBound& bound_;
  const Ray& ray_;
  Trace& trace_;
  detail::LineInBox line_;
  detail::EnclosedLine<double> in_double_;
  std::optional<detail::EnclosedLine<DoubleDouble>> precise_;
  std::optional<Enclosure<DoubleDouble>> precise_level_;
  detail::LineScale<double> scale_;
  double sign_ = 1, level_ = 0, level_error_ = 0;
  double kept_t_ = 0, kept_ = 0;
  bool has_level_ = false, is_kept_ = false;
};

}  // namespace protostar::inline PROTOSTAR_ABI

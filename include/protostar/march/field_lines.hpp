// A distance field along several rays at once, one in each lane, with the bits of each ray alone
// (field_line.hpp).
#pragma once

#include <algorithm>

#include "../simd/vectors.hpp"
#include "field_line.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Field F(t) along the rays of a packet, one in each lane. The rays must not leave the field's surface, nor
/// be mapped by an instance. The trace is told of each evaluation in a lane as of that of a single ray. The
/// functions are those of FieldLine; `asked` are the lanes whose results are wanted, and results in other
/// lanes may be anything. Field, set-up and trace are borrowed.
template <class F, class Trace>
class FieldLines {
 public:
  using Number = simd::Doubles;
  using Truth = simd::LaneMask;

  FieldLines(const F& field, const MarchSetup& setup, const simd::Vectors& origin,
             const simd::Vectors& direction, Trace& trace)
      : field_(field),
        bound_(setup.bound),
        trace_(trace),
        origin_(origin),
        direction_(direction),
        span_(detail::span_inside<Number>(setup.inside, origin, direction)),
        scale_(scale_of(setup, length(origin), length(direction),
                        simd::max(simd::abs(span_.min), simd::abs(span_.max)))) {}

  /// Returns the lanes that can be marched: they have finite rays with directions of moderate size, and known
  /// errors of values in double.
  [[nodiscard]] Truth is_known() const {
    return scale_.error < infinity && is_finite(origin_) && is_of_moderate_size(direction_);
  }

  /// Returns the parameters at which marches forward from the origins begin, 0 or where the box begins;
  /// infinity in lanes whose line has no part inside the box.
  [[nodiscard]] Number begin() const {
    const Truth is_there = span_.min < span_.max && simd::abs(span_.min) < infinity && span_.max < infinity;
    return select(is_there, simd::max(Number(0.0), span_.min), infinity);
  }

  [[nodiscard]] const detail::Span<Number>& span() const { return span_; }
  [[nodiscard]] Number error() const { return scale_.error; }
  [[nodiscard]] Number reach() const { return scale_.reach; }
  [[nodiscard]] bool is_bend_known() const { return detail::least_curvature(bound_, 1) > -infinity; }
  [[nodiscard]] Number bend() const {
    return scale_.bend * Number(std::max(0.0, -detail::least_curvature(bound_, 1)));
  }
  [[nodiscard]] Number extent() const { return scale_.extent; }
  [[nodiscard]] Number resolution() const { return scale_.resolution; }

  /// Returns F(t) in double in the lanes that ask, off by at most error().
  [[nodiscard]] Number value(Number t, Truth asked) {
    const Truth is_new = asked && !(t == kept_t_);
    if (!any(is_new)) return kept_;
    each(is_new, [&](int lane) { trace_.evaluated(Evaluation::value, t[lane], t[lane]); });
    kept_t_ = select(is_new, t, kept_t_), kept_ = select(is_new, plain(t), kept_);
    return kept_;
  }

  /// Returns an enclosure of F(t) in the lanes that ask: the value with its error on both sides.
  template <class B>
  [[nodiscard]] Enclosure<B> enclosed(B t, Truth asked) {
    const B v = value(t, asked), error = scale_.error + 0x1p-50 * simd::abs(v);
    return {v - error, v + error};
  }

  /// Returns enclosures of the values and slopes of F over [a, b], in the lanes that ask.
  template <class B>
  [[nodiscard]] Slope<Enclosure<B>> slope(B a, B b, Truth asked) {
    each(asked, [&](int lane) { trace_.evaluated(Evaluation::slope, a[lane], b[lane]); });
    return over(a, b);
  }

  /// Tells the trace of a proof about [a, b] in each of these lanes.
  void proven(MarchProof proof, Truth lanes, Number a, Number b) {
    each(lanes, [&](int lane) { trace_.proven(proof, a[lane], b[lane]); });
  }

 private:
  static detail::LineScale<Number> scale_of(const MarchSetup& setup, Number o, Number d, Number largest_t) {
    return {setup, {setup.margin, o, d, largest_t, 0.0, 0.0}, o, d, largest_t, 0.0};
  }

  static void each(Truth lanes, const auto& visit) {
    for (const int lane : simd::lanes_in(lanes)) visit(lane);
  }

  static Truth is_finite(const simd::Vectors& v) {
    const auto one = [](Number x) { return simd::abs(x) < infinity; };
    return one(v.x) && one(v.y) && one(v.z);
  }

  [[nodiscard]] Number plain(Number t) const { return plain_values(field_, origin_ + t * direction_); }

  /// Returns the field over [a, b], in a function of its own, with all operations inlined as in march.hpp.
  [[nodiscard, gnu::flatten, gnu::noinline]] Slope<Enclosure<Number>> over(Number a, Number b) const {
    using E = Enclosure<Number>;
    const E t{a, b};
    const auto coordinate = [&](Number o, Number d) {
      const E along = E::at(d);
      return Slope<E>{E::at(o) + t * along, along};
    };
    const Slope<E> f =
        field_(FieldPoint<Slope<E>>{coordinate(origin_.x, direction_.x), coordinate(origin_.y, direction_.y),
                                    coordinate(origin_.z, direction_.z)});
    return {f.value - E(0.0), f.slope};  // less the level, which is 0
  }

  const F& field_;
  const FieldBound& bound_;
  Trace& trace_;
  simd::Vectors origin_, direction_;
  detail::Span<Number> span_;
  detail::LineScale<Number> scale_;
  Number kept_t_ = -infinity, kept_ = 0.0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

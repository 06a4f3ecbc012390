// How a field varies over a box: its Lipschitz constant, and the rounding error of its plain values.
//
// Lipschitz constant: a number L with |f(p) − f(q)| ≤ L |p − q| for all points p and q of a box. It is
// derived from the field, as a Variation, by lipschitz_bound.
//
// A Variation describes a function on a box by a bound in each of five ways: its values, its gradient by
// components, its second derivatives (curvature.hpp), its Lipschitz constant, and the error of its
// Plain<double> value, which is computed by operations that round once, or not at all where the compiler
// fuses a product with a sum. u = 2^-53.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "../bounds.hpp"
#include "curvature.hpp"
#include "enclosure.hpp"
#include "field_point.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Bounds of a function on a box: the number type with which a field gives bounds of itself there. Bounds are
/// infinite where nothing is known, and never NaN.
class Variation {
 public:
  using Values = Enclosure<double>;

  Values value;        ///< contains all exact values
  Values gradient[3];  ///< contains Clarke's generalized gradient by components
  Curvature curvature;
  double lipschitz = 0;
  double error = 0;  ///< bound of |plain value − exact value|

  /// Constructs the constant 0.
  Variation() = default;

  /// Constructs a constant, which has no error.
  Variation(double number) : value(number) {}

  /// Returns coordinate k, 0, 1 or 2, of the points of a box, which is from `least` to `most`. A coordinate
  /// has no error here: rounded points of a ray are taken into account along it (march/field_line.hpp).
  [[nodiscard]] static Variation of_coordinate(int k, double least, double most) {
    Variation coordinate;
    coordinate.value = {least, most};
    coordinate.gradient[k] = 1.0;
    coordinate.lipschitz = 1;
    return coordinate;
  }

  friend Variation operator-(Variation a) {
    a.value = -a.value;
    for (Values& g : a.gradient) g = -g;
    a.curvature = -a.curvature;
    return a;
  }
  friend Variation operator+(const Variation& a, const Variation& b) {
    Variation sum;
    sum.value = a.value + b.value;
    for (int k = 0; k < 3; ++k) sum.gradient[k] = a.gradient[k] + b.gradient[k];
    sum.curvature = a.curvature + b.curvature;
    sum.set_lipschitz(a.lipschitz + b.lipschitz);
    sum.set_error(a.error + b.error, sum.value);
    return sum;
  }
  friend Variation operator-(const Variation& a, const Variation& b) { return a + -b; }

  /// Returns the product. With errors e of a and f of b, a' b' is off by |a| f + |b| e + e f.
  friend Variation operator*(const Variation& a, const Variation& b) {
    const double p = a.value.magnitude(), q = b.value.magnitude();
    Variation product;
    product.value = a.value * b.value;
    for (int k = 0; k < 3; ++k) product.gradient[k] = a.gradient[k] * b.value + b.gradient[k] * a.value;
    product.curvature =
        b.value * a.curvature + a.value * b.curvature + Curvature::of_product(a.gradient, b.gradient);
    product.set_lipschitz(times(a.lipschitz, q) + times(b.lipschitz, p));
    product.set_error(times(p, b.error) + times(q, a.error) + times(a.error, b.error) + tiny, product.value);
    return product;
  }

  /// Returns the quotient r = a/b. With errors e of a and f of b, a'/b' is off by (e + |r| f) / (|b| − f).
  /// The product rule for a = r b gives its second derivatives. A product here loses up to 2^-1075 by
  /// underflow, which is no longer small when it is divided by a small number: `lost` is added before. If the
  /// divisor may be 0, nothing is known.
  friend Variation operator/(const Variation& a, const Variation& b) {
    const double least = abs(b.value).lower - b.error;
    if (!(least > 0)) return unknown();
    Variation ratio;
    ratio.value = a.value / b.value;
    for (int k = 0; k < 3; ++k) ratio.gradient[k] = (a.gradient[k] - ratio.value * b.gradient[k]) / b.value;
    ratio.curvature =
        (Values(1.0) / b.value) * (a.curvature - Curvature::of_product(ratio.gradient, b.gradient)) +
        -(ratio.value / b.value) * b.curvature;
    const double size = ratio.value.magnitude();
    ratio.set_lipschitz((a.lipschitz + times(size, b.lipschitz) + lost) / least);
    ratio.set_error((a.error + times(size, b.error) + lost) / least + tiny, ratio.value);
    return ratio;
  }

  // min, max, abs, fold and wrap of an approximate number are off by its own error at most: they change by no
  // more than their arguments do, and round nothing.

  friend Variation min(const Variation& a, const Variation& b) {
    return of_smaller(a.value, b.value, a, b, min(a.value, b.value), {infinity, 0});
  }
  friend Variation max(const Variation& a, const Variation& b) {
    return of_smaller(b.value, a.value, a, b, max(a.value, b.value), {0, infinity});
  }
  friend Variation abs(const Variation& a) {
    return of_smaller(-a.value, a.value, a, -a, abs(a.value), {0, infinity});
  }
  friend Variation fold(const Variation& a) {
    const double first = std::floor(a.value.lower), last = std::floor(a.value.upper);
    const Variation falling = -a;
    Variation folded = first < last ? either(a, falling) : (std::floor(first / 2) == first / 2 ? a : falling);
    folded.value = fold(a.value);
    // A kink on the common face of two boxes, as at floor(lower) = lower, counts in one of them.
    if (first < last) folded.curvature = Curvature::unknown();
    return folded;
  }

  /// Returns the difference from the nearest integer, with the gradient and the error that it has away from
  /// its jumps. A rounded argument may be on the other side of a jump, where the plain value is off by 1; a
  /// field made with wrap has to be continuous there (Slope's wrap), and is off by no more than elsewhere.
  friend Variation wrap(const Variation& a) {
    Variation wrapped = a;
    wrapped.value = wrap(a.value);
    if (rounding::nearest_integer(a.value.lower) < rounding::nearest_integer(a.value.upper))
      wrapped.curvature = Curvature::unknown();  // a function that does not jump there may have a kink
    return wrapped;
  }

  friend Variation square(const Variation& a) {
    Variation product = a * a;
    product.value = square(a.value);
    product.curvature = Values(2.0) * (a.value * a.curvature + Curvature::of_square(a.gradient));
    return product;
  }

  /// Returns the square root. √a and √b differ by |a − b| / (√a + √b), hence by √|a − b| at most. If a may be
  /// 0, the Lipschitz constant is infinite.
  friend Variation sqrt(const Variation& a) {
    Variation root;
    root.value = sqrt(a.value);
    const double least = root.value.lower;
    for (int k = 0; k < 3; ++k) root.gradient[k] = a.gradient[k] / (root.value * 2.0);
    root.curvature = least > 0
                         ? (Values(0.5) / root.value) *
                               (a.curvature - (Values(0.5) / a.value) * Curvature::of_square(a.gradient))
                         : Curvature::unknown();
    root.set_lipschitz(least > 0 ? a.lipschitz / (2 * least) : infinity);
    root.set_error(least > 0 ? smaller(std::sqrt(a.error), a.error / least) : std::sqrt(a.error), root.value);
    return root;
  }

  /// Returns the smooth minimum m, for k > 0; nothing is known for other k, or if 1/4k is beyond the range of
  /// double. It changes by at most as much as the larger of the changes of a and b: its derivatives by them
  /// are weights with the sum 1. It is concave in a and b, and its second derivative by a − b is −1/2k or 0,
  /// which counts (L_a + L_b)² times at most.
  ///
  /// Roundings of the plain value: h = max(k − |a − b|, 0) ≤ k has u (|a| + |b|) + u k, which count h/2k ≤ ½
  /// in h²/4k ≤ k/4; h·h, ¼/k and their product have 3u of it, and the difference u (|m| + k/4).
  friend Variation smooth_min(const Variation& a, const Variation& b, double k) {
    if (!(k > 0 && 0.25 / k < infinity)) return unknown();
    const Values weight = clamp((b.value - a.value) / (Values(2.0) * k) + 0.5, 0, 1);
    Variation mixed = either(a, b);
    for (int i = 0; i < 3; ++i)
      mixed.gradient[i] = common(mixed.gradient[i], b.gradient[i] + weight * (a.gradient[i] - b.gradient[i]));
    mixed.curvature = mixed.curvature.widened(
        larger_by_rounding * (times(a.lipschitz + b.lipschitz, a.lipschitz + b.lipschitz) + lost) / (2 * k) +
            lost,
        0);
    if (weight.lower >= 1) mixed.lipschitz = a.lipschitz;
    if (weight.upper <= 0) mixed.lipschitz = b.lipschitz;
    mixed.set_lipschitz(mixed.lipschitz);
    mixed.value = smooth_min(a.value, b.value, k);
    const double sizes = a.value.magnitude() + a.error + b.value.magnitude() + b.error + k;
    mixed.set_error(mixed.error + 2 * u * sizes + tiny, mixed.value);
    return mixed;
  }

  /// Returns the length of a vector of at most 16 components. Squares and their sum have a relative error of
  /// n u, since no term is negative, which counts half in the root. The root itself is rounded once more
  /// (set_error). With e = v/|v|: |v| + e·δ ≤ |v + δ| ≤ |v| + e·δ + |δ|²/2|v|, and |δ| is at most |J| |h| for
  /// a change h of the point.
  template <std::size_t n>
  friend Variation length_of(const Variation (&v)[n]) {
    static_assert(n <= 16, "length_of: at most 16 components");  // larger_by_rounding holds for these
    constexpr double roundings = std::max(3.0, 0.5 * n);
    Values values[n];
    for (std::size_t i = 0; i < n; ++i) values[i] = v[i].value;
    Variation length;
    length.value = length_of(values);
    for (std::size_t i = 0; i < n; ++i) {
      const Values part = unit_component(values[i], length.value);
      for (int k = 0; k < 3; ++k) length.gradient[k] = length.gradient[k] + part * v[i].gradient[k];
      length.curvature = length.curvature + part * v[i].curvature;
    }
    const double norm = norm_of_rows(v), least = length.value.lower;
    length.curvature =
        length.curvature.widened(0, least > 0 ? larger_by_rounding * times(norm, norm) / least : infinity);
    length.set_lipschitz(norm);
    double squares = 0;
    for (const Variation& component : v) squares += component.error * component.error;
    const double off = std::sqrt(squares) + 0x1p-500;  // 2^-500 exceeds the root of all underflow
    length.set_error(off + roundings * u * (length.value.magnitude() + off), length.value);
    return length;
  }

  /// Returns the signed distance of q from the vectors without a positive component, which changes by no
  /// more than |q| does, as distances do. Its plain value is a sum. It is convex in q, as the distance from a
  /// convex set is, with a gradient whose components are in [0, 1].
  template <std::size_t n>
  friend Variation signed_length_of(const Variation (&q)[n]) {
    Variation parts[n], largest = q[0];
    for (std::size_t i = 0; i < n; ++i) parts[i] = max(q[i], 0.0), largest = max(largest, q[i]);
    const Variation outside = length_of(parts), inside = min(largest, 0.0), sum = outside + inside;
    Variation distance = of_smaller(Values(0.0), largest.value, outside, largest, sum.value, {});
    distance.curvature = {};
    for (const Variation& component : q)
      distance.curvature = distance.curvature + Values(0, 1) * component.curvature;
    distance.curvature = distance.curvature.widened(0, infinity);
    distance.set_lipschitz(smaller(distance.lipschitz, norm_of_rows(q)));
    distance.error = sum.error;
    return distance;
  }

  /// Returns f(a) for a function f of one number: `values`, `derivatives` and `second_derivatives` enclose
  /// those of f on a.value, `steepest` is the largest magnitude of its derivatives at numbers that are at
  /// most a.error away from a.value, and `own` bounds the error of its plain value for an exact argument.
  friend Variation composed(const Variation& a, const Values& values, const Values& derivatives,
                            const Values& second_derivatives, double steepest, double own) {
    Variation f;
    f.value = values;
    f.curvature = derivatives * a.curvature + second_derivatives * Curvature::of_square(a.gradient);
    for (int k = 0; k < 3; ++k) f.gradient[k] = derivatives * a.gradient[k];
    f.set_lipschitz(times(derivatives.magnitude(), a.lipschitz));
    f.error = known(larger_by_rounding * (times(steepest, a.error) + own));
    return f;
  }

  /// Returns bounds that say nothing.
  [[nodiscard]] static Variation unknown() {
    Variation variation;
    variation.value = Values::whole();
    for (Values& g : variation.gradient) g = Values::whole();
    variation.curvature = Curvature::unknown();
    variation.lipschitz = variation.error = infinity;
    return variation;
  }

 private:
  static constexpr double u = 0x1p-53;
  static constexpr double tiny = 0x1p-1000;  ///< exceeds all underflow of a few operations
  static constexpr double lost = 0x1p-1074;  ///< exceeds the underflow of one product

  /// Exceeds the relative error of a bound, which is computed by fewer than 32 roundings, of sums of numbers
  /// that are not negative, products and roots.
  static constexpr double larger_by_rounding = 1 + 0x1p-48;

  static double smaller(double a, double b) { return b < a ? b : a; }
  static double larger(double a, double b) { return a < b ? b : a; }

  /// Returns a · b for bounds, where 0 stays 0 beside ∞.
  static double times(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

  /// Returns a bound, and ∞ instead of NaN.
  static double known(double bound) { return bound >= 0 ? bound : infinity; }

  /// Sets the Lipschitz constant to the smaller of a bound and the largest length of a gradient, of which
  /// 2^-500 exceeds the root of all underflow. 2^-1060 exceeds the underflow of a bound, of a few operations.
  void set_lipschitz(double bound) {
    double squares = 0;
    for (const Values& g : gradient) squares += g.magnitude() * g.magnitude();
    lipschitz = larger_by_rounding * smaller(known(bound), known(std::sqrt(squares) + 0x1p-500)) + 0x1p-1060;
  }

  /// Sets the error to that of the arguments, and one rounding of a value of the function.
  void set_error(double of_arguments, const Values& values) {
    error = known(larger_by_rounding * (of_arguments + u * (values.magnitude() + of_arguments)));
  }

  /// Returns bounds for a function that is a or b at each point.
  static Variation either(const Variation& a, const Variation& b) {
    Variation one;
    one.value = hull(a.value, b.value);
    for (int k = 0; k < 3; ++k) one.gradient[k] = hull(a.gradient[k], b.gradient[k]);
    one.curvature = Curvature::either(a.curvature, b.curvature);
    one.lipschitz = larger(a.lipschitz, b.lipschitz);
    one.error = larger(a.error, b.error);
    return one;
  }

  /// Jumps of the gradient where branches meet: infinite if it may fall, or rise, along a line.
  struct Kinks {
    double fall = 0, rise = 0;
  };

  /// Returns bounds for a function that is p where a < b, and q where b < a.
  static Variation of_smaller(const Values& a, const Values& b, const Variation& p, const Variation& q,
                              const Values& values, const Kinks& kinks) {
    const bool is_p = a.upper < b.lower, is_q = b.upper < a.lower;
    Variation chosen = is_p ? p : is_q ? q : either(p, q);
    if (!is_p && !is_q) chosen.curvature = chosen.curvature.widened(kinks.fall, kinks.rise);
    chosen.value = values;
    chosen.error = larger(p.error, q.error);
    return chosen;
  }

  /// Returns a bound of the matrix norm |J| of the gradients of v, its rows r_i: |J|² is at most the largest
  /// sum over k of |r_i · r_k|, a row sum of J Jᵀ. Rows for different axes add nothing, so that the length of
  /// a vector of distances along the axes has the constant 1. 2^-500 exceeds the root of all underflow.
  template <std::size_t n>
  static double norm_of_rows(const Variation (&v)[n]) {
    double most = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double row = times(v[i].lipschitz, v[i].lipschitz);
      for (std::size_t k = 0; k < n; ++k) {
        if (k == i) continue;
        double product = 0;
        for (int axis = 0; axis < 3; ++axis)
          product += times(v[i].gradient[axis].magnitude(), v[k].gradient[axis].magnitude());
        row += smaller(product, times(v[i].lipschitz, v[k].lipschitz));
      }
      most = larger(most, row);
    }
    return std::sqrt(most) + 0x1p-500;
  }
};

/// Bounds of a field on a box.
struct FieldBound {
  double lipschitz = infinity;  ///< Lipschitz constant
  double error = infinity;      ///< bound of the error of a Plain<double> value
  /// Second derivatives along unit vectors; an end is infinite if the gradient may jump (curvature.hpp).
  Enclosure<double> curvature = Enclosure<double>::whole();
};

/// Returns the variation of a field over a box.
[[nodiscard]] Variation variation_over(const auto& field, const Bounds& box) {
  const auto coordinate = [&](int k) { return Variation::of_coordinate(k, box.min[k], box.max[k]); };
  return field(FieldPoint<Variation>{coordinate(0), coordinate(1), coordinate(2)});
}

/// Returns bounds of a field on a box, in scene units, by branch and bound: the part of the box with the
/// largest Lipschitz constant is halved, across its longest side, until the constant at the middle of such a
/// part shows that no division can make that of the box smaller by more than 2^-20 of itself. It takes at
/// most `evaluations` evaluations of the field, but always one. Bounds are infinite if the field has none.
[[nodiscard]] FieldBound lipschitz_bound(const auto& field, const Bounds& box, int evaluations) {
  struct Part {
    Bounds box;
    FieldBound bound;
    bool operator<(const Part& other) const { return bound.lipschitz < other.bound.lipschitz; }
  };
  const auto part = [&](const Bounds& of, const FieldBound& whole) {
    const Variation variation = variation_over(field, of);
    return Part{of,
                {std::min(variation.lipschitz, whole.lipschitz), std::min(variation.error, whole.error),
                 common(variation.curvature.range(), whole.curvature)}};
  };
  std::vector<Part> parts{part(box, {})};  // a heap
  double seen = 0;                         // a constant that some point needs
  for (int remaining = evaluations - 1; remaining >= 3; remaining -= 3) {
    const Part worst = parts.front();
    const auto halves = halves_of(worst.box);
    if (!halves) break;
    const Point center = center_of(worst.box);
    seen = std::max(seen, variation_over(field, {center, center}).lipschitz);
    if (worst.bound.lipschitz <= (1 + 0x1p-20) * seen) break;
    std::pop_heap(parts.begin(), parts.end());
    parts.back() = part((*halves)[0], worst.bound);
    std::push_heap(parts.begin(), parts.end());
    parts.push_back(part((*halves)[1], worst.bound));
    std::push_heap(parts.begin(), parts.end());
  }
  FieldBound bound{parts.front().bound.lipschitz, 0, parts.front().bound.curvature};
  for (const Part& of : parts) {
    bound.error = std::max(bound.error, of.bound.error);
    bound.curvature = hull(bound.curvature, of.bound.curvature);
  }
  return bound;
}

}  // namespace protostar::inline PROTOSTAR_ABI

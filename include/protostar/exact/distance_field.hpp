// Distance fields: functions of a point, each written once, that are evaluated with any number type.
//
//   const auto sphere = [](const auto& p) { return length(p) - 1.0; };
//   plain_value(sphere, {3, 0, 0});                                  // 2, rounded as in double
//   value_at<double>(sphere, origin, direction, t);                  // enclosure of values, t an interval
//   slope_at<double>(sphere, origin, direction, t);                  // enclosures of values and slopes
//   lipschitz_bound(sphere, bounds, 1000);                           // {Lipschitz constant, error}
//
// A distance field is positive outside of its surface, 0 on it and negative inside, and continuous. Values
// and coordinates are in scene units.
#pragma once

#include <concepts>

#include "../bounds.hpp"
#include "../simd/vectors.hpp"
#include "../vec3.hpp"
#include "enclosure.hpp"
#include "field_point.hpp"
#include "functions.hpp"
#include "lipschitz.hpp"
#include "plain.hpp"
#include "slope.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Function of a point whose coordinates have number type T, with a result of that type or a constant.
template <class F, class T>
concept FieldOver = requires(const F& field, const FieldPoint<T>& p) {
  { field(p) } -> std::convertible_to<T>;
};

/// Distance field: a function of a FieldPoint<T> with each number type T of the library. In a generic lambda
/// `[](const auto& p) { … }`, what a number type lacks is an error inside the lambda.
template <class F>
concept DistanceField =
    FieldOver<F, Plain<double>> && FieldOver<F, Plain<simd::Doubles>> && FieldOver<F, Enclosure<double>> &&
    FieldOver<F, Enclosure<DoubleDouble>> && FieldOver<F, Slope<Enclosure<double>>> &&
    FieldOver<F, Slope<Enclosure<DoubleDouble>>> && FieldOver<F, Variation>;

/// Names each number type that a field cannot be evaluated with, as errors of the compiler.
template <class F>
constexpr void require_distance_field() {
  static_assert(
      FieldOver<F, Plain<double>>,
      "DistanceField: the field cannot be called as f(FieldPoint<Plain<double>>), or returns no number; "
      "write it as [](const auto& p) { return length(p) - 1.0; }");
  static_assert(
      !FieldOver<F, Plain<double>> || FieldOver<F, Plain<simd::Doubles>>,
      "DistanceField: the field cannot be called as f(FieldPoint<Plain<simd::Doubles>>); take the point "
      "as `const auto& p`, so that it may have any number type");
  static_assert(!FieldOver<F, Plain<double>> ||
                    (FieldOver<F, Enclosure<double>> && FieldOver<F, Enclosure<DoubleDouble>>),
                "DistanceField: the field cannot be called as f(FieldPoint<Enclosure<B>>) for B = double and "
                "DoubleDouble; use only the operations of exact/enclosure.hpp and exact/functions.hpp");
  static_assert(
      !FieldOver<F, Plain<double>> ||
          (FieldOver<F, Slope<Enclosure<double>>> && FieldOver<F, Slope<Enclosure<DoubleDouble>>>),
      "DistanceField: the field cannot be called as f(FieldPoint<Slope<Enclosure<B>>>) for B = double "
      "and DoubleDouble; use only the operations of exact/slope.hpp and exact/functions.hpp");
  static_assert(
      !FieldOver<F, Plain<double>> || FieldOver<F, Variation>,
      "DistanceField: the field cannot be called as f(FieldPoint<Variation>); use only the operations of "
      "exact/lipschitz.hpp and exact/functions.hpp");
}

/// Returns a field's value at a point, with the rounding errors of double.
[[nodiscard]] double plain_value(const auto& field, const Point& p) {
  const Plain<double> value = field(FieldPoint<Plain<double>>{p.x, p.y, p.z});
  return value.value;
}

/// Returns a field's values at a point in each lane, with the same bits as plain_value.
[[nodiscard]] simd::Doubles plain_values(const auto& field, const simd::Vectors& p) {
  using Lanes = Plain<simd::Doubles>;
  const Lanes value = field(FieldPoint<Lanes>{Lanes::of(p.x), Lanes::of(p.y), Lanes::of(p.z)});
  return value.value;
}

/// Returns an enclosure of a field's values at the points origin + t · direction, for t in an interval.
template <class B>
[[nodiscard]] Enclosure<B> value_at(const auto& field, const Point& origin, const Vec3& direction,
                                    const Enclosure<B>& t) {
  const auto coordinate = [&](int k) { return t * direction[k] + origin[k]; };
  return field(FieldPoint<Enclosure<B>>{coordinate(0), coordinate(1), coordinate(2)});
}

/// Returns enclosures of a field's values at the points origin + t · direction, for t in an interval, and of
/// its slopes there, which are derivatives by t: for a direction of length 1, per scene unit.
template <class B>
[[nodiscard]] Slope<Enclosure<B>> slope_at(const auto& field, const Point& origin, const Vec3& direction,
                                           const Enclosure<B>& t) {
  using Number = Slope<Enclosure<B>>;
  const auto coordinate = [&](int k) { return Number{t * direction[k] + origin[k], direction[k]}; };
  return field(FieldPoint<Number>{coordinate(0), coordinate(1), coordinate(2)});
}

}  // namespace protostar::inline PROTOSTAR_ABI

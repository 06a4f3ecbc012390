// The line of a ray for a march: with a direction of moderate size, and as enclosed numbers, in double and in
// double-double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "../bounds.hpp"
#include "../exact/enclosure.hpp"
#include "../interval.hpp"
#include "../numeric/scale.hpp"
#include "../transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Line of a ray in doubles whose direction is of moderate size, so that squares of it are in the range of
/// double. The parameter `t` of the ray is `unit` times that of the line.
struct ModerateLine : RoundedLine {
  double unit = 1;  ///< a power of two from 2^-1000 to 2^1000

  /// Takes the line of a ray. The smallest direction, 2^-1074, becomes one of 2^-74. A component that
  /// underflows is off by 2^-1075 at most; 2^-1060 is added to its error.
  explicit ModerateLine(const Ray& ray) : RoundedLine(rounded_line(ray)) {
    if (is_of_moderate_size(direction)) return;
    // The largest component comes to [1, 2), but for factors beyond 2^±1000.
    unit = power_of_two(std::clamp(1 - exponent_of({direction}), -1000, 1000));
    for (int k = 0; k < 3; ++k) {
      const double given = direction[k], error = direction_error[k];
      direction[k] *= unit;
      if (direction[k] / unit != given || error != 0) direction_error[k] = unit * error + 0x1p-1060;
    }
  }
};

/// Line of the points origin + t · direction, whose numbers are enclosed.
template <class B>
struct EnclosedLine {
  Enclosure<B> origin[3], direction[3];
};

/// Returns a line in double as enclosed numbers: each number with its error on both sides.
[[nodiscard]] inline EnclosedLine<double> enclosed_line(const RoundedLine& line) {
  EnclosedLine<double> result;
  for (int k = 0; k < 3; ++k) {
    // The error is far above the rounding of the sums here, so twice the error makes up for both.
    const double o = line.origin[k], d = line.direction[k];
    const double o_error = 2 * line.origin_error[k], d_error = 2 * line.direction_error[k];
    result.origin[k] = {o - o_error, o + o_error};
    result.direction[k] = {d - d_error, d + d_error};
  }
  return result;
}

/// Returns an enclosure of x/weight for weight ≠ 0. Both are rounded to double-double with relative errors of
/// 2^-103, and a quotient of two such numbers has one of less than 2^-101; the enclosure is twice as wide.
/// The exponents of both are kept apart, so that only the quotient itself may leave the range of double:
/// below it 2^-1060 is added, which exceeds the last bit of a double, and above it nothing is known.
[[nodiscard]] inline Enclosure<DoubleDouble> enclosed_quotient(const ExactNumber& x,
                                                               const ExactNumber::Approximation& weight) {
  if (x.sign() == 0) return {};
  const ExactNumber::Approximation of_x = x.approximation();
  const DoubleDouble q = of_x.value / weight.value, margin = std::abs(q.hi) * 0x1p-100;
  const int exponent = of_x.exponent - weight.exponent;
  const auto end = [exponent](DoubleDouble e) {
    return DoubleDouble(std::ldexp(e.hi, exponent), std::ldexp(e.lo, exponent));
  };
  const DoubleDouble lower = end(q - margin), upper = end(q + margin);
  if (!(std::isfinite(lower.hi) && std::isfinite(upper.hi))) return Enclosure<DoubleDouble>::whole();
  if (std::abs(lower.hi) > 0x1p-900) return {lower, upper};
  return {lower - DoubleDouble(0x1p-1060), upper + DoubleDouble(0x1p-1060)};
}

/// Returns the line of a ray in double-double, from that in double, its direction times `unit`: exact, or
/// for a ray that an instance has mapped, with the errors of enclosed_quotient.
[[nodiscard, gnu::noinline, gnu::cold]] inline EnclosedLine<DoubleDouble> enclosed_exact_line(
    const Ray& ray, const RoundedLine& rounded, double unit = 1) {
  EnclosedLine<DoubleDouble> result;
  if (ray.transform == nullptr) {
    for (int k = 0; k < 3; ++k) {
      const DoubleDouble d = rounded.direction[k], error = 2 * rounded.direction_error[k];
      result.origin[k] = Enclosure<DoubleDouble>(rounded.origin[k]),
      result.direction[k] = {d - error, d + error};
    }
    return result;
  }
  const ExactLine line = exact_line(ray);
  const ExactNumber::Approximation weight = line.weight.approximation();
  for (std::size_t k = 0; k < 3; ++k) {
    result.origin[k] = enclosed_quotient(line.origin[k], weight);
    result.direction[k] = enclosed_quotient(ExactNumber(unit) * line.direction[k], weight);
  }
  return result;
}

/// Returns the parameters of a line inside a box, rounded outward by less than two last places. There are
/// none for a line beside the box that goes along its faces, or comes to it beyond the range of double.
[[nodiscard, gnu::noinline, gnu::cold]] inline Interval inside_of(const Bounds& box,
                                                                  const EnclosedLine<DoubleDouble>& line) {
  constexpr double most = std::numeric_limits<double>::max();
  Interval span{-most, most};
  for (int k = 0; k < 3; ++k) {
    using E = Enclosure<DoubleDouble>;
    // They are sixteenths, so that a sum of four quotients overflows for no t in the range of double.
    const E to_min = (E(box.min[k]) - line.origin[k]) * 0x1p-4,
            to_max = (E(box.max[k]) - line.origin[k]) * 0x1p-4;
    // A quotient by a tiny number would be all numbers (rounding::least_divisor): `scale` makes it larger.
    const DoubleDouble size = line.direction[k].magnitude();
    const double scale =
        size.hi < 0x1p-100 ? power_of_two(std::clamp(1 - exponent_of({Vec3(size.hi)}), -1000, 1000)) : 1;
    const E d{line.direction[k].lower * DoubleDouble(scale), line.direction[k].upper * DoubleDouble(scale)};
    // A quotient is all numbers if the direction may be 0, or t overflows. A line beside a face has no t in
    // the box if its t at the face overflows even for the largest direction.
    const E largest = E::at(size * DoubleDouble(scale));
    const auto is_beyond = [&](const E& to_face) {
      return !(std::abs((to_face / largest).lower.hi * scale) < infinity);
    };
    if (to_min.lower.hi > 0 && is_beyond(to_min)) return {infinity, -infinity};
    if (to_max.upper.hi < 0 && is_beyond(to_max)) return {infinity, -infinity};
    const E to_first = d.upper.hi < 0 ? to_max : to_min, to_last = d.upper.hi < 0 ? to_min : to_max;
    span.min = std::max(span.min, std::nextafter(16 * (to_first / d).lower.hi * scale, -infinity));
    span.max = std::min(span.max, std::nextafter(16 * (to_last / d).upper.hi * scale, infinity));
  }
  return span;
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

// The line of a ray as enclosed numbers, in double and in double-double.
#pragma once

#include <cmath>
#include <cstddef>

#include "../exact/enclosure.hpp"
#include "../transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Line of points whose coordinates are enclosed.
template <class B>
struct EnclosedLine {
  Enclosure<B> origin[3], direction[3];
};

/// Returns the line of a ray in double: exact, or for a ray that an instance has mapped, with the errors of
/// its numbers.
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

/// Returns the line of a ray in double-double. Exact numbers are rounded to it with relative errors of
/// 2^-103, and a quotient of two has one of less than 2^-101; the enclosure is twice as wide.
[[nodiscard, gnu::noinline, gnu::cold]] inline EnclosedLine<DoubleDouble> enclosed_exact_line(
    const Ray& ray) {
  EnclosedLine<DoubleDouble> result;
  const auto at = [](double x) { return Enclosure<DoubleDouble>{DoubleDouble(x), DoubleDouble(x)}; };
  if (ray.transform == nullptr) {
    for (int k = 0; k < 3; ++k)
      result.origin[k] = at(ray.origin[k]), result.direction[k] = at(ray.direction[k]);
    return result;
  }
  const ExactLine line = exact_line(ray);
  const DoubleDouble weight(line.weight);
  const auto quotient = [&](const ExactNumber& x) {
    const DoubleDouble q = DoubleDouble(x) / weight, margin = std::abs(q.hi) * 0x1p-100;
    return Enclosure<DoubleDouble>{q - margin, q + margin};
  };
  for (std::size_t k = 0; k < 3; ++k) {
    result.origin[k] = quotient(line.origin[k]);
    result.direction[k] = quotient(line.direction[k]);
  }
  return result;
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

// Rays in the object space of an instance, which are rounded, and the exact lines that they stand for.
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>

#include "numeric/affine.hpp"
#include "numeric/equation.hpp"
#include "ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Outer ray and map of a ray that an instance has mapped, with rounding, into its object space
/// (Ray::transform). It borrows both.
struct RayTransform {
  const Ray& outer;  ///< ray outside of the instance, which may have a transform itself
  const AffineInverse& inverse;
  RoundedLine line;

  RayTransform(const Ray& ray, const AffineInverse& to_inside);

  /// Returns the line in doubles as a ray with this transform; it departs from nothing.
  [[nodiscard]] Ray ray() const {
    return {.origin = line.origin, .direction = line.direction, .transform = this};
  }
};

/// Returns the line of a ray in doubles, with their errors.
[[nodiscard]] inline RoundedLine rounded_line(const Ray& ray) {
  if (ray.transform == nullptr) return {.origin = ray.origin, .direction = ray.direction};
  RoundedLine line = ray.transform->line;
  if (ray.is_reversed) line.direction = -line.direction;
  return line;
}

/// Upper bounds for the errors of a line's numbers on each axis.
struct LineError {
  double origin = 0, direction = 0;
};

[[nodiscard]] inline LineError error_of(const RoundedLine& line) {
  const auto largest = [](const Vec3& v) { return std::max({v.x, v.y, v.z}); };
  return {largest(line.origin_error), largest(line.direction_error)};
}

/// Returns the LineError of a ray; it is 0 unless an instance has mapped the ray.
[[nodiscard]] inline LineError line_error(const Ray& ray) {
  return ray.transform == nullptr ? LineError{} : error_of(ray.transform->line);
}

/// Returns the line of a ray in rounded numbers.
template <class T>
requires std::same_as<T, RoundedNumber>
[[nodiscard]] LineOf<T> line_of(const Ray& ray) { return rounded_line(ray).with_errors(); }

/// Returns the line of a ray without rounding.
template <class T>
requires std::same_as<T, ExactNumber>
[[nodiscard]] LineOf<T> line_of(const Ray& ray) {
  if (ray.transform == nullptr) return line_of<T>(ray.origin, ray.direction);
  ExactLine line = ray.transform->inverse.line(line_of<T>(ray.transform->outer));
  if (ray.is_reversed) line.direction = -line.direction;
  return line;
}

inline RayTransform::RayTransform(const Ray& ray, const AffineInverse& to_inside)
    : outer(ray), inverse(to_inside), line(to_inside.line(rounded_line(ray))) {}

/// Tests whether the numbers of a ray, or of the outermost ray that it is mapped from, are finite, and its
/// direction is not 0; any other ray crosses nothing.
[[nodiscard]] inline bool is_proper(const Ray& ray) {
  if (ray.transform != nullptr) return is_proper(ray.transform->outer);
  return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3{0};
}

/// Returns answer(line) for the ray's line, in rounded numbers if these decide it, else without rounding.
/// answer(line) is an std::optional for a line of rounded numbers.
[[nodiscard]] auto decided(const Ray& ray, const auto& answer) {
  if (const auto in_rounded_numbers = answer(line_of<RoundedNumber>(ray))) return *in_rounded_numbers;
  ++fallbacks.exact;
  if constexpr (requires { *answer(line_of<ExactNumber>(ray)); })
    return *answer(line_of<ExactNumber>(ray));
  else
    return answer(line_of<ExactNumber>(ray));
}

/// Returns the certified roots of a surface's equation(line) along a ray; none if the ray is not proper.
[[nodiscard]] Roots roots_along(const Ray& ray, const auto& equation) {
  if (!is_proper(ray)) return {};
  return decided(ray, [&](const auto& line) { return roots_of(equation(line)); });
}

/// Returns the sign of number(line) along a ray.
[[nodiscard]] int sign_along(const Ray& ray, const auto& number) {
  return decided(ray, [&](const auto& line) { return sign_of(number(line)); });
}

}  // namespace protostar::inline PROTOSTAR_ABI

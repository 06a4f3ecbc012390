// Rays in the object space of an instance, which are rounded, and the exact lines that they stand for.
#pragma once

#include "numeric/affine.hpp"
#include "numeric/equation.hpp"
#include "numeric/rounded_equation.hpp"
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
    return {.origin = line.origin, .direction = line.direction, .transform = this, .time = outer.time};
  }
};

/// Returns the line of a ray in doubles, with their errors.
[[nodiscard, gnu::always_inline]] inline RoundedLine rounded_line(const Ray& ray) {
  if (ray.transform == nullptr) return {.origin = ray.origin, .direction = ray.direction};
  RoundedLine line = ray.transform->line;
  if (ray.is_reversed) line.direction = -line.direction;
  return line;
}

/// Returns f(line) for the line of a ray in doubles: the ray itself, if it has no errors, or a RoundedLine.
[[nodiscard, gnu::always_inline]] inline auto with_line(const Ray& ray, const auto& f) {
  return ray.transform == nullptr ? f(ray) : f(rounded_line(ray));
}

/// Returns the line of a ray without rounding.
[[nodiscard]] inline ExactLine exact_line(const Ray& ray) {
  if (ray.transform == nullptr) return exact_line(ray.origin, ray.direction);
  ExactLine line = ray.transform->inverse.line(exact_line(ray.transform->outer));
  if (ray.is_reversed) line.direction = ExactNumber(-1) * line.direction;
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

}  // namespace protostar::inline PROTOSTAR_ABI

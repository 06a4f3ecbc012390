// Vectors without rounding.
#pragma once

#include <array>

#include "../vec3.hpp"
#include "exact_number.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Vector without rounding.
using ExactVector = std::array<ExactNumber, 3>;

[[nodiscard]] inline ExactVector exact_vector(const Vec3& v) { return {v.x, v.y, v.z}; }

[[nodiscard]] inline ExactVector operator+(const ExactVector& a, const ExactVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[nodiscard]] inline ExactVector operator-(const ExactVector& a, const ExactVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline ExactVector operator*(const ExactNumber& factor, const ExactVector& v) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}
[[nodiscard]] inline ExactNumber dot(const ExactVector& a, const ExactVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline ExactVector exact_difference(const Vec3& a, const Vec3& b) {
  return exact_vector(a) - exact_vector(b);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Vectors of numbers of any type: without rounding (ExactNumber), or with an error bound (RoundedNumber).
#pragma once

#include <array>
#include <cstddef>

#include "../vec3.hpp"
#include "exact_number.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template <class T>
using VectorOf = std::array<T, 3>;

/// Vector without rounding.
using ExactVector = VectorOf<ExactNumber>;

template <class T>
[[nodiscard]] VectorOf<T> vector_of(const Vec3& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

// If an operation mixes two types of numbers, one of them is double, which is exact (RoundedNumber).

template <class T>
[[nodiscard]] VectorOf<T> operator+(const VectorOf<T>& a, const VectorOf<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class A, class B>
[[nodiscard]] auto operator-(const VectorOf<A>& a, const VectorOf<B>& b) {
  return VectorOf<decltype(a[0] - b[0])>{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
[[nodiscard]] VectorOf<T> operator-(const VectorOf<T>& a) {
  return {-a[0], -a[1], -a[2]};
}
template <class A, class B>
[[nodiscard]] auto operator*(const A& factor, const VectorOf<B>& v) {
  return VectorOf<decltype(factor * v[0])>{factor * v[0], factor * v[1], factor * v[2]};
}

template <class A, class B>
[[nodiscard]] auto dot(const VectorOf<A>& a, const VectorOf<B>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
[[nodiscard]] VectorOf<T> cross(const VectorOf<T>& a, const VectorOf<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

[[nodiscard]] inline ExactVector exact_vector(const Vec3& v) { return vector_of<ExactNumber>(v); }
[[nodiscard]] inline ExactVector exact_difference(const Vec3& a, const Vec3& b) {
  return exact_vector(a) - exact_vector(b);
}

}  // namespace protostar::inline PROTOSTAR_ABI

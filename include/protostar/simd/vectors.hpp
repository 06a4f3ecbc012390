// Numbers and vectors with a lane for each of as many rays, or surfaces, as are computed at once in double.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "../vec3.hpp"
#include "opaque.hpp"
#include "simd.hpp"
#include "vector_registers.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Numbers, one in each lane: as many as the processor computes at once in double.
using Doubles = Lanes<double, double_lanes>;
using Floats = Lanes<float, double_lanes>;
using Indices = Lanes<std::int64_t, double_lanes>;
using LaneMask = Mask<double, double_lanes>;  ///< mask of some lanes

/// Numbers, one in each lane: as many as the processor computes at once in float.
using WideFloats = Lanes<float, float_lanes>;
using WideIndices = Lanes<std::int32_t, float_lanes>;
using WideMask = Mask<float, float_lanes>;

/// Returns a b + c, rounded once, in each lane.
[[nodiscard]] inline Doubles fma(Doubles a, Doubles b, Doubles c) {
#if defined(PROTOSTAR_BIT_MASKS)
  return _mm512_fmadd_pd((__m512d)a.v, (__m512d)b.v, (__m512d)c.v);
#elif defined(PROTOSTAR_VECTORS) && defined(__AVX2__) && defined(__FMA__)
  return _mm256_fmadd_pd((__m256d)a.v, (__m256d)b.v, (__m256d)c.v);
#else
  return Doubles::of_each([&](int i) { return std::fma(a[i], b[i], c[i]); });
#endif
}

/// Returns a b + c in each lane, the product rounded or not, whichever is faster: for bounds, which hold for
/// both.
template <int N>
[[nodiscard]] Lanes<float, N> fused_or_not(Lanes<float, N> a, Lanes<float, N> b, Lanes<float, N> c) {
#if defined(PROTOSTAR_VECTORS)
  [[maybe_unused]] constexpr std::size_t size = sizeof(a.v);
  using V [[maybe_unused]] = detail::Vector<float, N>;
#if defined(__AVX512F__)
  if constexpr (size == 64) return (V)_mm512_fmadd_ps((__m512)a.v, (__m512)b.v, (__m512)c.v);
#endif
#if defined(__FMA__)
  if constexpr (size == 32) return (V)_mm256_fmadd_ps((__m256)a.v, (__m256)b.v, (__m256)c.v);
  if constexpr (size == 16) return (V)_mm_fmadd_ps((__m128)a.v, (__m128)b.v, (__m128)c.v);
#endif
#endif
  return a * b + c;
}

/// Returns f(number) in each lane.
[[nodiscard]] Doubles of_each(Doubles x, const auto& f) {
  return Doubles::of_each([&](int lane) { return f(x[lane]); });
}

/// Returns x in a form that a compiler cannot look through.
[[nodiscard]] inline Doubles opaque(Doubles x) {
#if defined(PROTOSTAR_VECTORS)
  return protostar::opaque(x.v);
#else
  return of_each(x, [](double number) { return protostar::opaque(number); });
#endif
}

/// Returns a member of objects[index] for the index in each lane. `of_first` is that member of objects[0].
template <class T>
[[nodiscard]] Doubles gathered(const T* objects, const double& of_first, const Indices& indices) {
#if defined(PROTOSTAR_BIT_MASKS)
  // The mask form, as in sqrt, since g++ warns of the other.
  if constexpr (sizeof(T) % sizeof(double) == 0) {
    const Indices offsets = indices * Indices(sizeof(T) / sizeof(double));
    return (detail::Vector<double, double_lanes>)_mm512_mask_i64gather_pd(
        _mm512_setzero_pd(), 0xff, (__m512i)offsets.v, &of_first, sizeof(double));
  }
#endif
  const auto place = reinterpret_cast<const char*>(&of_first) - reinterpret_cast<const char*>(objects);
  return Doubles::of_each([&](int lane) {
    double number;
    std::memcpy(&number, reinterpret_cast<const char*>(objects + indices[lane]) + place, sizeof(number));
    return number;
  });
}

/// Returns the number in the first of some lanes. Lane 0, mostly the first, is read without a detour through
/// memory.
[[nodiscard]] inline std::int64_t in_first_lane(const Indices& numbers, Bits lanes) {
  return (lanes & 1) != 0 ? numbers[0] : numbers[std::countr_zero(lanes) % double_lanes];
}

/// Some lanes that hold one number.
struct Group {
  std::int64_t number;
  LaneMask lanes;
};

/// Takes out of some lanes, of which there is at least one, the first and all others that hold the same
/// number. `while (any(remaining))` around it is a loop over the different numbers.
[[nodiscard]] inline Group take_group(const Indices& numbers, LaneMask& remaining) {
  const std::int64_t number = in_first_lane(numbers, bits(remaining));
  const LaneMask lanes = remaining && mask_for<double>(numbers == Indices(number));
  remaining = remaining && !lanes;
  return {number, lanes};
}

/// A vector of floats in each lane.
struct WideVectors {
  WideFloats x, y, z;

  /// Returns a dot product whose products are rounded or not, whichever is faster: for bounds, which hold for
  /// both.
  friend WideFloats dot(const WideVectors& a, const WideVectors& b) {
    return fused_or_not(a.z, b.z, fused_or_not(a.y, b.y, a.x * b.x));
  }
};

/// A vector in each lane.
struct Vectors {
  Doubles x, y, z;

  Vectors() = default;
  Vectors(Doubles first, Doubles second, Doubles third) : x(first), y(second), z(third) {}
  Vectors(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}

  [[nodiscard]] Vec3 operator[](int lane) const { return {x[lane], y[lane], z[lane]}; }

  friend Vectors operator+(const Vectors& a, const Vectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vectors operator-(const Vectors& a, const Vectors& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vectors operator-(const Vectors& a) { return {-a.x, -a.y, -a.z}; }
  friend Vectors operator*(const Vectors& a, Doubles b) { return {a.x * b, a.y * b, a.z * b}; }
  friend Vectors operator*(Doubles a, const Vectors& b) { return b * a; }
  friend Vectors operator/(const Vectors& a, Doubles b) { return {a.x / b, a.y / b, a.z / b}; }
  friend Vectors operator+(const Vectors& a, double b) { return {a.x + b, a.y + b, a.z + b}; }

  friend Doubles dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Vectors cross(const Vectors& a, const Vectors& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend Doubles length(const Vectors& a) { return sqrt(dot(a, a)); }
  friend Vectors normalize(const Vectors& a) { return a * (1 / length(a)); }
  friend Vectors abs(const Vectors& a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
  friend Vectors select(LaneMask which, const Vectors& a, const Vectors& b) {
    return {select(which, a.x, b.x), select(which, a.y, b.y), select(which, a.z, b.z)};
  }
};

/// Returns t · d with one direction for all lanes.
inline Vectors operator*(Doubles t, const Vec3& d) { return t * Vectors(d); }

/// Clamps each component to between -most and most.
[[nodiscard]] inline Vectors within(const Vectors& v, double most) {
  const auto one = [&](Doubles x) { return min(max(x, -most), most); };
  return {one(v.x), one(v.y), one(v.z)};
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

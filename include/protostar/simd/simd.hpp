// Vectors of numbers, as many as fit into a register of the processor.
//
// Lanes<T, N> is N numbers of type T, and Mask<T, N> the N results of a comparison. Each lane is rounded as a
// single number is, so that a formula gives the same bits for one number and in every lane, if it needs
// nothing but + − × ÷ and square roots.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "../platform.hpp"
#include "lane_sets.hpp"
#include "vector_registers.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Truth value for each of N lanes of type T: a bit, if the processor compares to bits (AVX-512), or else an
/// integer as large as T.
template <class T, int N>
struct Mask {
#if defined(PROTOSTAR_BIT_MASKS)
  Bits v;

  Mask() = default;
  explicit Mask(Bits lanes) : v(lanes) {}
  Mask(bool answer) : v(answer ? first_bits(N) : 0) {}

  friend Mask operator!(Mask a) { return Mask(~a.v & first_bits(N)); }
#else
  detail::Vector<detail::Truth<T>, N> v;

  Mask() = default;
  explicit Mask(detail::Vector<detail::Truth<T>, N> truths) : v(truths) {}
  Mask(bool answer) : v(detail::everywhere<detail::Truth<T>, N>(answer ? -1 : 0)) {}

  friend Mask operator!(Mask a) { return Mask(~a.v); }
#endif
  friend Mask operator&&(Mask a, Mask b) { return Mask(a.v & b.v); }
  friend Mask operator||(Mask a, Mask b) { return Mask(a.v | b.v); }
};

/// N numbers of type T.
template <class T, int N>
struct Lanes {
  detail::Vector<T, N> v;

  Lanes() = default;
  Lanes(detail::Vector<T, N> lanes) : v(lanes) {}

  /// Sets every lane to the number.
  Lanes(T number) : v(detail::everywhere<T, N>(number)) {}

  /// Returns the numbers f(0), f(1), ..., written out: clang does not unroll loops over WebAssembly's lanes.
  static Lanes of_each(const auto& f) {
    return [&]<int... i>(std::integer_sequence<int, i...>) {
      return Lanes(detail::Vector<T, N>{detail::in_register<T>(f(i))...});
    }
    (std::make_integer_sequence<int, N>());
  }

  /// Returns the N numbers from an address on.
  static Lanes load(const T* from) {
#if defined(PROTOSTAR_VECTORS)
    return {*reinterpret_cast<const typename detail::VectorAt<T, N>::type*>(from)};
#else
    Lanes lanes;
    std::memcpy(&lanes.v, from, sizeof(lanes.v));
    return lanes;
#endif
  }
  void store(T* to) const {
#if defined(PROTOSTAR_VECTORS)
    *reinterpret_cast<typename detail::VectorAt<T, N>::type*>(to) = v;
#else
    std::memcpy(to, &v, sizeof(v));
#endif
  }

  T operator[](int i) const { return v[i]; }
  void set(int i, T number) { v[i] = number; }

  friend Lanes operator+(Lanes a, Lanes b) { return {a.v + b.v}; }
  friend Lanes operator-(Lanes a, Lanes b) { return {a.v - b.v}; }
  friend Lanes operator*(Lanes a, Lanes b) { return {a.v * b.v}; }
  friend Lanes operator/(Lanes a, Lanes b) { return {a.v / b.v}; }
  friend Lanes operator-(Lanes a) { return {-a.v}; }
  friend Lanes operator&(Lanes a, Lanes b) { return {a.v & b.v}; }
  friend Lanes operator|(Lanes a, Lanes b) { return {a.v | b.v}; }
  friend Lanes operator^(Lanes a, Lanes b) { return {a.v ^ b.v}; }
  friend Lanes operator<<(Lanes a, Lanes b) { return {a.v << b.v}; }
  friend Lanes operator>>(Lanes a, Lanes b) { return {a.v >> b.v}; }
  Lanes& operator+=(Lanes b) { return *this = *this + b; }
  Lanes& operator*=(Lanes b) { return *this = *this * b; }
  friend Mask<T, N> operator<(Lanes a, Lanes b) {
#if defined(PROTOSTAR_BIT_MASKS)
    return Mask<T, N>(detail::compare<_CMP_LT_OQ>(a.v, b.v));
#else
    return Mask<T, N>(a.v < b.v);
#endif
  }
  friend Mask<T, N> operator<=(Lanes a, Lanes b) {
#if defined(PROTOSTAR_BIT_MASKS)
    return Mask<T, N>(detail::compare<_CMP_LE_OQ>(a.v, b.v));
#else
    return Mask<T, N>(a.v <= b.v);
#endif
  }
  friend Mask<T, N> operator==(Lanes a, Lanes b) {
#if defined(PROTOSTAR_BIT_MASKS)
    return Mask<T, N>(detail::compare<_CMP_EQ_OQ>(a.v, b.v));
#else
    return Mask<T, N>(a.v == b.v);
#endif
  }
  friend Mask<T, N> operator>(Lanes a, Lanes b) { return b < a; }
  friend Mask<T, N> operator>=(Lanes a, Lanes b) { return b <= a; }
};

/// Returns the set of lanes that are true.
template <class T, int N>
[[nodiscard]] Bits bits(Mask<T, N> mask) {
#if defined(PROTOSTAR_BIT_MASKS)
  return mask.v;
#else
#if defined(PROTOSTAR_VECTORS)
  [[maybe_unused]] constexpr std::size_t size = sizeof(mask.v);
#if defined(__AVX__)
  if constexpr (size == 32 && sizeof(T) == 4) return static_cast<Bits>(_mm256_movemask_ps((__m256)mask.v));
  if constexpr (size == 32 && sizeof(T) == 8) return static_cast<Bits>(_mm256_movemask_pd((__m256d)mask.v));
#endif
#if defined(__SSE2__)
  if constexpr (size == 16 && sizeof(T) == 4) return static_cast<Bits>(_mm_movemask_ps((__m128)mask.v));
  if constexpr (size == 16 && sizeof(T) == 8) return static_cast<Bits>(_mm_movemask_pd((__m128d)mask.v));
#endif
#if defined(__wasm_simd128__)
  if constexpr (size == 16 && sizeof(T) == 4) return wasm_i32x4_bitmask((v128_t)mask.v);
  if constexpr (size == 16 && sizeof(T) == 8) return wasm_i64x2_bitmask((v128_t)mask.v);
#endif
#endif
  return [&]<int... i>(std::integer_sequence<int, i...>) {
    return ((static_cast<Bits>(mask.v[i] & 1) << i) | ...);
  }
  (std::make_integer_sequence<int, N>());
#endif
}

template <class T, int N>
[[nodiscard]] bool any(Mask<T, N> mask) {
  return bits(mask) != 0;
}

/// Returns the lanes that are true, for a loop.
template <class T, int N>
[[nodiscard]] LanesIn lanes_in(Mask<T, N> mask) {
  return {bits(mask)};
}

/// Converts a mask to one for lanes of another type.
template <class U, class T, int N>
[[nodiscard]] Mask<U, N> mask_for(Mask<T, N> mask) {
#if defined(PROTOSTAR_BIT_MASKS)
  return Mask<U, N>(mask.v);
#elif defined(PROTOSTAR_VECTORS)
  return Mask<U, N>(__builtin_convertvector(mask.v, detail::Vector<detail::Truth<U>, N>));
#else
  return Mask<U, N>(mask.v.template each<detail::Truth<U>>([&](int i) { return mask.v[i] ? -1 : 0; }));
#endif
}

/// Returns the mask in which just these lanes are true; bits from N on are ignored.
template <class T, int N>
[[nodiscard]] Mask<T, N> mask_of(Bits lanes) {
#if defined(PROTOSTAR_BIT_MASKS)
  return Mask<T, N>(lanes & first_bits(N));
#else
  using Truth = detail::Truth<T>;
  const auto bit = Lanes<Truth, N>::of_each([](int i) { return static_cast<Truth>(Truth{1} << i); }).v;
  return Mask<T, N>((detail::everywhere<Truth, N>(static_cast<Truth>(lanes)) & bit) == bit);
#endif
}

/// Returns a where the mask is true, and b elsewhere.
template <class M, class T, int N>
[[nodiscard]] Lanes<T, N> select(Mask<M, N> mask, Lanes<T, N> a, std::type_identity_t<Lanes<T, N>> b) {
#if defined(PROTOSTAR_BIT_MASKS)
  return {detail::blend(mask.v, a.v, b.v)};
#elif defined(PROTOSTAR_VECTORS)
  return {mask_for<T>(mask).v ? a.v : b.v};
#else
  return {a.v.each([&](int i) { return mask.v[i] ? a.v[i] : b.v[i]; })};
#endif
}

/// Returns the numbers 0, 1, 2, ...
template <class T, int N>
[[nodiscard]] Lanes<T, N> iota() {
  return Lanes<T, N>::of_each([](int i) { return static_cast<T>(i); });
}

/// Returns the square root in each lane; NaN for a negative number.
template <class T, int N>
[[nodiscard]] Lanes<T, N> sqrt(Lanes<T, N> a) {
#if defined(PROTOSTAR_VECTORS)
  [[maybe_unused]] constexpr std::size_t size = sizeof(a.v);
  using V [[maybe_unused]] = detail::Vector<T, N>;
#if defined(__AVX512F__)
  if constexpr (size == 64 && sizeof(T) == 4) return (V)_mm512_maskz_sqrt_ps(0xffff, (__m512)a.v);
  if constexpr (size == 64 && sizeof(T) == 8) return (V)_mm512_maskz_sqrt_pd(0xff, (__m512d)a.v);
#endif
#if defined(__AVX__)
  if constexpr (size == 32 && sizeof(T) == 4) return (V)_mm256_sqrt_ps((__m256)a.v);
  if constexpr (size == 32 && sizeof(T) == 8) return (V)_mm256_sqrt_pd((__m256d)a.v);
#endif
#if defined(__SSE2__)
  if constexpr (size == 16 && sizeof(T) == 4) return (V)_mm_sqrt_ps((__m128)a.v);
  if constexpr (size == 16 && sizeof(T) == 8) return (V)_mm_sqrt_pd((__m128d)a.v);
#endif
#if defined(__wasm_simd128__)
  if constexpr (size == 16 && sizeof(T) == 4) return (V)wasm_f32x4_sqrt((v128_t)a.v);
  if constexpr (size == 16 && sizeof(T) == 8) return (V)wasm_f64x2_sqrt((v128_t)a.v);
#endif
#endif
  return Lanes<T, N>::of_each([&](int i) { return std::sqrt(a[i]); });
}

/// Returns 1/√a in each lane, off by less than 8u = 2^-21 of it, for a from 2^-100 to 2^100.
///
/// The processor's estimate y is off by at most 1.5 · 2^-12 of it. One step of Newton's method for 1/y² − a,
/// y (3/2 − a y²/2), squares that error: 3/2 · 2.25 · 2^-24 < 3.4u. Its roundings are about 3u: two products
/// in a y²/2, which is about 1/2, so that their 2u count half in the bracket, which is about 1; the bracket's
/// own, and that of its product with y.
template <int N>
[[nodiscard]] Lanes<float, N> reciprocal_sqrt(Lanes<float, N> a) {
  [[maybe_unused]] const auto improved = [&](Lanes<float, N> y) {
    return y * (Lanes<float, N>(1.5f) - Lanes<float, N>(0.5f) * a * y * y);
  };
#if defined(PROTOSTAR_VECTORS)
  [[maybe_unused]] constexpr std::size_t size = sizeof(a.v);
  using V [[maybe_unused]] = detail::Vector<float, N>;
#if defined(__AVX512F__)
  if constexpr (size == 64) return improved((V)_mm512_maskz_rsqrt14_ps(0xffff, (__m512)a.v));
#endif
#if defined(__AVX__)
  if constexpr (size == 32) return improved((V)_mm256_rsqrt_ps((__m256)a.v));
#endif
#if defined(__SSE2__)
  if constexpr (size == 16) return improved((V)_mm_rsqrt_ps((__m128)a.v));
#endif
#endif
  return Lanes<float, N>(1.0f) / sqrt(a);
}

/// Returns the magnitude of a with the sign of b, in each lane.
template <class T, int N>
[[nodiscard]] Lanes<T, N> copysign(Lanes<T, N> a, Lanes<T, N> b) {
#if defined(PROTOSTAR_VECTORS)
  using Whole = detail::Vector<detail::Truth<T>, N>;
  const Whole sign = (Whole)Lanes<T, N>(static_cast<T>(-0.0)).v;
  return (detail::Vector<T, N>)(((Whole)a.v & ~sign) | ((Whole)b.v & sign));
#else
  return a.v.each([&](int i) { return std::copysign(a.v[i], b.v[i]); });
#endif
}

template <class T, int N>
[[nodiscard]] Lanes<T, N> abs(Lanes<T, N> a) {
  return copysign(a, Lanes<T, N>(T{0}));
}

/// Returns the smaller number in each lane, as std::min does: a if one of them is NaN.
template <class T, int N>
[[nodiscard]] Lanes<T, N> min(const Lanes<T, N>& a, const Lanes<T, N>& b) {
#if defined(PROTOSTAR_VECTORS)
  return {detail::smaller(a.v, b.v)};
#else
  return select(b < a, b, a);
#endif
}

/// Returns the larger number in each lane, as std::max does: a if one of them is NaN.
template <class T, int N>
[[nodiscard]] Lanes<T, N> max(const Lanes<T, N>& a, const Lanes<T, N>& b) {
#if defined(PROTOSTAR_VECTORS)
  return {detail::larger(a.v, b.v)};
#else
  return select(a < b, b, a);
#endif
}

template <class T, int N>
[[nodiscard]] Lanes<T, N> min(const Lanes<T, N>& a, std::type_identity_t<T> b) {
  return min(a, Lanes<T, N>(b));
}
template <class T, int N>
[[nodiscard]] Lanes<T, N> max(const Lanes<T, N>& a, std::type_identity_t<T> b) {
  return max(a, Lanes<T, N>(b));
}

/// Combines all lanes into one number; f combines two vectors lane by lane.
template <class T, int N>
[[nodiscard]] T folded(const Lanes<T, N>& a, const auto& f) {
  if constexpr (N == 1) {
    return a[0];
  } else {
    // Combines the two halves, as vectors that are half as long.
    T numbers[N];
    a.store(numbers);
    return folded(f(Lanes<T, N / 2>::load(numbers), Lanes<T, N / 2>::load(numbers + N / 2)), f);
  }
}

/// Returns the largest number of all lanes, none of which is NaN.
template <class T, int N>
[[nodiscard]] T largest(const Lanes<T, N>& a) {
  return folded(a, [](const auto& b, const auto& c) { return max(b, c); });
}

/// Returns the smallest number of all lanes, none of which is NaN.
template <class T, int N>
[[nodiscard]] T smallest(const Lanes<T, N>& a) {
  return folded(a, [](const auto& b, const auto& c) { return min(b, c); });
}

namespace detail {

/// Converts each number to a U.
template <class U, class T, int N>
[[nodiscard]] Lanes<U, N> converted(const Lanes<T, N>& a) {
#if defined(PROTOSTAR_VECTORS)
#if defined(__AVX512F__)
  // One instruction, where g++ 12 makes one for each half; the maskz form, as in sqrt, since g++ warns of the
  // others.
  using V = Vector<U, N>;
  if constexpr (N == 8 && std::same_as<T, float> && std::same_as<U, double>)
    return (V)_mm512_maskz_cvtps_pd(0xff, (__m256)a.v);
  else if constexpr (N == 8 && std::same_as<T, std::int32_t> && std::same_as<U, double>)
    return (V)_mm512_maskz_cvtepi32_pd(0xff, (__m256i)a.v);
  else if constexpr (N == 8 && std::same_as<T, std::int32_t> && std::same_as<U, std::int64_t>)
    return (V)_mm512_maskz_cvtepi32_epi64(0xff, (__m256i)a.v);
  else if constexpr (N == 8 && std::same_as<T, std::uint32_t> && std::same_as<U, std::uint64_t>)
    return (V)_mm512_maskz_cvtepu32_epi64(0xff, (__m256i)a.v);
  else if constexpr (N == 8 && std::same_as<T, std::uint64_t> && std::same_as<U, std::uint32_t>)
    return (V)_mm512_maskz_cvtepi64_epi32(0xff, (__m512i)a.v);
  else
#endif
    return __builtin_convertvector(a.v, Vector<U, N>);
#else
  return a.v.template each<U>([&](int i) { return static_cast<U>(a.v[i]); });
#endif
}

}  // namespace detail

/// Converts each number to the nearest float.
template <int N>
[[nodiscard]] Lanes<float, N> to_float(Lanes<double, N> a) {
  return detail::converted<float>(a);
}

/// Converts each integer to the nearest float.
template <int N>
[[nodiscard]] Lanes<float, N> to_float(Lanes<std::int32_t, N> a) {
  return detail::converted<float>(a);
}

/// Truncates each number, of a magnitude below 2^31, to an integer.
template <int N>
[[nodiscard]] Lanes<std::int32_t, N> to_whole(Lanes<float, N> a) {
  return detail::converted<std::int32_t>(a);
}

template <int N>
[[nodiscard]] Lanes<double, N> to_double(Lanes<float, N> a) {
  return detail::converted<double>(a);
}

template <int N>
[[nodiscard]] Lanes<double, N> to_double(Lanes<std::int32_t, N> a) {
  return detail::converted<double>(a);
}

/// Converts each integer to 64 bits, as wide as a double.
template <int N>
[[nodiscard]] Lanes<std::int64_t, N> widened(Lanes<std::int32_t, N> a) {
  return detail::converted<std::int64_t>(a);
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

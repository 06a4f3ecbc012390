// Vectors as registers of the processor hold them, and the only include of the processor's instructions.
//
// With g++ and clang a detail::Vector is one of their vectors; with other compilers, and with
// PROTOSTAR_SCALAR, an array. If PROTOSTAR_VECTORS is defined it is a vector, and if PROTOSTAR_BIT_MASKS is,
// the processor compares vectors to bits.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "../platform.hpp"

#if defined(__GNUC__) && !defined(PROTOSTAR_SCALAR)
#define PROTOSTAR_VECTORS 1
#if defined(__AVX__)
#include <immintrin.h>  // 40,000 lines, which no other processor needs
#elif defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif
#if defined(__AVX512VL__)
#define PROTOSTAR_BIT_MASKS 1
#endif
#endif

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Number of floats, and of doubles, that one instruction takes.
#if !defined(PROTOSTAR_VECTORS)
inline constexpr int float_lanes = 1, double_lanes = 1;
#elif defined(PROTOSTAR_BIT_MASKS)
inline constexpr int float_lanes = 16, double_lanes = 8;
#elif defined(__AVX2__)
inline constexpr int float_lanes = 8, double_lanes = 4;
#else
inline constexpr int float_lanes = 4, double_lanes = 2;
#endif

namespace detail {

/// Integer type as large as T, of which masks are made: 0 is false, −1 true.
template <class T>
using Truth = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;

#if defined(PROTOSTAR_VECTORS)

template <class T, int N>
struct VectorOf {
  typedef T type __attribute__((vector_size(sizeof(T) * N)));
};
template <class T, int N>
using Vector = typename VectorOf<T, N>::type;

/// Vector at an address that is aligned for a T, and where Ts may be.
template <class T, int N>
struct VectorAt {
  typedef T type __attribute__((vector_size(sizeof(T) * N), aligned(alignof(T)), may_alias));
};

#else

/// Substitute for the vectors of g++ and clang in standard C++.
template <class T, int N>
struct Vector {
  T lane[N];

  T& operator[](int i) { return lane[i]; }
  const T& operator[](int i) const { return lane[i]; }

  template <class R = T>
  static Vector<R, N> each(const auto& f) {
    Vector<R, N> result{};
    for (int i = 0; i < N; ++i) result[i] = f(i);
    return result;
  }
  friend Vector operator+(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] + b[i]); });
  }
  friend Vector operator-(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] - b[i]); });
  }
  friend Vector operator*(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] * b[i]); });
  }
  friend Vector operator/(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] / b[i]); });
  }
  friend Vector operator-(const Vector& a) {
    return each([&](int i) { return static_cast<T>(-a[i]); });
  }
  friend Vector operator&(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] & b[i]); });
  }
  friend Vector operator|(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] | b[i]); });
  }
  friend Vector operator^(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] ^ b[i]); });
  }
  friend Vector operator~(const Vector& a) {
    return each([&](int i) { return static_cast<T>(~a[i]); });
  }
  friend Vector operator<<(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] << b[i]); });
  }
  friend Vector operator>>(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] >> b[i]); });
  }
  friend Vector<Truth<T>, N> operator<(const Vector& a, const Vector& b) {
    return each<Truth<T>>([&](int i) { return a[i] < b[i] ? -1 : 0; });
  }
  friend Vector<Truth<T>, N> operator<=(const Vector& a, const Vector& b) {
    return each<Truth<T>>([&](int i) { return a[i] <= b[i] ? -1 : 0; });
  }
  friend Vector<Truth<T>, N> operator==(const Vector& a, const Vector& b) {
    return each<Truth<T>>([&](int i) { return a[i] == b[i] ? -1 : 0; });
  }
};

#endif

#if defined(PROTOSTAR_BIT_MASKS)
/// Returns the lanes in which two vectors compare as the predicate says.
template <int Predicate, class V>
[[nodiscard]] std::uint32_t compare(V a, V b) {
  using T = std::remove_cvref_t<decltype(a[0])>;
  if constexpr (!std::floating_point<T>) {
    constexpr auto predicate = Predicate == _CMP_EQ_OQ   ? _MM_CMPINT_EQ
                               : Predicate == _CMP_LT_OQ ? _MM_CMPINT_LT
                                                         : _MM_CMPINT_LE;
    static_assert(sizeof(V) == 64 || sizeof(T) == 4, "nothing else is needed");
    static_assert(std::signed_integral<T> || sizeof(V) == 32, "nothing else is needed");
    if constexpr (std::unsigned_integral<T>)
      return _mm256_cmp_epu32_mask((__m256i)a, (__m256i)b, predicate);
    else if constexpr (sizeof(T) == 8)
      return _mm512_cmp_epi64_mask((__m512i)a, (__m512i)b, predicate);
    else if constexpr (sizeof(V) == 64)
      return _mm512_cmp_epi32_mask((__m512i)a, (__m512i)b, predicate);
    else if constexpr (sizeof(V) == 32)
      return _mm256_cmp_epi32_mask((__m256i)a, (__m256i)b, predicate);
    else
      return _mm_cmp_epi32_mask((__m128i)a, (__m128i)b, predicate);
  } else if constexpr (sizeof(V) == 64) {
    if constexpr (sizeof(T) == 8)
      return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, Predicate);
    else
      return _mm512_cmp_ps_mask((__m512)a, (__m512)b, Predicate);
  } else if constexpr (sizeof(V) == 32) {
    static_assert(sizeof(T) == 4, "nothing else is needed");
    return _mm256_cmp_ps_mask((__m256)a, (__m256)b, Predicate);
  } else {
    static_assert(sizeof(T) == 4, "nothing else is needed");
    return _mm_cmp_ps_mask((__m128)a, (__m128)b, Predicate);
  }
}

/// Returns a in these lanes, and b elsewhere.
template <class V>
[[nodiscard]] V blend(std::uint32_t lanes, V a, V b) {
  constexpr std::size_t size = sizeof(a[0]);
  static_assert(sizeof(V) == 64 || size == 4, "nothing else is needed");
  if constexpr (sizeof(V) == 16)
    return (V)_mm_mask_blend_epi32(static_cast<__mmask8>(lanes), (__m128i)b, (__m128i)a);
  else if constexpr (sizeof(V) == 32)
    return (V)_mm256_mask_blend_epi32(static_cast<__mmask8>(lanes), (__m256i)b, (__m256i)a);
  else if constexpr (size == 8)
    return (V)_mm512_mask_blend_epi64(static_cast<__mmask8>(lanes), (__m512i)b, (__m512i)a);
  else
    return (V)_mm512_mask_blend_epi32(static_cast<__mmask16>(lanes), (__m512i)b, (__m512i)a);
}
#endif

#if defined(PROTOSTAR_VECTORS)
/// Returns b where it is less than a, and a elsewhere, by the one instruction that does so: g++ 12 makes two
/// of the comparison and the selection where one of the vectors is constant, or in memory.
template <class V>
[[nodiscard]] V smaller(V a, V b) {
  using T [[maybe_unused]] = std::remove_cvref_t<decltype(a[0])>;
  [[maybe_unused]] constexpr std::size_t size = std::floating_point<T> ? sizeof(V) : 0;
#if defined(__AVX512F__)
  if constexpr (size == 64 && sizeof(T) == 4) return (V)_mm512_maskz_min_ps(0xffff, (__m512)b, (__m512)a);
  if constexpr (size == 64 && sizeof(T) == 8) return (V)_mm512_maskz_min_pd(0xff, (__m512d)b, (__m512d)a);
#endif
#if defined(__AVX__)
  if constexpr (size == 32 && sizeof(T) == 4) return (V)_mm256_min_ps((__m256)b, (__m256)a);
  if constexpr (size == 32 && sizeof(T) == 8) return (V)_mm256_min_pd((__m256d)b, (__m256d)a);
#endif
#if defined(__SSE2__)
  if constexpr (size == 16 && sizeof(T) == 4) return (V)_mm_min_ps((__m128)b, (__m128)a);
  if constexpr (size == 16 && sizeof(T) == 8) return (V)_mm_min_pd((__m128d)b, (__m128d)a);
#endif
  return b < a ? b : a;
}

/// Returns b where it is more than a, and a elsewhere, as smaller() does.
template <class V>
[[nodiscard]] V larger(V a, V b) {
  using T [[maybe_unused]] = std::remove_cvref_t<decltype(a[0])>;
  [[maybe_unused]] constexpr std::size_t size = std::floating_point<T> ? sizeof(V) : 0;
#if defined(__AVX512F__)
  if constexpr (size == 64 && sizeof(T) == 4) return (V)_mm512_maskz_max_ps(0xffff, (__m512)b, (__m512)a);
  if constexpr (size == 64 && sizeof(T) == 8) return (V)_mm512_maskz_max_pd(0xff, (__m512d)b, (__m512d)a);
#endif
#if defined(__AVX__)
  if constexpr (size == 32 && sizeof(T) == 4) return (V)_mm256_max_ps((__m256)b, (__m256)a);
  if constexpr (size == 32 && sizeof(T) == 8) return (V)_mm256_max_pd((__m256d)b, (__m256d)a);
#endif
#if defined(__SSE2__)
  if constexpr (size == 16 && sizeof(T) == 4) return (V)_mm_max_ps((__m128)b, (__m128)a);
  if constexpr (size == 16 && sizeof(T) == 8) return (V)_mm_max_pd((__m128d)b, (__m128d)a);
#endif
  return a < b ? b : a;
}
#endif

/// Returns the number, which stands in a register from here on. Without this, clang 14 joins a load and the
/// use of its number in lanes to one instruction of WebAssembly (LLVM's LOAD_SPLAT), and may move it behind a
/// store that changes the number in memory.
template <class T>
[[nodiscard, gnu::always_inline]] inline T in_register(T number) {
#if defined(__wasm_simd128__)
  asm("" : "+r"(number));
#endif
  return number;
}

/// Returns a vector with the number in every lane.
template <class T, int N>
[[nodiscard]] Vector<T, N> everywhere(T number) {
#if defined(PROTOSTAR_VECTORS)
  // Less 0, and not plus 0, which would turn −0 into 0.
  return in_register(number) - Vector<T, N>{};
#else
  return Vector<T, N>::each([&](int) { return number; });
#endif
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI::simd

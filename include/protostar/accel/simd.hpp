// Vectors of numbers, as many as fit into a register of the processor: the only file with vector
// instructions.
//
// Lanes<T, N> is N numbers of type T, and Mask<T, N> the N results of a comparison. Each lane is rounded as a
// single number is, so that a formula gives the same bits for one number and in every lane, if it needs
// nothing but + − × ÷ and square roots. With g++ and clang a Lanes is one of their vectors; with other
// compilers, and with PROTOSTAR_SCALAR, an array.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "../platform.hpp"

#if defined(__GNUC__) && !defined(PROTOSTAR_SCALAR)
#define PROTOSTAR_VECTORS 1
#if defined(__SSE2__)
#include <immintrin.h>
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
  friend Vector operator~(const Vector& a) {
    return each([&](int i) { return static_cast<T>(~a[i]); });
  }
  friend Vector operator<<(const Vector& a, const Vector& b) {
    return each([&](int i) { return static_cast<T>(a[i] << b[i]); });
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
    if constexpr (sizeof(T) == 8)
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
    return _mm256_cmp_ps_mask((__m256)a, (__m256)b, Predicate);
  } else {
    return _mm_cmp_ps_mask((__m128)a, (__m128)b, Predicate);
  }
}

/// Returns a in these lanes, and b elsewhere.
template <class V>
[[nodiscard]] V blend(std::uint32_t lanes, V a, V b) {
  constexpr std::size_t size = sizeof(a[0]);
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

/// Returns a vector with the number in every lane.
template <class T, int N>
[[nodiscard]] Vector<T, N> everywhere(T number) {
#if defined(PROTOSTAR_VECTORS)
  return number - Vector<T, N>{};
#else
  return Vector<T, N>::each([&](int) { return number; });
#endif
}

}  // namespace detail

/// Set of lanes; the lowest bit is lane 0.
using Bits = std::uint32_t;

/// Returns the set of the first `count` lanes.
[[nodiscard]] constexpr Bits first_bits(int count) { return count >= 32 ? ~Bits{0} : (Bits{1} << count) - 1; }

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

  /// Returns the numbers f(0), f(1), ...
  static Lanes of_each(const auto& f) {
    return [&]<int... i>(std::integer_sequence<int, i...>) { return Lanes(detail::Vector<T, N>{f(i)...}); }
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
  void store(T* to) const { std::memcpy(to, &v, sizeof(v)); }

  T operator[](int i) const { return v[i]; }
  void set(int i, T number) { v[i] = number; }

  friend Lanes operator+(Lanes a, Lanes b) { return {a.v + b.v}; }
  friend Lanes operator-(Lanes a, Lanes b) { return {a.v - b.v}; }
  friend Lanes operator*(Lanes a, Lanes b) { return {a.v * b.v}; }
  friend Lanes operator/(Lanes a, Lanes b) { return {a.v / b.v}; }
  friend Lanes operator-(Lanes a) { return {-a.v}; }
  friend Lanes operator|(Lanes a, Lanes b) { return {a.v | b.v}; }
  friend Lanes operator<<(Lanes a, Lanes b) { return {a.v << b.v}; }
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
  constexpr std::size_t size = sizeof(mask.v);
#if defined(__AVX__)
  if constexpr (size == 32 && sizeof(T) == 4) return static_cast<Bits>(_mm256_movemask_ps((__m256)mask.v));
  if constexpr (size == 32 && sizeof(T) == 8) return static_cast<Bits>(_mm256_movemask_pd((__m256d)mask.v));
#endif
#if defined(__SSE2__)
  if constexpr (size == 16 && sizeof(T) == 4) return static_cast<Bits>(_mm_movemask_ps((__m128)mask.v));
  if constexpr (size == 16 && sizeof(T) == 8) return static_cast<Bits>(_mm_movemask_pd((__m128d)mask.v));
#endif
#endif
  Bits result = 0;
  for (int i = 0; i < N; ++i) result |= static_cast<Bits>(mask.v[i] & 1) << i;
  return result;
#endif
}

template <class T, int N>
[[nodiscard]] bool any(Mask<T, N> mask) {
  return bits(mask) != 0;
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
  detail::Vector<Truth, N> bit{};
  for (int i = 0; i < N; ++i) bit[i] = Truth{1} << i;
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
  Lanes<T, N> lanes;
  for (int i = 0; i < N; ++i) lanes.set(i, static_cast<T>(i));
  return lanes;
}

/// Returns the square root in each lane; NaN for a negative number.
template <class T, int N>
[[nodiscard]] Lanes<T, N> sqrt(Lanes<T, N> a) {
#if defined(PROTOSTAR_VECTORS)
  constexpr std::size_t size = sizeof(a.v);
  using V = detail::Vector<T, N>;
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
#endif
  for (int i = 0; i < N; ++i) a.set(i, std::sqrt(a[i]));
  return a;
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

/// Returns the smaller number in each lane, as std::min does: a if one of them is NaN. Written like this, it
/// is one instruction.
template <class T, int N>
[[nodiscard]] Lanes<T, N> min(const Lanes<T, N>& a, const Lanes<T, N>& b) {
#if defined(PROTOSTAR_VECTORS)
  return {b.v < a.v ? b.v : a.v};
#else
  return select(b < a, b, a);
#endif
}

/// Returns the larger number in each lane, as std::max does: a if one of them is NaN.
template <class T, int N>
[[nodiscard]] Lanes<T, N> max(const Lanes<T, N>& a, const Lanes<T, N>& b) {
#if defined(PROTOSTAR_VECTORS)
  return {a.v < b.v ? b.v : a.v};
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

/// Returns the bits that are set in any lane.
template <std::integral T, int N>
[[nodiscard]] T bits_of_any(const Lanes<T, N>& a) {
  return folded(a, [](const auto& b, const auto& c) { return b | c; });
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

/// Time at which prefetched data is read: soon, or after much else. If later, it waits in the second-level
/// cache; only few lines can be on their way into the first level at a time, and with more of them the
/// processor presumably waits.
enum class Read { soon, later };

/// Prefetches an address that will be read.
template <Read read = Read::soon>
void prefetch([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address, 0, read == Read::soon ? 3 : 2);
#endif
}

/// Prefetches an address that will be written soon.
inline void prefetch_to_write([[maybe_unused]] void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address, 1);
#endif
}

/// Keeps the calls of a function that does nothing but prefetch: g++ takes it for one without effect, and may
/// never call it.
inline void keep_calls() {
#if defined(__GNUC__)
  asm volatile("");
#endif
}

/// Prefetches an object, in all its lines of the cache.
template <class T>
void prefetch_whole(const T& object) {
  const auto* const bytes = reinterpret_cast<const char*>(&object);
  for (std::size_t i = 0; i < sizeof(T); i += 64) prefetch(bytes + i);
  prefetch(bytes + sizeof(T) - 1);
}

/// Stores the numbers of three vectors in turn: a[0], b[0], c[0], a[1], …
template <int N>
void store_in_turn(void* to, Lanes<float, N> a, Lanes<float, N> b, Lanes<float, N> c) {
#if defined(PROTOSTAR_VECTORS) && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
  if constexpr (N >= 4) {
    // The k-th number to store is the (k / 3)-th of the (k % 3)-th vector.
    const auto store = [&]<int from, int... i>(std::integral_constant<int, from>,
                                               std::integer_sequence<int, i...>) {
      const auto of_two =
          __builtin_shufflevector(a.v, b.v, ((from + i) / 3 + ((from + i) % 3 == 1 ? N : 0))...);
      const auto of_all =
          __builtin_shufflevector(of_two, c.v, ((from + i) % 3 == 2 ? N + (from + i) / 3 : i)...);
      std::memcpy(static_cast<float*>(to) + from, &of_all, sizeof(of_all));
    };
    constexpr std::make_integer_sequence<int, N> lanes;
    store(std::integral_constant<int, 0>(), lanes);
    store(std::integral_constant<int, N>(), lanes);
    store(std::integral_constant<int, 2 * N>(), lanes);
    return;
  }
#endif
#endif
  for (int i = 0; i < N; ++i) {
    const float numbers[] = {a[i], b[i], c[i]};
    std::memcpy(static_cast<float*>(to) + 3 * i, numbers, sizeof(numbers));
  }
}

namespace detail {

/// Table of the lanes in each set of eight, in order; the rest is 0.
inline constexpr auto chosen_lanes = [] {
  std::array<std::array<std::uint8_t, 8>, 256> all{};
  for (std::size_t lanes = 0; lanes < all.size(); ++lanes)
    for (std::size_t lane = 0, count = 0; lane < 8; ++lane)
      if ((lanes >> lane & 1) != 0) all[lanes][count++] = static_cast<std::uint8_t>(lane);
  return all;
}();

}  // namespace detail

/// Stores the numbers of the lanes in a set, in order, from an address on, and returns how many they are; all
/// N places from there on may change.
template <class T, int N>
int store_chosen(T* to, Bits lanes, Lanes<T, N> a) {
#if defined(PROTOSTAR_VECTORS) && defined(__AVX512F__)
  if constexpr (sizeof(a.v) == 64 && sizeof(T) == 4) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(lanes), (__m512i)a.v));
    return std::popcount(lanes);
  }
#endif
#if defined(PROTOSTAR_VECTORS) && defined(__AVX512VL__)
  if constexpr (sizeof(a.v) == 32 && sizeof(T) == 4) {
    _mm256_storeu_si256((__m256i*)to,
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(lanes), (__m256i)a.v));
    return std::popcount(lanes);
  }
#endif
#if defined(PROTOSTAR_VECTORS) && defined(__AVX2__)
  if constexpr (sizeof(a.v) == 32 && sizeof(T) == 4) {
    const __m128i order = _mm_loadl_epi64((const __m128i*)detail::chosen_lanes[lanes].data());
    _mm256_storeu_si256((__m256i*)to, _mm256_permutevar8x32_epi32((__m256i)a.v, _mm256_cvtepu8_epi32(order)));
    return std::popcount(lanes);
  }
#endif
  int count = 0;
  for (; lanes != 0; lanes &= lanes - 1) to[count++] = a[std::countr_zero(lanes)];
  return count;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

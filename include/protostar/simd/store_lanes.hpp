// Stores lanes in another order than they have: the numbers of three vectors in turn, or only chosen lanes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "../platform.hpp"
#include "simd.hpp"
#include "vector_registers.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

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
/// N places from there on may change. Precondition: no bit from N on is set.
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
  for (const int lane : lanes_in(lanes)) to[count++] = a[lane];
  return count;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

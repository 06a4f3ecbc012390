// Words of 32 and 64 binary digits, alone or in lanes: what hash functions and samplers do with digits.
//
// Each function has two forms, for one word and for a word in each lane, so that a function template over the
// type of word serves both. Their results have the same digits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "../platform.hpp"
#include "simd.hpp"
#include "vector_registers.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Words, one in each lane: as many as the processor computes at once in double.
using Words = Lanes<std::uint32_t, double_lanes>;
using LongWords = Lanes<std::uint64_t, double_lanes>;

/// Returns the words of 64 digits with the same values.
[[nodiscard]] constexpr std::uint64_t widened(std::uint32_t word) { return word; }
template <int N>
[[nodiscard]] Lanes<std::uint64_t, N> widened(Lanes<std::uint32_t, N> words) {
  return detail::converted<std::uint64_t>(words);
}

/// Returns the lower 32 digits.
[[nodiscard]] constexpr std::uint32_t low_word(std::uint64_t word) {
  return static_cast<std::uint32_t>(word);
}
template <int N>
[[nodiscard]] Lanes<std::uint32_t, N> low_word(Lanes<std::uint64_t, N> words) {
  return detail::converted<std::uint32_t>(words);
}

/// Returns the higher 32 digits.
template <class LongWord>
[[nodiscard]] auto high_word(LongWord word) {
  return low_word(word >> 32);
}

namespace detail {

/// Exchanges neighboring groups of digits: of 16, 8, 4, 2 and 1. Each step is an exchange inside the groups
/// of twice that size, so that all five turn the order of 32 digits around.
template <class Word>
[[nodiscard]] constexpr Word reversed_in_steps(Word x) {
  x = x >> 16 | x << 16;
  x = (x >> 8 & 0x00ff00ff) | (x & 0x00ff00ff) << 8;
  x = (x >> 4 & 0x0f0f0f0f) | (x & 0x0f0f0f0f) << 4;
  x = (x >> 2 & 0x33333333) | (x & 0x33333333) << 2;
  return (x >> 1 & 0x55555555) | (x & 0x55555555) << 1;
}

#if defined(PROTOSTAR_VECTORS) && defined(__AVX__)
/// Order of 16 bytes that turns around each four of them.
[[nodiscard]] inline __m128i turned_bytes() {
  return _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
}
/// Table of each four binary digits in the other order.
[[nodiscard]] inline __m128i turned_digits() {
  return _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
}
#endif

}  // namespace detail

/// Returns each word with its 32 binary digits in the opposite order. The bytes are put into the opposite
/// order by one instruction; their digits by another, which multiplies each byte by a matrix over {0, 1}, or
/// by looking up each half of a byte.
template <int N>
[[nodiscard]] Lanes<std::uint32_t, N> reversed(Lanes<std::uint32_t, N> x) {
#if defined(PROTOSTAR_VECTORS) && defined(__AVX__)
  constexpr std::size_t size = sizeof(x.v);
  using V [[maybe_unused]] = detail::Vector<std::uint32_t, N>;
#if defined(__GFNI__) && defined(__AVX512VL__)
  constexpr long long opposite = static_cast<long long>(0x8040201008040201ull);
  if constexpr (size == 64) {
    const __m512i order = _mm512_maskz_broadcast_i32x4(0xffff, detail::turned_bytes());
    return (V)_mm512_gf2p8affine_epi64_epi8(_mm512_shuffle_epi8((__m512i)x.v, order),
                                            _mm512_set1_epi64(opposite), 0);
  }
  if constexpr (size == 32) {
    const __m256i order = _mm256_broadcastsi128_si256(detail::turned_bytes());
    return (V)_mm256_gf2p8affine_epi64_epi8(_mm256_shuffle_epi8((__m256i)x.v, order),
                                            _mm256_set1_epi64x(opposite), 0);
  }
  if constexpr (size == 16)
    return (V)_mm_gf2p8affine_epi64_epi8(_mm_shuffle_epi8((__m128i)x.v, detail::turned_bytes()),
                                         _mm_set1_epi64x(opposite), 0);
#elif defined(__AVX2__)
  if constexpr (size == 32) {
    const __m256i half = _mm256_set1_epi8(15);
    const __m256i digits = _mm256_broadcastsi128_si256(detail::turned_digits());
    const __m256i bytes =
        _mm256_shuffle_epi8((__m256i)x.v, _mm256_broadcastsi128_si256(detail::turned_bytes()));
    const __m256i low = _mm256_shuffle_epi8(digits, _mm256_and_si256(bytes, half));
    const __m256i high = _mm256_shuffle_epi8(digits, _mm256_and_si256(_mm256_srli_epi16(bytes, 4), half));
    return (V)_mm256_or_si256(_mm256_slli_epi16(low, 4), high);
  }
#endif
  if constexpr (size == 16) {
    const __m128i half = _mm_set1_epi8(15);
    const __m128i bytes = _mm_shuffle_epi8((__m128i)x.v, detail::turned_bytes());
    const __m128i low = _mm_shuffle_epi8(detail::turned_digits(), _mm_and_si128(bytes, half));
    const __m128i high =
        _mm_shuffle_epi8(detail::turned_digits(), _mm_and_si128(_mm_srli_epi16(bytes, 4), half));
    return (V)_mm_or_si128(_mm_slli_epi16(low, 4), high);
  }
#endif
  return detail::reversed_in_steps(x);
}

/// Returns a word with its 32 binary digits in the opposite order.
[[nodiscard]] constexpr std::uint32_t reversed(std::uint32_t x) {
#if defined(PROTOSTAR_VECTORS) && defined(__GFNI__) && defined(__AVX512VL__)
  if (!std::is_constant_evaluated()) return reversed(Lanes<std::uint32_t, 4>(x))[0];
#endif
  return detail::reversed_in_steps(x);
}

#if defined(PROTOSTAR_VECTORS) && defined(__AVX2__)
/// Words in twice as many lanes: two sets of words, one after the other.
using TwoWords = Lanes<std::uint32_t, 2 * double_lanes>;

/// Returns the words of a and then those of b.
[[nodiscard]] inline TwoWords joined(Words a, Words b) {
#if defined(PROTOSTAR_BIT_MASKS)
  return (detail::Vector<std::uint32_t, 16>)_mm512_maskz_inserti64x4(
      0xff, _mm512_castsi256_si512((__m256i)a.v), (__m256i)b.v, 1);
#else
  return (detail::Vector<std::uint32_t, 8>)_mm256_inserti128_si256(_mm256_castsi128_si256((__m128i)a.v),
                                                                   (__m128i)b.v, 1);
#endif
}

/// Returns the first or the second half of the lanes.
template <int half>
[[nodiscard]] Words half_of(TwoWords a) {
#if defined(PROTOSTAR_BIT_MASKS)
  return (detail::Vector<std::uint32_t, 8>)_mm512_maskz_extracti64x4_epi64(0xf, (__m512i)a.v, half);
#else
  return (detail::Vector<std::uint32_t, 4>)_mm256_extracti128_si256((__m256i)a.v, half);
#endif
}

/// Number of binary digits that a look-up takes at once: two tables of so many digits fit into registers.
#if defined(PROTOSTAR_BIT_MASKS)
inline constexpr int digits_looked_up = 4;
#else
inline constexpr int digits_looked_up = 2;
#endif

/// Two tables one after the other, with an entry for each value of so many digits.
using LookUpTables = std::array<std::uint32_t, 2 << digits_looked_up>;

/// Returns numbers of entries: the lowest digits_looked_up digits of each word, for a look-up in the first
/// table in the first half of the lanes, in the second table in the second half.
[[nodiscard]] inline TwoWords entries_of(TwoWords digits) {
  constexpr std::uint32_t size = 1u << digits_looked_up;
  return (digits & (size - 1)) | joined(Words(std::uint32_t{0}), Words(size));
}

/// Returns the entries of such numbers.
[[nodiscard]] inline TwoWords looked_up(const LookUpTables& tables, TwoWords entries) {
#if defined(PROTOSTAR_BIT_MASKS)
  __m512i first, second;
  std::memcpy(&first, tables.data(), sizeof first);
  std::memcpy(&second, tables.data() + 16, sizeof second);
  return (detail::Vector<std::uint32_t, 16>)_mm512_permutex2var_epi32(first, (__m512i)entries.v, second);
#else
  __m256i both;
  std::memcpy(&both, tables.data(), sizeof both);
  return (detail::Vector<std::uint32_t, 8>)_mm256_permutevar8x32_epi32(both, (__m256i)entries.v);
#endif
}
#endif

/// Returns (n + ½) · 2^-32, the middle of the n-th of 2^32 equal parts of the interval from 0 to 1. Its 33
/// digits fit into a double, so that the result is exact, never 0 and never 1.
[[nodiscard]] constexpr double to_unit(std::uint32_t n) { return (n + 0.5) * 0x1p-32; }

/// Returns (n + ½) · 2^-32 in each lane. AVX-512 converts words to doubles. Without it, the double 1 + (n +
/// ½) · 2^-32 is put together, which has n as the first 32 digits after the point and then a 1, and 1 is
/// taken off. Both are exact.
template <int N>
[[nodiscard]] Lanes<double, N> to_unit(Lanes<std::uint32_t, N> n) {
#if defined(PROTOSTAR_BIT_MASKS)
  using V [[maybe_unused]] = detail::Vector<double, N>;
  const auto unit = [](V whole) { return Lanes<double, N>(whole) * 0x1p-32 + 0x1p-33; };
  if constexpr (N == 8) return unit((V)_mm512_maskz_cvtepu32_pd(0xff, (__m256i)n.v));
  if constexpr (N == 4) return unit((V)_mm256_cvtepu32_pd((__m128i)n.v));
#endif
#if defined(PROTOSTAR_VECTORS)
  const Lanes<std::uint64_t, N> digits = widened(n) << 20 | 0x3ff0000000080000;
  return Lanes<double, N>((detail::Vector<double, N>)digits.v) - 1.0;
#else
  return Lanes<double, N>::of_each([&](int i) { return to_unit(n[i]); });
#endif
}

/// Returns in each lane the least power of two above x, from 2^-1021 to 2^1023; 0 for x from 0 to below
/// 2^-1022. x is neither negative nor 2^1023 or more. It has the exponent of x, one higher, and no digits.
template <int N>
[[nodiscard]] Lanes<double, N> power_above(Lanes<double, N> x) {
  constexpr std::uint64_t exponent = 0x7ff0000000000000;
#if defined(PROTOSTAR_VECTORS)
  const Lanes<std::uint64_t, N> bits((detail::Vector<std::uint64_t, N>)x.v);
  return 2.0 * Lanes<double, N>((detail::Vector<double, N>)(bits & exponent).v);
#else
  return Lanes<double, N>::of_each([&](int i) {
    double number = x[i];
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    bits &= exponent;
    std::memcpy(&number, &bits, sizeof bits);
    return 2 * number;
  });
#endif
}

/// Returns (n + ½) · 2^-32 of each of four words.
[[nodiscard]] inline std::array<double, 4> to_units(Lanes<std::uint32_t, 4> n) {
  std::array<double, 4> units;
#if defined(__AVX2__)
  to_unit(n).store(units.data());
#else
  for (int i = 0; i < 4; ++i) units[static_cast<std::size_t>(i)] = to_unit(n[i]);
#endif
  return units;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

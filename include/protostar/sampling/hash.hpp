// Hash functions of which samplers make their numbers: digits that look random, and depend on nothing but
// seed, pixel, sample and set.
//
// All functions take words of any type: std::uint32_t and std::uint64_t, or words in lanes. Words of 32 and
// 64 binary digits are computed modulo 2^32 and 2^64, so that the results are the same on any machine.
#pragma once

#include <cstdint>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/words.hpp"

namespace protostar::inline PROTOSTAR_ABI::sampling {

/// Nearest odd number to 2^64 divided by the golden ratio: its multiples are spread evenly.
inline constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;

/// Returns a word that looks unrelated to z, another one for each z (the last step of Vigna's splitmix64).
///
/// It is a bijection, since each step is. x ^ (x >> k) keeps the highest k digits; from them the next k can
/// be computed, and so on. A product with an odd number can be undone, since an odd number has an inverse
/// modulo 2^64.
template <class LongWord>
[[nodiscard]] LongWord mix(LongWord z) {
  z = (z ^ z >> 30) * LongWord(0xbf58476d1ce4e5b9);
  z = (z ^ z >> 27) * LongWord(0x94d049bb133111eb);
  return z ^ z >> 31;
}

/// Returns the key of a pixel. For one seed, no two pixels have the same key: x · 2^32 + y is another number
/// for each pixel, and mixing and adding a constant are bijections. For one pixel, each of the 2^64 seeds has
/// another key, by the same argument.
template <class Word>
[[nodiscard]] auto pixel_key(std::uint64_t seed, Word x, Word y) {
  using LongWord = decltype(simd::widened(x));
  return mix(mix(simd::widened(x) << 32 | simd::widened(y)) + LongWord(mix(seed + golden)));
}

/// Returns the key of one part of a pixel's set of numbers, another one for each set and part: set · 2^32 +
/// part is another number for each, and a product with an odd number is a bijection.
template <class LongWord>
[[nodiscard]] LongWord set_key(LongWord key, std::uint32_t set, std::uint32_t part) {
  return mix(key + LongWord((std::uint64_t{set} << 32 | part) * golden));
}

/// Factors for seed_of() and word_of(): odd numbers whose digits look random. Each numbers a word of a set.
inline constexpr std::uint32_t factors[] = {0x9e3779b1, 0x85ebca77, 0xc2b2ae3d, 0x27d4eb2f, 0x165667b1,
                                            0xd3a2646d, 0xb55a4f09, 0xfd7046c5, 0xa0761d65};

/// Returns a word made of the lower half of a set's key, mostly another word for another odd factor.
template <class Word>
[[nodiscard]] Word seed_of(Word low, Word factor) {
  const Word x = low * factor;
  return x ^ x >> 15;
}

/// Returns a word made of both halves of a set's key. For each lower half, it is a bijection of the higher.
template <class Word>
[[nodiscard]] Word word_of(Word low, Word high, Word factor) {
  return seed_of(low, factor) + high;
}

// ---- Scrambling of digits

// A nested uniform scrambling (Owen 1995) flips each digit of a number by a coin that belongs to the digits
// before it: numbers that agree in their first k digits do so after it, and the next digit of both is flipped
// or not. A hash function does it without a tree of coins if its digit i is digit i of x, flipped by a
// function of the digits below i, for every i. Digits are counted from the lowest, so that numbers with
// digits after a point are turned around before. These steps have this property, and so have several in turn:
// - x + s: to digit i comes digit i of s, and a carry from the digits below;
// - x · odd: the product is x, plus x shifted to the left by 1 or more;
// - x ⊕ x · even: the product consists of x shifted to the left by 1 or more.

/// Returns a nested uniform scrambling of the digits of x, read from the lowest, as a seed has it. With
/// another word added modulo 2, all 2^7 scramblings of three digits occur, and 2^13 of the 2^15 of four.
template <class Word>
[[nodiscard]] Word nested(Word x, Word seed) {
  x = x + seed;
  x = x * (seed >> 9 | Word(1));
  x = x ^ x * Word(0x2cd3cde2u);
  x = x + (seed >> 17);
  return x ^ x * (seed >> 25 & Word(0xfffffffeu));
}

/// Returns a nested scrambling of the digits of x for which 0 stays 0.
///
/// It shuffles indices with their digits turned around, so that 0, 1, 2–3, 4–7, 8–15, … keep their places:
/// the first 2^k indices stay the first 2^k, and have at most k digits. Nothing is lost against a scrambling
/// that moves 0 to some c. For Sobol's points, whose digits depend linearly (modulo 2) on those of the index,
/// ⊕ c in the index is ⊕ a constant in each coordinate, and these are flipped at random anyway.
template <class Word>
[[nodiscard]] Word shuffled(Word x, Word seed) {
  return nested(x, seed) ^ nested(Word(0), seed);
}

}  // namespace protostar::inline PROTOSTAR_ABI::sampling

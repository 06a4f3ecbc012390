#include <protostar/simd/words.hpp>

#include <cstdint>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using simd::Lanes;

namespace {

/// Words at the ends of their range, with one digit and with many.
std::vector<std::uint32_t> any_words() {
  std::vector<std::uint32_t> all = {0, 1, 2, 3, 0x7fffffff, 0x80000000, 0x80000001, 0xfffffffe, 0xffffffff};
  for (int digit = 0; digit < 32; ++digit) all.push_back(std::uint32_t{1} << digit);
  Random random(1);
  for (int i = 0; i < 500; ++i) all.push_back(static_cast<std::uint32_t>(random.bits()));
  return all;
}

/// Calls test with words in lanes, of each number of lanes that the library uses.
void for_each_word(const auto& test) {
  test(Lanes<std::uint32_t, 4>());
  test(simd::Words());
#if defined(PROTOSTAR_VECTORS) && defined(__AVX2__)
  test(simd::TwoWords());
#endif
}

template <int N>
constexpr int count_of(const Lanes<std::uint32_t, N>&) {
  return N;
}

/// Returns the word with digit i of x as digit 31 − i.
std::uint32_t reversed_digit_by_digit(std::uint32_t x) {
  std::uint32_t result = 0;
  for (int i = 0; i < 32; ++i) result |= (x >> i & 1) << (31 - i);
  return result;
}

}  // namespace

TEST_CASE("operations on words in lanes are those on single words") {
  WrongCases wrong;
  const std::vector<std::uint32_t> all = any_words();
  for_each_word([&](auto kind) {
    using Kind = decltype(kind);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      const auto number = [&](int lane) { return all[(i + static_cast<std::size_t>(lane)) % all.size()]; };
      const auto a = Kind::of_each(number);
      const std::uint32_t b = all[i + 1];
      const int shift = static_cast<int>(b % 32);
      for (int lane = 0; lane < count_of(kind); ++lane) {
        const std::uint32_t x = number(lane);
        wrong.add((a + Kind(b))[lane] != x + b, "+", x, b);
        wrong.add((a * Kind(b))[lane] != x * b, "*", x, b);
        wrong.add((a & Kind(b))[lane] != (x & b), "&", x, b);
        wrong.add((a | Kind(b))[lane] != (x | b), "|", x, b);
        wrong.add((a ^ Kind(b))[lane] != (x ^ b), "^", x, b);
        wrong.add((a >> Kind(b % 32))[lane] != x >> shift, ">>", x, b);
        wrong.add((a << Kind(b % 32))[lane] != x << shift, "<<", x, b);
        wrong.add(simd::reversed(a)[lane] != reversed_digit_by_digit(x), "reversed", x);
        wrong.add(simd::reversed(x) != reversed_digit_by_digit(x), "reversed", x);
        if constexpr (std::is_same_v<Kind, simd::Words>)
          wrong.add(simd::to_unit(a)[lane] != simd::to_unit(x), "to_unit", x);
        if constexpr (std::is_same_v<Kind, Lanes<std::uint32_t, 4>>)
          wrong.add(simd::to_units(a)[static_cast<std::size_t>(lane)] != simd::to_unit(x), "to_units", x);
      }
    }
  });
  CHECK(wrong == 0);
}

TEST_CASE("long words are multiplied, and divided into halves, in every lane") {
  WrongCases wrong;
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const std::uint64_t first = random.bits(), factor = random.bits();
    const auto number = [&](int lane) { return first + 0xfffffffbu * static_cast<std::uint64_t>(lane); };
    const auto a = simd::LongWords::of_each(number);
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const std::uint64_t x = number(lane);
      wrong.add((a * simd::LongWords(factor))[lane] != x * factor, x, factor);
      wrong.add(simd::low_word(a)[lane] != static_cast<std::uint32_t>(x), x);
      wrong.add(simd::high_word(a)[lane] != static_cast<std::uint32_t>(x >> 32), x);
      wrong.add(simd::widened(simd::high_word(a))[lane] != x >> 32, x);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("words are compared without a sign, in every lane") {
  WrongCases wrong;
  for (const std::uint32_t a : any_words())
    for (const std::uint32_t b : {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
      const simd::Bits all = simd::first_bits(simd::double_lanes);
      wrong.add(bits(simd::Words(a) < simd::Words(b)) != (a < b ? all : 0), a, "<", b);
      wrong.add(bits(simd::Words(a) <= simd::Words(b)) != (a <= b ? all : 0), a, "<=", b);
      wrong.add(bits(simd::Words(a) == simd::Words(b)) != (a == b ? all : 0), a, "==", b);
    }
  CHECK(wrong == 0);
}

TEST_CASE("units are the middles of 2^32 equal parts, and never 0 or 1") {
  CHECK(simd::to_unit(0u) == 0x1p-33);
  CHECK(simd::to_unit(0xffffffffu) == 1 - 0x1p-33);
  CHECK(simd::to_unit(0x80000000u) == 0.5 + 0x1p-33);
  CHECK(simd::to_unit(simd::Words(0u))[0] == 0x1p-33);
  CHECK(simd::to_unit(simd::Words(0xffffffffu))[0] == 1 - 0x1p-33);
  const auto four = simd::to_units(simd::Lanes<std::uint32_t, 4>::of_each(
      [](int i) { return ~std::uint32_t{0} * static_cast<std::uint32_t>(i % 2); }));
  CHECK(four == std::array{0x1p-33, 1 - 0x1p-33, 0x1p-33, 1 - 0x1p-33});
}

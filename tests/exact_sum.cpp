#include <protostar/sampling/exact_sum.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/numeric/exact_number.hpp>
#include <protostar/sampling/exact_lanes.hpp>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a sum in units of 2^-47.
ExactNumber units_of(const ExactSum& sum) {
  const ExactSum::Words words = sum.words();
  const auto half = [](auto number) { return ExactNumber(static_cast<double>(number)); };
  return half(words.high >> 32) * ExactNumber(0x1p96) + half(words.high & 0xffffffff) * ExactNumber(0x1p64) +
         half(words.low >> 32) * ExactNumber(0x1p32) + half(words.low & 0xffffffff);
}

/// Returns x · 2^47, clamped and rounded to the nearest integer, by the C library.
ExactNumber expected_units(float x) {
  if (std::isnan(x)) return 0;
  return std::nearbyint(std::ldexp(std::fmin(std::fmax(x, -0x1p47), 0x1p47), 47));
}

ExactSum sum_of(const std::vector<float>& numbers) {
  ExactSum sum;
  for (const float x : numbers) sum.add(x);
  return sum;
}

/// Returns any float: NaN, infinite and denormal ones too.
float any_float(Random& random) { return std::bit_cast<float>(static_cast<std::uint32_t>(random.bits())); }

/// Returns a float as radiance may have, of either sign: from 2^-30 to 2^most.
float radiance(Random& random, int most = 50) {
  const double sign = random.bits() % 4 == 0 ? -1 : 1;
  return static_cast<float>(sign * std::exp2(random.real(-30, most)));
}

ExactNumber magnitude(const ExactNumber& x) { return x.sign() < 0 ? -x : x; }

/// Tests whether a float or a double is the one nearest to sum/count, and of two as near the even one.
template <class Float>
bool is_nearest(Float mean, const ExactSum& sum, std::uint32_t count) {
  using Bits = std::conditional_t<sizeof(Float) == 4, std::uint32_t, std::uint64_t>;
  const auto error = [&](Float value) {  // times count and 2^47
    return magnitude(ExactNumber(value) * ExactNumber(count) * ExactNumber(0x1p47) - units_of(sum));
  };
  constexpr Float infinity = std::numeric_limits<Float>::infinity();
  for (const Float other : {std::nextafter(mean, -infinity), std::nextafter(mean, infinity)}) {
    const int sign = (error(mean) - error(other)).sign();
    if (sign > 0 || (sign == 0 && std::bit_cast<Bits>(mean) % 2 != 0)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("a float counts exactly from 2^-24 on, and to the nearest 2^-47 below") {
  Random random(1);
  WrongCases wrong(random);
  for (int i = 0; i < cases(20000, 2000000); ++i) {
    const float x = i % 2 == 0 ? any_float(random) : radiance(random);
    const ExactSum sum = sum_of({x});
    wrong.add(!(units_of(sum) == expected_units(x)), x);
    const float size = std::abs(x);
    if (size >= 0x1p-24f && size <= 0x1p47f) wrong.add(sum.value() != x || sum.mean(1) != x, x);
    if (size < 0x1p-24f) wrong.add(!(std::abs(sum.value() - x) <= 0x1p-48), x);
    // Midway between two multiples of 2^-47.
    const float midway = std::ldexp(static_cast<float>(random.bits() >> 41 | 1), -48);
    wrong.add(!(units_of(sum_of({midway})) == expected_units(midway)), midway);
  }
  CHECK(wrong == 0);
}

TEST_CASE("infinite numbers and those beyond 2^47 count as 2^47, and NaN as 0") {
  CHECK(sum_of({0x1p47f}).value() == 0x1p47);
  CHECK(sum_of({0x1.000002p47f}).value() == 0x1p47);
  CHECK(sum_of({0x1.fffffep46f}).value() == 0x1.fffffep46);
  CHECK(sum_of({1e38f}).value() == 0x1p47);
  CHECK(sum_of({float_infinity}).value() == 0x1p47);
  CHECK(sum_of({-float_infinity}).value() == -0x1p47);
  CHECK(sum_of({-1e38f}).value() == -0x1p47);
  CHECK(sum_of({1, std::numeric_limits<float>::quiet_NaN(), 2}).value() == 3);
  CHECK(sum_of({-0.0f}) == ExactSum());
  CHECK(std::signbit(sum_of({-0.0f}).mean(1)) == false);
  CHECK(std::signbit(sum_of({0x1p40f, -0x1p40f}).mean(2)) == false);
}

TEST_CASE("the words of a sum are an integer in two's complement") {
  constexpr std::uint64_t ones = ~std::uint64_t{0};
  CHECK(sum_of({}).words() == ExactSum::Words{0, 0});
  CHECK(sum_of({0x1p-47f}).words() == ExactSum::Words{0, 1});
  CHECK(sum_of({0x1p-48f}).words() == ExactSum::Words{0, 0});
  CHECK(sum_of({0x1.8p-47f}).words() == ExactSum::Words{0, 2});
  CHECK(sum_of({-0x1p-47f}).words() == ExactSum::Words{-1, ones});
  CHECK(sum_of({0x1p15f}).words() == ExactSum::Words{0, std::uint64_t{1} << 62});
  CHECK(sum_of({-0x1p15f}).words() == ExactSum::Words{-1, std::uint64_t{3} << 62});
  CHECK(sum_of({0x1.000002p15f}).words() == ExactSum::Words{0, 0x4000008000000000});
  CHECK(sum_of({-0x1.000002p15f}).words() == ExactSum::Words{-1, 0xbfffff8000000000});
  CHECK(sum_of({0x1p17f}).words() == ExactSum::Words{1, 0});
  CHECK(sum_of({-0x1p17f}).words() == ExactSum::Words{-1, 0});
  CHECK(sum_of({0x1p47f}).words() == ExactSum::Words{1 << 30, 0});
  CHECK(sum_of({0x1p16f, 0x1p16f}).words() == ExactSum::Words{1, 0});
  CHECK(sum_of({0x1p15f, 0x1p15f, 0x1p15f, 0x1p15f}).words() == ExactSum::Words{1, 0});
  CHECK(sum_of({0x1p17f, -0x1p-47f}).words() == ExactSum::Words{0, ones});
  CHECK(sum_of({0x1p17f, -0x1p17f}).words() == ExactSum::Words{0, 0});
}

TEST_CASE("a sum is that of exact arithmetic, in any order and any grouping") {
  Random random(2);
  std::vector<float> numbers;
  ExactNumber expected;
  for (int i = 0; i < 400; ++i) {
    numbers.push_back(i % 50 == 0 ? any_float(random) : radiance(random));
    expected += expected_units(numbers.back());
  }
  WrongCases wrong(random);
  std::set<double> plain;
  for (int trial = 0; trial < cases(100, 1000); ++trial) {
    for (std::size_t i = numbers.size(); i > 1; --i) std::swap(numbers[i - 1], numbers[random.bits() % i]);
    std::vector<ExactSum> parts(1 + random.bits() % 40);
    double floats = 0;
    for (const float x : numbers) {
      parts[random.bits() % parts.size()].add(x);
      floats += ExactSum::bounded(x);
    }
    while (parts.size() > 1) {
      std::swap(parts[random.bits() % parts.size()], parts.back());
      const ExactSum last = parts.back();
      parts.pop_back();
      parts[random.bits() % parts.size()] += last;
    }
    wrong.add(!(units_of(parts[0]) == expected) || !(parts[0] == sum_of(numbers)), trial);
    plain.insert(floats);
  }
  CHECK(wrong == 0);
  CHECK(plain.size() > 1);  // these numbers would tell an order
}

TEST_CASE("2^32 - 1 numbers of any kind have an exact sum") {
  for (const float x : {0x1p47f, -0x1p47f, 0x1.fffffep46f, -0x1.fffffep46f, 0x1.000002p15f, 0x1p15f, -0x1p15f,
                        0x1.fffffep14f, -0x1p-47f, 0x1.fffffep-17f, -0x1.fffffep-17f}) {
    ExactSum power = sum_of({x}), all;
    for (int i = 0; i < 32; ++i) {  // 1 + 2 + 4 + …
      all += power;
      if (i < 31) power += power;
    }
    CAPTURE(x);
    CHECK(units_of(all) == expected_units(x) * ExactNumber(4294967295.0));
    CHECK(all.mean(4294967295u) == x);
  }
}

TEST_CASE("a mean is the float nearest to it, and a value the double, of two as near the even one") {
  Random random(3);
  WrongCases wrong(random);
  const auto try_one = [&](const ExactSum& sum, std::uint32_t count) {
    const float mean = sum.mean(count);
    wrong.add(!is_nearest(mean, sum, count), mean, sum.value(), count);
    const double value = sum.value();
    wrong.add(!is_nearest(value, sum, 1), value);
  };
  // An odd number of so many binary digits, of either sign.
  const auto odd = [&](int digits) {
    const std::uint64_t top = std::uint64_t{1} << (digits - 1);
    const auto number = static_cast<std::int64_t>(top | (random.bits() & (top - 1)) | 1);
    return random.bits() % 2 == 0 ? number : -number;
  };
  const auto one_beside = [&](ExactSum sum) {
    sum += ExactSum::of_units(static_cast<std::int64_t>(random.bits() % 3) - 1, 0);
    return sum;
  };
  for (int i = 0; i < cases(4000, 400000); ++i) {
    // Counts and sums of all sizes and of either sign, within those of count numbers.
    const auto count =
        static_cast<std::uint32_t>(1 + (random.bits() >> 32 >> random.bits() % 32) % 4294967295u);
    const std::int64_t most = std::int64_t{count} << 30;
    const std::int64_t high = (static_cast<std::int64_t>(random.bits()) >> random.bits() % 64) % most;
    try_one(ExactSum({high, random.bits() >> random.bits() % 64}), count);
    try_one(ExactSum({-static_cast<std::int64_t>(random.bits() % 2), random.bits()}), count);
    // A float and half of its last digit lie midway between two, times any count. So does a double for a
    // count of 1. The sum is that of one of them, or one unit beside it.
    const auto few = static_cast<std::uint32_t>(1 + random.bits() % 1000);
    const auto exponent = static_cast<int>(random.bits() % 64);
    try_one(one_beside(ExactSum::of_units(odd(25) * few, exponent)), few);
    try_one(one_beside(ExactSum::of_units(odd(54), exponent % 40)), 1);
  }
  CHECK(wrong == 0);
  CHECK(ExactSum({1 << 30, 0}).mean(0) == 0);
  CHECK(ExactSum({0, 1}).mean(4294967295u) == 0x1p-79f);  // 2^-47/(2^32 − 1)
  CHECK(ExactSum({-1, ~std::uint64_t{0}}).mean(4294967295u) == -0x1p-79f);
}

TEST_CASE("a sum of colors is that of its channels, in range or not") {
  Random random(4);
  ExactColorSum colors, others;
  ExactSum red, green, blue;
  WrongCases wrong(random);
  for (int i = 0; i < 1000; ++i) {
    const auto channel = [&] { return i % 3 == 0 ? any_float(random) : radiance(random); };
    const Color color{channel(), channel(), channel()};
    (i % 5 == 0 ? others : colors).add(color);
    red.add(color.r), green.add(color.g), blue.add(color.b);
    ExactColorSum sum = colors;
    sum += others;
    wrong.add(sum.channels != std::array{red, green, blue}, color);
  }
  CHECK(wrong == 0);
  CHECK_FALSE(colors == others);
  colors += others;
  CHECK(colors.mean(1000) == Color{red.mean(1000), green.mean(1000), blue.mean(1000)});
}

TEST_CASE("sums in lanes are those of one number after the other") {
  constexpr int lanes = simd::double_lanes;
  Random random(5);
  WrongCases wrong(random);
  for (int trial = 0; trial < cases(200, 20000); ++trial) {
    ExactLanes<lanes> several;
    std::array<ExactSum, lanes> each;
    for (int i = 0; i < 20; ++i) {
      std::array<float, lanes> x;
      for (std::size_t k = 0; k < x.size(); ++k) {
        x[k] = trial % 4 == 0   ? any_float(random)
               : trial % 4 == 1 ? std::ldexp(static_cast<float>(random.bits() >> 41), -48)
                                : radiance(random, trial % 4 == 2 ? 15 : 50);
        each[k].add(x[k]);
      }
      several.add(simd::Lanes<float, lanes>::of_each([&](int k) { return x[static_cast<std::size_t>(k)]; }));
    }
    for (int k = 0; k < lanes; ++k) wrong.add(!(several[k] == each[static_cast<std::size_t>(k)]), trial, k);
  }
  CHECK(wrong == 0);

  // The most numbers that there may be, the last of which has a lower digit than the sum of the others.
  for (const float x : {0x1p47f, -0x1.fffffep46f, 0x1.8p16f, 0x1p16f, 0x1p15f, -0x1.fffffep-18f}) {
    ExactLanes<lanes> many;
    constexpr int most = (1 << 22) - 1;
    for (int i = 1; i < most; ++i) many.add(x);
    const float last = x == -0x1.fffffep-18f ? -0x1p-47f : 0x1p-16f;
    many.add(last);
    CAPTURE(x);
    CHECK(units_of(many[0]) == expected_units(x) * ExactNumber(most - 1) + expected_units(last));
  }
}

TEST_CASE("means in lanes are those of one number after the other") {
  constexpr int lanes = simd::double_lanes;
  Random random(6);
  WrongCases wrong(random);
  int ties = 0;
  for (int trial = 0; trial < cases(3000, 300000); ++trial) {
    ExactLanes<lanes> several;
    // Numbers of few digits have sums in the middle between two floats, and others sums that no double holds.
    const int digits = trial % 24, count = trial % 3 == 0 ? 1 << trial % 7 : 1 + trial % 67;
    for (int i = 0; i < count; ++i)
      several.add(simd::Lanes<float, lanes>::of_each([&](int) {
        if (trial % 5 == 0) return any_float(random);
        const float x = radiance(random, trial % 7 < 5 ? 15 : 50);
        return trial % 5 == 1 ? x : std::ldexp(std::nearbyint(std::ldexp(x, digits)), -digits);
      }));
    const auto n = static_cast<std::uint32_t>(count);
    const simd::Lanes<float, lanes> means = several.mean(n);
    for (int k = 0; k < lanes; ++k) {
      const float expected = several[k].mean(n);
      const double quotient = several[k].value() / n;
      ties += quotient != static_cast<double>(expected) &&
              2 * quotient - static_cast<double>(expected) ==
                  static_cast<double>(static_cast<float>(2 * quotient - static_cast<double>(expected)));
      wrong.add(means[k] != expected, trial, k);
    }
  }
  CHECK(wrong == 0);
  CHECK(ties > 10 * lanes);

  // Beside the middle between two floats by less than double tells.
  for (const float size : {1024.0f, -1024.0f, 0x1p36f, 0x1p40f, -0x1p40f})
    for (const float beside : {-0x1p-16f, -0x1p-47f, 0.0f, 0x1p-47f, 0x1p-16f}) {
      const float next = size * (1 + 0x1p-23f);
      ExactLanes<lanes> several;
      for (const float x : {size, next, beside}) several.add(x);
      CAPTURE(size, beside);
      CHECK(several.mean(2)[0] == (beside * size > 0 ? next : size));
    }

  // One lane beyond 2^15 among others.
  ExactLanes<lanes> several;
  for (int i = 0; i < 3; ++i)
    several.add(simd::Lanes<float, lanes>::of_each([](int k) { return k == 1 ? 1e9f : 0.1f; }));
  for (int k = 0; k < lanes; ++k) CHECK(several.mean(3)[k] == (k == 1 ? 1e9f : 0.1f));
}

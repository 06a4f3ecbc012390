#include <protostar/exact/enclosure.hpp>
#include <protostar/exact/functions.hpp>

#include <algorithm>
#include <cmath>
#include <protostar/simd/vectors.hpp>
#include <type_traits>
#include <utility>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/true_number.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

exact::Quad quad(double x) { return x; }
exact::Quad quad(DoubleDouble x) { return exact::Quad(x.hi) + exact::Quad(x.lo); }

/// Returns true if an enclosure contains a number: in double without any doubt, in double-double up to the
/// error of the number of 113 bits itself.
bool holds(const Enclosure<double>& e, TrueNumber x) {
  return quad(e.lower) <= x.value && x.value <= quad(e.upper);
}
bool holds(const Enclosure<DoubleDouble>& e, TrueNumber x) {
  const exact::Quad off = exact::Quad(0x1p-106) * (abs(x).value + 1);
  return quad(e.lower) - off <= x.value && x.value <= quad(e.upper) + off;
}

bool is_interval(const Enclosure<double>& e) { return e.lower <= e.upper; }
bool is_interval(const Enclosure<DoubleDouble>& e) {
  return e.lower <= e.upper && !std::isnan(e.lower.lo) && !std::isnan(e.upper.lo);
}

/// Returns a number about 1, or of a size from 2^-reach to 2^reach, at most 2^1020, or a whole one, or 0.
double number_for_ends(Random& random, int reach) {
  const auto exponent = [&] { return std::min(static_cast<int>(random.whole(reach)), 1020); };
  switch (random.bits() % 5) {
    case 0:
      return static_cast<double>(random.whole(4));
    case 1:
      return std::ldexp(random.real(-1, 1), exponent());
    case 2:
      return random.bits() % 2 == 0 ? 0 : std::ldexp(1, exponent());
    default:
      return random.real(-4, 4);
  }
}
DoubleDouble any_end(Random& random, int reach, DoubleDouble) {
  const double x = number_for_ends(random, reach);
  return fast_two_sum(x, random.bits() % 2 == 0 ? 0 : x * random.real(-0x1p-54, 0x1p-54));
}
double any_end(Random& random, int reach, double) { return number_for_ends(random, reach); }

/// Interval and a number in it.
template <class B>
struct Sample {
  Enclosure<B> interval;
  TrueNumber number;

  Sample(Random& random, int reach) {
    B a = any_end(random, reach, B{}), b = any_end(random, reach, B{});
    switch (random.bits() % 4) {
      case 0:
        b = a;
        break;
      case 1:
        b = a + B(std::abs(static_cast<double>(a)) * random.real(0, 0x1p-30));
        break;
      default:
        break;
    }
    if (b < a) std::swap(a, b);
    interval = {a, b};
    const exact::Quad share = random.bits() % 3 == 0 ? exact::Quad(random.bits() % 2) : random.real(0, 1);
    number = TrueNumber::of(quad(a) + share * (quad(b) - quad(a)));
    if (number.value > quad(b)) number.value = quad(b);
  }
};

/// Tests that f of two intervals contains f of numbers in them.
template <class B>
void check_containment(const char* name, int reach, const auto& f) {
  Random random(11);
  WrongCases wrong(random);
  for (int i = 0; i < cases(1500, 200000); ++i) {
    const Sample<B> a(random, reach), b(random, reach);
    const Enclosure<B> result = f(a.interval, b.interval);
    wrong.add(!is_interval(result) || !holds(result, f(a.number, b.number)),
              static_cast<double>(a.interval.lower), static_cast<double>(a.interval.upper),
              static_cast<double>(b.interval.lower), static_cast<double>(b.interval.upper));
  }
  INFO(name);
  CHECK(wrong == 0);
}

template <class B>
void check_all_containment(int reach) {
  check_containment<B>("sum", reach, [](const auto& a, const auto& b) { return a + b; });
  check_containment<B>("difference", reach, [](const auto& a, const auto& b) { return a - b; });
  check_containment<B>("product", reach, [](const auto& a, const auto& b) { return a * b; });
  check_containment<B>("multiples", reach, [](const auto& a, const auto& b) { return a * 0.3 - -3 * b; });
  check_containment<B>("minimum", reach, [](const auto& a, const auto& b) { return min(a, b); });
  check_containment<B>("maximum", reach, [](const auto& a, const auto& b) { return max(a, 2.5 + b); });
  check_containment<B>("absolute value", reach, [](const auto& a, const auto& b) { return abs(a) - b; });
  check_containment<B>("square", reach, [](const auto& a, const auto&) { return square(a); });
  check_containment<B>("root", reach, [](const auto& a, const auto&) { return sqrt(a); });
  check_containment<B>("smooth minimum", reach,
                       [](const auto& a, const auto& b) { return smooth_min(a, b, 0.7); });
  check_containment<B>("length", reach, [](const auto& a, const auto& b) {
    const std::remove_cvref_t<decltype(a)> v[] = {a, b, 0.5};
    return length_of(v);
  });
  check_containment<B>("signed length", reach, [](const auto& a, const auto& b) {
    const std::remove_cvref_t<decltype(a)> q[] = {a, b};
    return signed_length_of(q);
  });
}

}  // namespace

TEST_CASE("enclosures contain the exact results of arithmetic") {
  check_all_containment<double>(40);
  check_all_containment<double>(1070);  // with overflow and underflow
  check_all_containment<DoubleDouble>(40);
  check_all_containment<DoubleDouble>(1020);
}

TEST_CASE("enclosures contain exact quotients, and are all numbers if the divisor may be 0") {
  Random random(12);
  WrongCases wrong(random);
  int divided = 0;
  const auto look = [&]<class B>(B) {
    const Sample<B> a(random, 300), b(random, 300);
    const Enclosure<B> quotient = a.interval / b.interval;
    const bool may_be_0 = b.interval.contains(B(0.0));
    wrong.add(may_be_0 ? !(quotient.upper.hi == infinity) : !holds(quotient, a.number / b.number));
    divided += !may_be_0;
  };
  for (int i = 0; i < 3000; ++i) {
    const Sample<double> a(random, 900), b(random, 900);
    const Enclosure<double> quotient = a.interval / b.interval;
    const bool may_be_0 = b.interval.contains(0);
    wrong.add(may_be_0 ? quotient.lower > -infinity || quotient.upper < infinity
                       : !holds(quotient, a.number / b.number),
              a.interval.lower, a.interval.upper, b.interval.lower, b.interval.upper);
    divided += !may_be_0;
    look(DoubleDouble());
  }
  CHECK(wrong == 0);
  CHECK(divided > 2000);
}

TEST_CASE("enclosures contain quotients of the smallest numbers") {
  // Low parts of the long division underflow; the remainders that are left are divided by small numbers.
  Random random(13);
  WrongCases wrong(random);
  for (int i = 0; i < 10000; ++i) {
    const auto any = [&](int least, int most) {
      const double x =
          std::ldexp(random.real(1, 2), -least - static_cast<int>(std::abs(random.whole(most - least))));
      return fast_two_sum(x, x * random.real(-0x1p-54, 0x1p-54));
    };
    const DoubleDouble a = any(950, 1020), b = any(100, 500);
    const auto is_in = [&](const Enclosure<DoubleDouble>& e, exact::Quad x) {
      const exact::Quad share = exact::Quad(0x1p-110);
      return quad(e.lower) <= x * (1 + share) && x * (1 - share) <= quad(e.upper);
    };
    const auto at = [](DoubleDouble x) { return Enclosure<DoubleDouble>::at(x); };
    wrong.add(!is_in(at(a) / at(b), quad(a) / quad(b)), a.hi, b.hi);
    wrong.add(!is_in(at(a) / b.hi, quad(a) / b.hi), a.hi, b.hi);
    const DoubleDouble largest = any(940, 949);
    wrong.add(!is_in(unit_component(at(a), at(largest)), quad(a) / quad(largest)), a.hi, largest.hi);
  }
  CHECK(wrong == 0);
}

TEST_CASE("repetitions are exact, but for kinks and jumps inside an interval") {
  const auto folded = [](const auto& a, const auto&) { return fold(a); };
  check_containment<double>("fold", 60, folded);
  check_containment<DoubleDouble>("fold", 60, folded);
  // A function of it that is continuous, since halfway between integers either of two answers will do.
  const auto wrapped = [](const auto& a, const auto&) { return wrap(a) * (0.25 - square(wrap(a))); };
  check_containment<double>("wrap", 60, wrapped);
  check_containment<DoubleDouble>("wrap", 60, wrapped);

  CHECK(fold(Enclosure<double>(2.25, 2.5)).lower == 0.25);
  CHECK(fold(Enclosure<double>(2.25, 2.5)).upper == 0.5);
  CHECK(fold(Enclosure<double>(1.75, 2.5)).lower == 0);
  CHECK(fold(Enclosure<double>(1.75, 2.5)).upper == 0.5);
  CHECK(fold(Enclosure<double>(-3.5, -2.75)).lower == 0.5);
  CHECK(fold(Enclosure<double>(-3.5, -2.75)).upper == 1);
  CHECK(wrap(Enclosure<double>(-3.25, -2.75)).lower == -0.25);
  CHECK(wrap(Enclosure<double>(-3.25, -2.75)).upper == 0.25);
  CHECK(wrap(Enclosure<double>(0.25, 0.75)).upper == 0.5);
  // 1 − 2^-80 and 1 + 2^-80 are on both sides of a kink that double does not see.
  const DoubleDouble less(1, -0x1p-80), more(1, 0x1p-80);
  CHECK(fold(Enclosure<DoubleDouble>(less, less)).upper < DoubleDouble(1));
  CHECK(fold(Enclosure<DoubleDouble>(more, more)).upper < DoubleDouble(1));
  CHECK(fold(Enclosure<DoubleDouble>(less, more)).upper.hi == 1);
}

TEST_CASE("what an enclosure cannot know is everything, and never NaN") {
  const Enclosure<double> whole = Enclosure<double>::whole(), huge(0x1p1000, 0x1p1023);
  const auto is_all = [](const Enclosure<double>& e) { return e.lower == -infinity && e.upper == infinity; };
  CHECK(is_all(whole * Enclosure<double>(0.0)));
  CHECK(is_all(whole - whole));
  CHECK(is_all(whole + whole));
  CHECK(is_all(Enclosure<double>(0.0) / Enclosure<double>(0.0)));
  CHECK(is_all(whole / huge));
  CHECK((huge * huge).upper == infinity);
  CHECK((huge * huge).lower < infinity);
  CHECK((huge + huge).lower <= 0x1p1001);
  CHECK(sqrt(whole).lower == 0);
  CHECK(sqrt(whole).upper == infinity);
  CHECK(fold(whole).lower == 0);
  CHECK(fold(whole).upper == 1);
  CHECK(wrap(whole).upper == 0.5);
  CHECK(sin(whole).lower == -1);
  CHECK(exp(whole).upper == infinity);
  CHECK(is_all(log(Enclosure<double>(-1, 1))));
  const Enclosure<double> v[] = {whole, 1.0};
  CHECK(length_of(v).upper == infinity);
  CHECK(unit_component(whole, length_of(v)).lower == -1);

  const Enclosure<DoubleDouble> most(0x1p1023);
  CHECK((most * most).upper.hi == infinity);
  CHECK((most + most + most).upper.hi == infinity);
  CHECK((most + most + most).lower.hi == -infinity);
}

TEST_CASE("an end that is exactly 0 stays 0") {
  const Enclosure<double> half(0, 1), tiny(-0x1p-800, 0x1p-800);
  CHECK((half * half).lower == 0);
  CHECK((half * -half).upper == 0);
  CHECK((Enclosure<double>(0.0) * tiny).upper == 0);
  CHECK((half * 0.3).lower == 0);
  CHECK((half / Enclosure<double>(1, 2)).lower == 0);
  CHECK(square(Enclosure<double>(0.0)).upper == 0);
  CHECK(sqrt(Enclosure<double>(0.0)).upper == 0);
  CHECK(unit_component(half, Enclosure<double>(1, 2)).lower == 0);
  // A product that underflows to 0 does not become one.
  CHECK((tiny * tiny).lower < 0);
  CHECK((Enclosure<double>(0x1p-800) * 0x1p-800).upper > 0);
}

TEST_CASE("enclosures in lanes have the bits of single ones") {
  Random random(13);
  WrongCases wrong(random);
  using Lanes = Enclosure<simd::Doubles>;
  const auto f = [](const auto& a, const auto& b) {
    const std::remove_cvref_t<decltype(a)> v[] = {a, b};
    const auto sum = smooth_min(a * b, sqrt(a) / (abs(b) + 1.0), 0.3) + length_of(v) - signed_length_of(v);
    return sum + sin(fold(a)) * cos(b) + wrap(b) + exp(fold(b) - a) + log(square(b) + 0.5);
  };
  for (int i = 0; i < 300; ++i) {
    Lanes a, b;
    Enclosure<double> one[simd::double_lanes];
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const Sample<double> x(random, 8), y(random, 8);
      a.lower.set(lane, x.interval.lower), a.upper.set(lane, x.interval.upper);
      b.lower.set(lane, y.interval.lower), b.upper.set(lane, y.interval.upper);
      one[lane] = f(x.interval, y.interval);
    }
    const Lanes all = f(a, b);
    for (int lane = 0; lane < simd::double_lanes; ++lane)
      wrong.add(all.lower[lane] != one[lane].lower || all.upper[lane] != one[lane].upper, a.lower[lane],
                a.upper[lane], b.lower[lane], b.upper[lane]);
  }
  CHECK(wrong == 0);
}

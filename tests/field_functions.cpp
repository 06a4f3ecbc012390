// Tests of sine, cosine, exponential and logarithm of fields (exact/functions.hpp).
#include <math.h>  // with its functions at global scope, which must not be taken for a field's

#include <protostar/exact/distance_field.hpp>
#include <protostar/exact/functions.hpp>
#include <protostar/fields/operations.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/true_number.hpp"
#include "support/wrong_cases.hpp"

namespace {

using protostar::DoubleDouble;
using protostar::Enclosure;
using protostar::Plain;
using protostar::Slope;
using protostar::Variation;

/// Returns |x − truth| in double.
double distance_to(double x, TrueNumber truth) {
  return std::abs(static_cast<double>(exact::Quad(x) - truth.value));
}

TrueNumber true_of(double x) { return x; }
TrueNumber true_of(DoubleDouble x) { return TrueNumber::of(exact::Quad(x.hi) + exact::Quad(x.lo)); }

/// Checks that an enclosure has both ends around f(x), and that its width is at most `most`.
template <class B>
void check_point(WrongCases& wrong, const B& x, const auto& f, double most) {
  const auto found = f(Enclosure<B>::at(x));
  const TrueNumber truth = f(true_of(x));
  // In double-double, numbers of 113 bits are off by 2^-104 of the value, and by 2^-112 of an angle's digits.
  const exact::Quad size = std::min(std::abs(static_cast<double>(x)), 0x1p20);
  const exact::Quad off = std::is_same_v<B, double>
                              ? exact::Quad(0)
                              : exact::Quad(0x1p-104) * (1 + abs(truth).value) + exact::Quad(0x1p-112) * size;
  const exact::Quad low = true_of(found.lower).value - off, high = true_of(found.upper).value + off;
  wrong.add(!(low <= truth.value && truth.value <= high), static_cast<double>(x));
  const exact::Quad width = true_of(found.upper).value - true_of(found.lower).value;
  wrong.add(!(static_cast<double>(width) <= most), static_cast<double>(x), "width");
}

}  // namespace

TEST_CASE("plain sine and cosine have errors below 2^-51 up to 2^20") {
  Random random(31);
  WrongCases wrong(random);
  double most = 0;
  for (int i = 0; i < cases(4000, 1000000); ++i) {
    double x = random.real(-8, 8);
    if (i % 4 == 1) x = random.real(-0x1p20, 0x1p20);
    if (i % 4 == 2)
      x = std::round(random.real(-600000, 600000)) * 1.5707963267948966 + random.real(-1e-6, 1e-6);
    if (i % 4 == 3) x = std::ldexp(random.real(-1, 1), -static_cast<int>(random.bits() % 60));
    const double sine = distance_to(sin(Plain<double>(x)).value, sin(TrueNumber(x))),
                 cosine = distance_to(cos(Plain<double>(x)).value, cos(TrueNumber(x)));
    wrong.add(!(sine < 0x1p-51 && cosine < 0x1p-51), x, sine, cosine);
    most = std::max({most, sine, cosine});
  }
  CHECK(wrong == 0);
  CHECK(most > 0x1p-54);
}

TEST_CASE("plain exponentials and logarithms have relative errors below 2^-51 and 2^-50") {
  Random random(32);
  WrongCases wrong(random);
  for (int i = 0; i < cases(1500, 300000); ++i) {
    const double x = i % 2 == 0 ? random.real(-600, 600) : random.real(-2, 2);
    const TrueNumber power = exp(TrueNumber(x));
    wrong.add(!(distance_to(exp(Plain<double>(x)).value, power) < 0x1p-51 * static_cast<double>(power)), x,
              "exponential");
    const double y =
        i % 2 == 0 ? std::exp2(random.real(-800, 800)) : 1 + random.real(-0x1p-3, 0x1p-3) * random.real(0, 1);
    const TrueNumber logarithm = log(TrueNumber(y));
    wrong.add(!(distance_to(log(Plain<double>(y)).value, logarithm) <=
                0x1p-50 * std::abs(static_cast<double>(logarithm))),
              y, "logarithm");
  }
  CHECK(wrong == 0);
  CHECK(exp(Plain<double>(0.0)).value == 1);
  CHECK(log(Plain<double>(1.0)).value == 0);
}

TEST_CASE("enclosures of functions at a number are narrow and contain the value") {
  Random random(33);
  WrongCases wrong(random);
  const auto sine = [](const auto& x) { return sin(x); };
  const auto cosine = [](const auto& x) { return cos(x); };
  const auto power = [](const auto& x) { return exp(x); };
  const auto logarithm = [](const auto& x) { return log(x); };
  for (int i = 0; i < cases(150, 30000); ++i) {
    const double x = i % 2 == 0 ? random.real(-8, 8) : random.real(-0x1p20, 0x1p20), y = random.real(-3, 3),
                 z = std::exp2(random.real(-700, 700));
    const auto more = [&](double a) {
      return protostar::fast_two_sum(a, a * random.real(-0x1p-54, 0x1p-54));
    };
    check_point<double>(wrong, x, sine, 0x1p-49);
    check_point<double>(wrong, x, cosine, 0x1p-49);
    check_point<double>(wrong, y, power, 0x1p-44);
    check_point<double>(wrong, z, logarithm, 0x1p-38);
    check_point<DoubleDouble>(wrong, more(x), sine, 0x1p-95);
    check_point<DoubleDouble>(wrong, more(x), cosine, 0x1p-95);
    check_point<DoubleDouble>(wrong, more(y), power, 0x1p-90);
    check_point<DoubleDouble>(wrong, more(z), logarithm, 0x1p-90);
  }
  CHECK(wrong == 0);
}

TEST_CASE("enclosures of functions on intervals contain all values") {
  Random random(34);
  WrongCases wrong(random);
  for (int i = 0; i < cases(2000, 500000); ++i) {
    const double first = random.real(-9, 9), width = std::exp2(random.real(-40, 3)),
                 x = std::min(first + width * random.real(0, 1), first + width);
    const Enclosure<double> interval(first, first + width);
    const auto look = [&](const Enclosure<double>& found, TrueNumber truth, const char* name) {
      wrong.add(!(exact::Quad(found.lower) <= truth.value && truth.value <= exact::Quad(found.upper)), first,
                width, x, name);
    };
    look(sin(interval), sin(TrueNumber(x)), "sine");
    look(cos(interval), cos(TrueNumber(x)), "cosine");
    look(exp(interval), exp(TrueNumber(x)), "exponential");
    if (x > 0) look(log(interval), log(TrueNumber(x)), "logarithm");
  }
  CHECK(wrong == 0);
  CHECK(sin(Enclosure<double>(1, 2)).upper == 1);
  CHECK(sin(Enclosure<double>(4, 5)).lower == -1);
  CHECK(cos(Enclosure<double>(-1, 1)).upper == 1);
  CHECK(cos(Enclosure<double>(3, 4)).lower == -1);
  CHECK(sin(Enclosure<double>(1, 1.5)).upper < 1);
  CHECK(cos(Enclosure<double>(3.2, 6)).lower > -1);
}

TEST_CASE("a peak of the sine just inside the end of an interval is not missed") {
  for (const double turns : {0.0, 3.0, 1000.0, 100000.0}) {
    const DoubleDouble half_pi(0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54),
        peak = DoubleDouble(4 * turns + 1) * half_pi;
    const Enclosure<DoubleDouble> before{peak - DoubleDouble(0x1p-20), peak + DoubleDouble(0x1p-70)},
        after{peak - DoubleDouble(0x1p-70), peak + DoubleDouble(0x1p-20)};
    CHECK(sin(before).upper.hi == 1);
    CHECK(sin(after).upper.hi == 1);
    CHECK(DoubleDouble(1) <= sin(after).upper);
    CHECK(DoubleDouble(1) <= sin(before).upper);
  }
}

TEST_CASE("beyond the range of a function nothing is claimed") {
  const Enclosure<double> far(0x1p21), large(700), small(-700), tiny(0x1p-900);
  CHECK(sin(far).lower == -1);
  CHECK(sin(far).upper == 1);
  CHECK(exp(large).upper == protostar::infinity);
  CHECK(exp(small).lower == 0);
  CHECK(exp(small).upper > 0);
  CHECK(log(tiny).lower == -protostar::infinity);
  const auto error = [](double least, double most, const auto& f) {
    return f(Variation::of_coordinate(0, least, most)).error;
  };
  const auto sine = [](const auto& x) { return sin(x); };
  CHECK(error(0, 0x1p20, sine) < 0x1p-50);
  CHECK(error(0, 0x1p21, sine) == protostar::infinity);
  CHECK(error(0, 700, [](const auto& x) { return exp(x); }) == protostar::infinity);
  CHECK(error(0, 1, [](const auto& x) { return log(x); }) == protostar::infinity);
  CHECK(error(0.5, 1, [](const auto& x) { return log(x); }) < 0x1p-49);
}

namespace {

// A user's programs: with both namespaces, and with none.
namespace with_all_names {
using namespace std;
using namespace protostar;
constexpr auto field = [](const auto& p) {
  const auto ring = length(Vec2{p.x, p.z}) - 1.0;
  const auto wave = sin(p.x * 3) + cos(p.y) * exp(-abs(p.z)) - log(2 + square(p.x));
  return max(min(length(Vec2{ring, p.y}) - 0.3, wave), sqrt(abs(wave)) - fold(p.y) / 2);
};
}  // namespace with_all_names

namespace with_no_names {
constexpr auto field = [](const auto& p) {
  const auto ring = length(protostar::Vec2{p.x, p.z}) - 1.0;
  const auto wave = sin(p.x * 3) + cos(p.y) * exp(-abs(p.z)) - log(2 + square(p.x));
  return max(min(length(protostar::Vec2{ring, p.y}) - 0.3, wave), sqrt(abs(wave)) - fold(p.y) / 2);
};
}  // namespace with_no_names

/// Callable on plain points only: no distance field.
struct OnlyPlain {
  double operator()(const protostar::FieldPoint<Plain<double>>& p) const { return p.x.value; }
};

}  // namespace

TEST_CASE("a field finds the library's functions, whatever names a program uses") {
  static_assert(protostar::DistanceField<decltype(with_all_names::field)>);
  static_assert(protostar::DistanceField<decltype(with_no_names::field)>);
  static_assert(!protostar::DistanceField<OnlyPlain>);
  static_assert(!protostar::DistanceField<int>);
  protostar::require_distance_field<decltype(with_all_names::field)>();
  Random random(35);
  for (int i = 0; i < 50; ++i) {
    const protostar::Point p = random.point(2);
    CHECK(protostar::plain_value(with_all_names::field, p) ==
          protostar::plain_value(with_no_names::field, p));
  }
}

TEST_CASE("points of a field are added, multiplied and folded as vectors are") {
  using Point = protostar::FieldPoint<Plain<double>>;
  using protostar::Vec3;
  const Vec3 v{1, -2, 5}, w{7, 3, -4};
  const Point p{v.x, v.y, v.z}, q{w.x, w.y, w.z};
  const Plain<double> k = 3;
  const auto numbers = [](const Point& of) { return Vec3{of.x.value, of.y.value, of.z.value}; };
  CHECK(numbers(-p) == -v);
  CHECK(numbers(p + q) == v + w);
  CHECK(numbers(p - q) == v - w);
  CHECK(numbers(p + w) == v + w);
  CHECK(numbers(p - w) == v - w);
  CHECK(numbers(p * k) == 3.0 * v);
  CHECK(numbers(k * p) == 3.0 * v);
  CHECK(numbers(p * w) == v * w);
  CHECK(numbers(abs(p)) == Vec3{1, 2, 5});
  CHECK(numbers(fold(p)) == Vec3{1, 0, 1});
  CHECK(numbers(min(p, k)) == Vec3{1, -2, 3});
  CHECK(numbers(max(p, k)) == Vec3{3, 3, 5});
  CHECK(dot(p, q).value == 7 - 6 - 20);
  CHECK(dot(p, w).value == 7 - 6 - 20);
  CHECK(length(Point{2.0, -3.0, 6.0}).value == 7);
  CHECK(signed_length(Point{-1.0, 3.0, 4.0}).value == 5);
  CHECK(signed_length(Point{-3.0, -1.0, -2.0}).value == -1);
}

TEST_CASE("plain lengths of vectors with many components are off by no more than their bound") {
  // The squares of all components but the first are each lost in the sum, which is 1.
  const auto lengths = []<std::size_t n>(const double(&x)[n]) {
    Plain<double> plain[n];
    Variation bounds[n];
    exact::Quad squares = 0;
    for (std::size_t i = 0; i < n; ++i) {
      plain[i] = x[i], bounds[i] = x[i];
      squares += exact::Quad(x[i]) * exact::Quad(x[i]);
    }
    const double error = distance_to(length_of(plain).value, sqrt(TrueNumber::of(squares)));
    CAPTURE(n, error);
    CHECK(error <= length_of(bounds).error);
    CHECK(error > 0.25 * length_of(bounds).error);
  };
  constexpr double s = 0x1.6a09p-27;  // its square is below 2^-53, half the last place of 1
  lengths({1, s, s, s, s, s});
  lengths({1, s, s, s, s, s, s, s, s, s, s, s, s, s, s, s});
}

TEST_CASE("nothing is known of a smooth minimum whose width is so small that its plain value is no number") {
  const auto joined = [](double k) { return smooth_min(Variation(0.0), Variation(0.0), k); };
  CHECK(std::isnan(smooth_min(Plain<double>(0.0), Plain<double>(0.0), 0x1p-1030).value));
  CHECK(joined(0x1p-1030).error == protostar::infinity);
  CHECK(joined(0x1p-1020).error < protostar::infinity);
}

namespace {

/// Octant of space, which is open to one side.
struct Octant {
  template <class T>
  [[nodiscard]] T operator()(const protostar::FieldPoint<T>& p) const {
    return max(max(-p.x, -p.y), -p.z);
  }
  [[nodiscard]] static protostar::Bounds bounds(double level = 0) {
    return {protostar::Point(-level), protostar::Point(protostar::infinity)};
  }
  void validate() const {}
};

}  // namespace

TEST_CASE("a shape that is open to one side, once rotated, has infinite bounds") {
  const protostar::Bounds box = protostar::fields::Rotated<Octant>({}, {1, 2, 3}, 40).bounds();
  CHECK(box.min == protostar::Point(-protostar::infinity));
  CHECK(box.max == protostar::Point(protostar::infinity));
}

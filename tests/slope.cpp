#include <protostar/exact/distance_field.hpp>

#include <cmath>
#include <type_traits>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/sample_fields.hpp"
#include "support/true_number.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

exact::Quad end_of(double x) { return x; }
exact::Quad end_of(DoubleDouble x) { return exact::Quad(x.hi) + exact::Quad(x.lo); }

/// Returns true if a number is in an enclosure, up to an error of the number itself.
template <class B>
bool is_in(const Enclosure<B>& e, exact::Quad x, exact::Quad error) {
  return end_of(e.lower) - error <= x && x <= end_of(e.upper) + error;
}

/// Returns the true value of a field at origin + t · direction.
exact::Quad true_value(const auto& field, const Point& origin, const Vec3& direction, exact::Quad t) {
  const auto at = [&](int k) { return TrueNumber(origin[k]) + TrueNumber::of(t) * direction[k]; };
  const TrueNumber value = field(FieldPoint<TrueNumber>{at(0), at(1), at(2)});
  return value.value;
}

/// Checks enclosures of the values and slopes of a field on random segments, of lengths from 2^-53 to 1.
template <class B>
void check_segments(const auto& field, double size, int count) {
  Random random(21);
  WrongCases wrong(random);
  double widest = 0;
  for (int i = 0; i < count; ++i) {
    Point origin = random.point(size / 2);
    Vec3 direction = random.point(size / 2);
    if (i % 5 == 0) origin[i % 3] = direction[i % 3] = 0;  // in a plane of symmetry, on kinks
    const double first = random.real(0, 1), length = std::exp2(-53 * random.real(0, 1));
    const Enclosure<B> t{B(first), B(first) + B(length)};
    const Slope<Enclosure<B>> found = slope_at<B>(field, origin, direction, t);
    const Enclosure<B> values = value_at<B>(field, origin, direction, t);
    const exact::Quad a = first, c = a + length, b = a + random.real(0, 1) * (c - a);
    const exact::Quad f_a = true_value(field, origin, direction, a),
                      f_b = true_value(field, origin, direction, b),
                      f_c = true_value(field, origin, direction, c);
    // 2^-100 exceeds errors of the true values, 2^-106 of numbers below 30.
    wrong.add(!is_in(found.value, f_b, 0x1p-100) || !is_in(found.value, f_c, 0x1p-100), origin, direction,
              first, length, "value");
    wrong.add(!is_in(values, f_a, 0x1p-100) || !is_in(values, f_b, 0x1p-100), origin, direction, first,
              length, "value alone");
    wrong.add(!is_in(found.slope, (f_c - f_a) / (c - a), 0x1p-99 / (c - a)), origin, direction, first, length,
              "slope");
    if (b > a)
      wrong.add(!is_in(found.slope, (f_b - f_a) / (b - a), 0x1p-99 / (b - a)), origin, direction, first,
                length, "slope of a part");
    if (length < 0x1p-48)
      widest = std::max(widest, static_cast<double>(end_of(values.upper) - end_of(values.lower)));
  }
  CHECK(wrong == 0);
  // Along directions of at most 1.56, fields change by at most 27, that of the gyroid, and 100 operations
  // move ends of numbers up to 10 by twice 2^-52 or 2^-102 (rounding.hpp).
  const double share = std::is_same_v<B, double> ? 0x1p-52 : 0x1p-102;
  CHECK(widest <= 27 * 0x1p-48 + 1000 * 2 * share);
}

}  // namespace

TEST_CASE("enclosures of fields on segments contain values and difference quotients") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    check_segments<double>(field, size, cases(400, 200000));
    check_segments<DoubleDouble>(field, size, cases(60, 20000));
  });
}

TEST_CASE("an enclosure in double-double of a field at a point is 2^-85 wide or less") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    Random random(22);
    WrongCases wrong(random);
    for (int i = 0; i < 60; ++i) {
      const Point origin = random.point(size / 2);
      const Enclosure<DoubleDouble> values = value_at<DoubleDouble>(field, origin, {1, 0, 0}, 0.0);
      const exact::Quad width = end_of(values.upper) - end_of(values.lower);
      wrong.add(!(width <= exact::Quad(0x1p-85)), origin, static_cast<double>(width));
    }
    CHECK(wrong == 0);
  });
}

TEST_CASE("plain values have the same bits for one point and in lanes") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    Random random(23);
    WrongCases wrong(random);
    for (int i = 0; i < 50; ++i) {
      simd::Vectors points;
      double values[simd::double_lanes];
      for (int lane = 0; lane < simd::double_lanes; ++lane) {
        const Point p = random.point(size);
        points.x.set(lane, p.x), points.y.set(lane, p.y), points.z.set(lane, p.z);
        values[lane] = plain_value(field, p);
      }
      const simd::Doubles all = plain_values(field, points);
      for (int lane = 0; lane < simd::double_lanes; ++lane)
        wrong.add(all[lane] != values[lane], points[lane]);
    }
    CHECK(wrong == 0);
  });
}

TEST_CASE("at a kink, a slope has those of both sides") {
  using Number = Slope<Enclosure<double>>;
  const Number t({-1, 1}, 1.0), right({1, 2}, 1.0);
  CHECK(abs(t).slope.lower == -1);
  CHECK(abs(t).slope.upper == 1);
  CHECK(abs(right).slope.lower == 1);
  CHECK(abs(-right).slope.upper == 1);
  CHECK(max(t, 0.0).slope.lower == 0);
  CHECK(max(t, 0.0).slope.upper == 1);
  CHECK(max(t, 2.0).slope.upper == 0);
  CHECK(min(t, 2.0).slope.lower == 1);
  CHECK(fold(Number({0.5, 0.75}, 1.0)).slope.lower == 1);
  CHECK(fold(Number({1.5, 1.75}, 1.0)).slope.upper == -1);
  CHECK(fold(Number({0.5, 1.75}, 1.0)).slope.lower == -1);
  CHECK(fold(Number({0.5, 1.75}, 1.0)).slope.upper == 1);
  // The signed distance from an octant changes by as much as its argument, also at its border.
  const Number q[] = {t, Number({-2, -1.5}, 0.0), -0.5};
  CHECK(signed_length_of(q).slope.upper <= 1 + 0x1p-48);
  CHECK(signed_length_of(q).slope.lower >= 0);
}

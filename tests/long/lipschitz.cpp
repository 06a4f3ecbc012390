// Tests of Lipschitz constants and rounding errors of fields (exact/lipschitz.hpp).
#include <protostar/exact/distance_field.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/sample_fields.hpp"
#include "support/true_number.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

TrueNumber true_at(const auto& field, const Point& p) { return field(FieldPoint<TrueNumber>{p.x, p.y, p.z}); }

Bounds cube_of(double size) { return {Point{-size}, Point{size}}; }

/// Returns the second difference of a field around a point, over h²: a value of its second derivative along
/// h.
double curve_of(const auto& field, const Point& p, const Vec3& h) {
  const FieldPoint<TrueNumber> at{p.x, p.y, p.z}, way{h.x, h.y, h.z};
  const TrueNumber twice = field(at + way) + field(at - way) - field(at) * 2.0;
  return static_cast<double>(twice / (way.x * way.x + way.y * way.y + way.z * way.z));
}

/// Tests whether a value of curve_of is in its bounds: true numbers are off by less than 2^-80, and h² is
/// above 2^-26.
bool is_in_bounds(double curve, const Enclosure<double>& bound) {
  return bound.lower - 0x1p-50 <= curve && curve <= bound.upper + 0x1p-50;
}

}  // namespace

TEST_CASE("fields vary by no more than their Lipschitz constant") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    Random random(41);
    WrongCases wrong(random);
    const FieldBound bound = lipschitz_bound(field, cube_of(size), 100);
    double most = 0;
    for (int i = 0; i < cases(400, 100000); ++i) {
      const Point p = random.point(size);
      Point q = p + std::exp2(random.real(-30, 0)) * random.direction();
      for (int k = 0; k < 3; ++k) q[k] = std::clamp(q[k], -size, size);
      if (i % 5 == 0) q[i % 3] = p[i % 3];
      const TrueNumber way[] = {TrueNumber(q.x) - p.x, TrueNumber(q.y) - p.y, TrueNumber(q.z) - p.z};
      const double ratio = static_cast<double>(abs(true_at(field, p) - true_at(field, q)) / length_of(way));
      wrong.add(!(ratio <= bound.lipschitz), p, q, ratio, bound.lipschitz);
      most = std::max(most, ratio);
    }
    CHECK(wrong == 0);
    CHECK(bound.lipschitz < 30 * most);
  });
}

TEST_CASE("fields curve along lines by no more than the bounds of their second derivatives") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    Random random(43);
    WrongCases wrong(random);
    const Enclosure<double> bound = lipschitz_bound(field, cube_of(size), 100).curvature;
    if (bound.lower == -infinity && bound.upper == infinity) return;
    for (int i = 0; i < cases(400, 100000); ++i) {
      const Point p = random.point(size);
      const Vec3 h = std::exp2(random.real(-12, 0)) * random.direction();
      bool is_inside = true;
      for (int k = 0; k < 3; ++k) is_inside = is_inside && std::abs(p[k]) + std::abs(h[k]) < size;
      if (!is_inside) continue;
      const double curve = curve_of(field, p, h);
      wrong.add(!is_in_bounds(curve, bound), p, h, curve, bound.lower, bound.upper);
    }
    CHECK(wrong == 0);
  });
}

TEST_CASE("in small boxes, too, fields curve by no more than the bounds of their second derivatives") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    Random random(45);
    WrongCases wrong(random);
    int bounded = 0;
    for (int i = 0; i < cases(400, 40000); ++i) {
      const Point p = random.point(size);
      const Vec3 h = std::exp2(random.real(-12, -6)) * random.direction(), reach = abs(h);
      const Enclosure<double> bound = lipschitz_bound(field, {p - reach, p + reach}, 1).curvature;
      bounded += bound.lower > -infinity || bound.upper < infinity;
      const double curve = curve_of(field, p, h);
      wrong.add(!is_in_bounds(curve, bound), p, h, curve, bound.lower, bound.upper);
    }
    CHECK(wrong == 0);
    CHECK(bounded > 0);
  });
}

TEST_CASE("bounds of second derivatives are those of convex, smooth and other fields") {
  const auto curvature = [](const auto& field) { return lipschitz_bound(field, cube_of(2), 300).curvature; };
  // With u = 2^-53, some 30 operations move the ends of numbers up to 12 by 4u each (rounding.hpp).
  const auto is_near = [](double x, double right) { return std::abs(x - right) <= 30 * 12 * 4 * 0x1p-53; };
  CHECK(is_near(curvature([](const auto& p) { return length(p) - 1.0; }).lower, 0));
  CHECK(is_near(curvature([](const auto& p) { return max(p.x, abs(p.y)); }).lower, 0));
  // At (1, 0, 0) the length of (x², 1) has the unit vector (1, 1)/√2, |J|² = 4, and curves along x by
  // 2/√2 to |J|²/√2 more, and not along y.
  const auto curved = [](const auto& p) { return length(Vec2{square(p.x), p.x * 0.0 + 1.0}); };
  const auto there = lipschitz_bound(curved, {{1, 0, 0}, {1, 0, 0}}, 1).curvature;
  CHECK(is_near(there.lower, 0));
  CHECK(is_near(there.upper, 3 * std::sqrt(2)));
  CHECK(curvature([](const auto& p) { return min(p.x, p.y); }).lower == -infinity);
  CHECK(is_near(curvature([](const auto& p) { return min(p.x, p.y); }).upper, 0));
  CHECK(is_near(curvature([](const auto& p) { return min(square(p.x), square(p.x) + 1.0); }).upper, 2));
  CHECK(is_near(curvature([](const auto& p) { return sin(p.x) * 3.0; }).lower, -3));
  CHECK(curvature([](const auto& p) { return fold(p.x); }).lower == -infinity);
  CHECK(curvature([](const auto& p) { return abs(wrap(p.x)); }).lower == -infinity);
  // ½ w a'' is 0, and (a' − b')² / 2w is 2/w along x.
  CHECK(is_near(curvature([](const auto& p) { return smooth_min(p.x, -p.x, 0.5); }).lower, -4));
}

TEST_CASE("plain values are off by no more than the bound of their error, which is not much larger") {
  for_each_sample_field([](const char* name, const auto& field, double size) {
    INFO(name);
    Random random(42);
    WrongCases wrong(random);
    const FieldBound bound = lipschitz_bound(field, cube_of(size), 100);
    double most = 0;
    for (int i = 0; i < cases(400, 100000); ++i) {
      const Point p = random.point(size);
      const double off = static_cast<double>(abs(TrueNumber(plain_value(field, p)) - true_at(field, p)));
      wrong.add(!(off <= bound.error), p, off, bound.error);
      most = std::max(most, off);
    }
    CHECK(wrong == 0);
    CHECK(bound.error < 200 * most);
    CHECK(bound.error <= 100 * 8 * 0x1p-53);  // some 100 operations with numbers up to 8
  });
}

TEST_CASE("the Lipschitz constant of a distance, derived by one evaluation, is 1") {
  int distances = 0;
  for_each_sample_field([&](const std::string& name, const auto& field, double size) {
    if (name == "gyroid" || name == "twist" || name == "horn" || name == "growth") return;
    INFO(name);
    const FieldBound bound = lipschitz_bound(field, cube_of(size), 1);
    CHECK(bound.lipschitz >= 1);
    CHECK(bound.lipschitz <= 1 + 0x1p-40);
    ++distances;
  });
  CHECK(distances == 7);
}

TEST_CASE("the Lipschitz constant of a gyroid falls as its box is divided") {
  for_each_sample_field([&](const std::string& name, const auto& field, double size) {
    if (name != "gyroid") return;
    double before = infinity;
    for (const int evaluations : {1, 1000, 10000}) {
      const double constant = lipschitz_bound(field, cube_of(size), evaluations).lipschitz;
      CHECK(constant >= 10.275);  // the steepest slope that has been seen
      CHECK(constant < before);
      before = constant;
    }
    CHECK(lipschitz_bound(field, cube_of(size), 1).lipschitz <= 20.8);
    CHECK(before < 17);
  });
}

TEST_CASE("components that grow in one direction have a longer length") {
  const auto diagonal = [](const auto& p) { return length(Vec2{p.x, p.x}); };
  const auto thrice = [](const auto& p) { return signed_length(FieldPoint{p.x, p.x, p.x}); };
  CHECK(lipschitz_bound(diagonal, cube_of(1), 1).lipschitz >= std::sqrt(2.0));
  CHECK(lipschitz_bound(diagonal, cube_of(1), 1).lipschitz <= std::sqrt(2.0) * (1 + 0x1p-40));
  CHECK(lipschitz_bound(thrice, cube_of(1), 1).lipschitz >= std::sqrt(3.0));
  CHECK(lipschitz_bound(thrice, cube_of(1), 1).lipschitz <= std::sqrt(3.0) * (1 + 0x1p-40));
}

TEST_CASE("a box need not be a cube, and may be a point or infinite") {
  const auto bent = [](const auto& p) { return square(p.x) + p.y; };
  CHECK(lipschitz_bound(bent, {{-3, 0, 0}, {1, 1, 1}}, 1).lipschitz >= std::sqrt(37.0));
  CHECK(lipschitz_bound(bent, {{-3, 0, 0}, {1, 1, 1}}, 1).lipschitz <= std::sqrt(37.0) * (1 + 0x1p-40));
  CHECK(lipschitz_bound(bent, {{1, 0, 0}, {1, 1, 1}}, 100).lipschitz <= std::sqrt(5.0) * (1 + 0x1p-40));
  const auto sphere = [](const auto& p) { return length(p) - 1.0; };
  const FieldBound everywhere = lipschitz_bound(sphere, {Point{-infinity}, Point{infinity}}, 100);
  CHECK(everywhere.lipschitz <= 1 + 0x1p-40);
  CHECK(everywhere.error == infinity);
  CHECK(lipschitz_bound(bent, {Point{-infinity}, Point{infinity}}, 100).lipschitz == infinity);
  // Nothing is known of 1/x where x may be 0, and of a root's slope there.
  const auto pole = [](const auto& p) { return 1.0 / p.x; };
  CHECK(lipschitz_bound(pole, cube_of(1), 100).lipschitz == infinity);
  CHECK(lipschitz_bound(pole, cube_of(1), 100).error == infinity);
  const auto root = [](const auto& p) { return sqrt(p.x); };
  CHECK(lipschitz_bound(root, cube_of(1), 1).lipschitz == infinity);
  CHECK(lipschitz_bound(root, cube_of(1), 1).error < 0x1p-52);
}

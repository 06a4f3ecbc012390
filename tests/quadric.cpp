#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <vector>

#include "stress/exact.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

Quadric whole_quadric(Random& random, std::int64_t size) {
  const Vec3 squares = random.whole_vector(size), products = random.whole_vector(size),
             linear = random.whole_vector(size);
  return {{squares, products, linear, static_cast<double>(random.whole(size))}};
}

__extension__ using Int128 = __int128;

/// Returns (p, p3)ᵀ M (q, q3) for the form's 4 × 4 matrix M, exactly; all numbers must be whole.
Int128 value(const QuadricForm& form, const Vec3& p, double p3, const Vec3& q, double q3) {
  const double matrix[4][4] = {{form.squares.x, form.products.z, form.products.y, form.linear.x},
                               {form.products.z, form.squares.y, form.products.x, form.linear.y},
                               {form.products.y, form.products.x, form.squares.z, form.linear.z},
                               {form.linear.x, form.linear.y, form.linear.z, form.constant}};
  const double left[4] = {p.x, p.y, p.z, p3}, right[4] = {q.x, q.y, q.z, q3};
  Int128 sum = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      sum += static_cast<Int128>(left[i]) * static_cast<Int128>(matrix[i][j]) * static_cast<Int128>(right[j]);
  return sum;
}

/// Equation A t² − 2bt + c = 0 of a line and a quadric in whole numbers, with A ≥ 0.
struct Equation {
  Int128 A, b, c, D;

  Equation(const Ray& ray, const QuadricForm& form)
      : A(value(form, ray.direction, 0, ray.direction, 0)),
        b(-value(form, ray.direction, 0, ray.origin, 1)),
        c(value(form, ray.origin, 1, ray.origin, 1)),
        D(b * b - A * c) {
    if (A < 0) A = -A, b = -b, c = -c;
  }
  [[nodiscard]] int count() const { return A == 0 ? b != 0 : D < 0 ? 0 : 2; }
  [[nodiscard]] long double root(int i) const {
    const auto number = [](Int128 x) { return static_cast<long double>(x); };
    if (A == 0) return number(c) / number(2 * b);
    const long double root = std::sqrt(number(D)), q = number(b) + (b < 0 ? -root : root);
    const long double one = q == 0 ? 0 : number(c) / q, other = q / number(A);
    return i == 0 ? std::min(one, other) : std::max(one, other);
  }
  /// Returns the number of roots below 1, from the value and the slope of the equation at t = 1.
  [[nodiscard]] int count_below_1() const {
    const Int128 at_1 = A - 2 * b + c;
    if (A == 0) return b != 0 && (b > 0 ? at_1 < 0 : at_1 > 0);
    if (D < 0) return 0;
    if (at_1 < 0) return 1;
    if (at_1 > 0) return b > A ? 0 : 2;
    return c < A ? 1 : 0;  // the roots are 1 and c/A
  }
};

std::vector<double> crossings(const Quadric& quadric, const Ray& ray, Interval range = everywhere) {
  std::vector<double> all;
  each_crossing(quadric, ray, range, [&](const Crossing& crossing) { all.push_back(crossing.t); });
  return all;
}

/// Returns whether an answer about a quadric and a ray of whole numbers is wrong.
bool is_wrong(const Quadric& quadric, const Ray& ray) {
  const Equation e(ray, quadric.form);
  const auto found = crossings(quadric, ray);
  if (static_cast<int>(found.size()) != e.count()) return true;
  if (static_cast<int>(crossings(quadric, ray, {-infinity, 1}).size()) != e.count_below_1()) return true;
  for (int i = 0; i < e.count(); ++i) {
    const long double t = found[static_cast<std::size_t>(i)], truth = e.root(i);
    if (!(std::abs(t - truth) <= 0x1p-30L * std::abs(truth))) return true;
  }
  return false;
}

const Quadric cylinder{{.squares = {1, 0, 1}}};                                        // x² + z² = 1
const Quadric cone{{.squares = {1, -1, 1}, .constant = 0}};                            // x² + z² = y²
const Quadric bowl{{.squares = {1, 0, 1}, .linear = {0, -0.5, 0}, .constant = 0}};     // y = x² + z²
const Quadric saddle{{.squares = {1, -1, 0}, .linear = {0, 0, -0.5}, .constant = 0}};  // z = x² − y²
const Quadric hyperboloid{{.squares = {1, -1, 1}}};                                    // x² + z² = 1 + y²
const Quadric planes{{.squares = {0, 0, 1}, .constant = -4}};                          // z = ±2
const Quadric flat_quadric{{.squares = {0, 0, 0}, .linear = {0, 0, 1}, .constant = -6}};   // z = 3
const Quadric ellipsoid{{.squares = {4, 1, 1}, .linear = {0, 0, -3}, .constant = 9 - 4}};  // around (0, 0, 3)

}  // namespace

TEST_CASE("a quadric is hit where its form is 0") {
  struct {
    const char* what;
    Quadric quadric;
    Ray ray;
    std::vector<double> expected;
  } const rows[] = {
      {"the unit sphere", {}, {{0, 0, -3}, {0, 0, 1}}, {2, 4}},
      {"touched", {}, {{1, 0, -3}, {0, 0, 1}}, {3, 3}},
      {"missed", {}, {{1 + ulp, 0, -3}, {0, 0, 1}}, {}},
      {"its negative is the same", {{Vec3{-1}, {}, {}, 1}}, {{0, 0, -3}, {0, 0, 1}}, {2, 4}},
      {"an ellipsoid along its short axis", ellipsoid, {{-3, 0, 3}, {1, 0, 0}}, {2, 4}},
      {"an ellipsoid along a long one", ellipsoid, {{0, 0, 0}, {0, 0, 1}}, {1, 5}},
      {"from inside", ellipsoid, {{0, 0, 3}, {0, 0.5, 0}}, {-4, 4}},
      {"a cylinder across", cylinder, {{-3, 7, 0}, {1, 1, 0}}, {2, 4}},
      {"a cylinder along", cylinder, {{0.5, 0, 0}, {0, 1, 0}}, {}},
      {"a cylinder along, in it", cylinder, {{1, 0, 0}, {0, 1, 0}}, {}},
      {"a cone across both halves", cone, {{2, -9, 0}, {0, 1, 0}}, {7, 11}},
      {"a cone across one", cone, {{-9, 2, 0}, {1, 0, 0}}, {7, 11}},
      {"a cone at its apex", cone, {{0, 0, -3}, {0, 0, 1}}, {3, 3}},
      {"a cone along a side", cone, {{1, 0, 0}, {1, 1, 0}}, {-0.5}},
      {"a cone in a side", cone, {{1, 1, 0}, {1, 1, 0}}, {}},
      {"a bowl along its axis", bowl, {{1, -3, 2}, {0, 2, 0}}, {4}},
      {"a bowl across", bowl, {{-3, 4, 0}, {1, 0, 0}}, {1, 5}},
      {"a saddle along its axis", saddle, {{2, 1, 0}, {0, 0, 1}}, {3}},
      {"a saddle along one of its lines", saddle, {{1, 0, 0}, {1, 1, 0}}, {-0.5}},
      {"a saddle in one of its lines", saddle, {{1, 1, 0}, {1, 1, 0}}, {}},
      {"a hyperboloid across", hyperboloid, {{-3, 0, 0}, {1, 0, 0}}, {2, 4}},
      {"a hyperboloid in one of its lines", hyperboloid, {{1, 0, 0}, {0, 1, 1}}, {}},
      {"two planes", planes, {{0, 0, 0}, {1, 1, 1}}, {-2, 2}},
      {"two planes, along", planes, {{0, 0, 0}, {1, 1, 0}}, {}},
      {"one plane", flat_quadric, {{0, 0, 0}, {1, 1, 1}}, {3}},
      {"one plane, along", flat_quadric, {{0, 0, 0}, {1, 1, 0}}, {}},
      {"one plane, in it", flat_quadric, {{0, 0, 3}, {1, 1, 0}}, {}},
      {"nothing", {{Vec3{0}, Vec3{0}, Vec3{0}, 1}}, {{0, 0, 0}, {0, 0, 1}}, {}},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK(crossings(row.quadric, row.ray) == row.expected);
  }
}

TEST_CASE("hits of a quadric by a ray, both of whole numbers, are exact also before t = 1") {
  Random random(51);
  int touching = 0, linear = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Quadric quadric = whole_quadric(random, 2);
    const Ray ray{random.whole_vector(2), random.whole_vector(2)};
    if (ray.direction == Vec3{0}) continue;
    const Equation e(ray, quadric.form);
    touching += e.A != 0 && e.D == 0;
    linear += e.A == 0;
    wrong.add(is_wrong(quadric, ray), quadric, ray);
  }
  CHECK(touching > 200);
  CHECK(linear > 500);
  CHECK(wrong == 0);
}

TEST_CASE("hits and misses of a quadric that are too close for double are decided exactly") {
  Random random(52);
  int hits = 0, misses = 0, in_doubt = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000 && hits + misses < 3000; ++i) {
    Quadric quadric = whole_quadric(random, 2);
    const Ray ray{random.whole_vector(1 << 24), random.whole_vector(2)};
    // Constant that brings D closest to 0, or one next to it.
    Equation e(ray, quadric.form);
    if (e.A == 0 || ray.direction == Vec3{0}) continue;
    const Int128 sign = value(quadric.form, ray.direction, 0, ray.direction, 0) < 0 ? -1 : 1;
    quadric.form.constant += static_cast<double>(sign * (e.b * e.b / e.A - e.c) + random.whole(1));
    if (std::abs(quadric.form.constant) > 0x1p53) continue;
    ++(Equation(ray, quadric.form).D < 0 ? misses : hits);
    fallbacks = {};
    wrong.add(is_wrong(quadric, ray), quadric, ray);
    in_doubt += fallbacks.exact > 0;
  }
  CHECK(hits > 1000);
  CHECK(misses > 500);
  CHECK(in_doubt > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("a quadric that is a sphere is hit where the sphere is, with its normal, u and v") {
  Random random(53);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Point center = random.whole_vector(i % 2 ? 9 : 999);
    const double radius = static_cast<double>(1 + random.bits() % 9);
    const Sphere sphere{center, radius};
    const Quadric quadric{{.linear = -center, .constant = dot(center, center) - radius * radius}};
    const Ray ray{center + random.point(15), std::exp(random.real(-2, 2)) * random.direction()};
    const auto expected = sphere.intersect(ray), found = quadric.intersect(ray);
    wrong.add(expected.has_value() != found.has_value(), sphere, quadric, ray);
    if (!expected || !found) continue;
    ++hits;
    wrong.add(!(std::abs(*expected - *found) <= 0x1p-29 * *expected), sphere, quadric, ray);
    const Point p = ray.at(*expected);
    // The gradient is p − center, as the sphere's vector is, which is rounded twice before normalize.
    wrong.add(!(length(quadric.normal_at(p) - normalize(sphere.normal_at(p))) <= 11.001 * 0x1p-53), sphere,
              quadric, ray, p);
    wrong.add(quadric.uv_at(p) != sphere.uv_at(p), sphere, quadric, ray, p);
  }
  CHECK(hits > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("a hit lies on the quadric, and the normal there is a unit vector pointing outwards") {
  Random random(54);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Quadric quadric{{random.point(1), random.point(1), random.point(1), random.real(-1, 1)}};
    const Ray ray{random.point(3), std::exp(random.real(-3, 3)) * random.direction()};
    const auto t = quadric.intersect(ray);
    if (!t || *t * length(ray.direction) > 20) continue;
    ++hits;
    const auto f = [&](const Point& p) {
      return dot(p, quadric.form.times(p)) + 2 * dot(quadric.form.linear, p) + quadric.form.constant;
    };
    const Point p = ray.at(*t);
    const Vec3 n = quadric.normal_at(p), gradient = 2.0 * (quadric.form.times(p) + quadric.form.linear);
    // The point is off by 2^-30 of the way to it, and with u = 2^-53 by u of the way and of itself; the terms
    // of f are off by up to 8u.
    const double size = 3 * dot(p, p) + 4 * length(p) + 1, way = *t * length(ray.direction);
    const double most = length(gradient) * (0x1p-30 * way + 0x1p-53 * (way + length(p))) + 8 * 0x1p-53 * size;
    wrong.add(!(std::abs(f(p)) <= most), quadric, ray, p, size);
    wrong.add(!(std::abs(length(n) - 1) <= 7.001 * 0x1p-53), quadric, ray, n);  // 4.5u and 2.5u
    // The slope of f is the gradient's length along it, and changes by less than 2^-10 of itself.
    const double off = 0x1p-13 * length(gradient);
    if (off * length(gradient) > 2 * most)
      wrong.add(!(f(p + off * n) > 0 && f(p - off * n) < 0), quadric, ray, p, n, off);
  }
  CHECK(hits > 5000);
  CHECK(wrong == 0);
  CHECK(cone.normal_at(Point{0}) == Vec3{0, 0, 1});
  // With u = 2^-53, both are off by 4.5u for normalize (camera.cpp); below, products of the gradient by 2u,
  // and the length of {0, 0.6, 0.8} by u.
  CHECK(length(cone.normal_at({3, 3, 0}) - normalize(Vec3{1, -1, 0})) <= 9.001 * 0x1p-53);
  const Quadric tiny{{Vec3{1e-300}, {}, {}, -1e-300}}, huge{{Vec3{1e300}, {}, {}, -1e300}};
  CHECK(length(tiny.normal_at({0, 0.6, 0.8}) - Vec3{0, 0.6, 0.8}) <= 7.501 * 0x1p-53);
  CHECK(length(huge.normal_at({0, 0.6, 0.8}) - Vec3{0, 0.6, 0.8}) <= 7.501 * 0x1p-53);
}

TEST_CASE("a ray that leaves a quadric crosses it once more, exactly at the other root") {
  Random random(55);
  int again = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    Quadric quadric = whole_quadric(random, 3);
    Ray ray{random.whole_vector(4), random.whole_vector(4)};
    if (ray.direction == Vec3{0}) continue;
    // The origin is on the quadric, in every second round up to one unit in the last place of the constant.
    quadric.form.constant -= static_cast<double>(value(quadric.form, ray.origin, 1, ray.origin, 1));
    const Equation e(ray, quadric.form);
    if (i % 2) quadric.form.constant = std::nextafter(quadric.form.constant, 0);
    ray.departure = quadric.departure();
    const auto found = crossings(quadric, ray);
    wrong.add(found.size() != (e.A == 0 ? 0 : 1), quadric, ray);
    if (e.A == 0 || found.size() != 1) continue;
    wrong.add(found[0] != static_cast<double>(2 * e.b) / static_cast<double>(e.A), quadric, ray);
    again += found[0] > 0;
    wrong.add(crossings(quadric, ray, {0, 1}).size() != (0 < e.b && 2 * e.b < e.A), quadric, ray);
    // An equal quadric at another address counts as a different surface, so the departure does not matter.
    const Quadric other = quadric;
    wrong.add(crossings(other, {ray.origin, ray.direction}).size() != crossings(other, ray).size(), quadric,
              other, ray);
  }
  CHECK(again > 5000);
  CHECK(wrong == 0);

  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Quadric round{
        {{random.real(0.5, 2), 1, random.real(0.5, 2)}, random.point(0.25), random.point(1), -4}};
    const Ray ray{random.point(5), random.direction()};
    const auto t = round.intersect(ray);
    if (!t) continue;
    ++hits;
    const Ray left{ray.at(*t), random.direction(), round.departure()};
    const bool is_inwards = dot(left.direction, round.normal_at(left.origin)) < 0;
    wrong.add(crossings(round, left, {}).size() != is_inwards, round, ray, left);
  }
  CHECK(hits > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("ends_inside is exact for a quadric, and consistent with its crossings") {
  Random random(56);
  int inside = 0, along = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Quadric quadric = whole_quadric(random, 2);
    const Ray ray{random.whole_vector(2), random.whole_vector(2)};
    if (ray.direction == Vec3{0}) continue;
    const Int128 A = value(quadric.form, ray.direction, 0, ray.direction, 0),
                 b = -value(quadric.form, ray.direction, 0, ray.origin, 1),
                 c = value(quadric.form, ray.origin, 1, ray.origin, 1);
    const bool expected = A != 0 ? A < 0 : b != 0 ? b > 0 : c < 0;
    wrong.add(quadric.ends_inside(ray) != expected, quadric, ray);
    inside += expected;
    along += A == 0 && b == 0;
    // Each crossing ahead takes the ray from one side to the other.
    if (c != 0)
      wrong.add((crossings(quadric, ray, {}).size() % 2 != 0) != ((c < 0) != expected), quadric, ray);
    Ray left = ray;
    left.departure = quadric.departure();
    wrong.add(quadric.ends_inside(left) != (A != 0 ? A < 0 : b > 0), quadric, ray, left);
  }
  CHECK(inside > 5000);
  CHECK(along > 100);
  CHECK(wrong == 0);
  CHECK_FALSE(Quadric{}.ends_inside({{0, 0, 0}, {0, 0, 1}}));
  CHECK(Quadric{{Vec3{-1}, {}, {}, 1}}.ends_inside({{0, 0, 0}, {0, 0, 1}}));
  CHECK(cone.ends_inside({{9, 0, 0}, {1, 1 + ulp, 0}}));
  CHECK_FALSE(cone.ends_inside({{0, 9, 0}, {1, 1 - ulp, 0}}));
  CHECK(cylinder.ends_inside({{0.5, 0, 0}, {0, 1, 0}}));
  CHECK_FALSE(cylinder.ends_inside({{1, 0, 0}, {0, 1, 0}}));
  CHECK_FALSE(cylinder.ends_inside({{0.5, 0, 0}, {1e-300, 1, 0}}));
  CHECK_FALSE(cylinder.ends_inside({{0.5, 0, 0}, {0, 0, 0}}));
  CHECK_FALSE(cylinder.ends_inside({{0.5, 0, 0}, {0, not_a_number, 0}}));
}

TEST_CASE("huge and tiny quadrics are hit like others, and those that are not finite are not hit") {
  for (const double size : {0x1p-400, 0x1p-200, 0x1p-30, 1.0, 0x1p30, 0x1p200, 0x1p400})
    for (const double factor : {0x1p-200, 1.0, 0x1p200})
      for (const double far : {0x1p-60, 1.0, 0x1p60}) {
        CAPTURE(size, factor, far);
        const Quadric sphere{{Vec3{factor}, {}, {}, -factor * size * size}};
        CHECK(crossings(sphere, {{size, 0, -3 * size}, {0, 0, far}}) ==
              std::vector<double>{3 * size / far, 3 * size / far});
        CHECK(crossings(sphere, {{0, 0, -3 * size}, {0, 0, far}}) ==
              std::vector<double>{2 * size / far, 4 * size / far});
        CHECK(crossings(sphere, {{size * (1 + ulp), 0, -3 * size}, {0, 0, far}}).empty());
        const Quadric floor{{Vec3{0}, {}, {0, factor, 0}, -2 * factor * size}};
        CHECK(crossings(floor, {{0, 3 * size, 0}, {0, far, far}}) == std::vector<double>{-2 * size / far});
      }
  const Quadric sound = ellipsoid;
  const Ray ray;
  REQUIRE(sound.intersect(ray));
  CHECK(crossings(sound, {{0, 0, 0}, {0, 0, 0}}).empty());
  for (const double bad : {infinity, -infinity, not_a_number}) {
    Quadric constant = sound;
    constant.form.constant = bad;
    CHECK(crossings(constant, ray).empty());
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(bad, axis);
      Ray origin = ray, direction = ray;
      origin.origin[axis] = bad, direction.direction[axis] = bad;
      CHECK(crossings(sound, origin).empty());
      CHECK(crossings(sound, direction).empty());
      Quadric squares = sound, products = sound, linear = sound;
      squares.form.squares[axis] = bad, products.form.products[axis] = bad, linear.form.linear[axis] = bad;
      CHECK(crossings(squares, ray).empty());
      CHECK(crossings(products, ray).empty());
      CHECK(crossings(linear, ray).empty());
    }
  }
}

namespace {

/// Returns an ellipsoid with the given center and half axes h, randomly rotated: M is the sum of r rᵀ / h²
/// for the columns r of a rotation.
Quadric turned_ellipsoid(Random& random, const Point& center, const Vec3& half_axes) {
  const Vec3 r0 = random.direction(), r1 = normalize(cross(r0, random.direction()));
  const Vec3 axes[] = {r0, r1, cross(r0, r1)};
  QuadricForm form{.squares = Vec3{0}, .constant = -1};
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = axes[i] / half_axes[i];
    form.squares += a * a;
    form.products += Vec3{a.y * a.z, a.z * a.x, a.x * a.y};
  }
  form.linear = -form.times(center);
  form.constant = -dot(center, form.linear) - 1;
  return {form};
}

/// Ratio of the distances from the center to the ends of the box and of the ellipsoid along an axis, in both
/// directions, computed from the minors of the matrix; negative if the box ends on the wrong side of the
/// center.
struct Excess {
  double below, above;

  Excess(const QuadricForm& form, const Bounds& bounds, int axis) {
    using exact::Number;
    const Number m[3][3] = {{form.squares.x, form.products.z, form.products.y},
                            {form.products.z, form.squares.y, form.products.x},
                            {form.products.y, form.products.x, form.squares.z}};
    const Number l[3] = {form.linear.x, form.linear.y, form.linear.z};
    const auto minor = [&](int i, int k) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
      return m[a][c] * m[b][d] - m[a][d] * m[b][c];
    };
    const Number determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    Number Nl[3], H = -(determinant * form.constant);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) Nl[i] = Nl[i] + minor(i, k) * l[k];
      H = H + l[i] * Nl[i];
    }
    const exact::Quad reach = (H * minor(axis, axis)).sqrt();
    below = static_cast<double>(exact::Quad(-(determinant * bounds.min[axis] + Nl[axis])) / reach);
    above = static_cast<double>(exact::Quad(determinant * bounds.max[axis] + Nl[axis]) / reach);
  }
};

/// Returns the number of faces of a box beyond which a point of a ray lies, exactly.
int ends_passed(const Bounds& bounds, const Ray& ray, double t) {
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const exact::Number x = exact::Number(ray.origin[axis]) + exact::Number(t) * ray.direction[axis];
    count += (x - bounds.min[axis]).sign() < 0;
    count += (exact::Number(bounds.max[axis]) - x).sign() < 0;
  }
  return count;
}

}  // namespace

TEST_CASE("the bounds of an ellipsoid contain it, and are hardly larger") {
  const auto unit = Quadric{}.bounds();
  for (int axis = 0; axis < 3; ++axis) {
    CHECK((-1.002 < unit.min[axis] && unit.min[axis] < -1));
    CHECK((1 < unit.max[axis] && unit.max[axis] < 1.002));
  }
  Random random(57);
  double least = 2, most = 0;
  int crossed = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 4000; ++i) {
    const double size = std::exp2(random.real(-20, 20)),
                 far = i % 2 ? 0 : size * std::exp2(random.real(0, 16));
    const Vec3 half_axes{size, size * std::exp2(random.real(-6, 0)), size * std::exp2(random.real(-6, 0))};
    const Point center = random.point(far);
    const Quadric quadric = turned_ellipsoid(random, center, half_axes);
    const Bounds bounds = quadric.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      const Excess excess(quadric.form, bounds, axis);
      least = std::min({least, excess.below, excess.above});
      most = std::max({most, excess.below, excess.above});
    }
    const Ray ray{center + 4 * size * random.direction(), random.direction()};
    const Ray aimed{ray.origin, center + random.point(0.5 * size) - ray.origin};
    each_crossing(quadric, aimed, everywhere, [&](const Crossing& crossing) {
      ++crossed;
      wrong.add(ends_passed(bounds, aimed, crossing.t) > 0, quadric, ray, aimed);
    });
  }
  CHECK(least > 1 + 0x1p-11);
  CHECK(most < 1 + 0x1p-9);
  CHECK(crossed > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("quadrics other than ellipsoids have no bounds, and neither have inverted ellipsoids") {
  const auto is_everywhere = [](const Quadric& quadric) {
    const Bounds bounds = quadric.bounds();
    return bounds.min == Point{-infinity} && bounds.max == Point{infinity};
  };
  for (const Quadric& quadric : {cylinder, cone, bowl, saddle, hyperboloid, planes, flat_quadric})
    CHECK(is_everywhere(quadric));
  CHECK(is_everywhere({{Vec3{-1}, {}, {}, 1}}));
  CHECK(is_everywhere({{.squares = {1, 1, 0}, .linear = {1, 2, 3}}}));
  CHECK(is_everywhere({{.squares = Vec3{2}, .products = {2, 0, 0}}}));  // unbounded along y = −z
  CHECK(is_everywhere({{.squares = Vec3{2}, .products = {2 + ulp, 0, 0}}}));
  CHECK_FALSE(is_everywhere({{.squares = Vec3{2}, .products = {2 - 2 * ulp, 0, 0}}}));
  CHECK(is_everywhere({{.squares = Vec3{1}, .products = {-1, -1, -1}}}));
  CHECK(is_everywhere({{.squares = Vec3{4}, .products = {-2, -2, -2}}}));  // the determinant is 0
  CHECK_FALSE(is_everywhere({{.squares = {1, 1, 0x1p-90}}}));
  CHECK_FALSE(is_everywhere({{.squares = {1, 1, 0x1p-200}}}));
  for (const double bad : {infinity, -infinity, not_a_number}) {
    CHECK(is_everywhere({{.squares = {1, bad, 1}}}));
    CHECK(is_everywhere({{.constant = bad}}));
  }
  // Quadrics that are a point, or empty.
  constexpr double least = 0x1p-1074;  // the doubles next to the point are the bounds
  CHECK(Quadric{{.linear = {-3, 0, 0}, .constant = 9}}.bounds().min ==
        Point{std::nextafter(3, 0), -least, -least});
  CHECK(Quadric{{.constant = 1}}.bounds().max == Point{least});
  for (const double size : {0x1p-400, 0x1p-200, 1.0, 0x1p200, 0x1p400})
    for (const double factor : {0x1p-200, 1.0, 0x1p200}) {
      const Bounds bounds = Quadric{{Vec3{factor}, {}, {}, -factor * size * size}}.bounds();
      CHECK(bounds.max.y > size);
      CHECK(bounds.max.y < 1.002 * size);
      CHECK(bounds.min.z == -bounds.max.z);
    }
}

TEST_CASE("crossings of a ray that leaves an ellipsoid lie in its bounds, wherever the ray begins") {
  Random random(58);
  int again = 0, none = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Point center = random.point(3);
    const Quadric quadric = turned_ellipsoid(random, center, {1, random.real(0.1, 1), random.real(0.1, 1)});
    const Ray ray{center + 4.0 * random.direction(), random.direction()};
    const Ray aimed{ray.origin, center + random.point(0.3) - ray.origin};
    const auto t = quadric.intersect(aimed);
    if (!t) continue;
    const Point hit = aimed.at(*t);
    const Vec3 n = quadric.normal_at(hit);
    // The ray begins at the hit or well off the ellipsoid, in any direction inwards or in one nearly tangent.
    const double off = i % 2 == 0 ? 0 : std::exp2(random.real(-40, 2));
    Vec3 d =
        i % 3 == 0 ? random.direction() : cross(n, random.direction()) - std::exp2(random.real(-40, 0)) * n;
    if (dot(d, n) > 0) d = -d;
    const Ray left{hit + off * n, d, quadric.departure()};
    const auto found = crossings(quadric, left);
    wrong.add(found.size() > 1 || (off == 0 && found.size() != 1), quadric, ray, aimed, left, off);
    none += found.empty(), again += !found.empty();
    for (const double other : found)
      wrong.add(ends_passed(quadric.bounds(), left, other) > 0, quadric, ray, aimed, left, other);
  }
  CHECK(again > 4000);
  CHECK(none > 500);
  CHECK(wrong == 0);
}

TEST_CASE("pictures of ellipsoids in a BVH are the same ray by ray, accelerated and by tiles") {
  Random random(59);
  Scene<Quadric, AnySurface> scene;
  const Material glass{.diffuse = Color{0.25f}, .refract = 0.75, .ior = 1.5};
  for (int i = 0; i < 60; ++i) {
    const Point center = Point{0, 0, 4} + random.point(2.5);
    const Vec3 half_axes{random.real(0.1, 0.6), random.real(0.02, 0.6), random.real(0.1, 0.6)};
    const Quadric quadric = turned_ellipsoid(random, center, half_axes);
    const Material material = i % 4 == 0 ? glass : Material{.diffuse = random.color(), .reflect = 0.25};
    if (i % 3 == 0)
      scene.add(AnySurface(quadric), material);
    else
      scene.add(quadric, material);
  }
  // A hyperboloid behind the ellipsoids, which has no bounds: x² + (z − 12)² = 1 + y².
  scene.add(Quadric{{.squares = {1, -1, 1}, .linear = {0, 0, -12}, .constant = 143}}, Color{0.5f});
  scene.add(PointLight{.position = {3, 6, -6}, .power = Color{3000}});
  const DrawnAlike drawn = drawn_alike(scene, Camera{.position = {0, 0, -1}});
  CHECK(drawn.lit > 500);
  CHECK(drawn.different == 0);
}

TEST_CASE("pictures of quadrics are the same ray by ray, accelerated and by tiles, and show no acne") {
  const Camera camera{.position = {0, 1, -6}};
  const Point light{3, 6, -6};
  Scene<Quadric, AnySurface> scene;
  const Material squares{.texture = Checker{.size = 0.25}, .reflect = 0.25},
      glass{.diffuse = Color{0.25f}, .refract = 0.75, .ior = 1.5};
  scene.add(AnySurface(Plane{{0, 1, 0}, -1}), squares);
  scene.add(Quadric{{.squares = {4, 1, 4}, .linear = {8, 0, 0}, .constant = 15}}, squares);  // on the plane
  scene.add(Quadric{{.squares = {8, -1, 8}, .linear = {0, 0, -16}, .constant = 32}}, Color{0.5f});  // a cone
  scene.add(AnySurface(Quadric{{.linear = {-2, 0, 1}, .constant = 4}}), glass);
  scene.add(AnySurface(Quadric{{.squares = {1, 0, 1}, .linear = {-4, 0, -3}, .constant = 24.9}}), squares);
  scene.add(PointLight{.position = light, .power = Color{3000}});
  const DrawnAlike drawn = drawn_alike(scene, camera);
  CHECK(drawn.lit > 500);
  CHECK(drawn.different == 0);

  int lit = 0;
  WrongCases acne;
  for (int i = 0; i < 64 * 48; ++i) {
    const auto hit = scene.intersect(camera.through_pixel(i % 64, i / 64, 64, 48));
    if (!hit) continue;
    ++lit;
    const Ray to_light = hit->leave(light - hit->point());
    if (!(dot(hit->facing_normal(), to_light.direction) > 0)) continue;
    if (const auto shadow = scene.intersect(to_light, {0, 1}))
      acne.add(shadow->t < 0x1p-7, to_light);  // nothing else is so near
  }
  CHECK(lit > 1000);
  CHECK(acne == 0);
}

TEST_CASE("an invalid quadric is refused") {
  const auto says = [](const Quadric& quadric) {
    return message_of<std::invalid_argument>([&] { quadric.validate(); });
  };
  for (const double bad : {1e121, -1e121, infinity, -infinity, not_a_number}) {
    CHECK_THAT(says({{.constant = bad}}), ContainsSubstring("Quadric: the numbers of the form"));
    CHECK_THAT(says({{.squares = {1, bad, 1}}}), ContainsSubstring("Quadric: the numbers of the form"));
    CHECK_THAT(says({{.products = {1, bad, 1}}}), ContainsSubstring("Quadric: the numbers of the form"));
    CHECK_THAT(says({{.linear = {1, bad, 1}}}), ContainsSubstring("Quadric: the numbers of the form"));
  }
  CHECK_THAT(says({{.squares = Vec3{0}}}), ContainsSubstring("Quadric: the form must not be constant"));
  CHECK_NOTHROW(flat_quadric.validate());
  CHECK_NOTHROW(Quadric{}.validate());
}

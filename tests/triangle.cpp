#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <stdexcept>
#include <vector>

#include "stress/exact.hpp"
#include "stress/oracle/equations.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

// ---- Reference: whole numbers, and an origin that is actually moved.

__extension__ using Int128 = __int128;
using WholeVector = std::array<Int128, 3>;

WholeVector operator-(const WholeVector& a, const WholeVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Int128 determinant(const WholeVector& a, const WholeVector& b, const WholeVector& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Returns coordinates of at most 9 in units of 10^-9.
WholeVector in_units(const Vec3& v) {
  const auto units = [](double x) { return static_cast<Int128>(x) * 1000000000; };
  return {units(v.x), units(v.y), units(v.z)};
}

/// Returns true if the line crosses the triangle with its origin moved by (10^-3, 10^-6, 10^-9): sides are
/// whole numbers, and change by less than 1.
bool is_crossed(const Triangle& s, const Ray& ray) {
  WholeVector o = in_units(ray.origin);
  o[0] += 1000000, o[1] += 1000, o[2] += 1;
  const WholeVector d = in_units(ray.direction), a = in_units(s.a) - o, b = in_units(s.b) - o,
                    c = in_units(s.c) - o;
  const Int128 ab = determinant(d, a, b), bc = determinant(d, b, c), ca = determinant(d, c, a);
  return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

/// Returns true if the line crosses the triangle by the equation of stress_numerics, for any numbers.
bool is_exactly_crossed(const Triangle& s, const Ray& ray) {
  return exact::TriangleEquation<exact::Number>(ray, s).is_crossed().value();
}

Vec3 exact_normal(const Triangle& s) { return cross(s.b - s.a, s.c - s.a); }

}  // namespace

TEST_CASE(
    "an edge in the opposite direction is passed on the opposite side, whatever the sizes of numbers are") {
  Random random(5);
  const auto number = [&] {
    return std::ldexp(random.real(-1, 1), static_cast<int>(random.real(-1070, 1020)));
  };
  const auto vector = [&] {
    const double x = number(), y = number(), z = number();
    return Vec3{x, y, z};
  };
  int parallel = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Point origin = vector(), p = vector();
    const Vec3 direction = vector();
    Point q = p;
    if (i % 2 == 0)
      q[i / 2 % 3] = number();
    else
      q = vector();
    const auto line = exact_line(origin, direction);
    const int side = detail::side_of_edge(line, p, q);
    wrong.add(detail::side_of_edge(line, q, p) != -side, origin, direction, q);
    parallel += side == 0;
  }
  CHECK(wrong == 0);
  CHECK(parallel < 5000);
}

TEST_CASE("a triangle is hit if a ray passes all its edges on one side") {
  const Triangle right{{1, 1, 3}, {3, 1, 3}, {1, 3, 3}};
  const Triangle oblique{{0, 0, 2}, {4, 0, 2}, {2, 3, 4}};
  const auto along_z = [](double x, double y) { return Ray{{x, y, 0}, {0, 0, 1}}; };
  struct {
    const char* what;
    Triangle surface;
    Ray ray;
    Interval range;
    std::optional<double> expected;
  } const rows[] = {
      {"through the middle", right, along_z(1.5, 1.5), {}, 3},
      {"t in halves", right, {{1.5, 1.5, 0}, {0, 0, 0.5}}, {}, 6},
      {"from behind", right, {{1.5, 1.5, 5}, {0, 0, -1}}, {}, 2},
      {"away from it", right, {{1.5, 1.5, 5}, {0, 0, 1}}, {}, std::nullopt},
      {"away from it, in a range that reaches back", right, {{1.5, 1.5, 5}, {0, 0, 1}}, everywhere, -2},
      {"at the end of the range", right, along_z(1.5, 1.5), {0, 3}, std::nullopt},
      {"behind the slanted edge", right, along_z(2.5, 2.5), {}, std::nullopt},
      {"on the other side", right, along_z(0.5, 1.5), {}, std::nullopt},
      {"below it", right, along_z(1.5, 0.5), {}, std::nullopt},
      {"just inside the edge a b", right, along_z(1.5, 1 + ulp), {}, 3},
      {"just outside the edge a b", right, along_z(1.5, 1 - ulp), {}, std::nullopt},
      {"just inside the edge c a", right, along_z(1 + ulp, 1.5), {}, 3},
      {"just outside the edge c a", right, along_z(1 - ulp, 1.5), {}, std::nullopt},
      {"just inside the edge b c", right, along_z(2 - ulp, 2), {}, 3},
      {"just outside the edge b c", right, along_z(2 + ulp, 2), {}, std::nullopt},
      {"the edge that is met a bit further inside", right, along_z(1, 1.5), {}, 3},
      {"the edge that is met a bit further outside", right, along_z(2, 2), {}, std::nullopt},
      {"parallel", right, {{2, 2, 0}, {1, 1, 0}}, everywhere, std::nullopt},
      {"in its plane", right, {{0, 1.5, 3}, {1, 0, 0}}, everywhere, std::nullopt},
      {"along an edge", right, {{0, 1, 3}, {1, 0, 0}}, everywhere, std::nullopt},
      {"all but parallel", {{1, 1, 0}, {3, 1, 0}, {1, 3, 0}}, {{0, 1.5, -0x1p-60}, {2, 0, 0x1p-60}}, {}, 1},
      {"starting on it", right, {{1.5, 1.5, 3}, {0, 0, 1}}, everywhere, 0},
      {"turned over", {{1, 1, 3}, {1, 3, 3}, {3, 1, 3}}, along_z(1.5, 1.5), {}, 3},
      {"oblique, inside", oblique, along_z(2, 1.5), {}, 3},
      {"oblique, in its box and outside", oblique, along_z(0.5, 1.5), {}, std::nullopt},
      {"no area", {{1, 1, 3}, {2, 2, 3}, {3, 3, 3}}, along_z(2, 2), everywhere, std::nullopt},
      {"an edge twice", {{1, 1, 3}, {3, 1, 3}, {1, 1, 3}}, along_z(2, 1), everywhere, std::nullopt},
      {"a point", {{1, 1, 3}, {1, 1, 3}, {1, 1, 3}}, along_z(1, 1), everywhere, std::nullopt},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK(row.surface.intersect(row.ray, row.range) == row.expected);
  }
}

TEST_CASE("hits of triangles are exact, and at the outline as for an infinitesimally moved origin") {
  Random random(31);
  int hits = 0, outline = 0;
  WrongCases misjudged(random), wrong(random);
  for (int i = 0; i < 100000; ++i) {
    const Triangle s{random.whole_vector(3), random.whole_vector(3), random.whole_vector(3)};
    const Ray ray{random.whole_vector(3), random.whole_vector(3)};
    const Vec3 a = s.a - ray.origin, b = s.b - ray.origin, c = s.c - ray.origin;
    const bool expected = is_crossed(s, ray);
    if (i % 16 == 0) misjudged.add(is_exactly_crossed(s, ray) != expected, s, ray);
    const auto t = s.intersect(ray, everywhere);
    hits += expected;
    outline += expected && (dot(ray.direction, cross(a, b)) == 0 || dot(ray.direction, cross(b, c)) == 0 ||
                            dot(ray.direction, cross(c, a)) == 0);
    wrong.add(t.has_value() != expected, s, ray);
    if (t && expected)
      wrong.add(*t != dot(exact_normal(s), a) / dot(exact_normal(s), ray.direction), s, ray, a);
  }
  CHECK(hits > 3000);
  CHECK(outline > 1000);
  CHECK(misjudged == 0);  // both references agree
  CHECK(wrong == 0);
}

TEST_CASE("hits of a triangle do not depend on the order of its vertices, and scale with powers of two") {
  Random random(32);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const Triangle s{random.whole_vector(4), random.whole_vector(4), random.whole_vector(4)};
    const Ray ray{random.whole_vector(4), random.whole_vector(4)};
    const auto t = s.intersect(ray, everywhere);
    hits += t.has_value();
    for (const Triangle& other : {Triangle{s.b, s.c, s.a}, Triangle{s.a, s.c, s.b}})
      wrong.add(other.intersect(ray, everywhere) != t, s, other, ray);
    for (const double size : {0x1p-900, 0x1p-300, 0x1p-30, 0x1p30, 0x1p300, 0x1p900}) {
      const Triangle scaled{size * s.a, size * s.b, size * s.c};
      const auto found = scaled.intersect({size * ray.origin, 0x1p-50 * ray.direction}, everywhere);
      wrong.add(found.has_value() != t.has_value() || (t && *found != std::ldexp(*t * size, 50)), s, size,
                ray);
    }
  }
  CHECK(hits > 200);
  CHECK(wrong == 0);
}

TEST_CASE("a ray to the shared edge of two triangles hits exactly one of them") {
  Random random(33);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::exp2(random.real(-10, 20));
    const Point at = size * random.point(100), p = at + size * random.point(1),
                q = at + size * random.point(1);
    const Vec3 side = size * random.point(1);
    const Triangle one{p, q, p + side}, other{p, p - side, q};  // the edge in both directions
    const Point origin = at + size * random.point(20);
    const Ray ray{origin, p + random.real(0.01, 0.99) * (q - p) - origin};
    // Both must face the ray with the same side, so that neither is in front of the other.
    const double seen = dot(ray.direction, exact_normal(one)) * dot(ray.direction, exact_normal(other));
    if (!(seen > 0)) continue;
    ++hits;
    wrong.add(one.intersect(ray).has_value() == other.intersect(ray).has_value(), one, ray);
  }
  CHECK(hits > 10000);
  CHECK(wrong == 0);
}

TEST_CASE("rays next to an edge or a vertex are decided exactly") {
  Random random(39);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 far = i % 3 == 0 ? random.point(1e4) : Vec3{0};
    const Triangle s{far + random.point(1), far + random.point(1), far + random.point(1)};
    const double along = i % 2 == 0 ? random.real(0, 1) : std::exp2(random.real(-50, 0));
    Point target = s.a + along * (s.b - s.a);
    for (int axis = 0; axis < 3; ++axis) target[axis] += 0x1p-53 * random.real(-4, 4);
    const Point origin = far + random.point(3);
    const Ray ray{origin, target - origin};
    const bool expected = is_exactly_crossed(s, ray);
    hits += expected;
    wrong.add(s.intersect(ray, everywhere).has_value() != expected, s, ray);
  }
  CHECK(hits > 7000);
  CHECK(hits < 13000);
  CHECK(wrong == 0);
}

TEST_CASE("t is accurate for triangles, however flat the ray, and however near its origin") {
  Random random(34);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Triangle s{random.point(2), random.point(2), random.point(2)};
    Ray ray{random.point(5), random.direction()};
    const Point middle = (s.a + s.b + s.c) / 3.0;
    const double off = std::exp2(random.real(-50, 0));
    if (i % 3 == 0) {  // nearly parallel, close to the plane
      ray.origin = middle + 3.0 * (s.b - s.a) + off * random.point(1);
      ray.direction = middle + off * random.point(1) - ray.origin;
    }
    if (i % 3 == 1) ray.origin = middle + off * random.point(0.1);  // steep, from close to the plane
    const auto t = s.intersect(ray, everywhere);
    if (!t) continue;
    ++hits;
    const ExactRoot exact = exact_root_of(s, ray, 0);
    const DoubleDouble root = refined(exact);
    wrong.add(!(std::abs((root - DoubleDouble(*t)).hi) <= Roots::relative_error * std::abs(root.hi)), s, ray);
    wrong.add(!roots_of(s, ray).count(), s, ray);
  }
  CHECK(hits > 200);
  CHECK(wrong == 0);
}

TEST_CASE("a triangle of numbers that are not finite is not hit") {
  const Triangle sound{{-1, -1, 3}, {1, -1, 3}, {0, 1, 3}};
  const Ray ray;
  REQUIRE(sound.intersect(ray));
  CHECK_FALSE(sound.intersect({{0, 0, 0}, {0, 0, 0}}, everywhere));
  for (const double bad : {infinity, -infinity, not_a_number})
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(bad, axis);
      Ray origin = ray, direction = ray;
      origin.origin[axis] = bad, direction.direction[axis] = bad;
      CHECK_FALSE(sound.intersect(origin, everywhere));
      CHECK_FALSE(sound.intersect(direction, everywhere));
      Triangle a = sound, b = sound, c = sound;
      a.a[axis] = bad, b.b[axis] = bad, c.c[axis] = bad;
      for (const Triangle& s : {a, b, c}) CHECK_FALSE(s.intersect(ray, everywhere));
    }
}

TEST_CASE("the normal of a triangle is the unit vector along (b − a) × (c − a), however thin it is") {
  for (const double size : {1e-300, 1e-9, 1.0, 1e9, 1e300}) {
    CAPTURE(size);
    const Triangle s{Point{0}, size * Vec3{2, -1, 0}, size * Vec3{3, 0, -1}};
    // With u = 2^-53, one number is rounded by u, normalize is off by 4.5u (camera.cpp), a quotient by a root
    // by 2u.
    CHECK(length(s.normal_at(s.a) - Vec3{1, 2, 3} / std::sqrt(14)) <= 7.501 * 0x1p-53);
  }
  const Triangle thin{Point{0}, {1, 1 + ulp, 0}, {1 - ulp, 1, 0.1}};
  CHECK(length(thin.normal_at(Point{0}) - normalize(Vec3{1 + ulp, -1, 10 * ulp * ulp})) <=
        9.001 * 0x1p-53);  // twice 4.5u

  // Far from the origin, and so thin that all digits of the differences cancel, or some are lost. Multiples
  // of 2^-40 in [1, 2) have products of 82 bits at most.
  Random random(35);
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const auto place = [&] { return Vec3{1.5} + 0x1p-40 * random.whole_vector(std::int64_t{1} << 39); };
    Triangle s{place(), place(), place()};
    if (i % 2 == 0) s.c = s.a + 0.5 * (s.b - s.a) + 0x1p-40 * random.whole_vector(2);
    const auto whole = [](const Vec3& v) {
      const auto number = [](double x) { return static_cast<Int128>(x * 0x1p41); };
      return WholeVector{number(v.x), number(v.y), number(v.z)};
    };
    const WholeVector u = whole(s.b) - whole(s.a), v = whole(s.c) - whole(s.a);
    const auto minor = [&](std::size_t j, std::size_t k) {
      return static_cast<double>(u[j] * v[k] - u[k] * v[j]);
    };
    const Vec3 n{minor(1, 2), minor(2, 0), minor(0, 1)};
    if (n == Vec3{0}) continue;
    // Both vectors are rounded by u before normalize; mostly to the same numbers.
    wrong.add(!(length(s.normal_at(s.a) - normalize(n)) <= 11.001 * 0x1p-53), thin, s, n);
  }
  CHECK(wrong == 0);
}

TEST_CASE("u and v of a triangle are barycentric: 1 and 0 at b, 0 and 1 at c") {
  const Triangle s{{1, 2, 3}, {1, 5, 7}, {3, 4, 4}};
  CHECK(s.uv_at(s.a) == Uv{0, 0});
  CHECK(s.uv_at(s.b) == Uv{1, 0});
  CHECK(s.uv_at(s.c) == Uv{0, 1});
  CHECK(s.uv_at(s.a + 0.5 * (s.b - s.a) + 0.25 * (s.c - s.a)) == Uv{0.5, 0.25});
  for (const double size : {1e-300, 1e-200, 1e200, 1e300}) {
    const Triangle other{Point{0}, {size, 0, 0}, {0, 0, size}};
    CHECK(other.uv_at({0.5 * size, 0, 0.25 * size}) == Uv{0.5, 0.25});
  }
}

TEST_CASE("the bounds of a triangle hold its points, and are tight") {
  const Bounds bounds = Triangle{{1, -2, 3}, {0, 5, 4}, {2, 1, -7}}.bounds();
  CHECK(bounds.min == Point{0, -2, -7});
  CHECK(bounds.max == Point{2, 5, 4});
}

TEST_CASE("a ray that leaves a triangle never hits it again") {
  Random random(36);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    Triangle s{random.point(2), random.point(5), random.point(5)};
    if (i % 4 == 0) s.a.y = s.b.y = s.c.y;
    const Point origin = random.point(5);
    const Ray ray{origin, s.a + 0.4 * (s.b - s.a) + 0.3 * (s.c - s.a) - origin};
    const auto t = s.intersect(ray);
    if (!t) continue;
    ++hits;
    wrong.add(s.intersect({ray.at(*t), random.direction(), s.departure()}, everywhere).has_value(), s, ray);
    wrong.add(s.intersect({ray.at(*t), s.b - ray.at(*t), s.departure()}, everywhere).has_value(), s, ray);
  }
  CHECK(hits > 15000);
  CHECK(wrong == 0);
}

TEST_CASE("triangles of one plane have equal departures, and so have the plane and a parallelogram in it") {
  Random random(37);
  int tilted = 0, inexact = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    // Points p + j u + k v of few digits. Differences between points close to the origin and others do not
    // fit into a double.
    const bool is_near = i % 2 == 0;
    const Vec3 u = random.whole_vector(3), v = random.whole_vector(3);
    const Vec3 p = is_near ? Vec3{0} : random.whole_vector(100);
    if (cross(u, v) == Vec3{0}) continue;
    const auto place = [&](double unit) {
      const Vec3 k = unit * random.whole_vector(1000);
      return p + k.x * u + k.y * v;
    };
    const auto triangle = [&] { return Triangle{place(is_near ? 0x1p-50 : 1), place(1), place(1)}; };
    const Triangle a = triangle(), b = triangle();
    const auto has_area = [](const Triangle& s) { return is_finite(s.normal_at(s.a)); };
    if (!has_area(a) || !has_area(b)) continue;
    for (int axis = 0; axis < 3; ++axis) inexact += two_sum(a.b[axis], -a.a[axis]).lo != 0;
    tilted += a.departure().kind == Departure::Kind::rounded_plane;
    wrong.add(a.departure() != b.departure() || b.departure() != a.departure(), a, b);
    wrong.add(b.intersect({b.a, random.direction(), a.departure()}, everywhere).has_value(), a, b);
    const Parallelogram board{p, u, v};
    wrong.add(a.departure() != board.departure(), a, b, board);
    const Plane plane{cross(u, v), dot(cross(u, v), p)};
    wrong.add(a.departure() != plane.departure() || plane.departure() != a.departure(), a, b, board, plane);
  }
  CHECK(tilted > 2000);
  CHECK(inexact > 1000);
  CHECK(wrong == 0);

  // The equation is that of the exact plane, however thin the triangle and wherever it is.
  WrongCases off(random);
  for (int i = 0; i < 3000; ++i) {
    const Point p = random.point(1), q = random.point(1);
    const Point r =
        i % 3 == 0 ? 0.5 * (p + q) + std::exp2(random.real(-50, -20)) * random.point(1) : random.point(1);
    const ExactVector n = cross(exact_difference(q, p), exact_difference(r, p));
    off.add(plane_through_points(p, q, r) != detail::nearest_plane(n, dot(n, exact_vector(p))), p, r);
  }
  CHECK(off == 0);

  const Triangle s{{0, 0, 7}, {0, 3.5, 0}, {7, 0, 0}};  // x + 2y + z = 7
  CHECK(s.departure() == Plane{{1, 2, 1}, 7}.departure());
  CHECK(s.departure() != Plane{{1, 2, 1}, 7 + 8 * ulp}.departure());
  CHECK(Triangle{{0, 0.1, 0}, {1, 0.1, 0}, {0, 0.1, 1}}.departure() == Plane{{0, 1, 0}, 0.1}.departure());
}

TEST_CASE("a picture of triangles is the same ray by ray, accelerated and by tiles") {
  Random random(38);
  Scene<Triangle, Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  for (int i = 0; i < 60; ++i) {
    const Point at = Point{0, 0, 4} + random.point(2);
    scene.add(Triangle{at + random.point(0.5), at + random.point(0.5), at + random.point(0.5)},
              random.color());
  }
  scene.add(Triangle{{-2, -1, 3}, {2, -1, 3}, {0, -1, 6}}, Color{1, 0, 0});
  scene.add(PointLight{.position = {1, 4, 1}, .power = Color{400}});
  const DrawnAlike drawn = drawn_alike(scene, Camera{}, ShadowIntegrator{});
  CHECK(drawn.lit > 1000);
  CHECK(drawn.different == 0);
}

TEST_CASE("an invalid triangle is refused") {
  const auto says = [](const Triangle& s) {
    return message_of<std::invalid_argument>([&] { s.validate(); });
  };
  for (const Vec3& bad : {Vec3{0, not_a_number, 0}, Vec3{0, infinity, 0}, Vec3{-infinity, 1, 0}}) {
    CHECK_THAT(says({.a = bad}), ContainsSubstring("Triangle: a, b and c must have numbers at most 2^400"));
    CHECK_THAT(says({.b = bad}), ContainsSubstring("a, b and c must have"));
    CHECK_THAT(says({.c = bad}), ContainsSubstring("a, b and c must have"));
  }
  CHECK_THAT(says({{1, 1, 1}, {2, 2, 2}, {4, 4, 4}}), ContainsSubstring("must not be on one line"));
  CHECK_THAT(says({{1, 1, 1}, {2, 2, 2}, {1, 1, 1}}), ContainsSubstring("must not be on one line"));
  CHECK_NOTHROW(Triangle{}.validate());
  CHECK_NOTHROW(Triangle{{1, 1, 1}, {2, 2, 2}, {4, 4, 4 + 4 * ulp}}.validate());
  CHECK_NOTHROW(Triangle{Point{0}, {0x1p400, 0, 0}, {0x1p400, 0x1p400, 0}}.validate());
  CHECK_THAT(says({Point{0}, {1, 0, 0}, {0, 1e121, 0}}), ContainsSubstring("at most 2^400"));
}

TEST_CASE("the normal of a tiny sliver equals that of exact arithmetic") {
  const double size = 0x1p-480;  // its square times that of an ulp is just above the least double
  const Triangle sliver{{1, 0, 0}, {1, size * (1 + ulp), size}, {1, size, size * (1 - ulp)}};
  CHECK(sliver.normal_at(sliver.a) == Vec3{-1, 0, 0});  // (1 + ulp) (1 − ulp) < 1
  const Triangle turned{sliver.a, sliver.c, sliver.b};
  CHECK(turned.normal_at(turned.a) == Vec3{1, 0, 0});
}

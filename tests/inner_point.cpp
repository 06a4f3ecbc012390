#include <algorithm>
#include <cmath>
#include <limits>
#include <protostar/numeric/inner_point.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

struct Corners {
  Point a, b, c;
};

ExactVector difference(const ExactVector& x, const ExactVector& y) {
  return {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
}

/// Tests whether a point lies in the plane of three others, strictly on the inner side of all edges.
bool is_inside(const ExactVector& point, const Corners& t) {
  const ExactVector n = cross(exact_difference(t.b, t.a), exact_difference(t.c, t.a));
  const auto is_left_of = [&](const Point& p, const Point& q) {
    return dot(cross(exact_difference(q, p), difference(point, exact_vector(p))), n).sign() > 0;
  };
  return dot(n, difference(point, exact_vector(t.a))).sign() == 0 && is_left_of(t.a, t.b) &&
         is_left_of(t.b, t.c) && is_left_of(t.c, t.a);
}

/// Tests whether each component of a point differs from another's by at most a distance.
bool is_within(double distance, const ExactVector& point, const Point& other) {
  const ExactVector from_other = difference(point, exact_vector(other));
  return std::all_of(from_other.begin(), from_other.end(), [&](const ExactNumber& x) {
    return (ExactNumber(distance) - x).sign() >= 0 && (ExactNumber(distance) + x).sign() >= 0;
  });
}

/// Returns a place in a triangle, on its border or at a vertex: weights of the second and the third vertex.
Uv place(Random& random) {
  const double u = random.real(0, 1), v = random.real(0, 1);
  switch (random.bits() % 4) {
    case 0:
      return {u, 0};
    case 1:
      return {0, 0};
    case 2:
      return {1 - v, v};
    default:
      return {u * (1 - v), v};
  }
}

}  // namespace

TEST_CASE("InnerPoint is next to a rounded point of a triangle and strictly inside, without rounding") {
  Random random(31);
  WrongCases wrong(random), far(random);
  for (int i = 0; i < 4000; ++i) {
    const Point offset = random.point(i % 5 == 0 ? 1000 : 1);
    const double size = std::ldexp(1, static_cast<int>(random.bits() % 20) - 10),
                 thin = i % 3 == 0 ? std::ldexp(1, -static_cast<int>(random.bits() % 30)) : 1;
    const Point a = offset + random.point(size), b = a + random.point(size),
                c = a + random.real(-1, 2) * (b - a) + thin * random.point(size);
    const Uv at = place(random);
    const Point near = a + at.x * (b - a) + at.y * (c - a);
    const InnerPoint inner(near, a, b, c);
    wrong.add(!is_inside(inner.exact(), {a, b, c}) || !is_within(inner.distance(), inner.exact(), near), a, b,
              c, near);
    // The distance is some roundings of the coordinates, however thin the triangle is.
    const auto largest = [](const Vec3& w) { return std::max({w.x, w.y, w.z}); };
    far.add(inner.distance() > 0x1p-48 * (largest(abs(a)) + largest(abs(b - a)) + largest(abs(c - a))), a, b,
            c, near);
  }
  CHECK(wrong == 0);
  CHECK(far == 0);
}

TEST_CASE("InnerPoint is the given point if that is surely in a triangle at a right angle to an axis") {
  const double tiny = 1e-300;
  const Point near{tiny, 2, 5};
  const InnerPoint inner(near, {0, 0, 5}, {0, 4, 5}, {4, 2, 5});
  CHECK(inner.distance() == 0);
  CHECK(is_within(0, inner.exact(), near));
  // A point on the edge, or beyond it, is moved to the inside.
  for (const double x : {0.0, -tiny, -0x1p-52}) {
    const Point other{x, 2, 5};
    const InnerPoint next(other, {0, 0, 5}, {0, 4, 5}, {4, 2, 5});
    CHECK(is_inside(next.exact(), {{0, 0, 5}, {0, 4, 5}, {4, 2, 5}}));
    CHECK(is_within(next.distance(), next.exact(), other));
    CHECK((next.distance() > 0 && next.distance() < 0x1p-46));
  }
}

TEST_CASE("for a point away from the triangle, InnerPoint is next to the triangle's nearest point") {
  const Point a{0, 0, 0}, b{4, 0, 0}, c{0, 2, 0};
  const struct {
    Point near;
    Point expected;
  } rows[] = {{{1, -3, 0}, {1, 0, 0}},   {{1, -3, 2}, {1, 0, 0}},   {{-2, 1.5, 0}, {0, 1.5, 0}},
              {{3, 3, 0}, {2, 1, 0}},    {{-1, -1, 0}, a},          {{9, -1, 7}, b},
              {{-0.5, 8, 0}, {0, 2, 0}}, {{1, 0.5, 3}, {1, 0.5, 0}}};
  for (const auto& row : rows) {
    CAPTURE(row.near.x, row.near.y, row.near.z);
    const ExactVector point = InnerPoint(row.near, a, b, c).exact();
    CHECK(is_inside(point, {a, b, c}));
    CHECK(is_within(0x1p-48, point, row.expected));
  }
}

TEST_CASE("InnerPoint is inside triangles of any size, whatever the given point") {
  const double most = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
  const Corners unit{{0, 0, 0}, {1, 0, 0.25}, {0, 1, 0.5}};
  for (const double scale : {0x1p-1060, 1e-200, 1.0, 1e200, 0x1p1022}) {
    const Corners t{scale * unit.a, scale * unit.b, scale * unit.c};
    for (const double x : {0.0, -least, 0.25 * scale, scale, -most, most, std::nan("")})
      for (const double y : {0.0, 0.25 * scale, scale, most}) {
        CAPTURE(scale, x, y);
        const Point near{x, y, 0.25 * x + 0.5 * y};
        const InnerPoint inner(near, t.a, t.b, t.c);
        CHECK(is_inside(inner.exact(), t));
        if (is_finite(near) && std::isfinite(inner.distance()))
          CHECK(is_within(inner.distance(), inner.exact(), near));
      }
  }
}

#include <protostar/sampling/solid_angle.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/catch.hpp"
#include "support/chi_squared.hpp"
#include "support/common.hpp"
#include "support/random.hpp"
#include "support/view_checks.hpp"
#include "support/views.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns the weights of a triangle's corners for a point.
Vec3 barycentric(const std::array<Point, 3>& t, const Point& point) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double b = dot(cross(point - t[0], t[2] - t[0]), n) / dot(n, n);
  const double c = dot(cross(t[1] - t[0], point - t[0]), n) / dot(n, n);
  return {1 - b - c, b, c};
}

/// Returns how far outside of a triangle a point is, in units of its size.
double outside(const std::array<Point, 3>& t, const Point& point) {
  const Vec3 weights = barycentric(t, point);
  const Vec3 n = normalize(cross(t[1] - t[0], t[2] - t[0]));
  return std::max({-weights.x, -weights.y, -weights.z, std::abs(dot(point - t[0], n)), 0.0});
}

/// Returns χ² over its bound, of the triangles of a grid in which `count` drawn points lie.
double chi_squared_in_triangle(const auto& view, const Point& from, const std::array<Point, 3>& t,
                               std::uint64_t seed, int count = 4000) {
  constexpr int n = 4;
  std::array<int, n * n * 2> counts{};
  std::array<double, n * n * 2> expected{};
  // Cell (i, j) of the weights of two corners has a lower and an upper triangle.
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const auto at = [&](int a, int b) {
        return t[0] + (static_cast<double>(a) / n) * (t[1] - t[0]) +
               (static_cast<double>(b) / n) * (t[2] - t[0]);
      };
      const auto cell = static_cast<std::size_t>(2 * (i * n + j));
      expected[cell] = solid_angle_by_quotient(from, {at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < n)
        expected[cell + 1] = solid_angle_by_quotient(from, {at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)});
    }
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    const double u = random.interior(), v = random.interior();
    const auto [direction, distance, density] = view.sample(u, v);
    const Vec3 w = barycentric(t, from + distance * direction) * static_cast<double>(n);
    const int i = std::clamp(static_cast<int>(w.y), 0, n - 1),
              j = std::clamp(static_cast<int>(w.z), 0, n - 1 - i);
    const bool upper = w.y - i + w.z - j > 1 && i + j + 1 < n;
    ++counts[static_cast<std::size_t>(2 * (i * n + j) + upper)];
  }
  double whole = 0;
  for (const double e : expected) whole += e;
  return chi_squared_over_bound(
      n * n * 2, [&](int i) { return counts[static_cast<std::size_t>(i)]; },
      [&](int i) { return expected[static_cast<std::size_t>(i)] / whole * count; });
}

}  // namespace

TEST_CASE("the solid angle of a sphere has its digits at every distance") {
  Random random(1);
  double most = 0;
  for (int i = 0; i < 3000; ++i) {
    // Far away, near, and almost on the sphere.
    const double radius = std::exp2(random.real(-20, 20));
    const double gap = std::exp2(random.real(-40, 40)) * radius;
    const Point center = random.point(radius);
    const Point from = center + (radius + gap) * random.direction();
    const PreciseVector to = scaled_difference(center, from, 0);
    const DoubleDouble s = two_product(radius, radius) / dot(to, to);
    if (s.hi > 1) continue;  // rounded to the inside
    // 1 − √(1 − s) by its series, if the difference has less than 70 digits.
    const DoubleDouble height =
        s.hi < 0x1p-20
            ? s * (DoubleDouble(0.5) +
                   s * (DoubleDouble(0.125) + s * (DoubleDouble(0.0625) + s * DoubleDouble(0.0390625))))
            : DoubleDouble(1) - sqrt(DoubleDouble(1) - s);
    const double expected = static_cast<double>(DoubleDouble(2) * detail::pi * height);
    most = std::max(most, relative_error(SphereView(from, center, radius).solid_angle(), expected));
  }
  CHECK(most < 8 * u_roundoff);
}

TEST_CASE("directions to a sphere are uniform in its cap, and lead to its near side") {
  for (const double distance : {1 + 0x1p-40, 1.001, 1.5, 10.0, 1e4, 1e12}) {
    CAPTURE(distance);
    const Point from{0.1, -0.2, 0.3};
    const Vec3 axis = normalize(Vec3{2, -1, -2});
    const Point center = from + distance * axis;
    const SphereView view(from, center, 1);
    const auto roundings = [](const Vec3&) { return of_sphere + 8; };  // 8u for the distance
    check_directions(
        view, from, [&](const Point& p) { return std::abs(length(p - center) - 1); }, roundings);
    if (distance < 1e6) CHECK(wrong_solid_angles(view, 2, of_sphere) == 0);  // beyond, roundings prevail
    // Heights in the cap are uniform, and so are azimuths. The height is the share that (d, d) would have.
    Random random(3);
    std::array<int, 64> counts{};
    const Frame frame = frame_around(axis);
    for (int i = 0; i < 10000; ++i) {
      const double u = random.interior(), v = random.interior();
      const Vec3 local = frame.local(view.sample(u, v).direction);
      const double side2 = local.x * local.x + local.y * local.y;
      const double height = local.z > 0 ? side2 / (1 + local.z) : 1 - local.z;
      const double share = height * 2 * std::numbers::pi / view.solid_angle();
      const double turn = std::atan2(local.y, local.x) / (2 * std::numbers::pi) + 0.5;
      const int row = std::clamp(static_cast<int>(share * 8), 0, 7);
      ++counts[static_cast<std::size_t>(8 * row + std::clamp(static_cast<int>(turn * 8), 0, 7))];
    }
    const auto count = [&](int i) { return counts[static_cast<std::size_t>(i)]; };
    CHECK(chi_squared_over_bound(64, count, [](int) { return 10000 / 64.0; }) < 1);
  }
}

TEST_CASE("from inside, all directions lead to a sphere") {
  const Point center{1, 2, 3}, from{1.2, 2.5, 3.1};
  const SphereView view(from, center, 1);
  CHECK(view.solid_angle() == 4 * std::numbers::pi);
  check_directions(
      view, from, [&](const Point& p) { return std::abs(length(p - center) - 1); },
      [](const Vec3&) { return of_sphere + 8; });
  CHECK(wrong_solid_angles(view, 4, of_sphere) == 0);
  CHECK(SphereView(center, center, 2).sample(0.3, 0.4).distance == 2);
  CHECK(SphereView({0, 0, 1}, {0, 0, 0}, 1).solid_angle() ==
        2 * std::numbers::pi);  // on the sphere, it is a half space
  CHECK(SphereView({0, 0, 1}, {0, 0, 0}, -1).solid_angle() == 2 * std::numbers::pi);
}

TEST_CASE(
    "the solid angle of a triangle has its digits near edges, corners and the plane, and for tiny ones") {
  Random random(5);
  WrongCases wrong(random);
  double most = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto [from, corners] = triangle_case(random, i);
    const double expected = solid_angle_by_quotient(from, corners);
    const double error =
        relative_error(TriangleView(from, corners[0], corners[1], corners[2]).solid_angle(), expected);
    most = std::max(most, error);
    wrong.add(!(error < 20 * u_roundoff), i % 6, from, corners, error);
  }
  CHECK(wrong == 0);
  CHECK(most > u_roundoff);
}

TEST_CASE("directions to a triangle are uniform in its solid angle") {
  const std::array<Point, 3> t{{{-1, -0.5, 1}, {2, 0.5, 1}, {0.25, 2, 1}}};
  for (const Point from :
       {Point{0.3, 0.5, 0}, Point{0.3, 0.5, 0.9}, Point{0.3, 0.5, 1 - 1e-3}, Point{4, -3, 0.9},
        Point{0.5, 0.1, 0.95}, Point{-20, 30, -40}, Point{0.3, 0.5, 3}, Point{-1, -0.5, 0.7}}) {
    CAPTURE(from.x, from.y, from.z);
    for (int turn = 0; turn < 3; ++turn) {
      const std::array<Point, 3> s{t[static_cast<std::size_t>(turn)],
                                   t[static_cast<std::size_t>((turn + 1) % 3)],
                                   t[static_cast<std::size_t>((turn + 2) % 3)]};
      const TriangleView view(from, s[0], s[1], s[2]);
      check_directions(
          view, from, [&](const Point& p) { return outside(s, p); }, in_plane({0, 0, 1}, of_triangle));
      CHECK(wrong_solid_angles(view, 6, of_triangle, 60) == 0);
      CHECK(chi_squared_in_triangle(view, from, s, 7) < 1);
    }
  }
}

TEST_CASE("directions to a triangle are uniform where it fills almost a hemisphere, and where it is tiny") {
  const std::array<Point, 3> t{{{-1, -0.5, 1}, {2, 0.5, 1}, {0.25, 2, 1}}};
  for (const double height : {1e-6, 1e-9, 1e-12}) {
    CAPTURE(height);
    const Point from{0.3, 0.5, 1 - height};
    const TriangleView view(from, t[0], t[1], t[2]);
    CHECK(relative_error(view.solid_angle(), solid_angle_by_quotient(from, t)) < 20 * u_roundoff);
    // Almost all directions reach the plane close by: they are those of a hemisphere.
    Random random(8);
    std::array<int, 64> counts{};
    for (int i = 0; i < 4000; ++i) {
      const double u = random.interior(), v = random.interior();
      const Vec3 d = view.sample(u, v).direction;
      const int row = std::clamp(static_cast<int>(d.z * 8), 0, 7);
      const double turn = std::atan2(d.y, d.x) / (2 * std::numbers::pi) + 0.5;
      ++counts[static_cast<std::size_t>(8 * row + std::clamp(static_cast<int>(turn * 8), 0, 7))];
    }
    const auto count = [&](int i) { return counts[static_cast<std::size_t>(i)]; };
    CHECK(chi_squared_over_bound(64, count, [](int) { return 4000 / 64.0; }) < 1);
  }
  for (const double size : {1e-3, 1e-6, 1e-9, 1e-12}) {
    CAPTURE(size);
    const Point from{3, -2, 0.5};
    const std::array<Point, 3> s{size * t[0], size * t[1], size * t[2]};
    const TriangleView view(from, s[0], s[1], s[2]);
    if (size > 1e-11) CHECK(chi_squared_in_triangle(view, from, s, 9) < 1);
  }
}

TEST_CASE(
    "the solid angle of a rectangle has its digits near edges, corners and the plane, and for tiny ones") {
  Random random(10);
  WrongCases wrong(random);
  double most = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto axis = static_cast<int>(random.bits() % 3);
    Vec3 edge_u{0}, edge_v{0};
    edge_u[axis] = std::exp2(random.real(-3, 3)), edge_v[(axis + 1) % 3] = -std::exp2(random.real(-3, 3));
    const double close = std::exp2(random.real(-40, 0));
    // Corners are multiples of 2^-50, so that none is rounded.
    const auto round = [](Vec3 v) {
      return Vec3{std::round(v.x * 0x1p46), std::round(v.y * 0x1p46), std::round(v.z * 0x1p46)} * 0x1p-46;
    };
    if (i % 6 == 3) edge_u *= close, edge_v *= close;
    const Point position = round(random.point(1));
    if (i % 6 != 3) edge_u = round(edge_u), edge_v = round(edge_v);
    const double a = random.real(0, 1), b = random.real(0, 1);
    const Vec3 normal = normalize(cross(edge_u, edge_v));
    Point from = position + a * edge_u + b * edge_v + close * normal;
    if (i % 6 == 1) from = position + a * edge_u + close * random.point(1);
    if (i % 6 == 2) from = position + edge_u + edge_v + close * random.point(1);
    if (i % 6 == 3) from = random.point(9);
    if (i % 6 == 4) from += (4 * a) * edge_u - (3 * b) * edge_v;
    if (i % 6 == 5) from = position + (1 + 3 * a) * edge_u + close * random.point(1);
    const Point q = position + edge_u, r = position + edge_v, opposite = q + edge_v;
    if (q - position != edge_u || r - position != edge_v || opposite - q != edge_v) continue;  // rounded
    const double expected =
        solid_angle_by_quotient(from, {position, q, r}) + solid_angle_by_quotient(from, {opposite, q, r});
    const double error =
        relative_error(RectangleView(from, position, edge_u, edge_v).solid_angle(), expected);
    most = std::max(most, error);
    wrong.add(!(error < 20 * u_roundoff), i % 6, from, position, edge_u, edge_v, error);
  }
  CHECK(wrong == 0);
  CHECK(most > u_roundoff);
}

TEST_CASE("directions to a rectangle are uniform in its solid angle, also close to it and far away") {
  const Vec3 x = normalize(Vec3{2, 1, -0.5}), y = normalize(cross(x, Vec3{0.3, 1, 1})), z = cross(x, y);
  const Point position{0.5, 0.25, -1};
  const Vec3 edge_u = 3.0 * x, edge_v = -1.5 * y;
  struct {
    double u, v, height;
  } const rows[] = {{0.3, 0.4, 1},  {0.3, 0.4, -0.01}, {0.7, 0.9, 1e-9},   {0.5, 0.5, 1e-12},
                    {-2, 0.4, 0.3}, {3, 5, 1},         {-0.01, 0.5, 0.01}, {-40, 30, 50},
                    {0, 0, 0.5},    {1, 0.25, -0.5},   {2, 3, 1e-3},       {400, 300, 500}};
  for (const auto& [u, v, height] : rows) {
    CAPTURE(u, v, height);
    const Point from = position + u * edge_u + v * edge_v + height * z;
    const ParallelogramView view(from, position, edge_u, edge_v);
    CHECK(view.solid_angle() == RectangleView(from, position, edge_u, edge_v).solid_angle());
    const auto place = [&](const Point& p) {
      const Vec3 w = p - position;
      return Vec3{dot(w, edge_u) / dot(edge_u, edge_u), dot(w, edge_v) / dot(edge_v, edge_v), dot(w, z)};
    };
    const auto off = [&](const Point& p) {
      const Vec3 w = place(p);
      return std::max({-w.x, w.x - 1, -w.y, w.y - 1, std::abs(w.z)});
    };
    check_directions(view, from, off, in_plane(z, of_rectangle));
    if (std::abs(height) > 1e-6) CHECK(wrong_solid_angles(view, 11, of_rectangle, 60) == 0);
    std::array<int, 36> counts{};
    std::array<double, 36> expected{};
    double whole = 0;
    for (int i = 0; i < 36; ++i) {
      const Point p = position + (i / 6 / 6.0) * edge_u + (i % 6 / 6.0) * edge_v;
      const Point q = p + edge_u / 6.0, r = p + edge_v / 6.0, s = q + edge_v / 6.0;
      whole += expected[static_cast<std::size_t>(i)] =
          solid_angle_by_quotient(from, {p, q, r}) + solid_angle_by_quotient(from, {s, q, r});
    }
    Random random(12);
    for (int i = 0; i < 4000; ++i) {
      const double a = random.interior(), b = random.interior();
      const auto [direction, distance, density] = view.sample(a, b);
      const Vec3 w = place(from + distance * direction);
      const int row = std::clamp(static_cast<int>(w.x * 6), 0, 5),
                column = std::clamp(static_cast<int>(w.y * 6), 0, 5);
      ++counts[static_cast<std::size_t>(6 * row + column)];
    }
    const auto counted = [&](int i) { return counts[static_cast<std::size_t>(i)]; };
    const auto share = [&](int i) { return expected[static_cast<std::size_t>(i)] / whole * 4000; };
    CHECK(chi_squared_over_bound(36, counted, share) < 1);
  }
}

TEST_CASE("the part of a rectangle beside a drawn direction has the share u of the solid angle") {
  Random random(20);
  WrongCases wrong(random);
  for (int i = 0; i < 600; ++i) {
    // The point is the origin, and close to the plane or to an edge, so that numbers have their digits.
    const double h = std::exp2(random.real(-45, 1)), u = random.interior(), v = random.interior();
    double x0 = -std::exp2(random.real(-45, 1)), y0 = -std::exp2(random.real(-45, 1));
    const double x1 = std::exp2(random.real(-2, 3)), y1 = std::exp2(random.real(-2, 3));
    if (i % 3 == 1) x0 = -x0 / 8;
    if (i % 3 == 2) y0 = -y0 / 8;
    const Vec3 edge_u{x1 - x0, 0, 0}, edge_v{0, y1 - y0, 0};
    const RectangleView view({0, 0, 0}, {x0, y0, h}, edge_u, edge_v);
    const Vec3 d = view.sample(u, v).direction;
    const double x = d.x / d.z * h, y = d.y / d.z * h;
    // Of the larger part of each axis, the view sees the positive side.
    const double right = x0 + edge_u.x, top = y0 + edge_v.y;
    const double share = -x0 > right ? 1 - u : u, lift = -y0 > top ? 1 - v : v;
    const auto part = [&](double left, double to) {
      return TriangleView({0, 0, 0}, {left, y0, h}, {to, y0, h}, {left, top, h}).solid_angle() +
             TriangleView({0, 0, 0}, {to, top, h}, {to, y0, h}, {left, top, h}).solid_angle();
    };
    // The part and the whole are off by 20u of themselves, and so are the parts of which the view makes x.
    // Components of a direction and their quotient are off by 42u of themselves, as they are products; an
    // error counts by the change of the share with ln x.
    const double error = part(x0, x) / view.solid_angle() - share;
    const auto slope = [](const auto& f, double at) {
      return std::abs(f(at * (1 + 0x1p-20)) - f(at)) * 0x1p20;
    };
    const double by_x = slope([&](double at) { return part(x0, at) / view.solid_angle(); }, x);
    wrong.add(!(std::abs(error) <= (60 + 42 * by_x) * u_roundoff), "x", h, x0, x1, y0, y1, u, v, error);
    // Heights y/r are uniform, and so are depths 1 − y/r.
    const auto depth = [&](double at) {
      const double square = x * x + h * h, r = std::sqrt(at * at + square);
      return at > 0 ? square / (r * (r + at)) : (r - at) / r;
    };
    // Depths are off by 8u of themselves, and so are their differences.
    const double whole = depth(y0) - depth(top), other = (depth(y0) - depth(y)) / whole - lift;
    const double most = (16 * depth(y0) + 42 * slope(depth, y)) / whole + 2;
    wrong.add(!(std::abs(other) <= most * u_roundoff), "y", h, x0, x1, y0, y1, u, v, other);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a parallelogram without right angles is two triangles") {
  const Point position{-1, -1, 2}, from{0.2, 0.1, -0.3};
  const Vec3 edge_u{2, 0.5, 0.25}, edge_v{1, 2, -0.5};
  const ParallelogramView view(from, position, edge_u, edge_v);
  const std::array<Point, 3> a{position, position + edge_u, position + edge_v},
      b{position + edge_u + edge_v, position + edge_v, position + edge_u};
  const double first = TriangleView(from, a[0], a[1], a[2]).solid_angle(),
               second = TriangleView(from, b[0], b[1], b[2]).solid_angle();
  CHECK(view.solid_angle() == first + second);
  check_directions(
      view, from, [&](const Point& p) { return std::min(outside(a, p), outside(b, p)); },
      in_plane(normalize(cross(edge_u, edge_v)), of_triangle));
  CHECK(wrong_solid_angles(view, 13, of_triangle, 200, first / (first + second)) == 0);
  int inside = 0;
  Random random(14);
  for (int i = 0; i < 4000; ++i) {
    const double u = random.interior(), v = random.interior();
    const auto [direction, distance, density] = view.sample(u, v);
    const Point p = from + distance * direction;
    inside += outside(a, p) < outside(b, p);
  }
  // Five standard deviations: 6e-7.
  const double share = first / (first + second);
  CHECK(std::abs(inside - 4000 * share) < 5 * std::sqrt(4000 * share * (1 - share)));
}

TEST_CASE("the triangles of a mesh are chosen by their areas, or by their solid angles") {
  const std::vector<TriangleCorners> triangles{{{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}},
                                               {{{1, 1, 2}, {1, 1, 2}, {0, 1, 2}}},  // no area
                                               {{{1, 0, 2}, {3, 1, 2}, {0, 1, 2}}},
                                               {{{-4, 0, 1}, {-5, 0, 1}, {-4, 3, 1.5}}}};
  const Point from{0.2, 0.1, 0};
  const MeshLight light(triangles);
  const MeshView view(from, light.triangles());
  double whole = 0;
  std::vector<double> angles, areas;
  for (const auto& [a, b, c] : triangles) {
    angles.push_back(TriangleView(from, a, b, c).solid_angle()), whole += angles.back();
    areas.push_back(length(cross(b - a, c - a)) / 2);
  }
  CHECK(view.solid_angle() == whole);
  CHECK(angles[1] == 0);
  std::array<int, 4> by_angle{}, by_area{};
  Random random(17);
  WrongCases wrong(random);
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    const double u = random.interior(), v = random.interior();
    const MeshSample one = view.sample(u, v), other = light.sample(from, u, v);
    ++by_angle[one.triangle], ++by_area[other.triangle];
    wrong.add(one.light.density != 1 / whole, u, v);
    // One probability by one solid angle, with two roundings and with one.
    wrong.add(relative_error(other.light.density, light.density(from, other.triangle)) > 3.001 * u_roundoff,
              u, v);
    for (const MeshSample& sample : {one, other}) {
      const auto& [a, b, c] = triangles[sample.triangle];
      const auto& [direction, distance, density] = sample.light;
      const double roundings = in_plane(normalize(cross(b - a, c - a)), of_triangle)(direction) + 15;
      wrong.add(outside({a, b, c}, from + distance * direction) > roundings * u_roundoff * (1 + distance), u,
                v);
    }
  }
  CHECK(wrong == 0);
  const double area = areas[0] + areas[1] + areas[2] + areas[3];
  for (std::size_t i = 0; i < 4; ++i) {
    const double p = angles[i] / whole, q = areas[i] / area;
    CHECK(std::abs(by_angle[i] - count * p) <= 5 * std::sqrt(count * p * (1 - p)));
    CHECK(std::abs(by_area[i] - count * q) <= 5 * std::sqrt(count * q * (1 - q)));
    // A share is the difference of sums up to the whole, off by u of them; q and the density have 10
    // operations.
    if (i != 1) CHECK(relative_error(light.density(from, i), q / angles[i]) <= (1 / q + 10) * u_roundoff);
  }
  CHECK(MeshLight({}).sample(from, 0.5, 0.5).light.density == std::numeric_limits<double>::infinity());
}

TEST_CASE("a light that covers no solid angle has an infinite density, and adds nothing") {
  const double inf = std::numeric_limits<double>::infinity();
  const Point in_plane{3, 4, 0};
  CHECK(TriangleView(in_plane, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}).sample(0.5, 0.5).density == inf);
  CHECK(TriangleView({0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}).sample(0.5, 0.5).density == inf);
  CHECK(RectangleView(in_plane, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}).sample(0.5, 0.5).density == inf);
  CHECK(ParallelogramView(in_plane, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}).sample(0.5, 0.5).density == inf);
  CHECK(DiskView(in_plane, {0, 0, 0}, {0, 0, 1}, 1).sample(0.5, 0.5).density == inf);
  CHECK(1 / TriangleView({0, 0, 0x1p300}, {0, 0, 0}, {0x1p-300, 0, 0}, {0, 0x1p-300, 0})
                .sample(0.5, 0.5)
                .density ==
        0);
}

TEST_CASE("views of lights do not depend on the unit of length") {
  const Point from{0.1, 0.2, 0.3}, p{1, 2, 3}, q{2, 2, 1}, r{1, -2, 4};
  for (const double unit : {0x1p-390, 0x1p-40, 0x1p40, 0x1p390}) {
    const auto check = [&](const auto& one, const auto& other) {
      CHECK(one.solid_angle() == other.solid_angle());
      const LightSample a = one.sample(0.3, 0.6), b = other.sample(0.3, 0.6);
      CHECK(a.direction == b.direction);
      CHECK(a.distance * unit == b.distance);
    };
    check(SphereView(from, p, 1), SphereView(unit * from, unit * p, unit));
    check(TriangleView(from, p, q, r), TriangleView(unit * from, unit * p, unit * q, unit * r));
    check(RectangleView(from, p, {3, 0, 0}, {0, 0, 2}),
          RectangleView(unit * from, unit * p, {3 * unit, 0, 0}, {0, 0, 2 * unit}));
    check(DiskView(from, p, r, 2), DiskView(unit * from, unit * p, r, 2 * unit));
  }
}

// These values would differ between machines if functions of the C library took part.
TEST_CASE("views of lights have the same bits on every machine") {
  const Point from{0.1, 0.2, 0.3}, p{1, 2, 3};
  const auto check = [](const auto& view, double solid_angle, double x, double distance) {
    CHECK(view.solid_angle() == solid_angle);
    CHECK(view.sample(0.3, 0.6).direction.x == x);
    CHECK(view.sample(0.3, 0.6).distance == distance);
  };
  check(SphereView(from, p, 1), 0x1.223b36abc8d8p-2, 0x1.3e06d88f5ae1cp-3, 0x1.36d4abf158776p+1);
  check(TriangleView(from, p, {2, 2, 1}, {1, -2, 4}), 0x1.bc1344798ac96p-2, 0x1.c79ba288834d4p-2,
        0x1.6330606032ac5p+1);
  check(RectangleView(from, p, {3, 0, 0}, {0, 0, 2}), 0x1.b28844fce3c04p-4, 0x1.6f1a2b9ece4f8p-2,
        0x1.14f03242d9b29p+2);
  check(DiskView(from, p, {.3, .2, -1}, 1), 0x1.5627ef3e3c4f7p-3, 0x1.5c90698fe2662p-3, 0x1.a8a2194cd6563p+1);
}

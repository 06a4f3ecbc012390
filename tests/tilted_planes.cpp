// Tests which tilted planes a ray leaves together: planes whose equations, divided by the largest component
// of the normal, round to the same doubles (docs/derivations.md, The plane that a ray leaves).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <protostar/accel/accelerate.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

constexpr Interval whole_line{-infinity, infinity};

/// Returns n·x − distance of a rounded equation, exactly.
ExactNumber height_over(const PlaneEquation& plane, const Point& x) {
  ExactNumber height = -ExactNumber(plane[3]);
  for (int i = 0; i < 3; ++i) height += ExactNumber(plane[static_cast<std::size_t>(i)]) * ExactNumber(x[i]);
  return height;
}

/// Returns the unit vector along an exact vector that is not 0.
Vec3 unit_along_exact(const ExactVector& n) {
  int largest = -100000;
  for (const ExactNumber& x : n)
    if (x.sign() != 0) largest = std::max(largest, x.approximation().exponent);
  Vec3 v;
  for (int i = 0; i < 3; ++i) {
    const auto [value, exponent] = n[static_cast<std::size_t>(i)].approximation();
    v[i] = value.hi == 0 ? 0 : std::ldexp(value.hi, exponent - largest);
  }
  return normalize(v);
}

Plane plane_of(const PlaneEquation& equation) {
  return {.normal = {equation[0], equation[1], equation[2]}, .distance = equation[3]};
}

/// Returns a random parallelogram in a tilted plane whose equation doubles do not hold exactly.
Parallelogram tilted_board(Random& random) {
  for (;;) {
    const Parallelogram board{random.point(3), random.point(1), random.point(1)};
    if (board.departure().kind == Departure::Kind::rounded_plane &&
        length(cross(board.edge_u, board.edge_v)) > 0.1)
      return board;
  }
}

Point middle_of(const Parallelogram& board) { return board.position + 0.5 * (board.edge_u + board.edge_v); }

}  // namespace

TEST_CASE("a ray that leaves one of several surfaces in one tilted plane leaves all of them, of any kind") {
  Random random(81);
  int planes = 0;
  WrongCases wrong(random);
  while (planes < 500) {
    // Whole numbers so small that the plane of each surface is exact.
    const Vec3 n = random.whole_vector(20);
    const Vec3 u = cross(n, random.whole_vector(5)), v = cross(n, random.whole_vector(5));
    if (cross(u, v) == Vec3{0} || (n.x == 0) + (n.y == 0) + (n.z == 0) == 2) continue;
    ++planes;
    const Point p = random.whole_vector(50);
    std::vector<AnySurface> surfaces;
    for (const double multiple : {1.0, -3.0, 0x1p-70})
      surfaces.emplace_back(Plane{multiple * n, multiple * dot(n, p)});
    surfaces.emplace_back(Parallelogram{p, u, v});
    surfaces.emplace_back(Parallelogram{p + 2.0 * u - v, u - v, 5.0 * v});
    surfaces.emplace_back(Triangle{p, p + u, p + v});
    surfaces.emplace_back(Triangle{p - v, p + 3.0 * u, p + 7.0 * v});
    surfaces.emplace_back(Disk{.position = p + u, .normal = n, .radius = 40});
    surfaces.emplace_back(Disk{.position = p - v, .normal = -7.0 * n, .radius = 60});
    for (const AnySurface& left : surfaces)
      for (const AnySurface& other : surfaces) {
        wrong.add(!(left.departure(0) == other.departure(0)), n, u, p);
        const Ray ray{p + 0.25 * u + 0.25 * v, random.direction(), left.departure(0)};
        wrong.add(first_crossing(other, ray, whole_line).has_value(), ray);
      }
  }
  CHECK(wrong == 0);
}

TEST_CASE(
    "equations of planes are rounded to nearest, and normals are right, however small their numbers are") {
  Random random(83);
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const auto number = [&] {
      const int exponents[] = {0, 0, 60, -60, 390, -390, -900, -1040, -1074};
      return std::ldexp(i % 3 == 0 ? random.real(-8, 8) : static_cast<double>(random.whole(15)),
                        exponents[random.whole(4) + 4]);
    };
    const auto vector = [&] { return Vec3{number(), number(), number()}; };
    const Point p = vector();
    const Vec3 u = vector(),
               v = i % 2 == 0 ? vector() : u + Vec3{0, 0, 0x1p-1073 * static_cast<double>(random.whole(9))};
    const auto nearest = [](const ExactVector& n, const Point& at) {
      return detail::nearest_plane(n, dot(n, exact_vector(at)));
    };
    const auto is_off = [](const Vec3& unit, const ExactVector& n) {
      // With u = 2^-53, both round the vector by u, and normalize it, which is off by 4.5u (camera.cpp).
      return !(length(unit - unit_along_exact(n)) <= 11.001 * 0x1p-53);
    };
    if (u != Vec3{0}) wrong.add(plane_at(p, u) != nearest(exact_vector(u), p), p, u);
    const ExactVector along = cross(exact_vector(u), exact_vector(v)), through = exact_normal(p, u, v);
    if (along != ExactVector{}) {
      wrong.add(plane_through(p, u, v) != nearest(along, p), p, u, v);
      wrong.add(is_off(unit_normal(u, v), along), u, v);
    }
    if (through != ExactVector{}) {
      wrong.add(plane_through_points(p, u, v) != nearest(through, p), p, u, v);
      wrong.add(is_off(unit_normal_through(p, u, v), through), p, u, v);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a ray that leaves a surface with numbers near the smallest double does not hit it again") {
  const AnySurface surfaces[] = {
      Disk{.position = {4, -1, 1}, .normal = {-0x1.9p1000, 0, -0x1p-73}, .radius = 4},
      Parallelogram{{-4, 1.5, 4}, {12, -7.5, 0}, {12, -7.5, 0x1p-1074}},
      Triangle{Point{0}, {12, -7.5, 0}, {12, -7.5, 0x1p-1070}}};
  for (const AnySurface& surface : surfaces) {
    const Ray ray{.origin = {20, -10, 3}, .direction = {-3, 2, -1}, .departure = departure_of(surface)};
    CHECK_FALSE(first_crossing(surface, ray, whole_line));
    for (const Vec3& direction : {Vec3{-1, 0, 0}, Vec3{0, 1, 0}}) {
      const Ray other{surface.bounds().min, direction, departure_of(surface)};
      CHECK_FALSE(first_crossing(surface, other, whole_line));
    }
  }
}

TEST_CASE("planes whose rounded equations differ in the last place of one number are told apart") {
  Random random(82);
  WrongCases wrong(random);
  for (int i = 0; i < 500; ++i) {
    const Parallelogram board = tilted_board(random);
    const PlaneEquation equation = board.departure().geometry;
    wrong.add(!(plane_of(equation).departure() == board.departure()), board);
    for (std::size_t k = 0; k < 4; ++k)
      for (const double side : {-infinity, infinity}) {
        PlaneEquation next = equation;
        next[k] = std::nextafter(next[k], side);
        const Plane other = plane_of(next);
        wrong.add(other.departure() == board.departure() || board.departure() == other.departure(), board,
                  other);
        // A line through both planes that departs from one of them crosses the other.
        const Point origin = middle_of(board);
        const Vec3 direction = cross(board.edge_u, board.edge_v) + 0.1 * random.direction();
        wrong.add(!other.intersect({origin, direction, board.departure()}, whole_line), board, other, origin,
                  direction);
        wrong.add(!board.intersect({origin - direction, direction, other.departure()}, whole_line), board,
                  other, origin, direction);
      }
  }
  CHECK(wrong == 0);
}

TEST_CASE("planes with equal rounded equations are left together, and are hit in exact order") {
  Random random(83);
  int before = 0, behind = 0;
  WrongCases wrong(random), far(random), misordered(random);
  for (int i = 0; i < 2000; ++i) {
    const Parallelogram board = tilted_board(random);
    const PlaneEquation equation = board.departure().geometry;
    const Plane floor = plane_of(equation);
    const Point origin = middle_of(board) + random.direction();
    const Ray ray{origin, middle_of(board) + 0.2 * random.point(1) - origin};
    wrong.add(floor.intersect({middle_of(board), ray.direction, board.departure()}, whole_line).has_value(),
              board, floor, ray);
    wrong.add(board.intersect({middle_of(board), ray.direction, floor.departure()}, whole_line).has_value(),
              board, floor, ray);

    // The distance between both is at most 2^-52 of the sizes of the terms, in units of the normal, whose
    // length is at least 1.
    const Point p = board.position;
    double terms = std::abs(equation[3]);
    for (int k = 0; k < 3; ++k) terms += std::abs(equation[static_cast<std::size_t>(k)] * p[k]);
    const ExactNumber height = height_over(equation, p), most = 0x1p-52 * 1.01 * terms;
    far.add((most - height).sign() < 0 || (most + height).sign() < 0, board, floor, ray);

    // Both are ordered as in exact arithmetic, whichever was added first.
    const auto t = board.intersect(ray);
    if (!t || !floor.intersect(ray)) continue;
    const int first = order(exact_root_of(board, ray, 0), exact_root_of(floor, ray, 0));
    before += first<0, behind += first> 0;
    Scene<Parallelogram, Plane> boards_first;
    Scene<Plane, Parallelogram> floors_first;
    boards_first.add(board, Color{1}), boards_first.add(floor, Color{0});
    floors_first.add(floor, Color{0}), floors_first.add(board, Color{1});
    const auto sees_board = [&](const auto& scene) { return scene.intersect(ray)->color() == Color{1}; };
    misordered.add(
        first != 0 && (sees_board(boards_first) != (first < 0) || sees_board(floors_first) != (first < 0)),
        board, floor, ray);
  }
  CHECK(wrong == 0);
  CHECK(far == 0);
  CHECK(misordered == 0);
  CHECK(before > 100);
  CHECK(behind > 100);
}

TEST_CASE("surfaces with equal rounded planes show no acne, and surfaces farther off cast their shadow") {
  Random random(84);
  int lit = 0, dark = 0;
  WrongCases acne(random), leaks(random);
  for (int i = 0; i < 100; ++i) {
    const Parallelogram board = tilted_board(random);
    const Plane floor = plane_of(board.departure().geometry);
    const Vec3 up = board.normal_at(board.position);
    Scene<Plane, Parallelogram> touching, apart;
    touching.add(floor, Color{1}), touching.add(board, Color{1});
    Parallelogram raised = board;
    raised.position += 0x1p-46 * up;  // far above the rounding of a hit point, 2^-51 of its size
    apart.add(floor, Color{1}), apart.add(raised, Color{1});
    for (int k = 0; k < 100; ++k) {
      const Point on_board =
          board.position + random.real(0.01, 0.99) * board.edge_u + random.real(0.01, 0.99) * board.edge_v;
      const Point light = on_board + up + 0.5 * random.direction();
      const Point eye = on_board + up + 0.5 * random.direction();
      const auto hit = touching.intersect({eye, on_board - eye});
      REQUIRE(hit);
      ++lit;
      acne.add(touching.occluded(hit->leave(light - hit->point()), Interval{0, 1}), board, floor, raised,
               light);
      // From below, the floor is visible, which the raised board hides from a light above.
      const Point below = on_board - up + 0.5 * random.direction();
      const auto under = apart.intersect({below, on_board - below});
      REQUIRE(under);
      const Ray to_light = under->leave(light - under->point());
      const Plane* const is_floor = &apart.template surfaces<Plane>()[0];
      REQUIRE(under->leave(up).departure == is_floor->departure());
      ++dark;
      leaks.add(!apart.occluded(to_light, Interval{0, 1}), board, floor, raised, to_light);
    }
  }
  CHECK(acne == 0);
  CHECK(leaks == 0);
  CHECK(lit + dark == 20'000);
}

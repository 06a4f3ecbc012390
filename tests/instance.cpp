#include <protostar/surfaces/instance.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/accel/accelerate.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/meshes.hpp"
#include "support/random.hpp"
#include "support/two_plates.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a random map that stretches by 1/2 to 2, mirrors, rotates and moves.
Affine any_placement(Random& random, double far) {
  return Affine{}
      .scaled_by({random.real(0.5, 2), random.real(0.5, 2), random.real(-2, -0.5)})
      .rotated_about(random.direction(), random.real(0, 360))
      .moved_by(random.point(far));
}

}  // namespace

TEST_CASE("no line that crosses a box is taken to miss it, and those that pass it are") {
  const Bounds box{Point{-1}, Point{1}}, everything{Point{-infinity}, Point{infinity}};
  struct {
    const char* what;
    Bounds bounds;
    Ray ray;
    bool misses;
  } const rows[] = {
      {"through it", box, {{-3, 0.5, 0}, {1, 0, 0}}, false},
      {"behind the origin", box, {{3, 0.5, 0}, {1, 0, 0}}, false},
      {"along a face", box, {{-3, 1, 0}, {1, 0, 0}}, false},
      {"past the face", box, {{-3, 1 + 0x1p-40, 0}, {1, 0, 0}}, true},
      {"touching an edge", box, {{0, 2, 0}, {1, -1, 0}}, false},
      {"past the edge", box, {{0, 2 + 0x1p-40, 0}, {1, -1, 0}}, true},
      {"past it, seen along one axis only", box, {{-1, 2.5, 0}, {1, -1, 1}}, true},
      {"no direction", box, {{-3, 5, 0}, {0, 0, 0}}, false},
      {"no number", box, {{-3, not_a_number, 0}, {1, 0, 0}}, false},
      {"without bounds", everything, {{-3, 5, 0}, {1, 0, 0}}, false},
      {"past a flat box", {{-1, 0, -1}, {1, 0, 1}}, {{-3, 0x1p-40, 0}, {1, 0, 0}}, true},
      {"in a flat box", {{-1, 0, -1}, {1, 0, 1}}, {{-3, 0, 0}, {1, 0, 0}}, false},
  };
  for (const auto& row : rows) {
    CAPTURE(row.what);
    CHECK(surely_misses(row.ray, row.bounds) == row.misses);
  }

  Random random(20261124);
  int crossed = 0, missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double far = std::ldexp(1, static_cast<int>(random.bits() % 40));
    const Point center = random.point(far), half = abs(random.point(1));
    const Box inner{center - half, center + half}, outer{center - 1.001 * half, center + 1.001 * half};
    const Point origin = center + random.point(10);
    const Ray ray{origin, center + 2.0 * random.point(1) * half - origin};
    const bool misses = surely_misses(ray, {inner.min, inner.max});
    const bool crosses = first_crossing(inner, ray, everywhere).has_value();
    CHECK_FALSE((crosses && misses));
    crossed += crosses, missed += misses;
    if (far < 0x1p20 && std::min({half.x, half.y, half.z}) > 0.01)
      CHECK((misses || first_crossing(outer, ray, everywhere)));
  }
  CHECK(crossed > 4000);
  CHECK(missed > 4000);
}

TEST_CASE("an instance is hit where its surface is, transformed by the map") {
  const auto stretched = Affine{}.scaled_by({1, 1, 2}).moved_by({0, 0, 5});
  struct {
    const char* what;
    Affine placement;
    Ray ray;
    Interval range;
    std::optional<double> expected;
  } const rows[] = {
      {"where it was", {}, {{0, 0, -3}, {0, 0, 1}}, {}, 2},
      {"moved", Affine{}.moved_by({0, 0, 5}), ray_along_z, {}, 4},
      {"stretched", stretched, ray_along_z, {}, 3},
      {"stretched, seen from inside", stretched, {{0, 0, 5}, {0, 0, 1}}, {}, 2},
      {"a direction that is longer", stretched, {{0, 0, 0}, {0, 0, 8}}, {}, 0.375},
      {"beyond the range", stretched, ray_along_z, {0, 3}, std::nullopt},
      {"its far side", stretched, ray_along_z, {3, infinity}, 7},
      {"behind", stretched, {{0, 0, 9}, {0, 0, 1}}, {}, std::nullopt},
      {"behind, in a range that reaches back", stretched, {{0, 0, 9}, {0, 0, 1}}, everywhere, -6},
      {"grazing", stretched, {{1, 0, 0}, {0, 0, 1}}, {}, 5},
      {"next to it", stretched, {{1 + 0x1p-52, 0, 0}, {0, 0, 1}}, {}, std::nullopt},
      {"a mirror image", Affine{}.scaled_by({1, 1, -2}).moved_by({0, 0, 5}), ray_along_z, {}, 3},
      {"turned",
       Affine{}.scaled_by({1, 4, 1}).rotated_about({1, 0, 0}, 90).moved_by({0, 0, 5}),
       ray_along_z,
       {},
       1},
      {"sheared", {{1, 0, 0}, {0, 1, 0}, {1, 0, 1}, {0, 0, 5}}, {{1, 0, 0}, {0, 0, 1}}, {}, 5},
      {"tiny", Affine{}.scaled_by(Vec3{0x1p-400}).moved_by({0, 0, 1}), ray_along_z, {}, 1},
      {"huge", Affine{}.scaled_by(Vec3{0x1p400}), ray_along_z, {}, 0x1p400},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    const Instance instance(Sphere{}, row.placement);
    CHECK_NOTHROW(instance.validate());
    CHECK(instance.intersect(row.ray, row.range) == row.expected);
  }
}

TEST_CASE("rays and instances with numbers that are not finite have no hits") {
  const Instance sound(Sphere{}, Affine{}.moved_by({0, 0, 5}));
  for (const double bad : {infinity, -infinity, std::nan("")})
    for (int axis = 0; axis < 3; ++axis) {
      Ray origin = ray_along_z, direction = ray_along_z;
      origin.origin[axis] = bad, direction.direction[axis] = bad;
      CHECK_FALSE(sound.intersect(origin, everywhere));
      CHECK_FALSE(sound.intersect(direction, everywhere));
      Affine placement;
      placement.y[axis] = bad;
      CHECK_FALSE(Instance(Sphere{}, placement).intersect(ray_along_z, everywhere));
    }
  CHECK_FALSE(sound.intersect({{0, 0, 5}, {0, 0, 0}}, everywhere));
}

TEST_CASE("whether a ray hits an ellipsoid is exact if the map consists of powers of two") {
  // All numbers are multiples of 1/4, so the transformed ray is not rounded and plain signs decide.
  Random random(71);
  const auto whole = [&](int size) {
    return static_cast<std::int64_t>(random.bits() % static_cast<std::uint64_t>(2 * size + 1)) - size;
  };
  int hits = 0, touching = 0;
  WrongCases wrong(random);
  for (int i = 0; i < cases(10'000, 80'000, 80'000); ++i) {
    Vec3 scales, moved, origin, direction;
    std::int64_t A = 0, b = 0, c = -16;  // in quarters, in object space
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t scale = 1 << (random.bits() % 3), o = whole(4), d = whole(3), m = whole(3);
      const auto to_double = [](std::int64_t x) { return static_cast<double>(x); };
      scales[axis] = to_double(scale), moved[axis] = to_double(m);
      origin[axis] = to_double(o), direction[axis] = to_double(d);
      const std::int64_t carried = (o - m) * 4 / scale, along = d * 4 / scale;
      A += along * along, b -= along * carried, c += carried * carried;
    }
    const Instance instance(Sphere{}, Affine{}.scaled_by(scales).moved_by(moved));
    int crossings = 0;
    instance.each_crossing({origin, direction}, everywhere, [&](const Crossing&) { ++crossings; });
    const std::int64_t D = b * b - A * c;
    const bool expected = A > 0 && D >= 0;
    hits += expected;
    touching += expected && D == 0;
    wrong.add(crossings != (expected ? 2 : 0), scales, moved, origin, direction);
  }
  CHECK(hits > cases(1'000, 10'000, 10'000));
  CHECK(touching > cases(50, 500, 500));
  CHECK(wrong == 0);
}

TEST_CASE(
    "a hit on an instance lies on the transformed surface, within the rounding of the transformed ray") {
  // In units of u = 2^-53: the map's inverse stretches by at most 2, so the terms of a component of a
  // transformed vector are at most twice the vector's length. The origin is within 9√3 of the map's
  // translation, and t d is shorter than 18: it ends before the target, or in the ellipsoid in which it
  // starts. A component of the transformed origin is off by 5 · 2 · 16 = 160, and of t d by 4 · 2 · 18 = 144.
  // The point in world space rounds by 18 + 8, which becomes 52; transformed back for the test, a component
  // of it is off by 5 · 2 · 2 = 20. With √3 for three components, 36 for the rounding of t and 3 for the
  // length: √3 · 324 + 52 + 36 + 3 < 2^10.
  const double rounding = 0x1p-43;
  Random random(72);
  double worst = 0, worst_refined = 0;
  for (int i = 0; i < cases(3'000, 20'000, 20'000); ++i) {
    const Affine placement = any_placement(random, 3);
    const Instance instance(Sphere{}, placement);
    const Point origin = random.point(6), target = placement.point(0.9 * random.direction());
    const Ray ray{origin, target - origin};
    const auto crossing = instance.first_crossing(ray, {});
    REQUIRE(crossing);
    const AffineInverse back(placement);
    const auto off = [&](double t) { return std::abs(length(back.point(ray.at(t))) - 1); };
    // The relative error of t is at most 2^-30, and one unit in the last place where t is refined.
    const double by_t = Roots::relative_error * length(back.vector(crossing->t * ray.direction));
    worst = std::max(worst, off(crossing->t) - by_t);
    if (i % 16 != 0) continue;
    worst_refined =
        std::max(worst_refined, off(static_cast<double>(refined(instance.exact_root(ray, *crossing)))));
  }
  CHECK(worst < rounding);
  CHECK(worst_refined < rounding);
}

TEST_CASE("the normal of an instance is a unit vector that points outwards, also in a mirror image") {
  Random random(73);
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const Affine placement = any_placement(random, 3);
    const Instance instance(Sphere{}, placement);
    const Vec3 n = random.direction(), along = normalize(cross(n, random.direction()));
    const Vec3 normal = instance.normal_at(placement.point(n));
    // In units of u = 2^-53, with rows and columns of a size of √12 at most: the point is off by 3√12 and by
    // 7 for its sum, at rest by 5√12 · 2 and twice as much, together 70 and 2 for the normal there. Mapped,
    // these grow to 144, with 4√12 for the sum, over a length of ½ or more; normalize has 4.5 and the dot
    // product 3 · 2, and the mapped vector 3√12. Measured are 9.
    wrong.add(!(std::abs(length(normal) - 1) <= 7.001 * 0x1p-53), "length", placement, normal);
    wrong.add(!(std::abs(dot(normal, placement.vector(along))) <= (2 * (2 * 158 + 4.5) + 6 + 11) * 0x1p-53),
              "angle", placement, n, normal);
    wrong.add(dot(normal, placement.vector(n)) <= 0, "inward", placement, n, normal);
  }
  CHECK(wrong == 0);
  CHECK(Instance(Sphere{.radius = -1}, {}).normal_at({0, 0, 1}) == Vec3{0, 0, -1});
  for (const double size : {0x1p-400, 0x1p400})
    CHECK(Instance(Sphere{}, Affine{}.scaled_by({size, 1, 1})).normal_at({0, 0, 1}) == Vec3{0, 0, 1});
}

TEST_CASE("a ray that leaves an instance never hits it again outwards, and once inwards") {
  Random random(74);
  int out = 0, in = 0;
  WrongCases wrong(random);
  for (int i = 0; i < cases(3'000, 20'000, 20'000); ++i) {
    const Affine placement = any_placement(random, 10);
    const Instance<> instance(Sphere{}, placement);
    const Point origin = random.point(20);
    const Ray ray{origin, placement.point(0.99 * random.direction()) - origin};
    const auto t = instance.intersect(ray);
    REQUIRE(t);
    const Point point = ray.at(*t);
    Vec3 direction = random.direction();
    if (i % 2 == 0) direction = cross(direction, instance.normal_at(point)) + 1e-9 * direction;  // grazing
    const double slope = dot(direction, instance.normal_at(point));
    const Ray left{point, direction, instance.departure()};
    int ahead = 0, all = 0;
    instance.each_crossing(left, {}, [&](const Crossing&) { ++ahead; });
    instance.each_crossing(left, everywhere, [&](const Crossing&) { ++all; });
    wrong.add(all != 1, placement, ray, left);
    if (std::abs(slope) < 1e-12) continue;
    out += slope > 0, in += slope < 0;
    wrong.add(ahead != (slope < 0), placement, ray, left, slope);
  }
  CHECK(out > cases(1'000, 5'000, 5'000));
  CHECK(in > cases(1'000, 5'000, 5'000));
  CHECK(wrong == 0);

  // Ellipsoids are identified by their address, so a ray that leaves one hits its equal twin.
  const Affine stretched = Affine{}.scaled_by({1, 1, 2});
  const Instance<> one(Sphere{}, stretched), other(Sphere{}, stretched);
  CHECK(one.departure() != other.departure());
  CHECK(other.intersect({{0, 0, 2}, {0, 0, -1}, one.departure()}) == 4);
}

TEST_CASE(
    "an instance of an instance, or of AnySurface, has the primitives, coordinates and departures of its "
    "surface") {
  const Instance<> plates(Instance(TwoPlates{}, Affine{}.scaled_by({2, 2, 2})), Affine{}.moved_by({0, 0, 4}));
  CHECK(plates.has_primitives());
  CHECK(plates.has_uv());
  CHECK_FALSE(Instance(Plane{}, {}).has_primitives());
  std::vector<std::pair<double, int>> crossed;
  plates.each_crossing(ray_along_z, {}, [&](const Crossing& c) { crossed.push_back({c.t, c.primitive}); });
  CHECK(crossed == std::vector<std::pair<double, int>>{{4, 0}, {6, 1}});
  CHECK(plates.normal_at({0, 0, 4}, 0) == Vec3{0, 0, -1});
  CHECK(plates.normal_at({0, 0, 6}, 1) == Vec3{0, 0, 1});
  CHECK(plates.uv_at({1, 0, 6}, 1) == Uv{10.5, 0});

  const Vec3 up{0, 0, 1};
  CHECK(plates.intersect({{0, 0, 4}, up, plates.departure(0)}, everywhere) == 2);
  CHECK(plates.intersect({{0, 0, 4}, up, plates.departure(1)}, everywhere) == 0);
  CHECK(plates.intersect({{0, 0, 6}, -up, plates.departure(1)}, everywhere) == 2);

  // In a scene, a ray that leaves the lower plate hits the upper one.
  Scene<AnySurface> scene;
  scene.add(plates, Color{1});
  const auto hit = scene.intersect(ray_along_z);
  REQUIRE(hit);
  CHECK(hit->t == 4);
  const auto next = scene.intersect(hit->leave(up));
  REQUIRE(next);
  CHECK(next->t == 2);
  CHECK(next->normal() == up);
  CHECK_FALSE(scene.intersect(next->leave(up)));
}

TEST_CASE("crossings with instances are ordered exactly by the transformed rays") {
  // A sphere and an instance, an ellipsoid, that touch at (0, 0, 1).
  Scene<Sphere, Instance<Sphere>> scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 4}, Color{0.25f});
  scene.add(Instance(Sphere{}, Affine{}.scaled_by({1, 1, 4}).moved_by({0, 0, 5})), Color{0.5f});
  const auto middle = scene.intersect(ray_along_z);
  CHECK(middle->t == 1);
  CHECK(middle->color().r == 0.25f);  // at equal t the surface that comes first
  const double off = 0x1p-20;         // off the axis the sphere is nearer
  CHECK(scene.intersect({{off, 0, 0}, {0, 0, 1}})->color().r == 0.25f);
  CHECK(scene.intersect({{off, 0, 9}, {0, 0, -1}}, everywhere)->color().r == 0.25f);
}

TEST_CASE("every crossing with an instance lies in its bounds, from any distance") {
  Random random(75);
  int hits = 0;
  WrongCases outside(random), loose(random);
  for (int i = 0; i < cases(3'000, 20'000, 20'000); ++i) {
    const Affine placement = any_placement(random, 100);
    const Instance instance(Sphere{}, placement);
    const Bounds box = instance.bounds();
    // From far away t d needs all digits of the ray's numbers.
    const double far = std::exp2(random.real(0, 60));
    const Point origin = far * random.direction();
    const Ray ray{origin, placement.point(1.1 * random.direction()) - origin};
    instance.each_crossing(ray, everywhere, [&](const Crossing& crossing) {
      ++hits;
      const DoubleDouble t = refined(instance.exact_root(ray, crossing));  // relative error 2^-97
      for (int axis = 0; axis < 3; ++axis) {
        const ExactNumber way = (ExactNumber(t.hi) + ExactNumber(t.lo)) * ExactNumber(ray.direction[axis]),
                          x = ExactNumber(ray.origin[axis]) + way,
                          off = ExactNumber(0x1p-97) * (way.sign() < 0 ? -way : way);
        outside.add((x + off - ExactNumber(box.min[axis])).sign() < 0, placement, ray);
        outside.add((ExactNumber(box.max[axis]) - x + off).sign() < 0, placement, ray);
      }
    });
    for (int axis = 0; axis < 3; ++axis) {
      // An ellipsoid extends along an axis by the length of the map's row.
      const double reach = length(Vec3{placement.x[axis], placement.y[axis], placement.z[axis]});
      outside.add(!(box.min[axis] < placement.translation[axis] - reach), placement, ray, reach);
      outside.add(!(box.max[axis] > placement.translation[axis] + reach), placement, ray, reach);
      // They are at most √3 times as large, and a little.
      loose.add(!(box.max[axis] - box.min[axis] < 4 * reach), placement, ray, reach);
    }
  }
  CHECK(hits > cases(1'000, 10'000, 10'000));
  CHECK(outside == 0);
  CHECK(loose == 0);
  CHECK(Instance(Plane{}, {}).bounds().max.x == infinity);
  CHECK(Instance<>(Plane{}, {}).bounds().min.y == -infinity);
}

TEST_CASE(
    "faces of instances and instances of spheres that stay spheres have the departures of the surfaces that "
    "they coincide with") {
  Random random(77);
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    const Affine map = any_placement(random, 100), half{0.5 * map.x, map.y, map.z, map.translation};
    // Two maps with the same image, a longer box, and a board in the bottom face.
    const Instance<Box> box(Box{{0, 0, 0}, {1, 1, 1}}, map), same(Box{{0, 0, 0}, {2, 1, 1}}, half),
        longer(Box{{0, 0, 0}, {2, 1, 1}}, map);
    const Parallelogram board{map.translation, map.x, map.y};
    for (int face = 0; face < 6; ++face) CHECK(box.departure(face) == same.departure(face));
    for (const int face : {0, 2, 3, 4, 5}) CHECK(box.departure(face) == longer.departure(face));
    CHECK(box.departure(1) != longer.departure(1));
    CHECK(box.departure(4) == board.departure());
    CHECK(board.departure() == box.departure(4));

    // A ray upwards from the board does not hit the bottom, however its origin is rounded.
    const Point on = map.translation + random.real(0.1, 0.9) * map.x + random.real(0.1, 0.9) * map.y;
    const Vec3 up = map.z + random.real(-0.01, 0.01) * map.x;
    int crossed = 0;
    box.each_crossing({on, up, board.departure()}, {}, [&](const Crossing& crossing) {
      ++crossed;
      CHECK(crossing.primitive != 4);
    });
    CHECK(crossed == 1);
    CHECK_FALSE(box.intersect({on, -up, board.departure()}));
  }
  const Affine turned{{0, 3, 4}, {5, 0, 0}, {0, 4, -3}, {1, 2, 3}};  // a rotation, scaled by 5
  const Sphere image{.center = {1 + 5, 2 + 3, 3 + 4}, .radius = 10};
  const Instance<> ball(Sphere{.center = {1, 1, 0}, .radius = -2}, turned);
  CHECK(ball.departure() == image.departure());
  const Point side = image.center + Vec3{10, 0, 0};
  CHECK_FALSE(ball.intersect({side, {1, 1, 1}, image.departure()}));
  CHECK(image.intersect({side, {-1, 0, 0}, ball.departure()}) == 20);
}

TEST_CASE("rays that leave solids made of instances with common faces show no acne") {
  // A bar of four tilted boxes, end to end, each an instance of its own.
  Random random(78);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < cases(10, 50, 50); ++i) {
    const Affine map = any_placement(random, 1000);
    std::vector<Csg> cubes;
    for (int k = 0; k < 4; ++k) cubes.push_back(Instance<Box>(Box{{1.0 * k, 0, 0}, {1.0 + k, 1, 1}}, map));
    Scene<AnySurface> scene;
    scene.add(union_of(std::move(cubes)), Color{1});
    const auto tree = accelerate(scene);
    for (int k = 0; k < 100; ++k) {
      const Point eye = map.point(Point{2, 0.5, 0.5} + 5.0 * random.direction()),
                  target = map.point({random.real(0, 4), random.real(0, 1), random.real(0, 1)});
      const auto hit = scene.intersect({eye, target - eye});
      if (!hit) continue;
      ++hits;
      const Ray on = hit->leave(hit->direction()), back = hit->leave(eye - target);
      wrong.add(!scene.intersect(on) || scene.intersect(back).has_value(), map, on);
      wrong.add(!tree.intersect(on) || tree.intersect(back).has_value(), map, on);
      if (const auto out = scene.intersect(on))
        wrong.add(scene.intersect(out->leave(out->direction())).has_value(), map, on);
      int crossed = 0;
      scene.crossings({eye, target - eye}, Interval{}, [&](const Intersection&) { ++crossed; });
      wrong.add(crossed != 2, map, on);
    }
  }
  CHECK(hits > cases(500, 3000, 3000));
  CHECK(wrong == 0);
}

TEST_CASE("an instance of a mesh is as watertight as the mesh, from any distance") {
  Random random(79);
  int met = 0;
  WrongCases slipped(random);
  const Mesh ball(meshes::icosphere(1));
  for (int i = 0; i < cases(25, 100, 500); ++i) {
    const Affine placement = any_placement(random, 100);
    const Instance<Mesh> instance(ball, placement);
    const Point eye = std::exp2(random.real(0, 50)) * random.direction();
    for (int k = 0; k < 20; ++k) {
      // Aims at a vertex, or at the middle between two.
      const auto& vertices = ball.data().vertices;
      const auto vertex = [&] {
        return vertices[static_cast<std::size_t>(random.real(0, static_cast<double>(vertices.size())))];
      };
      const Point one = vertex(), other = k % 2 == 0 ? one : vertex();
      const Ray ray{eye, placement.point(0.5 * one + 0.5 * other) - eye};
      // Checks by exact slopes that crossings alternate between in and out.
      const ExactLine line = AffineInverse(placement).line(exact_line(ray));
      int count = 0, last = 0;
      bool alternates = true;
      instance.each_crossing(ray, everywhere, [&](const Crossing& crossing) {
        const Triangle t = ball.data().triangle(static_cast<std::size_t>(crossing.primitive));
        const int side = triangle_plane_equation(line, t.a, t.b, t.c).slope.sign();
        alternates = alternates && side != 0 && side != last;
        last = side;
        ++count;
      });
      met += count > 0;
      slipped.add(count % 2 != 0 || !alternates, placement, ray);
    }
  }
  CHECK(met > cases(100, 400, 2000));
  CHECK(slipped == 0);
}

TEST_CASE("pictures of instances are the same plain, accelerated and by tiles") {
  Random random(76);
  Scene<AnySurface> scene;
  scene.add(Sphere{.center = {0, -101, 4}, .radius = 100}, Color{0.6f});
  for (int i = 0; i < 12; ++i) {
    const auto place = [&](double size) {
      return Affine{}
          .scaled_by(size * Vec3{random.real(0.5, 1), random.real(0.5, 1), random.real(0.5, 1)})
          .rotated_about(random.direction(), random.real(0, 360))
          .moved_by(Vec3{0, 0, 5} + random.point(2.5));
    };
    scene.add(Instance(Sphere{}, place(0.5)), random.color());
    scene.add(Instance<>(TwoPlates{}, place(0.6)),
              Material{.texture = Checker{.first = random.color(), .second = random.color(), .size = 0.3}});
    scene.add(Instance<>(Parallelogram{}, place(0.7)), random.color());
  }
  scene.add(Instance<>(Plane{}, Affine{}.rotated_about({1, 0, 0}, 80).moved_by({0, 0, 9})), Color{0.5f});
  scene.add(PointLight{.position = {3, 5, 0}, .power = Color{800}});
  const DrawnAlike drawn = drawn_alike(scene, Camera{}, ShadowIntegrator{});
  CHECK(drawn.lit > 1000);
  CHECK(drawn.different == 0);
}

TEST_CASE("an invalid instance is refused") {
  const auto says = [](const auto& instance) {
    return message_of<std::invalid_argument>([&] { instance.validate(); });
  };
  CHECK_THAT(says(Instance(Sphere{}, Affine{}.scaled_by({1, 0, 1}))),
             ContainsSubstring("to a plane or less"));
  CHECK_THAT(says(Instance(Sphere{}, Affine{}.moved_by({0, infinity, 0}))), ContainsSubstring("Instance"));
  CHECK_THAT(says(Instance(Sphere{.radius = 0}, {})), ContainsSubstring("Sphere: radius"));
  CHECK_THAT(says(Instance<>(Sphere{.radius = 0}, {})), ContainsSubstring("Sphere: radius"));
  CHECK_THAT(says(Instance(Sphere{}, Affine{}.scaled_by({1, 1, 1e-121}))),
             ContainsSubstring("the numbers of the inverse of the map must be at most 2^400"));
  const std::string of_map = "the numbers of the map must be at most 2^400";
  CHECK_THAT(says(Instance(Sphere{}, Affine{}.scaled_by({1, 1, 1e121}))), ContainsSubstring(of_map));
  CHECK_THAT(says(Instance(Sphere{}, Affine{}.moved_by({0, -1e121, 0}))), ContainsSubstring(of_map));
  CHECK_NOTHROW(Instance(Sphere{}, Affine{}.scaled_by({1, 0x1p400, 1}).moved_by({0x1p400, 0, 0})).validate());
  CHECK_NOTHROW(Instance<>(Sphere{}, Affine{}.scaled_by({-1, 2, 1e-9})).validate());
}

TEST_CASE("an instance of a solid is a solid") {
  CHECK(is_solid(Instance(Sphere{}, {})));
  CHECK(is_solid(Instance<>(Sphere{}, {})));
  CHECK_FALSE(is_solid(Instance(Plane{}, {})));
  CHECK_FALSE(is_solid(Instance<>(Parallelogram{}, {})));
  CHECK_FALSE(ends_inside(Instance(Sphere{}, {}), ray_along_z));
}

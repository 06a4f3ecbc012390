#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <stdexcept>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {}  // namespace

TEST_CASE("a disk is the set of points of a plane at most radius away from its position") {
  const Disk disk{.position = {1, 1, 3}, .normal = {0, 0, 2}, .radius = 5};
  const Disk oblique{.position = {0, 0, 3}, .normal = {0, 3, -4}, .radius = 5};  // ends: ±(0, 4, 3), ±5x
  const auto along_z = [](double x, double y) { return Ray{{x, y, 0}, {0, 0, 1}}; };
  struct {
    const char* what;
    Disk disk;
    Ray ray;
    Interval range;
    std::optional<double> expected;
  } const rows[] = {
      {"through the middle", disk, along_z(1, 1), {}, 3},
      {"t in halves", disk, {{2, 2, 0}, {0, 0, 0.5}}, {}, 6},
      {"from behind", disk, {{2, 2, 5}, {0, 0, -1}}, {}, 2},
      {"away from it", disk, {{2, 2, 5}, {0, 0, 1}}, {}, std::nullopt},
      {"away from it, in a range that reaches back", disk, {{2, 2, 5}, {0, 0, 1}}, everywhere, -2},
      {"at the end of the range", disk, along_z(2, 2), {0, 3}, std::nullopt},
      {"beside it", disk, along_z(7, 2), {}, std::nullopt},
      {"in the corner of its box", disk, along_z(5, 5), {}, std::nullopt},
      {"its outline along x", disk, along_z(6, 1), {}, 3},
      {"its outline along y", disk, along_z(1, -4), {}, 3},
      {"its outline between them", disk, along_z(4, 5), {}, 3},
      {"next to it", disk, along_z(4 + 4 * ulp, 5), {}, std::nullopt},
      {"next to it, inside", disk, along_z(4 - 2 * ulp, 5), {}, 3},
      {"parallel", disk, {{2, 2, 0}, {1, 1, 0}}, everywhere, std::nullopt},
      {"in its plane", disk, {{0, 2, 3}, {1, 0, 0}}, everywhere, std::nullopt},
      {"all but parallel", {{1, 1, 0}, {0, 0, 2}, 5}, {{0, 1, -0x1p-60}, {1, 0, 0x1p-60}}, {}, 1},
      {"starting on it", disk, {{2, 2, 3}, {0, 0, 1}}, everywhere, 0},
      {"starting on its outline", disk, {{4, 5, 3}, {0, 0, 1}}, everywhere, 0},
      {"starting in its plane, outside", disk, {{5, 5, 3}, {0, 0, 1}}, everywhere, std::nullopt},
      {"oblique", oblique, along_z(0, 2), {}, 4.5},
      {"oblique, its outline", oblique, along_z(0, 4), {}, 6},
      {"oblique, its outline along x", oblique, along_z(-5, 0), {}, 3},
      {"oblique, its outline between them", oblique, {{4, 0, 0}, {0, 2.4, 4.8}}, {}, 1},
      {"oblique, next to it", oblique, along_z(0, 4 + 4 * ulp), {}, std::nullopt},
      {"turned around", {{1, 1, 3}, {0, 0, -1}, 5}, along_z(4, 5), {}, 3},
      {"no normal", {{1, 1, 3}, {0, 0, 0}, 5}, along_z(1, 1), everywhere, std::nullopt},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK(row.disk.intersect(row.ray, row.range) == row.expected);
  }
}

TEST_CASE("whether a ray hits a disk of whole numbers, its outline included, is exact") {
  // All products are whole numbers that double holds.
  Random random(41);
  fallbacks = {};
  int hits = 0, outline = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 50000; ++i) {
    const Disk disk{random.whole_vector(3), random.whole_vector(3),
                    static_cast<double>(1 + random.bits() % 5)};
    const Ray ray{random.whole_vector(3), random.whole_vector(3)};
    // Lengths are times slope: the crossing is at slope · origin + height · direction.
    const double slope = dot(disk.normal, ray.direction),
                 height = dot(disk.normal, disk.position - ray.origin);
    const Vec3 from_center = slope * (ray.origin - disk.position) + height * ray.direction;
    const double beyond = dot(from_center, from_center) - disk.radius * disk.radius * slope * slope;
    const bool expected = slope != 0 && beyond <= 0;
    const auto t = disk.intersect(ray, everywhere);
    hits += expected;
    outline += expected && beyond == 0;
    wrong.add(t.has_value() != expected, disk, ray);
    if (t && expected) wrong.add(*t != height / slope, disk, ray, slope);
  }
  CHECK(hits > 10000);
  CHECK(outline > 250);
  CHECK(fallbacks.exact > 250);
  CHECK(wrong == 0);
}

TEST_CASE(
    "whether a ray hits or misses the outline of a disk is decided exactly, also where double cannot tell") {
  // Points (3k, −4k) of a circle with radius 5k, from all sides: a shift by 2^-44, inwards or outwards, makes
  // a difference.
  Random random(42);
  int in_doubt = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 3000; ++i) {
    const double k = static_cast<double>(1 + random.bits() % 9), off = static_cast<double>(random.whole(1));
    const Disk disk{.position = random.whole_vector(99), .normal = {0, 0, 3}, .radius = 5 * k};
    const Point target = disk.position + Vec3{3 * k + off * 0x1p-44, -4 * k, 0};
    const Point above = Vec3{random.whole(99), random.whole(99), 1 + random.bits() % 9};
    fallbacks = {};
    const auto t = disk.intersect({target + above, -above});
    in_doubt += fallbacks.exact > 0;
    wrong.add(t.has_value() != (off <= 0), disk);
    wrong.add(t && *t != 1, disk);
  }
  CHECK(wrong == 0);
  CHECK(in_doubt > 2500);
}

TEST_CASE("a hit lies on the disk") {
  Random random(43);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Disk disk{random.point(3), std::exp(random.real(-9, 9)) * random.direction(), random.real(1, 3)};
    const Ray ray{random.point(5), std::exp(random.real(-3, 3)) * random.direction()};
    const auto t = disk.intersect(ray);
    if (!t) continue;
    ++hits;
    const Vec3 from_center = ray.at(*t) - disk.position, n = disk.normal_at(ray.at(*t));
    wrong.add(
        !(std::abs(length(n) - 1) < 4 * ulp && length(cross(n, disk.normal)) < 4 * ulp * length(disk.normal)),
        disk, ray);
    const double allowed = 0x1p-30 * length(ray.direction) * *t + 64 * ulp;
    wrong.add(!(std::abs(dot(n, from_center)) < allowed && length(from_center) < disk.radius + allowed), disk,
              ray, from_center, allowed);
  }
  CHECK(hits > 500);
  CHECK(wrong == 0);
}

TEST_CASE("huge and tiny disks are hit like others, and numbers that are not finite give no hit") {
  for (const double size : {0x1p-900, 0x1p-400, 0x1p-30, 1.0, 0x1p30, 0x1p400, 0x1p900})
    for (const double tilt : {0x1p-900, 1.0, 0x1p900}) {
      CAPTURE(size, tilt);
      const Disk disk{size * Point{1, 1, 3}, tilt * Vec3{0, 3, 4}, 5 * size};
      for (const double length : {0x1p-60, 1.0, 0x1p60}) {
        CHECK(disk.intersect({Point{0}, length * Vec3{1, 1, 3}}) == size / length);
        CHECK(disk.intersect({Point{0}, length * Vec3{6, 1, 3}}) == size / length);  // its outline
        CHECK_FALSE(disk.intersect({Point{0}, length * Vec3{6 + 4 * ulp, 1, 3}}));
      }
    }
  const Disk sound{.position = {0, 0, 3}};
  const Ray ray;
  REQUIRE(sound.intersect(ray));
  CHECK_FALSE(sound.intersect({{0, 0, 0}, {0, 0, 0}}, everywhere));
  for (const double bad : {infinity, -infinity, not_a_number}) {
    Disk radius = sound;
    radius.radius = bad;
    CHECK_FALSE(radius.intersect(ray, everywhere));
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(bad, axis);
      Ray origin = ray, direction = ray;
      origin.origin[axis] = bad, direction.direction[axis] = bad;
      CHECK_FALSE(sound.intersect(origin, everywhere));
      CHECK_FALSE(sound.intersect(direction, everywhere));
      Disk position = sound, normal = sound;
      position.position[axis] = bad, normal.normal[axis] = bad;
      CHECK_FALSE(position.intersect(ray, everywhere));
      CHECK_FALSE(normal.intersect(ray, everywhere));
    }
  }
}

TEST_CASE("u and v of a disk are those of its plane, measured from its position") {
  Random random(44);
  WrongCases wrong(random);
  for (int i = 0; i < 1000; ++i) {
    const Disk disk{random.point(3), random.direction(), 2};
    const Point p = disk.position + random.point(1);
    const Uv from_origin = Plane{disk.normal, 0}.uv_at(p - disk.position);
    wrong.add(!(length(Vec3(disk.uv_at(p) - from_origin, 0)) < 8 * ulp), disk, p, from_origin);
  }
  CHECK(wrong == 0);
  const Disk floor{.position = {1, 2, 3}, .normal = {0, 7, 0}};
  CHECK(floor.uv_at({2, 2, 5}) == Plane{{0, 1, 0}, 0}.uv_at({1, 0, 2}));
  CHECK(floor.uv_at(floor.position) == Uv{0, 0});
}

TEST_CASE("the bounds of a disk contain its outline, and are tight") {
  Random random(45);
  WrongCases outside(random), loose(random);
  for (int i = 0; i < 2000; ++i) {
    const Disk disk{random.point(1e3), i % 5 == 0 ? random.whole_vector(1) : random.direction(),
                    random.real(0, 9)};
    if (disk.normal == Vec3{0}) continue;
    const auto [min, max] = disk.bounds();
    const Vec3 n = disk.normal_at({});
    for (int axis = 0; axis < 3; ++axis) {
      // The point of the outline that lies farthest along the axis.
      Vec3 along{0};
      along[axis] = 1;
      const double reach = disk.radius * length(cross(cross(n, along), n));
      const double rounding = 8 * ulp * (1e3 + reach);
      outside.add(!(max[axis] - disk.position[axis] >= reach - rounding &&
                    disk.position[axis] - min[axis] >= reach - rounding),
                  disk, reach, rounding);
      loose.add(!(max[axis] - disk.position[axis] <= reach + rounding &&
                  disk.position[axis] - min[axis] <= reach + rounding),
                disk, reach, rounding);
    }
  }
  CHECK(outside == 0);
  CHECK(loose == 0);
  const Disk turned{.normal = {1e-200, 0, 1}};
  CHECK(turned.bounds().max.z >= 1e-200);
}

TEST_CASE("disks in one plane have equal departures, as do the plane and a parallelogram in it") {
  Random random(46);
  int tilted = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 u = random.whole_vector(9), v = random.whole_vector(9), n = cross(u, v);
    if (n == Vec3{0}) continue;
    const Point p = random.whole_vector(99);
    const double k = static_cast<double>(random.whole(3)), l = static_cast<double>(random.whole(3));
    const Disk one{p, 3.0 * n, 2}, other{p + k * u + l * v, -n, 1};
    const Plane plane{n, dot(n, p)};
    const Parallelogram board{p, u, v};
    tilted += one.departure().kind == Departure::Kind::rounded_plane;
    for (const Departure& departure : {other.departure(), plane.departure(), board.departure()}) {
      wrong.add(one.departure() != departure, one, plane, board);
      wrong.add(one.intersect({p, random.direction(), departure}, everywhere).has_value(), one, plane, board,
                p);
    }
    wrong.add(plane.intersect({p, random.direction(), one.departure()}, everywhere).has_value(), one, plane,
              board, p);
    wrong.add(board.intersect({p, random.direction(), one.departure()}, everywhere).has_value(), one, plane,
              board, p);
    const Disk apart{p + 0.25 * n, n, 2};
    wrong.add(apart.departure() == one.departure(), one, plane, board, apart);
    wrong.add(!apart.intersect({p, n, one.departure()}), one, plane, board, apart, p);
  }
  CHECK(tilted > 2000);
  CHECK(wrong == 0);

  const Disk level{.position = {3, 0.1, 4}, .normal = {0, 0.3, 0}};
  CHECK(level.departure() == Plane{{0, 1, 0}, 0.1}.departure());
  CHECK(level.departure() != Plane{{0, 1, 0}, 0.1 + ulp / 8}.departure());
  for (const double off : {-4 * ulp, 4 * ulp}) {
    const Disk tilted_one{.position = {1, 0, 2}, .normal = {1, 2, 3}};
    Disk moved = tilted_one, turned = tilted_one;
    moved.position.z += off, turned.normal.y += off;
    CHECK(moved.departure() != tilted_one.departure());
    CHECK(turned.departure() != tilted_one.departure());
    CHECK(moved.intersect({Point{1, 0, 2} - Vec3{1, 2, 3}, {1, 2, 3}, tilted_one.departure()}));
  }
}

TEST_CASE("a ray that leaves a disk never hits it again") {
  Random random(47);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Disk disk{random.point(2), random.direction(), 3};
    const Ray ray{random.point(5), random.direction()};
    const auto t = disk.intersect(ray);
    if (!t) continue;
    ++hits;
    wrong.add(disk.intersect({ray.at(*t), random.direction(), disk.departure()}, everywhere).has_value(),
              disk, ray);
  }
  CHECK(hits > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("pictures of disks are the same plain, accelerated and by tiles, and show no acne on a floor") {
  Random random(48);
  const Camera camera{.position = {0, 1.5, -4}};
  const Point light{3, 6, -3};
  Scene<Disk, AnySurface> scene;
  const Material tiled{.texture = Checker{.size = 0.25}, .reflect = 0.25};
  scene.add(AnySurface(Plane{{0, 1, 0}, -1}), tiled);
  for (int i = 0; i < 30; ++i) {  // more of one type than a tree node has children
    const Point center{random.real(-4, 3), random.real(-1, 2), random.real(-1, 7)};
    const Disk disk{center, random.direction(), random.real(0.2, 1)};
    if (i % 3 == 0) scene.add(disk, tiled);
    if (i % 3 == 1) scene.add(AnySurface(disk), Color{0.5f});
    if (i % 3 == 2) scene.add(Disk{{center.x, -1, center.z}, {0, 2, 0}, disk.radius}, Color{0.5f});
  }
  scene.add(PointLight{.position = light, .power = Color{1000}});
  const DrawnAlike drawn = drawn_alike(scene, camera);
  CHECK(drawn.lit > 500);
  CHECK(drawn.different == 0);

  int lit = 0;
  WrongCases acne(random);
  for (int i = 0; i < 64 * 48; ++i) {
    const auto hit = scene.intersect(camera.through_pixel(i % 64, i / 64, 64, 48));
    if (!hit) continue;
    ++lit;
    const Ray to_light = hit->leave(light - hit->point());
    if (const auto shadow = scene.intersect(to_light, {0, 1}))
      acne.add(shadow->t < 0x1p-7, to_light);  // nothing else is so near
  }
  CHECK(lit > 1000);
  CHECK(acne == 0);
}

TEST_CASE("an invalid disk is refused with the field's name") {
  const auto says = [](const Disk& disk) {
    return message_of<std::invalid_argument>([&] { disk.validate(); });
  };
  for (const Vec3& bad : {Vec3{0, not_a_number, 0}, Vec3{0, infinity, 0}, Vec3{-infinity, 1, 0}}) {
    CHECK_THAT(says({.position = bad}), ContainsSubstring("Disk: position"));
    CHECK_THAT(says({.normal = bad}), ContainsSubstring("Disk: normal"));
  }
  CHECK_THAT(says({.normal = Vec3{0}}), ContainsSubstring("Disk: normal"));
  CHECK_THAT(says({.position = {0, 1e121, 0}}), ContainsSubstring("Disk: position"));
  for (const double bad : {0.0, -1.0, 1e-121, 1e121, infinity, not_a_number})
    CHECK_THAT(says({.radius = bad}), ContainsSubstring("Disk: radius"));
  CHECK_NOTHROW(Disk{}.validate());
}

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/integrators/normal.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <stdexcept>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

Box box_around(const Point& a, const Point& b) { return {glm::min(a, b), glm::max(a, b)}; }

std::vector<Crossing> crossings(const Box& box, const Ray& ray, Interval range = everywhere) {
  std::vector<Crossing> all;
  box.each_crossing(ray, range, [&](const Crossing& crossing) { all.push_back(crossing); });
  return all;
}

__extension__ using Int128 = __int128;

/// A quotient of whole numbers, with a divisor above 0.
struct Quotient {
  Int128 over, under;
  [[nodiscard]] bool operator<(const Quotient& other) const {
    return over * other.under < other.over * under;
  }
  [[nodiscard]] bool operator==(const Quotient& other) const {
    return over * other.under == other.over * under;
  }
  [[nodiscard]] double rounded() const { return static_cast<double>(over) / static_cast<double>(under); }
};

struct Judged {
  Quotient t;
  int face;
};

/// Computes the crossings in another way than the library. Among the places where the line crosses the plane
/// of a face and is in the box, these are the first and the last, each with the lowest of the faces through
/// which the line enters, or leaves, there. Lengths are multiples of a unit.
std::vector<Judged> judge(const Box& box, const Ray& ray, double unit = 1) {
  const auto number = [&](double x) { return static_cast<Int128>(x / unit); };
  std::vector<Judged> places;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const auto d = static_cast<Int128>(ray.direction[axis]);
    const Int128 height = number(face % 2 ? box.max[axis] : box.min[axis]) - number(ray.origin[axis]);
    if (d == 0) continue;
    const Quotient t{d < 0 ? -height : height, d < 0 ? -d : d};
    bool is_inside = true;
    for (int i = 0; i < 3; ++i) {
      const Int128 x = number(ray.origin[i]) * t.under + static_cast<Int128>(ray.direction[i]) * t.over;
      is_inside = is_inside && number(box.min[i]) * t.under <= x && x <= number(box.max[i]) * t.under;
    }
    if (is_inside) places.push_back({t, face});
  }
  if (places.empty()) return {};
  const auto [first, last] = std::minmax_element(places.begin(), places.end(),
                                                 [](const auto& a, const auto& b) { return a.t < b.t; });
  const auto lowest_at = [&](const Quotient& t, bool enters) {
    return *std::find_if(places.begin(), places.end(), [&](const Judged& place) {
      return place.t == t && (ray.direction[place.face / 2] > 0) == ((place.face % 2 == 0) == enters);
    });
  };
  return {lowest_at(first->t, true), lowest_at(last->t, false)};
}

}  // namespace

TEST_CASE("a box is the set of points from min to max, boundary included") {
  const Box box{.min = {1, 1, 3}, .max = {3, 3, 4}};
  const auto along_z = [](double x, double y) { return Ray{{x, y, 0}, {0, 0, 1}}; };
  struct {
    const char* what;
    Box box;
    Ray ray;
    Interval range;
    std::optional<double> expected;
    int face = 4;
  } const rows[] = {
      {"into it", box, along_z(2, 2), {}, 3},
      {"t in halves", box, {{2, 2, 0}, {0, 0, 0.5}}, {}, 6},
      {"from behind", box, {{2, 2, 6}, {0, 0, -1}}, {}, 2, 5},
      {"along x", box, {{0, 2, 3.5}, {1, 0, 0}}, {}, 1, 0},
      {"along x, from the other side", box, {{4, 2, 3.5}, {-1, 0, 0}}, {}, 1, 1},
      {"along y", box, {{2, 0, 3.5}, {0, 1, 0}}, {}, 1, 2},
      {"along y, from the other side", box, {{2, 4, 3.5}, {0, -1, 0}}, {}, 1, 3},
      {"from inside", box, {{2, 2, 3.25}, {0, 0, 1}}, {}, 0.75, 5},
      {"from inside, by a range behind the near face", box, along_z(2, 2), {3.5, 9}, 4, 5},
      {"in a range between the faces", box, along_z(2, 2), {3, 4}, std::nullopt},
      {"away from it", box, {{2, 2, 5}, {0, 0, 1}}, {}, std::nullopt},
      {"away from it, in a range that reaches back", box, {{2, 2, 5}, {0, 0, 1}}, everywhere, -2},
      {"beside it", box, along_z(4, 2), {}, std::nullopt},
      {"on the other side", box, along_z(0, 2), {}, std::nullopt},
      {"above it", box, along_z(2, 4), {}, std::nullopt},
      {"along a face", box, along_z(1, 2), {}, 3},
      {"along the opposite face", box, along_z(3, 2), {}, 3},
      {"next to it", box, along_z(1 - ulp / 2, 2), {}, std::nullopt},
      {"next to the opposite one", box, along_z(3 + 2 * ulp, 2), {}, std::nullopt},
      {"along an edge", box, along_z(1, 3), {}, 3},
      {"touching an edge", box, {{0, 2, 2}, {1, 0, 1}}, {}, 1, 0},
      {"touching the opposite edge", box, {{2, 2, 5}, {1, 0, -1}}, {}, 1, 5},
      {"passing an edge", box, {{0, 2, 2}, {1, 0, 1 - ulp}}, {}, 1 + ulp},
      {"missing an edge", box, {{4, 2, 2}, {-1, 0, 3}}, {}, std::nullopt},
      {"through an edge into it", box, {{0, 2, 2}, {1, 0, 1 + ulp}}, {}, 1, 0},
      {"touching a vertex", box, {{2, 2, 2}, {-1, -1, 1}}, {}, 1},
      {"through a vertex", box, {{0, 0, 2}, {1, 1, 1}}, {}, 1, 0},
      {"flat, across", {{1, 1, 3}, {3, 3, 3}}, along_z(2, 2), {}, 3},
      {"flat, along", {{1, 1, 3}, {3, 3, 3}}, {{0, 2, 3}, {1, 0, 0}}, {}, 1, 0},
      {"a point", {{1, 1, 3}, {1, 1, 3}}, {{0, 0, 2}, {1, 1, 1}}, {}, 1, 0},
      {"beside a point", {{1, 1, 3}, {1, 1, 3}}, {{0, 0, 2}, {1, 1, 1 + ulp}}, {}, std::nullopt},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    const auto crossing = row.box.first_crossing(row.ray, row.range);
    CHECK(row.box.intersect(row.ray, row.range) == row.expected);
    if (crossing && row.expected) CHECK(crossing->primitive == row.face);
  }
}

TEST_CASE("t and the face where a ray enters or leaves a box of small whole numbers are exact") {
  Random random(31);
  int hits = 0, touching = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 50000; ++i) {
    const Box box = box_around(random.whole_vector(3), random.whole_vector(3));
    const Ray ray{random.whole_vector(4), random.whole_vector(3)};
    const auto expected = judge(box, ray);
    const auto found = crossings(box, ray);
    wrong.add(found.size() != expected.size(), box, ray);
    if (found.size() != 2 || expected.size() != 2) continue;
    ++hits;
    touching += expected[0].t == expected[1].t;
    for (std::size_t end = 0; end < 2; ++end) {
      wrong.add(found[end].primitive != expected[end].face, box, ray);
      wrong.add(found[end].t != expected[end].t.rounded(), box, ray);
    }
  }
  CHECK(hits > 5000);
  CHECK(touching > 1000);
  CHECK(wrong == 0);
}

TEST_CASE(
    "whether a ray hits or misses the edge of a box is decided exactly, also where double cannot tell") {
  // The line passes next to the middle at t = T, a number of 52 bits: differences have up to 101 bits.
  Random random(32);
  const double unit = 0x1p-40;
  fallbacks = {};
  int hits = 0, misses = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 direction = random.whole_vector(1 << 9);
    const std::int64_t T = random.whole(std::int64_t{1} << 52);
    const Point origin = -static_cast<double>(T) * direction;
    Point middle;
    for (int axis = 0; axis < 3; ++axis)
      middle[axis] = static_cast<double>(Int128{T} * static_cast<Int128>(direction[axis]) +
                                         static_cast<Int128>(origin[axis]));
    const Ray ray{origin, direction};
    const Box box = box_around(middle + unit * random.whole_vector(2),
                               middle + unit * random.whole_vector(2) + Vec3(random.bits() % 4 == 0 ? 1 : 0));
    const auto expected = judge(box, ray, unit);
    const auto found = crossings(box, ray);
    ++(expected.empty() ? misses : hits);
    wrong.add(found.size() != expected.size(), box, ray);
    if (found.size() != expected.size()) continue;
    for (std::size_t end = 0; end < found.size(); ++end)
      wrong.add(found[end].primitive != expected[end].face, box, ray);
  }
  CHECK(hits > 1000);
  CHECK(misses > 1000);
  CHECK(fallbacks.exact > 4000);
  CHECK(wrong == 0);
}

TEST_CASE("a hit on a box lies on the face that it names, which the ray enters or leaves through") {
  Random random(33);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Box box = box_around(random.point(3), random.point(3));
    const Ray ray{random.point(5), std::exp(random.real(-3, 3)) * random.direction()};
    const auto found = crossings(box, ray);
    if (found.empty()) continue;
    ++hits;
    const auto [entry, exit] = std::pair{found.at(0), found.at(1)};
    wrong.add(!(entry.t <= exit.t), box, ray);
    wrong.add(!(dot(box.normal_at({}, entry.primitive), ray.direction) < 0), box, ray);
    wrong.add(!(dot(box.normal_at({}, exit.primitive), ray.direction) > 0), box, ray);
    for (const Crossing& crossing : found) {
      const Point point = ray.at(crossing.t);
      const int axis = crossing.primitive / 2;
      wrong.add(!(std::abs(point[axis] - (crossing.primitive % 2 ? box.max : box.min)[axis]) < 16 * ulp), box,
                ray, point);
      for (int other = 0; other < 3; ++other)
        wrong.add(!(box.min[other] - 16 * ulp < point[other] && point[other] < box.max[other] + 16 * ulp),
                  box, ray, point);
    }
  }
  CHECK(hits > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("huge and tiny boxes are hit like others, and numbers that are not finite give no hit") {
  for (const double size : {0x1p-900, 0x1p-400, 0x1p-30, 1.0, 0x1p30, 0x1p400, 0x1p900}) {
    CAPTURE(size);
    const Box box{size * Point{1, 1, 3}, size * Point{2, 3, 4}};
    for (const double length : {0x1p-60, 1.0, 0x1p60}) {
      CHECK(box.intersect({Point{0}, length * Vec3{1, 2, 3}}) == size / length);  // an edge
      CHECK(box.intersect({Point{0}, length * Vec3{1.5, 2, 3}}) == size / length);
      CHECK_FALSE(box.intersect({Point{0}, length * Vec3{1, 2, 3} * Vec3{1 - ulp, 1, 1.5}}));
    }
  }
  const Box slab{{-1e300, -1, -1e300}, {1e300, 1, 1e300}};
  CHECK(slab.intersect({{0, 3, 0}, {1, -2, 1}}) == 1);
  CHECK(slab.intersect({{0, 0, 0}, {1e-300, -1e-301, 0}}) == 1 / 1e-301);
  CHECK(Box{{1e308, -1, -1}, {1.5e308, 1, 1}}.intersect({{-1e308, 0, 0}, {1e308, 0, 0}}) == 2);

  const Box sound;
  const Ray ray{{0, 0, -3}, {0.125, 0.125, 1}};
  REQUIRE(sound.intersect(ray));
  CHECK_FALSE(sound.intersect({{0, 0, -3}, {0, 0, 0}}, everywhere));
  CHECK_FALSE(sound.intersect({{0, 0, 0}, {0, 0, 0}}, everywhere));
  for (const double bad : {infinity, -infinity, not_a_number})
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(bad, axis);
      for (Ray other : {ray, Ray{{0, 0, -3}, {0, 0, 1}}}) {
        Box min = sound, max = sound;
        min.min[axis] = bad, max.max[axis] = bad;
        CHECK_FALSE(min.intersect(other, everywhere));
        CHECK_FALSE(max.intersect(other, everywhere));
        Ray origin = other, direction = other;
        origin.origin[axis] = bad, direction.direction[axis] = bad;
        CHECK_FALSE(sound.intersect(origin, everywhere));
        CHECK_FALSE(sound.intersect(direction, everywhere));
      }
    }
}

TEST_CASE("each face of a box has its normal, its plane and its u and v along the next two axes, from min") {
  const Box box{.min = {1, 2, 3}, .max = {5, 7, 9}};
  const Point p{2, 4, 8};
  struct {
    Vec3 normal;
    Uv uv;
    Plane plane;
  } const faces[] = {{{-1, 0, 0}, {2, 5}, {{1, 0, 0}, 1}}, {{1, 0, 0}, {2, 5}, {{1, 0, 0}, 5}},
                     {{0, -1, 0}, {5, 1}, {{0, 1, 0}, 2}}, {{0, 1, 0}, {5, 1}, {{0, 1, 0}, 7}},
                     {{0, 0, -1}, {1, 2}, {{0, 0, 1}, 3}}, {{0, 0, 1}, {1, 2}, {{0, 0, 1}, 9}}};
  for (int face = 0; face < 6; ++face) {
    CAPTURE(face);
    CHECK(box.normal_at(p, face) == faces[face].normal);
    CHECK(box.uv_at(p, face) == faces[face].uv);
    CHECK(box.departure(face) == faces[face].plane.departure());
  }
  const double near =
      0x1p-19 * std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
  for (int axis = 0; axis < 3; ++axis) {
    CHECK((box.min[axis] - near < box.bounds().min[axis] && box.bounds().min[axis] < box.min[axis]));
    CHECK((box.max[axis] < box.bounds().max[axis] && box.bounds().max[axis] < box.max[axis] + near));
  }
}

TEST_CASE("a ray that leaves a face inwards at a grazing angle hits the other end of the box") {
  const Box box;
  Scene<Box> scene;
  scene.add(box, Color{1});
  const auto hit = scene.intersect({{0, 2.5, 0}, {0, -5.875, 0}});
  REQUIRE(hit);
  for (const double down : {1.0, 0x1p-53, 0x1p-60, 0x1p-1000}) {
    CAPTURE(down);
    const auto out = scene.intersect(hit->leave({1, -down, 0}));
    REQUIRE(out);
    CHECK(out->t == 1);
    CHECK_FALSE(scene.intersect(hit->leave({1, down, 0})));
  }
}

TEST_CASE(
    "a ray that leaves a face inwards hits the box once, also next to an edge and far from the coordinate "
    "origin") {
  Random random(38);
  int inwards = 0;
  WrongCases missed(random);
  for (const double far : {0.0, 1.0, 1e6, 1e14}) {
    Scene<Box> scene;
    scene.add(Box{{far - 1, -far - 1, -1}, {far + 1, -far + 1, 1}}, Color{1});
    const auto tree = accelerate(scene);
    for (int i = 0; i < 20000; ++i) {
      const Point middle{far, -far, 0};
      Point target = middle + random.point(1);
      if (i % 2 == 0) target[i / 2 % 3] = std::round(target[i / 2 % 3]) + random.real(-1, 1) * 0x1p-50;
      const Point eye = middle + random.point(4);
      const Ray ray{eye, target - eye};
      const auto hit = scene.intersect(ray);
      if (!hit) continue;
      const Vec3 direction = random.direction();
      const Ray left = hit->leave(direction);
      const bool is_inwards = dot(hit->normal(), direction) < 0;
      inwards += is_inwards;
      missed.add(scene.intersect(left).has_value() != is_inwards, ray, left);
      missed.add(tree.intersect(left).has_value() != is_inwards, ray, left);
      missed.add(tree.occluded(left) != is_inwards, ray, left);
    }
  }
  CHECK(inwards > 10000);
  CHECK(missed == 0);
}

TEST_CASE("a ray that leaves a box hits it again only if it leads inwards, and then at another face") {
  Random random(34);
  int inwards = 0, outwards = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Point far = random.point(i % 2 ? 1 : 1e6);
    const Box box = box_around(far + random.point(3), far + random.point(3));
    const Point inside = 0.5 * (box.min + box.max), origin = far + random.point(10);
    const Ray ray{origin, inside - origin};
    for (const Crossing& crossing : crossings(box, ray)) {
      const Ray left{ray.at(crossing.t), random.direction(), box.departure(crossing.primitive)};
      const auto ahead = crossings(box, left, {});
      const bool is_inwards = dot(left.direction, box.normal_at({}, crossing.primitive)) < 0;
      ++(is_inwards ? inwards : outwards);
      wrong.add(ahead.size() != (is_inwards ? 1 : 0), box, ray, left);
      // Except for the face that is left, crossings are those of a ray without a departure.
      if (ahead.size() == 1)
        wrong.add(ahead[0].primitive == crossing.primitive ||
                      ahead[0].t != crossings(box, {left.origin, left.direction}).back().t,
                  box, ray, left);
    }
  }
  CHECK(inwards > 10000);
  CHECK(outwards > 10000);
  CHECK(wrong == 0);
}

TEST_CASE(
    "a ray that leaves a floor, a board or another box does not hit a face of a box in the same plane") {
  const Box box{.min = {-1, 0, -1}, .max = {1, 1, 1}};
  const Departure floor = Plane{{0, -2, 0}, 0}.departure(),
                  board = Parallelogram{{3, 0, 0}, {1, 0, 0}, {0, 0, 1}}.departure(),
                  below = Box{{0, -1, 0}, {9, 0, 9}}.departure(3);
  for (const Departure& departure : {floor, board, below}) {
    // The origins are a little above or below the plane, as rounding leaves them.
    for (const double off : {-1e-17, 0.0, 1e-17}) {
      CHECK(crossings(box, {{0, off, 0}, {0.1, 1, 0}, departure}, {}).size() == 1);
      CHECK(crossings(box, {{0, off, 0}, {0.1, 1, 0}, departure}, {})[0].primitive == 3);
      CHECK(crossings(box, {{0, off, 0}, {0.1, -1, 0}, departure}).empty());
      CHECK(crossings(box, {{0, off, 0}, {1, 0, 0}, departure}).empty());
      CHECK(crossings(box, {{-3, off, 0}, {1, 0, 0}, departure}).empty());
      const auto beside = crossings(box, {{-3, off, 0}, {4, 1, 0}, departure}, {});
      REQUIRE(beside.size() == 2);
      CHECK(beside[0].primitive == 0);
    }
  }
  // By its departure the origin is in the floor, and by its coordinates beside the box; from there the ray
  // rises into the box through a side face.
  const auto through_side = crossings(box, {{-1 - ulp, -ulp, 0}, {1, 1, 0}, floor}, {});
  REQUIRE(through_side.size() == 2);
  CHECK(through_side[0].primitive == 0);
  const Departure other = Plane{{0, 1, 0}, 0x1p-60}.departure();
  CHECK(crossings(box, {{0, -1e-17, 0}, {0.1, 1, 0}, other}, {}).size() == 2);
  // Both faces of a flat box lie in the plane of the floor.
  const Box flat{.min = {-1, 0, -1}, .max = {1, 0, 1}};
  for (const double off : {-1e-17, 1e-17})
    for (const double up : {-1.0, 1.0}) CHECK(crossings(flat, {{0, off, 0}, {0.1, up, 0}, floor}).empty());
}

TEST_CASE("pictures of boxes are the same plain, accelerated and by tiles, and show no acne on a floor") {
  Random random(35);
  const Camera camera{.position = {0, 1.5, -4}};
  Scene<Box, AnySurface> scene;
  scene.add(AnySurface(Plane{{0, 1, 0}, -1}), Material{.texture = Checker{}, .reflect = 0.25});
  const auto glass = [&] { return Material{.diffuse = random.color(), .refract = 0.5, .ior = 1.5}; };
  for (int i = 0; i < 30; ++i) {  // more of one type than a tree node has children
    const Point corner = Point{random.real(-4, 3), -1, random.real(-1, 7)};
    const Box box{corner, corner + Vec3{random.real(0.1, 1), random.real(0.1, 2), random.real(0.1, 1)}};
    if (i % 3 == 0) scene.add(box, Material{.texture = Checker{.size = 0.25}});
    if (i % 3 == 1) scene.add(box, glass());
    if (i % 3 == 2) scene.add(AnySurface(box), glass());
  }
  scene.add(PointLight{.position = {3, 6, -3}, .power = Color{1000}});
  const DrawnAlike drawn = drawn_alike(scene, camera);
  CHECK(drawn.lit > 500);
  CHECK(drawn.different == 0);

  // No point that faces the light is shadowed from a distance below 0.1 (acne), where nothing else is.
  int lit = 0;
  WrongCases dark(random);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = camera.through_pixel(i % 64, i / 64, 64, 48);
    const auto hit = scene.intersect(ray);
    if (!hit || !(dot(hit->facing_normal(), Vec3{3, 6, -3} - hit->point()) > 0)) continue;
    const Ray to_light = hit->leave(Point{3, 6, -3} - hit->point());
    ++lit;
    if (const auto shadow = scene.intersect(to_light, {0, 1}))
      dark.add(length(shadow->point() - to_light.origin) < 0.1, ray, to_light);
  }
  CHECK(lit > 300);
  CHECK(dark == 0);
}

TEST_CASE("an invalid box is refused") {
  const auto says = [](const Box& box) { return message_of<std::invalid_argument>([&] { box.validate(); }); };
  for (const auto& [bad, shown] : {std::pair(infinity, "inf"), {-infinity, "-inf"}, {not_a_number, "nan"}})
    for (int axis = 0; axis < 3; ++axis) {
      Box min, max;
      min.min[axis] = bad, max.max[axis] = bad;
      const std::string is =
          std::string(1, "xyz"[axis]) + " = " + shown + " must be at most 2^400 (2.6e120) in magnitude";
      CHECK(says(min) == "Box: min." + is);
      CHECK(says(max) == "Box: max." + is);
    }
  for (int axis = 0; axis < 3; ++axis) {
    Box box;
    box.min[axis] = 1 + ulp;
    const std::string name(1, "xyz"[axis]);
    CHECK(says(box) == "Box: min." + name + " = 1.0000000000000002 must not be above max." + name + " = 1");
    box.min[axis] = 1;
    CHECK_NOTHROW(box.validate());
  }
}

namespace {

/// Box that counts the calls of first_crossing.
struct CountedBox : Box {
  static inline int asked = 0;

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    ++asked;
    return Box::first_crossing(ray, range);
  }
};

}  // namespace

TEST_CASE("by tiles, a surface that is intersected ray by ray is queried at most once for each camera ray") {
  Scene<CountedBox, Sphere> scene;
  scene.add(CountedBox{{{-9, -9, 4}, {9, 9, 5}}}, Color{1});
  scene.add(Sphere{.center = {0, 0, 2}, .radius = 0.4}, Color{1});
  Image image(64, 48);
  CountedBox::asked = 0;
  render(image, Camera{}, scene, NormalIntegrator{}, {.threads = 1});
  CHECK(CountedBox::asked <= 64 * 48);
  CHECK(CountedBox::asked > 64 * 48 / 2);
  CHECK(drawn_alike(scene, Camera{}).different == 0);
}

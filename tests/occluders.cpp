#include <protostar/accel/occluders.hpp>
#include <protostar/numeric/exact_number.hpp>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/box.hpp>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using simd::LaneMask, simd::ConeToLight, simd::Occluders, simd::RayPacket, simd::SeenFrom, simd::SphereAround,
    simd::Vectors;

namespace {

/// Returns one surface in one lane, as a search finds it.
simd::SurfacesAround found(std::uint32_t index, const SphereAround& around) {
  return {simd::SurfaceIndices(index), simd::Bits{1}, around};
}

/// Returns rays from random points near a place to a light, with t = 1 at the light.
RayPacket to_light(Random& random, const Point& light, const Point& place, double spread) {
  RayPacket rays(Vectors(place), Vectors(Vec3{0}));
  for (int lane = 0; lane < simd::double_lanes; ++lane) {
    const Point from = place + random.point(spread);
    const Vec3 way = light - from;
    rays.origin.x.set(lane, from.x), rays.origin.y.set(lane, from.y), rays.origin.z.set(lane, from.z);
    rays.direction.x.set(lane, way.x), rays.direction.y.set(lane, way.y), rays.direction.z.set(lane, way.z);
  }
  return rays;
}

/// Distance of the origins of neighboring rays. The cone around a single ray has a half-angle of about half a
/// degree, so they must be closer if a packet has one lane.
constexpr double apart = simd::double_lanes > 1 ? 1 : 0.15;

bool is_inside(const std::array<simd::HalfSpace, 5>& half_spaces, const SphereAround& around) {
  for (const auto& [on, normal] : half_spaces)
    if (dot(normal, around.center - on) < -around.radius) return false;
  return true;
}

}  // namespace

TEST_CASE("a cone to a light keeps every sphere that a ray inside it hits") {
  Random random(11);
  int met = 0, left_out = 0, left_out_within = 0;
  for (int i = 0; i < 3000; ++i) {
    const double far = i % 3 == 0 ? 1e6 : 10;
    const Point light = random.point(far), place = light + 10.0 * random.direction();
    const RayPacket first = to_light(random, light, place, 0.2),
                    others = to_light(random, light, place, 1.2 * apart * apart);
    const SeenFrom seen(light, first, true);
    const ConeToLight cone(seen);
    REQUIRE(cone.is_cone());
    REQUIRE(cone.holds(seen));
    const auto half_spaces = cone.half_spaces();
    // Spheres that are hit by 1e-9 of their radius, and others around the ray.
    for (int k = 0; k < 20; ++k) {
      const int lane = k % simd::double_lanes;
      const LaneMask alone = simd::mask_of<double, simd::double_lanes>(simd::Bits{1} << lane);
      const SeenFrom one(light, others, alone);
      if (!cone.holds(one)) continue;
      const Ray ray = others[lane];
      const double radius = std::pow(10, random.real(-3, 1));
      const Vec3 aside = normalize(cross(ray.direction, random.direction()));
      const double distance = radius * (k % 3 == 0 ? 1 - 1e-9 : random.real(0, 10));
      const Sphere sphere{.center = ray.at(random.real(0, 1)) + distance * aside, .radius = radius};
      const SphereAround around{sphere.center, radius};
      const bool kept = cone.may_hold(cone.seen(around)) && is_inside(half_spaces, around);
      simd::InCone in_cone;
      in_cone.add(7, cone.seen(around));
      const auto is_within = [&](const ConeToLight& narrow) {
        int visits = 0;
        in_cone.each_within(narrow, [&](int found) { visits += found == 7 ? 1 : 100; });
        REQUIRE(visits <= 1);
        return visits == 1;
      };
      const bool kept_within = is_within(cone.around(one));
      if (first_crossing(sphere, ray, Interval{0, 1})) {
        ++met;
        REQUIRE(kept);
        REQUIRE(kept_within);
        REQUIRE(is_within(cone));
      }
      if (!kept) ++left_out;
      if (!kept_within) ++left_out_within;
    }
  }
  CHECK(met > 2000);
  CHECK(left_out > 2000);
  CHECK(left_out_within > left_out + 200);  // the cone around a single ray culls more
}

TEST_CASE("rays that do not end at a cone's apex, or start outside the cone, are not inside it") {
  Random random(12);
  const Point light{1, 2, 3};
  const auto seen = [&](const Point& end, const Point& place) {
    return SeenFrom(light, to_light(random, end, place, 0.1), true);
  };
  const SeenFrom rays = seen(light, {1, 2, 13});
  const ConeToLight cone(rays);
  CHECK(cone.holds(rays));
  CHECK_FALSE(cone.holds(seen(light + Vec3{1e-6, 0, 0}, {1, 2, 13})));
  CHECK_FALSE(cone.holds(seen(light, {1, 2, 17})));
  CHECK_FALSE(cone.holds(seen(light, {3, 2, 13})));
  CHECK_FALSE(cone.holds(seen(light, {1, 2, -7})));
  CHECK_FALSE(ConeToLight().holds(rays));
}

TEST_CASE("spheres around the light, or too large or small for float, are kept by every cone to it") {
  Random random(16);
  const Point light{1, 2, 3};
  const SeenFrom rays(light, to_light(random, light, {1, 2, 13}, 0.1), true);
  const ConeToLight cone(rays);
  simd::InCone in_cone;
  in_cone.add(0, cone.seen({Point{0}, infinity}));
  in_cone.add(1, cone.seen({light + Vec3{0, 0, -2}, 2.5}));
  in_cone.add(2, cone.seen({Point{1e200, 0, 0}, 1e199}));
  in_cone.add(3, cone.seen({light + Vec3{1e-100, 0, 0}, 1e-120}));
  in_cone.add(4, cone.seen({light + Vec3{0, 0, -2}, 1.5}));
  std::vector<int> indices;
  in_cone.each_within(cone.around(rays), [&](int index) { indices.push_back(index); });
  CHECK(indices == std::vector<int>{0, 1, 2, 3});
}

TEST_CASE("a list of occluders may be of any length") {
  Random random(17);
  const SeenFrom rays(Point{0}, to_light(random, {0, 0, 0}, {0, 0, 10}, 0.1), true);
  const ConeToLight cone(rays);
  for (int count = 0; count < 70; ++count) {
    simd::InCone in_cone;
    for (int i = 0; i < count; ++i) in_cone.add(i, cone.seen({Point{i % 3 == 0 ? 4.0 : 0.0, 0, 5}, 0.5}));
    std::vector<int> indices, expected;
    in_cone.each_within(cone.around(rays), [&](int index) { indices.push_back(index); });
    for (int i = 0; i < count; ++i)
      if (i % 3 != 0) expected.push_back(i);
    CHECK(indices == expected);
  }
}

TEST_CASE("a cone keeps a sphere that a ray at its very edge touches from outside") {
  // Rays of one plane on both sides of the cone's edge, closer and closer to it, and for each a sphere beside
  // the cone that it touches within 2^-40 of the distance.
  const Point light{0};
  RayPacket first(Vectors(Point{0, 0, 8}), Vectors(Vec3{0, 0, -8}));
  const ConeToLight cone(SeenFrom(light, first, true));
  const double edge = cone.sine() / cone.cosine();
  int inside = 0, outside = 0;
  for (int power = -56; power < -20; ++power)
    for (const double side : {-1.0, 1.0}) {
      const Point from{8 * edge * (1 + side * std::ldexp(1, power)), 0, 8};
      const RayPacket rays(Vectors(from), Vectors(light - from));
      if (!cone.holds(SeenFrom(light, rays, true))) {
        ++outside;
        continue;
      }
      ++inside;
      const Vec3 aside = normalize(Vec3{8, 0, -from.x});
      const double radius = 0.25;
      const SphereAround around{0.5 * from + radius * (1 - 0x1p-44) * aside, radius};
      CHECK(first_crossing(Sphere{around.center, radius}, rays[0], Interval{0, 1}));
      CHECK(cone.may_hold(cone.seen(around)));
      CHECK(is_inside(cone.half_spaces(), around));
    }
  CHECK(inside > 8);
  CHECK(outside > 30);
}

TEST_CASE("rays that begin at the light, or too near it for squares, are in no cone") {
  const Point light{0};
  const auto seen = [&](double distance) {
    return SeenFrom(light, RayPacket(Vectors(Point{0, 0, distance}), Vectors(Vec3{0, 0, -distance})), true);
  };
  const ConeToLight cone(seen(1));
  CHECK(cone.holds(seen(0x1p-199)));
  for (const double distance : {0x1p-200, 0x1p-300, 0x1p-600, 0.0}) CHECK_FALSE(cone.holds(seen(distance)));
  for (const double distance : {0x1p-300, 0x1p-600, 0.0, 0x1p300, 0x1p600, 0x1p1000})
    CHECK_FALSE(ConeToLight(seen(distance)).is_cone());
}

TEST_CASE("there is no cone for rays from all sides") {
  Random random(13);
  if (simd::double_lanes > 1)
    CHECK_FALSE(ConeToLight(SeenFrom(Point{0}, to_light(random, {0, 0, 0}, {0, 0, 0}, 5), true)).is_cone());
}

TEST_CASE(
    "occluders are searched once for neighboring rays, and seldom for unrelated rays if a search is slow") {
  Random random(14);
  Occluders occluders;
  int searches = 0;
  const auto search = [&](const auto&, const auto& visit) {
    ++searches;
    visit(found(7, {Point{0, 0, 5}, 1}));
    visit(found(8, {Point{0, 50, 5}, 1}));
  };
  for (int i = 0; i < 100; ++i) {
    const auto* indices =
        occluders.between(to_light(random, {0, 0, 0}, {0, 0, 10}, 0.1 * apart), true, search);
    if (i > 2) REQUIRE((indices != nullptr && *indices == PlainVector<int>(1, 7)));
  }
  CHECK(searches < 4);

  const auto search_of_many = [&](const auto&, const auto& visit) {
    ++searches;
    for (int i = 0; i < 1000; ++i) visit(found(1, {Point{0, 50, 5}, 1}));
  };
  const auto searches_for_others = [&](const auto& search_for) {
    Occluders others;
    searches = 0;
    for (int i = 0; i < 1000; ++i) {
      const auto rays = to_light(random, {0, 0, 0}, 10.0 * random.direction(), 0.1);
      for (int asked = 0; asked < 80; asked += simd::double_lanes)
        static_cast<void>(others.between(rays, true, search_for));
    }
    return searches;
  };
  CHECK(searches_for_others(search) > 100);  // this search is fast
  CHECK(searches_for_others(search_of_many) < 50);
}

TEST_CASE("rays with different ends, or of length 0, get no list of occluders") {
  Random random(15);
  Occluders occluders;
  const auto search = [](const auto&, const auto&) {};
  for (int i = 0; i < 200; ++i) {
    RayPacket rays = to_light(random, {0, 0, 0}, {0, 0, 10}, 0.1);
    const Vec3 aside = random.direction();
    rays.direction.x.set(simd::double_lanes - 1, aside.x),
        rays.direction.y.set(simd::double_lanes - 1, aside.y);
    if (simd::double_lanes > 1) CHECK(occluders.between(rays, true, search) == nullptr);
    rays.direction = Vectors(Vec3{0});
    CHECK(occluders.between(rays, true, search) == nullptr);
  }
}

TEST_CASE("rays that get no list of occluders leave those of other rays as they are") {
  if (simd::double_lanes < 2) {
    WARN("not tested: a single ray always gets a cone");
    return;
  }
  Random random(19);
  Occluders occluders;
  int searches = 0;
  const auto search = [&](const auto&, const auto& visit) {
    ++searches;
    visit(found(7, {Point{0, 0, 5}, 1}));
  };
  const RayPacket rays = to_light(random, {0, 0, 0}, {0, 0, 10}, 0.1);
  CHECK(occluders.between(rays, true, search) != nullptr);
  for (int i = 0; i < 8; ++i) {  // no cone holds two rays that come to the light from opposite sides
    RayPacket around = to_light(random, {0, 0, 0}, {0, 0, 1}, 3);
    const int last = simd::double_lanes - 1;
    const Point from = -around.origin[0];
    around.origin.x.set(last, from.x), around.origin.y.set(last, from.y), around.origin.z.set(last, from.z);
    around.direction.x.set(last, -from.x), around.direction.y.set(last, -from.y),
        around.direction.z.set(last, -from.z);
    CHECK(occluders.between(around, true, search) == nullptr);
  }
  CHECK(occluders.between(rays, true, search) != nullptr);
  CHECK(searches == 1);
}

TEST_CASE("rays with different ends leave no wrong list of occluders for later rays") {
  if (simd::double_lanes < 2) {
    WARN("not tested: a packet has a single ray");
    return;
  }
  Occluders occluders;
  const auto search = [](const auto&, const auto& visit) { visit(found(7, {{0, 0, 5}, 1})); };
  RayPacket rays(Vectors(Point{0, 0, 10}), Vectors(Vec3{0, 0, -10}));
  rays.direction.x.set(simd::double_lanes - 1, 1);
  CHECK(occluders.between(rays, true, search) == nullptr);
  const auto* const indices = occluders.between(rays, simd::mask_of<double, simd::double_lanes>(1), search);
  CHECK((indices == nullptr || *indices == PlainVector<int>(1, 7)));
}

TEST_CASE("a list that has served 2^29 rays, as in a tile of many samples, is followed by another search",
          "[long]") {
  if (cases(0, 1) == 0) return;  // it takes a minute
  Random random(18);
  Occluders occluders;
  int searches = 0;
  const auto search = [&](const auto&, const auto& visit) {
    ++searches;
    visit(found(7, {Point{0, 0, 5}, 1}));
  };
  RayPacket rays = to_light(random, {0, 0, 0}, {0, 0, 10}, 0.1);
  for (int i = 0; i <= (1 << 29) / simd::double_lanes; ++i)
    static_cast<void>(occluders.between(rays, true, search));
  CHECK(searches == 1);
  for (int i = 0; i < 2; ++i) {
    rays = to_light(random, {0, 0, 0}, {10, 10.0 * i, 0}, 0.1);
    CHECK(occluders.between(rays, true, search) != nullptr);
  }
  CHECK(searches == 3);
}

TEST_CASE("the sphere around a surface contains the corners of its bounds, without rounding") {
  Random random(15);
  WrongCases wrong(random);
  for (int i = 0; i < 3000; ++i) {
    const Point at = std::exp2(random.real(-60, 60)) * random.point(1);
    const Box box{at, at + std::exp2(random.real(-60, 60)) * (random.point(1) + Vec3(1))};
    const auto around = simd::sphere_around(box);
    const Bounds bounds = box.bounds();
    const ExactNumber radius = around.radius;
    for (int corner = 0; corner < 8; ++corner) {
      ExactNumber square = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double end = corner >> k & 1 ? bounds.max[k] : bounds.min[k];
        const ExactNumber off = ExactNumber(end) - ExactNumber(around.center[k]);
        square = square + off * off;
      }
      wrong.add((radius * radius - square).sign() < 0, box, corner, around.center, around.radius);
    }
  }
  CHECK(wrong == 0);
}

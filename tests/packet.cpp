#include <protostar/accel/hit_packet.hpp>
#include <protostar/accel/packet.hpp>
#include <protostar/light.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <functional>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using simd::Bits;
using simd::CameraPacket;
using simd::double_lanes;
using simd::LaneMask;
using simd::RayPacket;
using simd::Vectors;

namespace {

static_assert(simd::takes_packets<Sphere> && simd::takes_packets<Plane> &&
              simd::takes_packets<Parallelogram>);
static_assert(!simd::takes_packets<Cylinder>);

/// Sphere whose normal takes one point only.
struct Bumpy : Sphere {
  [[nodiscard]] Vec3 normal_at(const Point& p) const {
    return normalize(Sphere::normal_at(p) + Vec3{0.1, 0, 0});
  }
};
static_assert(SurfaceWithEquation<Bumpy> && !simd::takes_packets<Bumpy>);

/// Rays that fill a packet; all have the same departure.
using Bundle = std::array<Ray, double_lanes>;

Vectors directions_of(const Bundle& bundle) {
  Vectors directions(Vec3{0});
  for (int i = 0; i < double_lanes; ++i) {
    const Vec3& d = bundle[static_cast<std::size_t>(i)].direction;
    directions.x.set(i, d.x), directions.y.set(i, d.y), directions.z.set(i, d.z);
  }
  return directions;
}

/// Returns the packet of some rays, each with its own origin.
RayPacket packet_of(const Bundle& bundle, LaneMask active) {
  Vectors origins(Vec3{0});
  for (int i = 0; i < double_lanes; ++i) {
    const Point& o = bundle[static_cast<std::size_t>(i)].origin;
    origins.x.set(i, o.x), origins.y.set(i, o.y), origins.z.set(i, o.z);
  }
  return {origins, directions_of(bundle), active, bundle[0].departure};
}

/// Returns the packet of some rays, all starting at the first one's origin.
RayPacket packet_from_one_point(const Bundle& bundle, LaneMask active) {
  return {bundle[0].origin, directions_of(bundle), active, bundle[0].departure};
}

/// Returns the packet of a pinhole's rays, which depart from nothing.
CameraPacket packet_of_pinhole(const Bundle& bundle, LaneMask active) {
  CameraPacket rays(bundle[0].origin, directions_of(bundle), active);
  rays.start_together = true;
  return rays;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// Counts from comparing packets with their single rays.
struct Comparison {
  int asked = 0, met = 0, in_doubt = 0;
  WrongCases wrong;
};

bool has(LaneMask some, int lane) { return (bits(some) >> lane & 1) != 0; }

/// Compares a surface's answers for a packet with those for its single rays: the roots, and the crossings in
/// some ranges.
template <Surface S>
void compare(const S& surface, const auto& rays, Random& random, Comparison& tally) {
  const LaneMask active = rays.active;
  if constexpr (simd::takes_packets<S>) {
    const auto roots = roots_of_each(surface, rays, active);
    const simd::Doubles near = roots.near(), far = roots.far();
    for (int i = 0; i < double_lanes; ++i) {
      const bool meets = has(roots.meets, i), in_doubt = has(roots.in_doubt, i);
      if (!has(active, i)) {
        tally.wrong.add(meets || in_doubt, surface, "inactive lane", i);
        continue;
      }
      ++tally.asked;
      tally.met += meets;
      tally.in_doubt += in_doubt;
      if (in_doubt) continue;
      const Roots expected = roots_of(surface, rays[i]);
      tally.wrong.add(meets != (expected.count() > 0), surface, rays[i]);
      if (!meets) continue;
      tally.wrong.add(!same_bits(near[i], expected[0]) ||
                          !same_bits(far[i], expected[expected.count() - 1]) ||
                          roots.count != expected.count(),
                      surface, rays[i], near[i], far[i]);
    }
  }
  // Rays of a camera are asked for their first crossings in t > 0 alone.
  const auto crossings_in = [&](Interval range) {
    if constexpr (std::same_as<decltype(rays), const CameraPacket&>)
      if (range.min == 0 && range.max == infinity) return first_crossings(surface, rays, active);
    return first_crossings(surface, static_cast<const RayPacket&>(rays), active, range);
  };
  const auto compare_in = [&](Interval range, bool may_be_in_doubt) {
    const simd::ClosestCrossings first = crossings_in(range);
    const auto crossed = crossed_in(surface, rays, active, range);
    for (int i = 0; i < double_lanes; ++i) {
      if (!has(active, i)) {
        tally.wrong.add(has(first.met, i) || has(first.in_doubt, i) || has(crossed.crossed, i) ||
                            has(crossed.in_doubt, i),
                        surface, "inactive lane", i, range);
        continue;
      }
      const auto expected = first_crossing(surface, rays[i], range);
      if (!may_be_in_doubt) {
        tally.asked += 2;
        tally.in_doubt += has(first.in_doubt, i) + has(crossed.in_doubt, i);
      }
      if (!has(first.in_doubt, i))
        tally.wrong.add(has(first.met, i) != expected.has_value() ||
                            (expected && !(same_bits(first.t[i], expected->t) &&
                                           has(first.is_far, i) == (expected->root == 1))),
                        surface, rays[i], range, first.t[i]);
      if (!has(crossed.in_doubt, i))
        tally.wrong.add(has(crossed.crossed, i) != expected.has_value(), surface, rays[i], range);
    }
  };
  const double a = random.real(-3, 3), b = a + random.real(0, 3);
  for (const Interval range : {Interval{}, Interval{0, 1}, Interval{-infinity, infinity}, Interval{a, b},
                               Interval{0, b}, Interval{b, a}})
    compare_in(range, range.min != 0);
  // Ranges that begin or end at a crossing or close to it.
  const auto somewhere = first_crossing(surface, rays[0], Interval{-infinity, infinity});
  const double t = somewhere ? somewhere->t : 0, nearly = t * (1 + std::ldexp(random.real(-1, 1), -31));
  for (const Interval range :
       {Interval{t, infinity}, Interval{-infinity, t}, Interval{nearly, b}, Interval{a, nearly}})
    compare_in(range, true);
}

/// Returns a mask of some lanes, or of all.
LaneMask some_lanes(Random& random) {
  const Bits all = simd::first_bits(double_lanes), some = static_cast<Bits>(random.bits()) & all;
  return simd::mask_of<double, double_lanes>(random.bits() % 2 ? all : some);
}

/// Compares a surface's answers for packets with many origins, with one origin, and of a pinhole, in a number
/// of rounds.
Comparison compare(const std::function<Ray(Random&)>& ray, const auto& surface_of, int rounds) {
  Comparison tally;
  Random random(7);
  for (int round = 0; round < rounds; ++round) {
    const auto surface = surface_of(random);
    Bundle bundle;
    for (Ray& r : bundle) r = ray(random);
    for (Ray& r : bundle) r.departure = bundle[0].departure;
    compare(surface, packet_of(bundle, some_lanes(random)), random, tally);
    compare(surface, packet_from_one_point(bundle, some_lanes(random)), random, tally);
    if (bundle[0].departure.kind == Departure::Kind::none)
      compare(surface, packet_of_pinhole(bundle, some_lanes(random)), random, tally);
  }
  return tally;
}

/// Returns a random double of any size, sometimes 0, infinity or NaN.
double any_size(Random& random) {
  switch (random.bits() % 16) {
    case 0:
      return 0;
    case 1:
      return infinity;
    case 2:
      return std::nan("");
    default:
      return std::ldexp(random.real(-1, 1), static_cast<int>(random.bits() % 2000) - 1000);
  }
}

struct PacketRow {
  const char* what;
  std::function<Ray(Random&)> ray;
  double most_in_doubt;  ///< upper bound for the share of answers
  double least_met;      ///< lower bound for the share of questions, of which one in 13 asks for roots
};

}  // namespace

TEST_CASE("a packet hits a sphere where each of its rays does, or is in doubt") {
  const auto unit = [](Random&) { return Sphere{}; };
  const auto row = GENERATE_COPY(values<PacketRow>(
      {{"ordinary rays",
        [](Random& r) {
          return Ray{r.point(3), r.direction()};
        },
        1e-3, 0.003},
       {"of any length",
        [](Random& r) {
          return Ray{r.point(3), r.direction() * std::exp2(r.real(-60, 60))};
        },
        1e-3, 0.003},
       {"from far away, towards it",
        [](Random& r) {
          const Point from = 1e3 * r.direction();
          return Ray{from, r.point(1) - from};
        },
        1e-2, 0.005},
       {"from inside",
        [](Random& r) {
          return Ray{0.9 * r.direction(), r.direction()};
        },
        1e-3, 0.03},
       {"between two points",
        [](Random& r) {
          const Point from = r.point(2);
          return Ray{from, r.point(2) - from};
        },
        1e-3, 0.003},
       {"to a point of it",
        [](Random& r) {
          const Point from = r.point(2);
          return Ray{from, r.direction() - from};
        },
        1, 0.005},
       {"to nearly a point of it",
        [](Random& r) {
          const Point from = r.point(2);
          return Ray{from, (r.direction() - from) *
                               (1 + std::ldexp(r.real(-1, 1), -static_cast<int>(r.bits() % 54)))};
        },
        1, 0.005},
       {"from the surface, as a point",
        [](Random& r) {
          return Ray{r.direction(), r.direction()};
        },
        1, 0},
       {"tangent",
        [](Random& r) {
          const Vec3 n = r.direction(), along = normalize(cross(n, r.direction()));
          return Ray{n - r.real(-3, 3) * along, along};
        },
        1, 0},
       {"nearly tangent",
        [](Random& r) {
          const Vec3 n = r.direction(), along = normalize(cross(n, r.direction()));
          return Ray{
              (1 + std::ldexp(r.real(-1, 1), -static_cast<int>(r.bits() % 50))) * n - r.real(-3, 3) * along,
              along};
        },
        1, 0.001},
       {"touching in whole numbers",
        [](Random& r) {
          return Ray{{1, r.real(-2, 2) < 0 ? -2.0 : 0.0, 0}, {0, 1, 0}};
        },
        1, 0},
       {"of any numbers",
        [](Random& r) {
          return Ray{{any_size(r), any_size(r), any_size(r)}, {any_size(r), any_size(r), any_size(r)}};
        },
        1, 0},
       {"departing",
        [](Random& r) {
          return Ray{r.direction(), r.direction(), Sphere{}.departure()};
        },
        1e-3, 0.03},
       {"departing along it",
        [](Random& r) {
          const Vec3 n = r.direction(), along = normalize(cross(n, r.direction()));
          return Ray{n, along + std::ldexp(r.real(-1, 1), -static_cast<int>(r.bits() % 60)) * n,
                     Sphere{.radius = -1}.departure()};
        },
        1, 0.01},
       {"departing from another",
        [](Random& r) {
          return Ray{r.point(2), r.direction(), Sphere{.center = {1, 0, 0}}.departure()};
        },
        1e-3, 0.003}}));
  const Comparison tally = compare(row.ray, unit, cases(1000, 2000));
  CAPTURE(row.what, tally.asked, tally.met, tally.in_doubt);
  CHECK(tally.wrong == 0);
  CHECK(tally.in_doubt <= row.most_in_doubt * tally.asked);
  CHECK(tally.met >= row.least_met * tally.asked);
}

TEST_CASE("a packet hits spheres of any size and position where each of its rays does, or is in doubt") {
  const auto at = [](double center, double radius) {
    return [=](Random& r) {
      return Sphere{.center = center + r.point(std::abs(radius)),
                    .radius = radius * std::exp2(r.real(-1, 1))};
    };
  };
  struct Row {
    double center, radius;
  };
  for (const auto& [center, radius] :
       {Row{0, 1e-6}, Row{65537, 1}, Row{65537, -1e-3}, Row{0, 1e6}, Row{1e9, 1}, Row{0, 1e300},
        Row{0, 1e-300}, Row{0, 1e160}, Row{0, 5e-324}}) {
    CAPTURE(center, radius);
    const auto near_it = [middle = center, size = std::abs(radius)](Random& r) {
      const Point from = middle + r.point(3 * size);
      return Ray{from, (middle + r.point(size) - from) * std::exp2(r.real(-2, 2))};
    };
    const Comparison tally = compare(near_it, at(center, radius), cases(250, 1000));
    CHECK(tally.wrong == 0);
  }
  const auto any_sphere = [](Random& r) {
    return Sphere{{any_size(r), any_size(r), any_size(r)}, any_size(r)};
  };
  const auto any_ray = [](Random& r) {
    return Ray{{any_size(r), any_size(r), any_size(r)}, {any_size(r), any_size(r), any_size(r)}};
  };
  CHECK(compare(any_ray, any_sphere, cases(1000, 4000)).wrong == 0);
}

TEST_CASE("a packet hits a plane where each of its rays does, or is in doubt") {
  const auto ordinary = [](Random& r) { return Ray{r.point(3), r.direction()}; };
  const auto random_plane = [](Random& r) { return Plane{.normal = r.point(2), .distance = r.real(-2, 2)}; };
  const Comparison tally = compare(ordinary, random_plane, 4000);
  CHECK(tally.wrong == 0);
  CHECK(tally.met > 0.05 * tally.asked);
  CHECK(tally.in_doubt < 1e-3 * tally.asked);

  const auto floor = [](Random&) { return Plane{.normal = {0, 1, 0}, .distance = -1}; };
  for (const PacketRow& row :
       {PacketRow{"from the plane",
                  [](Random& r) {
                    return Ray{{r.real(-2, 2), -1, 0}, r.direction()};
                  },
                  1, 0},
        PacketRow{"parallel",
                  [](Random& r) {
                    return Ray{r.point(3), {r.real(-1, 1), 0, r.real(-1, 1)}};
                  },
                  1, 0},
        PacketRow{
            "nearly parallel",
            [](Random& r) {
              return Ray{r.point(3), {1, std::ldexp(r.real(-1, 1), -static_cast<int>(r.bits() % 1000)), 2}};
            },
            1, 0.001},
        PacketRow{"departing",
                  [](Random& r) {
                    return Ray{{r.real(-2, 2), -1, 0}, r.direction(), Plane{{0, 2, 0}, -2}.departure()};
                  },
                  0, 0},
        PacketRow{
            "of any numbers",
            [](Random& r) {
              return Ray{{any_size(r), any_size(r), any_size(r)}, {any_size(r), any_size(r), any_size(r)}};
            },
            1, 0}}) {
    const Comparison answers = compare(row.ray, floor, 1000);
    CAPTURE(row.what, answers.asked, answers.met, answers.in_doubt);
    CHECK(answers.wrong == 0);
    CHECK(answers.in_doubt <= row.most_in_doubt * answers.asked);
    CHECK(answers.met >= row.least_met * answers.asked);
  }
  const auto any_plane = [](Random& r) {
    return Plane{{any_size(r), any_size(r), any_size(r)}, any_size(r)};
  };
  CHECK(compare(ordinary, any_plane, 4000).wrong == 0);
}

TEST_CASE("a packet hits a parallelogram where each of its rays does, or is in doubt") {
  const auto any_board = [](Random& r) { return Parallelogram{r.point(2), r.point(3), r.point(3)}; };
  const auto level = [](Random&) { return Parallelogram{{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}}; };
  const auto any_ray = [](Random& r) {
    return Ray{{any_size(r), any_size(r), any_size(r)}, {any_size(r), any_size(r), any_size(r)}};
  };
  const Comparison tally = compare([](Random& r) { return Ray{r.point(3), r.direction()}; }, any_board, 4000);
  CHECK(tally.wrong == 0);
  CHECK(tally.met > 0.003 * tally.asked);
  CHECK(tally.in_doubt < 1e-3 * tally.asked);

  const auto on_it = [](Random& r) { return Point{r.real(-1, 1), -1, r.real(-1, 1)}; };
  // Of seven questions, two have a range that ends where a ray hits. Of packets with one origin, which are
  // two of three, only the first ray does so.
  const double at_the_end = 2.0 / 7 * (1 + 2.0 / double_lanes) / 3;
  for (const PacketRow& row :
       {PacketRow{"to a point of it",
                  [&](Random& r) {
                    const Point from = r.point(3);
                    return Ray{from, on_it(r) - from};
                  },
                  at_the_end + 0.001, 0.03},
        PacketRow{"to its outline",
                  [&](Random& r) {
                    const Point from = r.point(3);
                    return Ray{from, Point{r.real(-1, 1), -1, 1} - from};
                  },
                  1, 0},
        PacketRow{"from it",
                  [&](Random& r) {
                    return Ray{on_it(r), r.direction()};
                  },
                  1, 0},
        PacketRow{"along it",
                  [](Random& r) {
                    return Ray{r.point(1), {r.real(-1, 1), 0, r.real(-1, 1)}};
                  },
                  1, 0},
        PacketRow{"departing",
                  [&](Random& r) {
                    return Ray{on_it(r), r.direction(), Plane{{0, 2, 0}, -2}.departure()};
                  },
                  0, 0},
        PacketRow{"of any numbers", any_ray, 1, 0}}) {
    const Comparison answers = compare(row.ray, level, 1000);
    CAPTURE(row.what, answers.asked, answers.met, answers.in_doubt);
    CHECK(answers.wrong == 0);
    CHECK(answers.in_doubt <= row.most_in_doubt * answers.asked);
    CHECK(answers.met >= row.least_met * answers.asked);
  }
  const auto of_any_numbers = [](Random& r) {
    return Parallelogram{{any_size(r), any_size(r), any_size(r)},
                         {any_size(r), any_size(r), any_size(r)},
                         {any_size(r), any_size(r), any_size(r)}};
  };
  CHECK(compare(any_ray, of_any_numbers, 2000).wrong == 0);
}

TEST_CASE("a surface without packet functions is asked about each ray of a packet") {
  const auto ordinary = [](Random& r) { return Ray{r.point(3), r.direction()}; };
  const Comparison tally = compare(
      ordinary, [](Random&) { return Cylinder{}; }, 1000);
  CHECK(tally.wrong == 0);
  CHECK(tally.in_doubt == 0);
}

TEST_CASE("the hits of a packet have the same values as the hits of its single rays") {
  Random random(3);
  const Light light = PointLight{.position = {1, 4, -2}, .power = Color{300, 200, 100}};
  int surfaces = 0, hits = 0;
  WrongCases wrong(random);
  const auto compare_hits = [&](const auto& surface) {
    Bundle bundle;
    for (Ray& r : bundle) r = {random.point(3), random.direction()};
    const RayPacket rays = packet_of(bundle, true);
    const simd::ClosestCrossings first = first_crossings(surface, rays, true, Interval{});
    // Every other surface has a texture, which is evaluated for each ray.
    Material material{.diffuse = random.color()};
    if (++surfaces % 2 == 0) material.texture = Checker{random.color(), random.color(), 0.3};
    const simd::HitPacket some(rays, first.t, first.met, surface, material);
    const Vectors normals = some.normal(), facing = some.facing_normal(), points = some.point();
    const simd::Colors lights = light.irradiance(points, facing), colors = some.color();
    const simd::Uvs places = some.uv();
    const RayPacket left = some.leave(light.towards(points)), turned = left.with_direction(normals);
    wrong.add(bits(turned.active) != bits(left.active), surface);
    for (int i = 0; i < double_lanes; ++i) {
      if (!has(first.met && !first.in_doubt, i)) continue;
      ++hits;
      const auto crossing = first_crossing(surface, rays[i], Interval{});
      const Intersection one(bundle[static_cast<std::size_t>(i)], crossing_on(surface, *crossing, material));
      const Color lit = light.irradiance(one.point(), one.facing_normal());
      const Ray leaving = one.leave(light.towards(one.point()));
      wrong.add(!same_bits(one.point(), points[i]) || !same_bits(one.normal(), normals[i]) ||
                    !same_bits(one.facing_normal(), facing[i]) || one.uv() != Uv{places.x[i], places.y[i]} ||
                    one.direction() != some.direction()[i] ||
                    one.color() != Color{colors.r[i], colors.g[i], colors.b[i]} ||
                    lit != Color{lights.r[i], lights.g[i], lights.b[i]} || !has(left.active, i) ||
                    !same_bits(leaving.origin, left[i].origin) ||
                    !same_bits(leaving.direction, left[i].direction) ||
                    leaving.departure != left[i].departure || !has(turned.active, i) ||
                    !same_bits(leaving.origin, turned[i].origin) ||
                    !same_bits(leaving.with_direction(one.normal()).direction, turned[i].direction) ||
                    leaving.departure != turned[i].departure,
                surface, leaving);
    }
  };
  for (int round = 0; round < 1000; ++round) {
    compare_hits(Sphere{.center = random.point(1), .radius = random.real(-2, 2)});
    compare_hits(Plane{.normal = random.point(1), .distance = random.real(-2, 2)});
    compare_hits(Parallelogram{random.point(2), random.point(4), random.point(4)});
    compare_hits(Cylinder{.radius = random.real(0.5, 2)});
  }
  CHECK(hits > 500);
  CHECK(wrong == 0);
}

TEST_CASE("masked() keeps the lanes that are both active and chosen") {
  const auto mask = [](Bits lanes) { return simd::mask_of<double, double_lanes>(lanes); };
  const Bits all = simd::first_bits(double_lanes);
  for (Bits lanes = 0; lanes <= all; ++lanes) {
    RayPacket rays(Point{0}, Vec3{0, 0, 1}, mask(lanes));
    const RayPacket chosen = masked(mask(all & 5), std::move(rays));
    CHECK(bits(chosen.active) == (lanes & 5));
  }
}

TEST_CASE("number_of and crossing_at convert a crossing without its t to a negative number and back") {
  for (const int root : {0, 1, 7, 2147483647})
    for (const int primitive : {0, 1, 5, 2147483647, -1, -2147483647}) {
      const std::int64_t number = simd::number_of({.t = 3, .root = root, .primitive = primitive});
      const Crossing crossing = simd::crossing_at(0.25, number);
      CHECK(number < 0);
      CHECK((crossing.t == 0.25 && crossing.root == root && crossing.primitive == primitive));
    }
}

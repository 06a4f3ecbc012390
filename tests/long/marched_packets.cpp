#include <protostar/accel/packet.hpp>
#include <protostar/exact/functions.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <bit>
#include <cstdint>
#include <type_traits>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Compares packets of rays towards a field with single rays: crossings and evaluations.
template <class F>
void compare_marches(const char* name, const Marched<F>& surface, double size, int packets) {
  Random random(24);
  WrongCases wrong(random);
  int met = 0;
  MarchCounts together, alone;
  for (int i = 0; i < packets; ++i) {
    const Point origin = size * Vec3(random.real(-3, 3), random.real(-3, 3), random.real(-3, 3));
    const Vec3 target = 0.7 * size * random.point(1);
    const double spread = size * std::pow(10, random.real(-6, 0));
    simd::Vectors directions(Vec3{0});
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      Vec3 d = target + spread * random.point(1) - origin;
      if (i % 5 == 0) d.x = 0;
      directions.x.set(lane, d.x), directions.y.set(lane, d.y), directions.z.set(lane, d.z);
    }
    const simd::LaneMask active = simd::mask_of<double, simd::double_lanes>(i % 3 == 0 ? 0x55 : 0xff);
    const simd::RayPacket rays(origin, directions, active);
    const Interval range = i % 2 == 0 ? Interval{} : Interval{0, 1};
    const auto ray = [&rays](int lane) { return rays[lane]; };
    const RayLanes in_lanes{rays.origin, rays.direction, active, false, ray};
    const FirstOfLanes found = surface.first_of_lanes(in_lanes, range, together);
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const simd::Bits bit = simd::Bits{1} << lane;
      if ((bits(active) & bit) == 0) continue;
      const auto first = surface.first_crossing(rays[lane], range);
      static_cast<void>(surface.march(rays[lane], range, alone));
      const bool is_there = (bits(found.is_there) & bit) != 0;
      const double t = found.t[lane];
      met += is_there;
      const bool same = is_there == first.has_value() &&
                        (!first || std::bit_cast<std::uint64_t>(t) == std::bit_cast<std::uint64_t>(first->t));
      wrong.add(!same, name, rays[lane], range, t, first ? first->t : -1, is_there);
    }
  }
  CAPTURE(name, together.values, alone.values, together.slopes, alone.slopes, together.precise_values,
          alone.precise_values);
  CHECK(wrong == 0);
  CHECK(met > packets / 4);
}

}  // namespace

TEST_CASE("Packets of rays march to the crossings of their single rays, bit by bit") {
  each_test_field([](const char* name, const auto& field, double half) {
    compare_marches(name, Marched(field, cube_bounds(half), 1000), half, cases(60, 20000));
  });
}

namespace {

/// Ball that counts the searches for crossings of several rays.
struct CountedBall : Marched<std::remove_cv_t<decltype(sphere_field)>> {
  using Marched::first_of_lanes;
  using Marched::Marched;
  [[nodiscard]] FirstOfLanes first_of_lanes(const RayLanes& rays, Interval range) const {
    ++searches;
    return Marched::first_of_lanes(rays, range);
  }

  inline static int searches = 0;
};

}  // namespace

TEST_CASE("A surface of any type hands the rays of a packet on to the surface that it holds") {
  const AnySurface counted(CountedBall(sphere_field, cube_bounds(1))), sphere(Sphere{Point(0), 1});
  simd::Vectors directions(Vec3(0.1, 0.2, -1));
  for (int lane = 0; lane < simd::double_lanes; ++lane) directions.x.set(lane, 0.03 * lane);
  const simd::RayPacket rays(Point(0, 0, 3), directions);
  const int before = CountedBall::searches;
  const simd::ClosestCrossings marched = first_crossings(counted, rays, true, Interval{});
  CHECK(CountedBall::searches == before + 1);
  const simd::ClosestCrossings exact = first_crossings(sphere, rays, true, Interval{});
  for (int lane = 0; lane < simd::double_lanes; ++lane) {
    CHECK(marched.t[lane] == counted.first_crossing(rays[lane], {})->t);
    CHECK(exact.t[lane] == sphere.first_crossing(rays[lane], {})->t);
  }
  CHECK(!any(!(marched.met && exact.met)));
}

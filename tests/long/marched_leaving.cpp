// Rays that leave marched surfaces: they meet neither the place that they start at, nor miss what comes next.
#include <cmath>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a ray that leaves a marched surface from a computed hit, outward or inward: in a random direction,
/// or at a grazing angle with a cosine from 0.1 to 1e-14. None, if a random ray does not hit.
std::optional<Ray> leaving_ray(Random& random, const auto& surface, double half, bool is_outward,
                               bool is_grazing) {
  const Point from = 4.0 * random.direction();
  const Ray to{.origin = from, .direction = normalize(random.point(half) - from)};
  const auto t = surface.intersect(to);
  if (!t) return std::nullopt;
  const Point point = to.at(*t);
  const Vec3 normal = surface.normal_at(point);
  Vec3 direction = random.direction();
  if ((dot(direction, normal) > 0) != is_outward) direction = -direction;
  if (is_grazing) {
    const double cosine = std::pow(10, random.real(-14, -1));
    direction =
        normalize(direction - dot(direction, normal) * normal + (is_outward ? cosine : -cosine) * normal);
  }
  return Ray{.origin = point, .direction = direction, .departure = surface.departure()};
}

/// Returns the enclosure of a field at the origin of a ray, the level that the ray leaves.
Enclosure<DoubleDouble> level_at(const auto& field, const Point& p) {
  const auto at = [&](int k) { return Enclosure<DoubleDouble>(p[k]); };
  return field(FieldPoint<Enclosure<DoubleDouble>>{at(0), at(1), at(2)});
}

}  // namespace

TEST_CASE("a ray that leaves a marched surface hits what is next, and never where it starts") {
  fallbacks = {};
  each_test_field([](const char* name, const auto& field, double half) {
    const Marched surface(field, cube_bounds(half), 4000);
    for (int kind = 0; kind < 4; ++kind) {
      const bool is_outward = kind % 2 == 0, is_grazing = kind >= 2;
      Random random(static_cast<std::uint64_t>(kind));
      WrongCases acne(random), missed(random), off(random);
      int looked_at = 0;
      for (int i = 0; i < cases(6, 1600); ++i) {
        const auto ray = leaving_ray(random, surface, half, is_outward, is_grazing);
        if (!ray) continue;
        // The truth begins beyond the departure: behind 1e-9, where that is distinct from the level.
        constexpr double begin = 1e-9;
        const TrueRoot truth = true_first_root(field, *ray, begin, 4 * half, level_at(field, ray->origin));
        if (truth.answer == TrueRoot::Answer::unknown) continue;
        NoTrace trace;
        const MarchedRoot root = surface.march(*ray, {}, trace);
        const bool is_hit = root.answer == MarchedRoot::Answer::hit;
        if (is_hit && root.max < 2 * begin) continue;  // the truth does not tell so near
        ++looked_at;
        acne.add(is_hit && truth.answer == TrueRoot::Answer::miss, name, *ray, root.min, root.max);
        missed.add(!is_hit && truth.answer == TrueRoot::Answer::hit, name, *ray, truth.t);
        off.add(is_hit && truth.answer == TrueRoot::Answer::hit &&
                    !(root.min <= truth.t * (1 + 4 * ulp) && truth.t <= root.max * (1 + 4 * ulp)),
                name, *ray, root.min, root.max, truth.t);
      }
      CHECK(acne == 0);
      CHECK(missed == 0);
      CHECK(off == 0);
      CHECK(looked_at > 0);
    }
  });
  CHECK(fallbacks.undecided == 0);
}

TEST_CASE("a ray that leaves a marched sphere outward is alone, and inward hits the other side once") {
  const Marched marched(sphere_field, cube_bounds(1));
  Random random(7);
  WrongCases wrong(random);
  int left = 0;
  for (int i = 0; i < cases(60, 20000); ++i) {
    const bool is_outward = i % 2 == 0;
    const auto ray = leaving_ray(random, marched, 1, is_outward, i % 4 >= 2);
    if (!ray) continue;
    ++left;
    const auto ahead = crossings_of(marched, *ray), all = crossings_of(marched, *ray, everywhere);
    wrong.add(ahead.size() != (is_outward ? 0U : 1U), *ray, ahead);
    wrong.add(all.size() != 1, *ray, all);
    if (all.size() != 1) continue;
    // The chord of a sphere through the origin is 2 b.
    const double chord = -2 * dot(ray->origin, ray->direction) / dot(ray->direction, ray->direction);
    // Both dot products here are off by 3u, u = 2^-53, the quotient by u and A in it by 3u.
    const double most = Roots::relative_error * std::abs(chord) + 8 * 0x1p-53;
    wrong.add(!(std::abs(all[0] - chord) <= most), *ray, all, chord);
  }
  CHECK(wrong == 0);
  CHECK(left > cases(30, 10000));
}

TEST_CASE("a ray that leaves an instance of a marched surface does not hit it where it starts") {
  const Instance marched(Marched(box_field, cube_bounds(1)), Affine{}.rotated_about({1, 2, 3}, 40));
  Random random(8);
  WrongCases wrong(random);
  int left = 0;
  for (int i = 0; i < cases(60, 6000); ++i) {
    const Point from = 4.0 * random.direction();
    const Ray to{.origin = from, .direction = normalize(random.point(1) - from)};
    const auto t = marched.intersect(to);
    if (!t) continue;
    ++left;
    const Point point = to.at(*t);
    const Vec3 normal = marched.normal_at(point);
    Ray leaving{.origin = point, .direction = random.direction(), .departure = marched.departure()};
    const bool is_outward = dot(leaving.direction, normal) > 0;
    const auto ahead = crossings_of(marched, leaving);
    wrong.add(ahead.size() != (is_outward ? 0U : 1U), leaving, normal, ahead);
    // Acne would be within the rounding of the point, 2^-30 of 4. No other hit is so near.
    if (!is_outward) wrong.add(ahead.size() == 1 && ahead[0] < 0x1p-20, leaving, ahead);
  }
  CHECK(wrong == 0);
  CHECK(left > cases(30, 3000));
}

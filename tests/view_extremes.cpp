// Views of lights over all magnitudes that a scene may have: sizes and distances far apart, and points almost
// on edges, corners, axes and planes.
#include <protostar/sampling/solid_angle.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a number from 2^-400 to 2^398.
double magnitude(Random& random) { return std::exp2(random.real(-400, 398)); }

/// Returns a vector of any magnitude: in any direction, with components of any magnitudes, on an axis or in a
/// plane of axes, or with components that are small multiples of one number.
Vec3 vector(Random& random) {
  if (random.bits() % 4 == 0) return magnitude(random) * random.direction();
  if (random.bits() % 3 == 0) return magnitude(random) * random.whole_vector(2);
  Vec3 v;
  const auto zeros = random.bits() % 2;
  for (int k = 0; k < 3; ++k)
    v[k] = zeros * (random.bits() % 3) != 0 ? 0 : (random.bits() % 2 ? 1 : -1) * magnitude(random);
  return v;
}

/// Returns a vector with the same direction and a length of about 1, or the z axis for 0.
Vec3 direction_of(const Vec3& v) { return v == Vec3{0} ? Vec3{0, 0, 1} : normalize(of_moderate_size(v)); }

/// Tests whether the solid angle is one, and samples have unit directions, distances and densities; those
/// without light have an infinite density.
bool is_sound(const auto& view) {
  const double solid_angle = view.solid_angle();
  if (!(0 <= solid_angle && solid_angle <= 4 * std::numbers::pi * (1 + 4 * ulp))) return false;
  constexpr double low = 0x1p-54, high = 1 - ulp / 2;
  for (const double u : {low, 0x1p-33, 0.3, 0.5, 1 - 0x1p-33, high})
    for (const double v : {low, 0.25, 0.5, 0.7, high}) {
      const auto [direction, distance, density] = view.sample(u, v);
      if (!(std::abs(length(direction) - 1) < 20 * ulp)) return false;
      if (!(0 <= distance && distance < infinity && density > 0)) return false;
      if (solid_angle > 0x1p-1000 && !(density < infinity)) return false;
    }
  return true;
}

}  // namespace

TEST_CASE("views of triangles, disks and spheres are sound for all magnitudes of a scene") {
  Random random(1);
  WrongCases wrong(random);
  for (int i = 0; i < cases(20000, 400000); ++i) {
    const Point place = i % 3 == 0 ? vector(random) : Vec3{0};
    const Point p = place + vector(random);
    Point q = place + vector(random), r = place + vector(random), from = vector(random);
    if (i % 7 == 3) q = p + vector(random), r = p + vector(random);
    const double a = random.real(0, 1), b = random.real(0, 1);
    if (i % 5 == 1) from = p + vector(random);
    if (i % 5 == 2) from = p + a * (q - p) + b * (r - p);
    if (i % 5 == 3) from = a * p + (1 - a) * q + vector(random);
    wrong.add(!is_sound(TriangleView(from, p, q, r)), "triangle", from, p, q, r);

    const Vec3 normal = direction_of(vector(random)), across = normalize(cross(normal, random.direction()));
    const double radius = magnitude(random);
    if (i % 5 == 3) from = p + radius * random.direction();
    if (i % 5 == 4) from = p + (0.5 + a) * radius * across;
    if (i % 10 == 4) from += magnitude(random) * random.direction();
    if (i % 11 == 0) from = p + radius * Vec3{1, 0, 0};
    wrong.add(!is_sound(DiskView(from, p, magnitude(random) * normal, radius)), "disk", from, p, normal,
              radius);
    wrong.add(!is_sound(SphereView(from, p, radius)), "sphere", from, p, radius);
  }
  CHECK(wrong == 0);
}

TEST_CASE(
    "views of parallelograms, and of rectangles from each of some points, are sound for all magnitudes") {
  Random random(2);
  WrongCases wrong(random);
  for (int i = 0; i < cases(20000, 400000); ++i) {
    const Vec3 u = magnitude(random) * direction_of(vector(random)),
               across = normalize(cross(direction_of(u), random.direction()));
    const Vec3 v = magnitude(random) * (i % 3 == 0 ? direction_of(vector(random)) : across);
    if (cross(direction_of(u), direction_of(v)) == Vec3{0}) continue;
    const Point p = i % 2 == 0 ? vector(random) : Vec3{0};
    Point from = vector(random);
    if (i % 5 < 3) from = p + random.real(0, 1) * u + random.real(0, 1) * v;
    if (i % 5 < 2)
      from += magnitude(random) * (i % 5 == 0 ? random.direction() : cross(direction_of(u), across));
    const ParallelogramLight light(p, u, v);
    wrong.add(!is_sound(ParallelogramView(from, light)), from, p, u, v);
    if (!light.rectangle) continue;
    const FewNumbers a{0.3}, b{0.6};
    std::array<LightSample, simd::double_lanes> drawn;
    RectangleView::sample_each(*light.rectangle, {&from, 1}, a, b, drawn);
    const LightSample alone = RectangleView(from, *light.rectangle).sample(0.3, 0.6);
    wrong.add(drawn[0].direction != alone.direction || drawn[0].distance != alone.distance ||
                  drawn[0].density != alone.density,
              "lanes", from, p, u, v);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a light of any size is as large as its view says, however close the point") {
  // A quarter of a plane from over its corner, from over an edge, and a far triangle of a known area.
  for (int exponent = 100; exponent <= 350; exponent += 25) {
    CAPTURE(exponent);
    const double small = std::ldexp(1, -exponent), large = std::ldexp(1, exponent);
    // As views promise, 20u for a triangle and 32u for a disk, and 3u for the quotient and the expected
    // number.
    constexpr double triangle = 20, disk = 32;
    const auto is_near = [](double x, double expected, double roundings) {
      return std::abs(x / expected - 1) <= (roundings + 3) * 0x1p-53;
    };
    const Point corner{0, 0, 0}, x{large, 0, 0}, y{0, large, 0};
    CHECK(is_near(TriangleView({0, 0, small}, corner, x, y).solid_angle(), std::numbers::pi / 2, triangle));
    CHECK(is_near(TriangleView({small, small, small}, corner, x, y).solid_angle(),
                  TriangleView({1, 1, 1}, corner, {0x1p90, 0, 0}, {0, 0x1p90, 0}).solid_angle(),
                  2 * triangle));
    CHECK(is_near(TriangleView({0, 0, 1}, corner, small * Vec3{1, 0, 0}, small * Vec3{0, 1, 0}).solid_angle(),
                  small * small / 2, triangle));
    // Beside a disk at a small height: Ω = h R² ∫ … is in proportion to the height.
    const Point beside{3, 0, 0};
    CHECK(is_near(DiskView(beside + Vec3{0, 0, small}, corner, {0, 0, 1}, 1).solid_angle() / small,
                  DiskView(beside + Vec3{0, 0, 0x1p-60}, corner, {0, 0, 1}, 1).solid_angle() / 0x1p-60,
                  2 * disk));
    CHECK(is_near(DiskView({0, 0, 1}, corner, {0, 0, 1}, small).solid_angle(),
                  std::numbers::pi * small * small, disk));
    CHECK(
        is_near(DiskView({0, 0, small}, corner, {0, 0, 1}, large).solid_angle(), 2 * std::numbers::pi, disk));
  }
}

TEST_CASE("a sphere is met at once from its surface, also along it, where a number is 0") {
  const SphereView view({0, 0, 1}, {0, 0, 0}, 1);
  for (const double u : {0.0, 0.25, 1.0})
    for (const double v : {0.0, 0.5, 1.0}) {
      CAPTURE(u, v);
      CHECK(view.sample(u, v).distance == 0);
      CHECK(view.sample(u, v).density == 1 / (2 * std::numbers::pi));
    }
}

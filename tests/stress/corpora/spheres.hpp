// Corpora of rays and spheres that are hard cases.
#pragma once

#include <cmath>
#include <protostar/camera.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Point, protostar::Sphere, protostar::Vec3;
using SphereCase = Case<Sphere>;

inline SphereCase tutorial(Random& random) {
  static constexpr Sphere spheres[] = {{{0, 0, 3}, 1}, {{-1.5, 0, 5}, 1}, {{0, -1001, 3}, 1000}};
  const int y = whole(random, 0, 479), x = whole(random, 0, 639);
  return {protostar::Camera{}.through_pixel(x, y, 640, 480), spheres[whole(random, 0, 2)]};
}

/// Returns a sphere and a ray, with radius and distance of any size, independent of each other.
inline SphereCase scales(Random& random) {
  const double r = size(random, -100, 100), distance = size(random, -100, 100);
  const double impact = r * random.real(0, 1.2);
  return {passing(random, Point{0}, impact, coin(random) ? distance : -distance), {Point{0}, r}};
}

/// Returns a nearly tangent ray, with an impact parameter of r (1 ± 2^-k).
inline SphereCase grazing(Random& random) {
  const double r = size(random, -10, 10), ahead = r * size(random, -3, 10);
  const Point center = coin(random) ? Point{0} : random.point(r);
  const double impact = r * (1 + tiny(random, 1, 50));
  return {passing(random, center, impact, ahead), {center, r}};
}

/// Returns a ray that starts inside, on or next to the sphere.
inline SphereCase origins(Random& random) {
  const double r = size(random, -10, 10);
  const Sphere sphere{coin(random) ? Point{0} : random.point(r), r};
  const double off = tiny(random, 10, 54), inside = random.real(0, 1);
  const double from_center = coin(random) ? inside : coin(random) ? 1 : 1 + off;
  return {{sphere.center + r * from_center * random.direction(), random.direction()}, sphere};
}

inline SphereCase far_away(Random& random) {
  const double r = size(random, -10, 10);
  const double far = r * size(random, 0, 40), ahead = r * size(random, -3, 10),
               impact = r * random.real(0, 1.2);
  const Point center = random.point(far);
  return {passing(random, center, impact, ahead), {center, r}};
}

/// Returns whole numbers for which the line is exactly tangent, except for a nudge.
inline SphereCase tangents(Random& random) {
  const int k = whole(random, 1, 50), times = whole(random, 0, 2);
  // (3, 4, 0) is 5 long and at a right angle to (-4, 3, z).
  const Vec3 d = turned({-4, 3, whole(random, -9, 9)}, times), radius = turned({3 * k, 4 * k, 0}, times);
  const Point center = whole_vector(random, -99, 99);
  const double ahead = whole(random, -9, 99);
  Point origin = center + radius - ahead * d;
  nudge(random, origin);
  const double unit = std::ldexp(1, whole(random, -30, 30));
  return {{unit * origin, std::ldexp(1, whole(random, -30, 30)) * d}, {unit * center, unit * (5 * k)}};
}

/// Returns a ray whose direction is not of unit length.
inline SphereCase directions(Random& random) {
  SphereCase c = grazing(random);
  c.surface.radius *= random.real(0.8, 1.2);
  c.ray.direction *= size(random, -10, 10);
  return c;
}

/// Returns a ray to a point of the sphere: t = 1 to within rounding.
inline SphereCase ends(Random& random) {
  const double r = size(random, -10, 10);
  const Sphere sphere{coin(random) ? Point{0} : random.point(10 * r), r};
  const Point target = sphere.center + r * random.direction();
  const Point origin = sphere.center + random.point(3 * r);
  return {{origin, target - origin}, sphere};
}

/// Returns a ray to a whole point of the sphere: t = 1 exactly, except for a nudge; across, it moves t by
/// about 2^-100.
inline SphereCase whole_ends(Random& random) {
  const int k = whole(random, 1, 50), times = whole(random, 0, 2);
  const Point center = whole_vector(random, -99, 99);
  const Vec3 radius = coin(random) ? Vec3{5 * k, 0, 0} : Vec3{3 * k, 4 * k, 0};
  Point target = center + turned(radius, times);
  nudge(random, target);
  const Point origin = center + whole_vector(random, -99, 99);
  if (origin == target) return whole_ends(random);
  return {{origin, target - origin}, {center, 5.0 * k}};
}

/// Returns a ray that leaves the sphere, outwards, inwards or along it.
inline SphereCase leaving(Random& random) {
  const double r = size(random, -20, 20), far = r * size(random, 0, 20), slope = tiny(random, 1, 60);
  const Sphere sphere{coin(random) ? Point{0} : random.point(far), r};
  const Vec3 normal = random.direction();
  const Vec3 d = coin(random) ? random.direction() : across(random, normal) + slope * normal;
  return {{sphere.center + r * normal, size(random, -10, 10) * d, sphere.departure()}, sphere};
}

/// Returns a case of sizes whose squares or products leave the range of double.
inline SphereCase exponents(Random& random) {
  SphereCase c = coin(random) ? grazing(random) : coin(random) ? tangents(random) : far_away(random);
  const int lengths = whole(random, -950, 950), lengthened = whole(random, -900, 900);
  const double unit = std::ldexp(1, lengths);
  if (std::abs(lengths - lengthened) > 950) return exponents(random);
  return {{unit * c.ray.origin, std::ldexp(1, lengthened) * c.ray.direction},
          {unit * c.surface.center, unit * c.surface.radius}};
}

inline const std::vector<Corpus<Sphere>> of_spheres{
    {"tutorial", tutorial},     {"scales", scales},     {"grazing", grazing},       {"origins", origins},
    {"far", far_away},          {"tangents", tangents}, {"directions", directions}, {"ends", ends},
    {"whole ends", whole_ends}, {"leaving", leaving},   {"exponents", exponents}};

}  // namespace corpora

// Corpora of rays and planes that are hard cases.
#pragma once

#include <cmath>
#include <protostar/ray.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Plane, protostar::Point, protostar::Vec3;
using PlaneCase = Case<Plane>;

inline PlaneCase planes(Random& random) {
  const double far = size(random, -10, 10), length = size(random, -10, 10);
  const Point origin = random.point(far);
  const Vec3 direction = random.direction(), normal = length * random.direction();
  return {{origin, direction}, {normal, random.real(-10, 10)}};
}

/// Returns a ray that is nearly parallel to the plane.
inline PlaneCase planes_grazing(Random& random) {
  PlaneCase c = planes(random);
  const double length = size(random, -10, 10), slope = tiny(random, 1, 60);
  c.ray.direction = length * (across(random, c.surface.normal) + slope * normalize(c.surface.normal));
  return c;
}

/// Returns a ray whose origin is far from the coordinate origin, on or next to the plane.
inline PlaneCase planes_far(Random& random) {
  PlaneCase c = planes(random);
  const double far = size(random, 0, 40), off = tiny(random, 10, 54);
  c.ray.origin = random.point(far);
  c.surface.distance = dot(c.surface.normal, c.ray.origin) * (coin(random) ? 1 : 1 + off);
  return c;
}

/// Returns small whole numbers: origins in the plane, directions along it, and t = 1; except for nudges.
inline PlaneCase planes_whole(Random& random) {
  PlaneCase c{{whole_vector(random, -2, 2), whole_vector(random, -2, 2)}, {whole_vector(random, -2, 2), 0}};
  c.surface.distance = whole(random, -2, 2);
  nudge(random, c.ray.origin), nudge(random, c.ray.direction), nudge(random, c.surface.normal);
  return c.surface.normal == Vec3{0} || c.ray.direction == Vec3{0} ? planes_whole(random) : c;
}

inline PlaneCase planes_ends(Random& random) {
  PlaneCase c = planes(random);
  const Point target = random.point(10);
  c.surface.distance = dot(c.surface.normal, target);
  c.ray.direction = target - c.ray.origin;
  return c;
}

inline PlaneCase planes_exponents(Random& random) {
  PlaneCase c = coin(random)   ? planes_far(random)
                : coin(random) ? planes_grazing(random)
                               : planes_whole(random);
  const int lengths = whole(random, -900, 900), lengthened = whole(random, -900, 900),
            normals = whole(random, -900, 900);
  if (std::abs(lengths - lengthened) > 900 || std::abs(lengths + normals) > 900)
    return planes_exponents(random);
  return {{std::ldexp(1, lengths) * c.ray.origin, std::ldexp(1, lengthened) * c.ray.direction},
          {std::ldexp(1, normals) * c.surface.normal, std::ldexp(c.surface.distance, lengths + normals)}};
}

inline const std::vector<Corpus<Plane>> of_planes{
    {"planes", planes},           {"planes grazing", planes_grazing},
    {"planes far", planes_far},   {"planes whole", planes_whole},
    {"planes ends", planes_ends}, {"planes exponents", planes_exponents}};

}  // namespace corpora

// Corpora of rays and instances of spheres and planes that are hard cases.
#pragma once

#include <cmath>
#include <protostar/numeric/affine.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "stress/made_of.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Affine, protostar::Plane, protostar::Point, protostar::Ray, protostar::Sphere,
    protostar::Vec3;
using PlacedSphereCase = Case<Placed<Sphere>>;
using PlacedPlaneCase = Case<Placed<Plane>>;

/// Returns a map that stretches each axis by 2^-4 to 2^4, mirrors, rotates, shears by up to 1/2, and moves
/// far.
inline Affine any_map(Random& random) {
  const double far = size(random, -10, 20), unit = size(random, -10, 10), angle = random.real(0, 360);
  const Vec3 stretches{size(random, -4, 4), size(random, -4, 4), -size(random, -4, 4)},
      move = random.point(far), axis = random.direction();
  const Affine sheared{.x = {1, random.real(-0.5, 0.5), 0}};
  return sheared.scaled_by(unit * stretches).rotated_about(axis, angle).moved_by(move);
}

inline Ray carried(const Ray& ray, const Affine& map) {
  return {map.point(ray.origin), map.vector(ray.direction)};
}

/// Returns a ray that is clear of the sphere's outline, inside or outside by any part of the radius.
inline PlacedSphereCase instances(Random& random) {
  const double r = size(random, -10, 10);
  const Sphere own{random.point(10 * r), r};
  const double past = coin(random) ? size(random, -52, -4) : random.real(0.1, 1);
  const double impact = coin(random) ? r * (1 - past) : r * (1 + past);
  const double outside = r * size(random, 1, 10), inside = r * random.real(-0.2, 0.2),
               ahead = coin(random)   ? outside
                       : coin(random) ? -outside
                                      : inside;
  const Ray ray = passing(random, own.center, impact, ahead);
  const Affine map = any_map(random);
  const double length = size(random, -10, 10);
  const Ray there = carried(ray, map);
  return {{there.origin, length * there.direction}, Placed(own, map)};
}

/// Returns a ray at any slope to an instance of a plane.
inline PlacedPlaneCase instances_of_planes(Random& random) {
  const Vec3 n = random.direction(), d = random.direction();
  const Point target = random.point(10);
  const double ahead = coin(random) ? size(random, 1, 10) : -size(random, 1, 10);
  const Affine map = any_map(random);
  const double length = size(random, -10, 10), factor = size(random, -10, 10);
  const Ray there = carried({target - ahead * d, d}, map);
  return {{there.origin, length * there.direction}, Placed(Plane{factor * n, factor * dot(n, target)}, map)};
}

/// Returns a map of few digits, whose inverse has few digits, too: a few times, a multiple of one axis is
/// added to another; then, powers of two along the axes.
inline Affine whole_map(Random& random) {
  Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    const int from = whole(random, 0, 2), to = (from + whole(random, 1, 2)) % 3;
    axes[to] += static_cast<double>(whole(random, -2, 2)) * axes[from];
  }
  for (Vec3& axis : axes) axis *= std::ldexp(1, whole(random, -3, 3));
  return {axes[0], axes[1], axes[2], whole_vector(random, -99, 99)};
}

/// Returns whole numbers for which the line is exactly tangent, except for a nudge that leaves all mapped
/// numbers exact; times powers of two, some so large or small that squares or products leave the range of
/// double.
inline PlacedSphereCase instances_whole(Random& random) {
  const int k = whole(random, 1, 50), times = whole(random, 0, 2);
  const Vec3 d = turned({-4, 3, whole(random, -9, 9)}, times), radius = turned({3 * k, 4 * k, 0}, times);
  const Point center = whole_vector(random, -99, 99);
  const double ahead = whole(random, -9, 99);
  Point origin = center + radius - ahead * d;
  if (whole(random, 0, 2) == 0) origin[whole(random, 0, 2)] += tiny(random, 10, 20);
  const Affine map = whole_map(random);
  const int most = coin(random) ? 300 : 0;
  const double unit = std::ldexp(1, whole(random, -most, most));
  const Ray there = carried({origin, d}, map);
  return {{unit * there.origin, std::ldexp(1, whole(random, -most, most)) * there.direction},
          Placed(Sphere{center, 5.0 * k},
                 Affine{unit * map.x, unit * map.y, unit * map.z, unit * map.translation})};
}

inline PlacedPlaneCase instances_of_planes_whole(Random& random) {
  const Point origin = whole_vector(random, -2, 2);
  const Vec3 direction = whole_vector(random, -2, 2), normal = whole_vector(random, -2, 2);
  const Plane own{normal, static_cast<double>(whole(random, -2, 2))};
  const Affine map = whole_map(random);
  return {carried({origin, direction}, map), Placed(own, map)};
}

/// Returns a ray that leaves a whole point of the image of a sphere, in any whole direction and along it.
inline PlacedSphereCase instances_leaving(Random& random) {
  const int k = whole(random, 1, 50), times = whole(random, 0, 2);
  const Point center = whole_vector(random, -99, 99);
  const Vec3 radius = turned({3 * k, 4 * k, 0}, times);
  const Vec3 d = coin(random) ? turned({-4, 3, whole(random, -9, 9)}, times) : whole_vector(random, -9, 9);
  const Affine map = whole_map(random);
  PlacedSphereCase c{carried({center + radius, d}, map), Placed(Sphere{center, 5.0 * k}, map)};
  c.ray.departure = c.surface.departure();
  return c;
}

inline const std::vector<Corpus<Placed<Sphere>>> of_placed_spheres{
    {"instances", instances}, {"i. whole", instances_whole}, {"i. leaving", instances_leaving}};

inline const std::vector<Corpus<Placed<Plane>>> of_placed_planes{
    {"i. planes", instances_of_planes}, {"i. planes whole", instances_of_planes_whole}};

}  // namespace corpora

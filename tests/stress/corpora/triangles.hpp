// Corpora of rays and triangles that are hard cases.
#pragma once

#include <cmath>
#include <protostar/ray.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Point, protostar::Triangle, protostar::Vec3;
using TriangleCase = Case<Triangle>;

/// Returns the point a + u (b − a) + v (c − a).
inline Point place_in(const Triangle& s, double u, double v) {
  return s.a + u * (s.b - s.a) + v * (s.c - s.a);
}

/// Returns a triangle of any size, with edges at any angle, and a ray to a point in its plane, inside or
/// beside it.
inline TriangleCase triangles(Random& random) {
  const double to_b = size(random, -10, 10), to_c = size(random, -10, 10), far = size(random, -10, 10);
  const Point a = random.point(far), origin = random.point(far);
  const Vec3 ab = to_b * random.direction(), ac = to_c * random.direction();
  const Triangle s{a, a + ab, a + ac};
  const double u = random.real(-0.25, 1.25), v = random.real(-0.25, 1.25);
  return {{origin, size(random, -10, 10) * (place_in(s, u, v) - origin)}, s};
}

/// Returns a ray to an edge or a vertex, or next to it.
inline TriangleCase triangles_edges(Random& random) {
  TriangleCase c = triangles(random);
  const int first = whole(random, 0, 2);
  const Point points[] = {c.surface.a, c.surface.b, c.surface.c};
  const Triangle from_edge{points[first], points[(first + 1) % 3], points[(first + 2) % 3]};
  const double off = coin(random) ? 0 : tiny(random, 20, 60), along = random.real(0, 1);
  c.ray.direction = place_in(from_edge, coin(random) ? along : 0, off) - c.ray.origin;
  return c;
}

/// Returns a ray that starts next to the plane, or runs nearly along it.
inline TriangleCase triangles_grazing(Random& random) {
  TriangleCase c = triangles(random);
  const Triangle& s = c.surface;
  const Vec3 normal = cross(s.b - s.a, s.c - s.a);
  const double off = tiny(random, 1, 60), u = random.real(-0.5, 1), v = random.real(-0.5, 1);
  const Point beside = place_in(s, u, v);
  if (coin(random)) {
    c.ray.origin = beside + off * normal;
  } else {
    const double p = random.real(-1, 1), q = random.real(-1, 1);
    c.ray.direction = place_in(s, p, q) - s.a + off * normal;
    c.ray.origin = beside - size(random, -3, 3) * c.ray.direction;
  }
  return c;
}

/// Returns small whole numbers: rays through edges and vertices, along the plane and in it, triangles without
/// area; except for nudges.
inline TriangleCase triangles_whole(Random& random) {
  TriangleCase c;
  c.surface = {whole_vector(random, -2, 2), whole_vector(random, -2, 2), whole_vector(random, -2, 2)};
  c.ray = {whole_vector(random, -3, 3), whole_vector(random, -3, 3)};
  if (coin(random)) {
    const double u = 0.5 * whole(random, -1, 3), v = 0.5 * whole(random, -1, 3);
    c.ray.direction = place_in(c.surface, u, v) - c.ray.origin;
  }
  nudge(random, c.ray.origin), nudge(random, c.ray.direction), nudge(random, c.surface.b);
  return c;
}

/// Returns a sliver: a vertex is nearly on the line through the others, or nearly equal to one of them.
inline TriangleCase triangles_thin(Random& random) {
  TriangleCase c = triangles(random);
  Triangle& s = c.surface;
  const double thickness = tiny(random, 1, 60), along = random.real(-1, 2);
  s.c = place_in(s, coin(random) ? along : 0, thickness);
  const double u = random.real(-0.1, 1.1), v = random.real(-0.1, 1.1 - u);
  c.ray.direction = place_in(s, u, v) - c.ray.origin;
  return c;
}

inline TriangleCase triangles_exponents(Random& random) {
  const TriangleCase c = coin(random)   ? triangles_edges(random)
                         : coin(random) ? triangles_grazing(random)
                                        : triangles_whole(random);
  const int lengths = whole(random, -900, 900), lengthened = whole(random, -900, 900);
  if (std::abs(lengths - lengthened) > 900) return triangles_exponents(random);
  const double unit = std::ldexp(1, lengths);
  return {{unit * c.ray.origin, std::ldexp(1, lengthened) * c.ray.direction},
          {unit * c.surface.a, unit * c.surface.b, unit * c.surface.c}};
}

inline const std::vector<Corpus<Triangle>> of_triangles{
    {"triangles", triangles},      {"t. edges", triangles_edges}, {"t. grazing", triangles_grazing},
    {"t. whole", triangles_whole}, {"t. thin", triangles_thin},   {"t. exponents", triangles_exponents}};

}  // namespace corpora

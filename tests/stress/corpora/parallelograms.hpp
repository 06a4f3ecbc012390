// Corpora of rays and parallelograms that are hard cases.
#pragma once

#include <cmath>
#include <protostar/ray.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Parallelogram, protostar::Point, protostar::Vec3;
using ParallelogramCase = Case<Parallelogram>;

/// Returns a parallelogram of any size, with edges at any angle, and a ray to a point in its plane, inside or
/// beside it.
inline ParallelogramCase parallelograms(Random& random) {
  const double u = size(random, -10, 10), v = size(random, -10, 10), far = size(random, -10, 10);
  const Point position = random.point(far), origin = random.point(far);
  const Parallelogram s{position, u * random.direction(), v * random.direction()};
  const double a = random.real(-0.5, 1.5), b = random.real(-0.5, 1.5);
  const double length = size(random, -10, 10);
  return {{origin, length * (s.position + a * s.edge_u + b * s.edge_v - origin)}, s};
}

/// Returns a ray to the outline or next to it.
inline ParallelogramCase parallelograms_outline(Random& random) {
  ParallelogramCase c = parallelograms(random);
  const double off = coin(random) ? 0 : tiny(random, 20, 60);
  const double a = random.real(0, 1), b = whole(random, 0, 1) + off;
  const Parallelogram& s = c.surface;
  const Vec3 along = coin(random) ? a * s.edge_u + b * s.edge_v : b * s.edge_u + a * s.edge_v;
  c.ray.direction = s.position + along - c.ray.origin;
  return c;
}

/// Returns a ray that starts next to the plane, or runs nearly along it.
inline ParallelogramCase parallelograms_grazing(Random& random) {
  ParallelogramCase c = parallelograms(random);
  const Parallelogram& s = c.surface;
  const Vec3 normal = cross(s.edge_u, s.edge_v);
  const double off = tiny(random, 1, 60), a = random.real(-1, 2), b = random.real(-1, 2);
  const Point beside = s.position + a * s.edge_u + b * s.edge_v;
  if (coin(random)) {
    c.ray.origin = beside + off * normal;
  } else {
    const double p = random.real(-1, 1), q = random.real(-1, 1);
    c.ray.direction = p * s.edge_u + q * s.edge_v + off * normal;
    c.ray.origin = beside - size(random, -3, 3) * c.ray.direction;
  }
  return c;
}

/// Returns small whole numbers: rays through edges and vertices, along the plane and in it; except for
/// nudges.
inline ParallelogramCase parallelograms_whole(Random& random) {
  ParallelogramCase c;
  c.surface = {whole_vector(random, -2, 2), whole_vector(random, -2, 2), whole_vector(random, -2, 2)};
  c.ray = {whole_vector(random, -3, 3), whole_vector(random, -3, 3)};
  if (coin(random)) {
    const double a = 0.5 * whole(random, -1, 3), b = 0.5 * whole(random, -1, 3);
    c.ray.direction = c.surface.position + a * c.surface.edge_u + b * c.surface.edge_v - c.ray.origin;
  }
  nudge(random, c.ray.origin), nudge(random, c.ray.direction), nudge(random, c.surface.edge_u);
  return c;
}

/// Returns a parallelogram whose edges are nearly parallel, or of very different lengths.
inline ParallelogramCase parallelograms_thin(Random& random) {
  ParallelogramCase c = parallelograms(random);
  Parallelogram& s = c.surface;
  const double thickness = tiny(random, 1, 60);
  s.edge_v = coin(random) ? s.edge_u + thickness * s.edge_v : thickness * s.edge_v;
  const double a = random.real(-0.1, 1.1), b = random.real(-0.1, 1.1);
  c.ray.direction = s.position + a * s.edge_u + b * s.edge_v - c.ray.origin;
  return c;
}

inline ParallelogramCase parallelograms_exponents(Random& random) {
  const ParallelogramCase c = coin(random)   ? parallelograms_outline(random)
                              : coin(random) ? parallelograms_grazing(random)
                                             : parallelograms_whole(random);
  const int lengths = whole(random, -900, 900), lengthened = whole(random, -900, 900);
  if (std::abs(lengths - lengthened) > 900) return parallelograms_exponents(random);
  const double unit = std::ldexp(1, lengths);
  return {{unit * c.ray.origin, std::ldexp(1, lengthened) * c.ray.direction},
          {unit * c.surface.position, unit * c.surface.edge_u, unit * c.surface.edge_v}};
}

inline const std::vector<Corpus<Parallelogram>> of_parallelograms{
    {"parallelograms", parallelograms},     {"p. outline", parallelograms_outline},
    {"p. grazing", parallelograms_grazing}, {"p. whole", parallelograms_whole},
    {"p. thin", parallelograms_thin},       {"p. exponents", parallelograms_exponents}};

}  // namespace corpora

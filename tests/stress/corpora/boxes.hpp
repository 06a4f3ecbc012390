// Corpora of rays and boxes that are hard cases.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Box, protostar::Point, protostar::Vec3;
using BoxCase = Case<Box>;

inline Box box_around(const Point& a, const Point& b) { return {glm::min(a, b), glm::max(a, b)}; }

/// Returns a number between the two ends, or one of them.
inline double between(Random& random, double a, double b, bool at_an_end) {
  const double share = random.real(0, 1);
  return !at_an_end ? a + share * (b - a) : coin(random) ? a : b;
}

/// Returns a box of any size and shape, and a ray to a point in it or beside it.
inline BoxCase boxes(Random& random) {
  const double far = size(random, -10, 10), wide = size(random, -10, 10), high = size(random, -10, 10);
  const Point corner = random.point(far), origin = random.point(far);
  const Box box = box_around(corner, corner + Vec3{wide, high, wide} * random.point(1));
  const Vec3 share{random.real(-0.5, 1.5), random.real(-0.5, 1.5), random.real(-0.5, 1.5)};
  const double length = size(random, -10, 10);
  return {{origin, length * (box.min + share * (box.max - box.min) - origin)}, box};
}

/// Returns a ray to a point of an edge or a vertex, or next to it.
inline BoxCase boxes_edges(Random& random) {
  BoxCase c = boxes(random);
  const int along = whole(random, 0, 3);
  for (int axis = 0; axis < 3; ++axis)
    c.ray.direction[axis] =
        between(random, c.surface.min[axis], c.surface.max[axis], axis != along) - c.ray.origin[axis];
  nudge(random, c.ray.direction), nudge(random, c.ray.origin);
  return c;
}

/// Returns small whole numbers: rays along faces and through edges and vertices, flat boxes; except for
/// nudges.
inline BoxCase boxes_whole(Random& random) {
  const Point a = whole_vector(random, -2, 2), b = whole_vector(random, -2, 2);
  BoxCase c{{whole_vector(random, -3, 3), whole_vector(random, -2, 2)}, box_around(a, b)};
  nudge(random, c.ray.origin), nudge(random, c.ray.direction);
  return c;
}

/// Returns a thin box, far away.
inline BoxCase boxes_thin(Random& random) {
  BoxCase c = boxes(random);
  const int axis = whole(random, 0, 2);
  const double far = size(random, 0, 40), thickness = tiny(random, 1, 60);
  c.surface.min[axis] += far;
  c.surface.max[axis] = c.surface.min[axis] * (1 + std::abs(thickness));
  if (c.surface.max[axis] < c.surface.min[axis]) c.surface.max[axis] = c.surface.min[axis];
  const Vec3 share{random.real(-0.1, 1.1), random.real(-0.1, 1.1), random.real(-0.1, 1.1)};
  c.ray.direction = c.surface.min + share * (c.surface.max - c.surface.min) - c.ray.origin;
  return c;
}

/// Returns a ray that leaves a face, or another surface in its plane, then also from beside the face, in any
/// direction and along the face.
inline BoxCase boxes_leaving(Random& random) {
  BoxCase c = boxes(random);
  const int face = whole(random, 0, 5);
  const bool is_own = coin(random);
  for (int axis = 0; axis < 3; ++axis) {
    const double share = is_own ? std::clamp(random.real(-0.2, 1.2), 0.0, 1.0) : random.real(-0.2, 1.2);
    c.ray.origin[axis] = c.surface.min[axis] + share * (c.surface.max[axis] - c.surface.min[axis]);
  }
  c.ray.direction = random.direction();
  c.ray.origin[face / 2] = face % 2 == 0 ? c.surface.min[face / 2] : c.surface.max[face / 2];
  nudge(random, c.ray.origin);
  if (whole(random, 0, 9) == 0) c.ray.direction[face / 2] = 0;
  c.ray.departure = c.surface.departure(face);
  if (!is_own) c.ray.departure.object = nullptr;
  return c;
}

inline BoxCase boxes_exponents(Random& random) {
  const BoxCase c = coin(random) ? boxes_edges(random) : coin(random) ? boxes(random) : boxes_whole(random);
  const int lengths = whole(random, -900, 900), lengthened = whole(random, -900, 900);
  if (std::abs(lengths - lengthened) > 900) return boxes_exponents(random);
  const double unit = std::ldexp(1, lengths);
  return {{unit * c.ray.origin, std::ldexp(1, lengthened) * c.ray.direction},
          {unit * c.surface.min, unit * c.surface.max}};
}

inline const std::vector<Corpus<Box>> of_boxes{
    {"boxes", boxes},           {"boxes edges", boxes_edges},     {"boxes whole", boxes_whole},
    {"boxes thin", boxes_thin}, {"boxes leaving", boxes_leaving}, {"boxes exponents", boxes_exponents}};

}  // namespace corpora

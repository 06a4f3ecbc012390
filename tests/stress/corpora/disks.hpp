// Corpora of rays and disks that are hard cases.
#pragma once

#include <cmath>
#include <protostar/ray.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Disk, protostar::Point;
using DiskCase = Case<Disk>;

/// Returns a disk of any size, at any angle, and a ray to a point in its plane, inside or beside it.
inline DiskCase disks(Random& random) {
  const double radius = size(random, -10, 10), tilt = size(random, -10, 10), far = size(random, -10, 10);
  const Point position = random.point(far), origin = random.point(far);
  const Disk disk{position, tilt * random.direction(), radius};
  const double off = radius * random.real(0, 1.5), length = size(random, -10, 10);
  return {{origin, length * (disk.position + off * across(random, disk.normal) - origin)}, disk};
}

/// Returns a ray to the outline or next to it.
inline DiskCase disks_outline(Random& random) {
  DiskCase c = disks(random);
  const double off = coin(random) ? 0 : tiny(random, 20, 60);
  c.ray.direction =
      c.surface.position + c.surface.radius * (1 + off) * across(random, c.surface.normal) - c.ray.origin;
  return c;
}

/// Returns a ray that starts next to the plane, or runs nearly along it.
inline DiskCase disks_grazing(Random& random) {
  DiskCase c = disks(random);
  const double off = tiny(random, 1, 60), from_center = c.surface.radius * random.real(0, 1.5);
  const Point beside = c.surface.position + from_center * across(random, c.surface.normal);
  if (coin(random)) {
    c.ray.origin = beside + off * c.surface.normal;
  } else {
    c.ray.direction = across(random, c.surface.normal) + off * c.surface.normal;
    c.ray.origin = beside - size(random, -3, 3) * c.ray.direction;
  }
  return c;
}

/// Returns small whole numbers: rays to the points (3k, 4k) of an outline, along the plane and in it; except
/// for nudges.
inline DiskCase disks_whole(Random& random) {
  const int k = whole(random, 1, 9), times = whole(random, 0, 2);
  DiskCase c{{whole_vector(random, -9, 9), whole_vector(random, -9, 9)},
             {whole_vector(random, -9, 9), turned({0, 0, whole(random, 1, 3)}, times), 5.0 * k}};
  if (coin(random)) c.ray.direction = c.surface.position + turned({3 * k, 4 * k, 0}, times) - c.ray.origin;
  nudge(random, c.ray.origin), nudge(random, c.ray.direction), nudge(random, c.surface.normal);
  return c;
}

inline DiskCase disks_exponents(Random& random) {
  const DiskCase c = coin(random)   ? disks_outline(random)
                     : coin(random) ? disks_grazing(random)
                                    : disks_whole(random);
  const int lengths = whole(random, -900, 900), lengthened = whole(random, -900, 900),
            normals = whole(random, -900, 900);
  if (std::abs(lengths - lengthened) > 900) return disks_exponents(random);
  const double unit = std::ldexp(1, lengths);
  return {{unit * c.ray.origin, std::ldexp(1, lengthened) * c.ray.direction},
          {unit * c.surface.position, std::ldexp(1, normals) * c.surface.normal, unit * c.surface.radius}};
}

inline const std::vector<Corpus<Disk>> of_disks{{"disks", disks},
                                                {"disks outline", disks_outline},
                                                {"disks grazing", disks_grazing},
                                                {"disks whole", disks_whole},
                                                {"disks exponents", disks_exponents}};

}  // namespace corpora

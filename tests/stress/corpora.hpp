// Corpora of rays and surfaces that are hard cases, each of one kind.
#pragma once

#include <protostar/camera.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <utility>
#include <vector>

#include "made_of.hpp"
#include "support/random.hpp"

template <class S>
struct Case {
  protostar::Ray ray;
  S surface;
};

template <class S>
struct Corpus {
  const char* name;
  Case<S> (*next)(Random&);
};

// The order in which the operands of a sum or the arguments of a call are evaluated is the compiler's choice,
// so a statement draws no more than one random number, unless braces set the order.
namespace corpora {

using protostar::Affine, protostar::Box, protostar::Csg, protostar::Disk, protostar::Parallelogram,
    protostar::Plane, protostar::Point, protostar::Quadric, protostar::QuadricForm, protostar::Ray,
    protostar::Sphere, protostar::Triangle, protostar::Vec3;
using SphereCase = Case<Sphere>;
using PlaneCase = Case<Plane>;
using ParallelogramCase = Case<Parallelogram>;
using TriangleCase = Case<Triangle>;
using DiskCase = Case<Disk>;
using BoxCase = Case<Box>;
using QuadricCase = Case<Quadric>;
using PlacedSphereCase = Case<Placed<Sphere>>;
using PlacedPlaneCase = Case<Placed<Plane>>;
using MadeCase = Case<Made>;

inline int whole(Random& random, int min, int max) {
  return min + static_cast<int>(random.bits() % static_cast<std::uint64_t>(max - min + 1));
}
inline bool coin(Random& random) { return (random.bits() & 1) != 0; }

/// Returns a number whose logarithm is uniform, from 2^min to 2^max.
inline double size(Random& random, int min, int max) {
  const double mantissa = random.real(1, 2);
  return std::ldexp(mantissa, whole(random, min, max - 1));
}

/// Returns ± 2^-k with k in [min, max].
inline double tiny(Random& random, int min, int max) {
  const double sign = coin(random) ? 1 : -1;
  return std::ldexp(sign, -whole(random, min, max));
}

/// Returns a unit vector at a right angle to d, to within rounding.
inline Vec3 across(Random& random, const Vec3& d) { return normalize(cross(random.direction(), d)); }

/// Returns a ray of unit direction that passes the center at a distance of impact, after about t = ahead.
inline Ray passing(Random& random, const Point& center, double impact, double ahead) {
  const Vec3 d = random.direction();
  const Point origin = center + impact * across(random, d) - ahead * d;
  return {origin, d};
}

// ---- Spheres

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

inline Vec3 whole_vector(Random& random, int min, int max) {
  const int x = whole(random, min, max), y = whole(random, min, max);
  return {x, y, whole(random, min, max)};
}

inline Vec3 turned(const Vec3& v, int times) {
  return times == 0 ? v : times == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
}

/// Moves one coordinate by one unit in the last place, in one of three calls.
inline void nudge(Random& random, Point& point) {
  double& moved = point[whole(random, 0, 2)];
  if (moved != 0 && whole(random, 0, 2) == 0) moved = std::nextafter(moved, coin(random) ? 1e9 : -1e9);
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

// ---- Planes

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

// ---- Parallelograms

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

// ---- Triangles

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

// ---- Disks

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

// ---- Boxes

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

// ---- Quadrics

inline QuadricForm any_form(Random& random) {
  const Vec3 squares = random.point(1), products = random.point(1), linear = random.point(1);
  return {squares, products, linear, random.real(-1, 1)};
}

/// Returns a quadric of any kind and any size.
inline QuadricCase quadrics(Random& random) {
  const double unit = size(random, -10, 10), far = unit * size(random, -3, 3), factor = size(random, -10, 10);
  QuadricForm form = any_form(random);
  form.squares *= factor, form.products *= factor;
  form.linear *= unit * factor, form.constant *= unit * unit * factor;
  const Point origin = random.point(far);
  return {{origin, size(random, -10, 10) * random.direction()}, {form}};
}

/// Returns an ellipsoid or hyperboloid around a point that is far from the coordinate origin, so that nearly
/// all digits cancel.
inline QuadricCase quadrics_far(Random& random) {
  const double far = size(random, 0, 20);
  const Point center = random.point(far);
  QuadricForm form{.squares = {1, random.real(-2, 2), random.real(0.5, 2)}};
  form.linear = -form.squares * center;
  form.constant = dot(form.squares * center, center) - 1;
  const double ahead = size(random, -3, 10);
  return {passing(random, center, random.real(0, 1.2), ahead), {form}};
}

/// Returns a nearly tangent ray, by the choice of the constant.
inline QuadricCase quadrics_tangent(Random& random) {
  QuadricCase c = quadrics(random);
  QuadricForm& form = c.surface.form;
  const Vec3 Md = form.times(c.ray.direction), g = form.times(c.ray.origin) + form.linear;
  const double A = dot(c.ray.direction, Md), b = dot(c.ray.direction, g);
  const double touches = b * b / A - dot(c.ray.origin, g) - dot(form.linear, c.ray.origin);
  form.constant = touches * (1 + tiny(random, 10, 60));
  return c;
}

/// Returns a direction in which the form is linear or nearly so.
inline QuadricCase quadrics_linear(Random& random) {
  QuadricCase c = quadrics(random);
  QuadricForm& form = c.surface.form;
  const Vec3& d = c.ray.direction;
  const double A = dot(d, form.times(d)), z = form.squares.z - A / (d.z * d.z);
  form.squares.z = coin(random) ? z : z * (1 + tiny(random, 10, 60));
  return c;
}

/// Returns small whole numbers: tangent rays, linear forms, rays in the quadric; except for nudges.
inline QuadricCase quadrics_whole(Random& random) {
  const Vec3 squares = whole_vector(random, -2, 2), products = whole_vector(random, -1, 1),
             linear = whole_vector(random, -2, 2);
  QuadricCase c{{whole_vector(random, -3, 3), whole_vector(random, -2, 2)},
                {{squares, products, linear, static_cast<double>(whole(random, -4, 4))}}};
  nudge(random, c.ray.origin), nudge(random, c.surface.form.squares);
  return c;
}

/// Returns a ray that leaves the quadric, in any direction and along it.
inline QuadricCase quadrics_leaving(Random& random) {
  QuadricCase c = coin(random) ? quadrics(random) : quadrics_whole(random);
  QuadricForm& form = c.surface.form;
  const Vec3 Mo = form.times(c.ray.origin);
  form.constant = -dot(c.ray.origin, Mo) - 2 * dot(form.linear, c.ray.origin);
  if (coin(random))
    c.ray.direction = across(random, Mo + form.linear) + tiny(random, 1, 60) * random.direction();
  c.ray.departure = c.surface.departure();
  return c;
}

inline QuadricCase quadrics_exponents(Random& random) {
  QuadricCase c = coin(random)   ? quadrics_tangent(random)
                  : coin(random) ? quadrics_whole(random)
                                 : quadrics_linear(random);
  const int lengths = whole(random, -300, 300), lengthened = whole(random, -600, 600),
            factors = whole(random, -300, 300);
  QuadricForm& form = c.surface.form;
  const double unit = std::ldexp(1, lengths), factor = std::ldexp(1, factors);
  form.squares *= factor, form.products *= factor;
  form.linear *= factor * unit, form.constant *= factor * unit * unit;
  c.ray.origin *= unit, c.ray.direction *= std::ldexp(1, lengthened);
  return c;
}

// ---- Instances

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

// ---- Solids made of solids

/// Returns an operation on count solids, or on one and another operation.
template <class NextSolid>
SolidTree tree_of(Random& random, const NextSolid& next, int count) {
  using Operation = Csg::Operation;
  static constexpr Operation operations[] = {Operation::either, Operation::all, Operation::first_alone};
  SolidTree tree{.operation = operations[whole(random, 0, 2)]};
  const auto add_one = [&] { tree.operands.push_back({.solid = next(random)}); };
  if (count == 2 || coin(random)) {
    for (int i = 0; i < count; ++i) add_one();
    return tree;
  }
  const bool is_first = coin(random);
  if (is_first) add_one();
  tree.operands.push_back(tree_of(random, next, count - 1));
  if (!is_first) add_one();
  return tree;
}

inline QuadricForm half_space(const Vec3& normal, double distance) {
  return {.squares = Vec3{0}, .linear = 0.5 * normal, .constant = -distance};
}

inline SolidTree::Solid any_solid(Random& random) {
  const Point center = random.point(1), other = random.point(1);
  const double radius = random.real(0.5, 1.5);
  switch (whole(random, 0, 7)) {
    case 0:
    case 1:
      return box_around(center, other);
    case 2:
      return Quadric{half_space(random.direction(), random.real(-1, 1))};
    default:
      return Sphere{center, radius};
  }
}

inline MadeCase solids(Random& random) {
  const int count = whole(random, 2, 4);
  SolidTree tree = tree_of(random, any_solid, count);
  const Point origin = random.point(4), target = random.point(1);
  return {{origin, size(random, -3, 3) * (target - origin)}, Made(std::move(tree))};
}

/// Returns a solid of small whole numbers, so that solids touch and have faces in common.
inline SolidTree::Solid whole_solid(Random& random) {
  const Point center = whole_vector(random, -2, 2), other = whole_vector(random, -2, 2);
  switch (whole(random, 0, 7)) {
    case 0:
    case 1:
    case 2:
      return Sphere{center, static_cast<double>(whole(random, 1, 3))};
    case 3:
      return Quadric{
          half_space(turned({2, 0, 2 * whole(random, 0, 1)}, whole(random, 0, 2)), 2 * whole(random, -2, 2))};
    default:
      return box_around(center, other);
  }
}

/// Returns a tree and a ray, which often leaves the plane of a box's face, from the face or from beside it.
inline MadeCase solids_whole(Random& random) {
  const int count = whole(random, 2, 4);
  SolidTree tree = tree_of(random, whole_solid, count);
  const Point origin = whole_vector(random, -4, 4), target = whole_vector(random, -2, 2);
  Ray ray{origin, target - origin};
  if (coin(random))
    tree.each_solid([&](const SolidTree::Solid& solid) {
      const Box* const box = std::get_if<Box>(&solid);
      if (!box || ray.departure.kind != protostar::Departure::Kind::none) return;
      const int face = whole(random, 0, 5);
      ray.origin[face / 2] = face % 2 == 0 ? box->min[face / 2] : box->max[face / 2];
      ray.departure = box->departure(face);
      ray.departure.object = nullptr;
    });
  return {ray, Made(std::move(tree))};
}

inline const std::vector<Corpus<Sphere>> of_spheres{
    {"tutorial", tutorial},     {"scales", scales},     {"grazing", grazing},       {"origins", origins},
    {"far", far_away},          {"tangents", tangents}, {"directions", directions}, {"ends", ends},
    {"whole ends", whole_ends}, {"leaving", leaving},   {"exponents", exponents}};

inline const std::vector<Corpus<Plane>> of_planes{
    {"planes", planes},           {"planes grazing", planes_grazing},
    {"planes far", planes_far},   {"planes whole", planes_whole},
    {"planes ends", planes_ends}, {"planes exponents", planes_exponents}};

inline const std::vector<Corpus<Parallelogram>> of_parallelograms{
    {"parallelograms", parallelograms},     {"p. outline", parallelograms_outline},
    {"p. grazing", parallelograms_grazing}, {"p. whole", parallelograms_whole},
    {"p. thin", parallelograms_thin},       {"p. exponents", parallelograms_exponents}};

inline const std::vector<Corpus<Triangle>> of_triangles{
    {"triangles", triangles},      {"t. edges", triangles_edges}, {"t. grazing", triangles_grazing},
    {"t. whole", triangles_whole}, {"t. thin", triangles_thin},   {"t. exponents", triangles_exponents}};

inline const std::vector<Corpus<Disk>> of_disks{{"disks", disks},
                                                {"disks outline", disks_outline},
                                                {"disks grazing", disks_grazing},
                                                {"disks whole", disks_whole},
                                                {"disks exponents", disks_exponents}};

inline const std::vector<Corpus<Box>> of_boxes{
    {"boxes", boxes},           {"boxes edges", boxes_edges},     {"boxes whole", boxes_whole},
    {"boxes thin", boxes_thin}, {"boxes leaving", boxes_leaving}, {"boxes exponents", boxes_exponents}};

inline const std::vector<Corpus<Quadric>> of_quadrics{{"quadrics", quadrics},
                                                      {"q. far", quadrics_far},
                                                      {"q. tangent", quadrics_tangent},
                                                      {"q. linear", quadrics_linear},
                                                      {"q. whole", quadrics_whole},
                                                      {"q. leaving", quadrics_leaving},
                                                      {"q. exponents", quadrics_exponents}};

inline const std::vector<Corpus<Placed<Sphere>>> of_placed_spheres{
    {"instances", instances}, {"i. whole", instances_whole}, {"i. leaving", instances_leaving}};

inline const std::vector<Corpus<Placed<Plane>>> of_placed_planes{
    {"i. planes", instances_of_planes}, {"i. planes whole", instances_of_planes_whole}};

inline const std::vector<Corpus<Made>> of_trees{{"csg", solids}, {"csg whole", solids_whole}};

}  // namespace corpora

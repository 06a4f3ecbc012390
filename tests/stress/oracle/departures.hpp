// Surfaces that a ray leaves, by its departure: its own, and those that coincide with it.
#pragma once

#include <array>
#include <cmath>
#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>

#include "coincide.hpp"
#include "equations.hpp"
#include "stress/exact.hpp"
#include "stress/made_of.hpp"

namespace exact {

/// Returns true if a ray departs from the plane n · x = distance: by the exact equations if its departure has
/// one and doubles hold the plane's, else by the rounded ones.
inline bool departs_from(const protostar::Departure& left, const Vector<Number>& n, const Number& distance,
                         bool is_exact) {
  using Kind = protostar::Departure::Kind;
  if (left.kind != Kind::plane && left.kind != Kind::rounded_plane) return false;
  const auto& g = left.geometry;
  const Vector<Number> m(g[0], g[1], g[2]);
  if (left.kind == Kind::plane && is_exact) {
    const Vector<Number> c = cross(m, n);
    const auto crossed = [&](const Number& a, const Number& b) {
      return (Number(g[3]) * a - distance * b).sign();
    };
    return c.x.sign() == 0 && c.y.sign() == 0 && c.z.sign() == 0 && crossed(n.x, m.x) == 0 &&
           crossed(n.y, m.y) == 0 && crossed(n.z, m.z) == 0;
  }
  const std::array<double, 4> of_ray =
      left.kind == Kind::rounded_plane ? g : rounded_equation(m, Number(g[3]));
  return of_ray == rounded_equation(n, distance);
}

/// Returns the face of a box in whose plane a ray starts by its departure, −1 if none.
inline int face_left(const protostar::Departure& left, const protostar::Box& box) {
  for (int face = 0; face < 6; ++face) {
    protostar::Vec3 normal{0};
    normal[face / 2] = 1;
    if (departs_from(left, Vector<Number>(normal), face % 2 ? box.max[face / 2] : box.min[face / 2], true))
      return face;
  }
  return -1;
}
inline int face_left(const protostar::Ray& ray, const protostar::Box& box) {
  return face_left(ray.departure, box);
}

/// Returns the face of a box's image in whose plane a ray starts, −1 if none: the normal of a face is a row
/// of the inverse.
inline int face_left(const protostar::Departure& left, const Placed<protostar::Box>& placed) {
  const Vector<Number> x(placed.placement.x), y(placed.placement.y), z(placed.placement.z),
      at(placed.placement.translation);
  const Vector<Number> rows[] = {cross(y, z), cross(z, x), cross(x, y)};
  const Number determinant = dot(x, rows[0]);
  for (int face = 0; face < 6; ++face) {
    const Vector<Number>& n = rows[face / 2];
    const double place = face % 2 ? placed.own.max[face / 2] : placed.own.min[face / 2];
    if (departs_from(left, n, Number(place) * determinant + dot(n, at), false)) return face;
  }
  return -1;
}

/// Returns true if a ray departs from this sphere, or from the image of a sphere, if it is a sphere.
inline bool departs_from(const protostar::Departure& left, const protostar::Sphere& sphere) {
  const auto& g = left.geometry;
  return left.kind == protostar::Departure::Kind::sphere && sphere.center.x == g[0] &&
         sphere.center.y == g[1] && sphere.center.z == g[2] && std::abs(sphere.radius) == g[3];
}
inline bool departs_from(const protostar::Departure& left, const Placed<protostar::Sphere>& placed) {
  if (left.kind != protostar::Departure::Kind::sphere) return false;
  const Vector<Number> x(placed.placement.x), y(placed.placement.y), z(placed.placement.z),
      at(placed.placement.translation);
  const Number k = dot(x, x);
  const auto is_0 = [](const Number& n) { return n.sign() == 0; };
  if (!is_0(dot(y, y) - k) || !is_0(dot(z, z) - k) || !is_0(dot(x, y)) || !is_0(dot(y, z)) ||
      !is_0(dot(z, x)))
    return false;
  const auto& g = left.geometry;
  const Vector<Number> c(placed.own.center);
  const auto is_at = [&](const Number& a, const Number& b, const Number& d, const Number& to, double place) {
    return is_0(c.x * a + c.y * b + c.z * d + to - Number(place));
  };
  return is_at(x.x, y.x, z.x, at.x, g[0]) && is_at(x.y, y.y, z.y, at.y, g[1]) &&
         is_at(x.z, y.z, z.z, at.z, g[2]) &&
         is_0(k * square(Number(placed.own.radius)) - square(Number(g[3])));
}

/// Returns true if a ray that leaves another surface leaves this one as well: if both are in one plane, by
/// the exact equations if it is orthogonal to an axis, else by the rounded ones.
inline bool is_left_with(const protostar::Ray& ray, const protostar::Disk& disk) {
  const Vector<Number> n(disk.normal);
  const bool is_exact = (disk.normal.x != 0) + (disk.normal.y != 0) + (disk.normal.z != 0) == 1;
  return departs_from(ray.departure, n, dot(n, Vector<Number>(disk.position)), is_exact);
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Plane& plane) {
  return departs_from(ray.departure, Vector<Number>(plane.normal), plane.distance, true);
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Parallelogram& board) {
  const Vector<Number> n = cross(Vector<Number>(board.edge_u), Vector<Number>(board.edge_v));
  bool is_exact = false;
  for (int i = 0; i < 3; ++i) is_exact = is_exact || (board.edge_u[i] == 0 && board.edge_v[i] == 0);
  return departs_from(ray.departure, n, dot(n, Vector<Number>(board.position)), is_exact);
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Sphere& sphere) {
  return departs_from(ray.departure, sphere);
}
inline bool is_left_with(const protostar::Ray&, const protostar::Quadric&) { return false; }

}  // namespace exact

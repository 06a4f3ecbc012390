// Exact crossings of a ray's line with a surface, and their order.
#pragma once

#include <algorithm>
#include <limits>
#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <vector>

#include "box_faces.hpp"
#include "equations.hpp"
#include "stress/exact.hpp"
#include "stress/made_of.hpp"

namespace exact {

/// Parameter of a crossing: (p + side · √D) / A with A > 0, side -1, 0 or 1; t is its value, rounded to Quad
/// and accurate to 2^-100.
struct Root {
  Number p, D, A;
  int side;
  Quad t;
};

/// Returns a double as a root, for comparisons.
inline Root root_at(double t) { return {t, {}, 1.0, 0, Quad(t)}; }

/// Returns the sign of a − b.
inline int compare(const Root& a, const Root& b) {
  const Quad larger = std::max(a.t < 0 ? -a.t : a.t, b.t < 0 ? -b.t : b.t);
  if (a.t - b.t > Quad(0x1p-90) * larger) return 1;
  if (b.t - a.t > Quad(0x1p-90) * larger) return -1;
  // Numerator over the product of both denominators.
  return sign_of_sum(a.p * b.A - b.p * a.A, a.side, a.D * square(b.A), -b.side, b.D * square(a.A));
}

/// Crossings of a ray's line with a surface, near before far; a point of tangency counts twice.
using Roots = std::vector<Root>;

/// Returns the roots of A t² − 2bt + c = 0 with A > 0.
inline Roots both_roots(const Number& A, const Number& b, const Number& c, const Number& D) {
  if (D.sign() < 0) return {};
  const Quad root = D.sqrt();
  const bool ahead = b.sign() >= 0;
  const Quad q = ahead ? Quad(b) + root : Quad(b) - root;  // nothing cancels
  const Quad one = q / Quad(A), other = q == 0 ? Quad(0) : Quad(c) / q;
  return {{b, D, A, -1, ahead ? other : one}, {b, D, A, 1, ahead ? one : other}};
}

inline Roots roots(const Line<Number>& line, const protostar::Sphere& sphere, bool leaves) {
  const SphereEquation<Number> e(line, sphere);
  if (e.A.sign() == 0) return {};
  if (leaves) {
    const Number p = Number(2) * e.b;
    return {{p, {}, e.A, 0, Quad(p) / Quad(e.A)}};
  }
  return both_roots(e.A, e.b, e.c, e.discriminant());
}
inline Roots roots(const protostar::Ray& ray, const protostar::Sphere& sphere, bool leaves) {
  return roots(Line<Number>(ray), sphere, leaves);
}

/// Returns the root of slope · t = height, with a slope that is not 0.
inline Root only_root(const Number& slope, const Number& height) {
  const bool falls = slope.sign() < 0;
  const Number p = falls ? -height : height, A = falls ? -slope : slope;
  return {p, {}, A, 0, Quad(p) / Quad(A)};
}

/// Returns the crossing with a plane; a ray that leaves the plane does not come back.
inline Roots roots(const protostar::Ray& ray, const protostar::Plane& plane, bool leaves) {
  if (leaves) return {};
  const PlaneEquation<Number> e(ray, plane);
  if (e.slope.sign() == 0) return {};
  return {only_root(e.slope, e.height)};
}
inline Roots roots(const protostar::Ray& ray, const protostar::Parallelogram& parallelogram, bool leaves) {
  if (leaves) return {};
  const ParallelogramEquation<Number> e(ray, parallelogram);
  if (e.slope.sign() == 0 || !e.is_inside()) return {};
  return {only_root(e.slope, e.height)};
}

inline Roots roots(const protostar::Ray& ray, const protostar::Triangle& triangle, bool leaves) {
  if (leaves) return {};
  const TriangleEquation<Number> e(ray, triangle);
  if (!e.is_crossed().value()) return {};
  return {only_root(e.slope, e.height)};
}

inline Roots roots(const protostar::Ray& ray, const protostar::Disk& disk, bool leaves) {
  if (leaves) return {};
  const DiskEquation<Number> e(ray, disk);
  if (e.slope.sign() == 0 || e.beyond.sign() > 0) return {};
  return {only_root(e.slope, e.height)};
}
/// Returns the crossings with a box. A ray that leaves a face of the box inwards leaves the box at t > 0: at
/// the smallest double, if its digits give 0 or less.
inline Roots roots(const Line<Number>& line, const protostar::Box& box, const LeftOfBox& left) {
  Roots all;
  const std::vector<int> faces = faces_crossed<Number>(line, box, left).value();
  for (const int face : faces) {
    const FaceEquation<Number> e(line, box, face, left);
    all.push_back(only_root(e.slope, e.height));
    if (left.is_own && all.back().p.sign() <= 0)
      all.back() = root_at(std::numeric_limits<double>::denorm_min());
  }
  return all;
}

/// Returns true if a ray that leaves a quadric crosses it again in the quadric's bounds. A quadric that is
/// not an ellipsoid with its inside within has none; in the bounds of an ellipsoid the form, which is c at
/// both crossings, is at most 2^-10 of its depth below 0 at the center.
inline bool meets_again(const protostar::QuadricForm& form, const Number& c) {
  const Number m[3][3] = {{form.squares.x, form.products.z, form.products.y},
                          {form.products.z, form.squares.y, form.products.x},
                          {form.products.y, form.products.x, form.squares.z}};
  const Number l[3] = {form.linear.x, form.linear.y, form.linear.z};
  const auto cofactor = [&](int i, int k) {
    const int a = (i + 1) % 3, b = (i + 2) % 3, p = (k + 1) % 3, q = (k + 2) % 3;
    return m[a][p] * m[b][q] - m[a][q] * m[b][p];
  };
  Number determinant, depth;
  for (int i = 0; i < 3; ++i) determinant = determinant + m[0][i] * cofactor(0, i);
  if (m[0][0].sign() <= 0 || cofactor(2, 2).sign() <= 0 || determinant.sign() <= 0) return true;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) depth = depth + l[i] * cofactor(i, k) * l[k];
  depth = depth - Number(form.constant) * determinant;
  return (Number(1024) * c * determinant - depth).sign() <= 0;
}

inline Roots roots(const Line<Number>& line, const protostar::Quadric& quadric, bool leaves) {
  QuadricEquation<Number> e(line, quadric.form);
  if (leaves && (e.A.sign() == 0 || !meets_again(quadric.form, e.c))) return {};
  if (leaves) return {only_root(e.A, Number(2) * e.b)};
  if (e.A.sign() == 0) return e.b.sign() == 0 ? Roots{} : Roots{only_root(Number(2) * e.b, e.c)};
  if (e.A.sign() < 0) e.A = -e.A, e.b = -e.b, e.c = -e.c;
  return both_roots(e.A, e.b, e.c, e.discriminant());
}

inline Roots roots(const protostar::Ray& ray, const protostar::Quadric& quadric, bool leaves) {
  return roots(Line<Number>(ray), quadric, leaves);
}

inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed, bool leaves) {
  return roots(Line<Number>(Line<Number>(ray), placed.placement), placed.own, leaves);
}
inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Plane>& placed, bool leaves) {
  if (leaves) return {};
  const PlaneEquation<Number> e(Line<Number>(Line<Number>(ray), placed.placement), placed.own);
  if (e.slope.sign() == 0) return {};
  return {only_root(e.slope, e.height)};
}

}  // namespace exact

// Where a ray crosses a surface, and in which order: exactly, for the ray as it is given in doubles.
#pragma once

#include <array>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "exact.hpp"

namespace exact {

struct Vector {
  Number x, y, z;

  explicit Vector(const protostar::Vec3& v) : x(v.x), y(v.y), z(v.z) {}
  Vector(const Number& vx, const Number& vy, const Number& vz) : x(vx), y(vy), z(vz) {}
};
inline Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Number dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// A crossing's parameter: (p + side · √D) / A with A > 0, side -1, 0 or 1; and that rounded to Quad, good to
/// 2^-100.
struct Root {
  Number p, D, A;
  int side;
  Quad t;
};

/// A double as a root, to compare one with.
inline Root root_at(double t) { return {t, {}, 1.0, 0, Quad(t)}; }

/// The sign of a − b.
inline int compare(const Root& a, const Root& b) {
  const Quad larger = std::max(a.t < 0 ? -a.t : a.t, b.t < 0 ? -b.t : b.t);
  if (a.t - b.t > Quad(0x1p-90) * larger) return 1;
  if (b.t - a.t > Quad(0x1p-90) * larger) return -1;
  // Over the product of both denominators.
  return sign_of_sum(a.p * b.A - b.p * a.A, a.side, a.D * square(b.A), -b.side, b.D * square(a.A));
}

/// The crossings of a ray's line with a surface, near before far; a point of tangency twice.
using Roots = std::vector<Root>;

/// The sphere's equation is A t² − 2bt + c = 0; of a ray that leaves it c is 0, and t = 0 is left out.
inline Roots roots(const protostar::Ray& ray, const protostar::Sphere& sphere, bool leaves) {
  const Vector d(ray.direction), l = Vector(sphere.center) - Vector(ray.origin);
  const Number A = dot(d, d), b = dot(d, l);
  if (A.sign() == 0) return {};
  const Quad a(A);
  if (leaves) {
    const Number p = Number(2) * b;
    return {{p, {}, A, 0, Quad(p) / a}};
  }
  const Number c = dot(l, l) - square(sphere.radius), D = square(b) - A * c;
  if (D.sign() < 0) return {};
  const Quad root = D.sqrt();
  const bool ahead = b.sign() >= 0;
  const Quad q = ahead ? Quad(b) + root : Quad(b) - root;  // nothing cancels
  const Quad one = q / a, other = q == 0 ? Quad(0) : Quad(c) / q;
  return {{b, D, A, -1, ahead ? other : one}, {b, D, A, 1, ahead ? one : other}};
}

/// The plane's is t = (distance − n·o) / n·d; a ray that leaves it does not come back.
inline Roots roots(const protostar::Ray& ray, const protostar::Plane& plane, bool leaves) {
  const Vector n(plane.normal);
  const Number slope = dot(n, Vector(ray.direction));
  if (leaves || slope.sign() == 0) return {};
  const Number height = Number(plane.distance) - dot(n, Vector(ray.origin));
  const Number p = slope.sign() < 0 ? -height : height, A = slope.sign() < 0 ? -slope : slope;
  return {{p, {}, A, 0, Quad(p) / Quad(A)}};
}

/// The parallelogram's: o + t d is a point position + a u + b v with a and b from 0 to 1. With e = o −
/// position and n = u × v that is t = −n·e / n·d, and a n·n = ((e + t d) × v)·n, b n·n = (u × (e + t d))·n.
inline Roots roots(const protostar::Ray& ray, const protostar::Parallelogram& s, bool leaves) {
  const Vector u(s.edge_u), v(s.edge_v), n = cross(u, v), d(ray.direction),
                                         e = Vector(ray.origin) - Vector(s.position);
  const Number down = dot(n, d);
  if (leaves || down.sign() == 0) return {};
  const bool turned = down.sign() < 0;
  const Number slope = turned ? -down : down, height = turned ? dot(n, e) : -dot(n, e);
  // e + t d, times the slope.
  const Vector x(slope * e.x + height * d.x, slope * e.y + height * d.y, slope * e.z + height * d.z);
  const Number end = slope * dot(n, n);
  for (const Number& along : {dot(cross(x, v), n), dot(cross(u, x), n)})
    if (along.sign() < 0 || (end - along).sign() < 0) return {};
  return {{height, {}, slope, 0, Quad(height) / Quad(slope)}};
}

/// A crossing with one surface of a scene, by its number.
struct Hit {
  Root root;
  int surface;
};

/// Adds the crossings of a ray and a surface of this number with 0 < t < end.
template <class S>
void add_hits(std::vector<Hit>& hits, const protostar::Ray& ray, const S& surface, int number, bool leaves,
              double end) {
  for (const Root& root : roots(ray, surface, leaves))
    if (root.t > 0 && (end == protostar::infinity || compare(root, root_at(end)) < 0))
      hits.push_back({root, number});
}

/// Puts crossings in the order in which the ray meets them; what is met at once stays as it was.
inline void sort(std::vector<Hit>& hits) {
  std::stable_sort(hits.begin(), hits.end(),
                   [](const Hit& a, const Hit& b) { return compare(a.root, b.root) < 0; });
}

/// Whether two surfaces are the same points.
inline bool coincide(const protostar::Sphere& a, const protostar::Sphere& b) {
  return a.center == b.center && std::abs(a.radius) == std::abs(b.radius);
}
inline bool coincide(const protostar::Plane& a, const protostar::Plane& b) {
  const Number p[] = {a.normal.x, a.normal.y, a.normal.z, a.distance};
  const Number q[] = {b.normal.x, b.normal.y, b.normal.z, b.distance};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j)
      if ((p[i] * q[j] - p[j] * q[i]).sign() != 0) return false;  // not multiples of each other
  return true;
}
/// The plane that a parallelogram lies in, as surfaces in one plane recognize each other: the plane's
/// equation, divided by the largest component of the normal, the first of equals, and rounded.
inline std::array<double, 4> rounded_equation(const Vector& n, const Number& distance) {
  const Number numbers[] = {n.x, n.y, n.z, distance};
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if ((square(numbers[i]) - square(numbers[k])).sign() > 0) k = i;
  std::array<double, 4> rounded{};
  for (std::size_t i = 0; i < 4; ++i) rounded[i] = static_cast<double>(Quad(numbers[i]) / Quad(numbers[k]));
  return rounded;
}
inline std::array<double, 4> rounded_equation(const protostar::Plane& s) {
  return rounded_equation(Vector(s.normal), s.distance);
}
inline std::array<double, 4> rounded_equation(const protostar::Parallelogram& s) {
  const Vector n = cross(Vector(s.edge_u), Vector(s.edge_v));
  return rounded_equation(n, dot(n, Vector(s.position)));
}
inline bool coincide(const protostar::Parallelogram& a, const protostar::Parallelogram& b) {
  return rounded_equation(a) == rounded_equation(b);
}
/// Exactly, where the parallelogram is at a right angle to an axis.
inline bool coincide(const protostar::Parallelogram& a, const protostar::Plane& b) {
  for (int i = 0; i < 3; ++i)
    if (a.edge_u[i] == 0 && a.edge_v[i] == 0) {
      protostar::Plane plane{protostar::Vec3{0}, a.position[i]};
      plane.normal[i] = 1;
      return coincide(plane, b);
    }
  return rounded_equation(a) == rounded_equation(b);
}

}  // namespace exact

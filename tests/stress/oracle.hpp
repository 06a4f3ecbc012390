// Where a ray crosses a surface, and in which order: exactly, for the ray as it is given in doubles.
#pragma once

#include <array>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "exact.hpp"

namespace exact {

/// T is the type of number.
template <class T>
struct Vector {
  T x, y, z;

  explicit Vector(const protostar::Vec3& v) : x(v.x), y(v.y), z(v.z) {}
  Vector(const T& vx, const T& vy, const T& vz) : x(vx), y(vy), z(vz) {}
};
template <class T>
Vector<T> operator-(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A t² − 2bt + c = 0; of a ray that leaves the sphere c is 0, and t = 0 is left out.
template <class T>
struct SphereEquation {
  T A, b, c;

  SphereEquation(const protostar::Ray& ray, const protostar::Sphere& sphere) {
    const Vector<T> d(ray.direction), l = Vector<T>(sphere.center) - Vector<T>(ray.origin);
    A = dot(d, d), b = dot(d, l), c = dot(l, l) - square(T(sphere.radius));
  }
  [[nodiscard]] T discriminant() const { return square(b) - A * c; }
};

/// slope · t = height, with slope = n·d and height = distance − n·o.
template <class T>
struct PlaneEquation {
  T slope, height;

  PlaneEquation(const protostar::Ray& ray, const protostar::Plane& plane) {
    const Vector<T> n(plane.normal);
    slope = dot(n, Vector<T>(ray.direction));
    height = T(plane.distance) - dot(n, Vector<T>(ray.origin));
  }
};

/// slope · t = height is where the line crosses the parallelogram's plane: with n = u × v and g = position −
/// origin, slope = n·d and height = n·g. Seen from the origin it is at t d. That is to the left of an edge w
/// through p where w × (t d − p) has the direction of n, so where its product with d has the slope's sign:
///   d·(w × (t d − p)) = d·(p × w) = (d × p)·w.
/// The parallelogram is to the left of its outline: along u from g, v from g + u, −u from g + v, −v from g.
template <class T>
struct ParallelogramEquation {
  T slope, height;
  T left[4];  ///< these products; 0 on the line through an edge

  ParallelogramEquation(const protostar::Ray& ray, const protostar::Parallelogram& parallelogram) {
    const Vector<T> u(parallelogram.edge_u), v(parallelogram.edge_v), n = cross(u, v);
    const Vector<T> d(ray.direction), g = Vector<T>(parallelogram.position) - Vector<T>(ray.origin);
    slope = dot(n, d), height = dot(n, g);
    const Vector<T> m = cross(d, g);
    left[0] = dot(m, u), left[1] = dot(m, v) + slope;  // (d × u)·v = n·d
    left[2] = slope - left[0], left[3] = -dot(m, v);
  }
  /// Whether the crossing is in the parallelogram, if the slope is not 0.
  [[nodiscard]] bool is_inside() const {
    return std::all_of(left, left + 4, [&](const T& x) { return x.sign() * slope.sign() >= 0; });
  }
};

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

inline Roots roots(const protostar::Ray& ray, const protostar::Sphere& sphere, bool leaves) {
  const SphereEquation<Number> e(ray, sphere);
  if (e.A.sign() == 0) return {};
  const Quad a(e.A);
  if (leaves) {
    const Number p = Number(2) * e.b;
    return {{p, {}, e.A, 0, Quad(p) / a}};
  }
  const Number D = e.discriminant();
  if (D.sign() < 0) return {};
  const Quad root = D.sqrt();
  const bool ahead = e.b.sign() >= 0;
  const Quad q = ahead ? Quad(e.b) + root : Quad(e.b) - root;  // nothing cancels
  const Quad one = q / a, other = q == 0 ? Quad(0) : Quad(e.c) / q;
  return {{e.b, D, e.A, -1, ahead ? other : one}, {e.b, D, e.A, 1, ahead ? one : other}};
}

/// The root of slope · t = height, with a slope that is not 0.
inline Root only_root(const Number& slope, const Number& height) {
  const bool falls = slope.sign() < 0;
  const Number p = falls ? -height : height, A = falls ? -slope : slope;
  return {p, {}, A, 0, Quad(p) / Quad(A)};
}

/// A ray that leaves a plane does not come back.
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
inline std::array<double, 4> rounded_equation(const Vector<Number>& n, const Number& distance) {
  const Number numbers[] = {n.x, n.y, n.z, distance};
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if ((square(numbers[i]) - square(numbers[k])).sign() > 0) k = i;
  std::array<double, 4> rounded{};
  for (std::size_t i = 0; i < 4; ++i) rounded[i] = static_cast<double>(Quad(numbers[i]) / Quad(numbers[k]));
  return rounded;
}
inline std::array<double, 4> rounded_equation(const protostar::Plane& s) {
  return rounded_equation(Vector<Number>(s.normal), s.distance);
}
inline std::array<double, 4> rounded_equation(const protostar::Parallelogram& s) {
  const Vector<Number> n = cross(Vector<Number>(s.edge_u), Vector<Number>(s.edge_v));
  return rounded_equation(n, dot(n, Vector<Number>(s.position)));
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

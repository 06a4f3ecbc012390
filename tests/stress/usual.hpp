// Usual algorithms to intersect a ray with a surface, which the library is compared with.
//
// Each returns the smallest t > 0, or infinity for a miss. l = center − origin.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace usual {

template <class T>
using Vector = glm::vec<3, T>;

template <class T>
struct Ray {
  Vector<T> origin, direction;
};
template <class T>
struct Sphere {
  Vector<T> center;
  T radius;
};
template <class T>
struct Plane {
  Vector<T> normal;
  T distance;
};

template <class T>
struct Parallelogram {
  Vector<T> position, edge_u, edge_v;
};

template <class T>
struct Triangle {
  Vector<T> a, b, c;
};

template <class T>
struct Disk {
  Vector<T> position, normal;
  T radius;
};
template <class T>
struct Box {
  Vector<T> min, max;
};
template <class T>
struct Quadric {
  Vector<T> squares, products, linear;
  T constant;
};

/// Surface with a map: the rows of the map's inverse matrix, and its translation.
template <class S, class T>
struct Placed {
  S own;
  Vector<T> rows[3], translation;
};

template <class T>
inline constexpr T miss = std::numeric_limits<T>::infinity();

template <class T>
T first_ahead(T near, T far) {
  return near > 0 ? near : far > 0 ? far : miss<T>;
}

/// Intersects as the tutorial does (§2.2.4): by the quadratic formula for a direction of unit length, A = 1.
template <class T>
T quadratic(const Ray<T>& ray, const Sphere<T>& sphere) {
  const Vector<T> l = sphere.center - ray.origin;
  const T b = dot(ray.direction, l), c = dot(l, l) - sphere.radius * sphere.radius;
  const T D = b * b - c;
  if (!(D >= 0)) return miss<T>;
  return first_ahead(b - std::sqrt(D), b + std::sqrt(D));
}

/// Intersects as tinyraytracer does: by the foot of the perpendicular from the center, and Pythagoras twice.
/// Directions are of unit length.
inline float geometric(const Ray<float>& ray, const Sphere<float>& sphere) {
  const glm::vec3 l = sphere.center - ray.origin;
  const float foot = dot(ray.direction, l), distance2 = dot(l, l) - foot * foot;
  const float radius2 = sphere.radius * sphere.radius;
  if (!(distance2 <= radius2)) return miss<float>;
  const float half_chord = std::sqrt(radius2 - distance2);
  return first_ahead(foot - half_chord, foot + half_chord);
}

/// Intersects as in Ray Tracing Gems, chapter 7: the discriminant from the vector between center and foot,
/// and the root that would cancel from the product of both.
inline float gems(const Ray<float>& ray, const Sphere<float>& sphere) {
  const glm::vec3 l = sphere.center - ray.origin;
  const float A = dot(ray.direction, ray.direction), b = dot(ray.direction, l);
  const glm::vec3 across = l - (b / A) * ray.direction;
  const float radius2 = sphere.radius * sphere.radius, D = radius2 - dot(across, across);
  if (!(D >= 0)) return miss<float>;
  const float q = b + std::copysign(std::sqrt(A * D), b);
  const float c = dot(l, l) - radius2;
  return b < 0 ? first_ahead(q / A, c / q) : first_ahead(c / q, q / A);
}

template <class T>
T quotient(const Ray<T>& ray, const Plane<T>& plane) {
  const T t = (plane.distance - dot(plane.normal, ray.origin)) / dot(plane.normal, ray.direction);
  return t > 0 && t < miss<T> ? t : miss<T>;
}

template <class T>
T in_circle(const Ray<T>& ray, const Disk<T>& disk) {
  const T t = dot(disk.normal, disk.position - ray.origin) / dot(disk.normal, ray.direction);
  if (!(t > 0 && t < miss<T>)) return miss<T>;
  const Vector<T> from_center = ray.origin + t * ray.direction - disk.position;
  return dot(from_center, from_center) <= disk.radius * disk.radius ? t : miss<T>;
}

/// Intersects by Kay and Kajiya's slabs.
template <class T>
T slabs(const Ray<T>& ray, const Box<T>& box) {
  T near = -miss<T>, far = miss<T>;
  for (int i = 0; i < 3; ++i) {
    const T inverse = 1 / ray.direction[i];
    const T a = (box.min[i] - ray.origin[i]) * inverse, b = (box.max[i] - ray.origin[i]) * inverse;
    near = std::fmax(near, std::fmin(a, b)), far = std::fmin(far, std::fmax(a, b));
  }
  return near <= far ? first_ahead(near, far) : miss<T>;
}

/// Intersects by the textbook formula.
template <class T>
T school(const Ray<T>& ray, const Quadric<T>& q) {
  const auto times = [&](const Vector<T>& v) {
    return Vector<T>{q.squares.x * v.x + q.products.z * v.y + q.products.y * v.z,
                     q.products.z * v.x + q.squares.y * v.y + q.products.x * v.z,
                     q.products.y * v.x + q.products.x * v.y + q.squares.z * v.z};
  };
  const Vector<T> g = times(ray.origin) + q.linear;
  const T A = dot(ray.direction, times(ray.direction)), b = -dot(ray.direction, g);
  const T c = dot(ray.origin, g) + dot(q.linear, ray.origin) + q.constant;
  if (A == 0) return first_ahead(c / (2 * b), miss<T>);
  const T D = b * b - A * c;
  if (!(D >= 0)) return miss<T>;
  const T one = (b - std::sqrt(D)) / A, other = (b + std::sqrt(D)) / A;
  return A > 0 ? first_ahead(one, other) : first_ahead(other, one);
}

/// Möller and Trumbore's solution: t, and the point position + a u + b v in the plane of two edges.
template <class T>
struct Determinants {
  T a, b, t;

  Determinants(const Ray<T>& ray, const Vector<T>& position, const Vector<T>& u, const Vector<T>& v) {
    const Vector<T> e = ray.origin - position, p = cross(ray.direction, v), q = cross(e, u);
    const T one = 1 / dot(u, p);
    a = dot(e, p) * one, b = dot(ray.direction, q) * one, t = dot(v, q) * one;
  }
  [[nodiscard]] T t_if(bool is_inside) const { return is_inside && t > 0 && t < miss<T> ? t : miss<T>; }
};

template <class T>
T in_triangle(const Ray<T>& ray, const Triangle<T>& s) {
  const Determinants<T> x(ray, s.a, s.b - s.a, s.c - s.a);
  return x.t_if(0 <= x.a && 0 <= x.b && x.a + x.b <= 1);
}

/// Intersects two triangles at once.
template <class T>
T in_parallelogram(const Ray<T>& ray, const Parallelogram<T>& s) {
  const Determinants<T> x(ray, s.position, s.edge_u, s.edge_v);
  return x.t_if(0 <= x.a && x.a <= 1 && 0 <= x.b && x.b <= 1);
}

/// Intersects a placed surface by kernel, with the ray mapped back and its direction normalized.
template <auto kernel, class S, class T>
T carried(const Ray<T>& ray, const Placed<S, T>& placed) {
  const auto back = [&](const Vector<T>& v) {
    return Vector<T>{dot(placed.rows[0], v), dot(placed.rows[1], v), dot(placed.rows[2], v)};
  };
  const Vector<T> d = back(ray.direction);
  const T size = std::sqrt(dot(d, d));
  return kernel({back(ray.origin - placed.translation), d / size}, placed.own) / size;
}

}  // namespace usual

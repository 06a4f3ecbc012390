// How a ray and a surface are usually intersected: what the library is compared with.
//
// Each gives the first t > 0, or infinity for a miss. l = center − origin.
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
inline constexpr T miss = std::numeric_limits<T>::infinity();

template <class T>
T first_ahead(T near, T far) {
  return near > 0 ? near : far > 0 ? far : miss<T>;
}

/// The tutorial's (§2.2.4): the quadratic formula for a direction of unit length, A = 1.
template <class T>
T quadratic(const Ray<T>& ray, const Sphere<T>& sphere) {
  const Vector<T> l = sphere.center - ray.origin;
  const T b = dot(ray.direction, l), c = dot(l, l) - sphere.radius * sphere.radius;
  const T D = b * b - c;
  if (!(D >= 0)) return miss<T>;
  return first_ahead(b - std::sqrt(D), b + std::sqrt(D));
}

/// tinyraytracer's: the foot of the perpendicular from the center, and Pythagoras twice. Unit directions.
inline float geometric(const Ray<float>& ray, const Sphere<float>& sphere) {
  const glm::vec3 l = sphere.center - ray.origin;
  const float foot = dot(ray.direction, l), distance2 = dot(l, l) - foot * foot;
  const float radius2 = sphere.radius * sphere.radius;
  if (!(distance2 <= radius2)) return miss<float>;
  const float half_chord = std::sqrt(radius2 - distance2);
  return first_ahead(foot - half_chord, foot + half_chord);
}

/// Ray Tracing Gems, chapter 7: the discriminant from the vector between center and foot, and the root that
/// would cancel from the product of both.
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

/// Möller and Trumbore's, for two triangles at once.
template <class T>
T determinants(const Ray<T>& ray, const Parallelogram<T>& s) {
  const Vector<T> e = ray.origin - s.position, p = cross(ray.direction, s.edge_v), q = cross(e, s.edge_u);
  const T one = 1 / dot(s.edge_u, p);
  const T a = dot(e, p) * one, b = dot(ray.direction, q) * one, t = dot(s.edge_v, q) * one;
  return 0 <= a && a <= 1 && 0 <= b && b <= 1 && t > 0 && t < miss<T> ? t : miss<T>;
}

}  // namespace usual

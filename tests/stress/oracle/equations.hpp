// Equations for where a ray's line crosses a surface, in numbers of any type.
#pragma once

#include <algorithm>
#include <optional>
#include <protostar/numeric/affine.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <protostar/vec3.hpp>

namespace exact {

/// Vector of numbers of type T.
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

/// Points (origin + t · direction) / weight, with a weight that is not 0: a ray, or the line that crosses a
/// surface where a ray crosses the surface's image. The rows of a matrix's inverse are the cross products of
/// its columns over its determinant, which goes into the weight.
template <class T>
struct Line {
  Vector<T> origin, direction;
  T weight;

  Line(const protostar::Ray& ray) : origin(ray.origin), direction(ray.direction), weight(1.0) {}
  Line(const Line& line, const protostar::Affine& map)
      : Line(line, Vector<T>(map.translation), Vector<T>(map.x), Vector<T>(map.y), Vector<T>(map.z)) {}

  /// Returns weight times a point, minus the origin.
  [[nodiscard]] Vector<T> to(const protostar::Point& p) const {
    return Vector<T>(weight * p.x, weight * p.y, weight * p.z) - origin;
  }

 private:
  Line(const Line& line, const Vector<T>& at, const Vector<T>& x, const Vector<T>& y, const Vector<T>& z)
      : origin(back(line.origin - Vector<T>(line.weight * at.x, line.weight * at.y, line.weight * at.z), x, y,
                    z)),
        direction(back(line.direction, x, y, z)),
        weight(line.weight * dot(x, cross(y, z))) {}

  static Vector<T> back(const Vector<T>& v, const Vector<T>& x, const Vector<T>& y, const Vector<T>& z) {
    return {dot(cross(y, z), v), dot(cross(z, x), v), dot(cross(x, y), v)};
  }
};

/// Equation A t² − 2bt + c = 0; for a ray that leaves the sphere c is 0, and t = 0 is left out.
template <class T>
struct SphereEquation {
  T A, b, c;

  SphereEquation(const Line<T>& line, const protostar::Sphere& sphere) {
    const Vector<T>&d = line.direction, l = line.to(sphere.center);
    A = dot(d, d), b = dot(d, l), c = dot(l, l) - square(line.weight * T(sphere.radius));
  }
  [[nodiscard]] T discriminant() const { return square(b) - A * c; }
};

/// Equation slope · t = height, with slope = n·d and height = distance − n·o.
template <class T>
struct PlaneEquation {
  T slope, height;

  PlaneEquation(const Line<T>& line, const protostar::Plane& plane) {
    const Vector<T> n(plane.normal);
    slope = dot(n, line.direction);
    height = line.weight * T(plane.distance) - dot(n, line.origin);
  }
};

/// Equation slope · t = height of the crossing with the parallelogram's plane: with n = u × v and
/// g = position − origin, slope = n·d and height = n·g. Relative to the origin the crossing is at t d. It is
/// to the left of an edge w through p if w × (t d − p) has the direction of n, and hence its product with d
/// the slope's sign:
///   d·(w × (t d − p)) = d·(p × w) = (d × p)·w.
/// The parallelogram is to the left of its outline: along u from g, v from g + u, −u from g + v, −v from g.
template <class T>
struct ParallelogramEquation {
  T slope, height;
  T left[4];  ///< the products; 0 on the line through an edge

  ParallelogramEquation(const protostar::Ray& ray, const protostar::Parallelogram& parallelogram) {
    const Vector<T> u(parallelogram.edge_u), v(parallelogram.edge_v), n = cross(u, v);
    const Vector<T> d(ray.direction), g = Vector<T>(parallelogram.position) - Vector<T>(ray.origin);
    slope = dot(n, d), height = dot(n, g);
    const Vector<T> m = cross(d, g);
    left[0] = dot(m, u), left[1] = dot(m, v) + slope;  // (d × u)·v = n·d
    left[2] = slope - left[0], left[3] = -dot(m, v);
  }
  /// Returns true if the crossing is in the parallelogram; the slope must not be 0.
  [[nodiscard]] bool is_inside() const {
    return std::all_of(left, left + 4, [&](const T& x) { return x.sign() * slope.sign() >= 0; });
  }
};

/// Equation slope · t = height of the crossing with the triangle's plane: with n = (b − a) × (c − a),
/// slope = n·d and height = n·(a − origin). The line passes the edge from p to q on the side that is the sign
/// of d · ((p − o) × (q − o)). If it is 0, the origin counts as moved by (ε, ε², ε³), which makes it the sign
/// of the first component of (p − q) × d that is not 0. The three sides add up to the slope, and these
/// components to 0, so sides that are all of one sign are not all 0, and the slope has their sign, too.
template <class T>
struct TriangleEquation {
  T slope, height;
  T side[3][4];  ///< for each edge: the product, and the components

  TriangleEquation(const protostar::Ray& ray, const protostar::Triangle& s) {
    const Vector<T> o(ray.origin), d(ray.direction),
        points[] = {Vector<T>(s.a), Vector<T>(s.b), Vector<T>(s.c)};
    const Vector<T> n = cross(points[1] - points[0], points[2] - points[0]);
    slope = dot(n, d), height = dot(n, points[0] - o);
    for (int i = 0; i < 3; ++i) {
      const Vector<T>&p = points[i], &q = points[(i + 1) % 3];
      const Vector<T> moved = cross(p - q, d);
      side[i][0] = dot(d, cross(p - o, q - o));
      side[i][1] = moved.x, side[i][2] = moved.y, side[i][3] = moved.z;
    }
  }
  /// Returns true if the line passes all edges on one side; nothing if 128 digits do not decide.
  [[nodiscard]] std::optional<bool> is_crossed() const {
    int signs[3] = {0, 0, 0};
    for (int i = 0; i < 3; ++i)
      for (const T& x : side[i]) {
        if constexpr (requires { x.is_known(); })
          if (!x.is_known()) return std::nullopt;
        if ((signs[i] = x.sign()) != 0) break;
      }
    return signs[0] != 0 && signs[0] == signs[1] && signs[0] == signs[2];
  }
};

/// Equation slope · t = height of the crossing with the disk's plane. Its vector from the center, times the
/// slope, is (origin − position) · slope + d · height; beyond is the square of this vector minus that of
/// radius · slope.
template <class T>
struct DiskEquation {
  T slope, height, beyond;

  DiskEquation(const protostar::Ray& ray, const protostar::Disk& disk) {
    const Vector<T> n(disk.normal), d(ray.direction), g = Vector<T>(disk.position) - Vector<T>(ray.origin);
    slope = dot(n, d), height = dot(n, g);
    beyond = square(d.x * height - g.x * slope) + square(d.y * height - g.y * slope) +
             square(d.z * height - g.z * slope) - square(T(disk.radius) * slope);
  }
};

/// Equation A t² − 2bt + c = 0 from the sixteen products of the form's matrix; for a ray that leaves the
/// quadric c is 0, and t = 0 is left out.
template <class T>
struct QuadricEquation {
  T A, b, c;

  QuadricEquation(const Line<T>& line, const protostar::QuadricForm& form) {
    const T q[4][4] = {{form.squares.x, form.products.z, form.products.y, form.linear.x},
                       {form.products.z, form.squares.y, form.products.x, form.linear.y},
                       {form.products.y, form.products.x, form.squares.z, form.linear.z},
                       {form.linear.x, form.linear.y, form.linear.z, form.constant}};
    const T d[4] = {line.direction.x, line.direction.y, line.direction.z, 0.0};
    const T o[4] = {line.origin.x, line.origin.y, line.origin.z, line.weight};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        A = A + d[i] * q[i][j] * d[j];
        b = b - d[i] * q[i][j] * o[j];
        c = c + o[i] * q[i][j] * o[j];
      }
  }
  [[nodiscard]] T discriminant() const { return square(b) - A * c; }
};

}  // namespace exact

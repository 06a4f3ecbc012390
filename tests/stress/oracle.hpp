// Where a ray crosses a surface, and in which order: exactly, for the ray as it is given in doubles.
#pragma once

#include <array>
#include <optional>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <vector>

#include "exact.hpp"
#include "made_of.hpp"

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

/// slope · t = height is where the line crosses the triangle's plane: with n = (b − a) × (c − a), slope = n·d
/// and height = n·(a − origin). The line passes the edge from p to q on the side that is the sign of d · ((p
/// − o) × (q − o)). Where that is 0, the origin counts as moved by (ε, ε², ε³), which makes it the sign of
/// the first component of (p − q) × d that is not 0. The three sides add up to the slope, and these
/// components to 0, so that sides that are all of one sign are not all 0, and the slope has that sign too.
template <class T>
struct TriangleEquation {
  T slope, height;
  T side[3][4];  ///< of each edge: the product, and the components

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
  /// Whether the line passes all edges on one side, if 128 digits tell.
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

/// slope · t = height is where the line crosses the disk's plane; times the slope, it is (origin − position)
/// · slope + d · height from the center there. beyond is the square of that, less that of radius · slope.
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

/// A t² − 2bt + c = 0 by the sixteen products of the form's matrix; of a ray that leaves the quadric c is 0,
/// and t = 0 is left out.
template <class T>
struct QuadricEquation {
  T A, b, c;

  QuadricEquation(const protostar::Ray& ray, const protostar::QuadricForm& form) {
    const T q[4][4] = {{form.squares.x, form.products.z, form.products.y, form.linear.x},
                       {form.products.z, form.squares.y, form.products.x, form.linear.y},
                       {form.products.y, form.products.x, form.squares.z, form.linear.z},
                       {form.linear.x, form.linear.y, form.linear.z, form.constant}};
    const T d[4] = {ray.direction.x, ray.direction.y, ray.direction.z, 0.0};
    const T o[4] = {ray.origin.x, ray.origin.y, ray.origin.z, 1.0};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        A = A + d[i] * q[i][j] * d[j];
        b = b - d[i] * q[i][j] * o[j];
        c = c + o[i] * q[i][j] * o[j];
      }
  }
  [[nodiscard]] T discriminant() const { return square(b) - A * c; }
};

/// slope · t = height is where the line crosses the plane of a box's face.
template <class T>
struct FaceEquation {
  T slope, height;

  FaceEquation(const protostar::Ray& ray, const protostar::Box& box, int face)
      : slope(ray.direction[face / 2]),
        height(T(face % 2 ? box.max[face / 2] : box.min[face / 2]) - T(ray.origin[face / 2])) {}

  /// Whether that is a point of the box, if 128 digits tell.
  [[nodiscard]] std::optional<bool> is_in_box(const protostar::Ray& ray, const protostar::Box& box) const {
    for (int i = 0; i < 3; ++i) {
      const T place = T(ray.origin[i]) * slope + T(ray.direction[i]) * height;
      for (const T& inwards : {place - T(box.min[i]) * slope, T(box.max[i]) * slope - place}) {
        if constexpr (requires { inwards.is_known(); })
          if (!inwards.is_known()) return std::nullopt;
        if (inwards.sign() * slope.sign() < 0) return false;
      }
    }
    return true;
  }
};

/// Whether a ray leaves the plane where the coordinate on one axis is this.
inline bool leaves_plane(const protostar::Ray& ray, int axis, double place) {
  const auto& g = ray.departure.geometry;
  const auto along = [&](int i) { return g[static_cast<std::size_t>(i)]; };
  return ray.departure.kind == protostar::Departure::Kind::plane && along(axis) != 0 &&
         along((axis + 1) % 3) == 0 && along((axis + 2) % 3) == 0 &&
         (Number(along(axis)) * Number(place) - Number(g[3])).sign() == 0;
}

/// The face of a box in whose plane a ray starts by what it departs from, −1 if it is none.
inline int face_left(const protostar::Ray& ray, const protostar::Box& box) {
  for (int face = 0; face < 6; ++face)
    if (leaves_plane(ray, face / 2, face % 2 ? box.max[face / 2] : box.min[face / 2])) return face;
  return -1;
}

/// The faces through which a line enters and leaves a box, if 128 digits tell: those that it crosses in one
/// direction, in a point of the box; of some, the first. A ray that leaves a face has that one behind it if
/// it leads through the box, and meets nothing otherwise.
template <class T>
std::optional<std::vector<int>> faces_crossed(const protostar::Ray& ray, const protostar::Box& box,
                                              bool leaves) {
  std::vector<int> crossed;
  const int left = leaves ? face_left(ray, box) : -1;
  const auto is_entered = [&](int face) { return (ray.direction[face / 2] > 0) == (face % 2 == 0); };
  if (leaves && (ray.direction[left / 2] == 0 || !is_entered(left) || box.min[left / 2] == box.max[left / 2]))
    return crossed;
  for (const bool enters : {true, false}) {
    int first = -1;
    for (int face = 0; face < 6; ++face) {
      if (ray.direction[face / 2] == 0 || is_entered(face) != enters) continue;
      const std::optional<bool> is_in = FaceEquation<T>(ray, box, face).is_in_box(ray, box);
      if (!is_in) return std::nullopt;
      if (*is_in && (first < 0 || face == left)) first = face;
    }
    if (first >= 0 && first != left) crossed.push_back(first);
  }
  return crossed;
}

/// The ray that meets a surface where the given one meets its image, with both its parts times the map's
/// determinant: the inverse of a matrix has the cross products of its columns for rows, over that.
template <class T>
struct CarriedRay {
  T determinant;
  Vector<T> origin, direction;

  CarriedRay(const protostar::Ray& ray, const protostar::Affine& map)
      : CarriedRay(ray, map, cross(Vector<T>(map.y), Vector<T>(map.z)),
                   cross(Vector<T>(map.z), Vector<T>(map.x)), cross(Vector<T>(map.x), Vector<T>(map.y))) {}

 private:
  CarriedRay(const protostar::Ray& ray, const protostar::Affine& map, const Vector<T>& yz,
             const Vector<T>& zx, const Vector<T>& xy)
      : determinant(dot(Vector<T>(map.x), yz)),
        origin(back(Vector<T>(ray.origin) - Vector<T>(map.translation), yz, zx, xy)),
        direction(back(Vector<T>(ray.direction), yz, zx, xy)) {}

  static Vector<T> back(const Vector<T>& v, const Vector<T>& yz, const Vector<T>& zx, const Vector<T>& xy) {
    return {dot(yz, v), dot(zx, v), dot(xy, v)};
  }
};

/// Whether a ray is carried into the space of an instance as well as doubles allow: each component with an
/// error of at most 4u, or of the origin 5u, of the sum of its terms' sizes; 6 with the second order.
inline bool is_carried(const protostar::Ray& ray, const protostar::Affine& map,
                       const protostar::Ray& carried) {
  const Vector<Number> x(map.x), y(map.y), z(map.z);
  // Of the inverse, times the determinant.
  const Vector<Number> rows[] = {cross(y, z), cross(z, x), cross(x, y)};
  const Number determinant = dot(x, rows[0]);
  const auto size = [](const Number& n) { return n.sign() < 0 ? -n : n; };
  const auto is_near = [&](const protostar::Vec3& found, const Vector<Number>& v) {
    for (int i = 0; i < 3; ++i) {
      const Number terms[] = {rows[i].x * v.x, rows[i].y * v.y, rows[i].z * v.z};
      const Number off = Number(found[i]) * determinant - (terms[0] + terms[1] + terms[2]);
      const Number sizes = size(terms[0]) + size(terms[1]) + size(terms[2]);
      if ((size(off) - Number(6 * 0x1p-53) * sizes).sign() > 0) return false;
    }
    return true;
  };
  return is_near(carried.origin, Vector<Number>(ray.origin) - Vector<Number>(map.translation)) &&
         is_near(carried.direction, Vector<Number>(ray.direction));
}

/// The equation of a sphere, or of a plane, and the carried ray, times the determinant or its square.
template <class T>
struct PlacedSphereEquation {
  T A, b, c;

  PlacedSphereEquation(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed) {
    const CarriedRay<T> carried(ray, placed.placement);
    const Vector<T> center(placed.own.center), &d = carried.direction;
    const T& k = carried.determinant;
    const Vector<T> l = Vector<T>(k * center.x, k * center.y, k * center.z) - carried.origin;
    A = dot(d, d), b = dot(d, l), c = dot(l, l) - square(k * T(placed.own.radius));
  }
  [[nodiscard]] T discriminant() const { return square(b) - A * c; }
};
template <class T>
struct PlacedPlaneEquation {
  T slope, height;

  PlacedPlaneEquation(const protostar::Ray& ray, const Placed<protostar::Plane>& placed) {
    const CarriedRay<T> carried(ray, placed.placement);
    const Vector<T> n(placed.own.normal);
    slope = dot(n, carried.direction);
    height = carried.determinant * T(placed.own.distance) - dot(n, carried.origin);
  }
};

/// Where all solids of a tree are crossed, in places of equal t from near to far: how often each solid is, in
/// each place; and which of them a ray is inside of in the end.
struct SolidsAlong {
  std::vector<std::vector<int>> times;
  std::vector<bool> ends_inside;

  /// Whether a line is inside of a tree behind a place; −1 is before all.
  [[nodiscard]] bool is_inside(const SolidTree& tree, int place) const {
    std::size_t next = 0;
    return is_inside(tree, place, next);
  }

 private:
  /// The same, where next is the number of the tree's first solid, and then of the first behind it.
  [[nodiscard]] bool is_inside(const SolidTree& tree, int place, std::size_t& next) const {
    using Operation = protostar::Csg::Operation;
    if (tree.operation == Operation::none) return is_inside_solid(next++, place);
    int count = 0;
    bool is_in_first = false;
    for (std::size_t i = 0; i < tree.operands.size(); ++i) {
      const bool is_in = is_inside(tree.operands[i], place, next);
      count += is_in;
      if (i == 0) is_in_first = is_in;
    }
    if (tree.operation == Operation::either) return count > 0;
    if (tree.operation == Operation::all) return count == static_cast<int>(tree.operands.size());
    return is_in_first && count == 1;
  }
  [[nodiscard]] bool is_inside_solid(std::size_t solid, int place) const {
    int ahead = 0;
    for (std::size_t i = static_cast<std::size_t>(place + 1); i < times.size(); ++i) ahead += times[i][solid];
    return ends_inside[solid] != (ahead % 2 != 0);
  }
};

/// Whether a ray is inside of a solid in the end, if 128 digits tell: the sign of A, or that of −b, or c.
template <class T>
std::optional<bool> ends_inside(const protostar::Ray&, const auto&) {
  return false;
}
template <class T>
std::optional<bool> ends_inside(const protostar::Ray& ray, const protostar::Quadric& quadric) {
  const QuadricEquation<T> e(ray, quadric.form);
  for (const T& x : {e.A, -e.b, e.c}) {
    if constexpr (requires { x.is_known(); })
      if (!x.is_known()) return std::nullopt;
    if (x.sign() != 0) return x.sign() < 0;
  }
  return false;
}

/// Whether a ray leaves a solid of a tree. No ray here leaves a quadric of one.
inline bool leaves_solid(const protostar::Ray&, const auto&) { return false; }
inline bool leaves_solid(const protostar::Ray& ray, const protostar::Box& box) {
  return ray.departure.kind != protostar::Departure::Kind::none && face_left(ray, box) >= 0;
}
inline bool leaves_solid(const protostar::Ray& ray, const protostar::Sphere& sphere) {
  const auto& g = ray.departure.geometry;
  return ray.departure.kind == protostar::Departure::Kind::sphere && sphere.center.x == g[0] &&
         sphere.center.y == g[1] && sphere.center.z == g[2] && std::abs(sphere.radius) == g[3];
}

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

/// Those of A t² − 2bt + c = 0 with A > 0.
inline Roots both_roots(const Number& A, const Number& b, const Number& c, const Number& D) {
  if (D.sign() < 0) return {};
  const Quad root = D.sqrt();
  const bool ahead = b.sign() >= 0;
  const Quad q = ahead ? Quad(b) + root : Quad(b) - root;  // nothing cancels
  const Quad one = q / Quad(A), other = q == 0 ? Quad(0) : Quad(c) / q;
  return {{b, D, A, -1, ahead ? other : one}, {b, D, A, 1, ahead ? one : other}};
}

inline Roots roots(const protostar::Ray& ray, const protostar::Sphere& sphere, bool leaves) {
  const SphereEquation<Number> e(ray, sphere);
  if (e.A.sign() == 0) return {};
  if (leaves) {
    const Number p = Number(2) * e.b;
    return {{p, {}, e.A, 0, Quad(p) / Quad(e.A)}};
  }
  return both_roots(e.A, e.b, e.c, e.discriminant());
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
inline Roots roots(const protostar::Ray& ray, const protostar::Box& box, bool leaves) {
  Roots all;
  const std::vector<int> faces = faces_crossed<Number>(ray, box, leaves).value();
  for (const int face : faces) {
    const FaceEquation<Number> e(ray, box, face);
    all.push_back(only_root(e.slope, e.height));
  }
  return all;
}
/// Whether a ray that leaves a quadric meets it again in the quadric's bounds: one that is no ellipsoid with
/// its inside within has none; in those of others its form, which at both places is the c of the origin, is
/// at most 2^-10 of what it is below 0 in the center.
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

inline Roots roots(const protostar::Ray& ray, const protostar::Quadric& quadric, bool leaves) {
  QuadricEquation<Number> e(ray, quadric.form);
  if (leaves && (e.A.sign() == 0 || !meets_again(quadric.form, e.c))) return {};
  if (leaves) return {only_root(e.A, Number(2) * e.b)};
  if (e.A.sign() == 0) return e.b.sign() == 0 ? Roots{} : Roots{only_root(Number(2) * e.b, e.c)};
  if (e.A.sign() < 0) e.A = -e.A, e.b = -e.b, e.c = -e.c;
  return both_roots(e.A, e.b, e.c, e.discriminant());
}

inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed, bool leaves) {
  const PlacedSphereEquation<Number> e(ray, placed);
  if (e.A.sign() == 0) return {};
  if (leaves) return {only_root(e.A, Number(2) * e.b)};
  return both_roots(e.A, e.b, e.c, e.discriminant());
}
inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Plane>& placed, bool leaves) {
  if (leaves) return {};
  const PlacedPlaneEquation<Number> e(ray, placed);
  if (e.slope.sign() == 0) return {};
  return {only_root(e.slope, e.height)};
}

/// Those at which the inside of a tree turns over. A solid that is left has lost one at t = 0 if it has not
/// an even number with both ends outside; what is left there is not met.
inline Roots roots(const protostar::Ray& ray, const Made& made, bool) {
  struct OfSolid {
    Root root;
    std::size_t solid;
  };
  std::vector<OfSolid> all;
  SolidsAlong along;
  bool is_any_left = false;
  made.tree.each_solid([&](const SolidTree::Solid& held) {
    std::visit(
        [&](const auto& solid) {
          const bool leaves = leaves_solid(ray, solid);
          const std::size_t number = along.ends_inside.size();
          Roots crossed = roots(ray, solid, leaves);
          if (leaves && crossed.size() % 2 != 0) crossed.push_back(root_at(0)), is_any_left = true;
          for (const Root& root : crossed) all.push_back({root, number});
          along.ends_inside.push_back(ends_inside<Number>(ray, solid).value());
        },
        held);
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const OfSolid& a, const OfSolid& b) { return compare(a.root, b.root) < 0; });
  Roots places;
  for (const OfSolid& one : all) {
    if (places.empty() || compare(places.back(), one.root) != 0) {
      places.push_back(one.root);
      along.times.emplace_back(along.ends_inside.size());
    }
    ++along.times.back()[one.solid];
  }
  Roots crossings;
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    const Root& root = places[static_cast<std::size_t>(i)];
    if (is_any_left && compare(root, root_at(0)) == 0) continue;
    if (along.is_inside(made.tree, i - 1) != along.is_inside(made.tree, i)) crossings.push_back(root);
  }
  return crossings;
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
inline std::array<double, 4> rounded_equation(const protostar::Disk& s) {
  const Vector<Number> n(s.normal);
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

inline bool coincide(const protostar::Disk& a, const protostar::Disk& b) {
  return rounded_equation(a) == rounded_equation(b);
}
inline bool coincide(const protostar::Disk& a, const protostar::Parallelogram& b) {
  return rounded_equation(a) == rounded_equation(b);
}
inline bool coincide(const protostar::Disk& a, const protostar::Plane& b) {
  for (int i = 0; i < 3; ++i)
    if (a.normal[(i + 1) % 3] == 0 && a.normal[(i + 2) % 3] == 0) {
      protostar::Plane plane{protostar::Vec3{0}, a.position[i]};
      plane.normal[i] = 1;
      return coincide(plane, b);
    }
  return rounded_equation(a) == rounded_equation(b);
}

/// Whether a ray that leaves something else leaves this as well: in one plane at a right angle to an axis, or
/// the same sphere.
inline bool is_left_with(const protostar::Ray& ray, const protostar::Box& box) {
  return face_left(ray, box) >= 0;
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Disk& disk) {
  for (int i = 0; i < 3; ++i)
    if (disk.normal[(i + 1) % 3] == 0 && disk.normal[(i + 2) % 3] == 0)
      return leaves_plane(ray, i, disk.position[i]);
  return false;
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Plane& plane) {
  for (int i = 0; i < 3; ++i)
    if (plane.normal[(i + 1) % 3] == 0 && plane.normal[(i + 2) % 3] == 0 && plane.normal[i] != 0) {
      const auto& g = ray.departure.geometry;
      return ray.departure.kind == protostar::Departure::Kind::plane &&
             coincide(plane, protostar::Plane{{g[0], g[1], g[2]}, g[3]});
    }
  return false;
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Parallelogram& board) {
  for (int i = 0; i < 3; ++i)
    if (board.edge_u[i] == 0 && board.edge_v[i] == 0) return leaves_plane(ray, i, board.position[i]);
  return false;
}
inline bool is_left_with(const protostar::Ray& ray, const protostar::Sphere& sphere) {
  return leaves_solid(ray, sphere);
}
inline bool is_left_with(const protostar::Ray&, const protostar::Quadric&) { return false; }

}  // namespace exact

// Exact crossings of rays and surfaces, and their order, for rays and surfaces as they are given in doubles.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <stdexcept>
#include <type_traits>
#include <variant>
#include <vector>

#include "exact.hpp"
#include "made_of.hpp"

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

/// Part of the surface that a ray leaves, −1 if none.
struct Left {
  int part = -1;
};

/// Face of a box in whose plane a ray starts by its departure, −1 if none; is_own if it leaves this box's
/// face.
struct LeftOfBox {
  int face = -1;
  bool is_own = false;
};

/// Equation slope · t = height of the crossing with the plane of a box's face. A line that leaves the face
/// crosses it at t = 0, whatever its digits are.
template <class T>
struct FaceEquation {
  T slope, height;

  FaceEquation(const Line<T>& line, const protostar::Box& box, int face, const LeftOfBox& left = {})
      : slope(face / 2 == 0   ? line.direction.x
              : face / 2 == 1 ? line.direction.y
                              : line.direction.z) {
    const Vector<T> from_min = line.to(box.min), from_max = line.to(box.max);
    const Vector<T>& from = face % 2 ? from_max : from_min;
    height = face == left.face ? T(0.0) : face / 2 == 0 ? from.x : face / 2 == 1 ? from.y : from.z;
  }

  /// Returns true if the crossing is a point of the box, on the outer side of no other face; nothing if 128
  /// digits do not decide. Points with t > 0 are on the inner side of the face that is left, if the line
  /// leads inwards there.
  [[nodiscard]] std::optional<bool> is_in_box(const Line<T>& line, const protostar::Box& box,
                                              const LeftOfBox& left = {}) const {
    for (int other = 0; other < 6; ++other) {
      const FaceEquation of_other(line, box, other);
      // (position of the face − position of the point) · weight · slope; positive is inside of an upper face.
      T beyond = of_other.height * slope - of_other.slope * height;
      if (other % 2 == 0) beyond = -beyond;
      if (other == left.face) beyond = height;
      if constexpr (requires { beyond.is_known(); })
        if (!beyond.is_known() || !line.weight.is_known() || !slope.is_known()) return std::nullopt;
      const int weight_sign = other == left.face ? 1 : line.weight.sign();
      if (beyond.sign() * slope.sign() * weight_sign < 0) return false;
    }
    return true;
  }
};

/// Returns true if a line leads from a face through the box; nothing if 128 digits do not decide.
template <class T>
std::optional<bool> leads_inwards(const Line<T>& line, const protostar::Box& box, int face) {
  const FaceEquation<T> e(line, box, face);
  if constexpr (requires { e.slope.is_known(); })
    if (!e.slope.is_known() || !line.weight.is_known()) return std::nullopt;
  const bool is_flat = box.min[face / 2] == box.max[face / 2];
  return !is_flat && e.slope.sign() * line.weight.sign() * (face % 2 ? -1 : 1) > 0;
}

/// Returns the faces through which a line enters and leaves a box, or nothing if 128 digits do not decide:
/// for each direction, the first face that it crosses in a point of the box. A ray that leaves a face of the
/// box inwards is in the box and only leaves it: through the face whose plane it crosses first among the
/// faces that it leads out of.
template <class T>
std::optional<std::vector<int>> faces_crossed(const Line<T>& line, const protostar::Box& box,
                                              const LeftOfBox& left) {
  std::vector<int> crossed;
  if (left.face >= 0) {
    const std::optional<bool> inwards = leads_inwards(line, box, left.face);
    if (!inwards) return std::nullopt;
    if (!*inwards) return crossed;
  }
  int signs[6];  // 1 if the face is entered, -1 if it is left
  for (int face = 0; face < 6; ++face) {
    const FaceEquation<T> e(line, box, face);
    if constexpr (requires { e.slope.is_known(); })
      if (!e.slope.is_known() || !line.weight.is_known()) return std::nullopt;
    signs[face] = e.slope.sign() * line.weight.sign() * (face % 2 ? -1 : 1);
  }
  if (left.is_own) {
    int first = -1;
    for (int face = 0; face < 6; ++face) {
      if (signs[face] >= 0) continue;
      if (first >= 0) {
        const FaceEquation<T> e(line, box, face), f(line, box, first);
        const T earlier = f.height * e.slope - e.height * f.slope;  // times both slopes
        if constexpr (requires { earlier.is_known(); })
          if (!earlier.is_known()) return std::nullopt;
        if (earlier.sign() * e.slope.sign() * f.slope.sign() <= 0) continue;
      }
      first = face;
    }
    crossed.push_back(first);
    return crossed;
  }
  for (const int sign : {1, -1}) {
    int first = -1;
    for (int face = 0; face < 6; ++face) {
      if (signs[face] != sign) continue;
      const std::optional<bool> is_in = FaceEquation<T>(line, box, face, left).is_in_box(line, box, left);
      if (!is_in) return std::nullopt;
      if (*is_in && (first < 0 || face == left.face)) first = face;
    }
    if (first >= 0 && first != left.face) crossed.push_back(first);
  }
  return crossed;
}

/// Crossings of all solids of a tree, in places of equal t from near to far: the number of crossings of each
/// solid in each place, and for each solid whether a ray ends inside.
struct SolidsAlong {
  std::vector<std::vector<int>> times;
  std::vector<bool> ends_inside;

  /// Returns true if a line is inside a tree behind a place; −1 is before all.
  [[nodiscard]] bool is_inside(const SolidTree& tree, int place) const {
    std::size_t next = 0;
    return is_inside(tree, place, next);
  }

 private:
  /// Returns true if a line is inside a tree behind a place. next is the number of the tree's first solid,
  /// and afterwards of the first solid behind the tree.
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

/// Returns true if a ray ends inside a solid, by the first sign of A, −b and c that is not 0; nothing if 128
/// digits do not decide. Bounded solids: false.
template <class T>
std::optional<bool> ends_inside(const Line<T>&, const auto&) {
  return false;
}
template <class T>
std::optional<bool> ends_inside(const Line<T>& line, const protostar::Quadric& quadric) {
  const QuadricEquation<T> e(line, quadric.form);
  for (const T& x : {e.A, -e.b, e.c}) {
    if constexpr (requires { x.is_known(); })
      if (!x.is_known()) return std::nullopt;
    if (x.sign() != 0) return x.sign() < 0;
  }
  return false;
}

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

/// Returns the double nearest to N/M, and the one with an even last bit if two are: the one with the least
/// |N − x M|, without rounding, among the quotient of Quads, rounded, and its neighbors.
inline double nearest_quotient(const Number& N, const Number& M) {
  const double q = static_cast<double>(Quad(N) / Quad(M));
  double best = q;
  const auto off = [&](double x) {
    const Number difference = N - Number(x) * M;
    return difference.sign() < 0 ? -difference : difference;
  };
  for (const double x : {std::nextafter(q, -protostar::infinity), std::nextafter(q, protostar::infinity)}) {
    const int closer = (off(best) - off(x)).sign();
    const auto is_even = [](double y) { return (std::bit_cast<std::uint64_t>(y) & 1) == 0; };
    if (closer > 0 || (closer == 0 && is_even(x))) best = x;
  }
  return best;
}

/// Returns the equation of a plane by which surfaces in one plane recognize each other: divided by the
/// largest component of the normal, the first of equals, and rounded.
inline std::array<double, 4> rounded_equation(const Vector<Number>& n, const Number& distance) {
  const Number numbers[] = {n.x, n.y, n.z, distance};
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if ((square(numbers[i]) - square(numbers[k])).sign() > 0) k = i;
  std::array<double, 4> rounded{};
  for (std::size_t i = 0; i < 4; ++i) rounded[i] = nearest_quotient(numbers[i], numbers[k]);
  return rounded;
}

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

/// Returns the crossings of a ray's line with a solid, of which the ray leaves a part, −1 for none; it may
/// leave another surface that coincides with it.
inline Roots roots(const protostar::Ray& ray, const protostar::Sphere& sphere, const Left& left) {
  return roots(Line<Number>(ray), sphere, left.part >= 0 || departs_from(ray.departure, sphere));
}
inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed, const Left& left) {
  return roots(Line<Number>(Line<Number>(ray), placed.placement), placed.own,
               left.part >= 0 || departs_from(ray.departure, placed));
}
inline LeftOfBox left_of(const protostar::Ray& ray, const auto& box, const Left& left) {
  return left.part >= 0 ? LeftOfBox{left.part, true} : LeftOfBox{face_left(ray.departure, box), false};
}
inline Roots roots(const protostar::Ray& ray, const protostar::Box& box, const Left& left) {
  return roots(Line<Number>(ray), box, left_of(ray, box, left));
}
inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Box>& placed, const Left& left) {
  return roots(Line<Number>(Line<Number>(ray), placed.placement), placed.own, left_of(ray, placed, left));
}
/// Returns the crossings with a quadric of a tree, which no ray here leaves.
inline Roots roots(const protostar::Ray& ray, const protostar::Quadric& quadric, const Left&) {
  return roots(Line<Number>(ray), quadric, false);
}

inline int parts_of(const protostar::Box&) { return 6; }
inline int parts_of(const protostar::Sphere&) { return 1; }
inline int parts_of(const protostar::Quadric&) { return 1; }
template <class S>
int parts_of(const Placed<S>& placed) {
  return parts_of(placed.own);
}

/// Returns true if a ray ends inside a solid.
inline bool ends_inside_of(const protostar::Ray&, const auto&) { return false; }
inline bool ends_inside_of(const protostar::Ray& ray, const protostar::Quadric& quadric) {
  return ends_inside<Number>(Line<Number>(ray), quadric).value();
}

/// Returns the crossings at which a ray enters or leaves a tree, whose solids each_solid(visit) visits. If
/// the number of a solid's crossings does not fit its two ends, the solid is left and lacks the crossing at
/// t = 0; then the tree is not crossed at t = 0.
inline Roots roots_of_tree(const protostar::Ray& ray, const SolidTree& tree, const Left& left,
                           const auto& each_solid) {
  struct OfSolid {
    Root root;
    std::size_t solid;
  };
  std::vector<OfSolid> all;
  SolidsAlong along;
  bool is_any_left = false;
  int first_part = 0;
  each_solid([&](const auto& solid) {
    const int inner = left.part - first_part;
    const bool is_own = left.part >= 0 && 0 <= inner && inner < parts_of(solid);
    first_part += parts_of(solid);
    const std::size_t number = along.ends_inside.size();
    Roots crossed = roots(ray, solid, Left{is_own ? inner : -1});
    const bool ends = ends_inside_of(ray, solid);
    const bool begins = ends_inside_of({ray.origin, -ray.direction}, solid);
    if ((crossed.size() % 2 != 0) != (begins != ends)) crossed.push_back(root_at(0)), is_any_left = true;
    for (const Root& root : crossed) all.push_back({root, number});
    along.ends_inside.push_back(ends);
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
    if (along.is_inside(tree, i - 1) != along.is_inside(tree, i)) crossings.push_back(root);
  }
  return crossings;
}
inline Roots roots(const protostar::Ray& ray, const Made& made, const Left& left) {
  return roots_of_tree(ray, made.tree, left, [&](const auto& visit) {
    made.tree.each_solid([&](const SolidTree::Solid& held) { std::visit(visit, held); });
  });
}
/// Solid of the image of a tree. It coincides with the part that a ray leaves also if both do before they are
/// mapped.
template <class S>
struct PlacedInTree : Placed<S> {
  protostar::Departure left_inside;
};
inline Roots roots(const protostar::Ray& ray, const PlacedInTree<protostar::Sphere>& solid,
                   const Left& left) {
  const bool leaves =
      left.part >= 0 || departs_from(ray.departure, solid) || departs_from(solid.left_inside, solid.own);
  return roots(Line<Number>(Line<Number>(ray), solid.placement), solid.own, leaves);
}
inline Roots roots(const protostar::Ray& ray, const PlacedInTree<protostar::Box>& solid, const Left& left) {
  LeftOfBox face = left_of(ray, static_cast<const Placed<protostar::Box>&>(solid), left);
  if (face.face < 0) face.face = face_left(solid.left_inside, solid.own);
  return roots(Line<Number>(Line<Number>(ray), solid.placement), solid.own, face);
}

/// Returns the crossings of the image of a tree, which is a tree of images.
inline Roots roots(const protostar::Ray& ray, const Placed<Made>& placed, const Left& left) {
  const auto each_image = [&](const auto& visit) {
    placed.own.tree.each_solid([&](const SolidTree::Solid& held) {
      std::visit(
          [&](const auto& solid) {
            using S = std::remove_cvref_t<decltype(solid)>;
            if constexpr (std::same_as<S, protostar::Sphere> || std::same_as<S, protostar::Box>)
              visit(PlacedInTree<S>{Placed<S>(solid, placed.placement), {}});
            else
              throw std::logic_error("exact: no images of such a solid are judged");
          },
          held);
    });
  };
  // Departure from the part that the ray leaves, before it is mapped.
  protostar::Departure left_inside;
  int first_part = 0;
  each_image([&](const auto& image) {
    const int inner = left.part - first_part;
    if (left.part >= 0 && 0 <= inner && inner < parts_of(image.own))
      left_inside = protostar::departure_of(image.own, inner);
    first_part += parts_of(image.own);
  });
  return roots_of_tree(ray, placed.own.tree, left, [&](const auto& visit) {
    each_image([&](auto image) {
      image.left_inside = left_inside;
      visit(image);
    });
  });
}

/// Returns the part of a tree that has the departure of a ray, −1 if none.
inline int own_part(const Made& made, const protostar::Departure& left) {
  for (int part = 0; part < made.part_count(); ++part) {
    const protostar::Departure of_part = made.departure(part);
    if (of_part == left && of_part.object == left.object && of_part.part == left.part) return part;
  }
  return -1;
}

/// Returns the crossings of a ray whose departure names the box, or the tree's part, that it leaves, or only
/// a plane.
inline Roots roots(const protostar::Ray& ray, const protostar::Box& box, bool) {
  return roots(ray, box, Left{ray.departure.object != nullptr ? ray.departure.part : -1});
}
inline Roots roots(const protostar::Ray& ray, const Made& made, bool) {
  return roots(ray, made, Left{own_part(made, ray.departure)});
}

/// Crossing with one surface of a scene, which is given by its number.
struct Hit {
  Root root;
  int surface;
};

/// Adds the crossings of a ray and a surface of this number with 0 < t < end; left is a bool, or Left.
template <class S>
void add_hits(std::vector<Hit>& hits, const protostar::Ray& ray, const S& surface, int number, auto left,
              double end) {
  for (const Root& root : roots(ray, surface, left))
    if (root.t > 0 && (end == protostar::infinity || compare(root, root_at(end)) < 0))
      hits.push_back({root, number});
}

/// Sorts crossings in the order of t; crossings at equal t keep their order.
inline void sort(std::vector<Hit>& hits) {
  std::stable_sort(hits.begin(), hits.end(),
                   [](const Hit& a, const Hit& b) { return compare(a.root, b.root) < 0; });
}

/// Returns true if two surfaces are the same points.
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
/// Returns true if both are in one plane, exactly if the parallelogram is orthogonal to an axis.
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

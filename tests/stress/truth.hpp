// True crossings of one ray and one surface, with as many digits as are needed to judge the library.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <optional>
#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <variant>
#include <vector>

#include "ball.hpp"
#include "exact.hpp"
#include "made_of.hpp"
#include "oracle/box_faces.hpp"
#include "oracle/equations.hpp"
#include "oracle/solids_along.hpp"
#include "oracle/surface_roots.hpp"
#include "oracle/tree_roots.hpp"

namespace exact {

static_assert(LDBL_MANT_DIG >= 64);

/// Parameter t of a crossing. Its sign and that of t − 1 are certain; t has a relative error below 2^-60 or,
/// as a Quad, 2^-100.
template <class T>
struct TrueRoot {
  T t;
  int beyond_one;  ///< the sign of t − 1
};

/// Crossings of a ray's line with a surface, near before far; a point of tangency counts twice. A tree of up
/// to four solids has the most.
template <class T = long double>
struct Truth {
  int count = 0;
  TrueRoot<T> root[8];

  [[nodiscard]] const TrueRoot<T>* begin() const { return root; }
  [[nodiscard]] const TrueRoot<T>* end() const { return root + count; }
};

/// Returns the root (p + side · √D) / A with A > 0, approximated well by t, or nothing if 128 digits do not
/// decide. If t is far enough from 1, it tells the sign of t − 1. Otherwise this is the sign of u + side · √D
/// with u = p − A; if both terms have opposite signs, the larger square decides.
inline std::optional<TrueRoot<long double>> true_root(const Ball& p, int side, const Ball& D, const Ball& A,
                                                      long double t) {
  if (t > 1 + 0x1p-59L) return TrueRoot<long double>{t, 1};
  if (t < 1 - 0x1p-59L) return TrueRoot<long double>{t, -1};
  const Ball u = p - A;
  if (!u.is_known()) return std::nullopt;
  if (side == 0 || D.sign() == 0) return TrueRoot<long double>{t, u.sign()};
  if (u.sign() == 0 || u.sign() == side) return TrueRoot<long double>{t, side};
  const Ball squares = square(u) - D;
  if (!squares.is_known()) return std::nullopt;
  return TrueRoot<long double>{t, u.sign() * squares.sign()};
}

/// Returns the only root p/A, A ≠ 0, or nothing if 128 digits do not decide.
inline std::optional<Truth<>> first_level(const Ball& p, const Ball& A) {
  if (!p.is_known() || !A.is_known()) return std::nullopt;
  if (A.sign() < 0) return first_level(-p, -A);
  const auto root = true_root(p, 0, {}, A, static_cast<long double>(p) / static_cast<long double>(A));
  return root ? std::optional(Truth<>{1, {*root, {}}}) : std::nullopt;
}

/// Returns the two roots of an equation with A > 0, or nothing if 128 digits do not decide. The numbers that
/// t is computed from have errors of 2^-62 each, and every operation adds 2^-64. Half of the error of D
/// remains in √D; q, in which nothing cancels, is off by less than 2^-62 + 2^-63, and q/A and c/q by less
/// than 2^-60.
inline std::optional<Truth<>> both_roots(const auto& e) {
  const Ball D = e.discriminant();
  if (!D.is_known()) return std::nullopt;  // D is known only if A, b and c are
  if (D.sign() < 0) return Truth<>{};
  const auto A = static_cast<long double>(e.A), b = static_cast<long double>(e.b),
             c = static_cast<long double>(e.c), root = std::sqrt(static_cast<long double>(D));
  const bool ahead = b >= 0;
  const long double q = ahead ? b + root : b - root;
  const long double one = q / A, other = q == 0 ? 0 : c / q;
  const auto near = true_root(e.b, -1, D, e.A, ahead ? other : one),
             far = true_root(e.b, 1, D, e.A, ahead ? one : other);
  return near && far ? std::optional(Truth<>{2, {*near, *far}}) : std::nullopt;
}

/// Returns the true crossings, or nothing if 128 digits do not decide.
inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const protostar::Sphere& sphere,
                                          bool leaves) {
  const SphereEquation<Ball> e(ray, sphere);
  if (e.A.sign() == 0) return Truth<>{};
  if (leaves) return first_level(Ball(2) * e.b, e.A);
  return both_roots(e);
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const protostar::Plane& plane,
                                          bool leaves) {
  if (leaves) return Truth<>{};
  const PlaneEquation<Ball> e(ray, plane);
  if (!e.slope.is_known()) return std::nullopt;
  if (e.slope.sign() == 0) return Truth<>{};
  return first_level(e.height, e.slope);
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray,
                                          const protostar::Parallelogram& parallelogram, bool leaves) {
  if (leaves) return Truth<>{};
  const ParallelogramEquation<Ball> e(ray, parallelogram);
  if (!e.slope.is_known()) return std::nullopt;
  if (e.slope.sign() == 0) return Truth<>{};
  for (const Ball& x : e.left)
    if (!x.is_known()) return std::nullopt;
  if (!e.is_inside()) return Truth<>{};
  return first_level(e.height, e.slope);
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const protostar::Triangle& triangle,
                                          bool leaves) {
  if (leaves) return Truth<>{};
  const TriangleEquation<Ball> e(ray, triangle);
  const std::optional<bool> is_crossed = e.is_crossed();
  if (!is_crossed) return std::nullopt;
  return *is_crossed ? first_level(e.height, e.slope) : Truth<>{};
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const protostar::Disk& disk,
                                          bool leaves) {
  if (leaves) return Truth<>{};
  const DiskEquation<Ball> e(ray, disk);
  if (!e.slope.is_known()) return std::nullopt;
  if (e.slope.sign() == 0) return Truth<>{};
  if (!e.beyond.is_known()) return std::nullopt;
  if (e.beyond.sign() > 0) return Truth<>{};
  return first_level(e.height, e.slope);
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const protostar::Box& box, bool leaves) {
  if (leaves) return std::nullopt;
  const std::optional<std::vector<int>> faces = faces_crossed<Ball>(Line<Ball>(ray), box, {});
  if (!faces) return std::nullopt;
  Truth<> truth;
  for (const int face : *faces) {
    const FaceEquation<Ball> e(ray, box, face);
    const std::optional<Truth<>> one = first_level(e.height, e.slope);
    if (!one) return std::nullopt;
    truth.root[truth.count++] = one->root[0];
  }
  return truth;
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const protostar::Quadric& quadric,
                                          bool leaves) {
  QuadricEquation<Ball> e(ray, quadric.form);
  if (!e.A.is_known() || !e.b.is_known()) return std::nullopt;
  if (leaves && e.A.sign() == 0) return Truth<>{};
  if (leaves) {
    // In the middle of the chord the form is c − b²/A, and in the center at most as much (meets_again).
    const Ball rest = Ball(2048) * e.c * e.A - square(e.b);
    if (e.A.sign() > 0 && !(rest.is_known() && rest.sign() <= 0)) return std::nullopt;
    return first_level(Ball(2) * e.b, e.A);
  }
  if (e.A.sign() == 0) return e.b.sign() == 0 ? Truth<>{} : first_level(e.c, Ball(2) * e.b);
  if (e.A.sign() < 0) e.A = -e.A, e.b = -e.b, e.c = -e.c;
  return both_roots(e);
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed,
                                          bool leaves) {
  const SphereEquation<Ball> e(Line<Ball>(Line<Ball>(ray), placed.placement), placed.own);
  if (!e.A.is_known()) return std::nullopt;
  if (e.A.sign() == 0) return Truth<>{};
  if (leaves) return first_level(Ball(2) * e.b, e.A);
  return both_roots(e);
}

inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const Placed<protostar::Plane>& placed,
                                          bool leaves) {
  if (leaves) return Truth<>{};
  const PlaneEquation<Ball> e(Line<Ball>(Line<Ball>(ray), placed.placement), placed.own);
  if (!e.slope.is_known()) return std::nullopt;
  if (e.slope.sign() == 0) return Truth<>{};
  return first_level(e.height, e.slope);
}

/// Returns nothing: images of boxes are left to exact numbers.
inline std::optional<Truth<>> first_level(const protostar::Ray&, const Placed<protostar::Box>&, bool) {
  return std::nullopt;
}

/// Returns the true crossings of a tree, if those of all its solids are known and far enough apart for their
/// order to be known; nothing for a ray that leaves it.
inline std::optional<Truth<>> first_level(const protostar::Ray& ray, const Made& made, bool leaves) {
  if (leaves) return std::nullopt;
  struct OfSolid {
    TrueRoot<long double> root;
    std::size_t solid;
  };
  std::vector<OfSolid> all;
  SolidsAlong along;
  bool is_known = true;
  made.tree.each_solid([&](const SolidTree::Solid& held) {
    std::visit(
        [&](const auto& solid) {
          const std::optional<Truth<>> truth = first_level(ray, solid, false);
          const std::optional<bool> ends = ends_inside<Ball>(Line<Ball>(ray), solid);
          is_known = is_known && truth && ends;
          if (!is_known) return;
          for (const auto& root : *truth) all.push_back({root, along.ends_inside.size()});
          along.ends_inside.push_back(*ends);
        },
        held);
  });
  if (!is_known) return std::nullopt;
  std::sort(all.begin(), all.end(), [](const OfSolid& a, const OfSolid& b) { return a.root.t < b.root.t; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    const long double t = all[i].root.t, gap = i == 0 ? 1 : t - all[i - 1].root.t;
    if (i > 0 && !(gap > 0x1p-50L * std::max(std::abs(t), std::abs(all[i - 1].root.t)))) return std::nullopt;
    along.times.emplace_back(along.ends_inside.size());
    along.times.back()[all[i].solid] = 1;
  }
  Truth<> crossings;
  for (int i = 0; i < static_cast<int>(all.size()); ++i)
    if (along.is_inside(made.tree, i - 1) != along.is_inside(made.tree, i))
      crossings.root[crossings.count++] = all[static_cast<std::size_t>(i)].root;
  return crossings;
}

/// Returns the true crossings, from exact numbers.
template <class T = long double, class S>
Truth<T> second_level(const protostar::Ray& ray, const S& surface, bool leaves) {
  Truth<T> truth;
  for (const Root& root : roots(ray, surface, leaves))
    truth.root[truth.count++] = {static_cast<T>(root.t), compare(root, root_at(1))};
  return truth;
}

template <class S>
Truth<> truth_of(const protostar::Ray& ray, const S& surface, bool leaves) {
  const std::optional<Truth<>> truth = first_level(ray, surface, leaves);
  return truth ? *truth : second_level(ray, surface, leaves);
}

/// Returns the name of a coefficient that is wrong in the equation of the first level, or nullptr.
inline const char* wrong_in_quadratic(const auto& e, const auto& truth) {
  if (!e.A.may_be(truth.A)) return "A";
  if (!e.b.may_be(truth.b)) return "b";
  if (!e.c.may_be(truth.c)) return "c";
  return e.discriminant().may_be(truth.discriminant()) ? nullptr : "D";
}
inline const char* wrong_in_linear(const auto& e, const auto& truth) {
  if (!e.slope.may_be(truth.slope)) return "the slope";
  return e.height.may_be(truth.height) ? nullptr : "the height";
}

inline const char* wrong_coefficient(const protostar::Ray& ray, const protostar::Sphere& sphere) {
  return wrong_in_quadratic(SphereEquation<Ball>(ray, sphere), SphereEquation<Number>(ray, sphere));
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed) {
  return wrong_in_quadratic(
      SphereEquation<Ball>(Line<Ball>(Line<Ball>(ray), placed.placement), placed.own),
      SphereEquation<Number>(Line<Number>(Line<Number>(ray), placed.placement), placed.own));
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const protostar::Quadric& quadric) {
  return wrong_in_quadratic(QuadricEquation<Ball>(ray, quadric.form),
                            QuadricEquation<Number>(ray, quadric.form));
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const protostar::Disk& disk) {
  const DiskEquation<Ball> e(ray, disk);
  const DiskEquation<Number> truth(ray, disk);
  if (!e.slope.may_be(truth.slope)) return "the slope";
  if (!e.height.may_be(truth.height)) return "the height";
  return e.beyond.may_be(truth.beyond) ? nullptr : "the distance from the center";
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const protostar::Box& box) {
  for (int face = 0; face < 6; ++face) {
    const FaceEquation<Ball> e(ray, box, face);
    const FaceEquation<Number> truth(ray, box, face);
    if (!e.height.may_be(truth.height)) return "the height";
    const std::optional<bool> is_in = e.is_in_box(ray, box);
    if (is_in && is_in != truth.is_in_box(ray, box)) return "whether a face is crossed in the box";
  }
  return nullptr;
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const protostar::Plane& plane) {
  return wrong_in_linear(PlaneEquation<Ball>(ray, plane), PlaneEquation<Number>(ray, plane));
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const Placed<protostar::Plane>& placed) {
  return wrong_in_linear(
      PlaneEquation<Ball>(Line<Ball>(Line<Ball>(ray), placed.placement), placed.own),
      PlaneEquation<Number>(Line<Number>(Line<Number>(ray), placed.placement), placed.own));
}
/// Returns nullptr: a tree has no equations but those of its solids.
inline const char* wrong_coefficient(const protostar::Ray&, const Made&) { return nullptr; }
inline const char* wrong_coefficient(const protostar::Ray& ray,
                                     const protostar::Parallelogram& parallelogram) {
  const ParallelogramEquation<Ball> e(ray, parallelogram);
  const ParallelogramEquation<Number> truth(ray, parallelogram);
  if (!e.slope.may_be(truth.slope)) return "the slope";
  if (!e.height.may_be(truth.height)) return "the height";
  for (int i = 0; i < 4; ++i)
    if (!e.left[i].may_be(truth.left[i])) return "which side of an edge a point is on";
  return nullptr;
}
inline const char* wrong_coefficient(const protostar::Ray& ray, const protostar::Triangle& triangle) {
  const TriangleEquation<Ball> e(ray, triangle);
  const TriangleEquation<Number> truth(ray, triangle);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k)
      if (!e.side[i][k].may_be(truth.side[i][k])) return "on which side an edge is passed";
  return wrong_in_linear(e, truth);
}

/// Returns the name of a difference between a truth of the first level and exact numbers, or nullptr.
inline const char* difference(const Truth<>& truth, const Roots& exact) {
  if (truth.count != static_cast<int>(exact.size())) return "the number of roots";
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const auto [t, beyond_one] = truth.root[i];
    const Quad exact_t = exact[i].t, off = Quad(t) - exact_t, size = exact_t < 0 ? -exact_t : exact_t;
    if ((t > 0) != (exact_t > 0) || (t < 0) != (exact_t < 0)) return "the sign of a root";
    if ((off < 0 ? -off : off) > Quad(0x1p-60) * size) return "a root to 2^-60";
    if (beyond_one != compare(exact[i], root_at(1))) return "which side of 1 a root is on";
  }
  return nullptr;
}

/// Returns the name of an error of the first level, or nullptr.
template <class S>
const char* wrong_in_first_level(const protostar::Ray& ray, const S& surface, bool leaves) {
  if (const char* wrong = wrong_coefficient(ray, surface)) return wrong;
  const std::optional<Truth<>> truth = first_level(ray, surface, leaves);
  return truth ? difference(*truth, roots(ray, surface, leaves)) : nullptr;
}

}  // namespace exact

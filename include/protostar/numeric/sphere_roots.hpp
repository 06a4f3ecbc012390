// Where a line crosses a sphere: exactly whether, and t as certain as Roots says (§2.2.4, A.1.1).
//
// With l = center − origin, a point origin + t·d of the line is on the sphere where |t·d − l|² = r², that is
//   A t² − 2 b t + c = 0   with   A = d·d,  b = d·l,  c = l·l − r².
// A line that starts on the sphere has c = 0 by definition, whatever its digits say; its roots are 0 and
// 2b/A, and only the second is a crossing that it does not come from.
//
// Double decides nearly always. Where its error bound does not allow that, the same equation is evaluated in
// double-double, and where that does not decide either, in exact arithmetic. docs/numerics.md derives the
// bounds, in units of u = 2^-53.
#pragma once

#include <cmath>
#include <optional>

#include "../vec3.hpp"
#include "expansion.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// The coefficients, evaluated in double-double or exactly and rounded to that.
struct SphereEquation {
  DoubleDouble A, b, c, D;
  double w;                   ///< |l|² + r², to double precision
  int t_exponent;             ///< the roots of these coefficients are to be multiplied by 2^t_exponent
  double discriminant_error;  ///< of D, absolute; 0 where A, b, c and D are all good to 2^-103

  SphereEquation(Point origin, Vec3 direction, Point center, double radius, Precision precision) {
    // Powers of two bring lengths and direction to about 1, so that no product leaves the range of double. A
    // component that is less than 2^-200 of the largest may then lose bits below 2^-1074, exactness with
    // them.
    const int lengths = exponent_of({origin, center, Vec3{radius}});
    const int directions = exponent_of({direction});
    origin = scaled(origin, -lengths), center = scaled(center, -lengths),
    radius = std::ldexp(radius, -lengths);
    direction = scaled(direction, -directions);
    t_exponent = lengths - directions;

    if (precision == Precision::exact) {
      ++fallbacks.exact;
      evaluate<Expansion>(origin, direction, center, radius);
    } else {
      ++fallbacks.double_double;
      evaluate<DoubleDouble>(origin, direction, center, radius);
    }
    const Vec3 l = center - origin;
    w = dot(l, l) + radius * radius;
    discriminant_error = precision == Precision::exact ? 0 : 0x1p-98 * A.hi * w;
  }

  [[nodiscard]] DoubleDouble scaled_back(DoubleDouble t) const {
    return {std::ldexp(t.hi, t_exponent), std::ldexp(t.lo, t_exponent)};
  }

 private:
  template <class T>
  void evaluate(const Point& origin, const Vec3& direction, const Point& center, double radius) {
    const T lx = T(center.x) - T(origin.x), ly = T(center.y) - T(origin.y), lz = T(center.z) - T(origin.z);
    const T dx = direction.x, dy = direction.y, dz = direction.z, r = radius;
    const T a = dx * dx + dy * dy + dz * dz;
    const T half_slope = dx * lx + dy * ly + dz * lz;
    const T constant = lx * lx + ly * ly + lz * lz - r * r;
    A = DoubleDouble(a);
    b = DoubleDouble(half_slope);
    c = DoubleDouble(constant);
    D = DoubleDouble(half_slope * half_slope - a * constant);
  }
};

}  // namespace detail

/// The roots of a line of finite numbers with direction ≠ 0, in double-double: good to 2^-58 or undecided, or
/// from exact coefficients.
[[nodiscard]] inline RefinedRoots refined_sphere_roots(const Point& origin, const Vec3& direction,
                                                       const Point& center, double radius,
                                                       Precision precision) {
  const detail::SphereEquation e(origin, direction, center, radius, precision);
  RefinedRoots roots;
  const DoubleDouble root = sqrt(e.D);
  const DoubleDouble q = e.b.sign() < 0 ? e.b - root : e.b + root;  // b ± √D without the cancellation
  if (precision == Precision::exact) {
    roots.relative_error = 0x1p-97;  // a sum, a root and a quotient of coefficients that are good to 2^-103
  } else {
    // The error of c is at most 16u² w, that of b 12u² √(A w), and that of D 66u² A w < 2^-99 A w. For |c| >
    // 2^-40 w that of c is below 2^-62 |c|, and since b² or D is at least A|c|/2, q > 2^-21 √(A w), so that
    // the error of b is below 2^-80 |q|; for √D·|q| > 2^-39 A w that of √D, which is that of D over 2√D, is
    // below 2^-60 |q|. All of them together stay below 2^-58.
    const double Aw = e.A.hi * e.w;
    const bool misses = e.D.hi < -e.discriminant_error;
    const bool certain = e.D.hi > e.discriminant_error && root.hi * std::abs(q.hi) > 0x1p-39 * Aw &&
                         std::abs(e.c.hi) > 0x1p-40 * e.w;
    if (!misses && !certain) return roots;
    roots.relative_error = 0x1p-58;
  }
  if (e.D.sign() < 0) return roots;

  // One root is q/A, and the other c/q, since their product is c/A. Where q is 0, so are D, b and c.
  const DoubleDouble t1 = q.sign() == 0 ? DoubleDouble() : e.c / q, t2 = q / e.A;
  const bool in_order = (t2 - t1).sign() >= 0;
  roots.count = 2;
  roots.t[0] = e.scaled_back(in_order ? t1 : t2);
  roots.t[1] = e.scaled_back(in_order ? t2 : t1);
  return roots;
}

/// The root 2b/A of a line that starts on the sphere, likewise.
[[nodiscard]] inline RefinedRoots refined_sphere_root_leaving(const Point& origin, const Vec3& direction,
                                                              const Point& center, double radius,
                                                              Precision precision) {
  const detail::SphereEquation e(origin, direction, center, radius, precision);
  RefinedRoots roots;
  if (precision == Precision::exact)
    roots.relative_error = 0x1p-97;
  else if (std::abs(e.b.hi) > 0x1p-40 * std::sqrt(e.A.hi * e.w))
    roots.relative_error = 0x1p-58;  // the error of b is at most 12u² √(A w) < 2^-62 |b|
  else
    return roots;
  roots.count = 1;
  roots.t[0] = e.scaled_back(DoubleDouble(2) * e.b / e.A);
  return roots;
}

namespace detail {

/// The roots where double does not decide, from the refined ones. Numbers that are not finite, and a
/// direction of 0, cross nothing.
[[nodiscard]] inline Roots rounded_roots(const Point& origin, const Vec3& direction, const Point& center,
                                         double radius, const auto& refine) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(center) || !std::isfinite(radius) ||
      direction == Vec3{0})
    return {};
  RefinedRoots refined = refine(origin, direction, center, radius, Precision::double_double);
  if (!(refined.relative_error < Roots::relative_error))
    refined = refine(origin, direction, center, radius, Precision::exact);
  if (refined.count == 0) return {};
  if (refined.count == 1) return Roots{static_cast<double>(refined.t[0])};
  return {static_cast<double>(refined.t[0]), static_cast<double>(refined.t[1])};
}

/// Added to the error of a discriminant, or of b: more than all underflows together, of 2^-1075 (4A + 3|c| +
/// 6|b| + 2), wherever A < 2^150 and rounding is not larger still. Overflow needs nothing: it makes the error
/// infinite first.
inline constexpr double underflow = 0x1p-900;

/// Whether the products with the square of a direction stay in the range of double, given that those of
/// lengths do.
[[nodiscard]] inline bool in_range(double A) { return 0x1p-150 < A && A < 0x1p150; }

/// The roots from the coefficients and the discriminant, which has an error of at most E; nothing if that
/// does not certify them. Of b ± √D, q is the one without cancellation; one root is q/A, and the other c/q,
/// since their product is c/A.
///
/// The error of c is at most 7u w and that of √D at most E/(2√D): both must be below 2^-32 of what they go
/// into, c and q. |c| > 2^-18 w also makes q larger than 2^-10 √(A w), so that the error of b, 4u √(A w), is
/// of no account.
[[nodiscard, gnu::always_inline]] inline std::optional<Roots> certified_roots(double A, double b, double c,
                                                                              double w, double D, double E) {
  const double root = std::sqrt(D);
  const double q = b + std::copysign(root, b);
  if (!(D > 4 * E && root * std::abs(q) > 0x1p31 * E && std::abs(c) > 0x1p-18 * w)) return std::nullopt;
  const double t1 = c / q, t2 = q / A;
  return t1 < t2 ? Roots{t1, t2} : Roots{t2, t1};
}

/// The roots where b² − A c does not tell.
[[nodiscard, gnu::noinline, gnu::cold, gnu::pure]] inline Roots sphere_roots_in_doubt(Point origin,
                                                                                      Vec3 direction,
                                                                                      Point center,
                                                                                      double radius) {
  const Vec3 l = center - origin;
  const double A = dot(direction, direction), b = dot(direction, l), ll = dot(l, l), rr = radius * radius;
  if (in_range(A)) {
    // By Lagrange's identity D = A r² − |l × d|², which does not cancel where the center is far away. A line
    // that meets the sphere has an error here of at most 9u A r s + 15u² A s², s = |l| + r; one that does
    // not, comes out no higher.
    const Vec3 moment = cross(l, direction);
    const double r = std::abs(radius), size = std::sqrt(ll) + r;
    const double D = A * rr - dot(moment, moment);
    const double E = 0x1p-49 * A * size * (r + 0x1p-45 * size) + underflow;
    if (D < -E) return {};
    if (const auto roots = certified_roots(A, b, ll - rr, ll + rr, D, E)) return *roots;
  }
  return rounded_roots(origin, direction, center, radius, refined_sphere_roots);
}

}  // namespace detail

/// The roots, certified.
[[nodiscard, gnu::always_inline]] inline Roots sphere_roots(const Point& origin, const Vec3& direction,
                                                            const Point& center, double radius) {
  const Vec3 l = center - origin;
  const double A = dot(direction, direction), b = dot(direction, l);
  const double ll = dot(l, l), rr = radius * radius, c = ll - rr, w = ll + rr;
  const double D = b * b - A * c;
  // The error of D is at most 20u A w, where nothing underflows or overflows.
  const double E = 0x1p-48 * (A * w) + detail::underflow;
  if (detail::in_range(A)) {
    if (D < -E) return {};
    if (const auto roots = detail::certified_roots(A, b, c, w, D, E)) return *roots;
  }
  return detail::sphere_roots_in_doubt(origin, direction, center, radius);
}

/// The root of a line that starts on the sphere, certified: the one that it does not come from.
[[nodiscard]] inline Roots sphere_root_leaving(const Point& origin, const Vec3& direction,
                                               const Point& center, double radius) {
  const Vec3 l = center - origin;
  const double size = std::abs(l.x) + std::abs(l.y) + std::abs(l.z) + std::abs(radius);
  const double sum = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
  const double A = dot(direction, direction), b = dot(direction, l);
  // The error of b is at most 4u |d||l|, hence below 2^-32 |b| here.
  if (std::abs(b) > 0x1p-19 * sum * size + detail::underflow && detail::in_range(A)) return Roots{2 * b / A};
  return detail::rounded_roots(origin, direction, center, radius, refined_sphere_root_leaving);
}

}  // namespace protostar::inline PROTOSTAR_ABI

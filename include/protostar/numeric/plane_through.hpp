// Planes through a point along two directions: their normals, and their equations in doubles.
//
// The normal u × v and the distance of an exact plane are seldom doubles. To let two surfaces find out that
// they lie in one plane, each writes down the same equation: divided by the largest component of the normal,
// and rounded to the nearest doubles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "../bit_cast.hpp"
#include "../vec3.hpp"
#include "double_double.hpp"
#include "exact_number.hpp"
#include "precise_vector.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns true if each number of some vectors is 0 or at least 2^-300 of their largest. Times a power of two
/// with which the largest is at least 2^-102, no digit of them or of their differences is then below 2^-454,
/// and none of a product of two below 2^-908: scaling and products are exact.
[[nodiscard]] inline bool are_commensurate(const auto&... vectors) {
  double largest = 0;
  const auto extend = [&](const Vec3& v) {
    largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  (extend(vectors), ...);
  const double least = 0x1p-300 * largest;
  const auto is_small = [&](double x) { return (x != 0) & (std::abs(x) < least); };
  return !((is_small(vectors.x) | is_small(vectors.y) | is_small(vectors.z)) | ...);
}

/// Returns u × v, each component with an error of at most 2^-104 of itself: the products are exact if they do
/// not underflow (are_commensurate), and their difference is rounded by 3u² + 13u³. Hence a component is 0
/// only if the exact one is.
[[nodiscard]] inline PreciseVector cross_product(const Vec3& u, const Vec3& v) {
  const auto component = [&](int j, int k) { return two_product(u[j], v[k]) - two_product(u[k], v[j]); };
  return {component(1, 2), component(2, 0), component(0, 1)};
}

/// Numbers of the equation normal · x = distance (normal, then distance), divided by the largest component of
/// the normal, the first of equals, and rounded to nearest. Equal planes have equal numbers.
using PlaneEquation = std::array<double, 4>;

namespace detail {

/// Returns N/M for M ≠ 0, rounded like a quotient of doubles: to nearest, ties to even.
[[nodiscard, gnu::cold, gnu::noinline]] inline double nearest_quotient(const ExactNumber& N,
                                                                       const ExactNumber& M) {
  if (N.sign() == 0) return 0;
  // q is accurate to 2^-96 before it is rounded to a double, so one of its neighbors may be nearer, but
  // nothing beyond them.
  const ExactNumber::Approximation n = N.approximation(), m = M.approximation();
  const double q = std::ldexp(static_cast<double>(n.value / m.value), n.exponent - m.exponent);
  const auto exact = [](double x) {  // infinity stands for ±2^1024, which comes after the largest double
    return std::isinf(x) ? ExactNumber(std::copysign(2, x)) * ExactNumber(0x1p1023) : ExactNumber(x);
  };
  const bool is_even = (detail::bit_cast<std::uint64_t>(q) & 1) == 0;
  for (const int side : {-1, 1}) {
    const double neighbor = std::nextafter(q, side * infinity);
    // N/M relative to the middle: on the neighbor's side (1), in it (0), or on the side of q (-1).
    const ExactNumber middle = (exact(q) + exact(neighbor)) * M;
    const int beyond = side * M.sign() * (ExactNumber(2) * N - middle).sign();
    if (beyond > 0 || (beyond == 0 && !is_even)) return neighbor;
  }
  return q;
}

/// Returns the equation of the plane n · x = distance; only its final numbers are rounded.
[[nodiscard, gnu::cold, gnu::noinline]] inline PlaneEquation nearest_plane(const ExactVector& n,
                                                                           const ExactNumber& distance) {
  const auto size = [&](std::size_t i) { return n[i].sign() < 0 ? -n[i] : n[i]; };
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if ((size(i) - size(k)).sign() > 0) k = i;
  if (n[k].sign() == 0) return {};
  return {nearest_quotient(n[0], n[k]), nearest_quotient(n[1], n[k]), nearest_quotient(n[2], n[k]),
          nearest_quotient(distance, n[k])};
}

/// Returns a/b by long division with two digits of 53 bits, in half the time of a / b and with an error below
/// 16u² (algorithm DWDivDW2 of Joldes, Muller and Popescu).
[[nodiscard]] inline DoubleDouble two_digits(DoubleDouble a, DoubleDouble b) {
  const double first = a.hi / b.hi;
  const DoubleDouble product = two_product(b.hi, first);
  const DoubleDouble whole = fast_two_sum(product.hi, std::fma(b.lo, first, product.lo));
  return fast_two_sum(first, ((a.hi - whole.hi) + (a.lo - whole.lo)) / b.hi);
}

/// Returns the equation of the plane through a point with a given normal, from double-double; empty if that
/// does not decide which component is the largest or how a quotient is rounded. The error is an upper bound
/// for the relative errors of the normal's components: 0, or at least 2^-100.
///
/// In units of u², an exact normal, or one with an error of 3, gives quotients 3 + 3 + 16; the distance has 3
/// + 5 + 3 + 3 of the magnitudes of its terms, and its quotient 3 + 16 more. All are below 2^-100 = 64u². If
/// the normal's error is large against that, a quotient has twice as much, and the distance as much.
///
/// High parts of components that are off by at most 2^-80 are off by less than 2^-52 together, so that those
/// that differ by more than 2^-50 are in the right order. Precondition: the position's components are 0 or
/// from 2^-301 to 1. The largest component is above 2^-200, and quotients are 0 or above 2^-300, so that the
/// components are 0 or above 2^-500, and terms of the distance above 2^-801: with 2^-106 of them, their last
/// digits are far above 2^-1074, and nothing underflows.
[[nodiscard]] inline std::optional<PlaneEquation> refined_plane_at(const Point& position,
                                                                   const PreciseVector& n, double error) {
  const auto size = [&](int i) { return std::abs(n[i].hi); };
  int k = 0;
  for (int i = 1; i < 3; ++i) {
    if (error != 0 && std::abs(size(i) - size(k)) <= 0x1p-50 * size(k)) return std::nullopt;
    if (size(i) > size(k)) k = i;
  }
  if (!(size(k) > 0x1p-200)) return std::nullopt;
  error = std::max(error, 0x1p-100);
  PlaneEquation equation;
  const auto is_rounded = [&](int i, DoubleDouble q, double uncertain) {
    equation[static_cast<std::size_t>(i)] = q.hi;
    if (q.hi != 0 && !(std::abs(q.hi) > 0x1p-300)) return false;
    return q.hi + (q.lo + uncertain) == q.hi && q.hi + (q.lo - uncertain) == q.hi;
  };
  DoubleDouble distance;
  double terms = 0;
  for (int i = 0; i < 3; ++i) {
    const DoubleDouble q = two_digits(n[i], n[k]), term = n[i] * position[i];
    if (!is_rounded(i, q, error * std::abs(q.hi))) return std::nullopt;
    distance = distance + term;
    terms += std::abs(term.hi);
  }
  if (!is_rounded(3, two_digits(distance, n[k]), error * (terms / std::abs(n[k].hi)))) return std::nullopt;
  return equation;
}

/// Returns u × v of vectors in double-double, each component with an error of at most 2^-82 of itself, and 0
/// only if the exact one is; empty if more than 20 binary digits cancel in one component. The products, which
/// must not underflow, have errors of 5u², and their difference 3u²: 8u² = 2^-103 of the magnitudes of both.
/// For doubles, such as differences of floats, the faster cross_product is used, and cancellation does no
/// harm.
[[nodiscard]] inline std::optional<PreciseVector> refined_cross_product(const PreciseVector& u,
                                                                        const PreciseVector& v) {
  const auto are_doubles = [](const PreciseVector& a) { return a.x.lo == 0 && a.y.lo == 0 && a.z.lo == 0; };
  if (are_doubles(u) && are_doubles(v))
    return cross_product({u.x.hi, u.y.hi, u.z.hi}, {v.x.hi, v.y.hi, v.z.hi});
  bool cancels = false;
  const auto component = [&](int j, int k) {
    const DoubleDouble one = u[j] * v[k], other = u[k] * v[j], difference = one - other;
    const double terms = std::abs(one.hi) + std::abs(other.hi);
    cancels = cancels || (terms != 0 && !(std::abs(difference.hi) > 0x1p-20 * terms));
    return difference;
  };
  const PreciseVector n{component(1, 2), component(2, 0), component(0, 1)};
  return cancels ? std::nullopt : std::optional(n);
}

/// Returns u × v, times a power of two, each component with an error of at most 2^-104 of itself, if it is
/// known so well. Of vectors of moderate size it is if all numbers are 0 or at least 2^-400, and so all
/// digits of products at least 2^-906: a test of these takes less time.
[[nodiscard]] inline std::optional<PreciseVector> refined_normal_along(const Vec3& u, const Vec3& v) {
  if (is_of_moderate_size(u) && is_of_moderate_size(v)) [[likely]] {
    const auto is_tiny = [](double x) { return (x != 0) & (std::abs(x) < 0x1p-400); };
    if (is_tiny(u.x) | is_tiny(u.y) | is_tiny(u.z) | is_tiny(v.x) | is_tiny(v.y) | is_tiny(v.z))
      return std::nullopt;
    return cross_product(u, v);
  }
  if (!are_commensurate(u) || !are_commensurate(v)) return std::nullopt;
  return cross_product(of_moderate_size(u), of_moderate_size(v));
}

/// Returns the equation of the plane through a point with a given normal, whose components have relative
/// errors of at most `error`; without rounding it is exact_normal().
[[nodiscard, gnu::noinline]] PlaneEquation rounded_plane_at(const Point& position,
                                                            const std::optional<PreciseVector>& normal,
                                                            double error, const auto& exact_normal) {
  if (normal && are_commensurate(position)) {
    const int lengths = exponent_of({position});
    if (auto equation = refined_plane_at(scaled(position, -lengths), *normal, error)) {
      double& distance = (*equation)[3];
      const double in_lengths = std::exchange(distance, scaled(distance, lengths));
      if (scaled(distance, -lengths) == in_lengths) return *equation;  // not rounded once more
    }
  }
  const ExactVector n = exact_normal();
  return nearest_plane(n, dot(n, exact_vector(position)));
}

}  // namespace detail

/// Returns true if an equation, which may have been rounded, certainly is not that of the plane through a
/// point along some vectors. Its numbers have errors of u = 2^-53 of themselves, or of u · 2^-1022 if they
/// are smaller than 2^-1022, and the vectors, which may be rounded differences, of u of themselves; the
/// scalar product has 3u of the magnitudes of its terms and the difference u, together less than 2^-50 of
/// them. 2^-900 covers the underflow of products.
[[nodiscard]] inline bool surely_differs(const PlaneEquation& equation, const Point& position,
                                         const auto&... along) {
  const Vec3 normal{equation[0], equation[1], equation[2]}, sizes = abs(normal) + Vec3(0x1p-1022);
  const auto is_off = [&](const Vec3& x, double expected = 0) {
    return std::abs(dot(normal, x) - expected) >
           0x1p-50 * (dot(sizes, abs(x)) + std::abs(expected)) + 0x1p-900;
  };
  return is_off(position, equation[3]) || (is_off(along) || ...);
}

/// Returns the equation of the plane through a point along u and v, which must not be parallel.
[[nodiscard]] inline PlaneEquation plane_through(const Point& position, const Vec3& u, const Vec3& v) {
  return detail::rounded_plane_at(position, detail::refined_normal_along(u, v), 0x1p-100,
                                  [&] { return cross(exact_vector(u), exact_vector(v)); });
}

/// Returns the equation of the plane through a point perpendicular to a normal, which must not be 0.
[[nodiscard]] inline PlaneEquation plane_at(const Point& position, const Vec3& normal) {
  std::optional<PreciseVector> refined;
  if (are_commensurate(normal)) {
    const Vec3 n = of_moderate_size(normal);
    refined = PreciseVector(n);
  }
  return detail::rounded_plane_at(position, refined, 0, [&] { return exact_vector(normal); });
}

/// Returns (b − a) × (c − a) without rounding.
[[nodiscard]] inline ExactVector exact_normal(const Point& a, const Point& b, const Point& c) {
  return cross(exact_difference(b, a), exact_difference(c, a));
}

namespace detail {

/// Returns (b − a) × (c − a), times a power of two, each component with an error of at most 2^-82 of itself,
/// if it is known so well.
[[nodiscard]] inline std::optional<PreciseVector> refined_normal(const Point& a, const Point& b,
                                                                 const Point& c) {
  if (!are_commensurate(a, b, c)) return std::nullopt;
  const int exponent = exponent_of({a, b, c});
  return refined_cross_product(scaled_difference(b, a, -exponent), scaled_difference(c, a, -exponent));
}

/// Returns the unit vector along a vector without rounding; NaN if it is 0.
[[nodiscard, gnu::cold, gnu::noinline]] inline Vec3 exact_unit_along(const ExactVector& n) {
  int largest = std::numeric_limits<int>::min();
  for (const ExactNumber& x : n)
    if (x.sign() != 0) largest = std::max(largest, x.approximation().exponent);
  const auto nearest = [&](const ExactNumber& x) {
    const auto [value, exponent] = x.approximation();
    return x.sign() == 0 ? 0 : std::ldexp(value.hi, std::max(exponent - largest, -4000));
  };
  return normalize(Vec3{nearest(n[0]), nearest(n[1]), nearest(n[2])});
}

/// Returns the unit vector along a vector in double-double, if there is one and it is not 0, otherwise along
/// exact().
[[nodiscard]] inline Vec3 unit_along(const std::optional<PreciseVector>& n, const auto& exact) {
  if (n) {
    const Vec3 unit = normalize(of_moderate_size({n->x.hi, n->y.hi, n->z.hi}));
    if (is_finite(unit)) return unit;
  }
  return exact_unit_along(exact());
}

}  // namespace detail

/// Returns the unit normal along u × v, whatever the lengths of both; NaN if they are parallel. The product
/// rarely underflows; if so, only the final numbers are rounded.
[[nodiscard]] inline Vec3 unit_normal(const Vec3& u, const Vec3& v) {
  return detail::unit_along(detail::refined_normal_along(u, v),
                            [&] { return cross(exact_vector(u), exact_vector(v)); });
}

/// Returns the unit normal along (b − a) × (c − a), however far the points are from the origin; NaN if they
/// are on one line. More than 20 binary digits rarely cancel, and the product rarely underflows; if so, only
/// the final numbers are rounded.
[[nodiscard]] inline Vec3 unit_normal_through(const Point& a, const Point& b, const Point& c) {
  return detail::unit_along(detail::refined_normal(a, b, c), [&] { return exact_normal(a, b, c); });
}

/// Returns the equation of the plane through three points that are not on one line. With the normal accurate
/// to 2^-82, quotients and distance are accurate to 2^-80.
[[nodiscard]] inline PlaneEquation plane_through_points(const Point& a, const Point& b, const Point& c) {
  return detail::rounded_plane_at(a, detail::refined_normal(a, b, c), 0x1p-80,
                                  [&] { return exact_normal(a, b, c); });
}

}  // namespace protostar::inline PROTOSTAR_ABI

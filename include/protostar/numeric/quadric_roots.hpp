// Where a line crosses a quadric: exactly whether, and t as certain as Roots says.
//
// A quadric is where f(p) = p·Mp + 2 l·p + k is 0, for a symmetric matrix M. On the points origin + t·d of a
// line, with g = M·origin + l, half of the gradient at the origin, f is
//   A t² − 2 b t + c   with   A = d·Md,  b = −d·g,  c = f(origin) = origin·g + l·origin + k.
// Where A is 0 that is a linear equation. A line that starts on the quadric has c = 0 by definition, whatever
// its digits say; its roots are 0 and 2b/A, and only the second is a crossing that it does not come from.
//
// Double decides nearly always. Where its error bound does not allow that, everything is evaluated without
// rounding. docs/numerics.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <algorithm>
#include <cmath>

#include "../vec3.hpp"
#include "exact_root.hpp"
#include "plane_through.hpp"
#include "roots.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The ten numbers of f(p) = squares·(x², y², z²) + 2 products·(yz, zx, xy) + 2 linear·p + constant. They are
/// those of a symmetric matrix of four rows and columns, the last of which belong to linear and constant.
struct QuadricForm {
  Vec3 squares{1};
  Vec3 products{0};
  Vec3 linear{0};
  double constant = -1;

  /// M v.
  [[nodiscard]] Vec3 times(const Vec3& v) const {
    return {squares.x * v.x + products.z * v.y + products.y * v.z,
            products.z * v.x + squares.y * v.y + products.x * v.z,
            products.y * v.x + products.x * v.y + squares.z * v.z};
  }
};

[[nodiscard]] inline QuadricForm abs(const QuadricForm& form) {
  return {abs(form.squares), abs(form.products), abs(form.linear), std::abs(form.constant)};
}
[[nodiscard]] inline bool is_finite(const QuadricForm& form) {
  return is_finite(form.squares) && is_finite(form.products) && is_finite(form.linear) &&
         std::isfinite(form.constant);
}

namespace detail {

/// The equation of a line and a quadric of finite numbers without rounding, in numbers of about 1, brought
/// there by powers of two. A is not negative: where it would be, all three are turned over.
struct ExactQuadricEquation {
  Expansion A, b, c;
  int exponent;            ///< t is 2^exponent times what it is in these numbers
  bool is_turned = false;  ///< whether A, b and c are those of −f

  [[gnu::cold, gnu::noinline]] ExactQuadricEquation(const Point& origin, const Vec3& direction,
                                                    const QuadricForm& form) {
    // A unit of length in which the origin is not large, and no term of f is larger than those of the highest
    // degree.
    const int quadratic = exponent_of({form.squares, form.products}), linear = exponent_of({form.linear}),
              constant = exponent_of({{form.constant, 0, 0}}), directions = exponent_of({direction});
    int lengths = exponent_of({origin});
    if (form.squares != Vec3{0} || form.products != Vec3{0})
      lengths = std::max({lengths, (constant - quadratic) / 2, linear - quadratic});
    else
      lengths = std::max(lengths, constant - linear);
    const int largest = std::max({quadratic + 2 * lengths, linear + lengths, constant});

    const ExactVector squares = exact_vector(scaled(form.squares, 2 * lengths - largest)),
                      products = exact_vector(scaled(form.products, 2 * lengths - largest)),
                      l = exact_vector(scaled(form.linear, lengths - largest)),
                      d = exact_vector(scaled(direction, -directions)),
                      o = exact_vector(scaled(origin, -lengths));
    const auto M_times = [&](const ExactVector& v) -> ExactVector {
      return {squares[0] * v[0] + products[2] * v[1] + products[1] * v[2],
              products[2] * v[0] + squares[1] * v[1] + products[0] * v[2],
              products[1] * v[0] + products[0] * v[1] + squares[2] * v[2]};
    };
    const ExactVector Mo = M_times(o), g{Mo[0] + l[0], Mo[1] + l[1], Mo[2] + l[2]};
    A = exact_dot(d, M_times(d));
    b = -exact_dot(d, g);
    c = exact_dot(o, g) + exact_dot(l, o) + Expansion(std::ldexp(form.constant, -largest));
    exponent = lengths - directions;
    is_turned = A.sign() < 0;
    if (is_turned) A = -A, b = -b, c = -c;
  }

  [[nodiscard, gnu::cold]] Expansion discriminant() const { return b * b - A * c; }

  /// The root p/q.
  [[nodiscard, gnu::cold, gnu::noinline]] ExactRoot quotient(const Expansion& p, const Expansion& q) const {
    const bool is_negative = q.sign() < 0;
    return {.A = is_negative ? -q : q, .b = is_negative ? -p : p, .D = {}, .exponent = exponent};
  }
  [[nodiscard]] ExactRoot linear_root() const { return quotient(c, b + b); }
  [[nodiscard]] ExactRoot root_leaving() const { return quotient(b + b, A); }
};

}  // namespace detail

/// One of the roots of a line that meets the quadric, without rounding; 0 is the near one, 1 the far one.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_quadric_root(const Point& origin,
                                                                            const Vec3& direction,
                                                                            const QuadricForm& form,
                                                                            int root) {
  const detail::ExactQuadricEquation e(origin, direction, form);
  if (e.A.sign() == 0) return e.linear_root();
  return {.A = e.A, .b = e.b, .D = e.discriminant(), .sign = root == 0 ? -1 : 1, .exponent = e.exponent};
}

/// The root 2b/A, likewise.
[[nodiscard, gnu::cold, gnu::noinline]] inline ExactRoot exact_quadric_root_leaving(const Point& origin,
                                                                                    const Vec3& direction,
                                                                                    const QuadricForm& form) {
  return detail::ExactQuadricEquation(origin, direction, form).root_leaving();
}

/// The roots in double-double. A line that lies in the quadric has none.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_quadric_roots(const Point& origin,
                                                                                  const Vec3& direction,
                                                                                  const QuadricForm& form) {
  ++fallbacks.exact;
  const detail::ExactQuadricEquation e(origin, direction, form);
  if (e.A.sign() == 0) return refined_linear_root(e.linear_root());
  // As for the sphere: the coefficients and D are good to 2^-103 each.
  return refined_quadratic_roots(DoubleDouble(e.A), DoubleDouble(e.b), DoubleDouble(e.c),
                                 DoubleDouble(e.discriminant()), e.exponent, 0x1p-97);
}

/// The root 2b/A, likewise; none where A is 0.
[[nodiscard, gnu::cold, gnu::noinline]] inline RefinedRoots refined_quadric_root_leaving(
    const Point& origin, const Vec3& direction, const QuadricForm& form) {
  ++fallbacks.exact;
  return refined_linear_root(exact_quadric_root_leaving(origin, direction, form));
}

namespace detail {

/// The roots where double does not decide. Numbers that are not finite, and a direction of 0, cross nothing.
[[nodiscard, gnu::cold, gnu::noinline]] inline Roots quadric_roots_in_doubt(const Point& origin,
                                                                            const Vec3& direction,
                                                                            const QuadricForm& form,
                                                                            const auto& refine) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(form) || direction == Vec3{0}) return {};
  const RefinedRoots refined = refine(origin, direction, form);
  if (refined.count == 0) return {};
  if (refined.count == 1) return Roots{static_cast<double>(refined.t[0])};
  return {static_cast<double>(refined.t[0]), static_cast<double>(refined.t[1])};
}

/// The equation in double. A, b and c have errors of at most 6u, 7u and 9u of their sizes, which are what
/// they would be if all numbers were positive.
struct RoundedQuadricEquation {
  double A, b, c, A_size, b_size, c_size;
  bool in_range;  ///< whether nothing overflows, and underflow adds nothing to speak of where E > 2^-348

  RoundedQuadricEquation(const Point& origin, const Vec3& direction, const QuadricForm& form) {
    const Vec3 g = form.times(origin) + form.linear;
    A = dot(direction, form.times(direction));
    b = -dot(direction, g);
    c = dot(origin, g) + dot(form.linear, origin) + form.constant;
    const Vec3 d = abs(direction), o = abs(origin);
    const QuadricForm sizes = abs(form);
    const Vec3 g_sizes = sizes.times(o) + sizes.linear;
    A_size = dot(d, sizes.times(d));
    b_size = dot(d, g_sizes);
    c_size = dot(o, g_sizes) + dot(sizes.linear, o) + sizes.constant;
    in_range = A_size < 0x1p400 && b_size < 0x1p400 && c_size < 0x1p400 && d.x + d.y + d.z < 0x1p200 &&
               o.x + o.y + o.z < 0x1p200;
  }

  /// Whether A is so good that a quotient with it is.
  [[nodiscard]] bool is_A_certain() const { return std::abs(A) > 0x1p-18 * A_size && A_size > 0x1p-400; }
};

}  // namespace detail

/// The roots, certified.
///
/// The error of D is at most 16u b_size² + 17u A_size c_size; E is 32u of both. That of q is what it is for
/// the sphere: 2^-31.9 |q| from √D, and 7u b_size < 2^-32.2 |q| from b.
[[nodiscard]] inline Roots quadric_roots(const Point& origin, const Vec3& direction,
                                         const QuadricForm& form) {
  const detail::RoundedQuadricEquation e(origin, direction, form);
  const double D = e.b * e.b - e.A * e.c, E = 0x1p-48 * (e.b_size * e.b_size + e.A_size * e.c_size);
  if (e.in_range && E > 0x1p-348) {
    if (D < -E) return {};
    if (D > 4 * E && e.is_A_certain() && std::abs(e.c) > 0x1p-18 * e.c_size && e.c_size > 0x1p-400) {
      const double root = std::sqrt(D), q = e.b + std::copysign(root, e.b);
      if (root * std::abs(q) > 0x1p31 * E && std::abs(q) > 0x1p-18 * e.b_size) return roots_from(e.A, e.c, q);
    }
  }
  return detail::quadric_roots_in_doubt(origin, direction, form, refined_quadric_roots);
}

/// The root of a line that starts on the quadric, certified: the one that it does not come from.
[[nodiscard]] inline Roots quadric_root_leaving(const Point& origin, const Vec3& direction,
                                                const QuadricForm& form) {
  const detail::RoundedQuadricEquation e(origin, direction, form);
  if (e.in_range && e.is_A_certain() && std::abs(e.b) > 0x1p-18 * e.b_size && e.b_size > 0x1p-400)
    return Roots{2 * e.b / e.A};
  return detail::quadric_roots_in_doubt(origin, direction, form, refined_quadric_root_leaving);
}

/// Whether f is negative, in the end, along a line, from coefficients without rounding; c is 0 where it
/// starts on the quadric. Numbers that are not finite, and a direction of 0, end nowhere.
[[nodiscard, gnu::cold, gnu::noinline]] inline bool quadric_ends_negative_in_doubt(const Point& origin,
                                                                                   const Vec3& direction,
                                                                                   const QuadricForm& form,
                                                                                   bool starts_on_it) {
  if (!is_finite(origin) || !is_finite(direction) || !is_finite(form) || direction == Vec3{0}) return false;
  ++fallbacks.exact;
  const detail::ExactQuadricEquation e(origin, direction, form);
  if (e.A.sign() != 0) return e.is_turned;
  if (e.b.sign() != 0) return e.b.sign() > 0;
  return !starts_on_it && e.c.sign() < 0;
}

/// The same, certified: by the sign of A, or where that is 0 by that of b, or c.
[[nodiscard]] inline bool quadric_ends_negative(const Point& origin, const Vec3& direction,
                                                const QuadricForm& form, bool starts_on_it) {
  const detail::RoundedQuadricEquation e(origin, direction, form);
  if (e.in_range && e.is_A_certain()) return e.A < 0;
  return quadric_ends_negative_in_doubt(origin, direction, form, starts_on_it);
}

}  // namespace protostar::inline PROTOSTAR_ABI

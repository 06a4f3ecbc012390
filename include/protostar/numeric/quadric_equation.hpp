// Crossings of a line with a quadric, whose existence is exact and whose t is certified (Roots), and bounds
// of a quadric that is an ellipsoid.
//
// A quadric is the set of zeros of f(p) = p·Mp + 2 l·p + k, for a symmetric matrix M. On the points origin +
// t·d of a line, with g = M·origin + l, half of the gradient at the origin, f is
//   A t² − 2 b t + c   with   A = d·Md,  b = −d·g,  c = f(origin) = origin·g + l·origin + k.
// If A is 0, the equation is linear. A line that starts on the quadric has c = 0 by definition, whatever its
// digits say; its roots are 0 and 2b/A, and only the second is a crossing other than the start.
//
// Double nearly always decides; if its error bound does not allow it, everything is evaluated without
// rounding. docs/derivations.md derives the bounds, in units of u = 2^-53.
#pragma once

#include <algorithm>
#include <cmath>

#include "../bounds.hpp"
#include "../vec3.hpp"
#include "equation.hpp"
#include "rounded_equation.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns M v for a symmetric matrix M with the numbers of a diagonal and the numbers (yz, zx, xy) beside
/// it.
template <class V>
[[nodiscard, gnu::always_inline]] inline V symmetric_times(const V& diagonal, const V& beside, const V& v) {
  return {diagonal[0] * v[0] + beside[2] * v[1] + beside[1] * v[2],
          beside[2] * v[0] + diagonal[1] * v[1] + beside[0] * v[2],
          beside[1] * v[0] + beside[0] * v[1] + diagonal[2] * v[2]};
}

/// Ten numbers of f(p) = squares·(x², y², z²) + 2 products·(yz, zx, xy) + 2 linear·p + constant. They form a
/// symmetric 4×4 matrix, whose last row and column are linear and constant.
struct QuadricForm {
  Vec3 squares{1};
  Vec3 products{0};
  Vec3 linear{0};
  double constant = -1;

  /// Returns M v.
  [[nodiscard, gnu::always_inline]] Vec3 times(const Vec3& v) const {
    return symmetric_times(squares, products, v);
  }
};

[[nodiscard]] inline QuadricForm abs(const QuadricForm& form) {
  return {abs(form.squares), abs(form.products), abs(form.linear), std::abs(form.constant)};
}
[[nodiscard]] inline bool is_finite(const QuadricForm& form) {
  return is_finite(form.squares) && is_finite(form.products) && is_finite(form.linear) &&
         std::isfinite(form.constant);
}

/// Returns the sign of the Gaussian curvature of a quadric, which is that of −det of the 4×4 matrix, all over
/// the quadric: 1 for an ellipsoid, −1 for a saddle. Returns 0 for cones and cylinders, also for those whose
/// numbers are rounded, and for what double cannot tell from them: an ellipsoid 2^264 times as wide as high.
[[nodiscard, gnu::noinline, gnu::cold]] inline int curvature_sign(const QuadricForm& form) {
  // det = k det M − l·adj(M) l. M, l and k are each scaled to about 1, so that no product overflows, and then
  // the smaller of the two terms, by 2^-|shift|.
  const int of_M = exponent_of({form.squares, form.products}), of_l = exponent_of({form.linear}),
            of_k = exponent_of({Vec3{form.constant, 0, 0}}), shift = of_M + of_k - 2 * of_l;
  const QuadricForm to_1{scaled(form.squares, -of_M), scaled(form.products, -of_M),
                         scaled(form.linear, -of_l), scaled(form.constant, -of_k)};
  const auto sum_of_terms = [&](const QuadricForm& f, double sign) {
    const Vec3 &a = f.squares, &b = f.products, &l = f.linear;
    const Vec3 diagonal{a.y * a.z + sign * b.x * b.x, a.z * a.x + sign * b.y * b.y,
                        a.x * a.y + sign * b.z * b.z};
    const Vec3 beside{b.y * b.z + sign * a.x * b.x, b.z * b.x + sign * a.y * b.y,
                      b.x * b.y + sign * a.z * b.z};
    const double det_M = a.x * diagonal.x + b.z * beside.z + b.y * beside.y;
    return scaled(f.constant * det_M, std::min(shift, 0)) +
           sign * scaled(dot(l, symmetric_times(diagonal, beside, l)), std::min(-shift, 0));
  };
  const double det = sum_of_terms(to_1, -1), size = sum_of_terms(abs(to_1), 1);
  // The terms pass at most 9 roundings. Each has four numbers of the matrix, which may be off by 4u, as after
  // a rotation: 25u in all, and less than 2^-1060 for the underflow of some 30 products.
  if (std::abs(det) <= 0x1p-48 * size + 0x1p-1060) return 0;
  return det < 0 ? 1 : -1;
}

/// Equation in double. A, b and c have errors of at most 6u, 7u and 9u of their sizes, their values with all
/// numbers made positive; for a rounded line, 8u, 9u and 11u.
struct RoundedQuadricEquation {
  double A, b, c, A_size, b_size, c_size, d_size;
  Vec3 g_sizes;
  bool in_range;  ///< true if nothing overflows, and underflow is negligible for E > 2^-348

  [[gnu::always_inline]] RoundedQuadricEquation(const auto& ray, const QuadricForm& form) {
    const Vec3 g = form.times(ray.origin) + form.linear;
    A = dot(ray.direction, form.times(ray.direction));
    b = -dot(ray.direction, g);
    c = dot(ray.origin, g) + dot(form.linear, ray.origin) + form.constant;
    const Vec3 o = origin_sizes(ray, ray.origin), d = direction_sizes(ray);
    const QuadricForm sizes = abs(form);
    g_sizes = sizes.times(o) + sizes.linear;
    A_size = dot(d, sizes.times(d));
    b_size = dot(d, g_sizes);
    c_size = dot(o, g_sizes) + dot(sizes.linear, o) + sizes.constant;
    d_size = d.x + d.y + d.z;
    in_range = A_size < 0x1p400 && b_size < 0x1p400 && c_size < 0x1p400 && d_size < 0x1p200 &&
               o.x + o.y + o.z < 0x1p200;
  }

  /// Returns true if A is accurate enough for a quotient with it; its terms then are finite, and their
  /// underflow is negligible.
  [[nodiscard]] bool is_A_certain() const {
    return std::abs(A) > 0x1p-18 * A_size && A_size > 0x1p-400 && d_size < 0x1p200;
  }

  /// Returns true if the roots surely are below 2^1000, provided that is_A_certain(): with the sizes Â, b̂ and
  /// ĉ they are at most (2 b̂ + √(Â ĉ)) / |A| < 2^18 (2 b̂/Â + √(ĉ/Â)).
  [[nodiscard]] bool has_finite_roots() const {
    return b_size < 0x1p900 * A_size && c_size < 0x1p900 * A_size;
  }

  /// Returns the equation in double with A > 0, and with its bounds.
  ///
  /// The error of D is at most 16u b_size² + 17u A_size c_size; E is 32u of both. The error of q is 2^-31.9
  /// |q| from √D, as for the sphere; √D |q| > 2^31 E makes |q| > 2^-9 b_size, so the error of b, at most 7u
  /// b_size, is negligible. The error of c is at most 9u c_size < 2^-31.8 |c|. b² > 2^12 E makes |b| > 2^-18
  /// b_size, so its error is below 2^-32.1 |b|.
  [[nodiscard]] RoundedQuadratic<double, double> with_positive_A() const {
    const double E = 0x1p-48 * (b_size * b_size + A_size * c_size), sign = A < 0 ? -1 : 1;
    const bool is_known = in_range && E > 0x1p-348 && is_A_certain();
    return {.A = sign * A,
            .b = sign * b,
            .c = sign * c,
            .w = c_size > 0x1p-400 ? c_size : infinity,
            .D = b * b - A * c,
            .E = is_known ? E : infinity};
  }
};

/// Returns the equation in double.
[[nodiscard]] inline auto quadric_equation(const auto& ray, const QuadricForm& form) {
  return RoundedQuadricEquation(ray, form).with_positive_A();
}

/// Returns the equation of a line whose numbers are rounded. With errors o_error and d_error, and the sizes M̂
/// and ĝ of M and g, A is off by d_error · M̂ (2 |d| + d_error), b by d_error · (ĝ + M̂ o_error) + |d| · M̂
/// o_error, and c by o_error · (2 ĝ + M̂ o_error).
[[nodiscard]] inline RoundedQuadratic<double, double> quadric_equation(const RoundedLine& line,
                                                                       const QuadricForm& form) {
  const struct {
    Point origin;
    Vec3 direction;
  } exact{line.origin, line.direction};
  const RoundedQuadricEquation e(exact, form);
  const QuadricForm sizes = abs(form);
  const Vec3 d = abs(line.direction), M_o_error = sizes.times(line.origin_error),
             &d_error = line.direction_error;
  return with_errors(e.with_positive_A(), dot(d_error, sizes.times(2.0 * d + d_error)),
                     dot(d_error, e.g_sizes + M_o_error) + dot(d, M_o_error),
                     dot(line.origin_error, 2.0 * e.g_sizes + M_o_error));
}

/// Returns the equation without rounding. With o and d of a line of weight w, A = d·Md, b = −d·(M o + w l)
/// and c = o·(M o + w l) + w l·o + w² k.
[[nodiscard]] inline ExactQuadratic quadric_equation(const ExactLine& line, const QuadricForm& form) {
  const ExactVector squares = exact_vector(form.squares), products = exact_vector(form.products),
                    l = line.weight * exact_vector(form.linear), &o = line.origin, &d = line.direction,
                    g = symmetric_times(squares, products, o) + l;
  return {.A = dot(d, symmetric_times(squares, products, d)),
          .b = -dot(d, g),
          .c = dot(o, g) + dot(l, o) + line.weight * line.weight * form.constant};
}

/// Tests whether f is negative along a line for t → ∞: by the sign of A, or if A is 0 by that of b, or of c,
/// which is 0 if the line starts on the quadric.
[[nodiscard]] inline bool ends_negative(const ExactQuadratic& e, bool starts_on_it) {
  const int A = e.A.sign(), b = e.b.sign();
  return A != 0 ? A < 0 : b != 0 ? b > 0 : !starts_on_it && e.c.sign() < 0;
}

// A quadric is an ellipsoid if M is positive definite; the form is negative inside.
// Around its center −M⁻¹ l the form is y·My − h, with h = l·M⁻¹ l − k, and its zeros reach √(h (M⁻¹)ᵢᵢ) along
// the axis i. With the adjugate matrix N = det M · M⁻¹, whose numbers are sums of products, and H = h det M =
// l·N l − k det M, they reach on the axis i from the near to the far root of
//
//   det M t² + 2 (N l)ᵢ t + … = 0   with the discriminant   D = H Nᵢᵢ,
//
// which are evaluated without rounding.

namespace detail {

/// Exact det M, H, N l and diagonal of N of a quadric.
struct ExactEllipsoid {
  bool exists = false;  ///< true if M is positive definite
  ExactNumber determinant, H;
  ExactVector Nl, N_diagonal;

  [[gnu::cold, gnu::noinline]] explicit ExactEllipsoid(const QuadricForm& form) {
    if (!is_finite(form)) return;
    const ExactVector s = exact_vector(form.squares), p = exact_vector(form.products),
                      l = exact_vector(form.linear);
    N_diagonal = {s[1] * s[2] - p[0] * p[0], s[2] * s[0] - p[1] * p[1], s[0] * s[1] - p[2] * p[2]};
    const ExactVector beside{p[1] * p[2] - p[0] * s[0], p[2] * p[0] - p[1] * s[1], p[0] * p[1] - p[2] * s[2]};
    determinant = s[0] * N_diagonal[0] + p[2] * beside[2] + p[1] * beside[1];
    exists = s[0].sign() > 0 && N_diagonal[2].sign() > 0 && determinant.sign() > 0;  // Sylvester's criterion
    Nl = symmetric_times(N_diagonal, beside, l);
    H = dot(l, Nl) - form.constant * determinant;
  }
};

}  // namespace detail

/// Returns the box around the points where the form of a quadric is at most 2^-10 h, if M is positive
/// definite; otherwise the box is infinite. These points reach √(1 + 2^-10) times as far from the center as
/// the ellipsoid. An end is rounded to nearest, up to 2^-97 of itself, and moved outward by one double.
[[nodiscard, gnu::cold, gnu::noinline]] inline Bounds quadric_bounds(const QuadricForm& form) {
  const detail::ExactEllipsoid e(form);
  Bounds bounds{Point{-infinity}, Point{infinity}};
  if (!e.exists) return bounds;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    ExactRoot end{.A = e.determinant, .b = -e.Nl[axis], .D = {}, .sign = -1};
    if (e.H.sign() > 0) end.D = (1 + 0x1p-10) * (1 + 0x1p-10) * (e.H * e.N_diagonal[axis]);
    bounds.min[i] = std::nextafter(static_cast<double>(refined(end)), -infinity);
    end.sign = 1;
    bounds.max[i] = std::nextafter(static_cast<double>(refined(end)), infinity);
  }
  return bounds;
}

namespace detail {

/// Tests without rounding whether the form is at most 2^-10 h at a finite point; true also if the quadric has
/// no bounds.
[[nodiscard, gnu::cold, gnu::noinline]] inline bool is_in_quadric_bounds_in_doubt(const Point& point,
                                                                                  const QuadricForm& form) {
  const ExactEllipsoid e(form);
  if (!e.exists) return true;
  ++fallbacks.exact;
  const ExactNumber level = quadric_equation(exact_line(point, Vec3{0}), form).c;
  return (level * e.determinant - 0x1p-10 * e.H).sign() <= 0;
}

}  // namespace detail

/// Tests whether the other root of a line that departs from the quadric is in the quadric's bounds. The
/// digits of the origin may be off the quadric; the form at the other end of the chord is the same as at the
/// origin, c. In the middle of the chord it is c − b²/A, and nowhere below −h. Hence c ≤ 2^-11 b²/A is
/// enough, since then h ≥ (1 − 2^-11) b²/A. The error of c, 9u, is covered by 2^-49, nearly twice as much,
/// and that of b²/A by 2^-11 in place of 2^-10.
[[nodiscard]] inline bool is_in_quadric_bounds(const auto& ray, const QuadricForm& form) {
  const RoundedQuadricEquation e(ray, form);
  if (e.in_range && e.is_A_certain()) {
    if (e.A < 0) return true;
    const bool is_b_certain = std::abs(e.b) > 0x1p-18 * e.b_size && e.b_size > 0x1p-400;
    const double c = e.c + 0x1p-49 * e.c_size;
    if (is_b_certain && e.c_size > 0x1p-400 && c * e.A <= 0x1p-11 * e.b * e.b) return true;
  }
  return detail::is_in_quadric_bounds_in_doubt(ray.origin, form);
}

}  // namespace protostar::inline PROTOSTAR_ABI

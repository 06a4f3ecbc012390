// Bounds of a quadric that is an ellipsoid.
//
// A quadric p·Mp + 2 l·p + k = 0 is an ellipsoid if M is positive definite; the form is negative inside.
// Around its center c = −M⁻¹ l the form is y·My − h, with h = −f(c) = l·M⁻¹ l − k, and its zeros reach to c ±
// √(h (M⁻¹)ᵢᵢ) along the axis i. With the adjugate matrix N = det M · M⁻¹, whose numbers are sums of
// products, and H = l·N l − k det M:
//
//   cᵢ = −(N l)ᵢ / det M,   h = H / det M,   and the reach is √(H Nᵢᵢ) / det M.
//
// Numerators and denominators are evaluated without rounding.
#pragma once

#include <algorithm>
#include <cmath>

#include "../bounds.hpp"
#include "plane_through.hpp"
#include "quadric_equation.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Exact M, l, k, det M, H, N l and diagonal of N of a quadric, in units of length of 2^exponent.
struct ExactEllipsoid {
  bool exists = false;  ///< true if M certainly is positive definite
  int exponent = 0;
  ExactVector squares, products, linear;
  ExactNumber constant, determinant, H;
  ExactVector Nl, N_diagonal;

  [[gnu::cold, gnu::noinline]] explicit ExactEllipsoid(const QuadricForm& form) {
    if (!is_finite(form) || (form.squares == Vec3{0} && form.products == Vec3{0})) return;
    // Scaled so that no number is larger than 2. If none but 0 is below 2^-100, scaling is exact, all are
    // multiples of 2^-153, and products of six of them, the most there are, stay in the range of double.
    const int quadratic = exponent_of({form.squares, form.products});
    exponent = std::max((exponent_of({{form.constant, 0, 0}}) - quadratic) / 2,
                        exponent_of({form.linear}) - quadratic);
    const auto taken = [&](const Vec3& given, int by, ExactVector& numbers) {
      const Vec3 v = scaled(given, -by);
      numbers = exact_vector(v);
      const auto is_exact = [&](int i) { return given[i] == 0 || std::abs(v[i]) >= 0x1p-100; };
      return is_exact(0) && is_exact(1) && is_exact(2);
    };
    ExactVector k;
    if (!taken(form.squares, quadratic, squares) || !taken(form.products, quadratic, products) ||
        !taken(form.linear, quadratic + exponent, linear) ||
        !taken({form.constant, 0, 0}, quadratic + 2 * exponent, k))
      return;
    constant = k[0];

    const ExactVector &s = squares, &p = products, &l = linear;
    N_diagonal = {s[1] * s[2] - p[0] * p[0], s[2] * s[0] - p[1] * p[1], s[0] * s[1] - p[2] * p[2]};
    const ExactVector beside{p[1] * p[2] - p[0] * s[0], p[2] * p[0] - p[1] * s[1], p[0] * p[1] - p[2] * s[2]};
    determinant = s[0] * N_diagonal[0] + p[2] * beside[2] + p[1] * beside[1];
    exists = s[0].sign() > 0 && N_diagonal[2].sign() > 0 && determinant.sign() > 0;  // Sylvester's criterion
    Nl = {N_diagonal[0] * l[0] + beside[2] * l[1] + beside[1] * l[2],
          beside[2] * l[0] + N_diagonal[1] * l[1] + beside[0] * l[2],
          beside[1] * l[0] + beside[0] * l[1] + N_diagonal[2] * l[2]};
    H = dot(l, Nl) - constant * determinant;
  }

  /// Returns the scaled form at a point given in units of 2^exponent.
  [[nodiscard, gnu::cold]] ExactNumber level_at(const ExactVector& o) const {
    const ExactVector &s = squares, &p = products;
    const ExactVector Mo{s[0] * o[0] + p[2] * o[1] + p[1] * o[2], p[2] * o[0] + s[1] * o[1] + p[0] * o[2],
                         p[1] * o[0] + p[0] * o[1] + s[2] * o[2]};
    const ExactNumber lo = dot(linear, o);
    return dot(o, Mo) + lo + lo + constant;
  }
};

}  // namespace detail

/// Returns the box around the points where the form of a quadric is at most 2^-10 h, if M certainly is
/// positive definite; otherwise the box is infinite. These points reach √(1 + 2^-10) times as far from the
/// center as the ellipsoid.
[[nodiscard, gnu::cold, gnu::noinline]] inline Bounds quadric_bounds(const QuadricForm& form) {
  const detail::ExactEllipsoid e(form);
  Bounds bounds{Point{-infinity}, Point{infinity}};
  if (!e.exists) return bounds;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    // The center is rounded to nearest, and the reach comes from double-double; 2^-10 of the reach is far
    // more than both √(1 + 2^-10) and its roundings need. The center has an error of u of itself, and each
    // end of u of both: 4u are more.
    const double center = -detail::nearest_quotient(e.Nl[axis], e.determinant);
    const DoubleDouble square(e.H.sign() > 0 ? e.H * e.N_diagonal[axis] : ExactNumber());
    const double reach = static_cast<double>(sqrt(square) / DoubleDouble(e.determinant)) * (1 + 0x1p-10);
    const double margin = 0x1p-51 * (std::abs(center) + reach);
    bounds.min[i] = std::nextafter(std::ldexp(center - reach - margin, e.exponent), -infinity);
    bounds.max[i] = std::nextafter(std::ldexp(center + reach + margin, e.exponent), infinity);
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
  // Nothing reaches as far as 2^400, as no number of N is larger than 2, nor H than 20, nor det M below
  // 2^-459.
  if (exponent_of({point}) - e.exponent > 400) return false;
  const ExactVector o = exact_vector(scaled(point, -e.exponent));
  return (e.level_at(o) * e.determinant - ExactNumber(0x1p-10) * e.H).sign() <= 0;
}

}  // namespace detail

/// Tests whether the other root of a line that departs from the quadric is in the quadric's bounds. The
/// digits of the origin may be off the quadric; the form at the other end of the chord is the same as at the
/// origin, c. In the middle of the chord it is c − b²/A, and nowhere below −h. Hence c ≤ 2^-11 b²/A is
/// enough, since then h ≥ (1 − 2^-11) b²/A. The error of c, 9u, is covered by 2^-49, nearly twice as much,
/// and that of b²/A by 2^-11 in place of 2^-10.
[[nodiscard]] inline bool is_in_quadric_bounds(const Point& origin, const Vec3& direction,
                                               const QuadricForm& form) {
  const RoundedQuadricEquation e(origin, direction, form);
  if (e.in_range && e.is_A_certain()) {
    if (e.A < 0) return true;
    const bool is_b_certain = std::abs(e.b) > 0x1p-18 * e.b_size && e.b_size > 0x1p-400;
    const double c = e.c + 0x1p-49 * e.c_size;
    if (is_b_certain && e.c_size > 0x1p-400 && c * e.A <= 0x1p-11 * e.b * e.b) return true;
  }
  return detail::is_in_quadric_bounds_in_doubt(origin, form);
}

}  // namespace protostar::inline PROTOSTAR_ABI

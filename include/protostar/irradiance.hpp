// Irradiance of a diffuse surface by a light of radiance 1 that nothing hides, in closed form: soft light
// without noise. u = 2^-53.
//
// The irradiance is the integral of cos θ over the solid angle of the light, where θ is the angle from the
// surface's normal; what is below the horizon, the plane through the point, counts nothing. A diffuse surface
// of albedo a under a light of radiance L sends out a L E/π. Points must not be on the light. Normals are
// unit vectors up to rounding. Each function names its error relative to the irradiance of a surface that
// faces the light.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <type_traits>

#include "numeric/power.hpp"
#include "numeric/precise_vector.hpp"
#include "numeric/radians.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns the irradiance by a sphere; π for a point inside. The error is below 16u π (R/d)².
///
/// With sin σ = R/d and k = (normal · center)/R, the height of the center over the horizon in radii, the
/// sphere is above the horizon for k ≥ 1, and E = π sin² σ cos θ = π sin³ σ k. For −1 < k < 1 the horizon
/// cuts it (Snyder 1996). With q = √(1 − k²), τ = q tan σ,
///   E = sin² σ (sin σ k arctan₂(q, −k cos σ) + arctan τ − (τ − arctan τ)/tan² σ),
/// where the last term, as q² (τ − arctan τ)/τ², has no small divisor. The height is computed in
/// double-double, since that of a small sphere far away is a difference of larger numbers.
[[nodiscard]] inline double sphere_irradiance(const Point& point, const Vec3& normal, const Point& center,
                                              double radius) {
  const int exponent = exponent_of({center - point, Vec3{radius, 0, 0}});
  const PreciseVector to = scaled_difference(center, point, -exponent);
  const double R = std::abs(scaled({radius, 0, 0}, -exponent).x);
  const DoubleDouble d2 = dot(to, to), gap = d2 - two_product(R, R);
  const double height = dot(to, PreciseVector(normal)).hi;
  if (gap.hi < 0) return std::numbers::pi;
  const double sin2 = R / d2.hi * R, sine = std::sqrt(sin2);
  // A sphere so small is cut by the horizon only where E is below π 2^-1020. Farther away sin³ σ would be
  // below the range of double, and k above it.
  if (sine < 0x1p-340) return std::numbers::pi * sin2 * std::max(height / std::sqrt(d2.hi), 0.0);
  const double k = height / R;
  if (k <= -1) return 0;
  if (k >= 1) return std::numbers::pi * sin2 * sine * k;
  const double cosine = std::sqrt(gap.hi / d2.hi), q2 = (1 - k) * (1 + k), q = std::sqrt(q2);
  const double tau = q * sine / cosine, tau2 = tau * tau;
  // (τ − arctan τ)/τ², for small τ by its series, of which the first term left out is below 2^-53 of it.
  double rest = 0;
  if (tau < 0.25)
    rest = tau * detail::polynomial({1 / 3.0, -1 / 5.0, 1 / 7.0, -1 / 9.0, 1 / 11.0, -1 / 13.0, 1 / 15.0,
                                     -1 / 17.0, 1 / 19.0, -1 / 21.0, 1 / 23.0, -1 / 25.0},
                                    tau2);
  else if (cosine > 0)
    rest = (1 - polar_angle(q * sine, cosine) / tau) / tau;
  return sin2 * (sine * k * polar_angle(q, -k * cosine) + polar_angle(q * sine, cosine) - q2 * rest);
}

namespace detail {

/// Sum of Lambert's formula over the edges of a polygon: in double for Vec3, or in double-double for
/// PreciseVector. The sum of γ (n · a × b)/|a × b| over the edges, of which each spans the angle γ from a to
/// b, is twice the irradiance. Corners are differences from one corner, to which `base` leads, since then a ×
/// b = a × (b − a) has a small relative error also if a and b are almost equal.
template <class Vector, class Number>
class LambertSum {
 public:
  LambertSum(const Vec3& normal, const Vector& base) : normal_(normal), base_(base) {}

  void add_corner(const Vector& corner) {
    if (has_corner_)
      add_edge(last_, corner);
    else
      first_ = corner;
    has_corner_ = true, last_ = corner;
  }

  /// Adds the edge from the last corner to the first; returns the irradiance, positive or negative by the
  /// direction in which the corners go around.
  [[nodiscard]] Number irradiance() {
    if (has_corner_) add_edge(last_, first_);
    return sum_ * Number(0.5);
  }

  /// Bounds the error of the irradiance in double, in units of 8u. The normal a × e of an edge has an error
  /// of 6u |a| |e|, which is f = |a| |e|/|a × e| times as much of its length; its angle one of 6u f and 4u of
  /// itself; the quotient and the product add less than 5u γ.
  [[nodiscard]] double error() const { return error_; }

 private:
  static double angle(double y, double x) { return polar_angle(y, x); }
  static DoubleDouble angle(DoubleDouble y, DoubleDouble x) { return precise_angle_of(y, x); }
  static double leading(double x) { return x; }
  static double leading(DoubleDouble x) { return x.hi; }

  void add_edge(const Vector& from, const Vector& to) {
    const Vector a = base_ + from, b = base_ + to, edge = to + -from;
    const Vector normal = cross(a, edge);
    const Number size = length(normal);
    if (!(leading(size) > 0)) return;  // seen lengthwise
    const Number gamma = angle(size, dot(a, b));
    sum_ = sum_ + gamma * dot(normal_, normal) / size;
    if constexpr (std::is_same_v<Number, double>) error_ += gamma * (1 + length(a) * length(edge) / size);
  }

  Vector normal_, base_, first_{}, last_{};
  Number sum_ = 0.0;
  double error_ = 0;
  bool has_corner_ = false;
};

}  // namespace detail

/// Returns the irradiance by a flat polygon, whose corners go around it in either direction (Lambert 1760).
/// It may be of any shape without crossing edges.
///
/// The edges' terms, of the size s of the polygon's angular diameter, cancel for a small polygon, or one seen
/// at a grazing angle. Hence the sum in double is used if its bound is below 2^-41 of it, and otherwise, and
/// for a polygon that the horizon cuts, a sum in double-double from exact differences, with an error below
/// 2^-92 s. That is below 2^-41 of the irradiance of a surface facing the light if its solid angle is above
/// 2^-51 s.
[[nodiscard]] inline double polygon_irradiance(const Point& point, const Vec3& normal,
                                               std::span<const Point> corners) {
  if (corners.empty()) return 0;
  int exponent = -2000;
  for (const Point& corner : corners) exponent = std::max(exponent, exponent_of({corner - point}));
  const Point& first = corners.front();
  const PreciseVector base = scaled_difference(first, point, -exponent), n(normal);
  bool is_cut = false;
  detail::LambertSum<Vec3, double> rough(normal, base.rounded());
  for (const Point& corner : corners) {
    const PreciseVector offset = scaled_difference(corner, first, -exponent);
    is_cut = is_cut || dot(base + offset, n).hi < 0;
    rough.add_corner(offset.rounded());
  }
  if (!is_cut) {
    const double irradiance = std::abs(rough.irradiance());
    if (rough.error() * 0x1p-50 <= 0x1p-41 * irradiance) return irradiance;
  }

  // Corners above the horizon, and points where edges cross it, at g/(g − h) of the way between heights g and
  // h of different signs.
  detail::LambertSum<PreciseVector, DoubleDouble> sum(normal, base);
  PreciseVector a = scaled_difference(corners.back(), first, -exponent);
  DoubleDouble g = dot(base + a, n);
  for (const Point& corner : corners) {
    const PreciseVector b = scaled_difference(corner, first, -exponent);
    const DoubleDouble h = dot(base + b, n);
    if ((g.hi < 0) != (h.hi < 0)) sum.add_corner(a + (g / (g - h)) * (b + -a));
    if (h.hi >= 0) sum.add_corner(b);
    a = b, g = h;
  }
  return std::abs(static_cast<double>(sum.irradiance()));
}

/// Returns the irradiance by a triangle.
[[nodiscard]] inline double triangle_irradiance(const Point& point, const Vec3& normal, const Point& a,
                                                const Point& b, const Point& c) {
  return polygon_irradiance(point, normal, std::array{a, b, c});
}

/// Returns the irradiance by a parallelogram.
[[nodiscard]] inline double parallelogram_irradiance(const Point& point, const Vec3& normal,
                                                     const Point& position, const Vec3& edge_u,
                                                     const Vec3& edge_v) {
  return polygon_irradiance(
      point, normal, std::array{position, position + edge_u, position + edge_u + edge_v, position + edge_v});
}

namespace detail {

/// Returns log((1 + x)/(1 − x))/x for |x| < 1: 2 (1 + x²/3 + x⁴/5 + …) for small x, of which the first term
/// left out is below 2^-100 of it. The formula has no value from ±1 on, where rounding may bring x:
/// magnitudes above 1 − 2^-100 count as that.
[[nodiscard]] inline DoubleDouble logarithm_over(DoubleDouble x) {
  if (const DoubleDouble size = abs(x); size.hi >= 0x1p-6) {
    if (!((1.0 - size).hi > 0x1p-100)) return ln_2 * log2(DoubleDouble(0x1p101));
    return ln_2 * log2((1.0 + x) / (1.0 - x)) / x;
  }
  const DoubleDouble square = x * x;
  DoubleDouble sum = 1 / 17.0;
  for (int n = 15; n > 0; n -= 2) sum = DoubleDouble(1) / DoubleDouble(n) + square * sum;
  return 2.0 * sum;
}

/// A disk as seen from a point, in units in which the largest number is about 1: h and ρ are the distances of
/// the point from its plane and from its axis.
struct DiskFromPoint {
  PreciseVector to;        ///< the center
  PreciseVector unit;      ///< the disk's unit normal, to the side away from the point
  PreciseVector sideways;  ///< to − h unit
  DoubleDouble h, rho, R;
};

/// Returns the irradiance by the part of a disk above the horizon, which cuts it: half of the integral of
/// n · (r × dr)/r² around that part, along an arc of the rim and back along the horizon, since the normals of
/// the cone over a curve have the directions r × dr.
///
/// With e1 along `sideways`, e2 = unit × e1 and (A, B, C) = (n·e1, n·e2, n·unit), the rim's point at the
/// angle φ from e1 is H + R (A cos φ + B sin φ) over the horizon, and r² = P + Q cos φ with P = ρ² + h² + R²
/// and Q = 2ρR. The arc reaches by δ to both sides of φ0, the direction of (A, B); cos δ = −H/(R √(A² + B²)).
/// Along it the integral is
///   C/2 (2δ + (R² − ρ² − h²) J) − R h (A K + B L),
/// where J, K and L are those of 1, cos φ and sin φ over P + Q cos φ:
///   J = 2/W arctan₂(W sin δ, P cos δ + Q cos φ0),  W = √(P² − Q²),   K = (2δ − P J)/Q,
///   L = 1/Q log((P + Q cos(φ0 − δ))/(P + Q cos(φ0 + δ))).
/// For Q < 2^-30 P, K is the sum of the integrals of cos φ − q cos² φ + q² cos³ φ over P, q = Q/P. The
/// horizon's part is the angle between the ends of the arc. All of this is in double-double, as the parts
/// cancel for a small disk.
[[nodiscard]] inline double cut_disk_irradiance(const DiskFromPoint& disk, const PreciseVector& n) {
  const auto& [to, unit, sideways, h, rho, R] = disk;
  const DoubleDouble C = dot(n, unit);
  // Next to the axis, where r² hardly depends on φ, any direction in the disk's plane will do.
  PreciseVector e1 = rho.hi > 0x1p-60 * R.hi ? sideways : n + -C * unit;
  e1 = (DoubleDouble(1) / length(e1)) * e1;
  const PreciseVector e2 = cross(unit, e1);
  const DoubleDouble A = dot(n, e1), B = dot(n, e2), S = sqrt(A * A + B * B), H = dot(n, to);
  // If S underflows, the horizon is parallel to the disk, all of which is on one side of it.
  const bool is_oblique = S.hi > 0;
  const DoubleDouble RS = R * S, rest = (RS - H) * (RS + H);
  const DoubleDouble cosine = is_oblique ? -H / RS : DoubleDouble(H.hi < 0 ? 1 : -1);
  const DoubleDouble sine = rest.hi > 0 ? sqrt(rest) / RS : DoubleDouble(0);
  const DoubleDouble cosine0 = is_oblique ? A / S : DoubleDouble(1),
                     sine0 = is_oblique ? B / S : DoubleDouble(0);
  const DoubleDouble delta = precise_angle_of(sine, cosine);

  const DoubleDouble square = rho * rho + h * h, P = square + R * R, Q = 2.0 * rho * R;
  const DoubleDouble near = rho - R, far = rho + R;
  const DoubleDouble W = sqrt((near * near + h * h) * (far * far + h * h));
  const DoubleDouble J =
      W.hi > 0 ? 2.0 * precise_angle_of(W * sine, P * cosine + Q * cosine0) / W : DoubleDouble(0);
  const DoubleDouble middle = P + Q * cosine0 * cosine;  // of the r² at the ends of the arc
  const DoubleDouble L = sine0 * sine / middle * logarithm_over(Q * sine0 * sine / middle);
  DoubleDouble K = (2.0 * delta - P * J) / Q;
  if (!(Q.hi > 0x1p-30 * P.hi)) {
    const DoubleDouble q = Q / P, cosine_twice = 2.0 * cosine0 * cosine0 - 1.0;
    const DoubleDouble triple0 = (2.0 * cosine_twice - 1.0) * cosine0;               // cos 3φ0
    const DoubleDouble triple = (3.0 - 4.0 * sine * sine) * sine;                    // sin 3δ
    const DoubleDouble first = 2.0 * cosine0 * sine;                                 // ∫ cos φ
    const DoubleDouble second = delta + cosine_twice * sine * cosine;                // ∫ cos² φ
    const DoubleDouble third = 0.75 * first + triple0 * triple / DoubleDouble(6.0);  // ∫ cos³ φ
    K = (first - q * (second - q * third)) / P;
  }
  const DoubleDouble arc = 0.5 * C * (2.0 * delta + (R * R - square) * J) - R * h * (A * K + B * L);

  // The ends are m ± k g, in the middle of the chord and along it.
  const PreciseVector g = -sine0 * e1 + cosine0 * e2, out = cosine0 * e1 + sine0 * e2;
  const PreciseVector m = to + (R * cosine) * out;
  const DoubleDouble k = R * sine, size = length(n);
  const DoubleDouble chord =
      size * precise_angle_of(-2.0 * k * dot(n, cross(m, g)) / size, dot(m, m) - k * k);
  return std::abs(static_cast<double>(arc + chord)) / 2;
}

}  // namespace detail

/// Returns the irradiance by a disk, of which only the part above the horizon counts. The error is below 32u
/// of that of a surface facing the light; for a disk that the horizon cuts, below 2^-41 of it if the disk
/// spans an angle above 2^-28. A point on the rim, from where no angle is right, gets 0. `disk_normal` may
/// have any length but 0; the radius is greater than 0.
///
/// With h and ρ, the distances of the point from the plane and from the axis, l1 and l2, those from the
/// nearest and farthest points of the rim, and s = (ρ − R)(ρ + R) + h², a surface parallel to the disk gets π
/// (l1 l2 − s)/(2 l1 l2), where l1² l2² = s² + (2Rh)², and a perpendicular one that faces the axis 2π h ρ
/// R²/(l1 l2 (h² + ρ² + R² + l1 l2)). On the axis, the first is π R²/(R² + h²).
[[nodiscard]] inline double disk_irradiance(const Point& point, const Vec3& normal, const Point& center,
                                            const Vec3& disk_normal, double radius) {
  const int exponent = exponent_of({center - point, Vec3{radius, 0, 0}});
  const PreciseVector to = scaled_difference(center, point, -exponent), axis(of_moderate_size(disk_normal));
  const double R = scaled({radius, 0, 0}, -exponent).x;
  const DoubleDouble size = length(axis), z = dot(to, axis) / size, h = abs(z);
  const PreciseVector n(normal), unit = (DoubleDouble(z.hi < 0 ? -1 : 1) / size) * axis;
  const PreciseVector sideways = to + (-h) * unit;
  const DoubleDouble rho = length(cross(axis, to)) / size;
  const double near = static_cast<double>(rho - R), far = static_cast<double>(rho + R), h2 = h.hi * h.hi;
  // On the rim, up to the rounding of h and ρ, whose errors are below 2^-100 R there.
  const double rounding = 0x1p-100 * R;
  if (!(near * near + h2 > rounding * rounding)) return 0;

  // The center is at `height` over the horizon, and the rim reaches ± R sin(disk, horizon) from there.
  const DoubleDouble height = dot(n, to), reach = DoubleDouble(R) * length(cross(n, unit));
  if ((height + reach).hi <= 0) return 0;
  if ((height - reach).hi < 0)
    return detail::cut_disk_irradiance({to, unit, sideways, h, rho, DoubleDouble(R)}, n);

  const double l1l2 = std::sqrt((near * near + h2) * (far * far + h2)), s = near * far + h2, Rh = R * h.hi;
  const double facing = s > 0 ? 2 * Rh / (l1l2 + s) * (Rh / l1l2) : (l1l2 - s) / (2 * l1l2);
  // The part sideways has the factor ρ of the vector `sideways`.
  const double across = 2 * Rh / l1l2 * (R / (h2 + rho.hi * rho.hi + R * R + l1l2));
  return std::numbers::pi *
         (facing * static_cast<double>(dot(n, unit)) + across * static_cast<double>(dot(n, sideways)));
}

}  // namespace protostar::inline PROTOSTAR_ABI

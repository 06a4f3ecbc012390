// A rectangle as seen from a point: its solid angle, and directions to it that are uniform in solid angle.
//
// With the point as origin and the axes along the edges, the rectangle is x0 ≤ x ≤ x1, y0 ≤ y ≤ y1, z = h.
// Ureña, Fajardo and King (2013) take x so that the part left of x is a share u of the solid angle, and then
// y so that y/√(x² + y² + h²) is uniform, by which areas on the sphere are equal. Their formulas are
// differences of arc cosines, which lose their digits for small rectangles and near the plane. Here angles
// are sums of positive ones.
//
// The strip y0 ≤ y ≤ y1, endless to both sides, has the solid angle 2Δ, where Δ is the angle from (h, y0) to
// (h, y1). Right of x ≥ 0 the strip is a spherical triangle with a corner at infinity, and its solid angle is
//   2 arctan(h l/D(x)),   D = r0 r1 + y0 y1 + x² + h² + x (r0 + r1),
// with l = y1 − y0 and r0, r1 the distances to (x, y0, h), (x, y1, h); and if y0 y1 < 0, r0 r1 + y0 y1 = (r0²
// r1² − y0² y1²)/(r0 r1 − y0 y1) = q (q + y0² + y1²)/(r0 r1 − y0 y1) for q = x² + h². The part between x and
// x' is
//   2 arctan(h l (D' − D)/(D D' + h² l²)),
// with a difference D' − D that is a sum of products of x' − x.
//
// Let p be the solid angle of the strip left of x, and q = 2Δ − p that right of it. Then g = (p − q)/2 is the
// solid angle between 0 and x, and
//   x = h sin g/(2 √(sin(p/2) sin(q/2) sin(κ1 + p/2) sin(κ1 + q/2))),   κ1 = arctan(h/y1),
// which is Ureña's formula for x with its differences of cosines written as products. p and q are sums: the
// part outside the rectangle and the share of Ω. Angles above a right one are replaced by π minus them, with
// κ0 = arctan(h/−y0) and κ0 + Δ + κ1 = π again a sum: π − (κ1 + p/2) = κ0 + q/2.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "../numeric/precise_vector.hpp"
#include "light_sample.hpp"
#include "radians_of_each.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// The part of a strip y0 ≤ y ≤ y1, z = h > 0 to the right of x ≥ 0.
struct HalfStrip {
  double x, r0, r1, D;

  HalfStrip(double h, double y0, double y1, double left) : x(left) {
    const double q = x * x + h * h;
    r0 = std::sqrt(q + y0 * y0), r1 = std::sqrt(q + y1 * y1);
    const double product = y0 * y1;
    const double sum = product < 0 ? q * (q + y0 * y0 + y1 * y1) / (r0 * r1 - product) : r0 * r1 + product;
    D = sum + q + x * (r0 + r1);
  }
};

/// Adds a pair to some, of which polar_angle is half of the solid angle of the strip between a.x and b.x ≥
/// a.x, where width = b.x − a.x.
inline void add_part_between(const HalfStrip& a, const HalfStrip& b, double width, double hl, auto& add) {
  const double sum = a.x + b.x;
  const double dr0 = width * sum / (a.r0 + b.r0), dr1 = width * sum / (a.r1 + b.r1);
  const double difference = b.r0 * dr1 + a.r1 * dr0 + width * (b.r0 + b.r1) + a.x * (dr0 + dr1) + width * sum;
  add(hl * difference, a.D * b.D + hl * hl);
}

}  // namespace detail

/// A rectangle, with what its views have in common, in double-double: unit axes along the edges and their
/// lengths.
struct RectangleLight {
  Point position;
  int exponent;  ///< of the edges: lengths are scaled by 2^-exponent
  PreciseVector x, y, z;
  DoubleDouble width, depth;
  Vec3 axis_x, axis_y, axis_z;  ///< the unit axes in double

  RectangleLight(const Point& corner, const Vec3& u, const Vec3& v)
      : position(corner), exponent(exponent_of({u, v})) {
    const PreciseVector along(scaled(u, -exponent)), up(scaled(v, -exponent)), normal = cross(along, up);
    width = length(along), depth = length(up);
    x = DoubleDouble(1) / width * along, y = DoubleDouble(1) / depth * up;
    z = DoubleDouble(1) / length(normal) * normal;
    axis_x = along.rounded() / width.hi, axis_y = up.rounded() / depth.hi, axis_z = cross(axis_x, axis_y);
  }
};

/// The directions from a point to a rectangle with edges that are perpendicular. The edges may deviate from
/// that by their rounding; the corner opposite the position is then that of the rectangle. The solid angle
/// has a relative error below 20u, and directions are off by at most 20u, if the distances from the lines
/// through the edges, and from the plane, are above 2^-45 of those from the corners.
class RectangleView {
 public:
  RectangleView(const Point& from, const Point& position, const Vec3& edge_u, const Vec3& edge_v)
      : RectangleView(from, RectangleLight(position, edge_u, edge_v)) {}

  /// The distances to the lines of the edges and to the plane are dot products with the axes, which cancel:
  /// the corner's coordinates are exact, and each distance is rounded once from about twice as many digits,
  /// with an error below u + 2^45 60u² < (1 + 2^-2) u. Those of the far edges are the sums with the lengths,
  /// in double-double.
  RectangleView(const Point& from, const RectangleLight& r) : x_(r.axis_x), y_(r.axis_y), z_(r.axis_z) {
    exponent_ = std::max(exponent_of({r.position - from}), r.exponent);
    const PreciseVector to = scaled_difference(r.position, from, -exponent_);
    const int smaller = r.exponent - exponent_;
    const Vec3 sizes = scaled(Vec3{r.width.hi, r.depth.hi, 0}, smaller),
               rests = scaled(Vec3{r.width.lo, r.depth.lo, 0}, smaller);
    const DoubleDouble width{sizes.x, rests.x}, depth{sizes.y, rests.y};
    const DoubleDouble x0 = compensated_dot(to, r.x), y0 = compensated_dot(to, r.y);
    const double z = static_cast<double>(compensated_dot(to, r.z));
    h_ = std::abs(z);
    if (z < 0) z_ = -z_;
    x0_ = static_cast<double>(x0), x1_ = static_cast<double>(x0 + width);
    y0_ = static_cast<double>(y0), y1_ = static_cast<double>(y0 + depth);
    // Mirrored if need be, the larger part is on the positive side of both axes.
    if (-x0_ > x1_) x_ = -x_, std::swap(x0_, x1_), x0_ = -x0_, x1_ = -x1_;
    if (-y0_ > y1_) y_ = -y_, std::swap(y0_, y1_), y0_ = -y0_, y1_ = -y1_;
    farthest_ = std::sqrt(x1_ * x1_ + y1_ * y1_ + h_ * h_);
    if (!(h_ > 0)) return;

    const double l = depth.hi, hl = h_ * l;
    const detail::HalfStrip at_0(h_, y0_, y1_, 0), at_x0(h_, y0_, y1_, std::abs(x0_)),
        at_x1(h_, y0_, y1_, x1_);
    FewNumbers y{}, x{};
    std::size_t count = 0;
    const auto add = [&](double of_y, double of_x) { y[count] = of_y, x[count++] = of_x; };
    add(hl, h_ * h_ + y0_ * y1_), add(h_, -y0_), add(h_, y1_), add(hl, at_x1.D);
    detail::add_part_between(at_0, at_x0, std::abs(x0_), hl, add);
    if (x0_ >= 0)
      detail::add_part_between(at_x0, at_x1, width.hi, hl, add);
    else
      add(hl, at_x0.D), detail::add_part_between(at_0, at_x1, x1_, hl, add);
    const FewNumbers angles = polar_angles_of_each(y, x, static_cast<int>(count));
    const double Delta = angles[0], near = 2 * angles[4];
    kappa0_ = angles[1], kappa1_ = angles[2];
    right_ = 2 * angles[3];
    left_ = x0_ >= 0 ? Delta + near : 2 * angles[5];
    solid_angle_ = x0_ >= 0 ? 2 * angles[5] : near + 2 * angles[6];
  }

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] double solid_angle() const { return solid_angle_; }

  /// Draws a direction.
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (!(solid_angle_ > 0)) return {};
    const double p = (left_ + u * solid_angle_) / 2, q = (right_ + (1 - u) * solid_angle_) / 2;  // halves
    // Each angle or its supplement. π − |g| for g = p − q is κ0 + κ1 + 2 min(p, q).
    const FewNumbers sines =
        sines_of_each({std::min(std::abs(p - q), kappa0_ + kappa1_ + 2 * std::min(p, q)),
                       std::min(p, kappa0_ + kappa1_ + q), std::min(q, kappa0_ + kappa1_ + p),
                       std::min(kappa1_ + p, kappa0_ + q), std::min(kappa1_ + q, kappa0_ + p)},
                      5);
    const double product = sines[1] * sines[2] * sines[3] * sines[4];
    const double x = std::clamp(std::copysign(h_ * sines[0] / (2 * std::sqrt(product)), p - q), x0_, x1_);

    // y = ρ w/√(1 − w²) for a w between w0 and w1; 1 − w and 1 + w are sums of those of the ends.
    const double rho = std::sqrt(x * x + h_ * h_);
    const auto below_1 = [rho](double y) {  // 1 − y/r
      const double r = std::sqrt(y * y + rho * rho);
      return y > 0 ? rho * rho / (r * (r + y)) : (r - y) / r;
    };
    const double minus = (1 - v) * below_1(y0_) + v * below_1(y1_);
    const double plus = (1 - v) * below_1(-y0_) + v * below_1(-y1_);
    const double y = std::clamp(rho * (plus - minus) / (2 * std::sqrt(plus * minus)), y0_, y1_);

    const double distance = std::min(std::sqrt(y * y + rho * rho), farthest_);
    return {(x / distance) * x_ + (y / distance) * y_ + (h_ / distance) * z_, std::ldexp(distance, exponent_),
            1 / solid_angle_};
  }

 private:
  Vec3 x_{0}, y_{0}, z_{0};                           // unit axes
  double x0_ = 0, x1_ = 0, y0_ = 0, y1_ = 0, h_ = 0;  // scaled by 2^-exponent_
  double farthest_ = 0;
  double kappa0_ = 0, kappa1_ = 0, left_ = 0, right_ = 0, solid_angle_ = 0;
  int exponent_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

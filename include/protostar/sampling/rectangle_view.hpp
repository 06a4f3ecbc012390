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
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "../numeric/precise_vector.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../simd/words.hpp"
#include "light_sample.hpp"
#include "radians_of_each.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Rectangle, prepared once for its views from all points: unit axes along the edges u and v and along the
/// normal u × v, and the lengths of the edges, in double-double.
struct RectangleLight {
  Point position;               ///< corner at which both edges begin
  int exponent;                 ///< scale of width and depth: the edges' lengths are those times 2^exponent
  PreciseVector x, y, z;        ///< unit axes along edge u, edge v and the normal
  DoubleDouble width, depth;    ///< lengths of edge u and edge v, scaled
  Vec3 axis_x, axis_y, axis_z;  ///< x, y and z in double

  /// Prepares a rectangle from a corner and its edges, which are perpendicular up to rounding.
  RectangleLight(const Point& corner, const Vec3& u, const Vec3& v)
      : position(corner), exponent(exponent_of({u, v})) {
    // Each edge has a scale of its own besides: one may be much shorter than the other.
    const PreciseVector along(of_moderate_size(scaled(u, -exponent))),
        up(of_moderate_size(scaled(v, -exponent))), normal = cross(along, up);
    const DoubleDouble size_u = length(along), size_v = length(up);
    x = DoubleDouble(1) / size_u * along, y = DoubleDouble(1) / size_v * up;
    z = DoubleDouble(1) / length(normal) * normal;
    axis_x = along.rounded() / size_u.hi, axis_y = up.rounded() / size_v.hi, axis_z = cross(axis_x, axis_y);
    const auto unscaled = [&](const DoubleDouble& size, const Vec3& edge) {
      const int by = immoderate_exponent(scaled(edge, -exponent));
      return DoubleDouble{scaled(size.hi, by), scaled(size.lo, by)};
    };
    width = unscaled(size_u, u), depth = unscaled(size_v, v);
  }
};

namespace detail {

/// Rectangle as seen from one point, for T = double and Vector = Vec3, or from a point in each lane with the
/// same bits, for T = Doubles and Vector = Vectors. All lengths are scaled by one power of two, which the
/// caller knows.
template <class T, class Vector>
class RectangleSeen {
 public:
  using Doubled = DoubleDoubleOf<T>;

  /// Vector from the point to the corner, without rounding.
  struct ToCorner {
    Doubled x, y, z;
  };

  /// The distances to the lines of the edges and to the plane are dot products with the axes, which cancel:
  /// the corner's coordinates are exact, and each distance is rounded once from about twice as many digits,
  /// with an error below u + 2^45 60u² < (1 + 2^-2) u. Those of the far edges are the sums with the lengths,
  /// in double-double.
  RectangleSeen(const RectangleLight& r, const ToCorner& to, const Doubled& width, const Doubled& depth) {
    using std::abs, std::max;
    const auto left = compensated_dot(to, r.x), near = compensated_dot(to, r.y);
    const T left_x = T(left), right_x = T(left + width), near_y = T(near), far_y = T(near + depth),
            height = T(compensated_dot(to, r.z));
    // Mirrored if need be, the larger part is on the positive side of both axes.
    const auto mirrors_x = -left_x > right_x, mirrors_y = -near_y > far_y, mirrors_z = height < T(0.0);
    x0_ = select(mirrors_x, -right_x, left_x), x1_ = select(mirrors_x, -left_x, right_x);
    y0_ = select(mirrors_y, -far_y, near_y), y1_ = select(mirrors_y, -near_y, far_y);
    h_ = select(height == T(0.0), T(0.0), max(abs(height), T(least_height)));
    x_ = select(mirrors_x, Vector(-r.axis_x), Vector(r.axis_x));
    y_ = select(mirrors_y, Vector(-r.axis_y), Vector(r.axis_y));
    z_ = select(mirrors_z, Vector(-r.axis_z), Vector(r.axis_z));

    const T l = depth.hi, hl = h_ * l;
    const HalfStrip at_0(*this, T(0.0)), at_x0(*this, abs(x0_)), at_x1(*this, x1_);
    // Where x0 ≥ 0, the rectangle is right of it and left of it are the half of the strip and the part from 0
    // on. Elsewhere it has a part on each side of 0, and left of it is less than the half.
    const auto is_right = x0_ >= T(0.0);
    const Pair pairs[] = {
        {h_, -y0_},
        {h_, y1_},
        {hl, at_x1.D},
        part_between(at_0, at_x0, abs(x0_), hl),
        part_between(HalfStrip::either(is_right, at_x0, at_0), at_x1, select(is_right, width.hi, x1_), hl),
        {hl, select(is_right, h_ * h_ + y0_ * y1_, at_x0.D)}};
    Few<T> y{}, x{};
    for (std::size_t i = 0; i < 6; ++i) y[i] = pairs[i].y, x[i] = pairs[i].x;
    const Few<T> angles = polar_angles_of_each(y, x, 6);
    kappa0_ = angles[0], kappa1_ = angles[1];
    right_ = 2.0 * angles[2];
    const T near_part = 2.0 * angles[3], far_part = 2.0 * angles[4], rest = angles[5];
    left_ = select(is_right, rest + near_part, 2.0 * rest);
    const T solid_angle = select(is_right, far_part, near_part + far_part);
    solid_angle_ = select(h_ > T(0.0) && solid_angle >= T(least_angle), solid_angle, T(0.0));
  }

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] T solid_angle() const { return solid_angle_; }

  /// Unit direction, and the distance along it to the rectangle.
  struct Drawn {
    Vector direction;
    T distance;
  };

  /// Draws a direction. Precondition: the solid angle is not 0.
  [[nodiscard]] Drawn sample(T u, T v) const {
    using std::abs, std::copysign, std::max, std::min, std::sqrt;
    const T p = (left_ + u * solid_angle_) / 2.0,
            q = (right_ + (1.0 - u) * solid_angle_) / 2.0;  // halves
    // Each angle or its supplement. π − |g| for g = p − q is κ0 + κ1 + 2 min(p, q).
    const Few<T> sines = sines_of_each(
        Few<T>{min(abs(p - q), kappa0_ + kappa1_ + 2.0 * min(p, q)), min(p, kappa0_ + kappa1_ + q),
               min(q, kappa0_ + kappa1_ + p), min(kappa1_ + p, kappa0_ + q), min(kappa1_ + q, kappa0_ + p)},
        5);
    const T product = sines[1] * sines[2] * sines[3] * sines[4];
    const T x = min(max(copysign(h_ * sines[0] / (2.0 * sqrt(product)), p - q), x0_), x1_);

    // y = ρ w/√(1 − w²) for a w between w0 and w1; 1 − w and 1 + w are sums of those of the ends.
    const T rho = sqrt(x * x + h_ * h_);
    const auto below_1 = [rho](const T& end) {  // 1 − y/r
      const T r = sqrt(end * end + rho * rho);
      const auto cancels = end > T(0.0);
      return select(cancels, rho * rho, r - end) / select(cancels, r * (r + end), r);
    };
    const T minus = (1.0 - v) * below_1(y0_) + v * below_1(y1_);
    const T plus = (1.0 - v) * below_1(-y0_) + v * below_1(-y1_);
    const T y = min(max(rho * (plus - minus) / (2.0 * sqrt(plus * minus)), y0_), y1_);

    const T farthest = sqrt(x1_ * x1_ + y1_ * y1_ + h_ * h_);
    const T distance = min(sqrt(y * y + rho * rho), farthest);
    return {(x / distance) * x_ + (y / distance) * y_ + (h_ / distance) * z_, distance};
  }

 private:
  /// Smallest height, in units of about the largest length, and smallest solid angle. With them no number
  /// underflows: p and q are at least 2^-305 for u from 2^-54 to 1 - 2^-54, κ0 and κ1 at least 2^-151, and
  /// the product of the four sines is above 2^-920.
  static constexpr double least_height = 0x1p-150, least_angle = 0x1p-250;

  /// The part of the strip y0 ≤ y ≤ y1, z = h > 0 to the right of x ≥ 0.
  struct HalfStrip {
    T x, r0, r1, D;

    HalfStrip(const RectangleSeen& of, T left) : x(left) {
      using std::sqrt;
      const T q = x * x + of.h_ * of.h_, product = of.y0_ * of.y1_;
      r0 = sqrt(q + of.y0_ * of.y0_), r1 = sqrt(q + of.y1_ * of.y1_);
      const T sum =
          select(product < T(0.0), q * (q + of.y0_ * of.y0_ + of.y1_ * of.y1_) / (r0 * r1 - product),
                 r0 * r1 + product);
      D = sum + q + x * (r0 + r1);
    }

    /// Returns a where the condition holds, and b elsewhere.
    static HalfStrip either(const auto& condition, HalfStrip a, const HalfStrip& b) {
      a.x = select(condition, a.x, b.x), a.D = select(condition, a.D, b.D);
      a.r0 = select(condition, a.r0, b.r0), a.r1 = select(condition, a.r1, b.r1);
      return a;
    }
  };

  /// Numbers of which polar_angle(y, x) is half of a solid angle, or an angle.
  struct Pair {
    T y, x;
  };

  /// Returns the pair of the part of the strip between a.x and b.x ≥ a.x, where width = b.x − a.x.
  [[nodiscard]] static Pair part_between(const HalfStrip& a, const HalfStrip& b, const T& width,
                                         const T& hl) {
    const T sum = a.x + b.x;
    const T dr0 = width * sum / (a.r0 + b.r0), dr1 = width * sum / (a.r1 + b.r1);
    const T difference = b.r0 * dr1 + a.r1 * dr0 + width * (b.r0 + b.r1) + a.x * (dr0 + dr1) + width * sum;
    return {hl * difference, a.D * b.D + hl * hl};
  }

  Vector x_, y_, z_;  // unit axes
  T x0_, x1_, y0_, y1_, h_;
  T kappa0_, kappa1_, left_, right_, solid_angle_;
};

}  // namespace detail

/// Directions from a point to a rectangle with edges that are perpendicular. The edges may deviate from
/// that by their rounding; the corner opposite the position is then that of the rectangle. The solid angle
/// has a relative error below 20u, and directions are off by at most 20u, if the distances from the lines
/// through the edges, and from the plane, are above 2^-45 of those from the corners. Heights over the plane
/// below 2^-150 of the largest of the sizes and distances count as that much, and a point from which the
/// solid angle is then below 2^-250 counts as in the plane.
class RectangleView {
 public:
  RectangleView(const Point& from, const Point& position, const Vec3& edge_u, const Vec3& edge_v)
      : RectangleView(from, RectangleLight(position, edge_u, edge_v)) {}
  RectangleView(const Point& from, const RectangleLight& r)
      : exponent_(exponent_of_view(from, r)), seen_(seen_by(from, r, exponent_)) {}

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] double solid_angle() const { return seen_.solid_angle(); }

  /// Draws a direction with two numbers from [0, 1).
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (!(solid_angle() > 0)) return {};
    const auto [direction, distance] = seen_.sample(u, v);
    return {direction, std::ldexp(distance, exponent_), 1 / solid_angle()};
  }

  /// Draws a direction to the rectangle from each of some points: drawn[i] is what sample returns for
  /// from[i], u[i] and v[i], to the bit. There are from 1 to simd::double_lanes points, and `drawn` holds at
  /// least as many. Coordinates are below 2^499 and edges are longer than 2^-500, as in any scene (most_t,
  /// least_size).
  static void sample_each(const RectangleLight& r, std::span<const Point> from, const FewNumbers& u,
                          const FewNumbers& v, std::span<LightSample> drawn) {
    using simd::Doubles, simd::Vectors;
    FewNumbers x, y, z;
    for (std::size_t i = 0; i < static_cast<std::size_t>(simd::double_lanes); ++i) {
      const Point& one = from[std::min(i, from.size() - 1)];
      x[i] = one.x, y[i] = one.y, z[i] = one.z;
    }
    const auto load = [](const FewNumbers& numbers) { return Doubles::load(numbers.data()); };
    const Vectors points{load(x), load(y), load(z)}, to_corner = abs(Vectors(r.position) - points);
    const Doubles size = max(to_corner.x, max(to_corner.y, to_corner.z));
    const double unit_of_edges = power_of_two(r.exponent);
    const Doubles unit = max(simd::power_above(size), Doubles(unit_of_edges)), scale = Doubles(1.0) / unit,
                  smaller = scale * unit_of_edges;  // all exact, as powers of two
    const auto to = [&](const Doubles& of, double corner) {
      return two_sum(Doubles(corner) * scale, -(of * scale));
    };
    const auto length = [&](const DoubleDouble& of) {
      return DoubleDoubleOf<Doubles>{Doubles(of.hi) * smaller, Doubles(of.lo) * smaller};
    };
    const detail::RectangleSeen<Doubles, Vectors> seen(
        r, {to(points.x, r.position.x), to(points.y, r.position.y), to(points.z, r.position.z)},
        length(r.width), length(r.depth));
    const auto [direction, distance] = seen.sample(load(u), load(v));
    const Doubles solid_angle = seen.solid_angle(), density = Doubles(1.0) / solid_angle,
                  far = distance * unit;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const int lane = static_cast<int>(i);
      if (solid_angle[lane] > 0)
        drawn[i] = {direction[lane], far[lane], density[lane]};
      else
        drawn[i] = {};
    }
  }

 private:
  using Seen = detail::RectangleSeen<double, Vec3>;

  [[nodiscard]] static int exponent_of_view(const Point& from, const RectangleLight& r) {
    return std::max(exponent_of({r.position - from}), r.exponent);
  }

  [[nodiscard]] static Seen seen_by(const Point& from, const RectangleLight& r, int exponent) {
    const PreciseVector to = scaled_difference(r.position, from, -exponent);
    const int smaller = r.exponent - exponent;
    const Vec3 sizes = scaled(Vec3{r.width.hi, r.depth.hi, 0}, smaller),
               rests = scaled(Vec3{r.width.lo, r.depth.lo, 0}, smaller);
    return Seen(r, {to.x, to.y, to.z}, {sizes.x, rests.x}, {sizes.y, rests.y});
  }

  int exponent_;  // lengths are scaled by 2^-exponent
  Seen seen_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

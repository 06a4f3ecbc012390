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
// with a difference D' − D that is a sum of products of x' − x. The arc tangent is the angle of a complex
// number, and for two parts together it is the angle of the product of their numbers.
//
// Let p be half of the solid angle of the strip left of x, and q = Δ − p half of that right of it. Then
//   x = h ρ1 sin(p − q)/(2 √(sin p sin q (h cos p + y1 sin p) (h cos q + y1 sin q))),   ρ = √(h² + y²),
// which is Ureña's formula for x with its differences of cosines written as products. p and q are sums: the
// part outside the rectangle and the share of Ω. If one of them is obtuse, say q, its sine and its sum would
// lose digits, and are taken from p, by the sine h l/ρ0ρ1 and the cosine (h² + y0 y1)/ρ0ρ1 of Δ:
//   ρ0 ρ1 sin q = h l cos p − (h² + y0 y1) sin p,   ρ0 (h cos q + y1 sin q) = ρ1 (h cos p − y0 sin p).
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
    const auto if_right = [&](const HalfStrip& a, const HalfStrip& b) {
      return HalfStrip::either(is_right, a, b);
    };
    const Pair near_part = part_between(at_0, at_x0, abs(x0_), hl),
               far_part = part_between(if_right(at_x0, at_0), at_x1, select(is_right, width.hi, x1_), hl),
               beyond = Pair{hl, if_right(at_0, at_x0).D}, nothing{T(0.0), T(1.0)};
    const Pair beside = beyond * Pair::either(is_right, near_part, nothing),
               inside = far_part * Pair::either(is_right, nothing, near_part);
    const Few<T> angles =
        polar_angles_of_each(Few<T>{beside.y, inside.y, hl}, Few<T>{beside.x, inside.x, at_x1.D}, 3);
    left_ = angles[0], middle_ = angles[1], right_ = angles[2];
    rho0_ = at_0.r0, rho1_ = at_0.r1, hl_ = hl;
    const T solid_angle = 2.0 * middle_;
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
    const T p = left_ + u * middle_, q = right_ + (1.0 - u) * middle_;
    const auto [sines, cosines] = sines_and_cosines_of_each(Few<T>{min(p, q), max(p, q)}, 2);
    const T sine = sines[0], cosine = cosines[0];  // of the smaller angle
    const auto is_obtuse = cosines[1] < T(0.0);
    const T other_sine = select(is_obtuse, hl_ * cosine - (h_ * h_ + y0_ * y1_) * sine, sines[1]),
            other_sum = select(is_obtuse, h_ * cosine - y0_ * sine, h_ * cosines[1] + y1_ * sines[1]),
            product = sine * other_sine * (h_ * cosine + y1_ * sine) * other_sum;
    const T difference = other_sine * cosine - select(is_obtuse, rho0_ * rho1_, T(1.0)) * cosines[1] * sine,
            size = h_ * select(is_obtuse, T(1.0), rho1_) * difference / (2.0 * sqrt(product));
    const T x = min(max(copysign(size, p - q), x0_), x1_);

    // y = ρ w/√(1 − w²) for a w between w0 and w1; 1 − w and 1 + w are sums of those of the ends, here both
    // times the `whole` of both ends.
    const T rho_2 = x * x + h_ * h_, rho = sqrt(rho_2);
    const End end_0(y0_, rho_2), end_1(y1_, rho_2);
    const T share_0 = (1.0 - v) * end_1.whole, share_1 = v * end_0.whole;
    const T minus = share_0 * end_0.minus + share_1 * end_1.minus,
            plus = share_0 * end_0.plus + share_1 * end_1.plus;
    const T y = min(max(rho * (plus - minus) / (2.0 * sqrt(plus * minus)), y0_), y1_);

    const T distance = sqrt(y * y + rho_2), inverse = 1.0 / distance;
    return {(x * inverse) * x_ + (y * inverse) * y_ + (h_ * inverse) * z_, distance};
  }

 private:
  /// Smallest height, in units of about the largest length, and smallest solid angle. With them no number
  /// that counts underflows: one of x1, y1 and h is at least 1/4, so that a pair of part_between is at least
  /// 2^-598, the product of two 2^-806, and its y 2^-1006. p and q are at least 2^-255 for u from 2^-54 to 1
  /// − 2^-54, and 2^-197 where Δ is obtuse, so that the product below the root is at least 2^-1000.
  static constexpr double least_height = 0x1p-100, least_angle = 0x1p-200;

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

  /// 1 − w and 1 + w for the end w = y/r of a line at the distance ρ, each times `whole`.
  struct End {
    T whole, minus, plus;

    End(const T& y, const T& rho_2) {
      using std::abs, std::sqrt;
      const T r = sqrt(y * y + rho_2), sum = r + abs(y);
      const auto is_positive = y > T(0.0);
      whole = r * sum;
      minus = select(is_positive, rho_2, sum * sum), plus = select(is_positive, sum * sum, rho_2);
    }
  };

  /// Complex number x + i y, whose angle, polar_angle(y, x), is half of a solid angle.
  struct Pair {
    T y, x;

    /// Returns the product, whose angle is the sum of both. No digits of y are lost for x, y ≥ 0.
    friend Pair operator*(const Pair& a, const Pair& b) {
      return {a.x * b.y + a.y * b.x, a.x * b.x - a.y * b.y};
    }

    /// Returns a where the condition holds, and b elsewhere.
    static Pair either(const auto& condition, const Pair& a, const Pair& b) {
      return {select(condition, a.y, b.y), select(condition, a.x, b.x)};
    }
  };

  /// Returns the pair of the part of the strip between a.x and b.x ≥ a.x, where width = b.x − a.x. Both
  /// components are multiplied by (a.r0 + b.r0) (a.r1 + b.r1), by which the difference of D would be divided.
  [[nodiscard]] static Pair part_between(const HalfStrip& a, const HalfStrip& b, const T& width,
                                         const T& hl) {
    const T sum = a.x + b.x, s0 = a.r0 + b.r0, s1 = a.r1 + b.r1, product = s0 * s1;
    const T difference =
        width * (sum * (b.r0 * s0 + a.r1 * s1 + a.x * (s0 + s1)) + product * (b.r0 + b.r1 + sum));
    return {hl * difference, (a.D * b.D + hl * hl) * product};
  }

  Vector x_, y_, z_;  // unit axes
  T x0_, x1_, y0_, y1_, h_;
  T left_, middle_, right_;  // halves of the solid angles of the strip's parts, and of the rectangle between
  T solid_angle_, rho0_, rho1_, hl_;
};

}  // namespace detail

/// Directions from a point to a rectangle with edges that are perpendicular. The edges may deviate from
/// that by their rounding; the corner opposite the position is then that of the rectangle. The solid angle
/// has a relative error below 20u, and directions are off by at most 20u, if the distances from the lines
/// through the edges, and from the plane, are above 2^-45 of those from the corners. Heights over the plane
/// below 2^-100 of the largest of the sizes and distances count as that much, and a point from which the
/// solid angle is then below 2^-200 counts as in the plane.
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

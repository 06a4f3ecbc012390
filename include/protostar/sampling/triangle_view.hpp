// A triangle as seen from a point: its solid angle, and directions to it that are uniform in solid angle.
//
// From the point, the triangle is a spherical triangle, with sides and angles. Arvo's map (1995) cuts off a
// share u of its area by a great circle from a vertex A to a point Q of the opposite side, and takes a point
// of that arc. Arvo's formulas lose their digits for small triangles and for those that fill almost a
// hemisphere. These here are made of half angles, in which nothing of a small size is a difference.
//
// Letters: a is the angular length of the side BC, b of CA, c of AB; β is the angle at B. Ω is the solid
// angle, and Ω/2 half the spherical excess. With z = cos(a/2) cos(c/2) + sin(a/2) sin(c/2) e^(iβ) and w =
// sin(a/2) sin(c/2) + cos(a/2) cos(c/2) e^(iβ),
//   |z| = |w| = cos(b/2),   Ω/2 = arg z,   β − Ω/2 = arg w.
// The vertex B is the one opposite the shortest side, so b ≤ 2π/3 and |z| ≥ 1/2: neither sum cancels.
//
// For the part of the area Ω' = uΩ between AB and AQ, with S = Ω'/2 and σ the length of BQ,
//   tan(σ/2) = sin S/(tan(c/2) sin(β − S)),
// where β − S = (β − Ω/2) + (1 − u) Ω/2 is a sum. The length τ of AQ and the angle α' of the triangle ABQ at
// A are those of Delambre's analogies:
//   sin(τ/2) e^(iδ) = sin((σ + c)/2) sin(β/2) + i sin((σ − c)/2) cos(β/2),   α' = S + (π − β)/2 + δ.
// On the arc, equal areas have equal 1 − cos θ, so sin(θ/2) = √v sin(τ/2).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "../numeric/precise_vector.hpp"
#include "../numeric/radians.hpp"
#include "light_sample.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Directions from a point to a triangle, on either side of which the point may be. Digits that cancel
/// when the point is near an edge, a corner or the plane are those of cross products and of the triple
/// product, and these are computed in double-double from exact differences. The solid angle has a relative
/// error below 20u, if the distances from the lines through the edges, and from the plane, are above 2^-45 of
/// those from the corners; directions are off by at most 40u.
class TriangleView {
 public:
  TriangleView(const Point& from, const Point& p, const Point& q, const Point& r) {
    exponent_ = exponent_of({p - from, q - from, r - from});
    const std::array<Point, 3> corners{p, q, r};
    std::array<PreciseVector, 3> to;
    std::array<Vec3, 3> unit;
    for (std::size_t i = 0; i < 3; ++i) {
      to[i] = scaled_difference(corners[i], from, -exponent_);
      const Vec3 v = to[i].rounded();
      const double size = length(v);
      if (!(size > 0)) return;  // the point is a corner
      farthest_ = std::max(farthest_, size);
      unit[i] = v / size;
    }
    std::size_t B = 0;
    double most = -2;
    for (std::size_t i = 0; i < 3; ++i)
      if (const double cosine = dot(unit[(i + 1) % 3], unit[(i + 2) % 3]); cosine > most)
        most = cosine, B = i;
    const std::size_t A = (B + 1) % 3, C = (B + 2) % 3;

    const PreciseVector BA = scaled_difference(corners[A], corners[B], -exponent_),
                        BC = scaled_difference(corners[C], corners[B], -exponent_);
    const PreciseVector area = cross(BC, BA);
    const DoubleDouble volume = dot(to[B], area);  // six times that of the tetrahedron
    const Vec3 across_c = cross(to[B], BA).rounded(), across_a = cross(to[B], BC).rounded();
    const Vec3 to_a = to[A].rounded(), to_b = to[B].rounded(), to_c = to[C].rounded();
    const double size_c = length(across_c), size_a = length(across_a);
    if (!(std::abs(volume.hi) > 0 && size_c > 0 && size_a > 0)) return;
    const Vec3 across = across_c / size_c;
    half_c_ = half_angle(size_c, dot(to_a, to_b));
    half_a_ = half_angle(size_a, dot(to_c, to_b));
    half_beta_ =
        half_angle(std::abs(volume.hi) / size_c * length(to_b) / size_a, dot(across, across_a / size_a));
    sine_beta_ = 2 * half_beta_.sine * half_beta_.cosine;
    const double cosine_beta = (half_beta_.cosine - half_beta_.sine) * (half_beta_.cosine + half_beta_.sine);
    const double cosines = half_a_.cosine * half_c_.cosine, sines = half_a_.sine * half_c_.sine;
    half_excess_ = polar_angle(sines * sine_beta_, cosines + sines * cosine_beta);
    rest_of_beta_ = polar_angle(cosines * sine_beta_, sines + cosines * cosine_beta);

    // The tangents at A: along AB, and across it to the side of C.
    at_a_ = unit[A];
    along_ = cross(at_a_, across);
    sideways_ = volume.hi < 0 ? across : -across;
    const Vec3 normal = area.rounded();
    const double size = length(normal);
    normal_ = (volume.hi < 0 ? -1 / size : 1 / size) * normal;
    height_ = std::abs(volume.hi) / size;
  }

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] double solid_angle() const { return 2 * half_excess_; }

  /// Draws a direction with two numbers from [0, 1).
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (!(half_excess_ > 0)) return {};
    const auto [sin_s, cos_s] = sine_and_cosine(u * half_excess_);
    const double sin_rest = sine_and_cosine(rest_of_beta_ + (1 - u) * half_excess_).sine;
    // Halves of σ, then of τ.
    const double y = half_c_.cosine * sin_s, x = half_c_.sine * sin_rest, r = std::sqrt(x * x + y * y);
    const double sin_sigma = y / r, cos_sigma = x / r;
    const double sum = sin_sigma * half_c_.cosine + cos_sigma * half_c_.sine;
    const double difference = sin_sigma * half_c_.cosine - cos_sigma * half_c_.sine;
    const double re = sum * half_beta_.sine, im = difference * half_beta_.cosine;
    const double sin2_tau = re * re + im * im;
    const double sin_tau = std::sqrt(sin2_tau);
    // The angle at A, as a product of three numbers e^(i angle).
    const double c = half_beta_.sine * cos_s - half_beta_.cosine * sin_s;
    const double s = half_beta_.sine * sin_s + half_beta_.cosine * cos_s;
    const double cos_a = (c * re - s * im) / sin_tau, sin_a = (s * re + c * im) / sin_tau;

    const double sin_half = std::sqrt(v) * sin_tau, cos_half = std::sqrt(1 - v * sin2_tau);
    const double cosine = 1 - 2 * v * sin2_tau, sine = 2 * sin_half * cos_half;
    const Vec3 direction = cosine * at_a_ + sine * (cos_a * along_ + sin_a * sideways_);
    const double distance = detail::distance_to_plane(height_, dot(direction, normal_), farthest_);
    return {direction, std::ldexp(distance, exponent_), 1 / solid_angle()};
  }

 private:
  SineCosine half_a_, half_c_, half_beta_;
  double sine_beta_ = 0;
  double half_excess_ = 0;   // Ω/2
  double rest_of_beta_ = 0;  // β − Ω/2
  Vec3 at_a_{0}, along_{0}, sideways_{0}, normal_{0};
  double height_ = 0, farthest_ = 0;  // scaled by 2^-exponent_
  int exponent_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

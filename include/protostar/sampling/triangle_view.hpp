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
/// those from the corners; directions are off by at most 40u. Otherwise digits are lost, and a point on a
/// line through an edge, up to rounding, counts as in the plane. So does one from which the solid angle is
/// below 2^-899.
class TriangleView {
 public:
  TriangleView(const Point& from, const Point& p, const Point& q, const Point& r) {
    exponent_ = exponent_of({p - from, q - from, r - from});
    const std::array<Point, 3> corners{p, q, r};
    std::array<ModerateVector, 3> to;
    std::array<Vec3, 3> unit;
    std::array<int, 3> exponents{};
    for (std::size_t i = 0; i < 3; ++i) {
      const PreciseVector difference = scaled_difference(corners[i], from, -exponent_);
      to[i] = ModerateVector(difference), exponents[i] = exponent_of({difference.rounded()});
      const Vec3 v = to[i].vector.rounded();
      const double size = length(v);
      if (!(size > 0)) return;  // the point is a corner
      farthest_ = std::max(farthest_, length(difference.rounded()));
      unit[i] = v / size;
    }
    std::size_t B = 0;
    double most = -2;
    for (std::size_t i = 0; i < 3; ++i)
      if (const double cosine = dot(unit[(i + 1) % 3], unit[(i + 2) % 3]); cosine > most)
        most = cosine, B = i;
    const std::size_t A = (B + 1) % 3, C = (B + 2) % 3;

    // Each vector and each product is scaled by a power of two of its own, since edges may have any sizes,
    // and the point any distance from a corner; the quotients below take these powers back.
    const ModerateVector BA(scaled_difference(corners[A], corners[B], -exponent_)),
        BC(scaled_difference(corners[C], corners[B], -exponent_));
    const ModerateVector area(cross(BC.vector, BA.vector));
    // The triple product is the same with the vector to any corner, and a cross product with an edge the same
    // with that to either end. A corner that is about 2^48 times nearer than B, or more, leaves more digits.
    const auto nearest = [&](std::size_t one, std::size_t other) {
      return exponents[other] < exponents[one] - 48 ? other : one;
    };
    const ModerateVector &on_c = to[nearest(B, A)], &on_a = to[nearest(B, C)],
                         &on_plane = to[nearest(nearest(B, A), C)];
    const DoubleDouble volume = dot(on_plane.vector, area.vector);  // six times that of the tetrahedron
    const ModerateVector across_c(cross(on_c.vector, BA.vector)), across_a(cross(on_a.vector, BC.vector));
    const Vec3 to_a = to[A].vector.rounded(), to_b = to[B].vector.rounded(), to_c = to[C].vector.rounded();
    const double size_c = length(across_c.vector.rounded()), size_a = length(across_a.vector.rounded());
    if (!(std::abs(volume.hi) > 0 && size_c > 0 && size_a > 0)) return;
    const int exponent_c = on_c.exponent - to[B].exponent + across_c.exponent,
              exponent_a = on_a.exponent - to[B].exponent + across_a.exponent;
    // `across`, the normal of the plane through AB and the point, is perpendicular to the direction to A up
    // to 6u, unless the point is so near to the line AB that digits are lost. With fewer than 24 bits left,
    // the point counts as on the line; with fewer than 48, `across` is made perpendicular, so that directions
    // are unit vectors.
    Vec3 across = across_c.vector.rounded() / size_c;
    const double off = dot(across, unit[A]);
    if (std::abs(off) > 0x1p-24) return;
    if (std::abs(off) > 0x1p-48) across = normalize(across - off * unit[A]);
    half_c_ = half_angle(scaled(size_c, exponent_c + BA.exponent - to[A].exponent), dot(to_a, to_b));
    half_a_ = half_angle(scaled(size_a, exponent_a + BC.exponent - to[C].exponent), dot(to_c, to_b));
    const double sine = scaled(std::abs(volume.hi) / size_c * length(to_b) / size_a,
                               area.exponent + on_plane.exponent - to[B].exponent - exponent_c - exponent_a);
    const double cosine = dot(across, across_a.vector.rounded() / size_a);
    // The sum of the squares is about 1 if any of their digits are right, and may be anything otherwise.
    if (const double one = sine * sine + cosine * cosine; !(0x1p-100 < one && one < 0x1p100)) return;
    half_beta_ = half_angle(sine, cosine);
    sine_beta_ = 2 * half_beta_.sine * half_beta_.cosine;
    const double cosine_beta = (half_beta_.cosine - half_beta_.sine) * (half_beta_.cosine + half_beta_.sine);
    const double cosines = half_a_.cosine * half_c_.cosine, sines = half_a_.sine * half_c_.sine;
    const double half_excess = polar_angle(sines * sine_beta_, cosines + sines * cosine_beta);
    if (!(half_excess >= 0x1p-900)) return;
    half_excess_ = half_excess;
    rest_of_beta_ = polar_angle(cosines * sine_beta_, sines + cosines * cosine_beta);

    // The tangents at A: along AB, and across it to the side of C.
    at_a_ = unit[A];
    along_ = cross(at_a_, across);
    sideways_ = volume.hi < 0 ? across : -across;
    const Vec3 normal = area.vector.rounded();
    const double size = length(normal);
    normal_ = (volume.hi < 0 ? -1 / size : 1 / size) * normal;
    height_ = scaled(std::abs(volume.hi) / size, on_plane.exponent);
  }

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] double solid_angle() const { return 2 * half_excess_; }

  /// Draws a direction with two numbers from [0, 1).
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (!(half_excess_ > 0)) return {};
    const auto [sin_s, cos_s] = sine_and_cosine(u * half_excess_);
    const double sin_rest = sine_and_cosine(rest_of_beta_ + (1 - u) * half_excess_).sine;
    // Halves of σ, then of τ.
    const LiftedPair sigma(half_c_.sine * sin_rest, half_c_.cosine * sin_s);
    const double sin_sigma = sigma.y / sigma.length, cos_sigma = sigma.x / sigma.length;
    const double sum = sin_sigma * half_c_.cosine + cos_sigma * half_c_.sine;
    const double difference = sin_sigma * half_c_.cosine - cos_sigma * half_c_.sine;
    const LiftedPair tau(sum * half_beta_.sine, difference * half_beta_.cosine);
    const double sin2_tau = tau.square / tau.lift / tau.lift, sin_tau = tau.length / tau.lift;
    // The angle at A, as a product of three numbers e^(i angle).
    const double c = half_beta_.sine * cos_s - half_beta_.cosine * sin_s;
    const double s = half_beta_.sine * sin_s + half_beta_.cosine * cos_s;
    const double cos_a = (c * tau.x - s * tau.y) / tau.length, sin_a = (s * tau.x + c * tau.y) / tau.length;

    const double sin_half = std::sqrt(v) * sin_tau, cos_half = std::sqrt(std::max(1 - v * sin2_tau, 0.0));
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

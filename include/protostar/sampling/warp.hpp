// Maps from pairs of numbers in (0, 1) to points of a disk and to directions, with their densities.
//
// Each map takes equal areas of the unit square to equal probabilities, and is continuous but for a seam or a
// point, so that pairs that are spread evenly stay so. The density of a direction is the probability per
// solid angle near it, in 1/steradian. Local directions have the normal as their z axis; Frame turns them.
// Same bytes on every machine. The unit roundoff is u = 2^-53.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../numeric/power.hpp"
#include "../numeric/radians.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Unit direction that was drawn, and the density with which it is drawn.
struct DirectionAndDensity {
  Vec3 direction{0, 0, 1};
  double density = 0;  ///< in 1/steradian
};

/// Three unit vectors, perpendicular to each other, x × y = z: the axes of local directions.
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  /// Returns local.x · x + local.y · y + local.z · z.
  [[nodiscard]] Vec3 operator()(const Vec3& local) const { return local.x * x + local.y * y + local.z * z; }

  /// Returns the components of a direction along x, y and z.
  [[nodiscard]] Vec3 local(const Vec3& direction) const {
    return {dot(direction, x), dot(direction, y), dot(direction, z)};
  }
};

/// Returns the frame whose z axis is a unit vector n. It turns the z axis to n by the shortest way, so it is
/// a continuous function of n but for n = (0, 0, −1), as no frame can be continuous everywhere. Its vectors
/// are unit and perpendicular with errors of 8u and that of n's length.
///
/// With k = 1/(1 + n.z), x = (1 − k n.x², −k n.x n.y, −n.x) and y = (−k n.x n.y, 1 − k n.y², −n.y). For n.z
/// < 0 the sum 1 + n.z would cancel, and k = (1 − n.z)/(n.x² + n.y²) is accurate. It is always inlined: a
/// frame that a call has stored number by number is loaded in vectors at once, for which a processor waits.
[[nodiscard, gnu::always_inline]] inline Frame frame_around(const Vec3& n) {
  const double square = n.x * n.x + n.y * n.y;
  if (n.z < 0 && square < 0x1p-900) return {{1, 0, 0}, {0, -1, 0}, n};  // before the squares underflow
  const double k = n.z < 0 ? (1 - n.z) / square : 1 / (1 + n.z);
  const double xy = -n.x * n.y * k;
  return {{1 - n.x * n.x * k, xy, -n.x}, {xy, 1 - n.y * n.y * k, -n.y}, n};
}

/// Point of the unit disk in polar form.
struct PolarPoint {
  double radius = 0;
  double angle = 0;  ///< in radians, from −π/4 to 7π/4
};

/// Returns the point of the unit disk to which Shirley and Chiu's concentric map takes (u, v): squares around
/// the center of the unit square become circles, and equal areas become equal areas.
[[nodiscard]] inline PolarPoint concentric_polar(double u, double v) {
  constexpr double eighth = std::numbers::pi / 4;
  const double a = 2 * u - 1, b = 2 * v - 1;
  if (a == 0 && b == 0) return {};
  // The quarter in which the point lies is random: a processor would foresee a branch only every other time,
  // so a table is looked up instead.
  constexpr double begin[2][2] = {{2 * eighth, 6 * eighth}, {0, 4 * eighth}};
  const bool is_wide = std::abs(a) > std::abs(b);
  const double along[2] = {b, a}, across[2] = {-a, b}, size = along[is_wide];
  return {std::abs(size), begin[is_wide][size < 0] + eighth * (across[is_wide] / size)};
}

/// Returns the point of concentric_polar in Cartesian coordinates. The density is 1/π per area.
[[nodiscard]] inline Uv concentric_disk(double u, double v) {
  const PolarPoint p = concentric_polar(u, v);
  const auto [sine, cosine] = sine_and_cosine(p.angle);
  return {p.radius * cosine, p.radius * sine};
}

/// Returns the density with which cosine_hemisphere draws a direction, cos θ/π in 1/steradian, from the
/// cosine of its angle θ to the normal; 0 if that is negative.
[[nodiscard]] inline double cosine_density(double cosine) { return std::max(cosine, 0.0) / std::numbers::pi; }

/// Draws a local direction of the upper hemisphere with the density cos θ/π: the point of the hemisphere
/// above a point of the disk (Malley). cos θ = √((1 − r)(1 + r)) does not cancel at grazing angles.
[[nodiscard]] inline DirectionAndDensity cosine_hemisphere(double u, double v) {
  const PolarPoint p = concentric_polar(u, v);
  const auto [sine, cosine] = sine_and_cosine(p.angle);
  const double z = std::sqrt((1 - p.radius) * (1 + p.radius));
  return {{p.radius * cosine, p.radius * sine, z}, cosine_density(z)};
}

/// Draws a direction of the cosine-weighted hemisphere around a unit normal.
[[nodiscard]] inline DirectionAndDensity cosine_hemisphere(const Vec3& normal, double u, double v) {
  const auto [direction, density] = cosine_hemisphere(u, v);
  return {frame_around(normal)(direction), density};
}

/// Density with which uniform_sphere draws each direction, in 1/steradian.
inline constexpr double uniform_sphere_density = 0.25 / std::numbers::pi;

/// Draws any direction, none more likely than another: its height along z is 1 − 2u, which is uniform on a
/// sphere (Archimedes), and its angle around z is 2πv.
[[nodiscard]] inline DirectionAndDensity uniform_sphere(double u, double v) {
  const auto [sine, cosine] = sine_and_cosine(2 * std::numbers::pi * v);
  const double r = 2 * std::sqrt(u * (1 - u));
  return {{r * cosine, r * sine, 1 - 2 * u}, uniform_sphere_density};
}

/// Power of a cosine around the z axis: the density (n + 1)/(2π) · cosⁿ α, where α is the angle from the
/// axis, on the hemisphere around it. The exponent n ≥ 0 need not be whole.
struct CosinePower {
  double exponent = 0;

  /// Returns the density for the cosine of α; 0 where that is not positive.
  [[nodiscard]] double density(double cosine) const {
    if (!(cosine > 0)) return 0;
    const double power =
        exponent == 0 ? 1 : static_cast<double>(pow(std::clamp(cosine, 0x1p-1000, 1.0), exponent));
    return (exponent + 1) / (2 * std::numbers::pi) * power;
  }

  /// Draws a local direction. Of the lobe, the share within α is 1 − cosⁿ⁺¹ α, so with the share r² of the
  /// disk cos α = (1 − r²)^(1/(n+1)). The power is a double-double with an error below 2^-57, and so is 1 −
  /// cos².
  [[nodiscard]] DirectionAndDensity sample(double u, double v) const {
    const PolarPoint p = concentric_polar(u, v);
    const auto [sine, cosine] = sine_and_cosine(p.angle);
    const double rest = std::max((1 - p.radius) * (1 + p.radius), 0x1p-1000);  // r may be rounded up to 1
    const DoubleDouble height = pow(rest, quotient(1, exponent + 1));
    const double z = static_cast<double>(height);
    const double r = std::sqrt(std::max(static_cast<double>((1 - height) * (1 + height)), 0.0));
    return {{r * cosine, r * sine, z}, density(z)};
  }
};

/// Microfacets of Trowbridge and Reitz (GGX): normals of tiny mirrors, of which each is drawn as often as the
/// viewer sees it. Directions and normals are local unit vectors.
struct VisibleNormals {
  Vec3 to_viewer{0, 0, 1};  ///< direction to the viewer, z ≥ 0
  double roughness = 1;  ///< width α > 0 of the slopes: GgxLobe::width, the square of a material's roughness

  /// Returns the area of microfacets per solid angle of their normals, and per area of the surface: D = α²/(π
  /// (α² cos² θ + sin² θ)²); 0 below the surface.
  [[nodiscard]] double distribution(const Vec3& normal) const {
    if (!(normal.z > 0)) return 0;
    const double alpha2 = roughness * roughness;
    const double k = alpha2 * normal.z * normal.z + normal.x * normal.x + normal.y * normal.y;
    return alpha2 / (std::numbers::pi * k * k);
  }

  /// Returns √(cos² θ + α² sin² θ) of a unit direction at the angle θ to the surface's normal: its length
  /// after x and y are multiplied by α, which turns the microfacets into a hemisphere.
  [[nodiscard]] double slope_length(const Vec3& d) const {
    return std::sqrt(d.z * d.z + roughness * roughness * (d.x * d.x + d.y * d.y));
  }

  /// Returns the density of a normal: G1 · D · max(0, viewer · normal)/viewer.z, with the share of
  /// microfacets that others do not hide from the viewer (Smith's G1), 2/(1 + √(1 + α² tan² θ)). The quotient
  /// G1/viewer.z is used as one, so that a viewer in the plane of the surface has a density too.
  [[nodiscard]] double density(const Vec3& normal) const {
    return 2 / (to_viewer.z + slope_length(to_viewer)) * distribution(normal) *
           std::max(0.0, dot(to_viewer, normal));
  }

  /// Returns the density of the direction to a light that a microfacet mirrors to the viewer: density(normal)
  /// of the normal halfway, over 4 (viewer · normal), as a mirrored ray turns twice as fast as the normal.
  /// The product viewer · normal is a factor of density(normal) too and is left out of both.
  [[nodiscard]] double reflected_density(const Vec3& direction) const {
    const Vec3 sum = to_viewer + direction;
    const double square = dot(sum, sum);
    if (!(square > 0 && sum.z > 0)) return 0;
    return distribution(sum / std::sqrt(square)) / (2 * (to_viewer.z + slope_length(to_viewer)));
  }

  /// Draws a normal (Dupuy and Benyoub 2023). Stretched by 1/α along z, the microfacets are a hemisphere, and
  /// the normals that a viewer sees of a hemisphere are the directions halfway to a uniform cap. The height
  /// in the cap is z = 1 − v (1 + s.z) for the stretched view s, and 1 − z² is computed as (1 − z)(1 + z).
  [[nodiscard]] DirectionAndDensity sample(double u, double v) const {
    const Vec3 stretched = normalize(Vec3{roughness * to_viewer.x, roughness * to_viewer.y, to_viewer.z});
    const double below = v * (1 + stretched.z);
    const double r = std::sqrt(below * (2 - below));
    const auto [sine, cosine] = sine_and_cosine(2 * std::numbers::pi * u);
    const Vec3 halfway = Vec3{r * cosine, r * sine, 1 - below} + stretched;
    const Vec3 normal = normalize(Vec3{roughness * halfway.x, roughness * halfway.y, halfway.z});
    return {normal, density(normal)};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

// A sphere as seen from a point: its solid angle, and directions to it that are uniform in solid angle.
#pragma once

#include <cmath>
#include <numbers>

#include "../numeric/precise_vector.hpp"
#include "light_sample.hpp"
#include "warp.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Directions from a point to a sphere. From outside they are a cap, the directions within an angle σ of
/// the center, with sin σ = R/d; from inside, all directions.
///
/// With s = (R/d)², the height of the cap is 1 − cos σ = s/(1 + √(1 − s)). 1 − s = (d² − R²)/d² is computed
/// in double-double, so it has digits also for a point close to the sphere. Relative errors are below 8u for
/// solid angles above 2^-1018; smaller ones lose digits, and the smallest count as 0.
class SphereView {
 public:
  /// Prepares the view from a point. The radius is not 0; a negative one counts as its magnitude.
  SphereView(const Point& from, const Point& center, double radius) {
    exponent_ = exponent_of({center - from, Vec3{radius, 0, 0}});
    const PreciseVector to_center = scaled_difference(center, from, -exponent_);
    const Vec3 scaled_radius = scaled({radius, 0, 0}, -exponent_);
    const DoubleDouble d2 = dot(to_center, to_center);
    const DoubleDouble r2 = two_product(scaled_radius.x, scaled_radius.x);
    gap_ = static_cast<double>(d2 - r2);
    distance_ = std::sqrt(d2.hi);
    is_outside_ = gap_ >= 0;
    // The squares of a distance below 2^-450 of the radius lose digits; there any directions will do.
    if (distance_ > 0x1p-450) frame_ = frame_around(to_center.rounded() / distance_);
    if (is_outside_) height_ = r2.hi / d2.hi / (1 + std::sqrt(gap_ / d2.hi));
  }

  /// Returns the solid angle in steradians: 2π (1 − cos σ), or 4π from inside.
  [[nodiscard]] double solid_angle() const {
    return is_outside_ ? 2 * std::numbers::pi * height_ : 4 * std::numbers::pi;
  }

  /// Draws a direction with two numbers from [0, 1). In the cap, its height 1 − cos θ is r² (1 − cos σ) for a
  /// point of the unit disk at distance r, since equal areas of a sphere have equal heights.
  ///
  /// Its distance is a root of t² − 2 d cos θ t + d² − R² = 0, from outside the near one, and from inside the
  /// positive one. With the height m of the cap, the discriminant R² − d² sin² θ is d² m (1 − r²)(2 − m (1 +
  /// r²)), a product of positive numbers.
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (!is_outside_) {
      const auto [local, density] = uniform_sphere(u, v);
      const double b = distance_ * local.z, root = std::sqrt(b * b - gap_);
      const double t = b > 0 ? b + root : -gap_ / (root - b);
      return {frame_(local), std::ldexp(t, exponent_), density};
    }
    const PolarPoint p = concentric_polar(u, v);
    const auto [sine, cosine] = sine_and_cosine(p.angle);
    const double share = p.radius * p.radius, height = share * height_, z = 1 - height;
    const double r = p.radius * std::sqrt(height_ * (2 - height));
    const double root = std::sqrt(height_ * (1 - p.radius) * (1 + p.radius) * (2 - height_ * (1 + share)));
    // On the cap's edge both roots are √(d² − R²); from the sphere itself z is 0 there.
    const double t = z + root > 0 ? gap_ / (distance_ * (z + root)) : std::sqrt(gap_);
    return {frame_({r * cosine, r * sine, z}), std::ldexp(t, exponent_), 1 / solid_angle()};
  }

 private:
  Frame frame_;
  double distance_ = 0;     // to the center; lengths are scaled by 2^-exponent_
  double gap_ = 0;          // d² − R²
  double height_ = 0;       // 1 − cos σ
  bool is_outside_ = true;  // or on the sphere, from where half of all directions lead to it
  int exponent_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

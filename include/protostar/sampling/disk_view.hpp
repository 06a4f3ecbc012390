// A disk as seen from a point: its solid angle, and directions to it that are uniform in solid angle.
//
// The point is at height h > 0 over the disk's plane, and the foot of its perpendicular at distance ρ from
// the center. The rim's nearest and farthest points are at distances l1 and l2, with l1² = (ρ − R)² + h² and
// l2² = (ρ + R)² + h². The directions to the rim are an elliptic cone. In the plane that contains the
// perpendicular and the center, its axis halves the angle 2b between those two points; across, its half angle
// is a ≥ b. With s = (ρ − R)(ρ + R) + h² = l1 l2 cos 2b, the cone's equation has the eigenvalues h² (across),
// λ = (l1 l2 + s)/2 = l1 l2 cos² b and −μ for μ = (l1 l2 − s)/2 = l1 l2 sin² b, where λμ = R² h². Hence
//   cos² a = h²/(h² + μ),   sin² a = μ/(h² + μ).
//
// A direction on the rim has the components sin a cos χ across and sin b sin χ along, and makes the angle θ
// with the axis, cos² θ = cos² a cos² χ + cos² b sin² χ. The solid angle between two χ is
//   sin a sin b ∫ dχ/(1 + cos θ),
// since it is ∫ (1 − cos θ) dφ with tan φ = (sin b/sin a) tan χ. The integrand is between 1/2 and 1 for every
// disk and every point. Its integral is elliptic, and so is computed by Gauss-Legendre quadrature with 12
// nodes, from 0 to a right angle in panels: the first has the width cos a/cos b, and each other one is as
// wide as all before it. The root cos θ is singular at tan χ = ±i cos a/cos b. As seen from a panel, mapped
// to [−1, 1], the singularity is on an ellipse with foci ±1 and semi-axes that add up to 4.6 (first panel) or
// more, so 24 powers of that bound the relative error of a quadrature, 2^-52.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "../numeric/precise_vector.hpp"
#include "../numeric/radians.hpp"
#include "light_sample.hpp"
#include "warp.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Returns ∫ f over [from, from + width] by the rule of Gauss and Legendre with 12 nodes.
[[nodiscard]] double gauss_legendre(const auto& f, double from, double width) {
  struct Pair {
    double node, weight;
  };
  static constexpr std::array<Pair, 6> pairs{{{0.12523340851146891547, 0.24914704581340278500},
                                              {0.36783149899818019375, 0.23349253653835480876},
                                              {0.58731795428661744730, 0.20316742672306592175},
                                              {0.76990267419430468704, 0.16007832854334622633},
                                              {0.90411725637047485668, 0.10693932599531843096},
                                              {0.98156063424671925069, 0.04717533638651182719}}};
  const double half = width / 2, middle = from + half;
  double sum = 0;
  for (const auto& [node, weight] : pairs)
    sum += weight * (f(middle - half * node) + f(middle + half * node));
  return sum * half;
}

}  // namespace detail

/// Directions from a point to a disk. The solid angle has a relative error below 2^-48 and directions are
/// off by at most 2^-47, if the distances from the plane and from the rim are above 2^-45 of those from the
/// center and of the radius. A point from which the solid angle is below 2^-900 counts as in the plane.
class DiskView {
 public:
  /// Prepares the view from a point. `any_normal` may have any length but 0; the radius is greater than 0.
  DiskView(const Point& from, const Point& center, const Vec3& any_normal, double radius) {
    exponent_ = exponent_of({center - from, Vec3{radius, 0, 0}});
    const PreciseVector to = scaled_difference(center, from, -exponent_);
    const double R = scaled({radius, 0, 0}, -exponent_).x;
    const Vec3 moderate = of_moderate_size(any_normal);
    const PreciseVector normal(moderate), across = cross(normal, to);
    const DoubleDouble size = length(normal), rho = length(across) / size, z = dot(to, normal) / size;
    const double h = std::abs(static_cast<double>(z)), near = static_cast<double>(rho - R),
                 far = static_cast<double>(rho + R);
    height_ = h, normal_ = (z.hi < 0 ? -1.0 : 1.0) * normalize(moderate);
    const LiftedPair l1(near, h);
    const double l1l2 = std::sqrt(l1.square * (far * far + h * h)) / l1.lift, s = near * far + h * h;
    farthest_ = std::sqrt(far * far + h * h);
    if (!(h > 0 && l1l2 > 0)) return;

    // Beside the disk, h² and μ have the factor h², which would underflow where the solid angle, about in
    // proportion to h, is far from that. There H = 2^-k h, about √h, stands for h in both, and their
    // quotients stay the same.
    const int k = s < 0 ? 0 : exponent_of({{h, 0, 0}}) / 2;
    const double H = scaled(h, -k), large = (l1l2 + std::abs(s)) / 2, small = R * H / large * (R * H);
    const double lambda = s < 0 ? small : large, mu = s < 0 ? large : small;
    const double whole = H * H + mu;
    cos2_a_ = H * H / whole, sin_a_ = std::sqrt(mu / whole);
    cos2_b_ = lambda / l1l2, sin_b_ = scaled(std::sqrt(mu / l1l2), k);

    // The axis: in the plane of `to` and the normal, (ρ h) sideways for h² + μ along the normal.
    const Frame frame = frame_around(normal_);
    // Closer to the disk's axis than 2^-75 h, `across` may be off by 2^-27, and any direction will do.
    const Vec3 crossed = of_moderate_size(across.rounded());
    x_ = rho.hi > 0x1p-75 * h ? crossed / length(crossed) : frame.x;  // across
    Vec3 outward = cross(x_, normal_);
    if (z.hi < 0) outward = -outward;
    const double sideways = static_cast<double>(rho) * H, upward = scaled(whole, k),
                 norm = std::sqrt(sideways * sideways + upward * upward);
    axis_ = (upward / norm) * normal_ + (sideways / norm) * outward;
    y_ = (upward / norm) * outward - (sideways / norm) * normal_;

    constexpr double right_angle = std::numbers::pi / 2;
    // A singularity nearer than 2^-60 changes the integral by less than that.
    for (double end = std::max(0x1p-60, std::sqrt(cos2_a_ / cos2_b_));; end *= 2) {
      const double width = std::min(end, right_angle) - end_[panels_];
      const double integral =
          detail::gauss_legendre([this](double chi) { return integrand(chi); }, end_[panels_], width);
      end_[panels_ + 1] = std::min(end, right_angle), sum_[panels_ + 1] = sum_[panels_] + integral;
      ++panels_;
      if (end >= right_angle) break;
    }
    const double solid_angle = 4 * sin_a_ * sin_b_ * sum_[panels_];
    if (solid_angle >= 0x1p-900) solid_angle_ = solid_angle;
  }

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] double solid_angle() const { return solid_angle_; }

  /// Draws a direction with two numbers from [0, 1). The concentric map takes them to a point of the unit
  /// disk. Its angle is the share of the integral over χ up to the direction, and the square of its radius
  /// the share of 1 − cos of the angle between axis and rim.
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (!(solid_angle_ > 0)) return {};
    const PolarPoint p = concentric_polar(u, v);
    constexpr double right_angle = std::numbers::pi / 2;
    const double quarters = std::floor(p.angle / right_angle);
    const double turn = std::clamp(p.angle / right_angle - quarters, 0.0, 1.0);
    // In every second quarter χ runs backward.
    const bool is_backward = static_cast<int>(quarters) % 2 != 0;
    const double chi = chi_of((is_backward ? 1 - turn : turn) * sum_[panels_]);
    auto [sine, cosine] = sine_and_cosine(chi);
    if (is_backward) cosine = -cosine;
    if (const int q = static_cast<int>(quarters) & 3; q >= 2) sine = -sine, cosine = -cosine;

    const double x = sin_a_ * cosine, y = sin_b_ * sine, sin2 = x * x + y * y, r2 = p.radius * p.radius;
    const double height = r2 * sin2 / (1 + root(sine));  // 1 − cos of the angle from the axis
    const double share = std::sqrt(height * (2 - height) / sin2);
    const Vec3 direction = (share * x) * x_ + (share * y) * y_ + (1 - height) * axis_;
    const double distance = detail::distance_to_plane(height_, dot(direction, normal_), farthest_);
    return {direction, std::ldexp(distance, exponent_), 1 / solid_angle_};
  }

 private:
  /// Returns cos θ on the rim.
  [[nodiscard]] double root(double sine) const {
    return std::sqrt(cos2_a_ * (1 - sine) * (1 + sine) + cos2_b_ * sine * sine);
  }
  [[nodiscard]] double integrand(double chi) const { return 1 / (1 + root(sine_and_cosine(chi).sine)); }

  /// Returns χ with the integral `share` from 0, by Newton's method in the panel that contains it. The
  /// integrand is monotonous and changes by less than a factor of 2, so each step at least halves the error;
  /// from 1/4 on the number of its digits doubles.
  [[nodiscard]] double chi_of(double share) const {
    int panel = 0;
    while (panel + 1 < static_cast<int>(panels_) && sum_[static_cast<std::size_t>(panel + 1)] < share)
      ++panel;
    const auto i = static_cast<std::size_t>(panel);
    const double begin = end_[i], end = end_[i + 1], rest = share - sum_[i];
    double chi = begin + (end - begin) * std::clamp(rest / (sum_[i + 1] - sum_[i]), 0.0, 1.0);
    for (int step = 0; step < 8; ++step) {
      const double before = chi;
      const double sum =
          detail::gauss_legendre([this](double x) { return integrand(x); }, begin, chi - begin);
      chi = std::clamp(chi + (rest - sum) / integrand(chi), begin, end);
      if (std::abs(chi - before) <= 0x1p-26 * chi) break;  // the next step would be below 2^-52
    }
    return chi;
  }

  Vec3 x_{1, 0, 0}, y_{0, 1, 0}, axis_{0, 0, 1}, normal_{0, 0, 1};
  double sin_a_ = 0, sin_b_ = 0, cos2_a_ = 1, cos2_b_ = 1;
  double height_ = 0, farthest_ = 0;  // scaled by 2^-exponent_
  std::array<double, 64> end_{}, sum_{};
  std::size_t panels_ = 0;
  double solid_angle_ = 0;
  int exponent_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI

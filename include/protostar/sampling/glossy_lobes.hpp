// Glossy lobes: reflection into directions around the mirror direction, blurred as on brushed metal or
// varnish.
//
// A lobe is given two local unit directions, with the surface's normal as their z axis: `view` to the viewer
// and `light` to where the light comes from. It has
//   value(view, light)        f, the radiance towards the viewer per irradiance by light from there; the same
//                             if both are exchanged
//   reflection(view, light)   f cos θ with the light's cosine: bounded at grazing angles, where f is not
//   density(view, light)      the probability per solid angle with which sample draws `light`; its integral
//                             over all directions is 1
//   sample(view, u, v)        a direction, its density, and its weight f cos θ/density
// No lobe reflects more light than arrives if its color is at most 1: the mean of its weights is at most 1.
// Directions may be drawn that lead into the surface; their weight is 0. Same bytes on every machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

#include "../vec3.hpp"
#include "warp.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Local direction that a lobe drew.
struct LobeSample {
  Vec3 direction{0, 0, 1};
  double density = 0;  ///< in 1/steradian
  Color weight{0};     ///< reflection/density; black if the direction leads into the surface
};

/// Type with the four functions of a glossy lobe.
template <class L>
concept GlossyLobe = requires(const L& lobe, const Vec3& view, const Vec3& light, double u) {
  { lobe.value(view, light) } -> std::same_as<Color>;
  { lobe.reflection(view, light) } -> std::same_as<Color>;
  { lobe.density(view, light) } -> std::same_as<double>;
  { lobe.sample(view, u, u) } -> std::same_as<LobeSample>;
};

namespace detail {

/// Returns light times a factor in double, clamped to the largest float.
[[nodiscard]] inline Color scaled_light(const Vec3& light, double factor) {
  return Color(within(light * factor, std::numeric_limits<float>::max()));
}

}  // namespace detail

/// Phong's lobe in the form that conserves energy (Lafortune and Willems 1994): f = color · (n + 2)/(2π) ·
/// cosⁿ α, where α is the angle between the light and the mirror direction of the view. At normal incidence
/// it reflects its color's share of the light, and less at grazing angles, where a part of the lobe is below
/// the horizon. Its numbers have a relative error of n 2^-51, as the cosine has one of 2^-51.
struct PhongLobe {
  Color color{1};
  double exponent = 50;  ///< n ≥ 0

  [[nodiscard]] Color value(const Vec3& view, const Vec3& light) const {
    return is_above(view, light) ? detail::scaled_light(color, gain() * density(view, light)) : Color{0};
  }

  [[nodiscard]] Color reflection(const Vec3& view, const Vec3& light) const {
    return is_above(view, light) ? detail::scaled_light(color, light.z * gain() * density(view, light))
                                 : Color{0};
  }

  [[nodiscard]] double density(const Vec3& view, const Vec3& light) const {
    return CosinePower{exponent}.density(dot(mirrored(view), light));
  }

  [[nodiscard]] LobeSample sample(const Vec3& view, double u, double v) const {
    const auto [around, probability] = CosinePower{exponent}.sample(u, v);
    const Vec3 light = frame_around(mirrored(view))(around);
    return {light, probability,
            is_above(view, light) ? detail::scaled_light(color, light.z * gain()) : Color{0}};
  }

 private:
  static Vec3 mirrored(const Vec3& view) { return {-view.x, -view.y, view.z}; }
  static bool is_above(const Vec3& view, const Vec3& light) { return view.z >= 0 && light.z > 0; }

  /// Returns f/density.
  [[nodiscard]] double gain() const { return (exponent + 2) / (exponent + 1); }
};

/// Lobe of a metal whose surface consists of tiny mirrors (microfacets), tilted at random by the distribution
/// of Trowbridge and Reitz (GGX): f = F D G/(4 cos θ_view cos θ_light). D is the distribution of the normal
/// halfway between view and light, G the share of mirrors there that both see (Smith, correlated by height:
/// Heitz 2014). F is what a mirror reflects, by Schlick's approximation color + (1 − color)(1 − cos)⁵ with
/// the cosine of the angle to the mirror's normal. Light that is reflected twice is not counted, so a rough
/// surface reflects less than its color: of light from everywhere 0.88 times as much for a roughness of 0.5,
/// and 0.41 times for 1.
struct GgxLobe {
  Color color{1};          ///< share of light that a microfacet reflects at normal incidence
  double roughness = 0.5;  ///< from 0, a mirror, to 1

  /// Least α. Half of such a lobe lies within 2·10^-6 radians, about a thousandth of a pixel, but it is far
  /// wider than the error of a direction, 2^-51, so a mirror needs no formulas of its own.
  static constexpr double least_width = 0x1p-20;

  /// Returns α, the width of the distribution of slopes: the square of the roughness, which looks as if it
  /// grew evenly from 0 to 1 (Burley 2012).
  [[nodiscard]] double width() const { return std::max(roughness * roughness, least_width); }

  /// Returns what a mirror reflects, by the cosine of the angle to its normal.
  [[nodiscard]] Color reflectance(double cosine) const { return Color(fresnel(cosine)); }

  [[nodiscard]] Color value(const Vec3& view, const Vec3& light) const {
    const double factor = projected(view, light) / light.z;
    return factor > 0 ? detail::scaled_light(fresnel(cosine_of_half(view, light)), std::min(factor, 0x1p500))
                      : Color{0};
  }

  [[nodiscard]] Color reflection(const Vec3& view, const Vec3& light) const {
    return detail::scaled_light(fresnel(cosine_of_half(view, light)), projected(view, light));
  }

  [[nodiscard]] double density(const Vec3& view, const Vec3& light) const {
    return view.z >= 0 ? normals(view).reflected_density(light) : 0;
  }

  /// Draws a mirror that the viewer sees, and returns the direction in which it reflects. The weight is F
  /// G/G1: the share of those mirrors that the light sees as well.
  [[nodiscard]] LobeSample sample(const Vec3& view, double u, double v) const {
    if (!(view.z >= 0)) return {};
    const VisibleNormals all = normals(view);
    const Vec3 normal = all.sample(u, v).direction;
    const double cosine = dot(view, normal);
    const Vec3 light = normalize(2 * cosine * normal - view);
    LobeSample sample{light, all.distribution(normal) / (2 * (view.z + all.slope_length(view)))};
    if (light.z > 0)
      sample.weight =
          detail::scaled_light(fresnel(cosine), (view.z + all.slope_length(view)) / both(all, light));
    return sample;
  }

 private:
  [[nodiscard]] VisibleNormals normals(const Vec3& view) const { return {view, width()}; }

  /// Returns √(cos² + α² sin²) of the view and that of the light times the ratio of their cosines: the
  /// denominator 2 cos θ_view/G. It is at least α, also at grazing angles.
  static double both(const VisibleNormals& all, const Vec3& light) {
    return all.slope_length(all.to_viewer) + all.to_viewer.z / light.z * all.slope_length(light);
  }

  /// Returns D G/(4 cos θ_view), or 0 if view or light is below the surface.
  [[nodiscard]] double projected(const Vec3& view, const Vec3& light) const {
    const Vec3 sum = view + light;
    const double square = dot(sum, sum);
    if (!(view.z >= 0 && light.z > 0 && square > 0)) return 0;
    const VisibleNormals all = normals(view);
    return all.distribution(sum / std::sqrt(square)) / (2 * both(all, light));
  }

  /// Returns the cosine of half of the angle between view and light.
  static double cosine_of_half(const Vec3& view, const Vec3& light) {
    return std::min(length(view + light) / 2, 1.0);
  }

  [[nodiscard]] Vec3 fresnel(double cosine) const {
    const double rest = std::clamp(1 - cosine, 0.0, 1.0), square = rest * rest;
    return Vec3(color) + (1.0 - Vec3(color)) * (square * square * rest);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

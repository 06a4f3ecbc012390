// Reference pictures of spheres on a plane under a point light, seen from the origin with a field of view of
// 90°, as exact as those of pictures.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry.hpp"

namespace reference {

/// Plane n·x = distance, for the unit vector n along normal. The origin is above it, hence the distance is
/// negative, and so is the light, hence the plane casts no shadow on visible points.
struct Ground {
  Whole normal;
  Real distance = -1;
  Vector color;

  [[nodiscard]] Vector unit_normal() const { return 1 / length(normal.real()) * normal.real(); }

  /// Returns t of the crossing of a ray from the origin, n·(t d) = distance, or nothing if it does not lead
  /// down.
  [[nodiscard]] std::optional<Real> crossing(Whole d) const {
    const std::int64_t down = -dot(normal, d);
    if (down <= 0) return std::nullopt;
    return -distance * length(normal.real()) / static_cast<Real>(down);
  }
};

struct SpheresOnGround {
  std::vector<Sphere> spheres;
  Ground ground;
  Vector light, power, sky;

  /// Colors of a ray for each of the integrators.
  struct Seen {
    Vector binary = {}, depth = {}, normal = {}, color, diffuse, transparency, shadow;
    const Sphere* sphere = nullptr;  ///< visible sphere, or none
  };

  [[nodiscard]] Seen along(Whole ray) const {
    Seen seen{.color = sky, .diffuse = sky, .transparency = sky, .shadow = sky};
    bool any = false;
    Real t = 0;
    for (const Sphere& sphere : spheres) {
      const auto crossed = crossings(ray, sphere);
      if (!crossed) continue;
      seen.transparency = seen.transparency * sphere.color * sphere.color;  // entering and leaving
      if (any && !is_less(crossed->near, t, t)) continue;
      any = true;
      t = crossed->near;
      seen.sphere = &sphere;
    }
    if (const auto crossed = ground.crossing(ray)) {
      seen.transparency = seen.transparency * ground.color;
      if (!any || is_less(*crossed, t, t)) {
        any = true;
        t = *crossed;
        seen.sphere = nullptr;
      }
    }
    if (!any) return seen;

    const Vector white{1, 1, 1}, point = t * ray.real();
    const Vector normal =
        seen.sphere ? 1 / seen.sphere->radius() * (point - seen.sphere->center()) : ground.unit_normal();
    seen.binary = white;
    seen.depth = 1 / length(point) * white;
    seen.normal = 0.5L * (normal + white);
    seen.color = seen.sphere ? seen.sphere->color : ground.color;
    // color · Φ/(4π) · cos θ / distance², with cos θ = n·l/|l| and distance = |l|.
    const Vector l = light - point;
    const Real cosine = std::max<Real>(dot(normal, l) / length(l), 0);
    seen.diffuse = cosine / (4 * std::numbers::pi_v<Real> * dot(l, l)) * (seen.color * power);
    const bool hidden = std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
      return &sphere == seen.sphere ? is_between_from_surface(sphere, point, light)
                                    : is_between(sphere, point, light);
    });
    seen.shadow = hidden ? Vector{} : seen.diffuse;
    return seen;
  }
};

/// Integrators by name.
inline const std::array<std::pair<std::string, Vector SpheresOnGround::Seen::*>, 7> lights_along{{
    {"binary", &SpheresOnGround::Seen::binary},
    {"depth", &SpheresOnGround::Seen::depth},
    {"normal", &SpheresOnGround::Seen::normal},
    {"color", &SpheresOnGround::Seen::color},
    {"diffuse", &SpheresOnGround::Seen::diffuse},
    {"transparency", &SpheresOnGround::Seen::transparency},
    {"shadow", &SpheresOnGround::Seen::shadow},
}};

/// Returns 255 times the piecewise curve of sRGB, rounded to nearest.
inline std::uint8_t encode_srgb(Real x) {
  const Real light = std::clamp<Real>(x, 0, 1);
  const Real code = light <= 0.0031308L ? 12.92L * light : 1.055L * std::pow(light, 1 / 2.4L) - 0.055L;
  return static_cast<std::uint8_t>(std::lround(255 * code));
}

}  // namespace reference

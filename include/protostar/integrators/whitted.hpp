// Light, shadows, mirrors and glass: Whitted's picture, by rays that follow rays.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "../numeric/power.hpp"
#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// d, seen in a mirror with this unit normal.
[[nodiscard]] inline Vec3 reflected(const Vec3& d, const Vec3& normal) {
  return d - 2 * dot(normal, d) * normal;
}

/// The unit direction d after it has passed a surface whose unit normal faces it (n·d ≤ 0), by Snell's law:
/// the sine of its angle to the normal is ratio times as large as before, ratio being the index of refraction
/// before the surface over that behind it. Nothing if there is no such angle: all light is reflected.
[[nodiscard]] inline std::optional<Vec3> refracted(const Vec3& d, const Vec3& normal, double ratio) {
  const double cosine = -dot(normal, d);
  const double square = 1 - ratio * ratio * (1 - cosine * cosine);  // of the cosine behind the surface
  if (!(square >= 0)) return std::nullopt;
  return ratio * d + (ratio * cosine - std::sqrt(square)) * normal;
}

/// The light of Material's equation: what the lights that a point can see bring to it, and what the mirror
/// direction and the refracted direction see, by rays of their own (Whitted 1980, "An Improved Illumination
/// Model for Shaded Display"). The sky, or black, where there is nothing.
struct WhittedIntegrator {
  int depth = 10;  ///< the most rays in one path; 1 is the camera's alone. A path that is cut sees the sky

  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    return follow(ray, scene, depth);
  }

 private:
  /// What a ray brings, and so many rays at the most, this one among them.
  [[nodiscard]] Color follow(const Ray& ray, const auto& scene, int rays) const {
    const auto hit = rays > 0 ? first_hit(ray, scene) : std::nullopt;
    if (!hit) return sky_of(scene, Color{0});

    const Material& material = hit->material();
    const Vec3 direction = normalize(ray.direction);
    const Vec3 outside = hit->normal();
    const bool enters = dot(outside, direction) <= 0;
    const Vec3 normal = enters ? outside : -outside;

    const Vec3 mirrored = reflected(direction, normal);
    Color result = from_lights(*hit, normal, mirrored, scene);
    if (material.reflect > 0)
      result += static_cast<float>(material.reflect) * follow(hit->leave(mirrored), scene, rays - 1);
    if (material.refract > 0)
      if (const auto d = refracted(direction, normal, enters ? 1 / material.ior : material.ior))
        result += static_cast<float>(material.refract) * follow(hit->leave(*d), scene, rays - 1);
    return result;
  }

  // What a path needs only for a moment is kept in functions of its own, and not on the stack for each ray.

  [[nodiscard, gnu::noinline]] static std::optional<Intersection> first_hit(const Ray& ray,
                                                                            const auto& scene) {
    return scene.intersect(ray, Interval{});
  }

  /// What comes from the lights. That the mirror image of the direction to the light is near the direction to
  /// the eye is to say that the direction to the light is near mirrored, the mirror image of the other.
  [[nodiscard, gnu::noinline]] Color from_lights(const Intersection& hit, const Vec3& normal,
                                                 const Vec3& mirrored, const auto& scene) const {
    const Color color = hit.color(), specular = hit.material().specular;
    if (color == Color{0} && specular == Color{0}) return Color{0};  // no light can be seen here

    const Point point = hit.point();
    Color result = color * ambient_of(scene);
    for (const Light& light : scene.lights()) {
      const Vec3 to_light = light.towards(point);
      if (!(dot(normal, to_light) > 0)) continue;  // it is behind the surface
      Color sent = color * light.irradiance(point, normal);
      if (specular != Color{0})
        if (const float share = lobe(dot(mirrored, to_light) / length(to_light), hit.material().shininess);
            share > 0)
          sent += specular * light.perpendicular_irradiance(point) * share;
      // What adds nothing needs no shadow ray.
      if (sent != Color{0} && !scene.occluded(hit.leave(to_light), light.way())) result += sent;
    }
    return result;
  }

  /// cos^shininess; 0 where the cosine is not positive.
  [[nodiscard]] static float lobe(double cosine, double shininess) {
    // Below 2^-150 it is 0 as a float. It is at most e^(−shininess · (1 − cos)), since ln cos ≤ cos − 1.
    if (!(cosine > 0) || shininess * (1 - cosine) > 150 * std::numbers::ln2) return 0;
    if (shininess == 0) return 1;
    constexpr double normal_least = std::numeric_limits<double>::min();  // pow takes no less
    return static_cast<float>(static_cast<double>(
        pow(DoubleDouble(std::clamp(cosine, normal_least, 1.0)), DoubleDouble(shininess))));
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

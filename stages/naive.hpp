// Traces rays the tutorial's own way, in float and with an offset, for comparison in 08_naive and 09_naive
// (§2.3.2).
//
// Nothing here is part of the library. It is the code that one writes first, and it is almost right: each
// function follows the formula of its section. docs/numerics.md says what goes wrong, and why no offset
// helps.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "scenes/three_spheres.hpp"

namespace naive {

using Vec = glm::vec3;
using protostar::Color;

struct Ray {
  Vec origin, direction;  // the direction is a unit vector, or nearly

  Ray(const Vec& from, const Vec& towards) : origin(from), direction(towards) {}
  explicit Ray(const protostar::Ray& ray) : origin(ray.origin), direction(ray.direction) {}
};

struct Sphere {
  Vec center;
  float radius;
  Color color;

  /// Returns the smaller of b ± √(b² − c) that is greater than 0 (§2.2.4). Both the difference under the root
  /// and b minus the root cancel: their leading digits vanish, and the rounding errors of b² and c remain.
  std::optional<float> intersect(const Ray& ray) const {
    const Vec l = center - ray.origin;
    const float b = dot(ray.direction, l), c = dot(l, l) - radius * radius;
    const float D = b * b - c;
    if (!(D > 0)) return std::nullopt;
    const float root = std::sqrt(D);
    if (b - root > 0) return b - root;
    if (b + root > 0) return b + root;
    return std::nullopt;
  }
};

struct Hit {
  Vec point, normal;  // the normal faces the ray's origin
  Color color;
};

inline const std::array<Sphere, 3> spheres = [] {
  std::array<Sphere, 3> copies;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const auto& [sphere, color] = the_three_spheres[i];
    copies[i] = {Vec(sphere.center), static_cast<float>(sphere.radius), color};
  }
  return copies;
}();

inline std::optional<Hit> closest_hit(const Ray& ray) {
  const Sphere* closest = nullptr;
  float t_max = std::numeric_limits<float>::infinity();
  for (const Sphere& sphere : spheres)
    if (const auto t = sphere.intersect(ray); t && *t < t_max) {
      t_max = *t;
      closest = &sphere;
    }
  if (!closest) return std::nullopt;
  const Vec point = ray.origin + t_max * ray.direction;
  const Vec normal = (point - closest->center) / closest->radius;
  return Hit{point, dot(normal, ray.direction) <= 0 ? normal : -normal, closest->color};
}

/// Listener to the rays of a pixel, which hears nothing.
struct Silent {
  void operator()(const auto&...) const {}
};

/// Returns light through colored glass: the ray starts again behind every hit, pushed through the surface by
/// the offset (Figs. 16, 19). Ten hits are the tutorial's limit; three spheres have six at most, so more are
/// failures of the offset.
template <class Listener = Silent>
Color transparency(Ray ray, float offset, const Listener& tell = {}) {
  Color light{1};
  for (int i = 0; i < 10; ++i) {
    const auto hit = closest_hit(ray);
    tell(ray, hit);
    if (!hit) break;
    light *= hit->color;
    ray.origin = hit->point - offset * hit->normal;
  }
  return light;
}

/// Returns diffuse light with shadows: the shadow ray starts above the surface by the offset (Fig. 20), and
/// ends before the light by as much.
template <class Listener = Silent>
Color shadow(const Ray& ray, float offset, const Listener& tell = {}) {
  const auto hit = closest_hit(ray);
  tell(ray, hit);
  if (!hit) return Color{0};
  const Vec light = light_of_the_three_spheres.position;
  const Vec to_light = light - hit->point;
  const float distance = length(to_light), cosine = dot(hit->normal, to_light) / distance;
  if (!(cosine > 0)) return Color{0};
  const Ray shadow_ray{hit->point + offset * hit->normal, to_light / distance};
  tell(shadow_ray, distance - offset);
  for (const Sphere& sphere : spheres)
    if (const auto t = sphere.intersect(shadow_ray); t && *t < distance - offset) return Color{0};
  const float intensity = 1 / (4 * std::numbers::pi_v<float>);
  return hit->color * light_of_the_three_spheres.power * (intensity * cosine / (distance * distance));
}

}  // namespace naive

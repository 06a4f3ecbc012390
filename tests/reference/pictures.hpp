// Reference pictures of stages 01 to 09, as exact arithmetic gives them, to compare the golden pictures with.
//
// Every picture is a function from the pixel's ray to linear light, which is encoded at the end. Decisions
// are exact (geometry.hpp); light has an error of less than 1e-16, and codes are 255 levels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "../compare_images/picture.hpp"
#include "geometry.hpp"

namespace reference {

// The tutorial's scene. Colors and the light's power are floats in the library, hence these floats here.
inline const std::vector<Sphere> three_spheres{
    {.center_parts = {0, 0, 6}, .radius_parts = 2, .color = {1, 0.3f, 0}},
    {.center_parts = {-3, 0, 10}, .radius_parts = 2, .color = {0.2f, 0.7f, 0.1f}},
    {.center_parts = {0, -2002, 6}, .radius_parts = 2000, .color = {0.2f, 0.4f, 0.8f}}};
inline const std::vector<Sphere> one_sphere{three_spheres.front()};
inline const Vector light{0, 3, 0};
inline const Real pi = std::numbers::pi_v<Real>;
inline const Real power = 4 * std::numbers::pi_v<float> * 10;

/// Closest hit of a ray: the sphere and the point.
struct Seen {
  const Sphere* sphere = nullptr;
  Vector point;
};

/// Returns the closest hit. The camera is outside of every sphere, so it is a near crossing, and the outward
/// normal is on the camera's side.
inline std::optional<Seen> first(Whole direction, const std::vector<Sphere>& spheres) {
  const Sphere* nearest = nullptr;
  Real t = 0;
  for (const Sphere& sphere : spheres) {
    const auto crossed = crossings(direction, sphere);
    if (!crossed || (nearest && !is_less(crossed->near, t, t))) continue;
    nearest = &sphere;
    t = crossed->near;
  }
  if (!nearest) return std::nullopt;
  return Seen{nearest, t * direction.real()};
}

inline Vector normal(const Seen& seen) {
  return 1 / seen.sphere->radius() * (seen.point - seen.sphere->center());
}

/// Returns color · Φ/(4π) · cos θ / distance², with cos θ = n·l/|l| and distance = |l|.
inline Vector lit(const Seen& seen) {
  const Vector l = light - seen.point;
  const Real cosine = dot(normal(seen), l) / length(l);
  const Real irradiance = std::max<Real>(cosine, 0) / dot(l, l) * power / (4 * pi);
  return irradiance * seen.sphere->color;
}

/// Returns true if any sphere hides the light, the point's own included.
inline bool in_shadow(const Seen& seen) {
  return std::any_of(three_spheres.begin(), three_spheres.end(), [&](const Sphere& sphere) {
    return &sphere == seen.sphere ? is_between_from_surface(sphere, seen.point, light)
                                  : is_between(sphere, seen.point, light);
  });
}

// ---- The pictures, as functions from a ray to linear light.

inline Vector sphere_alone(Whole ray) { return first(ray, one_sphere) ? Vector{1, 1, 1} : Vector{}; }

inline Vector binary(Whole ray) { return first(ray, three_spheres) ? Vector{1, 1, 1} : Vector{}; }

inline Vector depth(Whole ray) {
  const auto seen = first(ray, three_spheres);
  return seen ? 1 / length(seen->point) * Vector{1, 1, 1} : Vector{};
}

inline Vector normals(Whole ray) {
  const auto seen = first(ray, three_spheres);
  return seen ? 0.5L * normal(*seen) + Vector{0.5L, 0.5L, 0.5L} : Vector{};
}

inline Vector flat_color(Whole ray) {
  const auto seen = first(ray, three_spheres);
  return seen ? seen->sphere->color : Vector{};
}

inline Vector diffuse(Whole ray) {
  const auto seen = first(ray, three_spheres);
  return seen ? lit(*seen) : Vector{};
}

inline Vector transparency(Whole ray) {
  Vector product{1, 1, 1};
  for (const Sphere& sphere : three_spheres)
    if (crossings(ray, sphere))  // entering and leaving, also if both are one point
      product = product * sphere.color * sphere.color;
  return product;
}

inline Vector shadow(Whole ray) {
  const auto seen = first(ray, three_spheres);
  return seen && !in_shadow(*seen) ? lit(*seen) : Vector{};
}

// ---- From light to the bytes of a file.

/// Returns 255 · x^(1/gamma), rounded to nearest.
inline std::uint8_t encode(Real x, Real gamma) {
  return static_cast<std::uint8_t>(std::lround(255 * std::pow(std::clamp<Real>(x, 0, 1), 1 / gamma)));
}

inline Picture picture(int width, int height, Vector (*light_along)(Whole), Real gamma = 2.2L) {
  Picture result{width, height, {}};
  result.pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vector seen = light_along(through_pixel(x, y, width, height));
      result.pixels.push_back({encode(seen.x, gamma), encode(seen.y, gamma), encode(seen.z, gamma)});
    }
  return result;
}

/// Returns the picture of §2.2.2: x/(width − 1), not encoded.
inline Picture gradient(int width, int height) {
  Picture result{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t code = encode(static_cast<Real>(x) / static_cast<Real>(width - 1), 1);
      result.pixels.push_back({code, code, code});
    }
  return result;
}

}  // namespace reference

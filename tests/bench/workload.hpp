// Scenes of many spheres, cameras that look at them, and their acceleration.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <numbers>
#include <protostar/camera.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/random.hpp"

#if __has_include(<protostar/accel/accelerate.hpp>)
#include <protostar/accel/accelerate.hpp>
#endif

namespace bench {

#if __has_include(<protostar/accel/accelerate.hpp>)
inline constexpr bool is_accelerated = true;
inline auto traced(const protostar::Scene<protostar::Sphere>& scene, int threads) {
  return protostar::accelerate(scene, {.threads = threads});
}
#else
inline constexpr bool is_accelerated = false;
inline const auto& traced(const protostar::Scene<protostar::Sphere>& scene, int) { return scene; }
#endif

/// Sphere of numbers that float holds, laid out as Embree reads it.
struct FloatSphere {
  glm::vec3 center;
  float radius;
};

struct Workload {
  std::vector<FloatSphere> spheres;
  protostar::Camera camera;
  protostar::PointLight light;
  glm::vec3 corner, size;  ///< box in which incoherent rays start
};

/// Returns count spheres: the tutorial's scene for 3, otherwise random ones in the unit cube. Seen along an
/// axis, their discs cover 2 · 13/12 times the cube's face at any count: π Σ r², where r² = (½ + x)² · 2/(πn)
/// with x uniform in [0, 1) has the mean 13/12 · 2/(πn).
inline Workload workload(std::size_t count) {
  Workload work;
  if (count == 3) {
    for (const auto& [sphere, color] : the_three_spheres)
      work.spheres.push_back({glm::vec3(sphere.center), static_cast<float>(sphere.radius)});
    work.light = light_of_the_three_spheres;
    work.corner = {-3, -0.9f, 0};
    work.size = {6, 4, 6};
    return work;
  }
  Random random(count);
  const double unit = std::sqrt(2 / (std::numbers::pi * static_cast<double>(count)));
  work.spheres.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 center(random.point(0.5) + 0.5);
    work.spheres.push_back({center, static_cast<float>(unit * random.real(0.5, 1.5))});
  }
  work.camera = {.position = {0.5, 0.5, -1.2}, .forward = {0, 0, 2}};
  work.light = {.position = {0.3, 2, -1.5}, .power = protostar::Color{100}};
  work.corner = glm::vec3(0);
  work.size = glm::vec3(1);
  return work;
}

/// Returns a workload as a scene. A sphere's red is its index, so that a picture tells which spheres are
/// visible.
inline protostar::Scene<protostar::Sphere> scene_of(const Workload& work) {
  protostar::Scene<protostar::Sphere> scene;
  float index = 0;  // exact up to 2^24
  for (const FloatSphere& sphere : work.spheres)
    scene.add(protostar::Sphere{protostar::Point(sphere.center), sphere.radius}, {index++, 1, 1});
  scene.add(work.light);
  return scene;
}

}  // namespace bench

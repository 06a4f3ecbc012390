// The tutorial's scene (§2.3.1): three spheres, the largest of them the ground, under one point light.
#pragma once

#include <array>
#include <numbers>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>

struct ColoredSphere {
  protostar::Sphere sphere;
  protostar::Color color;
};

inline const std::array<ColoredSphere, 3> the_three_spheres{{
    {{.center = {0, 0, 3}, .radius = 1}, {1, 0.3f, 0}},
    {{.center = {-1.5, 0, 5}, .radius = 1}, {0.2f, 0.7f, 0.1f}},
    {{.center = {0, -1001, 3}, .radius = 1000}, {0.2f, 0.4f, 0.8f}},
}};

inline const protostar::PointLight light_of_the_three_spheres{
    .position = {0, 3, 0}, .power = protostar::Color{4 * std::numbers::pi_v<float> * 10}};

/// Builds the scene, of spheres or of a surface type that holds them, such as AnySurface.
template <protostar::Surface S = protostar::Sphere>
protostar::Scene<S> three_spheres() {
  protostar::Scene<S> scene;
  for (const auto& [sphere, color] : the_three_spheres) scene.add(sphere, color);
  scene.add(light_of_the_three_spheres);
  return scene;
}

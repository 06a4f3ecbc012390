// The tutorial's scene (§2.3.1): three spheres, the largest of them the ground, under one point light.
#pragma once

#include <numbers>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>

/// Builds the scene, of spheres or of a surface type that holds them, such as AnySurface.
template <protostar::Surface S = protostar::Sphere>
protostar::Scene<S> three_spheres() {
  using namespace protostar;
  Scene<S> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1, 0.3f, 0});
  scene.add(Sphere{.center = {-1.5, 0, 5}, .radius = 1}, Color{0.2f, 0.7f, 0.1f});
  scene.add(Sphere{.center = {0, -1001, 3}, .radius = 1000}, Color{0.2f, 0.4f, 0.8f});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{4 * std::numbers::pi_v<float> * 10}});
  return scene;
}

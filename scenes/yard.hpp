// A yard between a wall and a red fence: a ball under a roof, stairs, and two balls in the open. Most light
// under the roof has come there from other surfaces.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/camera.hpp>
#include <protostar/surfaces/box.hpp>

/// Builds the yard, without any light.
inline protostar::AnyScene yard() {
  using protostar::Box;
  using protostar::Color;
  using protostar::Plane;
  using protostar::Sphere;
  protostar::AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{0.7f});
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 4}, Color{0.7f});
  scene.add(Box{.min = {-4.5, 0, -1}, .max = {-4, 3, 4}}, Color{0.8f, 0.15f, 0.05f});
  scene.add(Box{.min = {-4, 2.5, 1}, .max = {-0.5, 2.75, 4}}, Color{0.7f});
  scene.add(Box{.min = {-0.75, 0, 1}, .max = {-0.5, 2.5, 1.25}}, Color{0.7f});
  scene.add(Box{.min = {1.5, 0, 1}, .max = {4.5, 0.5, 4}}, Color{0.7f});
  scene.add(Box{.min = {1.5, 0.5, 1.75}, .max = {4.5, 1, 4}}, Color{0.7f});
  scene.add(Box{.min = {1.5, 1, 2.5}, .max = {4.5, 1.5, 4}}, Color{0.7f});
  scene.add(Sphere{.center = {-2.25, 0.75, 2.25}, .radius = 0.75}, Color{0.8f});
  scene.add(Sphere{.center = {0.75, 0.5, -0.75}, .radius = 0.5}, Color{0.2f, 0.6f, 0.2f});
  scene.add(Sphere{.center = {3, 0.875, 1.375}, .radius = 0.375}, Color{0.2f, 0.3f, 0.8f});
  return scene;
}

/// Builds the yard at dusk: under a dark blue sky, with a lantern that is a sphere.
inline protostar::AnyScene yard_at_dusk() {
  using protostar::Color;
  auto scene = yard();
  scene.add(protostar::Sphere{.center = {2.5, 4, 0}, .radius = 0.5},
            protostar::Material{.diffuse = Color{0}, .emission = Color{60, 50, 36}});
  scene.set_sky({0.1f, 0.15f, 0.3f});
  return scene;
}

/// The camera that looks into the yard, over its open side.
inline protostar::Camera camera_of_yard() {
  return protostar::Camera::perspective({0, 4, -9}, {0, -7, 24}, {0, 24, 7}, 40);
}

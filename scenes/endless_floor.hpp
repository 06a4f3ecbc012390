// Three balls on a floor of squares that reaches the horizon, under a lamp that is almost as far away as a
// sun.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/camera.hpp>

/// Builds the scene, of the types of stage 14, whose pictures are compiled once. The squares have sides of
/// length 1.
inline protostar::AnyScene endless_floor() {
  using protostar::Color;
  protostar::AnyScene scene;
  scene.add(protostar::Plane{.normal = {0, 1, 0}, .distance = 0},
            protostar::Material{.texture = protostar::Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  scene.add(protostar::Sphere{.center = {0.5, 2, 5}, .radius = 2}, Color{1, 0.3f, 0});
  scene.add(protostar::Sphere{.center = {-5, 2, 9}, .radius = 2}, Color{0.2f, 0.7f, 0.1f});
  scene.add(protostar::Sphere{.center = {6, 2, 12}, .radius = 2}, Color{0.2f, 0.4f, 0.8f});
  scene.add(protostar::PointLight{.position = {-300, 500, -200}, .power = Color{4e6f}});
  scene.add(protostar::AmbientLight{Color{0.15f}});
  scene.set_sky({0.3f, 0.5f, 0.8f});
  return scene;
}

/// The camera that looks at them, down at an angle of 16°, so that the horizon is in the picture.
inline protostar::Camera camera_of_endless_floor() {
  return protostar::Camera::perspective({0, 6, -8}, {0, -7, 24}, {0, 24, 7}, 50);
}

// A large lamp and a small one, which throw soft shadows of two balls and a post.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/camera.hpp>
#include <protostar/surfaces/box.hpp>

/// Builds the scene. The lamps are spheres that emit light: the large one at the left is warm, and the small
/// one at the right, whose surface is much brighter, is cold.
inline protostar::AnyScene two_lamps() {
  using protostar::Color;
  using protostar::Material;
  protostar::AnyScene scene;
  scene.add(protostar::Plane{.normal = {0, 1, 0}, .distance = 0}, Color{0.7f});
  scene.add(protostar::Plane{.normal = {0, 0, 1}, .distance = 5}, Color{0.7f});
  scene.add(protostar::Box{.min = {-0.25, 0, 1}, .max = {0.25, 2, 1.5}}, Color{0.3f, 0.8f, 0.2f});
  scene.add(protostar::Sphere{.center = {0.75, 0.75, -1.5}, .radius = 0.5}, Color{1, 0.4f, 0.1f});
  scene.add(protostar::Sphere{.center = {-1.75, 0.5, -0.5}, .radius = 0.5}, Color{0.3f, 0.5f, 0.9f});
  scene.add(protostar::Sphere{.center = {-3, 2.25, 1}, .radius = 0.75},
            Material{.diffuse = Color{0}, .emission = Color{20, 15, 11}});
  scene.add(protostar::Sphere{.center = {3.25, 2.75, 0.5}, .radius = 0.125},
            Material{.diffuse = Color{0}, .emission = Color{400, 480, 600}});
  scene.add(protostar::AmbientLight{Color{0.15f}});
  return scene;
}

/// The camera that looks down at them.
inline protostar::Camera camera_of_two_lamps() {
  return protostar::Camera::perspective({0, 6, -8}, {0, -3, 4}, {0, 4, 3}, 45);
}

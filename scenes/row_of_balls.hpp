// A row of balls that leads away from the viewer over a floor of squares.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/camera.hpp>

/// Distance along the camera's direction of the middle of the third ball of row_of_balls.
inline constexpr double third_ball = 10;

/// Builds the scene, of the types of stage 14, whose pictures are compiled once. The squares have sides of
/// length 1.
inline protostar::AnyScene row_of_balls() {
  using protostar::Color;
  protostar::AnyScene scene;
  scene.add(protostar::Plane{.normal = {0, 1, 0}, .distance = 0},
            protostar::Material{.texture = protostar::Checker{.first = Color{0.7f}, .second = Color{0.25f}}});
  scene.add(protostar::Sphere{.center = {-1.5, 1, 4}, .radius = 1}, Color{0.9f, 0.2f, 0.1f});
  scene.add(protostar::Sphere{.center = {-0.25, 1, 7}, .radius = 1}, Color{0.9f, 0.6f, 0.1f});
  scene.add(protostar::Sphere{.center = {1, 1, third_ball}, .radius = 1}, Color{0.3f, 0.7f, 0.2f});
  scene.add(protostar::Sphere{.center = {3, 1, 15}, .radius = 1}, Color{0.1f, 0.5f, 0.8f});
  scene.add(protostar::Sphere{.center = {6, 1, 22}, .radius = 1}, Color{0.5f, 0.3f, 0.8f});
  scene.add(protostar::PointLight{.position = {-300, 500, -200}, .power = Color{4e6f}});
  scene.add(protostar::AmbientLight{Color{0.15f}});
  scene.set_sky({0.3f, 0.5f, 0.8f});
  return scene;
}

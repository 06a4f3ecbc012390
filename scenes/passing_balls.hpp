// Balls that pass a standing one on a floor of squares, at different speeds.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/camera.hpp>
#include <protostar/surfaces/moving.hpp>

/// Builds the scene, of the types of stage 14, whose pictures are compiled once. Balls move from time 0 to 1.
inline protostar::AnyScene passing_balls() {
  using namespace protostar;
  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0},
            Material{.texture = Checker{.first = Color{0.7f}, .second = Color{0.25f}}});
  scene.add(Sphere{.center = {-2.5, 1, 8}, .radius = 1}, Color{0.9f, 0.2f, 0.1f});
  const auto add = [&](const Point& center, const Vec3& velocity, const Color& color) {
    scene.add(Moving<Sphere>({.center = center, .radius = 1}, velocity), color);
  };
  add({0, 1, 8}, {0.5, 0, 0}, Color{0.9f, 0.6f, 0.1f});
  add({2.5, 1, 8}, {2, 0, 0}, Color{0.3f, 0.7f, 0.2f});
  add({-1.5, 3.25, 10}, {0, -1.25, 0}, Color{0.1f, 0.5f, 0.8f});
  scene.add(PointLight{.position = {-300, 500, -200}, .power = Color{4e6f}});
  scene.add(AmbientLight{Color{0.15f}});
  scene.set_sky({0.3f, 0.5f, 0.8f});
  return scene;
}

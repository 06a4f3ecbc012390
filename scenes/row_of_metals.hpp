// A row of metal balls, from a mirror to a rough one, below a large lamp and a small one.
#pragma once

#include <protostar/camera.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>

/// Builds the scene, of the surfaces of stage 25, whose pictures are compiled once. The roughness grows from
/// 0 by a quarter from ball to ball. The small lamp sends out nearly as much light as the large one.
inline protostar::Scene<protostar::Sphere, protostar::Parallelogram> row_of_metals() {
  using namespace protostar;
  Scene<Sphere, Parallelogram> scene;
  scene.add(Parallelogram{.position = {-200, 0, -200}, .edge_u = {0, 0, 400}, .edge_v = {400, 0, 0}},
            Material{.texture = Checker{Color{0.6f}, Color{0.2f}}});
  for (int i = 0; i < 5; ++i)
    scene.add(Sphere{.center = {1.2 * (i - 2), 0.5, 0}, .radius = 0.5},
              Material{.glossy = Color{0.9f, 0.75f, 0.55f}, .roughness = 0.25 * i});
  scene.add(Sphere{.center = {-1.5, 2.25, -0.5}, .radius = 0.5}, Material{.emission = Color{15, 12, 9}});
  scene.add(Sphere{.center = {1.5, 2.25, -0.5}, .radius = 0.125}, Material{.emission = Color{150, 180, 230}});
  scene.set_sky({0.1f, 0.14f, 0.2f});
  return scene;
}

/// The camera that looks at them.
inline protostar::Camera camera_of_metals() {
  return protostar::Camera::perspective({0, 2.5, -6}, {0, -7, 24}, {0, 24, 7}, 42);
}

// Cameras with a lens, and a scene with surfaces in and out of focus.
#pragma once

#include <cmath>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/mesh.hpp>

#include "support/meshes.hpp"
#include "support/random.hpp"

/// Returns a camera of random directions, neither at right angles nor of one handedness, with a lens.
inline protostar::Camera skewed_camera_with_lens(Random& random) {
  for (;;) {
    const protostar::Camera camera{.position = random.point(2),
                                   .right = random.point(1),
                                   .up = random.point(1),
                                   .forward = random.point(1),
                                   .aperture = std::exp2(random.real(-6, 2)),
                                   .focus = std::exp2(random.real(-3, 5))};
    const protostar::Vec3 r = normalize(camera.right), u = normalize(camera.up),
                          f = normalize(camera.forward);
    if (std::abs(dot(cross(r, u), f)) > 0.1) return camera;
  }
}

/// Scenes of balls_at_all_depths.
using LensScene =
    protostar::Scene<protostar::Sphere, protostar::Plane, protostar::Parallelogram, protostar::Mesh>;

/// Returns a scene of balls before and behind the plane in focus, of which the first is around the camera.
inline LensScene balls_at_all_depths(int count) {
  LensScene scene;
  Random random(5);
  scene.add(protostar::Sphere{.center = {0, 0, 0}, .radius = 40}, protostar::Color{0.3f, 0.4f, 0.2f});
  for (int i = 0; i < count; ++i)
    scene.add(protostar::Sphere{.center = {random.real(-4, 4), random.real(-3, 3), random.real(-1, 12)},
                                .radius = random.real(0.02, 0.4)},
              protostar::Material{.diffuse = random.color(), .reflect = i % 3 == 0 ? 0.3 : 0});
  scene.add(protostar::Mesh(meshes::moved(meshes::torus(20, 10), 0.7, {1.1, 0.2, 3}), {.threads = 1}),
            protostar::Color{0.2f, 0.7f, 0.3f});
  scene.add(protostar::Plane{.normal = {0, 1, 0}, .distance = -1},
            protostar::Material{.texture = protostar::Checker{.first = protostar::Color{0.8f},
                                                              .second = protostar::Color{0.1f}}});
  scene.add(protostar::PointLight{.position = {0, 3, 0}, .power = protostar::Color{125.66f}});
  return scene;
}

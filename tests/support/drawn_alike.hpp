// Whether a scene's picture is the same in all ways to draw it.
#pragma once

#include <protostar/integrators/whitted.hpp>
#include <protostar/render.hpp>

#include "pictures.hpp"

/// How many pixels of a scene's picture differ between ray by ray in the plain scene, the same with the
/// scene's tree, and by tiles.
inline int pixels_drawn_otherwise(const auto& scene, const protostar::Camera& camera) {
  using namespace protostar;
  const WhittedIntegrator integrator{.depth = 5};
  Image plain(64, 48), alone(64, 48), tiled(64, 48);
  render(plain, camera, [&](const Ray& ray) { return integrator.radiance(ray, scene); });
  render(alone, camera, scene, integrator, {.tiles = false});
  render(tiled, camera, scene, integrator);
  return different_pixels(plain, alone) + different_pixels(plain, tiled);
}

// Comparison of a scene's pictures for all ways of rendering.
#pragma once

#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/whitted.hpp>

#include "pictures.hpp"

/// Number of pixels of a scene's picture that are not black, and number of those that differ between the
/// plain scene, ray by ray, and the accelerated one, ray by ray, or tiles.
struct DrawnAlike {
  int lit = 0, different = 0;
};

inline DrawnAlike drawn_alike(const auto& scene, const protostar::Camera& camera, const auto& integrator) {
  using namespace protostar;
  Image plain(64, 48), accelerated(64, 48), tiled(64, 48);
  const auto fast = accelerate(scene);
  render(plain, camera, [&](const Ray& ray) { return integrator.radiance(ray, scene); });
  render(accelerated, camera, [&](const Ray& ray) { return integrator.radiance(ray, fast); });
  render(tiled, camera, scene, integrator);
  return {.lit = count_pixels(plain, [&](int x, int y) { return plain(x, y) != Color{0}; }),
          .different = different_pixels(plain, accelerated) + different_pixels(plain, tiled)};
}

/// Compares the pictures of a WhittedIntegrator, which shows mirrors and glass.
inline DrawnAlike drawn_alike(const auto& scene, const protostar::Camera& camera) {
  return drawn_alike(scene, camera, protostar::WhittedIntegrator{.depth = 5});
}

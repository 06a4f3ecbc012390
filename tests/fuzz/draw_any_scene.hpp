// Fuzzing of rendering: every scene that the reader accepts is drawn, and its pictures are checked.
#pragma once

#include <algorithm>
#include <cmath>
#include <protostar/image.hpp>
#include <protostar/io/scene_file.hpp>
#include <protostar/render_options.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "stages/support/scene_pictures.hpp"

/// Returns the names of all integrators.
[[nodiscard]] inline std::vector<std::string> all_integrators() {
  return {protostar::integrator_names.begin(), protostar::integrator_names.end()};
}

/// Returns false if the scene lacks what an integrator needs.
[[nodiscard]] inline bool is_drawn(const std::string& integrator, const protostar::SceneFile& file) {
  try {
    protostar::require_integrator(integrator, file);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// Draws a scene with some integrators, by tiles and ray by ray, in 8 × 2 pixels with at most 2 samples and
/// paths of at most 4 rays, whatever its settings are, to be fast. Integrators for which the scene lacks
/// something are left out. Returns the faults of the pictures, a line
/// each: pixels that are not finite, and pixels that differ between the two ways.
[[nodiscard]] inline std::string faults_of_pictures(protostar::SceneFile& file,
                                                    const std::vector<std::string>& integrators) {
  using namespace protostar;
  constexpr int width = 8, height = 2;
  file.depth = std::min(file.depth.value_or(4), 4);
  if (!file.occlusion_distance) file.occlusion_distance = 1;
  RenderOptions options{.samples = std::min(file.samples, 2), .threads = 1};
  std::ostringstream faults;
  for (const std::string& integrator : integrators) {
    if (!is_drawn(integrator, file)) continue;
    Image by_tiles(width, height), by_rays(width, height);
    options.tiles = true;
    draw(by_tiles, file, integrator, options);
    options.tiles = false;
    draw(by_rays, file, integrator, options);
    int not_finite = 0, different = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Color a = by_tiles(x, y), b = by_rays(x, y);
        // A difference from itself is 0 for finite numbers only.
        if (a - a != Color{0} || b - b != Color{0}) ++not_finite;
        if (a != b) ++different;
      }
    if (not_finite > 0) faults << integrator << ": " << not_finite << " pixels are not finite\n";
    if (different > 0) faults << integrator << ": " << different << " pixels differ between tiles and rays\n";
  }
  return faults.str();
}

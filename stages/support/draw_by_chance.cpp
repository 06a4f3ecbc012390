#include <protostar/integrators/ambient_occlusion.hpp>
#include <protostar/integrators/direct.hpp>
#include <protostar/integrators/path.hpp>
#include <string>

#include "scene_pictures.hpp"

using namespace protostar;

void draw_by_chance(Image& image, const SceneFile& file, const std::string& integrator,
                    const StageRenderOptions& options) {
  const auto draw_with = [&](const auto& chosen) { render(image, file.camera, file.scene, chosen, options); };
  if (integrator == "ambient-occlusion") return draw_with(AmbientOcclusionIntegrator{});
  if (integrator == "direct") return draw_with(DirectIntegrator(file.scene));
  PathIntegrator path(file.scene);
  path.depth = file.depth.value_or(path.depth);
  draw_with(path);
}

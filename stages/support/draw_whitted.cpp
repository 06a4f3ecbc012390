#include <protostar/integrators/whitted.hpp>

#include "pictures.hpp"
#include "scene_pictures.hpp"

using namespace protostar;

void draw_whitted(Image& image, const SceneFile& file, const RenderOptions& options) {
  render(image, file.camera, file.scene, WhittedIntegrator{.depth = file.depth}, options);
}

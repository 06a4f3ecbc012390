#include <protostar/integrators/transparency.hpp>

#include "scene_pictures.hpp"

using namespace protostar;

void draw_transparency(Image& image, const SceneFile& file, const RenderOptions& options) {
  render(image, file.camera, file.scene, TransparencyIntegrator{}, options);
}

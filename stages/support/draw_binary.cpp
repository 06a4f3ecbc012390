#include <protostar/integrators/binary.hpp>

#include "scene_pictures.hpp"

using namespace protostar;

void draw_binary(Image& image, const SceneFile& file, const RenderOptions& options) {
  render(image, file.camera, file.scene, BinaryIntegrator{}, options);
}

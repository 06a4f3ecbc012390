// Draws metal balls of growing roughness, by directions to lamps and directions of the metal together.
#include <protostar/integrators/path.hpp>
#include <protostar/render.hpp>

#include "scenes/row_of_metals.hpp"
#include "support/chance_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "path", .samples = 16}, [](Stage& stage) {
    const Camera camera = camera_of_metals();
    const auto scene = row_of_metals();

    Image image = stage.image();
    render(image, camera, scene, PathIntegrator(scene), stage.render_options());
    stage.save(image);
  });
}

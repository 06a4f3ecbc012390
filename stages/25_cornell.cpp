// Draws the Cornell box with a ball of glass, by paths.
#include <protostar/integrators/path.hpp>
#include <protostar/render.hpp>

#include "scenes/cornell_box.hpp"
#include "support/chance_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "path", .samples = 8}, [](Stage& stage) {
    const Camera camera = camera_of_cornell_box();
    const auto scene = cornell_box();

    Image image = stage.image();
    render(image, camera, scene, PathIntegrator(scene), stage.render_options());
    stage.save(image);
  });
}

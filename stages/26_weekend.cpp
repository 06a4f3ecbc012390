// Draws the last scene of "Ray Tracing in One Weekend": large balls among small ones, by paths.
#include <protostar/integrators/path.hpp>
#include <protostar/render.hpp>

#include "scenes/weekend.hpp"
#include "support/chance_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "path", .samples = 8}, [](Stage& stage) {
    const Camera camera = camera_of_weekend();
    const auto scene = weekend();

    Image image = stage.image();
    render(image, camera, scene, PathIntegrator(scene), stage.render_options());
    stage.save(image);
  });
}

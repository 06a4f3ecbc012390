// Draws a yard at dusk with all light, from surface to surface, by paths (§6).
#include <protostar/integrators/path.hpp>
#include <protostar/render.hpp>

#include "scenes/yard.hpp"
#include "support/any_surfaces.hpp"
#include "support/chance_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "path", .samples = 16}, [](Stage& stage) {
    const Camera camera = camera_of_yard();
    const auto scene = yard_at_dusk();

    Image image = stage.image();
    render(image, camera, scene, PathIntegrator(scene), stage.render_options());
    stage.save(image);
  });
}

// Draws a yard by how free the space over each point is (a next step after §2.4).
#include <protostar/integrators/ambient_occlusion.hpp>
#include <protostar/render.hpp>

#include "scenes/yard.hpp"
#include "support/any_surfaces.hpp"
#include "support/chance_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "ambient-occlusion", .samples = 16}, [](Stage& stage) {
    const Camera camera = camera_of_yard();
    const auto scene = yard();

    Image image = stage.image();
    render(image, camera, scene, AmbientOcclusionIntegrator{2}, stage.render_options());
    stage.save(image);
  });
}

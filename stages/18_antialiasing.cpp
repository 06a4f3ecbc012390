// Draws balls on a floor of squares to the horizon, by several rays through each pixel (§2.4).
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/endless_floor.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow", .samples = 16}, [](Stage& stage) {
    const Camera camera = camera_of_endless_floor();
    const auto scene = endless_floor();

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

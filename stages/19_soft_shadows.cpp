// Draws the soft shadows of balls and a post in the light of two spheres (§5).
#include <protostar/integrators/direct.hpp>
#include <protostar/render.hpp>

#include "scenes/two_lamps.hpp"
#include "support/any_surfaces.hpp"
#include "support/chance_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "direct", .samples = 16}, [](Stage& stage) {
    const Camera camera = camera_of_two_lamps();
    const auto scene = two_lamps();

    Image image = stage.image();
    render(image, camera, scene, DirectIntegrator{scene}, stage.render_options());
    stage.save(image);
  });
}

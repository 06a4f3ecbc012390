// Draws balls that move while the shutter is open.
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/passing_balls.hpp"
#include "support/any_surfaces.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow", .samples = 64}, [](Stage& stage) {
    const Camera camera = Camera::perspective({0, 3, 0}, {0, -2, 9}, {0, 9, 2}, 50).with_shutter(0, 1);
    const auto scene = passing_balls();

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

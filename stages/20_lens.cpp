// Draws a row of balls through a lens, with the third in focus.
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/row_of_balls.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow", .samples = 64}, [](Stage& stage) {
    const Camera camera = Camera::thin_lens({0, 1.5, 0}, {0, 0, 1}, {0, 1, 0}, 40, 0.15, third_ball);
    const auto scene = row_of_balls();

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

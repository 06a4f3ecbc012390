// Draws the complete picture under an evening sky, which glass and mirror show.
#include <protostar/integrators/whitted.hpp>
#include <protostar/render.hpp>

#include "scenes/dusk.hpp"
#include "scenes/four_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "whitted", .width = 1024, .height = 768, .transfer = Linear{}, .tone = Tone::scale_pixel};
  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera = camera_of_four_spheres();
    auto scene = four_spheres({ivory, glass, red_rubber, mirror});
    scene.add(checker_board, checkers);
    scene.set_environment(dusk);

    Image image = stage.image();
    render(image, camera, scene, WhittedIntegrator{.depth = 5}, stage.render_options());
    stage.save(image);
  });
}

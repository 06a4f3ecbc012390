// Draws four spheres with highlights, by Phong's formula.
#include <protostar/integrators/whitted.hpp>
#include <protostar/render.hpp>

#include "scenes/four_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "whitted", .width = 1024, .height = 768, .transfer = Linear{}, .tone = Tone::scale_pixel};
  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera = camera_of_four_spheres();
    const auto scene = four_spheres({unpolished_ivory, red_rubber, red_rubber, unpolished_ivory});

    Image image = stage.image();
    render(image, camera, scene, WhittedIntegrator{.depth = 1}, stage.render_options());
    stage.save(image);
  });
}

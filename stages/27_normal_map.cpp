// Draws four smooth spheres that look as if they had waves, by normal maps.
#include <protostar/integrators/whitted.hpp>
#include <protostar/render.hpp>

#include "scenes/four_spheres.hpp"
#include "scenes/waves.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "whitted", .width = 1024, .height = 768, .transfer = Linear{}, .tone = Tone::scale_pixel};
  return run_stage(argc, argv, defaults, [](Stage& stage) {
    Material bumpy_ivory = unpolished_ivory, ribbed_rubber = red_rubber;
    bumpy_ivory.normal_map = waves(24, 12, 0.5);
    ribbed_rubber.normal_map = waves(0, 12, 0.5);

    const Camera camera = camera_of_four_spheres();
    const auto scene = four_spheres({bumpy_ivory, ribbed_rubber, ribbed_rubber, bumpy_ivory});

    Image image = stage.image();
    render(image, camera, scene, WhittedIntegrator{.depth = 1}, stage.render_options());
    stage.save(image);
  });
}

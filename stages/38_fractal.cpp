// Draws Menger's sponge with shadows (§3.4).
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/sponge.hpp"
#include "support/any_surfaces.hpp"
#include "support/march_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{.integrator = "shadow", .shows = {"evaluations"}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera;
    const auto scene = sponge();
    if (stage.integrator() == "evaluations") return draw_evaluations(stage, camera, scene);

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

// Draws the three spheres as fields that are marched with a proof of each step (§3.2).
#include <protostar/integrators/diffuse.hpp>
#include <protostar/render.hpp>

#include "scenes/marched_spheres.hpp"
#include "support/march_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{.integrator = "diffuse", .shows = {"evaluations", "enclosure-width"}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera;
    const auto scene = marched_spheres();
    if (stage.integrator() == "evaluations") return draw_evaluations(stage, camera, scene);
    if (stage.integrator() == "enclosure-width") return draw_enclosures(stage, camera, scene);

    Image image = stage.image();
    render(image, camera, scene, DiffuseIntegrator{}, stage.render_options());
    stage.save(image);

    Image exact = stage.image();
    render(exact, camera, three_spheres(), DiffuseIntegrator{}, stage.render_options());
    stage.compare(image, exact);
  });
}

// Draws the normal of the closest hit, as a color (§2.3.2, Fig. 10).
#include <protostar/integrators/normal.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "normal"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, NormalIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

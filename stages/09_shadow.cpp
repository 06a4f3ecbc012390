// Draws diffuse surfaces under a point light, with shadows (§2.3.2, Fig. 20).
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

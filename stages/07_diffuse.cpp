// Draws diffuse surfaces under a point light, no shadows (§2.3.2, Fig. 15; with --transfer linear, Fig. 14).
#include <protostar/integrators/diffuse.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "diffuse"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, DiffuseIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

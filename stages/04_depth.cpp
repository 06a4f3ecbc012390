// Draws the reciprocal distance of the closest hit (§2.3.2, Fig. 9).
#include <protostar/integrators/depth.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "depth"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, DepthIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

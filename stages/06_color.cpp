// Draws the flat color of the closest hit (§2.3.2, Fig. 11).
#include <protostar/integrators/color.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "color"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, ColorIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

// Draws a scene of three spheres, white on black, through an integrator (§2.3.1).
#include <protostar/integrators/binary.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "binary"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, BinaryIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

// Draws colored glass: white light from behind, times the surface color at every hit (§2.3.2, Figs. 16–19).
#include <protostar/integrators/transparency.hpp>
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "transparency"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();

    Image image = stage.image();
    render(image, camera, scene, TransparencyIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

// Draws the three spheres as fields that are marched with a proof of each step (§3.2).
#include <protostar/integrators/diffuse.hpp>
#include <protostar/render.hpp>

#include "scenes/marched_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "diffuse"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = marched_spheres();

    Image image = stage.image();
    render(image, camera, scene, DiffuseIntegrator{}, stage.render_options());
    stage.save(image);

    Image exact = stage.image();
    render(exact, camera, three_spheres(), DiffuseIntegrator{}, stage.render_options());
    stage.compare(image, exact);
  });
}

// Draws surfaces of many shapes, each one function of a point (§3.4).
#include <protostar/integrators/diffuse.hpp>
#include <protostar/render.hpp>

#include "scenes/field_shapes.hpp"
#include "support/any_surfaces.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "diffuse"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = field_shapes();

    Image image = stage.image();
    render(image, camera, scene, DiffuseIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

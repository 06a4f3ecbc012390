// Draws the rows of columns with shadows, whose rays leave fields without an offset (§3.3).
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/folded_rows.hpp"
#include "support/any_surfaces.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = folded_rows();

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

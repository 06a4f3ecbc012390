// Draws one sphere, white on black: a ray through every pixel hits it or not (§2.2.3–2.2.5, Fig. 7).
#include <protostar/render.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "sphere"}, [](Stage& stage) {
    const Camera camera;
    const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
    const auto radiance = [&](const Ray& ray) { return sphere.intersect(ray) ? Color{1} : Color{0}; };

    Image image = stage.image();
    render(image, camera, radiance, stage.render_options(sphere));
    stage.save(image);
  });
}

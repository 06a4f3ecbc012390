// Draws colored glass the tutorial's way, in float with an offset (§2.3.2, Fig. 19; --offset 0: Fig. 16).
#include "naive.hpp"

#include <protostar/integrators/transparency.hpp>
#include <protostar/render.hpp>

#include "support/naive_story.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "naive transparency",
      .numbers = {{"--offset", "How far from the surface a ray starts, in scene units", 1e-4}}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera;
    const float offset = static_cast<float>(stage.number("--offset"));
    const auto radiance = [&](const Ray& ray) { return naive::transparency(naive::Ray(ray), offset); };

    Image image = stage.image();
    StageRenderOptions options = stage.render_options();
    options.tell = [&](SampleRecord& sample) {
      naive::transparency(naive::Ray(sample.ray), offset, naive::Story(sample, offset));
    };
    render(image, camera, radiance, options);
    stage.save(image);

    Image exact = stage.image();
    render(exact, camera, three_spheres(), TransparencyIntegrator{}, stage.render_options());
    stage.compare(image, exact);
  });
}

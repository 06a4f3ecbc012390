// Draws shadows the tutorial's way, in float with an offset (§2.3.2; --offset 0: Fig. 20).
#include "naive.hpp"

#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "support/naive_story.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "naive shadow",
      .numbers = {{"--offset", "How far from the surface a ray starts, in scene units", 1e-4}}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera;
    const float offset = static_cast<float>(stage.number("--offset"));
    const auto radiance = [&](const Ray& ray) { return naive::shadow(naive::Ray(ray), offset); };

    Image image = stage.image();
    StageRenderOptions options = stage.render_options();
    options.tell = [&](SampleRecord& sample) {
      naive::shadow(naive::Ray(sample.ray), offset, naive::Story(sample, offset));
    };
    render(image, camera, radiance, options);
    stage.save(image);

    Image exact = stage.image();
    render(exact, camera, three_spheres(), ShadowIntegrator{}, stage.render_options());
    stage.compare(image, exact);
  });
}

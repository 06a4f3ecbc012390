// Draws the rows of columns with shadows, whose rays leave fields without an offset (§3.3).
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>

#include "scenes/folded_rows.hpp"
#include "support/any_surfaces.hpp"
#include "support/chance_pictures.hpp"
#include "support/march_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

namespace {

/// Draws ambient occlusion or soft shadows of the rows, by distances along one ray or by many rays
/// (--samples).
void draw_by_distance(Stage& stage, const Camera& camera) {
  const double farthest = 1;  // in scene units; surfaces farther away do not hide the sky
  const auto rows = folded_rows(), lit = folded_rows(RowLamp::sphere);
  Image image = stage.image();
  const auto draw = [&](const AnyScene& scene, const auto& integrator) {
    render(image, camera, scene, integrator, stage.render_options());
  };
  if (stage.integrator() == "ambient-occlusion") draw(rows, AmbientOcclusionIntegrator{farthest});
  if (stage.integrator() == "distance-occlusion") draw(rows, DistanceOcclusionIntegrator{rows, farthest});
  if (stage.integrator() == "direct") draw(lit, DirectIntegrator{lit});
  if (stage.integrator() == "distance-shadow") draw(lit, DistanceShadowIntegrator{lit});
  stage.save(image);
}

}  // namespace

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "shadow",
      .shows = {"ambient-occlusion", "distance-occlusion", "direct", "distance-shadow"}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    const Camera camera;
    const auto scene = folded_rows();
    if (stage.integrator() != "shadow") return draw_by_distance(stage, camera);

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}

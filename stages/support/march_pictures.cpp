// Instantiates, once for all stages, pictures by the integrators of marched scenes.
#include "march_pictures.hpp"

using namespace protostar;

template struct StagePicture<AnyScene, DistanceOcclusionIntegrator>;
template struct StagePicture<AnyScene, DistanceShadowIntegrator>;
template struct StagePicture<AnyScene, EnclosureWidthIntegrator>;
template struct StagePicture<AnyScene, MarchEvaluationsIntegrator>;

namespace {

/// Draws and saves the heat map of an integrator, and prints the range of its numbers over all pixels.
void draw_heat_map(Stage& stage, const Camera& camera, const AnyScene& scene, const auto& integrator,
                   const std::string& what, const auto& number) {
  Image image = stage.image();
  render(image, camera, scene, integrator, stage.render_options());
  stage.save(image);

  Image numbers = stage.image();
  render(
      numbers, camera, [&](const Ray& ray) { return Color{static_cast<float>(number(ray))}; },
      stage.render_options());
  stage.tell_range(numbers, what);
}

}  // namespace

void draw_evaluations(Stage& stage, const Camera& camera, const AnyScene& scene) {
  const MarchEvaluationsIntegrator integrator(scene);
  draw_heat_map(stage, camera, scene, integrator, "evaluations of a ray, with white from 128 on",
                [&](const Ray& ray) { return integrator.evaluations(ray, scene); });
}

void draw_enclosures(Stage& stage, const Camera& camera, const AnyScene& scene) {
  const EnclosureWidthIntegrator integrator(scene);
  draw_heat_map(stage, camera, scene, integrator, "bits to which a hit is proven, with white at 53",
                [&](const Ray& ray) { return integrator.bits(ray, scene).value_or(-1); });
}

#include <algorithm>
#include <stdexcept>
#include <string>

#include "chance_pictures.hpp"
#include "command_line.hpp"
#include "march_pictures.hpp"
#include "option_values.hpp"
#include "pictures.hpp"
#include "scene_pictures.hpp"

using namespace protostar;

void draw(Image& image, const SceneFile& file, const std::string& integrator,
          const StageRenderOptions& options) {
  // The command line may ask for other samples than the scene file, which were checked when it was read.
  // Until an error is met, there may be many, of which few pictures need more than 1024.
  const bool is_open = options.error > 0 || options.seconds > 0;
  const int shares = is_open ? std::min(options.max_samples, 1024) : options.samples;
  if (const auto refusal = refusal_of_samples(shares, file.scene.lights().size()))
    throw UsageError(is_open ? "--max-samples" : "--samples", *refusal);
  try {
    require_integrator(integrator, file);
  } catch (const std::invalid_argument& error) {  // not the scene's, which was checked when it was read
    refuse("--integrator", integrator, std::string("possible with this scene: ") + error.what());
  }
  const double farthest = file.occlusion_distance.value_or(infinity);
  const auto draw_with = [&](const auto& chosen) { render(image, file.camera, file.scene, chosen, options); };
  if (integrator == "binary") return draw_with(BinaryIntegrator{});
  if (integrator == "color") return draw_with(ColorIntegrator{});
  if (integrator == "depth") return draw_with(DepthIntegrator{});
  if (integrator == "diffuse") return draw_with(DiffuseIntegrator{});
  if (integrator == "ambient-occlusion") return draw_with(AmbientOcclusionIntegrator(farthest));
  if (integrator == "direct") return draw_with(DirectIntegrator(file.scene));
  if (integrator == "distance-occlusion") return draw_with(DistanceOcclusionIntegrator(file.scene, farthest));
  if (integrator == "distance-shadow") return draw_with(DistanceShadowIntegrator(file.scene));
  if (integrator == "enclosure-width") return draw_with(EnclosureWidthIntegrator(file.scene));
  if (integrator == "evaluations") return draw_with(MarchEvaluationsIntegrator(file.scene));
  if (integrator == "normal") return draw_with(NormalIntegrator{});
  if (integrator == "path") {
    PathIntegrator path(file.scene);
    path.depth = file.depth.value_or(path.depth);
    return draw_with(path);
  }
  if (integrator == "shadow") return draw_with(ShadowIntegrator{});
  if (integrator == "transparency") return draw_with(TransparencyIntegrator{});
  if (integrator == "whitted") {
    WhittedIntegrator whitted{.most_rays = most_rays_of_sample(shares)};
    whitted.depth = file.depth.value_or(whitted.depth);
    return draw_with(whitted);
  }
  throw std::runtime_error("no such integrator: " + integrator);
}

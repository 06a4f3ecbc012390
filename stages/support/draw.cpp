#include <map>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <stdexcept>
#include <variant>

#include "scene_pictures.hpp"

using namespace protostar;

namespace {

/// Integrator that stands for each that shades the closest hit. Most of the code finds the hit, and is thus
/// compiled once.
struct ChosenIntegrator : FirstHit<ChosenIntegrator> {
  using TakesPackets = ChosenIntegrator;

  std::variant<ColorIntegrator, DepthIntegrator, DiffuseIntegrator, NormalIntegrator, ShadowIntegrator>
      shading;

  template <class R>
  [[nodiscard]] typename R::Light background(const R& ray, const auto& scene) const {
    return std::visit([&](const auto& integrator) ->
                      typename R::Light { return integrator.background(ray, scene); },
                      shading);
  }

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    return std::visit([&](const auto& integrator) { return integrator.shade(hit, scene); }, shading);
  }
};

}  // namespace

void draw(Image& image, const SceneFile& file, const std::string& integrator, const RenderOptions& options) {
  const auto draw_with = [&](const auto& chosen) { render(image, file.camera, file.scene, chosen, options); };
  static const std::map<std::string, ChosenIntegrator> first_hits{{"color", {{}, ColorIntegrator{}}},
                                                                  {"depth", {{}, DepthIntegrator{}}},
                                                                  {"diffuse", {{}, DiffuseIntegrator{}}},
                                                                  {"normal", {{}, NormalIntegrator{}}},
                                                                  {"shadow", {{}, ShadowIntegrator{}}}};
  // The command line may ask for other samples than the scene file, which were checked when it was read.
  if (const auto refusal = refusal_of_samples(options.samples, file.scene.lights().size()))
    throw std::runtime_error("--samples: " + *refusal);
  if (integrator == "binary") return draw_with(BinaryIntegrator{});
  if (integrator == "transparency") return draw_with(TransparencyIntegrator{});
  if (integrator == "whitted")
    return draw_with(
        WhittedIntegrator{.depth = file.depth, .most_rays = most_rays_of_sample(options.samples)});
  draw_with(first_hits.at(integrator));
}

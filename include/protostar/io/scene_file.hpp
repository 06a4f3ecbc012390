// Contents of a scene file, independent of its format: a scene, a camera, and how the picture is drawn.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "../any_scene.hpp"
#include "../camera.hpp"
#include "../encode.hpp"
#include "../integrators/distance_shadow.hpp"
#include "../integrators/whitted.hpp"
#include "../scene_fields.hpp"
#include "../tone.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Names of the integrators that a file can ask for.
inline constexpr std::array<std::string_view, 15> integrator_names{
    "binary",          "depth",       "normal",
    "color",           "diffuse",     "transparency",
    "shadow",          "whitted",     "ambient-occlusion",
    "direct",          "path",        "distance-occlusion",
    "distance-shadow", "evaluations", "enclosure-width"};

/// Returns true for the name of an integrator that draws light by chance, and therefore takes a sampler.
[[nodiscard]] inline bool draws_by_chance(std::string_view integrator) {
  return integrator == "ambient-occlusion" || integrator == "direct" || integrator == "path";
}

/// Returns why such an integrator is not drawn with the sampler hammersley.
[[nodiscard]] inline std::string why_not_hammersley(std::string_view integrator) {
  return "the integrator " + std::string(integrator) +
         " draws by chance, and hammersley has the same numbers in every pixel and for every seed, so that "
         "all pixels are wrong in the same way and look as if they were right";
}

/// Largest samples and depth that a file can ask for.
inline constexpr int most_samples = 1 << 16, most_depth = WhittedIntegrator::most_depth;

/// Largest number of rays for a pixel: camera rays, their secondary rays, and shadow rays. A small scene
/// takes about a second for them. Each sample has an equal share.
inline constexpr std::int64_t most_rays_of_pixel = std::int64_t{1} << 22;

/// Returns the largest number of rays for each of `samples` samples of a pixel.
[[nodiscard]] inline std::int64_t most_rays_of_sample(int samples) {
  return most_rays_of_pixel / std::max(samples, 1);
}

/// Returns the error message if samples and lights together exceed the limit on rays per pixel.
[[nodiscard]] inline std::optional<std::string> refusal_of_samples(int samples, std::size_t lights) {
  const auto rays = static_cast<std::int64_t>(lights) + 1;
  if (rays <= most_rays_of_sample(samples)) return std::nullopt;
  return "with " + std::to_string(lights) + " lights a pixel may take " +
         std::to_string(std::max(samples, 1) * rays) + " rays, and at most " +
         std::to_string(most_rays_of_pixel) + " are allowed";
}

/// Scene, camera, and settings of the picture, initialized to the defaults of what a file may leave out.
struct SceneFile {
  AnyScene scene;
  Camera camera;
  int width = 640, height = 480;       ///< in pixels
  int samples = 0;                     ///< per pixel; 0: one ray through its center
  double error = 0;                    ///< RenderOptions::error; 0: none
  std::string sampler = {};            ///< one of sampler_names; empty: the default of the integrator
  std::string filter = "box";          ///< one of ReconstructionFilter::names
  std::uint64_t seed = 0;              ///< of the sampler
  std::optional<int> depth = {};       ///< of WhittedIntegrator or PathIntegrator; none: its default
  std::string integrator = "whitted";  ///< one of integrator_names

  /// Distance beyond which surfaces occlude nothing, of AmbientOcclusionIntegrator, ∞ by default, and of
  /// DistanceOcclusionIntegrator, which needs one.
  std::optional<double> occlusion_distance = {};

  Transfer transfer = Srgb{};
  Tone tone = Tone::clip;
  double exposure = 1;                  ///< a factor on the light, before tone and transfer
  std::vector<std::string> files = {};  ///< paths of the images and meshes that the file names, each once
};

/// Throws std::invalid_argument if the scene and the settings of a file lack what an integrator needs:
/// marched surfaces, distances from all surfaces, or lamps that are spheres. The message names no integrator,
/// as the caller knows by which word it was asked for.
inline void require_integrator(std::string_view integrator, const SceneFile& file) {
  if (integrator == "evaluations" || integrator == "enclosure-width")
    static_cast<void>(SceneMarches(file.scene, ""));
  if (integrator == "distance-shadow") static_cast<void>(DistanceShadowIntegrator(file.scene, ""));
  if (integrator == "distance-occlusion") {
    if (!file.occlusion_distance) throw std::invalid_argument("the settings have no occlusion-distance");
    static_cast<void>(SceneDistances(file.scene, ""));
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Renders for a stage: the picture, or the one pixel that the user asks for, with its explanation.
#pragma once

#include <functional>
#include <protostar/accel/render_tiles.hpp>
#include <string>
#include <utility>
#include <vector>

#include "explained_scene.hpp"
#include "pictures.hpp"

/// Options of render for a stage.
struct StageRenderOptions : protostar::RenderOptions {
  StageRenderOptions(protostar::RenderOptions common) : RenderOptions(std::move(common)) {}

  bool draws = true;                   ///< true if the picture is needed
  Explanation* explanation = nullptr;  ///< if given, a pixel is explained

  /// Sphere that a function of a ray intersects, if that is all that it does; for the explanation.
  const protostar::Sphere* sphere = nullptr;

  /// Writes lines about a ray of the camera, for a function of a ray; for the explanation.
  std::function<void(const protostar::Ray&, std::vector<std::string>&)> tell = {};
};

// The overloads below are chosen for StageRenderOptions, so that a stage calls render as any program does.

/// Fills the image, or only the pixel that is explained, with the view of a camera in a scene.
template <class... S, class I>
void render(protostar::Image& image, const protostar::Camera& camera, const protostar::Scene<S...>& scene,
            const I& integrator, const StageRenderOptions& options) {
  const protostar::RenderOptions& common = options;
  if (options.draws) protostar::render(image, camera, scene, integrator, common);
  if (options.explanation == nullptr) return;
  if constexpr (protostar::Integrator<I, ExplainedScene>)
    explain(*options.explanation, camera, ExplainedScene(scene), integrator, common);
  else
    explain_function(
        *options.explanation, camera,
        [&](SampleRecord& sample) {
          return protostar::detail::radiance_of_sample(protostar::detail::radiance_in(scene, integrator),
                                                       sample.ray, sample.sampler);
        },
        common, protostar::detail::default_sampler<I, protostar::Scene<S...>>());
  image(options.explanation->pixel.x, options.explanation->pixel.y) = options.explanation->mean;
}

/// Fills the image, or only the pixel that is explained, by a function of the camera's rays.
template <protostar::Radiance F>
void render(protostar::Image& image, const protostar::Camera& camera, const F& radiance,
            const StageRenderOptions& options) {
  const protostar::RenderOptions& common = options;
  if (options.draws) protostar::render(image, camera, radiance, common);
  if (options.explanation == nullptr) return;
  if (options.sphere) {
    protostar::Scene<protostar::Sphere> scene;
    scene.add(*options.sphere, protostar::Color{1});
    const auto ask = [&](const protostar::Ray& ray, const protostar::Traceable auto& recorded,
                         const protostar::PixelSampler& sampler) {
      static_cast<void>(recorded.intersect(ray, protostar::Interval{}));
      return protostar::detail::radiance_of_sample(radiance, ray, sampler);
    };
    protostar::RenderOptions by_default = common;
    if (!by_default.sampler.is_made()) by_default.sampler = protostar::detail::default_sampler<F>();
    explain(*options.explanation, camera, ExplainedScene(scene), ask, by_default);
  } else {
    explain_function(
        *options.explanation, camera,
        [&](SampleRecord& sample) {
          if (options.tell) options.tell(sample.ray, sample.told);
          return protostar::detail::radiance_of_sample(radiance, sample.ray, sample.sampler);
        },
        common, protostar::detail::default_sampler<F>());
  }
  image(options.explanation->pixel.x, options.explanation->pixel.y) = options.explanation->mean;
}

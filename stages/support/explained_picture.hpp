// Explains the pixel of a picture that the user asks for, for a stage. docs/web has another file of this name
// for modules that only draw.
#pragma once

#include <protostar/image.hpp>
#include <protostar/render.hpp>

#include "explained_scene.hpp"
#include "stage_render_options.hpp"

/// Explains a pixel by an integrator in a scene, and fills it.
template <class S, class I>
void draw_explained(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                    const I& integrator, const StageRenderOptions& options) {
  Explanation& explanation = *options.explanation;
  const protostar::RenderOptions& common = options;
  if constexpr (protostar::Integrator<I, ExplainedScene>)
    explain(explanation, camera, ExplainedScene(scene), integrator, common);
  else
    explain_function(
        explanation, camera,
        [&](SampleRecord& sample) {
          return protostar::detail::radiance_of_sample(protostar::detail::radiance_in(scene, integrator),
                                                       sample.ray, sample.sampler);
        },
        common, protostar::detail::default_sampler<I, S>(camera));
  image(explanation.pixel.x, explanation.pixel.y) = explanation.mean;
}

/// Explains a pixel by a function of the camera's rays, and fills it.
template <class F>
void draw_explained(protostar::Image& image, const protostar::Camera& camera, const F& radiance,
                    const StageRenderOptions& options) {
  Explanation& explanation = *options.explanation;
  const protostar::RenderOptions& common = options;
  if (options.sphere) {
    protostar::Scene<protostar::Sphere> scene;
    scene.add(*options.sphere, protostar::Color{1});
    const auto ask = [&](const protostar::Ray& ray, const protostar::Traceable auto& recorded,
                         const protostar::PixelSampler& sampler) {
      static_cast<void>(recorded.intersect(ray, protostar::Interval{}));
      return protostar::detail::radiance_of_sample(radiance, ray, sampler);
    };
    protostar::RenderOptions by_default = common;
    if (!by_default.sampler.is_made()) by_default.sampler = protostar::detail::default_sampler<F>(camera);
    explain(explanation, camera, ExplainedScene(scene), ask, by_default);
  } else {
    explain_function(
        explanation, camera,
        [&](SampleRecord& sample) {
          if (options.tell) options.tell(sample);
          return protostar::detail::radiance_of_sample(radiance, sample.ray, sample.sampler);
        },
        common, protostar::detail::default_sampler<F>(camera));
  }
  image(explanation.pixel.x, explanation.pixel.y) = explanation.mean;
}

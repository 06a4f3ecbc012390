// Draws a picture whose work is shared, for a stage: in units. docs/web has another file of this name, which
// shares no work.
#pragma once

#include <functional>
#include <protostar/image.hpp>
#include <protostar/render.hpp>
#include <protostar/sampling/film.hpp>

#include "scene_of_units.hpp"
#include "shared_render.hpp"
#include "stage_render_options.hpp"

/// Draws units of a picture, and the picture unless it is a shard. `light` fills a small image with the view,
/// and `add` adds samples of it to a film; a view without a sampler in the options takes `otherwise`.
void render_shared(protostar::Image& image, const StageRenderOptions& options,
                   const protostar::SamplerChoice& otherwise,
                   const std::function<void(protostar::Image&, const protostar::RenderOptions&)>& light,
                   const std::function<void(protostar::Film&, const protostar::SampleRange&,
                                            const protostar::RenderOptions&)>& add);

/// Draws units of a picture by an integrator in a scene.
template <class S, class I>
void draw_shared(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                 const I& integrator, const StageRenderOptions& options) {
  const auto& of_units = scene_of_units(scene, options);
  render_shared(
      image, options, protostar::detail::default_sampler<I, S>(camera),
      [&](protostar::Image& seen, const protostar::RenderOptions& few) {
        protostar::render(seen, camera, scene, integrator, few);
      },
      [&](protostar::Film& film, const protostar::SampleRange& samples,
          const protostar::RenderOptions& of_unit) {
        if constexpr (protostar::Integrator<I, SceneOfUnits<S>>)
          protostar::add_samples(film, samples, camera, of_units, integrator, of_unit);
        else
          protostar::add_samples(film, samples, camera, scene, integrator, of_unit);
      });
}

/// Draws units of a picture by a function of the camera's rays.
template <class F>
void draw_shared(protostar::Image& image, const protostar::Camera& camera, const F& radiance,
                 const StageRenderOptions& options) {
  render_shared(
      image, options, protostar::detail::default_sampler<F>(camera),
      [&](protostar::Image& seen, const protostar::RenderOptions& few) {
        protostar::render(seen, camera, radiance, few);
      },
      [&](protostar::Film& film, const protostar::SampleRange& samples,
          const protostar::RenderOptions& of_unit) {
        protostar::add_samples(film, samples, camera, radiance, of_unit);
      });
}

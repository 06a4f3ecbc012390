// Renders for a stage: the picture, or the one pixel that the user asks for, with its explanation.
#pragma once

#include <functional>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/sampling/film.hpp>
#include <string>
#include <utility>
#include <vector>

#include "explained_scene.hpp"
#include "scene_of_units.hpp"
#include "shared_render.hpp"

/// Options of render for a stage.
struct StageRenderOptions : protostar::RenderOptions {
  StageRenderOptions(protostar::RenderOptions common) : RenderOptions(std::move(common)) {}

  bool draws = true;                   ///< true if the picture is needed
  Explanation* explanation = nullptr;  ///< if given, a pixel is explained

  /// Sphere that a function of a ray intersects, if that is all that it does; for the explanation.
  const protostar::Sphere* sphere = nullptr;

  /// Tells the steps of a function of a ray for the ray of a sample; for the explanation.
  std::function<void(SampleRecord&)> tell = {};

  SharedRender* shared = nullptr;         ///< if given, the work is drawn in units
  protostar::SharedPicture picture = {};  ///< with this fingerprint and finish
};

/// Draws units of a picture, and the picture unless it is a shard. `light` fills a small image with the view,
/// and `add` adds samples of it to a film; a view without a sampler in the options takes `otherwise`.
void render_shared(protostar::Image& image, const StageRenderOptions& options,
                   const protostar::SamplerChoice& otherwise,
                   const std::function<void(protostar::Image&, const protostar::RenderOptions&)>& light,
                   const std::function<void(protostar::Film&, const protostar::SampleRange&,
                                            const protostar::RenderOptions&)>& add);

/// Picture by an integrator in a scene. It is a class, with functions that are not inline, so that a program
/// may compile it once for the scenes and integrators that it uses in several units: `extern template`.
template <class S, class I>
struct StagePicture {
  /// Fills the image, or only the pixel that is explained, with the view of a camera.
  static void draw(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                   const I& integrator, const StageRenderOptions& options);

 private:
  static void draw_shared(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                          const I& integrator, const StageRenderOptions& options);
};

template <class S, class I>
void StagePicture<S, I>::draw(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                              const I& integrator, const StageRenderOptions& options) {
  const protostar::RenderOptions& common = options;
  if (options.shared) return draw_shared(image, camera, scene, integrator, options);
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
        common, protostar::detail::default_sampler<I, S>(camera));
  image(options.explanation->pixel.x, options.explanation->pixel.y) = options.explanation->mean;
}

template <class S, class I>
void StagePicture<S, I>::draw_shared(protostar::Image& image, const protostar::Camera& camera, const S& scene,
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

/// Picture by a function of the camera's rays, with this signature.
template <class Signature>
struct FunctionPicture {
  using F = std::function<Signature>;

  /// Fills the image, or only the pixel that is explained, with the view of a camera.
  static void draw(protostar::Image& image, const protostar::Camera& camera, const F& radiance,
                   const StageRenderOptions& options);
};

template <class Signature>
void FunctionPicture<Signature>::draw(protostar::Image& image, const protostar::Camera& camera,
                                      const F& radiance, const StageRenderOptions& options) {
  const protostar::RenderOptions& common = options;
  if (options.shared)
    return render_shared(
        image, options, protostar::detail::default_sampler<F>(camera),
        [&](protostar::Image& seen, const protostar::RenderOptions& few) {
          protostar::render(seen, camera, radiance, few);
        },
        [&](protostar::Film& film, const protostar::SampleRange& samples,
            const protostar::RenderOptions& of_unit) {
          protostar::add_samples(film, samples, camera, radiance, of_unit);
        });
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
    if (!by_default.sampler.is_made()) by_default.sampler = protostar::detail::default_sampler<F>(camera);
    explain(*options.explanation, camera, ExplainedScene(scene), ask, by_default);
  } else {
    explain_function(
        *options.explanation, camera,
        [&](SampleRecord& sample) {
          if (options.tell) options.tell(sample);
          return protostar::detail::radiance_of_sample(radiance, sample.ray, sample.sampler);
        },
        common, protostar::detail::default_sampler<F>(camera));
  }
  image(options.explanation->pixel.x, options.explanation->pixel.y) = options.explanation->mean;
}

extern template struct FunctionPicture<protostar::Color(const protostar::Ray&)>;

// The overloads below are chosen for StageRenderOptions, so that a stage calls render as any program does.

/// Fills the image, or only the pixel that is explained, with the view of a camera in a scene.
template <class... S, class I>
void render(protostar::Image& image, const protostar::Camera& camera, const protostar::Scene<S...>& scene,
            const I& integrator, const StageRenderOptions& options) {
  StagePicture<protostar::Scene<S...>, I>::draw(image, camera, scene, integrator, options);
}

/// Fills the image, or only the pixel that is explained, by a function of the camera's rays. It is called by
/// way of std::function, so that the pictures of all functions of a ray are compiled once.
template <protostar::Radiance F>
void render(protostar::Image& image, const protostar::Camera& camera, const F& radiance,
            const StageRenderOptions& options) {
  protostar::detail::validate(radiance);
  if constexpr (protostar::detail::takes_sampler<F>)
    FunctionPicture<protostar::Color(const protostar::Ray&, const protostar::PixelSampler&)>::draw(
        image, camera, std::cref(radiance), options);
  else
    FunctionPicture<protostar::Color(const protostar::Ray&)>::draw(image, camera, std::cref(radiance),
                                                                   options);
}

// Renders for a stage: the picture, or the one pixel that the user asks for, with its explanation.
#pragma once

#include <functional>
#include <protostar/accel/render_tiles.hpp>

#include "stage_render_options.hpp"

// By their full names, so that docs/web has others in folders that come first.
#include "stages/support/explained_picture.hpp"
#include "stages/support/shared_picture.hpp"

/// Picture by an integrator in a scene. It is a class, with functions that are not inline, so that a program
/// may compile it once for the scenes and integrators that it uses in several units: `extern template`.
template <class S, class I>
struct StagePicture {
  /// Fills the image, or only the pixel that is explained, with the view of a camera.
  static void draw(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                   const I& integrator, const StageRenderOptions& options);
};

template <class S, class I>
void StagePicture<S, I>::draw(protostar::Image& image, const protostar::Camera& camera, const S& scene,
                              const I& integrator, const StageRenderOptions& options) {
  const protostar::RenderOptions& common = options;
  if (options.shared) return draw_shared(image, camera, scene, integrator, options);
  if (options.draws) protostar::render(image, camera, scene, integrator, common);
  if (options.explanation) draw_explained(image, camera, scene, integrator, options);
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
  if (options.shared) return draw_shared(image, camera, radiance, options);
  if (options.draws) protostar::render(image, camera, radiance, common);
  if (options.explanation) draw_explained(image, camera, radiance, options);
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

// Fills an image of a scene tile by tile.
//
// This is the fast path of render, and gives the same bytes as the plain path: surfaces that a tile cannot
// see are culled by certified bounds (accel/candidates.hpp), and the others are decided by the certified
// roots of numeric/.
#pragma once

#include "../render.hpp"
#include "accelerate.hpp"
#include "packet_integrator.hpp"
#include "tile_renderer.hpp"
#include "tile_scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace simd {

/// Draws a picture by tiles, in a function of its own that is not inline, so that a program may compile it
/// once for the scenes and integrators that it uses in several units: `extern template`.
template <class I, Surface... S>
void fill_by_tiles(const protostar::detail::SampleTarget& target, const Camera& camera,
                   const Accelerated<Scene<S...>>& scene, const I& integrator, const RenderOptions& options) {
  const TileRenderer<I, S...> tiles(target, camera, scene, integrator, options);
  const Tile all = target.tile();
  protostar::detail::for_each_in_parallel(all.count(64), options, [&](int i) { tiles(all.part(i, 64)); });
}

}  // namespace simd

namespace detail {

/// Gives the light of a view to a target, by tiles, or ray by ray if the options say so.
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void draw(const SampleTarget& target, const Camera& camera, const Accelerated<Scene<S...>>& scene,
          const I& integrator, const RenderOptions& options) {
  if (options.tiles)
    simd::fill_by_tiles<I, S...>(target, camera, scene, integrator, options);
  else
    draw(target, camera, radiance_in(scene, integrator), options);
}

}  // namespace detail

/// Fills an image with the view of a camera in a scene, with the bytes of the render of render.hpp, but
/// faster.
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void render(Image& image, const Camera& camera, const Accelerated<Scene<S...>>& scene, const I& integrator,
            const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(integrator);
  scene.require_same_surfaces();
  detail::draw_image(image, options, [&](const detail::SampleTarget& target, const RenderOptions& pass) {
    detail::draw(target, camera, scene, integrator, pass);
  });
}
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void render(Image& image, const Camera& camera, const Scene<S...>& scene, const I& integrator,
            const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(integrator);
  if (!options.tiles) return render(image, camera, detail::radiance_in(scene, integrator), options);
  const Accelerated<Scene<S...>> accelerated(scene, options);
  detail::draw_image(image, options, [&](const detail::SampleTarget& target, const RenderOptions& pass) {
    simd::fill_by_tiles<I, S...>(target, camera, accelerated, integrator, pass);
  });
}

/// Adds samples of a camera's view in a scene to a film, with the sums of the render of render.hpp, but
/// faster. Whoever adds samples to a film several times accelerates the scene once.
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void render(Film& film, const SampleRange& samples, const Camera& camera,
            const Accelerated<Scene<S...>>& scene, const I& integrator, const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(integrator);
  scene.require_same_surfaces();
  if (samples.first >= samples.last) return;
  detail::draw(detail::SampleTarget(film, samples), camera, scene, integrator, options);
}
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void render(Film& film, const SampleRange& samples, const Camera& camera, const Scene<S...>& scene,
            const I& integrator, const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(integrator);
  if (!options.tiles) return render(film, samples, camera, detail::radiance_in(scene, integrator), options);
  if (samples.first >= samples.last) return;
  simd::fill_by_tiles<I, S...>(detail::SampleTarget(film, samples), camera,
                               Accelerated<Scene<S...>>(scene, options), integrator, options);
}

}  // namespace protostar::inline PROTOSTAR_ABI

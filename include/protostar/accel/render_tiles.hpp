// Fills an image of a scene, or adds samples to a film, tile by tile.
//
// This is the fast path of render and add_samples, and gives the same bytes as the plain path: surfaces that
// a tile cannot see are culled by certified bounds (accel/candidates.hpp), and the others are decided by the
// certified roots of numeric/.
#pragma once

#include "../render.hpp"
#include "accelerate.hpp"
#include "packet_integrator.hpp"
#include "tile_renderer.hpp"
#include "tile_scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace simd {

/// Draws the view of a camera into an image or a film, by tiles that threads share. It is a function of its
/// own, and not inline, so that a program may compile it once for the scenes and integrators that it uses in
/// several units: `extern template`.
template <class I, Surface... S>
void fill_by_tiles(const protostar::detail::SampleTarget& target, const Camera& camera,
                   const Accelerated<Scene<S...>>& scene, const I& integrator, const RenderOptions& options) {
  const TileRenderer<I, S...> tiles(target, camera, scene, integrator, options);
  const Tile all = target.tile();
  // A mesh can be rasterized into tiles of up to 64 × 64 pixels (PixelBlock::side).
  protostar::detail::for_each_in_parallel(all.count(64), options, [&](int i) { tiles(all.part(i, 64)); });
}

}  // namespace simd

namespace detail {

/// Returns draw(target, options), which renders the view of a camera into the image or film of a target, by
/// tiles. Borrows its arguments.
template <Surface First, Surface... S, simd::TileIntegrator<simd::TileScene<First, S...>> I>
[[nodiscard]] auto by_tiles(const Camera& camera, const Accelerated<Scene<First, S...>>& scene,
                            const I& integrator) {
  return [&](const SampleTarget& target, const RenderOptions& options) {
    simd::fill_by_tiles<I, First, S...>(target, camera, scene, integrator, options);
  };
}

/// Returns draw(target, options) that goes ray by ray, for a scene that names no type of surface: a tile has
/// nothing to look for. Borrows its arguments.
[[nodiscard]] auto by_tiles(const Camera& camera, const Accelerated<Scene<>>& scene, const auto& integrator) {
  return [&camera, radiance = radiance_in(scene, integrator)](const SampleTarget& target,
                                                              const RenderOptions& options) {
    ray_by_ray(camera, radiance)(target, options);
  };
}

/// Returns an accelerated scene: an Accelerated argument itself, or a new one of a plain scene. Throws
/// std::logic_error if the surfaces of an accelerated scene have changed.
template <Surface... S>
[[nodiscard]] const Accelerated<Scene<S...>>& accelerated(const Accelerated<Scene<S...>>& scene,
                                                          const RenderOptions&) {
  scene.require_same_surfaces();
  return scene;
}
template <Surface... S>
[[nodiscard]] Accelerated<Scene<S...>> accelerated(const Scene<S...>& scene, const RenderOptions& options) {
  return Accelerated<Scene<S...>>(scene, options);
}

/// Calls use(draw), where draw(target, options) renders the view of a camera into a target: by tiles, or ray
/// by ray if the options say so. draw may be used during that call only, as it refers to the accelerated
/// scene. Throws std::invalid_argument for an invalid camera or integrator, std::logic_error if the surfaces
/// of an accelerated scene have changed, and what accelerate throws.
template <class S, class I>
void with_draw(const Camera& camera, const S& scene, const I& integrator, const RenderOptions& options,
               const auto& use) {
  camera.validate();
  validate(integrator);
  if (options.tiles) {
    const auto& fast = accelerated(scene, options);
    use(by_tiles(camera, fast, integrator));
  } else {
    if constexpr (requires { scene.require_same_surfaces(); }) scene.require_same_surfaces();
    const auto radiance = radiance_in(scene, integrator);
    use(ray_by_ray(camera, radiance));
  }
}

}  // namespace detail

/// Fills an image with the view of a camera in a scene, with the bytes of the render of render.hpp, but
/// faster. Throws as that does, std::logic_error if the surfaces of an accelerated scene have changed, and
/// what accelerate throws.
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void render(Image& image, const Camera& camera, const Accelerated<Scene<S...>>& scene, const I& integrator,
            const RenderOptions& options = {}) {
  detail::with_draw(camera, scene, integrator, options,
                    [&](const auto& draw) { detail::draw_image(image, options, draw); });
}
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void render(Image& image, const Camera& camera, const Scene<S...>& scene, const I& integrator,
            const RenderOptions& options = {}) {
  detail::with_draw(camera, scene, integrator, options,
                    [&](const auto& draw) { detail::draw_image(image, options, draw); });
}

/// Adds samples of a camera's view in a scene to a film, with the sums of the add_samples of render.hpp, but
/// faster. A plain scene is accelerated anew in each call. Throws as that add_samples does, std::logic_error
/// if the surfaces of an accelerated scene have changed, and what accelerate throws.
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void add_samples(Film& film, const SampleRange& samples, const Camera& camera,
                 const Accelerated<Scene<S...>>& scene, const I& integrator,
                 const RenderOptions& options = {}) {
  detail::with_draw(camera, scene, integrator, options,
                    [&](const auto& draw) { detail::draw_samples(film, samples, options, draw); });
}
template <Surface... S, simd::TileIntegrator<simd::TileScene<S...>> I>
void add_samples(Film& film, const SampleRange& samples, const Camera& camera, const Scene<S...>& scene,
                 const I& integrator, const RenderOptions& options = {}) {
  detail::with_draw(camera, scene, integrator, options,
                    [&](const auto& draw) { detail::draw_samples(film, samples, options, draw); });
}

}  // namespace protostar::inline PROTOSTAR_ABI

// The loop over the pixels (§2.2.5), ray by ray, in tiles that several threads share.
//
// accel/render_tiles.hpp overloads render for scenes and gives the same bytes faster; protostar.hpp includes
// both.
#pragma once

#include "integrator.hpp"
#include "parallel.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Fills an image by tiles of side × side pixels; each thread takes the next tile when it is free.
void fill_tiles(const Image& image, int side, const RenderOptions& options, const auto& fill) {
  const Tile all = image.tile();
  for_each_in_parallel(all.count(side), options, [&](int i) { fill(all.part(i, side)); });
}

/// Returns the function radiance(ray) of an integrator in a scene.
[[nodiscard]] auto radiance_in(const auto& scene, const auto& integrator) {
  return [&](const Ray& ray) { return radiance_of(integrator, ray, scene); };
}

}  // namespace detail

/// Fills an image with the view of a camera, one ray through each pixel's center unless the options say
/// otherwise; radiance(ray) returns the radiance along a ray, and is called from several threads at once. The
/// picture is the same for any number of threads.
///
/// Throws std::invalid_argument for an invalid camera, a negative number of threads or samples and a crop
/// that does not contain the image, anything that radiance.validate() throws, if there is one, and anything
/// that radiance throws; the pixels of the image may then have any color.
void render(Image& image, const Camera& camera, const Radiance auto& radiance,
            const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(radiance);
  const PixelGrid pixels(image.width(), image.height(), options);
  detail::fill_tiles(image, 32, options,
                     [&](const Tile& tile) { detail::fill_pixels(image, tile, camera, pixels, radiance); });
}

/// Fills an image with the view of a camera in a scene, by an integrator. Throws as the render of a Radiance
/// does.
template <Traceable S, Integrator<S> I>
void render(Image& image, const Camera& camera, const S& scene, const I& integrator,
            const RenderOptions& options = {}) {
  detail::validate(integrator);
  render(image, camera, detail::radiance_in(scene, integrator), options);
}

/// Stops the compiler with a sentence on why the arguments cannot be rendered.
template <class R>
requires(!Radiance<R>) void render(Image&, const Camera&, const R&, const RenderOptions& = {}) {
  static_assert(detail::RadianceRequirements<R>::hold);
}
template <class S, class I>
requires(!(Traceable<S> && Integrator<I, S>)) void render(Image&, const Camera&, const S&, const I&,
                                                          const RenderOptions& = {}) {
  if constexpr (!Traceable<S>)
    static_assert(detail::TraceableRequirements<S>::hold);
  else
    static_assert(detail::IntegratorRequirements<I, S>::hold);
}

}  // namespace protostar::inline PROTOSTAR_ABI

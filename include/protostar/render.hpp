// The loop over the pixels (§2.2.5), in tiles, by several threads.
#pragma once

#include <algorithm>
#include <concepts>
#include <type_traits>

#include "accel/render_tiles.hpp"  // without this line every picture is the same, only later
#include "camera.hpp"
#include "image.hpp"
#include "parallel.hpp"
#include "render_options.hpp"
#include "scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// What gives the light that a ray brings: any function of a ray.
template <class F>
concept Radiance = std::is_invocable_r_v<Color, const F&, const Ray&>;

/// What gives the light that a ray brings in a scene: a struct with radiance(ray, scene), or a function of
/// both.
template <class I, class S>
concept Integrator = std::is_invocable_r_v<Color, const I&, const Ray&, const S&> ||
    requires(const I& integrator, const Ray& ray, const S& scene) {
  { integrator.radiance(ray, scene) } -> std::convertible_to<Color>;
};

namespace detail {

/// Fills the pixels of a tile, one ray after the other.
void fill_pixels(Image& image, const Tile& tile, const Camera& camera, const auto& radiance) {
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x)
      image(x, y) = radiance(camera.through_pixel(x, y, image.width(), image.height()));
}

/// Fills an image by tiles, which threads take as they come.
void fill_tiles(const Image& image, const RenderOptions& options, const auto& fill) {
  constexpr int side = 64;  // of a tile, in pixels
  const Tile all = image.tile();
  for_each_in_parallel(all.count(side), options, [&](int i) { fill(all.part(i, side)); });
}

}  // namespace detail

/// Fills an image with what a camera sees, one ray through each pixel's center; radiance says what a ray
/// brings, and is called from several threads at once. The picture is the same for any number of threads.
///
/// Throws std::invalid_argument for an invalid camera or a negative number of threads, and whatever radiance
/// throws.
void render(Image& image, const Camera& camera, const Radiance auto& radiance,
            const RenderOptions& options = {}) {
  camera.validate();
  detail::fill_tiles(image, options,
                     [&](const Tile& tile) { detail::fill_pixels(image, tile, camera, radiance); });
}

namespace detail {

/// What an integrator says that a ray brings in a scene.
template <class S, Integrator<S> I>
[[nodiscard]] Color radiance_of(const I& integrator, const Ray& ray, const S& scene) {
  if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const S&>)
    return integrator(ray, scene);
  else
    return integrator.radiance(ray, scene);
}

}  // namespace detail

/// What fills a tile of an image with what a camera sees of a scene: here, one ray after the other. For
/// scenes, accel/ has one that gives the same bytes sooner.
template <class S, class I>
auto tile_filler(Image& image, const Camera& camera, const S& scene, const I& integrator,
                 const RenderOptions&) {
  return [&](const Tile& tile) {
    detail::fill_pixels(image, tile, camera,
                        [&](const Ray& ray) { return detail::radiance_of(integrator, ray, scene); });
  };
}

/// Fills an image with what a camera sees of a scene, through an integrator. Errors as above.
template <Traceable S, Integrator<S> I>
void render(Image& image, const Camera& camera, const S& scene, const I& integrator,
            const RenderOptions& options = {}) {
  if (!options.tiles)
    return render(
        image, camera, [&](const Ray& ray) { return detail::radiance_of(integrator, ray, scene); }, options);
  camera.validate();
  detail::fill_tiles(image, options, tile_filler(image, camera, scene, integrator, options));
}

}  // namespace protostar::inline PROTOSTAR_ABI

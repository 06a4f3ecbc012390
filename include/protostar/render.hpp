// The loop over the pixels (§2.2.5), in tiles, by several threads.
#pragma once

#include <algorithm>
#include <concepts>
#include <type_traits>

#include "accel/render_tiles.hpp"
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

/// Fills an image with what a camera sees, one ray through each pixel's center; radiance says what a ray
/// brings, and is called from several threads at once. The picture is the same for any number of threads.
///
/// Throws std::invalid_argument for an invalid camera or a negative number of threads, and whatever radiance
/// throws.
void render(Image& image, const Camera& camera, const Radiance auto& radiance,
            const RenderOptions& options = {}) {
  camera.validate();
  constexpr int side = 32;  // of a tile, in pixels
  const int columns = (image.width() + side - 1) / side, rows = (image.height() + side - 1) / side;
  detail::for_each_in_parallel(columns * rows, options, [&](int tile) {
    const int x0 = tile % columns * side, y0 = tile / columns * side;
    const int x1 = std::min(x0 + side, image.width()), y1 = std::min(y0 + side, image.height());
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        image(x, y) = radiance(camera.through_pixel(x, y, image.width(), image.height()));
  });
}

namespace detail {
template <class S, class I>
inline constexpr bool can_tile = false;
template <Surface... S, simd::PacketIntegrator I>
inline constexpr bool can_tile<Scene<S...>, I> = true;
}  // namespace detail

/// Fills an image with what a camera sees of a scene, through an integrator. Errors as above.
template <Traceable S, Integrator<S> I>
void render(Image& image, const Camera& camera, const S& scene, const I& integrator,
            const RenderOptions& options = {}) {
  if constexpr (detail::can_tile<S, I>) {
    camera.validate();
    const simd::TileRenderer tiles(image, camera, scene, integrator);
    constexpr int side = 64;  // of a tile, in pixels
    const int columns = (image.width() + side - 1) / side, rows = (image.height() + side - 1) / side;
    detail::for_each_in_parallel(columns * rows, options, [&](int i) {
      const int x0 = i % columns * side, y0 = i / columns * side;
      tiles(simd::Tile{x0, y0, std::min(x0 + side, image.width()), std::min(y0 + side, image.height())});
    });
    return;
  }
  const auto radiance = [&](const Ray& ray) -> Color {
    if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const S&>)
      return integrator(ray, scene);
    else
      return integrator.radiance(ray, scene);
  };
  render(image, camera, radiance, options);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// What an integrator is, and the plain way from it to pixels: one ray after the other.
#pragma once

#include <concepts>
#include <type_traits>

#include "camera.hpp"
#include "image.hpp"
#include "pixels.hpp"
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

/// What an integrator says that a ray brings in a scene.
template <class I, class S>
[[nodiscard]] Color radiance_of(const I& integrator, const Ray& ray, const S& scene) {
  if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const S&>)
    return integrator(ray, scene);
  else
    return integrator.radiance(ray, scene);
}

/// Fills the pixels of a tile with what a function says that their rays bring.
void fill_pixels(Image& image, const Tile& tile, const Camera& camera, const PixelGrid& pixels,
                 const auto& radiance) {
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x)
      image(x, y) = pixels.mean([&](int i) -> Color { return radiance(pixels.ray(camera, x, y, i)); });
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

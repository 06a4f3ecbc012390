// The integrator concept, and the plain path from an integrator to pixels: one ray after the other.
#pragma once

#include <concepts>
#include <type_traits>

#include "camera.hpp"
#include "image.hpp"
#include "scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Function of a ray that returns the radiance along it.
template <class F>
concept Radiance = std::is_invocable_r_v<Color, const F&, const Ray&>;

/// Integrator of a scene: a struct with radiance(ray, scene), or a function of both, that returns the
/// radiance along a ray. It may have validate() const, which throws std::invalid_argument if a field makes no
/// sense; render calls it once, before the first ray.
template <class I, class S>
concept Integrator = std::is_invocable_r_v<Color, const I&, const Ray&, const S&> ||
    requires(const I& integrator, const Ray& ray, const S& scene) {
  { integrator.radiance(ray, scene) } -> std::convertible_to<Color>;
};

namespace detail {

/// Checks the members that a Traceable needs. As in surface_requirements.hpp, instantiating it stops the
/// compiler with a sentence on the missing member.
template <class S>
struct TraceableRequirements {
  static constexpr bool hold = true;

  static_assert(
      requires(const S& scene, const Ray& ray, Interval range) {
        { scene.intersect(ray, range) } -> std::same_as<std::optional<Intersection>>;
      },
      "Traceable: the scene has no std::optional<Intersection> intersect(const Ray&, Interval) const");
  static_assert(
      requires(const S& scene, const Ray& ray, Interval range) {
        { scene.occluded(ray, range) } -> std::same_as<bool>;
      },
      "Traceable: the scene has no bool occluded(const Ray&, Interval) const");
  static_assert(
      requires(const S& scene, const Ray& ray, Interval range) {
        scene.crossings(ray, range, [](const Intersection&) {});
      },
      "Traceable: the scene has no crossings(const Ray&, Interval, visit) const");
};

/// Checks the members that an Integrator needs.
template <class I, class S>
struct IntegratorRequirements {
  static constexpr bool hold = true;

  static constexpr bool has_radiance = requires(const I& integrator, const Ray& ray, const S& scene) {
    integrator.radiance(ray, scene);
  };
  static constexpr bool is_function = std::is_invocable_v<const I&, const Ray&, const S&>;
  static_assert(has_radiance || is_function,
                "Integrator: the type has no radiance(const Ray&, const Scene&) const, and is no function of "
                "both; for the scene write `const auto&` or its type");
  static_assert(Integrator<I, S> || !has_radiance,
                "Integrator: radiance(const Ray&, const Scene&) const does not return a Color");
  static_assert(Integrator<I, S> || has_radiance || !is_function,
                "Integrator: the function of a ray and a scene does not return a Color");
};

/// Checks that a type is a Radiance.
template <class F>
struct RadianceRequirements {
  static constexpr bool hold = true;

  static constexpr bool is_function = std::is_invocable_v<const F&, const Ray&>;
  static_assert(!Traceable<F>, "render: a scene is followed by an integrator");
  static_assert(
      Traceable<F> || is_function,
      "render: what follows the camera is neither a function of a const Ray& that may be called when "
      "const, nor a scene and an integrator");
  static_assert(Radiance<F> || !is_function, "render: the function of a ray does not return a Color");
};

/// Calls validate() of an integrator, or of a function of a ray, if it has one, which throws
/// std::invalid_argument if a field makes no sense.
void validate(const auto& radiance) {
  if constexpr (requires { radiance.validate(); }) radiance.validate();
}

/// Returns the radiance along a ray in a scene, as an integrator computes it.
template <class I, class S>
[[nodiscard]] Color radiance_of(const I& integrator, const Ray& ray, const S& scene) {
  if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const S&>)
    return integrator(ray, scene);
  else
    return integrator.radiance(ray, scene);
}

/// Fills the pixels of a tile with the mean radiance of their rays, radiance(ray) for each.
void fill_pixels(Image& image, const Tile& tile, const Camera& camera, const PixelGrid& pixels,
                 const auto& radiance) {
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x)
      image(x, y) = pixels.mean([&](int i) -> Color { return radiance(pixels.ray(camera, x, y, i)); });
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI

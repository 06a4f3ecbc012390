// The loop over the pixels (§2.2.5), ray by ray, in tiles that several threads share; and the integrators
// that tell it the color of a ray.
//
// accel/render_tiles.hpp overloads render for scenes and gives the same bytes faster; protostar.hpp includes
// both.
#pragma once

#include <concepts>
#include <type_traits>

#include "camera.hpp"
#include "image.hpp"
#include "parallel.hpp"
#include "pixel_grid.hpp"
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

/// Supplies radiance and background to an integrator that derives from it and has shade(hit, scene): the
/// radiance of a ray is that of its closest hit.
template <class Integrator>
struct FirstHit {
  /// Returns shade(hit, scene) of the closest hit, or background(ray, scene) if there is none.
  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto& integrator = static_cast<const Integrator&>(*this);
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? integrator.shade(*hit, scene) : integrator.background(ray, scene);
  }

  /// Returns the radiance of a ray that hits nothing: the sky's, or black.
  template <class R>
  [[nodiscard]] typename R::Light background(const R& ray, const auto& scene) const {
    return sky_of(ray, scene, Color{0});
  }
};

namespace detail {

/// Calls validate() of an integrator, or of a function of a ray, if it has one, which throws
/// std::invalid_argument if a field makes no sense.
void validate(const auto& radiance) {
  if constexpr (requires { radiance.validate(); }) radiance.validate();
}

/// Returns the function radiance(ray) of an integrator in a scene.
template <class S, class I>
[[nodiscard]] auto radiance_in(const S& scene, const I& integrator) {
  return [&](const Ray& ray) -> Color {
    if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const S&>)
      return integrator(ray, scene);
    else
      return integrator.radiance(ray, scene);
  };
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
  const Tile all = image.tile();
  detail::for_each_in_parallel(all.count(32), options, [&](int i) {
    const Tile tile = all.part(i, 32);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x)
        image(x, y) =
            pixels.mean([&](int sample) { return Color(radiance(pixels.ray(camera, x, y, sample))); });
  });
}

/// Fills an image with the view of a camera in a scene, by an integrator. Throws as the render of a Radiance
/// does.
template <Traceable S, Integrator<S> I>
void render(Image& image, const Camera& camera, const S& scene, const I& integrator,
            const RenderOptions& options = {}) {
  detail::validate(integrator);
  render(image, camera, detail::radiance_in(scene, integrator), options);
}

namespace detail {

/// Checks the members that a Traceable needs. As in surface_concepts.hpp, instantiating it stops the
/// compiler with a sentence on the missing member.
template <class S>
struct TraceableRequirements {
  static constexpr bool hold = true;

  static_assert(
      has_closest_hit<S>,
      "Traceable: the scene has no std::optional<Intersection> intersect(const Ray&, Interval) const");
  static_assert(has_any_hit<S>, "Traceable: the scene has no bool occluded(const Ray&, Interval) const");
  static_assert(has_all_hits<S>, "Traceable: the scene has no crossings(const Ray&, Interval, visit) const");
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

}  // namespace detail

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

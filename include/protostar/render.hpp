// The loop over the pixels (§2.2.5), ray by ray, in tiles that several threads share; and the integrators
// that tell it the color of a ray.
//
// accel/render_tiles.hpp overloads render for scenes and gives the same bytes faster; protostar.hpp includes
// both.
#pragma once

#include <concepts>
#include <type_traits>
#include <utility>

#include "camera.hpp"
#include "image.hpp"
#include "intersection.hpp"
#include "parallel.hpp"
#include "pixel_grid.hpp"
#include "sampling/film.hpp"
#include "sampling/hammersley_sampler.hpp"
#include "sampling/passes.hpp"
#include "sampling/pixel_sampler.hpp"
#include "sampling/sample_target.hpp"
#include "sampling/sobol_sampler.hpp"
#include "scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Tests whether an integrator, or a function, takes a ray and these arguments, and returns a Color.
template <class I, class... Rest>
concept Radiates = std::is_invocable_r_v<Color, const I&, const Ray&, const Rest&...> ||
    requires(const I& integrator, const Ray& ray, const Rest&... rest) {
  { integrator.radiance(ray, rest...) } -> std::convertible_to<Color>;
};

/// Tests whether an integrator has a shade that takes these.
template <class I, class S, class... Sampler>
concept ShadesHits = requires(const I& integrator, const Intersection& hit, const S& scene,
                              const Sampler&... sampler) {
  integrator.shade(hit, scene, sampler...);
};

}  // namespace detail

/// Function of a ray, or of a ray and a PixelSampler, that returns the radiance along the ray.
template <class F>
concept Radiance = std::is_invocable_r_v<Color, const F&, const Ray&> ||
    std::is_invocable_r_v<Color, const F&, const Ray&, const PixelSampler&>;

/// Integrator of a scene: a struct with radiance(ray, scene) or radiance(ray, scene, sampler), or a function
/// of these, that returns the radiance along a ray. The sampler gives random numbers (PixelSampler). An
/// integrator may have validate() const, which throws std::invalid_argument if a field makes no sense; render
/// calls it once, before the first ray.
template <class I, class S>
concept Integrator = detail::Radiates<I, S> || detail::Radiates<I, S, PixelSampler>;

/// Supplies radiance and background to an integrator that derives from it and has shade(hit, scene) or
/// shade(hit, scene, sampler): the radiance of a ray is that of its closest hit.
template <class Derived>
struct FirstHit {
  /// Returns shade of the closest hit, or background(ray, scene) if there is none. The sampler is given on,
  /// if there is one.
  template <Traceable S, class... Sampler>
  requires detail::ShadesHits<Derived, S, Sampler...>
  [[nodiscard]] Color radiance(const Ray& ray, const S& scene, const Sampler&... sampler) const {
    const auto& integrator = static_cast<const Derived&>(*this);
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? integrator.shade(*hit, scene, sampler...) : integrator.background(ray, scene);
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

/// True for a function, or an integrator in a scene, that takes a sampler. If it may be called without one as
/// well, it gets one.
template <class I, class... S>
inline constexpr bool takes_sampler = Radiates<I, S..., PixelSampler>;

/// Returns the sampler of those that are given none by the user: SobolSampler if the integrator takes a
/// sampler or the camera has a lens or an open shutter, otherwise HammersleySampler.
template <class I, class... S>
[[nodiscard]] const SamplerChoice& default_sampler(const Camera& camera) {
  return takes_sampler<I, S...> || camera.has_lens() || camera.shutter.is_open()
             ? sampler_of<SobolSampler>
             : sampler_of<HammersleySampler>;
}

/// Calls an integrator, or a function, with a ray and the rest of what it takes.
template <class I, class... Rest>
[[nodiscard]] Color radiance_along(const Ray& ray, const I& integrator, const Rest&... rest) {
  if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const Rest&...>)
    return integrator(ray, rest...);
  else
    return integrator.radiance(ray, rest...);
}

// &I::name is a pointer to a member of the class that declares it: of a base only where I inherits it.

/// Names the integrator whose FirstHit a type derives from.
template <class Base>
Base base_of(const FirstHit<Base>&);

/// Tests whether a type takes a function from the base.
template <class I, class Base, class S, class... Sampler>
inline constexpr bool takes_radiance = requires(Color (FirstHit<Base>::*& of_base)(const Ray&, const S&,
                                                                                   const Sampler&...) const) {
  of_base = &I::radiance;
};
template <class I, class Base, class S, class... Sampler>
inline constexpr bool takes_shade = requires(Color (Base::*& of_base)(const Intersection&, const S&,
                                                                      const Sampler&...) const) {
  of_base = &I::shade;
};
template <class I, class Base, class S>
inline constexpr bool takes_background = requires(Color (Base::*& of_base)(const Ray&, const S&) const) {
  of_base = &I::background;
};

/// True for a type that takes radiance from its base, and declares a shade or a background, which that
/// radiance does not call.
template <class I, class S, class... Sampler>
inline constexpr bool shades_in_vain = false;
template <class I, class S, class... Sampler>
requires requires(const I& integrator) { base_of(integrator); }
inline constexpr bool shades_in_vain<I, S, Sampler...> = [] {
  using Base = decltype(base_of(std::declval<const I&>()));
  return takes_radiance<I, Base, S, Sampler...> &&
         ((takes_shade<Base, Base, S, Sampler...> && !takes_shade<I, Base, S, Sampler...>) ||
          (takes_background<Base, Base, S> && !takes_background<I, Base, S>));
}();

/// Returns an integrator in a scene as a function of a ray, and of a sampler if it takes one.
template <class S, class I>
[[nodiscard]] auto radiance_in(const S& scene, const I& integrator) {
  static_assert(!shades_in_vain<I, S> && !shades_in_vain<I, S, PixelSampler>,
                "Integrator: the type has a shade or a background of its own, but takes radiance from the "
                "base, which does not call it: derive from FirstHit<the type itself>");
  if constexpr (takes_sampler<I, S>)
    return [&](const Ray& ray, const PixelSampler& sampler) {
      return radiance_along(ray, integrator, scene, sampler);
    };
  else
    return [&](const Ray& ray) { return radiance_along(ray, integrator, scene); };
}

/// Returns the radiance along the ray of a sample, by a function that may take a sampler.
template <class F>
[[nodiscard]] Color radiance_of_sample(const F& radiance, const Ray& ray, const PixelSampler& sampler) {
  if constexpr (takes_sampler<F>)
    return radiance_along(ray, radiance, sampler);
  else
    return radiance_along(ray, radiance);
}

/// Returns draw(target, options), which renders the view of a camera into the image or film of a target, ray
/// by ray. Borrows its arguments.
template <Radiance F>
[[nodiscard]] auto ray_by_ray(const Camera& camera, const F& radiance) {
  return [&](const SampleTarget& target, const RenderOptions& options) {
    const PixelGrid pixels = target.grid(options, default_sampler<F>(camera));
    const Tile all = target.tile();
    for_each_in_parallel(all.count(32), options, [&](int i) {
      const Tile tile = all.part(i, 32);
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
          target.draw(pixels, x, y, [&](int sample, const auto& place) {
            return radiance_of_sample(radiance, pixels.ray(camera, x, y, sample, place),
                                      pixels.sampler(x, y, sample));
          });
    });
  };
}

/// Draws an image by draw(target, options), in passes if the options say so.
void draw_image(Image& image, const RenderOptions& options, const auto& draw) {
  const auto draw_in_passes = options.passes();
  if (draw_in_passes == nullptr) return draw(SampleTarget(image), options);
  draw_in_passes(image, options, [&](Film& film, const SampleRange& samples, const RenderOptions& pass) {
    draw(SampleTarget(film, samples), pass);
  });
}

/// Adds a range of samples of each pixel to a film by draw(target, options). An empty range adds nothing, but
/// the options are checked.
void draw_samples(Film& film, const SampleRange& samples, const RenderOptions& options, const auto& draw) {
  const SampleTarget target(film, samples);
  if (samples.first < samples.last) return draw(target, options);
  static_cast<void>(target.grid(options, sampler_of<HammersleySampler>));
  require_threads(options);
}

}  // namespace detail

/// Fills an image with the view of a camera, one ray through each pixel's center unless the options say
/// otherwise; radiance(ray) or radiance(ray, sampler) returns the radiance along a ray, and is called from
/// several threads at once. The picture is the same for any number of threads. With options.error or
/// options.seconds, samples are added in passes until the error is met or the time is used up, or
/// options.max_samples is reached; options.report then has the number of samples and the estimated error.
///
/// Returns early if a stop is requested: some pixels are then not drawn or, with passes, the image stays as
/// it was.
///
/// Throws std::invalid_argument for an invalid camera, a negative number of threads or samples, a crop that
/// does not contain the image and options that make no sense together, anything that radiance.validate()
/// throws, if there is one, and anything that radiance throws; the pixels of the image may then have any
/// color.
void render(Image& image, const Camera& camera, const Radiance auto& radiance,
            const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(radiance);
  detail::draw_image(image, options, detail::ray_by_ray(camera, radiance));
}

/// Adds samples of each pixel to a film, whose tile tells which part of the picture it is. The size of the
/// picture is that of options.crop, whose position is not used; without one, the picture ends where the tile
/// does.
///
/// Sums do not depend on the order, the ranges, the threads or the machines. After all options.samples > 1
/// samples have been added, the film's mean is the image that render gives. If options.samples is 0,
/// samples.last counts as their number; samplers whose numbers depend on it (StratifiedSampler,
/// HammersleySampler) need it to be the same each time. Film::error throws for films that have samples of
/// these two samplers: for an error, options.sampler is SobolSampler, IndependentSampler or HaltonSampler.
///
/// Throws what the render of an image does, and std::invalid_argument if samples.last is greater than
/// options.samples. If anything was thrown, or a stop requested, any part of the samples may have been added.
void add_samples(Film& film, const SampleRange& samples, const Camera& camera, const Radiance auto& radiance,
                 const RenderOptions& options = {}) {
  camera.validate();
  detail::validate(radiance);
  detail::draw_samples(film, samples, options, detail::ray_by_ray(camera, radiance));
}

/// Fills an image with the view of a camera in a scene, by an integrator. Throws as the render of a Radiance
/// does.
template <Traceable S, Integrator<S> I>
void render(Image& image, const Camera& camera, const S& scene, const I& integrator,
            const RenderOptions& options = {}) {
  detail::validate(integrator);
  render(image, camera, detail::radiance_in(scene, integrator), options);
}

/// Adds samples of a camera's view in a scene to a film.
template <Traceable S, Integrator<S> I>
void add_samples(Film& film, const SampleRange& samples, const Camera& camera, const S& scene,
                 const I& integrator, const RenderOptions& options = {}) {
  detail::validate(integrator);
  add_samples(film, samples, camera, detail::radiance_in(scene, integrator), options);
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
  }
  || requires(const I& integrator, const Ray& ray, const S& scene, const PixelSampler& sampler) {
    integrator.radiance(ray, scene, sampler);
  };
  static constexpr bool is_function =
      std::is_invocable_v<const I&, const Ray&, const S&> ||
      std::is_invocable_v<const I&, const Ray&, const S&, const PixelSampler&>;
  static constexpr bool shades = std::is_base_of_v<FirstHit<I>, I>;
  static_assert(
      has_radiance || !shades,
      "Integrator: the type derives from FirstHit and has no shade(const Hit&, const Scene&) const, "
      "nor one with a sampler as third parameter; for each write `const auto&`");
  static_assert(has_radiance || is_function || shades,
                "Integrator: the type has no radiance(const Ray&, const Scene&) const, and is no function of "
                "both, nor of both and a sampler; for the scene and the sampler write `const auto&`, or for "
                "the scene its type and for the sampler PixelSampler");
  static_assert(Integrator<I, S> || !has_radiance,
                "Integrator: radiance(const Ray&, const Scene&) const, or with a sampler, does not return a "
                "Color");
  static_assert(Integrator<I, S> || has_radiance || !is_function,
                "Integrator: the function of a ray and a scene does not return a Color");
};

/// Checks that a type is a Radiance.
template <class F>
struct RadianceRequirements {
  static constexpr bool hold = true;

  static constexpr bool is_function = std::is_invocable_v<const F&, const Ray&> ||
                                      std::is_invocable_v<const F&, const Ray&, const PixelSampler&>;
  static_assert(!Traceable<F>, "render: a scene is followed by an integrator");
  static_assert(
      Traceable<F> || is_function,
      "render: what follows the camera is neither a function of a const Ray&, or of it and a sampler, that "
      "may be called when const, nor a scene and an integrator");
  static_assert(Radiance<F> || !is_function, "render: the function of a ray does not return a Color");
};

/// Checks what a scene and an integrator need, the scene first.
template <class S, class I>
constexpr void require_integrator() {
  if constexpr (!Traceable<S>)
    static_assert(TraceableRequirements<S>::hold);
  else
    static_assert(IntegratorRequirements<I, S>::hold);
}

}  // namespace detail

/// Stops the compiler with a sentence on why the arguments cannot be rendered.
template <class R>
requires(!Radiance<R>) void render(Image&, const Camera&, const R&, const RenderOptions& = {}) {
  static_assert(detail::RadianceRequirements<R>::hold);
}
template <class R>
requires(!Radiance<R>) void add_samples(Film&, const SampleRange&, const Camera&, const R&,
                                        const RenderOptions& = {}) {
  static_assert(detail::RadianceRequirements<R>::hold);
}
template <class S, class I>
requires(!(Traceable<S> && Integrator<I, S>)) void render(Image&, const Camera&, const S&, const I&,
                                                          const RenderOptions& = {}) {
  detail::require_integrator<S, I>();
}
template <class S, class I>
requires(!(Traceable<S> && Integrator<I, S>)) void add_samples(Film&, const SampleRange&, const Camera&,
                                                               const S&, const I&,
                                                               const RenderOptions& = {}) {
  detail::require_integrator<S, I>();
}

}  // namespace protostar::inline PROTOSTAR_ABI

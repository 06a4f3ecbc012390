// Scenes: surfaces and lights, and the three queries of a ray (§2.3.1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "environment.hpp"
#include "large_pages.hpp"
#include "light.hpp"
#include "material.hpp"
#include "surface.hpp"
#include "surface_concepts.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

// Tests whether a type answers one of the queries, for the concept and for the sentences on what is missing.

template <class T>
inline constexpr bool has_closest_hit = requires(const T& scene, const Ray& ray, Interval range) {
  { scene.intersect(ray, range) } -> std::same_as<std::optional<Intersection>>;
};
template <class T>
inline constexpr bool has_any_hit = requires(const T& scene, const Ray& ray, Interval range) {
  { scene.occluded(ray, range) } -> std::same_as<bool>;
};
template <class T>
inline constexpr bool has_all_hits = requires(const T& scene, const Ray& ray, Interval range,
                                              void (*visit)(const Intersection&)) {
  scene.crossings(ray, range, +visit);  // a temporary, as visitors mostly are
};

}  // namespace detail

/// Scene, or a type that stands in for one and answers the three queries of a ray.
///   intersect(ray, range)         closest hit
///   occluded(ray, range)          any hit
///   crossings(ray, range, visit)  all hits
/// Integrators of light also ask it for lights(), ambient(), sky() and environment(), as Scene has them; all
/// but lights() may be missing.
template <class T>
concept Traceable = detail::has_closest_hit<T> && detail::has_any_hit<T> && detail::has_all_hits<T>;

/// Traces the ray; returns shade(hit), or background() if it misses. A scene may offer it for several rays at
/// once.
template <class R>
[[nodiscard]] typename R::Light follow(const R& ray, const auto& scene, const auto& background,
                                       const auto& shade) {
  if constexpr (requires { scene.follow(ray, background, shade); }) {
    return scene.follow(ray, background, shade);
  } else {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit) : background();
  }
}

/// Traces several rays one by one; returns shade(hit) for each, or background() if it misses.
template <class R>
[[nodiscard]] typename R::Light follow_each(const R& ray, const auto& scene, const auto& background,
                                            const auto& shade) {
  if constexpr (requires { scene.follow_each(ray, background, shade); })
    return scene.follow_each(ray, background, shade);
  else
    return follow(ray, scene, background, shade);
}

/// Tests one surface. If its first crossing in the range precedes `first`, stores it there. Returns the new
/// end of the range: crossings that may still precede `first`, given the error of t, lie before it.
template <Surface T>
[[nodiscard, gnu::noinline]] double take_if_closer(const T& surface, const Material& material, const Ray& ray,
                                                   Interval range, SurfaceCrossing& first) {
  const auto crossing = first_crossing(surface, ray, range);
  if (!crossing) return range.max;
  const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
  if (first.surface != nullptr && !precedes(ray, candidate, first)) return range.max;
  first = candidate;
  return std::min(range.max, upper_bound_of(crossing->t));
}

/// Searches the closest hit among surfaces of one type: tests one after the other, stores the closest hit so
/// far in `first`, whose surface is null until there is one, and returns the new end of the range. The order
/// is exact between surfaces with an equation, and as exact as exact_root of a composite surface; any other
/// surface's t is taken as exact. Among hits at equal t, the surface tested first wins.
///
/// If the surfaces have an equation, no instance has mapped the ray and the range begins at 0, their first
/// roots in double nearly always decide by a few comparisons: a root below `sooner` surely precedes the
/// closest hit so far and lies in the range; one not below `later` surely does not (docs/derivations.md,
/// Which comes first).
template <Surface T>
[[nodiscard]] double search_closest_hit(const SceneVector<T>& surfaces,
                                        const SceneVector<Material>& materials, const Ray& ray,
                                        Interval range, SurfaceCrossing& first) {
  if constexpr (SurfaceWithEquation<T> && !SurfaceWithRoots<T>)
    if (range.min == 0 && ray.transform == nullptr) {
      const detail::CopiedLine line{ray.origin, ray.direction};
      constexpr double error = Roots::relative_error;
      const bool departs = ray.departure.kind != Departure::Kind::none;
      double end = range.max, sooner = (1 - 8 * error) * end, later = (1 + 2 * error) * end;
      const T* const all = surfaces.data();
      for (std::size_t i = 0, count = surfaces.size(); i < count; ++i) {
        const T& surface = all[i];
        const auto e = surface.equation(line);
        const bool leaves = departs && surface.is_left_by(ray);
        if (e.surely_misses() && !leaves) continue;
        const auto root = first_root_of_each(e, true);
        const bool is_known = !root.in_doubt && !leaves;
        if (is_known && !(root.is_there && root.t < later)) continue;
        if (is_known && root.t < sooner) {
          first = crossing_on(surface, {root.t, root.is_far}, materials[i]);
          end = (1 + 4 * error) * root.t;  // less than before
        } else {
          end = take_if_closer(surface, materials[i], ray, {0, end}, first);
        }
        sooner = (1 - 8 * error) * end, later = (1 + 2 * error) * end;
      }
      return end;
    }
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    range.max = take_if_closer(surfaces[i], materials[i], ray, range, first);
  return range.max;
}

/// Searches any hit among surfaces of one type; returns true at the first in the range. Few operations tell
/// that an equation has no root, which is so for most surfaces.
template <Surface T>
[[nodiscard]] bool search_any_hit(const SceneVector<T>& surfaces, const Ray& ray, const Interval& range) {
  if constexpr (SurfaceWithEquation<T> && !SurfaceWithRoots<T>)
    if (range.min == 0 && (range.max == 1 || range.max == infinity) && ray.transform == nullptr) {
      const detail::CopiedLine line{ray.origin, ray.direction};
      const bool departs = ray.departure.kind != Departure::Kind::none, is_segment = range.max == 1;
      for (const T& surface : surfaces) {
        const auto e = surface.equation(line);
        const bool leaves = departs && surface.is_left_by(ray);
        if (e.surely_misses() && !leaves) continue;
        const auto known =
            leaves ? crossed_by_each(detail::equation_of_departing(surface, ray), true, is_segment)
                   : crossed_by_each(e, true, is_segment);
        if (known.in_doubt ? first_crossing(surface, ray, range).has_value() : known.crossed) return true;
      }
      return false;
    }
  for (const T& surface : surfaces)
    if (any_hit(surface, ray, range)) return true;
  return false;
}

namespace detail {

template <class... T>
inline constexpr bool are_distinct = true;
template <class First, class... Rest>
inline constexpr bool are_distinct<First, Rest...> =
    (!std::same_as<First, Rest> && ...) && are_distinct<Rest...>;

}  // namespace detail

/// Collection of surfaces of the named types. If one is no Surface, the compiler names it and the members
/// that it lacks.
template <class... S>
class Scene;

/// Collection of surfaces of the named types, each type in a vector of its own: types that are not named cost
/// nothing.
///
/// The order of the surfaces is: by type as named, then as added. If two hits are at equal t, the earlier
/// surface's is the closest. Every ray misses a scene without surfaces, and a scene without lights is dark. A
/// const scene may be shared by threads.
template <Surface... S>
class Scene<S...> {
  static_assert(detail::are_distinct<S...>, "Scene: each type of surface is named once");
  static_assert((detail::SurfaceOffers<S>::hold && ...));

  template <class T>
  static constexpr bool takes = (std::convertible_to<T, S> || ...);
  template <class T>
  static constexpr bool is_incomplete = !takes<T> && detail::MeantAsSurface<T>;
  template <class T>
  static constexpr bool is_unlisted = !takes<T> && !detail::MeantAsSurface<T>;
  template <class M>
  static constexpr bool is_look = std::convertible_to<M, Material> || std::convertible_to<M, Color>;
  template <class T>
  static constexpr bool shines = std::convertible_to<T, Light> || std::convertible_to<T, AmbientLight>;

 public:
  /// Adds a surface of one of the scene's types, or of a type that converts to one; the first that takes it
  /// is used. Throws std::invalid_argument for a material or a surface that is not valid, and for a texture
  /// or a normal map on a surface that has no coordinates.
  template <class T>
  requires(takes<T>) void add(T surface, Material material) {
    material.validate();
    group_for<T>().add(std::move(surface), std::move(material));
  }

  /// Adds a matte surface of a color. Throws std::invalid_argument if the color is negative or not finite, or
  /// the surface is not valid.
  template <class T>
  requires(takes<T>) void add(T surface, const Color& color) {
    if (!is_light(color)) throw std::invalid_argument("Scene::add: color must be finite and not negative");
    group_for<T>().add(std::move(surface), Material{.diffuse = color});
  }

  /// Largest number of lights. They add up to less than the largest float, 2^128: none brings more than 2^107
  /// (most_irradiance), and neither do all ambient ones together.
  static constexpr std::size_t most_lights = std::size_t{1} << 20;

  /// Adds a light: a PointLight, or any other that Light takes. Throws std::invalid_argument for one that is
  /// not valid, or one too many.
  void add(const Light& light) {
    if (lights_.size() == most_lights)
      throw std::invalid_argument("Scene::add: a scene has at most " + std::to_string(most_lights) +
                                  " lights");
    lights_.push_back(light);
  }

  // Overloads for arguments that cannot be added. A type meant as a surface is told the members that it
  // lacks; for a call of a deleted function, compilers show its line.
  template <class T>
  requires(is_incomplete<T>) void add(const T&, const Material&) {
    static_assert(detail::SurfaceRequirements<T>::hold);
  }
  template <class T>
  requires(is_incomplete<T>) void add(const T&, const Color&) {
    static_assert(detail::SurfaceRequirements<T>::hold);
  }
  template <class T>
  requires(is_unlisted<T>) void add(const T&, const Material&) = delete;  // not in the list of this Scene
  template <class T>
  requires(is_unlisted<T>) void add(const T&, const Color&) = delete;  // not in the list of this Scene
  template <class T, class M>
  requires(!is_look<M>) void add(const T&, const M&) = delete;  // a surface goes with a Material or a Color
  template <class T>
  requires(!shines<T>) void add(const T&) = delete;  // no light, and a surface needs a Material or a Color

  /// Adds ambient light: irradiance of all points, whose sum is clamped to most_irradiance. Throws
  /// std::invalid_argument if the light is negative or not finite.
  void add(const AmbientLight& light) {
    if (!is_light(light.intensity))
      throw std::invalid_argument("AmbientLight: intensity must be finite and not negative");
    for (int i = 0; i < 3; ++i)
      ambient_[i] = std::min(ambient_[i] + std::min(light.intensity[i], most_irradiance), most_irradiance);
  }

  /// Sets the sky: the radiance of rays that hit nothing. Throws std::invalid_argument if it is negative or
  /// not finite.
  void set_sky(const Color& sky) {
    if (!is_light(sky)) throw std::invalid_argument("Scene::set_sky: sky must be finite and not negative");
    sky_ = sky;
  }

  /// Sets the environment: the radiance of rays that hit nothing, as a function of their unit direction, or
  /// of its u and v (environment_uv), with 0 ≤ v < 1. It takes precedence over the sky. Throws
  /// std::invalid_argument for an empty function.
  void set_environment(Environment environment) {
    if (!environment)
      throw std::invalid_argument(
          "Scene::set_environment: environment must be a function that can be called");
    environment_ = std::move(environment);
    ++environment_version_;
  }

  /// Returns the closest hit in the range, if there is one. The order is exact between surfaces with an
  /// equation, and as exact as exact_root of a composite surface; any other surface's t is taken as exact.
  [[nodiscard, gnu::noinline]] std::optional<Intersection> intersect(
      const Ray& ray, [[maybe_unused]] Interval range = {}) const {
    SurfaceCrossing first;
    ((range.max = search_closest_hit(surfaces<S>(), materials<S>(), ray, range, first)), ...);
    if (first.surface == nullptr) return std::nullopt;
    return std::optional<Intersection>(std::in_place, ray, first);  // built where the caller wants it
  }

  /// Returns true if there is any hit in the range. The first one found ends the search.
  [[nodiscard]] bool occluded(const Ray& ray, [[maybe_unused]] Interval range = {}) const {
    return (search_any_hit(surfaces<S>(), ray, range) || ...);
  }

  /// Calls visit(const Intersection&) for all hits in the range, in the order of the surfaces, not along the
  /// ray; hits on one surface come near before far. A point of tangency counts as two hits, but as one on a
  /// surface that offers only intersect.
  void crossings(const Ray& ray, Interval range, auto&& visit) const {
    [[maybe_unused]] const auto on_each = [&](const auto& surfaces, const auto& materials) {
      for (std::size_t i = 0; i < surfaces.size(); ++i)
        each_crossing(surfaces[i], ray, range, [&](const Crossing& crossing) {
          const Intersection intersection(ray, crossing_on(surfaces[i], crossing, materials[i]));
          visit(intersection);
        });
    };
    (on_each(surfaces<S>(), materials<S>()), ...);
  }

  [[nodiscard]] const std::vector<Light>& lights() const { return lights_; }

  /// Returns the irradiance that is added everywhere: the sum of the ambient lights.
  [[nodiscard]] const Color& ambient() const { return ambient_; }

  /// Returns the radiance of rays that hit nothing; if empty, each integrator has its own.
  [[nodiscard]] const std::optional<Color>& sky() const { return sky_; }

  /// Returns the radiance of rays that hit nothing as a function of their direction; empty if there is none.
  [[nodiscard]] const Environment& environment() const { return environment_; }

  /// Returns a version number of the environment: 0 at first, one more after each set_environment.
  /// EnvironmentLight compares it to detect that its environment has been replaced.
  [[nodiscard]] std::size_t environment_version() const { return environment_version_; }

  /// Returns the number of surfaces.
  [[nodiscard]] std::size_t size() const { return (std::size_t{0} + ... + surfaces<S>().size()); }

  /// Returns the surfaces of one of the scene's types, or their materials, in the order of addition.
  template <class T>
  [[nodiscard]] const SceneVector<T>& surfaces() const {
    return group<T>().surfaces;
  }
  template <class T>
  [[nodiscard]] const SceneVector<Material>& materials() const {
    return group<T>().materials;
  }

  /// Returns true if any material of the surfaces of one type has a texture, or a normal map.
  template <class T>
  [[nodiscard]] bool has_textures() const {
    return group<T>().has_textures;
  }
  template <class T>
  [[nodiscard]] bool has_normal_maps() const {
    return group<T>().has_normal_maps;
  }

 private:
  /// Surfaces of one type, and their materials.
  template <Surface T>
  struct Group {
    SceneVector<T> surfaces;
    SceneVector<Material> materials;
    bool has_textures = false, has_normal_maps = false;  ///< true if any of the materials has one

    void add(T surface, Material material) {
      if constexpr (requires { surface.validate(); }) surface.validate();
      if (material.texture && !has_uv(surface))
        throw std::invalid_argument("Scene::add: a texture needs a surface with coordinates, uv_at(point)");
      if (material.normal_map && !has_tangents(surface))
        throw std::invalid_argument(
            "Scene::add: a normal map needs a surface with coordinates and their directions, uv_at(point) "
            "and tangents_at(point)");
      // If memory runs out, it does so before one of the vectors has grown.
      if (materials.size() == materials.capacity()) materials.reserve(2 * materials.size() + 1);
      surfaces.push_back(std::move(surface));
      has_textures = has_textures || material.texture;
      has_normal_maps = has_normal_maps || material.normal_map;
      materials.push_back(std::move(material));
    }
  };

  /// Group of each type. A std::tuple of them would take a compiler twenty functions for each.
  struct Groups : Group<S>... {};

  template <class T>
  [[nodiscard]] const Group<T>& group() const {
    return groups_;
  }

  /// Returns the group of a type, or of the first that it converts to.
  template <class T>
  auto& group_for() {
    constexpr bool is_listed = (std::same_as<T, S> || ...);
    constexpr bool takes_it[] = {is_listed ? std::same_as<T, S> : std::convertible_to<T, S>...};
    constexpr auto first = std::find(std::begin(takes_it), std::end(takes_it), true) - std::begin(takes_it);
    using Listed = std::tuple_element_t<static_cast<std::size_t>(first), std::tuple<S...>>;
    return static_cast<Group<Listed>&>(groups_);
  }

  Groups groups_;
  std::vector<Light> lights_;
  Color ambient_{0};
  std::optional<Color> sky_;
  Environment environment_;
  std::size_t environment_version_ = 0;
};

/// Scene that names a type which is no surface: it stops the compiler, with a sentence on each member that
/// the type lacks. All other uses of the scene compile.
template <class... S>
class Scene : public Scene<> {
  static_assert((detail::SurfaceRequirements<S>::hold && ...));

 public:
  void add(const auto&...) {}
  void add(const auto&, const Material&) {}
};

}  // namespace protostar::inline PROTOSTAR_ABI

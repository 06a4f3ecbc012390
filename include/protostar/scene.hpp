// Surfaces and lights, and the three questions that a ray asks of them (§2.3.1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "light.hpp"
#include "surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Whatever answers the three questions: a Scene, or what stands in for one. Integrators ask no more than
/// this.
///   intersect(ray, range)         what is met first?
///   occluded(ray, range)          is anything in the way?
///   crossings(ray, range, visit)  what is crossed at all?
/// and lights(), for what shines on it.
template <class T>
concept Traceable = requires(const T& scene, const Ray& ray, Interval range) {
  { scene.intersect(ray, range) } -> std::same_as<std::optional<Intersection>>;
  { scene.occluded(ray, range) } -> std::same_as<bool>;
  scene.crossings(ray, range, [](const Intersection&) {});
  { scene.lights() } -> std::convertible_to<const std::vector<PointLight>&>;
};

namespace detail {

template <class... T>
inline constexpr bool are_distinct = true;
template <class First, class... Rest>
inline constexpr bool are_distinct<First, Rest...> =
    (!std::same_as<First, Rest> && ...) && are_distinct<Rest...>;

}  // namespace detail

/// A collection of surfaces of the named types, each type in a vector of its own: what is not named costs
/// nothing.
///
/// The order of the surfaces is: by type as named, then as added. Of two crossings at equal t the earlier
/// surface's is the first. A scene without surfaces is a miss for every ray, and one without lights is dark.
/// A const scene may be shared by threads.
template <Surface... S>
class Scene {
  static_assert(detail::are_distinct<S...>, "a scene names each type of surface once");

 public:
  /// Adds a surface of one of the scene's types, or one that converts to the first of them that takes it, in
  /// a color (finite, not negative). Throws std::invalid_argument for a color or a surface that is not valid.
  template <class T>
  requires(std::convertible_to<T, S> || ...) void add(T surface, const Color& color) {
    if (!is_light(color)) throw std::invalid_argument("Scene::add: color must be finite and not negative");
    group_for<T>().add(std::move(surface), color);
  }

  /// Adds a light. Throws std::invalid_argument if it is not valid.
  void add(const PointLight& light) {
    light.validate();
    lights_.push_back(light);
  }

  /// The first crossing inside the range. The order is exact for surfaces that can refine their roots.
  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range = {}) const {
    SurfaceCrossing first;
    bool found = false;
    each_surface([&](const auto& surface, const Color& color) {
      const auto crossing = first_crossing(surface, ray, range);
      if (!crossing) return;
      const SurfaceCrossing candidate = crossing_on(surface, *crossing, color);
      if (found && !precedes(ray, candidate, first)) return;
      first = candidate;
      found = true;
      // Each hit shortens the range, so the last hit is the nearest. What might be before it, given its
      // error, stays in.
      range.max = std::min(range.max, crossing->t + 4 * Roots::relative_error * std::abs(crossing->t));
    });
    if (!found) return std::nullopt;
    return Intersection(ray, first);
  }

  /// Whether there is any crossing inside the range. The first one found ends the search.
  [[nodiscard]] bool occluded(const Ray& ray, Interval range = {}) const {
    return (std::get<Group<S>>(groups_).occluded(ray, range) || ...);
  }

  /// Calls visit(const Intersection&) for every crossing inside the range, in the order of the surfaces, not
  /// along the ray; of one surface, near before far. A point of tangency counts as two crossings.
  void crossings(const Ray& ray, Interval range, auto&& visit) const {
    each_surface([&](const auto& surface, const Color& color) {
      each_crossing(surface, ray, range, [&](const Crossing& crossing) {
        const Intersection intersection(ray, crossing_on(surface, crossing, color));
        visit(intersection);
      });
    });
  }

  [[nodiscard]] const std::vector<PointLight>& lights() const { return lights_; }

  /// The surfaces of one of the scene's types, and their colors, as they were added.
  template <class T>
  [[nodiscard]] const std::vector<T>& surfaces() const {
    return std::get<Group<T>>(groups_).surfaces;
  }
  template <class T>
  [[nodiscard]] const std::vector<Color>& colors() const {
    return std::get<Group<T>>(groups_).colors;
  }

 private:
  /// The surfaces of one type, and their colors.
  template <Surface T>
  struct Group {
    std::vector<T> surfaces;
    std::vector<Color> colors;

    void add(T surface, const Color& color) {
      if constexpr (SurfaceWithValidation<T>) surface.validate();
      if (colors.capacity() == surfaces.size())  // if memory ends, before one of them has grown
        colors.reserve(2 * surfaces.size() + 1);
      surfaces.push_back(std::move(surface));
      colors.push_back(color);
    }

    [[nodiscard]] bool occluded(const Ray& ray, Interval range) const {
      for (const T& surface : surfaces)
        if (first_crossing(surface, ray, range)) return true;
      return false;
    }
  };

  /// Calls visit(surface, color) for every surface, in order.
  void each_surface(auto&& visit) const {
    [[maybe_unused]] const auto in_group = [&](const auto& group) {
      for (std::size_t i = 0; i < group.surfaces.size(); ++i) visit(group.surfaces[i], group.colors[i]);
    };
    (in_group(std::get<Group<S>>(groups_)), ...);
  }

  template <class T>
  auto& group_for() {
    if constexpr ((std::same_as<T, S> || ...))
      return std::get<Group<T>>(groups_);
    else
      return first_group_taking<T, S...>();
  }

  template <class T, class First, class... Rest>
  auto& first_group_taking() {
    if constexpr (std::convertible_to<T, First>)
      return std::get<Group<First>>(groups_);
    else
      return first_group_taking<T, Rest...>();
  }

  std::tuple<Group<S>...> groups_;
  std::vector<PointLight> lights_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

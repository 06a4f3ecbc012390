// A scene with BVHs over its surfaces: the answers of the plain scene, sooner.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../bvh/box_space.hpp"
#include "../parallel.hpp"
#include "../plain_vector.hpp"
#include "../render_options.hpp"
#include "../scene.hpp"
#include "finder.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Faster stand-in for a Traceable.
template <class>
class Accelerated;

/// View of a scene with one BVH for each type of surface with bounds; surfaces without bounds are tested one
/// after the other. Its answers are those of the scene, to the last bit. Many threads may share it.
///
/// It borrows the scene, which has to live as long and keep its surfaces: the trees know those that were
/// there when they were built. If the scene has gained or lost surfaces since, each of intersect, occluded
/// and crossings, and render, throws std::logic_error; accelerate the scene again. Replacing surfaces in
/// equal number is not detected and leaves the BVHs and the constants of surfaces wrong. Lights, sky and
/// environment may change between two calls.
template <Surface... S>
class Accelerated<Scene<S...>> {
 public:
  [[gnu::cold]] explicit Accelerated(const Scene<S...>& scene, const RenderOptions& options = {})
      : scene_(&scene),
        counts_{scene.template surfaces<S>().size()...},
        finders_{simd::Finder<S>(scene.template surfaces<S>(), options)...} {
    if (scene.size() <= simd::few_surfaces) prepare_few();
    detail::require_threads(options);  // small trees do not look at them (threads_for)
  }
  explicit Accelerated(Scene<S...>&&, const RenderOptions& = {}) = delete;

  /// Returns the closest crossing inside the range, with no surface if there is none.
  [[nodiscard]] SurfaceCrossing closest_crossing([[maybe_unused]] const Ray& ray,
                                                 [[maybe_unused]] Interval range = {}) const {
    require_same_surfaces();
    SurfaceCrossing first;
    (look_for_first<S>(ray, range, first), ...);
    return first;
  }

  /// Returns the closest hit inside the range.
  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range = {}) const {
    const SurfaceCrossing first = closest_crossing(ray, range);
    if (first.surface == nullptr) return std::nullopt;
    return std::optional<Intersection>(std::in_place, ray, first);  // in place, since a ray is large
  }

  /// Returns true if there is any crossing inside the range.
  [[nodiscard]] bool occluded([[maybe_unused]] const Ray& ray, [[maybe_unused]] Interval range = {}) const {
    require_same_surfaces();
    return (occluded_by<S>(ray, range) || ...);
  }

  /// Calls visit(const Intersection&) for every crossing inside the range, in the order of the surfaces;
  /// crossings of one surface come near before far.
  void crossings(const Ray& ray, Interval range, auto&& visit) const {
    require_same_surfaces();
    (cross<S>(ray, range, visit), ...);
  }

  [[nodiscard]] const std::vector<Light>& lights() const { return scene_->lights(); }
  [[nodiscard]] const Color& ambient() const { return scene_->ambient(); }
  [[nodiscard]] const std::optional<Color>& sky() const { return scene_->sky(); }
  [[nodiscard]] const Environment& environment() const { return scene_->environment(); }
  /// Returns the version number of the scene's environment.
  [[nodiscard]] std::size_t environment_version() const { return scene_->environment_version(); }

  /// Returns the number of surfaces that the scene has now.
  [[nodiscard]] std::size_t size() const { return scene_->size(); }

  [[nodiscard]] const Scene<S...>& scene() const { return *scene_; }

  /// Returns the surfaces that tell by is_left_by that the ray departs from them: the one that it leaves, and
  /// all that coincide with it. Bit k is the k-th surface of the scene. Returns 0 for a ray from free space.
  /// Precondition: at most few_surfaces surfaces.
  [[nodiscard]] simd::Bits departed_together(const Ray& ray) const {
    if (ray.departure.kind == Departure::Kind::none) return 0;
    std::size_t index = 0;
    const auto is_of = [&]<class T>(std::type_identity<T>) {
      const std::uint32_t departed = departed_by<T>(ray);
      index += departed == simd::no_surface ? scene_->template surfaces<T>().size() : departed;
      return departed != simd::no_surface && !is_made_of_primitives<T>;
    };
    return (is_of(std::type_identity<S>{}) || ...) ? departed_together_[index] : left_by(ray);
  }

  /// Returns the constants of the k-th surface of the scene, valid as long as this view; null if the scene
  /// has more than few_surfaces surfaces, for which none are computed.
  [[nodiscard]] const SurfaceConstants* constants(std::size_t k) const {
    return scene_->size() <= simd::few_surfaces ? &constants_[k] : nullptr;
  }

  /// Returns the equations of all surfaces of a type, in their order: prepared ones, or the surfaces
  /// themselves. Precondition: at most few_surfaces surfaces.
  template <class T>
  [[nodiscard]] const auto& equations() const {
    if constexpr (PreparedSurface<T>)
      return static_cast<const PreparedAll<T>&>(prepared_).all;
    else
      return scene_->template surfaces<T>();
  }

  /// Replaces `first`, the closest hit of a ray inside a range among the surfaces of all types before T, or
  /// none, by the closest among those of T as well, and ends the range there. It does not ask whether the
  /// scene has changed (require_same_surfaces).
  template <class T>
  void look_for_first(const Ray& ray, Interval& range, SurfaceCrossing& first) const {
    const auto& surfaces = scene_->template surfaces<T>();
    const auto& materials = scene_->template materials<T>();
    if (surfaces.empty()) return;
    std::uint32_t first_index = 0;  // surfaces of other types looked at so far come before
    const auto look_at = [&](std::uint32_t i) {
      const auto crossing = first_crossing(surfaces[i], ray, range);
      if (!crossing) return;
      const SurfaceCrossing candidate = crossing_on(surfaces[i], *crossing, materials[i]);
      if (first.surface != nullptr && !precedes(ray, candidate, i, first, first_index)) return;
      first = candidate;
      first_index = i;
      // Crossings that may precede this one, given its error, stay in range.
      range.max = std::min(range.max, upper_bound_of(crossing->t));
    };
    const std::uint32_t departed = departed_by<T>(ray);
    if (departed != simd::no_surface && !leaves_for_good(surfaces[departed], ray, range)) look_at(departed);
    finder<T>().search_closest(ray, range, departed, look_at);
  }

  /// Throws std::logic_error if the scene has more or fewer surfaces of a type than when it was accelerated.
  void require_same_surfaces() const {
    [[maybe_unused]] std::size_t i = 0;
    if (((scene_->template surfaces<S>().size() != counts_[i++]) || ...)) [[unlikely]]
      refuse_other_surfaces();
  }

  /// Calls visit for groups of surfaces that no single half-space excludes, a superset of those that reach
  /// into their intersection. The sphere around a surface without bounds has an infinite radius.
  void frustum_query(std::span<const simd::HalfSpace> half_spaces, const simd::VisitSurfaces& visit) const {
    std::size_t first = 0;
    const auto search = [&]<class T>(const simd::Finder<T>& finder) {
      finder.frustum_query(half_spaces, static_cast<std::uint32_t>(first), visit);
      first += scene_->template surfaces<T>().size();
    };
    (search(finder<S>()), ...);
  }

 private:
  using Counts = std::array<std::size_t, sizeof...(S)>;  ///< number of surfaces of each type

  [[nodiscard]] Counts counts() const { return {scene_->template surfaces<S>().size()...}; }

  [[noreturn, gnu::noinline, gnu::cold]] void refuse_other_surfaces() const {
    const auto list = [](const Counts& counts) {
      std::string text;
      for (const std::size_t count : counts) text += (text.empty() ? "" : ", ") + std::to_string(count);
      return text;
    };
    throw std::logic_error("Accelerated: the scene had " + list(counts_) +
                           " surfaces of its types when it was accelerated, and now has " + list(counts()) +
                           "; accelerate it again after its surfaces have changed");
  }

  /// Calls visit(surface, k) for each surface, the k-th of the scene.
  void each_surface(const auto& visit) const {
    std::size_t index = 0;
    [[maybe_unused]] const auto each_of = [&](const auto& surfaces) {
      for (const auto& surface : surfaces) visit(surface, index++);
    };
    (each_of(scene_->template surfaces<S>()), ...);
  }

  /// Returns the surfaces with is_left_by true for a ray.
  [[nodiscard]] simd::Bits left_by(const Ray& ray) const {
    simd::Bits left = 0;
    each_surface([&](const auto& surface, std::size_t k) {
      if constexpr (requires { surface.is_left_by(ray); }) left |= simd::Bits{surface.is_left_by(ray)} << k;
    });
    return left;
  }

  /// Fills prepared_, constants_, and departed_together_ for the surfaces that have one departure each.
  void prepare_few() {
    each_surface([&]<class T>(const T& surface, std::size_t index) {
      if constexpr (PreparedSurface<T>)
        static_cast<PreparedAll<T>&>(prepared_).all.push_back(surface.prepared());
      SurfaceConstants& constants = constants_[index];
      if constexpr (is_flat<T>) constants.normal = normal_at(surface, Point{0}, 0);
      if constexpr (!is_made_of_primitives<T>) {
        constants.departure = departure_of(surface);
        departed_together_[index] = left_by({.departure = *constants.departure});
      }
    });
  }

  template <class T>
  [[nodiscard]] bool occluded_by(const Ray& ray, const Interval& range) const {
    const auto& surfaces = scene_->template surfaces<T>();
    if (surfaces.empty()) return false;
    const std::uint32_t departed = departed_by<T>(ray);
    const auto is_hit = [&](std::uint32_t i) { return any_hit(surfaces[i], ray, range); };
    if (departed != simd::no_surface && !leaves_for_good(surfaces[departed], ray, range) && is_hit(departed))
      return true;
    return finder<T>().any_crossed(ray, range, departed, is_hit);
  }

  template <class T>
  void cross(const Ray& ray, const Interval& range, auto&& visit) const {
    PlainVector<std::uint32_t> candidates;
    const std::uint32_t departed = departed_by<T>(ray);
    if (departed != simd::no_surface) candidates.push_back(departed);
    finder<T>().each_candidate(ray, range, departed, [&](std::uint32_t i) {
      candidates.push_back(i);
      return false;
    });
    std::sort(candidates.begin(), candidates.end());
    const auto& surfaces = scene_->template surfaces<T>();
    const auto& materials = scene_->template materials<T>();
    for (const std::uint32_t i : candidates)
      each_crossing(surfaces[i], ray, range, [&](const Crossing& crossing) {
        const Intersection intersection(ray, crossing_on(surfaces[i], crossing, materials[i]));
        visit(intersection);
      });
  }

  /// Returns the index of the surface of one type that the ray leaves, or no_surface. It is tested
  /// apart, since the digits of the origin may lie outside of its bounds.
  template <class T>
  [[nodiscard]] std::uint32_t departed_by(const Ray& ray) const {
    const auto& surfaces = scene_->template surfaces<T>();
    const auto* const departed = static_cast<const T*>(ray.departure.surface);
    const std::less<const T*> before;
    if (departed != nullptr && !before(departed, surfaces.data()) &&
        before(departed, surfaces.data() + surfaces.size()))
      return static_cast<std::uint32_t>(departed - surfaces.data());
    return simd::no_surface;
  }

  template <class T>
  [[nodiscard]] const simd::Finder<T>& finder() const {
    return finders_;
  }

  struct Finders : simd::Finder<S>... {};  ///< one of each type

  /// Prepared equations of all surfaces of a type, if it has such.
  template <class T>
  struct PreparedAll {};
  template <PreparedSurface T>
  struct PreparedAll<T> {
    std::vector<decltype(std::declval<const T&>().prepared())> all;
  };
  struct PreparedOfTypes : PreparedAll<S>... {};

  const Scene<S...>* scene_;
  Counts counts_;  ///< when the scene was accelerated
  Finders finders_;

  /// Sets of coinciding surfaces, by the index in the scene's order of the surface that is left; all 0 if the
  /// scene has more than few_surfaces.
  std::array<simd::Bits, simd::few_surfaces> departed_together_{};
  std::array<SurfaceConstants, simd::few_surfaces> constants_{};  ///< by the same index
  PreparedOfTypes prepared_;                                      ///< empty if the scene has more
};

/// Returns an accelerated view of a scene, with the scene's answers in less time. Call it after the last
/// surface has been added. The view borrows the scene and throws if surfaces are added or removed; see
/// Accelerated. Throws std::invalid_argument if options.threads is negative, and std::length_error if there
/// are more than 2^27 surfaces of one type.
template <Surface... S>
[[nodiscard]] Accelerated<Scene<S...>> accelerate(const Scene<S...>& scene,
                                                  const RenderOptions& options = {}) {
  return Accelerated<Scene<S...>>(scene, options);
}
template <Surface... S>
void accelerate(Scene<S...>&&, const RenderOptions& = {}) = delete;

}  // namespace protostar::inline PROTOSTAR_ABI

// A scene in which surfaces are found by way of boxes: the answers of the plain scene, sooner.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "../scene.hpp"
#include "../surfaces/sphere.hpp"
#include "bvh.hpp"
#include "sphere_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace simd {

/// The things that a ray departing from a sphere meets are widened by this length.
///
/// Such a ray starts on the sphere by definition, whatever its digits say, and where these put it outside, so
/// they do the other root, 2b/A: the point there is as far from the center as the origin is. The bound on the
/// rounding is 4u of the distance and of the difference.
[[nodiscard]] inline double widening(const Ray& ray) {
  if (ray.departure.kind != Departure::Kind::sphere) return 0;
  const auto& [x, y, z, r] = ray.departure.geometry;
  const Vec3 l = Point{x, y, z} - ray.origin;
  const double distance = std::sqrt(dot(l, l));
  return std::max(0.0, distance - r + 0x1p-50 * (distance + r));
}

/// Where to look for what a ray may meet among surfaces of one type. Those without bounds: everywhere.
template <Surface T>
class Finder {
 public:
  Finder(const std::vector<T>& surfaces, const RenderOptions&)
      : count_(static_cast<std::uint32_t>(surfaces.size())) {}

  /// Calls visit(i) for each surface that a ray may cross inside the range, in any order, until one of them
  /// returns true; returns whether one did. A visit may shorten the range.
  template <Order>
  bool each_candidate(const Ray&, const Interval&, const auto& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (visit(i)) return true;
    return false;
  }

  /// Calls visit(i, SphereAround) for each surface that has bounds and may reach into all of some
  /// half-spaces.
  void each_in(std::span<const HalfSpace>, const auto&) const {}

 private:
  std::uint32_t count_;
};

/// Those with bounds: in the leaves of a tree.
template <SurfaceWithBounds T>
class Finder<T> {
 public:
  Finder(const std::vector<T>& surfaces, const RenderOptions& options)
      : surfaces_(&surfaces),
        bvh_(
            surfaces.size(), [&](std::size_t i) { return surfaces[i].bounds(); }, leaf_size, options) {
    if constexpr (is_sphere)
      spheres_ = SphereLeaves(
          bvh_, [&](std::size_t i) -> auto& { return surfaces[i]; });
  }

  template <Order order>
  bool each_candidate(const Ray& ray, const Interval& range, const auto& visit) const {
    for (const std::uint32_t i : bvh_.unbounded())
      if (visit(i)) return true;
    const BoxRay line(ray, bvh_.space(), widening(ray));
    // Behind the origin the ends of a box are not widened (BoxRay).
    if (!line.usable || range.min < 0) {
      for (const std::uint32_t i : bvh_.order())
        if (visit(i)) return true;
      return false;
    }
    const Reach reach{line.at_least(range.min), line.at_most(range.max)};
    const auto visit_leaf = [&](Leaf leaf, Reach& left) {
      if constexpr (is_sphere) {
        for (std::uint32_t i = 0; i < leaf.count; i += float_lanes) {
          const auto met = spheres_.met(leaf, i, line, left);
          for (Bits spheres = met.spheres; spheres != 0; spheres &= spheres - 1) {
            const int k = std::countr_zero(spheres);
            if (met.near[k] > left.until) continue;
            if (visit(bvh_.order()[leaf.first + i + static_cast<std::uint32_t>(k)])) return true;
            left.until = line.at_most(range.max);
          }
        }
      } else {
        for (std::uint32_t i = 0; i < leaf.count; ++i)
          if (visit(bvh_.order()[leaf.first + i])) return true;
        left.until = line.at_most(range.max);
      }
      return false;
    };
    const auto soon = [&](Leaf leaf) {
      if constexpr (is_sphere) spheres_.fetch(leaf);
    };
    return bvh_.each_leaf_along<order>(line, reach, visit_leaf, soon);
  }

  void each_in(std::span<const HalfSpace> half_spaces, const auto& visit) const {
    bvh_.each_leaf_in(half_spaces, [&](Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const std::uint32_t surface = bvh_.order()[leaf.first + i];
        if constexpr (is_sphere)
          visit(surface, spheres_.around(leaf, i, bvh_.space()));
        else
          visit(surface, sphere_around((*surfaces_)[surface]));
      }
    });
  }

 private:
  static constexpr bool is_sphere = std::same_as<T, Sphere>;
  static constexpr int leaf_size = is_sphere ? node_width : 1;
  struct Nothing {};

  const std::vector<T>* surfaces_;
  Bvh bvh_;
  std::conditional_t<is_sphere, SphereLeaves, Nothing> spheres_;
};

}  // namespace simd

/// What stands in for something Traceable, and is faster.
template <class>
class Accelerated;

/// A scene with a tree of boxes over the surfaces that have bounds. Its answers are those of the scene, to
/// the last bit. It borrows the scene, which has to live as long and stay as it is. Many threads may share
/// it.
template <Surface... S>
class Accelerated<Scene<S...>> {
 public:
  explicit Accelerated(const Scene<S...>& scene, const RenderOptions& options = {})
      : scene_(&scene), finders_(simd::Finder<S>(scene.template surfaces<S>(), options)...) {}
  explicit Accelerated(Scene<S...>&&, const RenderOptions& = {}) = delete;

  /// The first crossing inside the range.
  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range = {}) const {
    SurfaceCrossing first;
    (look_for_first<S>(ray, range, first), ...);
    if (first.surface == nullptr) return std::nullopt;
    return Intersection(ray, first);
  }

  /// Whether there is any crossing inside the range.
  [[nodiscard]] bool occluded(const Ray& ray, Interval range = {}) const {
    return (occluded_by<S>(ray, range) || ...);
  }

  /// Calls visit(const Intersection&) for every crossing inside the range, in the order of the surfaces; of
  /// one surface, near before far.
  void crossings(const Ray& ray, Interval range, auto&& visit) const { (cross<S>(ray, range, visit), ...); }

  [[nodiscard]] const std::vector<Light>& lights() const { return scene_->lights(); }
  [[nodiscard]] const Color& ambient() const { return scene_->ambient(); }
  [[nodiscard]] const std::optional<Color>& sky() const { return scene_->sky(); }

  [[nodiscard]] const Scene<S...>& scene() const { return *scene_; }

  /// Calls visit(i, SphereAround) for each surface of one type that has bounds and may reach into all of some
  /// half-spaces, in any order.
  template <class T>
  void each_in(std::span<const simd::HalfSpace> half_spaces, const auto& visit) const {
    finder<T>().each_in(half_spaces, visit);
  }

 private:
  template <class T>
  void look_for_first(const Ray& ray, Interval& range, SurfaceCrossing& first) const {
    const auto& surfaces = scene_->template surfaces<T>();
    const auto& materials = scene_->template materials<T>();
    std::uint32_t first_index = 0;  // all of other types come before
    finder<T>().template each_candidate<simd::Order::near_first>(ray, range, [&](std::uint32_t i) {
      const auto crossing = first_crossing(surfaces[i], ray, range);
      if (!crossing) return false;
      const SurfaceCrossing candidate = crossing_on(surfaces[i], *crossing, materials[i]);
      // Of crossings at equal t the earlier surface's is the first.
      if (first.surface != nullptr &&
          (i < first_index ? precedes(ray, first, candidate) : !precedes(ray, candidate, first)))
        return false;
      first = candidate;
      first_index = i;
      // What might be before it, given its error, stays in.
      range.max = std::min(range.max, crossing->t + 4 * Roots::relative_error * std::abs(crossing->t));
      return false;
    });
  }

  template <class T>
  [[nodiscard]] bool occluded_by(const Ray& ray, const Interval& range) const {
    const auto& surfaces = scene_->template surfaces<T>();
    return finder<T>().template each_candidate<simd::Order::any>(
        ray, range, [&](std::uint32_t i) { return first_crossing(surfaces[i], ray, range).has_value(); });
  }

  template <class T>
  void cross(const Ray& ray, const Interval& range, auto&& visit) const {
    std::vector<std::uint32_t> candidates;
    finder<T>().template each_candidate<simd::Order::any>(ray, range, [&](std::uint32_t i) {
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

  template <class T>
  [[nodiscard]] const simd::Finder<T>& finder() const {
    return std::get<simd::Finder<T>>(finders_);
  }

  const Scene<S...>* scene_;
  std::tuple<simd::Finder<S>...> finders_;
};

/// A scene that answers sooner. It borrows the scene: see Accelerated.
template <Surface... S>
[[nodiscard]] Accelerated<Scene<S...>> accelerate(const Scene<S...>& scene,
                                                  const RenderOptions& options = {}) {
  return Accelerated<Scene<S...>>(scene, options);
}
template <Surface... S>
void accelerate(Scene<S...>&&, const RenderOptions& = {}) = delete;

}  // namespace protostar::inline PROTOSTAR_ABI

// A scene with BVHs over its surfaces: the answers of the plain scene, sooner.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "../scene.hpp"
#include "../surfaces/sphere.hpp"
#include "bvh.hpp"
#include "ray_in_bvh.hpp"
#include "sphere_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace simd {

/// Indices of surfaces among those of their type, one in each lane.
using Numbers = Lanes<std::uint32_t, double_lanes>;

/// Finds the surfaces of one type that a ray may meet. This template is for types without bounds and visits
/// all surfaces.
template <Surface T>
class Finder {
 public:
  Finder(const std::vector<T>& surfaces, const RenderOptions&)
      : count_(static_cast<std::uint32_t>(surfaces.size())) {}

  /// Calls visit(i) for each surface that a ray may cross inside the range, in any order, until a call
  /// returns true; returns true if one did.
  bool each_crossed(const Ray&, const Interval&, const auto& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (visit(i)) return true;
    return false;
  }

  /// Returns true if a ray crosses any surface inside the range; visit(i) decides for one surface if bounds
  /// do not.
  bool any_crossed(const Ray& ray, const Interval& range, const auto& visit) const {
    return each_crossed(ray, range, visit);
  }

  /// Calls visit(i) for the surface of the closest hit inside the range, and for others. A visit may shorten
  /// the range.
  void each_first(const Ray&, const Interval&, const auto& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i) visit(i);
  }

  /// Calls visit(Numbers, Bits, SpheresAround) for some lanes at a time, so that each surface that has bounds
  /// and may reach into every one of the half-spaces is in a lane whose bit is set.
  void frustum_query(std::span<const HalfSpace>, const auto&) const {}

  /// Calls visit(i) for each surface without bounds, in order.
  void each_unbounded(const auto& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i) visit(i);
  }

 private:
  std::uint32_t count_;
};

[[nodiscard]] inline std::vector<BoxHalfSpace> in_box_space(std::span<const HalfSpace> half_spaces,
                                                            const Bvh& bvh) {
  std::vector<BoxHalfSpace> seen;
  for (const HalfSpace& half_space : half_spaces) seen.emplace_back(half_space, bvh.space());
  return seen;
}

/// Finds surfaces with bounds: in a BVH with one surface in each leaf.
template <SurfaceWithBounds T>
class Finder<T> {
 public:
  Finder(const std::vector<T>& surfaces, const RenderOptions& options)
      : surfaces_(&surfaces),
        bvh_(
            surfaces.size(), [&](std::size_t i) { return surfaces[i].bounds(); }, {.most = 1}, options) {}

  bool each_crossed(const Ray& ray, const Interval& range, const auto& visit) const {
    return each_along<Order::any>(bvh_, ray, range, visit, [&](const BoxRay&, Leaf leaf, Reach&) {
      return visit(bvh_.order()[leaf.first]);
    });
  }

  bool any_crossed(const Ray& ray, const Interval& range, const auto& visit) const {
    return each_crossed(ray, range, visit);
  }

  void each_first(const Ray& ray, const Interval& range, const auto& visit) const {
    const auto visit_one = [&](std::uint32_t i) {
      visit(i);
      return false;
    };
    each_along<Order::near_first>(bvh_, ray, range, visit_one,
                                  [&](const BoxRay& line, Leaf leaf, Reach& left) {
                                    visit(bvh_.order()[leaf.first]);
                                    left.until = line.at_most(range.max);
                                    return false;
                                  });
  }

  void frustum_query(std::span<const HalfSpace> half_spaces, const auto& visit) const {
    bvh_.each_leaf_in(in_box_space(half_spaces, bvh_), [&](Leaf leaf) {
      const std::uint32_t i = bvh_.order()[leaf.first];
      visit(Numbers(i), Bits{1}, SpheresAround(sphere_around((*surfaces_)[i])));
    });
  }

  void each_unbounded(const auto& visit) const {
    for (const std::uint32_t i : bvh_.unbounded()) visit(i);
  }

 private:
  const std::vector<T>* surfaces_;
  Bvh bvh_;
};

/// Finds spheres: in a BVH whose leaves have as many as are tested at once, in float.
template <>
class Finder<Sphere> {
 public:
  Finder(const std::vector<Sphere>& spheres, const RenderOptions& options)
      : bvh_(
            spheres.size(), [&](std::size_t i) { return spheres[i].bounds(); }, {.most = node_width},
            options),
        leaves_(
            bvh_, [&](std::size_t i) -> auto& { return spheres[i]; }, options),
        few_(spheres) {}

  bool each_crossed(const Ray& ray, const Interval& range, const auto& visit) const {
    if (few_.has_all()) return each_of_few(ray, range, visit);
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& left) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes)
        if (any_of(leaves_.crossed(leaf, i, line, left).maybe, leaf.first + i, visit)) return true;
      return false;
    };
    return each_along<Order::any>(bvh_, ray, range, visit, visit_leaf, soon());
  }

  bool any_crossed(const Ray& ray, const Interval& range, const auto& visit) const {
    if (few_.has_all()) return each_of_few(ray, range, visit);
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& left) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes) {
        const auto [maybe, surely] = leaves_.crossed(leaf, i, line, left);
        if (surely || any_of(maybe, leaf.first + i, visit)) return true;
      }
      return false;
    };
    return each_along<Order::any>(bvh_, ray, range, visit, visit_leaf, soon());
  }

  /// Calls visit(i) for the sphere of the closest hit inside the range, and for others. A sphere that is
  /// surely entered before all known ones is visited last: mostly a nearer one is found until then, or there
  /// is no other.
  void each_first(const Ray& ray, const Interval& range, const auto& visit) const {
    const auto visit_one = [&](std::uint32_t i) {
      visit(i);
      return false;
    };
    if (few_.has_all()) {
      each_of_few(ray, range, visit_one);
      return;
    }
    std::uint32_t waiting = 0;
    float waiting_near = infinite;
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& left) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes) {
        const auto entered = leaves_.entered(leaf, i, line, left);
        for (Bits spheres = entered.maybe; spheres != 0; spheres &= spheres - 1) {
          const int k = std::countr_zero(spheres);
          if (entered.near[k] > left.until) continue;
          const std::uint32_t place = leaf.first + i + static_cast<std::uint32_t>(k);
          if ((entered.surely >> k & 1) != 0 && entered.far[k] < waiting_near) {
            waiting = place;
            waiting_near = entered.near[k];
            left.until = std::min(left.until, entered.far[k]);
          } else {
            visit(bvh_.order()[place]);
            left.until = std::min(left.until, line.at_most(range.max));
          }
        }
      }
      return false;
    };
    each_along<Order::near_first>(bvh_, ray, range, visit_one, visit_leaf, soon());
    if (waiting_near < infinite) visit(bvh_.order()[waiting]);
  }

  void frustum_query(std::span<const HalfSpace> half_spaces, const auto& visit) const {
    const auto sides = in_box_space(half_spaces, bvh_);
    const auto visit_leaf = [&](Leaf leaf) {
      Bits within = 0;
      for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
        if (i % float_lanes == 0) within = leaves_.within(leaf, i, sides);
        if (const Bits some = within & first_bits(double_lanes); some != 0)
          visit(numbers(leaf.first + i), some, leaves_.around(leaf, i, bvh_.space()));
        within >>= double_lanes;
      }
    };
    bvh_.each_leaf_in(sides, visit_leaf, soon());
  }

  void each_unbounded(const auto& visit) const {
    for (const std::uint32_t i : bvh_.unbounded()) visit(i);
  }

 private:
  static constexpr float infinite = std::numeric_limits<float>::infinity();

  struct Fetch {
    const SphereLeaves& leaves;
    void operator()(Leaf leaf) const { leaves.fetch(leaf); }
  };
  [[nodiscard]] Fetch soon() const { return {leaves_}; }

  /// Returns the surfaces in the order of the leaves from a position on.
  [[nodiscard]] Numbers numbers(std::size_t from) const {
    const auto& order = bvh_.order();
    if (from + double_lanes <= order.size()) return Numbers::load(&order[from]);
    return Numbers::of_each(
        [&](int lane) { return order[std::min(from + static_cast<std::size_t>(lane), order.size() - 1)]; });
  }

  bool each_of_few(const Ray& ray, const Interval& range, const auto& visit) const {
    for (Bits met = few_.met(ray, range); met != 0; met &= met - 1)
      if (visit(static_cast<std::uint32_t>(std::countr_zero(met)))) return true;
    return false;
  }

  /// Returns true if visit(i) is true for any of some spheres in a leaf, bit k being at position first + k.
  bool any_of(Bits spheres, std::uint32_t first, const auto& visit) const {
    for (; spheres != 0; spheres &= spheres - 1)
      if (visit(bvh_.order()[first + static_cast<std::uint32_t>(std::countr_zero(spheres))])) return true;
    return false;
  }

  Bvh bvh_;
  SphereLeaves leaves_;
  FewSpheres few_;
};

}  // namespace simd

/// Faster stand-in for a Traceable.
template <class>
class Accelerated;

/// A scene with a BVH over the surfaces that have bounds. Its answers are those of the scene, to the last
/// bit. Many threads may share it.
///
/// It borrows the scene, which has to live as long and keep its surfaces: the tree knows those that were
/// there when it was built. If the scene has gained or lost surfaces since, each of intersect, occluded and
/// crossings, and render, throws std::logic_error; accelerate the scene again. Lights, sky and environment
/// may change between two calls.
template <Surface... S>
class Accelerated<Scene<S...>> {
 public:
  explicit Accelerated(const Scene<S...>& scene, const RenderOptions& options = {})
      : scene_(&scene),
        counts_{scene.template surfaces<S>().size()...},
        finders_(simd::Finder<S>(scene.template surfaces<S>(), options)...) {
    detail::require_threads(options);  // few surfaces are sorted by one thread, whatever the options say
  }
  explicit Accelerated(Scene<S...>&&, const RenderOptions& = {}) = delete;

  /// Returns the closest hit inside the range.
  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range = {}) const {
    require_same_surfaces();
    SurfaceCrossing first;
    (look_for_first<S>(ray, range, first), ...);
    if (first.surface == nullptr) return std::nullopt;
    return Intersection(ray, first);
  }

  /// Returns true if there is any crossing inside the range.
  [[nodiscard]] bool occluded(const Ray& ray, Interval range = {}) const {
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
  [[nodiscard]] const Texture& environment() const { return scene_->environment(); }

  [[nodiscard]] const Scene<S...>& scene() const { return *scene_; }

  /// Throws std::logic_error if the scene has more or fewer surfaces of a type than when it was accelerated.
  void require_same_surfaces() const {
    [[maybe_unused]] std::size_t i = 0;
    if (((scene_->template surfaces<S>().size() != counts_[i++]) || ...)) [[unlikely]]
      refuse_other_surfaces();
  }

  /// Calls visit(Numbers, Bits, SpheresAround) for some surfaces of one type at a time, in any order, so that
  /// each that has bounds and may reach into every one of the half-spaces is in a lane whose bit is set.
  template <class T>
  void frustum_query(std::span<const simd::HalfSpace> half_spaces, const auto& visit) const {
    finder<T>().frustum_query(half_spaces, visit);
  }

  /// Calls visit(i) for each surface of one type that has no bounds, in order.
  template <class T>
  void each_unbounded(const auto& visit) const {
    finder<T>().each_unbounded(visit);
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

  template <class T>
  void look_for_first(const Ray& ray, Interval& range, SurfaceCrossing& first) const {
    const auto& surfaces = scene_->template surfaces<T>();
    const auto& materials = scene_->template materials<T>();
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
    const std::uint32_t left = left_by<T>(ray);
    if (left != none) look_at(left);
    finder<T>().each_first(ray, range, [&](std::uint32_t i) {
      if (i != left) look_at(i);
    });
  }

  template <class T>
  [[nodiscard]] bool occluded_by(const Ray& ray, const Interval& range) const {
    const auto& surfaces = scene_->template surfaces<T>();
    const std::uint32_t left = left_by<T>(ray);
    if (left != none && any_hit(surfaces[left], ray, range)) return true;
    return finder<T>().any_crossed(ray, range, [&](std::uint32_t i) {
      if (i == left) return false;
      if constexpr (requires { surfaces[i].is_surely_behind(ray); })
        if (range.min >= 0 && surfaces[i].is_surely_behind(ray)) return false;
      return any_hit(surfaces[i], ray, range);
    });
  }

  template <class T>
  void cross(const Ray& ray, const Interval& range, auto&& visit) const {
    std::vector<std::uint32_t> candidates;
    const std::uint32_t left = left_by<T>(ray);
    if (left != none) candidates.push_back(left);
    finder<T>().each_crossed(ray, range, [&](std::uint32_t i) {
      if (i != left) candidates.push_back(i);
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

  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);

  /// Returns the index of the surface of one type of which the ray leaves a part, or `none`. It is always
  /// tested, since the digits of the origin may lie outside of its bounds.
  template <class T>
  [[nodiscard]] std::uint32_t left_by([[maybe_unused]] const Ray& ray) const {
    if constexpr (SurfaceWithParts<T>) {
      const auto& surfaces = scene_->template surfaces<T>();
      const auto* const left = static_cast<const T*>(ray.departure.in_scene);
      const std::less<const T*> before;
      if (left != nullptr && !before(left, surfaces.data()) &&
          before(left, surfaces.data() + surfaces.size()))
        return static_cast<std::uint32_t>(left - surfaces.data());
    }
    return none;
  }

  template <class T>
  [[nodiscard]] const simd::Finder<T>& finder() const {
    return std::get<simd::Finder<T>>(finders_);
  }

  const Scene<S...>* scene_;
  Counts counts_;  ///< when the scene was accelerated
  std::tuple<simd::Finder<S>...> finders_;
};

/// Returns an accelerated scene, with the same answers sooner; call it once all surfaces are in the scene.
/// The result borrows the scene and throws if surfaces are added or removed; see Accelerated. Throws
/// std::invalid_argument if options.threads is negative, and std::length_error if there are more than 2^27
/// surfaces of one type.
template <Surface... S>
[[nodiscard]] Accelerated<Scene<S...>> accelerate(const Scene<S...>& scene,
                                                  const RenderOptions& options = {}) {
  return Accelerated<Scene<S...>>(scene, options);
}
template <Surface... S>
void accelerate(Scene<S...>&&, const RenderOptions& = {}) = delete;

}  // namespace protostar::inline PROTOSTAR_ABI

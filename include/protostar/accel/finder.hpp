// Finders: for each type of surfaces, those that a ray may meet or that may reach into a frustum.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "../bvh/box_space.hpp"
#include "../bvh/bvh.hpp"
#include "../bvh/node.hpp"
#include "../bvh/ray_in_bvh.hpp"
#include "../interval.hpp"
#include "../plain_vector.hpp"
#include "../ray.hpp"
#include "../render_options.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../surface.hpp"
#include "../surfaces/sphere.hpp"
#include "sphere_around.hpp"
#include "sphere_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Returns what frustum_query tells of a surface without bounds: its index in one lane, in a sphere of
/// infinite radius.
[[nodiscard]] inline SurfacesAround around_unbounded(std::uint32_t index) {
  return {SurfaceIndices(index), Bits{1}, SphereAround{Point{0}, infinity}};
}

/// Index of no surface.
inline constexpr std::uint32_t no_surface = ~std::uint32_t{0};

/// Finds the surfaces of one type that a ray may meet, without that at the index `departed`, which the ray
/// departs from and the caller tests apart (no_surface: none). This template is for types without bounds and
/// visits all others.
template <Surface T>
class Finder {
 public:
  Finder(const SceneVector<T>& surfaces, const RenderOptions&)
      : count_(static_cast<std::uint32_t>(surfaces.size())) {}

  /// Calls visit(i) for candidates: a superset of the surfaces, except `departed`, that the ray crosses
  /// inside the range, in any order. Stops and returns true as soon as a call returns true.
  bool each_candidate(const Ray&, const Interval&, std::uint32_t departed, const auto& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (i != departed && visit(i)) return true;
    return false;
  }

  /// Returns true if a ray crosses any surface inside the range; visit(i) decides for one surface if bounds
  /// do not.
  bool any_crossed(const Ray& ray, const Interval& range, std::uint32_t departed, const auto& visit) const {
    return each_candidate(ray, range, departed, visit);
  }

  /// Calls visit(i) for candidates, roughly near to far: a set of surfaces, except `departed`, that has the
  /// one of the closest hit inside the range. `range` refers to a variable of the caller, which a visit may
  /// shorten: it is read again after each.
  void search_closest(const Ray&, const Interval&, std::uint32_t departed, const auto& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (i != departed) visit(i);
  }

  /// Calls visit for groups of surfaces that no single half-space excludes, a superset of those that reach
  /// into their intersection. Indices are in the scene's order, counted from `first`, that of the type's
  /// first surface. The sphere around a surface without bounds has an infinite radius.
  void frustum_query(std::span<const HalfSpace>, std::uint32_t first, const VisitSurfaces& visit) const {
    for (std::uint32_t i = 0; i < count_; ++i) visit(around_unbounded(first + i));
  }

 private:
  std::uint32_t count_;
};

/// Returns the half-spaces in the coordinates of a BVH's boxes, widened for float.
[[nodiscard]] inline PlainVector<BoxHalfSpace> in_box_space(std::span<const HalfSpace> half_spaces,
                                                            const Bvh& bvh) {
  PlainVector<BoxHalfSpace> seen;
  for (const HalfSpace& half_space : half_spaces) seen.push_back({half_space, bvh.space()});
  return seen;
}

/// Finds surfaces with bounds: in a BVH with one surface in each leaf.
template <SurfaceWithBounds T>
class Finder<T> {
 public:
  Finder(const SceneVector<T>& surfaces, const RenderOptions& options)
      : surfaces_(&surfaces),
        bvh_(
            surfaces.size(), [&](std::size_t i) { return surfaces[i].bounds(); }, {.most = 1}, options) {}

  bool each_candidate(const Ray& ray, const Interval& range, std::uint32_t departed,
                      const auto& visit) const {
    const auto visit_other = [&](std::uint32_t i) { return i != departed && visit(i); };
    return each_along<Order::any>(bvh_, ray, range, visit_other, [&](const BoxRay&, Leaf leaf, Reach&) {
      return visit_other(bvh_.order()[leaf.first]);
    });
  }

  bool any_crossed(const Ray& ray, const Interval& range, std::uint32_t departed, const auto& visit) const {
    return each_candidate(ray, range, departed, visit);
  }

  void search_closest(const Ray& ray, const Interval& range, std::uint32_t departed,
                      const auto& visit) const {
    const auto visit_other = [&](std::uint32_t i) {
      if (i != departed) visit(i);
      return false;
    };
    each_along<Order::near_first>(bvh_, ray, range, visit_other,
                                  [&](const BoxRay& line, Leaf leaf, Reach& reach) {
                                    visit_other(bvh_.order()[leaf.first]);
                                    reach.until = line.at_most(range.max);
                                    return false;
                                  });
  }

  void frustum_query(std::span<const HalfSpace> half_spaces, std::uint32_t first,
                     const VisitSurfaces& visit) const {
    traverse(bvh_, InHalfSpaces{in_box_space(half_spaces, bvh_)}, [&](Leaf leaf) {
      const std::uint32_t i = bvh_.order()[leaf.first];
      visit({SurfaceIndices(first + i), Bits{1}, sphere_around((*surfaces_)[i])});
      return false;
    });
    for (const std::uint32_t i : bvh_.unbounded()) visit(around_unbounded(first + i));
  }

 private:
  const SceneVector<T>* surfaces_;
  Bvh bvh_;
};

/// Finds spheres: in a BVH whose leaves have as many as are tested at once, in float.
template <>
class Finder<Sphere> {
 public:
  Finder(const SceneVector<Sphere>& spheres, const RenderOptions& options)
      : spheres_(&spheres),
        bvh_(
            spheres.size(), [&](std::size_t i) { return spheres[i].bounds(); }, {.most = node_width},
            options),
        leaves_(
            bvh_, [&](std::size_t i) -> auto& { return spheres[i]; }, options),
        few_(spheres),
        position_(spheres.size()) {
    bvh_.each_leaf(
        [&](Leaf leaf) {
          for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) position_[bvh_.order()[i]] = i;
        },
        options);
    for (const std::uint32_t i : bvh_.unbounded()) position_[i] = nowhere;
  }

  bool each_candidate(const Ray& ray, const Interval& range, std::uint32_t departed,
                      const auto& visit) const {
    if (few_.has_all()) return each_of_few(ray, range, departed, visit);
    const std::uint32_t passed_over = position(departed);
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& reach) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes)
        if (any_of(maybe(leaves_.pass(leaf, i, line), leaf, i, reach, passed_over), leaf.first + i, visit))
          return true;
      return false;
    };
    const auto visit_other = [&](std::uint32_t i) { return i != departed && visit(i); };
    return each_along<Order::any>(bvh_, ray, range, visit_other, visit_leaf);
  }

  bool any_crossed(const Ray& ray, const Interval& range, std::uint32_t departed, const auto& visit) const {
    if (few_.has_all()) return each_of_few(ray, range, departed, visit);
    const std::uint32_t passed_over = position(departed);
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& reach) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes) {
        const SpherePass passed = leaves_.pass(leaf, i, line);
        const Bits met = maybe(passed, leaf, i, reach, passed_over);
        if (met == 0) continue;
        const Bits surely =
            bits(passed.surely_within(reach.from * (1 + 0x1p-18f), reach.until * (1 - 0x1p-18f)));
        if ((met & surely) != 0 || any_of(met, leaf.first + i, visit)) return true;
      }
      return false;
    };
    const auto visit_other = [&](std::uint32_t i) { return i != departed && visit(i); };
    return each_along<Order::any>(bvh_, ray, range, visit_other, visit_leaf);
  }

  /// Calls visit(i) for a set of spheres that has the one of the closest hit inside the range. Postpones
  /// until the end a sphere that the ray surely enters. One that is surely entered earlier replaces it; the
  /// replaced one cannot be the closest and is never visited.
  void search_closest(const Ray& ray, const Interval& range, std::uint32_t departed,
                      const auto& visit) const {
    const auto visit_other = [&](std::uint32_t i) {
      if (i != departed) visit(i);
      return false;
    };
    if (few_.has_all()) {
      each_of_few(ray, range, departed, visit_other);
      return;
    }
    const std::uint32_t passed_over = position(departed);
    std::uint32_t waiting = 0;
    float waiting_near = infinite;
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& reach) {
      prefetch(&bvh_.order()[leaf.first]);
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes) {
        const SpherePass passed = leaves_.pass(leaf, i, line);
        const Bits met = maybe(passed, leaf, i, reach, passed_over);
        if (met == 0) continue;
        const auto [near, until] = passed.entry();
        const Bits surely = bits(passed.surely() && near > WideFloats(reach.from * (1 + 0x1p-18f)));
        for (const int k : lanes_in(met)) {
          if (near[k] > reach.until) continue;
          const std::uint32_t sphere = bvh_.order()[leaf.first + i + static_cast<std::uint32_t>(k)];
          if ((surely >> k & 1) != 0 && until[k] < waiting_near) {
            waiting = sphere;
            prefetch(spheres_->data() + waiting);
            waiting_near = near[k];
            reach.until = std::min(reach.until, until[k]);
          } else {
            visit(sphere);
            reach.until = std::min(reach.until, line.at_most(range.max));
          }
        }
      }
      return false;
    };
    each_along<Order::near_first>(bvh_, ray, range, visit_other, visit_leaf,
                                  [&](Leaf leaf) { leaves_.fetch(leaf); });
    if (waiting_near < infinite) visit(waiting);
  }

  void frustum_query(std::span<const HalfSpace> half_spaces, std::uint32_t first,
                     const VisitSurfaces& visit) const {
    const auto sides = in_box_space(half_spaces, bvh_);
    const auto visit_leaf = [&](Leaf leaf) {
      Bits within = 0;
      for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
        if (i % float_lanes == 0) within = leaves_.within(leaf, i, sides);
        if (const Bits some = within & first_bits(double_lanes); some != 0)
          visit({indices_at(leaf.first + i) + SurfaceIndices(first), some,
                 leaves_.around(leaf, i, bvh_.space())});
        within >>= double_lanes;
      }
      return false;
    };
    const auto fetch_leaf = [&](Leaf leaf) {
      leaves_.fetch_all(leaf);
      prefetch(&bvh_.order()[leaf.first]);
    };
    traverse(bvh_, InHalfSpaces{sides}, visit_leaf,
             FetchChild<Read::soon, decltype(fetch_leaf)>{bvh_, fetch_leaf});
    for (const std::uint32_t i : bvh_.unbounded()) visit(around_unbounded(first + i));
  }

 private:
  static constexpr float infinite = std::numeric_limits<float>::infinity();
  static constexpr std::uint32_t nowhere = ~std::uint32_t{0};  ///< position of no sphere

  /// Returns the indices of the surfaces from a position in the order of the leaves on.
  [[nodiscard]] SurfaceIndices indices_at(std::size_t from) const {
    const auto& order = bvh_.order();
    if (from + double_lanes <= order.size()) return SurfaceIndices::load(&order[from]);
    return SurfaceIndices::of_each(
        [&](int lane) { return order[std::min(from + static_cast<std::size_t>(lane), order.size() - 1)]; });
  }

  /// Returns the position of a sphere in the order of the leaves; `nowhere` for no_surface.
  [[nodiscard]] std::uint32_t position(std::uint32_t index) const {
    return index == no_surface ? nowhere : position_[index];
  }

  /// Returns the set of spheres that the ray may meet within `reach`; bit k is sphere i + k of the leaf.
  /// Leaves out the sphere at position passed_over.
  [[nodiscard, gnu::always_inline]] static Bits maybe(const SpherePass& passed, Leaf leaf, std::uint32_t i,
                                                      Reach reach, std::uint32_t passed_over) {
    const std::uint32_t k = passed_over - (leaf.first + i);
    return bits(passed.maybe_within(reach.from, reach.until)) & first_bits(static_cast<int>(leaf.count - i)) &
           ~(Bits{k < 32} << (k % 32));
  }

  bool each_of_few(const Ray& ray, const Interval& range, std::uint32_t departed, const auto& visit) const {
    for (const int k : lanes_in(few_.met(ray, range)))
      if (const auto i = static_cast<std::uint32_t>(k); i != departed && visit(i)) return true;
    return false;
  }

  /// Returns true if visit(i) is true for any of some spheres in a leaf, bit k being at position first + k.
  bool any_of(Bits spheres, std::uint32_t first, const auto& visit) const {
    for (const int k : lanes_in(spheres))
      if (visit(bvh_.order()[first + static_cast<std::uint32_t>(k)])) return true;
    return false;
  }

  const SceneVector<Sphere>* spheres_;
  Bvh bvh_;
  SphereLeaves leaves_;
  FewSpheres few_;
  PlainVector<std::uint32_t> position_;  ///< of each sphere, in the order of the leaves
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

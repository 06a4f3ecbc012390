// Triangles in a tree of boxes, and in its leaves looked for in float first.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "../surfaces/triangle.hpp"
#include "bvh.hpp"
#include "triangle_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A tree over triangles that others hold. What the functions take as `triangle` is what the constructor got.
class TriangleTree {
 public:
  static constexpr std::size_t most = largest_tree;  ///< triangles

  /// Those of a triangle. Unlike a Triangle they have no values of their own, which to write for all of many
  /// takes long.
  struct Corners {
    Point a, b, c;

    operator Triangle() const { return {a, b, c}; }
  };

  /// Of `count` triangles; triangle(i) is one of them.
  TriangleTree(std::size_t count, const auto& triangle, const RenderOptions& options)
      : bvh_(
            count, [&](std::size_t i) { return triangle(i).bounds(); }, node_width, options),
        in_leaves_(std::make_unique_for_overwrite<Corners[]>(bvh_.order().size())),
        leaves_(
            bvh_,
            [&](std::size_t place) {
              const Triangle one = triangle(number(place));
              in_leaves_[place] = {one.a, one.b, one.c};
              return one;
            },
            options) {}

  /// Calls visit(triangle, i) for all that a ray may cross inside the range, in any order, until one returns
  /// true; returns whether one did.
  bool each_crossed(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    return walk<Order::any>(ray, range, triangle, visit,
                            [&](const Crossed& crossed, std::uint32_t first, Reach&) {
                              return any_of(crossed.maybe, first, visit);
                            });
  }

  /// Whether a ray crosses any inside the range; visit(triangle, i) says it of one where float does not. A
  /// triangle in the plane that a ray departs from is not crossed, of which float knows nothing.
  bool any_crossed(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    const bool trusting = !ray.departure.is_planar();
    return walk<Order::any>(
        ray, range, triangle, visit, [&](const Crossed& crossed, std::uint32_t first, Reach& left) {
          return (trusting && crossed.any_surely_before(left.until)) || any_of(crossed.maybe, first, visit);
        });
  }

  /// Calls visit(triangle, i) for that which a ray crosses first inside the range, and for others. A visit
  /// returns whether the triangle is crossed there, and may shorten the range.
  ///
  /// A triangle that is surely crossed, before any other that is known, is not visited before the end: mostly
  /// something nearer is found until then, or there is nothing else. If the ray departs from its plane it is
  /// not crossed after all. Only then the search begins anew, and takes nothing for sure.
  void each_first(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    if (!look_for_first<true>(ray, range, triangle, visit) && ray.departure.is_planar())
      look_for_first<false>(ray, range, triangle, visit);
  }

  [[nodiscard]] const BoxSpace& space() const { return bvh_.space(); }

  /// Bvh::each_leaf_ahead.
  void each_leaf_ahead(std::span<const HalfSpace> half_spaces, const Vec3& direction, const auto& is_hidden,
                       const auto& visit) const {
    std::vector<BoxHalfSpace> seen;
    for (const HalfSpace& half_space : half_spaces) seen.emplace_back(half_space, space());
    bvh_.each_leaf_ahead(seen, direction, is_hidden, visit, [&](Leaf leaf) {
      const Corners* const first = &in_leaves_[leaf.first];
      for (const Corners* triangle = first; triangle != first + leaf.count; ++triangle) prefetch(triangle);
    });
  }

  /// The triangle that stands at a place of a leaf, and its number.
  [[nodiscard]] const Corners& in_leaf(std::size_t place) const { return in_leaves_[place]; }
  [[nodiscard]] std::uint32_t number(std::size_t place) const { return bvh_.order()[place]; }

  /// How many triangles stand in leaves.
  [[nodiscard]] std::size_t size() const { return bvh_.order().size(); }

  /// Whether all triangles do.
  [[nodiscard]] bool has_all() const { return bvh_.unbounded().empty(); }

 private:
  using Crossed = TriangleLeaves::Crossed;

  /// Returns whether what waited to the end, if anything did, is crossed.
  template <bool trusting>
  bool look_for_first(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    std::uint32_t waiting = 0;
    float waiting_near = infinite;
    const auto visit_some = [&](const Crossed& crossed, std::uint32_t first, Reach& left) {
      for (Bits some = crossed.maybe; some != 0; some &= some - 1) {
        const int k = std::countr_zero(some);
        if (crossed.near[k] > left.until) continue;
        const std::uint32_t place = first + static_cast<std::uint32_t>(k);
        if (trusting && (crossed.surely >> k & 1) != 0 && crossed.far[k] < waiting_near) {
          waiting = place;
          prefetch(&in_leaves_[place]), prefetch(&bvh_.order()[place]);
          waiting_near = crossed.near[k];
          left.until = std::min(left.until, crossed.far[k]);
        } else {
          visit(Triangle(in_leaf(place)), bvh_.order()[place]);
        }
      }
      return false;
    };
    walk<Order::near_first>(ray, range, triangle, visit, visit_some);
    return waiting_near == infinite || visit(Triangle(in_leaf(waiting)), bvh_.order()[waiting]);
  }

  bool any_of(Bits some, std::uint32_t first, const auto& visit) const {
    for (; some != 0; some &= some - 1) {
      const std::uint32_t place = first + static_cast<std::uint32_t>(std::countr_zero(some));
      if (visit(Triangle(in_leaf(place)), bvh_.order()[place])) return true;
    }
    return false;
  }

  /// Calls visit_some(crossed, first, reach) where a ray may cross triangles in the places from the first on,
  /// or visit(triangle, i) for each where float does not help. Unless near ones come first, it ends when one
  /// of them returns true, and returns whether one did.
  template <Order order>
  bool walk(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit,
            const auto& visit_some) const {
    const auto visit_one = [&](std::uint32_t i) { return visit(triangle(i), i) && order == Order::any; };
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& left) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes) {
        const Crossed crossed = leaves_.crossed(leaf, i, line, left);
        if (crossed.maybe != 0 && visit_some(crossed, leaf.first + i, left)) return true;
      }
      if constexpr (order == Order::near_first) left.until = std::min(left.until, line.at_most(range.max));
      return false;
    };
    return each_along<order>(bvh_, ray, range, visit_one, visit_leaf, leaves_.soon());
  }

  Bvh bvh_;
  std::unique_ptr<Corners[]>
      in_leaves_;  ///< by their places in the leaves, so that a leaf's are side by side
  TriangleLeaves leaves_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

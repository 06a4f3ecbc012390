// Triangles in a tree of boxes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh.hpp"
#include "triangle_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A tree over triangles that others hold. What the functions take as `triangle` is what the constructor got.
class TriangleTree {
 public:
  static constexpr std::size_t most = largest_tree;  ///< triangles

  /// Of `count` triangles; triangle(i) is one of them.
  TriangleTree(std::size_t count, const auto& triangle, const RenderOptions& options)
      : bvh_(
            count, [&](std::size_t i) { return triangle(i).bounds(); }, node_width, options),
        leaves_(bvh_, triangle, options) {}

  /// Calls visit(triangle, i) for all that a ray may cross inside the range, in any order, until one returns
  /// true; returns whether one did.
  bool each_crossed(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    return walk<Order::any>(ray, range, triangle, visit, [&](const Tried& tried, Leaf leaf, std::uint32_t i) {
      return any_of(tried.crossed | tried.in_doubt, leaf, i, visit);
    });
  }

  /// Whether a ray crosses any inside the range; visit(triangle, i) says it of one where double does not.
  bool any_crossed(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    return walk<Order::any>(ray, range, triangle, visit, [&](const Tried& tried, Leaf leaf, std::uint32_t i) {
      return tried.crossed != 0 || any_of(tried.in_doubt, leaf, i, visit);
    });
  }

  /// Calls found(t, i) for that which a ray crosses first inside the range, and for others that it crosses;
  /// or visit(triangle, i) where double does not decide. Both may shorten the range.
  void each_first(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit,
                  const auto& found) const {
    walk<Order::near_first>(ray, range, triangle, visit, [&](const Tried& tried, Leaf leaf, std::uint32_t i) {
      for (Bits some = tried.crossed; some != 0; some &= some - 1) {
        const int k = std::countr_zero(some);
        found(tried.t[k], leaves_.number(leaves_.place(leaf, i + static_cast<std::uint32_t>(k))));
      }
      any_of(tried.in_doubt, leaf, i, visit);
      return false;
    });
  }

  [[nodiscard]] const BoxSpace& space() const { return bvh_.space(); }

  /// Bvh::each_leaf_ahead.
  void each_leaf_ahead(std::span<const HalfSpace> half_spaces, const Vec3& direction, const auto& is_hidden,
                       const auto& visit) const {
    std::vector<BoxHalfSpace> seen;
    for (const HalfSpace& half_space : half_spaces) seen.emplace_back(half_space, space());
    bvh_.each_leaf_ahead(seen, direction, is_hidden, visit, [&](Leaf leaf) { leaves_.fetch(leaf); });
  }

  [[nodiscard]] const TriangleLeaves& leaves() const { return leaves_; }

  /// Which triangles stand in the leaves, one after another.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return bvh_.order(); }

  /// How many triangles stand in leaves.
  [[nodiscard]] std::size_t size() const { return bvh_.order().size(); }

  /// Whether all triangles do.
  [[nodiscard]] bool has_all() const { return bvh_.unbounded().empty(); }

 private:
  using Tried = TriangleLeaves::Tried;

  bool any_of(Bits some, Leaf leaf, std::uint32_t i, const auto& visit) const {
    for (; some != 0; some &= some - 1) {
      const auto place = leaves_.place(leaf, i + static_cast<std::uint32_t>(std::countr_zero(some)));
      if (visit(leaves_.triangle(place), leaves_.number(place))) return true;
    }
    return false;
  }

  /// Calls visit_some(tried, leaf, i) where a ray may cross triangles of a leaf, from the i-th on, or
  /// visit(triangle, i) for each where boxes do not help. Unless near ones come first, it ends when one of
  /// them returns true, and returns whether one did.
  template <Order order>
  bool walk(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit,
            const auto& visit_some) const {
    const auto visit_one = [&](std::uint32_t i) { return visit(triangle(i), i) && order == Order::any; };
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& left) {
      bool any = false;
      for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
        const Tried tried = leaves_.tried(leaf, i, ray, range);
        if ((tried.crossed | tried.in_doubt) == 0) continue;
        if (visit_some(tried, leaf, i)) return true;
        any = true;
      }
      if constexpr (order == Order::near_first)
        if (any) left.until = line.at_most(range.max);
      return false;
    };
    return each_along<order>(bvh_, ray, range, visit_one, visit_leaf,
                             [&](Leaf leaf) { leaves_.fetch(leaf); });
  }

  Bvh bvh_;
  TriangleLeaves leaves_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

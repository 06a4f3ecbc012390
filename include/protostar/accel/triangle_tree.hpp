// Triangles in a tree of boxes, and in its leaves looked for in float first.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "../surfaces/triangle.hpp"
#include "bvh.hpp"
#include "triangle_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A tree over triangles that others hold.
class TriangleTree {
 public:
  static constexpr std::size_t most = largest_tree;  ///< triangles

  /// Of `count` triangles; triangle(i) is one of them.
  TriangleTree(std::size_t count, const auto& triangle, const RenderOptions& options)
      : bvh_(
            count, [&](std::size_t i) { return triangle(i).bounds(); }, node_width, options),
        leaves_(bvh_, triangle) {
    in_leaves_.reserve(count);
    for (const std::uint32_t i : bvh_.order()) in_leaves_.push_back(triangle(i));
  }

  /// Calls visit(triangle, i) for all that a ray may cross inside the range, in any order, until one returns
  /// true; returns whether one did. triangle(i) is the same as before.
  bool each_crossed(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    return each_along_ray<Order::any>(ray, range, triangle, visit);
  }

  /// The same, near ones mostly before far ones. A visit may shorten the range.
  bool each_first(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    return each_along_ray<Order::near_first>(ray, range, triangle, visit);
  }

 private:
  template <Order order>
  bool each_along_ray(const Ray& ray, const Interval& range, const auto& triangle, const auto& visit) const {
    const auto visit_one = [&](std::uint32_t i) { return visit(triangle(i), i); };
    const auto visit_leaf = [&](const BoxRay& line, Leaf leaf, Reach& left) {
      for (std::uint32_t i = 0; i < leaf.count; i += float_lanes)
        for (Bits met = leaves_.met(leaf, i, line); met != 0; met &= met - 1) {
          const std::uint32_t place = leaf.first + i + static_cast<std::uint32_t>(std::countr_zero(met));
          if (visit(in_leaves_[place], bvh_.order()[place])) return true;
        }
      left.until = line.at_most(range.max);
      return false;
    };
    return each_along<order>(bvh_, ray, range, visit_one, visit_leaf, leaves_.soon());
  }

  Bvh bvh_;
  TriangleLeaves leaves_;
  std::vector<Triangle> in_leaves_;  ///< by their places in the leaves, so that a leaf's are side by side
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

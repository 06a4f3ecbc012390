// A tree of boxes over things that have bounds, and how to walk it: which of many can a ray meet?
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "box_space.hpp"
#include "bvh_build.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// The points x with normal · (x − on) ≥ 0; the normal has length 1 or, for all points, 0.
struct HalfSpace {
  Point on;
  Vec3 normal;
};

/// In which order leaves are visited.
enum class Order { near_first, any };

/// For leaves that need no preparation.
struct Ignore {
  void operator()(Leaf) const {}
};

/// Things with bounds, in leaves of a few, in a tree of boxes around them. It knows nothing of the things but
/// their bounds. What it visits are leaves: places first, first + 1, ... in order().
class Bvh {
 public:
  /// Of `count` things, the i-th of which has bounds_of(i); those whose bounds are not finite are in no leaf
  /// but in unbounded(). The tree does not depend on the number of threads.
  Bvh(std::size_t count, const auto& bounds_of, int leaf_size, const RenderOptions& options) {
    if (count > largest_tree) throw std::length_error("accelerate: more than 2^27 surfaces of one type");
    Bounds everything{Point{infinity}, Point{-infinity}};
    for (std::size_t i = 0; i < count; ++i)
      if (const Bounds bounds = bounds_of(i); is_finite(bounds.min) && is_finite(bounds.max))
        everything = {glm::min(everything.min, bounds.min), glm::max(everything.max, bounds.max)};
    std::vector<Box> boxes;
    std::vector<std::uint32_t> order;
    boxes.reserve(count);
    order.reserve(count);
    space_ = BoxSpace(everything);
    for (std::size_t i = 0; i < count; ++i) {
      const Bounds bounds = bounds_of(i);
      if (is_finite(bounds.min) && is_finite(bounds.max)) {
        boxes.push_back(space_(bounds));
        order.push_back(static_cast<std::uint32_t>(i));
      } else {
        unbounded_.push_back(static_cast<std::uint32_t>(i));
      }
    }
    if (!boxes.empty()) tree_ = TreeBuilder(std::move(boxes), std::move(order), leaf_size, options).build();
  }

  /// Which thing stands at each place.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return tree_.order; }
  [[nodiscard]] std::span<const std::uint32_t> unbounded() const { return unbounded_; }
  [[nodiscard]] const BoxSpace& space() const { return space_; }

  /// Calls visit(leaf) for every leaf.
  void each_leaf(const auto& visit) const {
    if (tree_.order.empty()) return;
    if (tree_.root.is_leaf()) visit(tree_.root.leaf());
    for (const Node& node : tree_.nodes)
      for (int k = 0; k < node_width && node.has(k); ++k)
        if (node.child[k].is_leaf()) visit(node.child[k].leaf());
  }

  /// Calls visit(leaf, reach) for every leaf whose box the ray may meet within a reach, until one of them
  /// returns true; returns whether one did. A visit may shorten the reach. Before that, soon(leaf) is called
  /// for leaves that are likely to be visited.
  template <Order order, class Soon = Ignore>
  bool each_leaf_along(const BoxRay& ray, Reach reach, const auto& visit, const Soon& soon = {}) const {
    if (tree_.order.empty()) return false;
    struct Entry {
      Child child;
      float near;
    };
    Entry stack[most_levels * node_width];
    int top = 0;
    Child next = tree_.root;
    for (;;) {
      if (next.is_leaf()) {
        if (visit(next.leaf(), reach)) return true;
      } else {
        const Node& node = tree_.nodes[next.node()];
        alignas(64) float near[node_width];
        const int below = top;
        for (Bits met = met_children(node, ray, reach, near); met != 0; met &= met - 1) {
          const int k = std::countr_zero(met);
          const Entry entry{node.child[k], near[k]};
          if (entry.child.is_leaf())
            soon(entry.child.leaf());
          else
            prefetch(&tree_.nodes[entry.child.node()]);
          int place = top++;
          if constexpr (order == Order::near_first)
            for (; place > below && stack[place - 1].near < entry.near; --place)
              stack[place] = stack[place - 1];
          stack[place] = entry;
        }
      }
      do {
        if (top == 0) return false;
        --top;
      } while (stack[top].near > reach.until);
      next = stack[top].child;
    }
  }

  /// Calls visit(leaf) for every leaf whose box may reach into all of some half-spaces.
  void each_leaf_in(std::span<const HalfSpace> half_spaces, const auto& visit) const {
    if (tree_.order.empty()) return;
    Child stack[most_levels * node_width];
    int top = 0;
    stack[top++] = tree_.root;
    while (top > 0) {
      const Child next = stack[--top];
      if (next.is_leaf()) {
        visit(next.leaf());
        continue;
      }
      const Node& node = tree_.nodes[next.node()];
      for (Bits within = children_in(node, half_spaces); within != 0; within &= within - 1)
        stack[top++] = node.child[std::countr_zero(within)];
    }
  }

 private:
  using Floats = Lanes<float, node_width>;

  /// The children whose boxes may reach into all half-spaces.
  ///
  /// Of a box, the corner farthest along the normal n counts, at most 1 from the origin in each component. In
  /// float, with u = 2^-24, n is off by u and the products and sums by 3u of |n_x| + |n_y| + |n_z| ≤ √3: 7u
  /// in all. The plane's distance is off by u of itself, and by less than 2^-50 |on|. 2^-20 = 16u of each
  /// covers both.
  [[nodiscard]] Bits children_in(const Node& node, std::span<const HalfSpace> half_spaces) const {
    Mask<float, node_width> outside = false;
    for (const auto& [on, n] : half_spaces) {
      const Point p = space_(on);
      const double distance = dot(n, p);
      const double margin =
          0x1p-20 * (1 + std::abs(distance)) + 0x1p-48 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
      Floats reach = 0.0f;
      for (int axis = 0; axis < 3; ++axis)
        reach +=
            Floats::load(n[axis] > 0 ? node.max[axis] : node.min[axis]) * Floats(static_cast<float>(n[axis]));
      outside = outside || reach < Floats(static_cast<float>(distance - margin));
    }
    Bits used = 0;
    for (int k = 0; k < node_width && node.has(k); ++k) used |= Bits{1} << k;
    return bits(!outside) & used;
  }

  /// The children whose boxes the ray may meet, and from where on.
  static Bits met_children(const Node& node, const BoxRay& ray, Reach reach, float* near_ends) {
    Floats near = reach.from, far = reach.until;
    for (int axis = 0; axis < 3; ++axis) {
      const float* const nearer = ray.backwards[axis] ? node.max[axis] : node.min[axis];
      const float* const farther = ray.backwards[axis] ? node.min[axis] : node.max[axis];
      near = max((Floats::load(nearer) - Floats(ray.near_origin[axis])) * Floats(ray.inverse[axis]), near);
      far = min((Floats::load(farther) - Floats(ray.far_origin[axis])) * Floats(ray.far_inverse[axis]), far);
    }
    near.store(near_ends);
    return bits(near <= far);
  }

  BoxSpace space_;
  Tree tree_;
  std::vector<std::uint32_t> unbounded_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

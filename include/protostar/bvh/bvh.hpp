// A BVH over primitives that have bounds, and its traversal, which finds those that a ray may meet.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "../bounds.hpp"
#include "../interval.hpp"
#include "../parallel.hpp"
#include "../render_options.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "../vec3.hpp"
#include "box_space.hpp"
#include "build.hpp"
#include "large_pages.hpp"
#include "node.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Order in which leaves are visited.
enum class Order { near_first, any };

/// Preparation of leaves that does nothing.
struct Ignore {
  void operator()(Leaf) const {}
};

/// A BVH: primitives with bounds, in leaves of a few. It knows nothing of the primitives but their bounds.
/// Traversals visit leaves: positions first, first + 1, ... in order().
class Bvh {
  using Floats = Lanes<float, node_width>;

 public:
  /// Builds the tree of `count` primitives, the i-th of which has bounds_of(i); one without finite bounds is
  /// in unbounded(), not in a leaf. The tree does not depend on the number of threads. Throws
  /// std::length_error if there are more than largest_tree.
  Bvh(std::size_t count, const auto& bounds_of, LeafSize leaf_size, const RenderOptions& options) {
    if (count > largest_tree) throw std::length_error("accelerate: more than 2^27 surfaces of one type");
    const protostar::detail::Parts parts{0, count};
    struct Part {
      Bounds bounds{Point{infinity}, Point{-infinity}};
      std::size_t count = 0;  ///< number of primitives with finite bounds
    };
    std::vector<Part> of_parts(static_cast<std::size_t>(parts.count()));
    parts.each(options, [&](std::size_t k, std::size_t first, std::size_t last) {
      Part part;
      for (std::size_t i = first; i < last; ++i)
        if (const Bounds bounds = bounds_of(i); is_finite(bounds.min) && is_finite(bounds.max)) {
          part.bounds = {glm::min(part.bounds.min, bounds.min), glm::max(part.bounds.max, bounds.max)};
          ++part.count;
        }
      of_parts[k] = part;
    });
    Part all;
    for (Part& part : of_parts) {
      all.bounds = {glm::min(all.bounds.min, part.bounds.min), glm::max(all.bounds.max, part.bounds.max)};
      all.count += std::exchange(part.count, all.count);  // from now on the number before the part
    }
    if (all.count < count)
      for (std::size_t i = 0; i < count; ++i)
        if (const Bounds bounds = bounds_of(i); !is_finite(bounds.min) || !is_finite(bounds.max))
          unbounded_.push_back(static_cast<std::uint32_t>(i));
    if (all.count == 0) return;
    space_ = BoxSpace(all.bounds);
    LargeVector<Box> boxes(all.count);
    LargeVector<std::uint32_t> order(all.count);
    parts.each(options, [&](std::size_t k, std::size_t first, std::size_t last) {
      std::size_t place = of_parts[k].count;
      for (std::size_t i = first; i < last; ++i)
        if (const Bounds bounds = bounds_of(i); is_finite(bounds.min) && is_finite(bounds.max)) {
          boxes[place] = space_(bounds);
          order[place++] = static_cast<std::uint32_t>(i);
        }
    });
    tree_ = TreeBuilder(std::move(boxes), std::move(order), leaf_size, options).build();
  }

  /// Returns the index of the primitive at each position.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return tree_.order; }
  [[nodiscard]] std::span<const std::uint32_t> unbounded() const { return unbounded_; }
  [[nodiscard]] const BoxSpace& space() const { return space_; }

  /// Calls visit(leaf) for every leaf, as many at a time as there are threads.
  void each_leaf(const auto& visit, const RenderOptions& options = {.threads = 1}) const {
    if (tree_.order.empty()) return;
    if (tree_.root.is_leaf()) visit(tree_.root.leaf());
    protostar::detail::for_each_in_parallel(static_cast<int>(tree_.nodes.size()),
                                            protostar::detail::threads_for(tree_.order.size(), options),
                                            [&](int i) {
                                              const Node& node = tree_.nodes[static_cast<std::size_t>(i)];
                                              for (int k = 0; k < node_width && node.has(k); ++k)
                                                if (node.child(k).is_leaf()) visit(node.child(k).leaf());
                                            });
  }

  /// Traversal by one ray, step by step: from node to node, and to every leaf whose box the ray may meet
  /// within a reach.
  template <Order order>
  class Walk {
   public:
    Reach reach;  ///< may be shortened on the way if near leaves come first

    Walk(const Bvh& bvh, const BoxRay& ray, Reach within)
        : reach(within),
          nodes_(bvh.tree_.nodes.data()),
          next_(bvh.tree_.root),
          has_ended_(bvh.tree_.order.empty()) {
      if (!has_ended_ && !next_.is_leaf()) slabs_ = Slabs(ray);
    }

    [[nodiscard]] bool has_ended() const { return has_ended_; }
    [[nodiscard]] bool is_at_leaf() const { return next_.is_leaf(); }
    [[nodiscard]] Leaf leaf() const { return next_.leaf(); }

    /// Goes on from a leaf to the next child on the stack, or ends.
    void leave() {
      do {
        if (top_ == 0) {
          has_ended_ = true;
          return;
        }
        --top_;
      } while (order == Order::near_first && near_[top_] > reach.until);
      next_ = Child(waiting_[top_]);
    }

    /// Goes on from a node to a child that the ray may meet, the nearest if near leaves come first, and puts
    /// the others on the stack. How many are met, and which is the nearest, is as good as random: therefore
    /// only whether any is met is a branch, and children on the stack are not sorted.
    void open() {
      const Node& node = nodes_[next_.node()];
      Floats near;
      Bits met = met_children(node, slabs_, reach, near);
      if constexpr (order == Order::near_first) {
        if (met == 0) return leave();
        const int k = nearest_of(met, near);
        next_ = node.child(k);
        met &= ~(Bits{1} << k);
        store_chosen(near_ + top_, met, near);
      }
      top_ += store_chosen(waiting_ + top_, met, Lanes<std::uint32_t, node_width>::load(node.children));
      if constexpr (order == Order::any) leave();
    }

    /// Prefetches what comes next; soon(leaf) does so for a leaf.
    void fetch_next(const auto& soon) const { fetch_one(next_, soon); }

   private:
    static int nearest_of(Bits met, const Floats& near) {
      const Floats of_met =
          select(mask_of<float, node_width>(met), near, std::numeric_limits<float>::infinity());
      return std::countr_zero(met & bits(of_met <= Floats(smallest(of_met))));
    }

    void fetch_one(Child child, const auto& soon) const {
      if (child.is_leaf())
        soon(child.leaf());
      else
        fetch<Read::later>(nodes_[child.node()]);
    }

    const Node* nodes_;
    Child next_;
    bool has_ended_;
    int top_ = 0;
    Slabs slabs_;
    float near_[most_levels * node_width];
    std::uint32_t waiting_[most_levels * node_width];  ///< Child::bits
  };

  /// Calls visit(leaf, reach) for every leaf whose box the ray may meet within a reach, until a call returns
  /// true; returns true if one did. A visit may shorten the reach. soon(leaf) is called before that for
  /// leaves that are put on the stack. For a single ray this replaces a Walk: its state can stay in
  /// registers, and if near leaves come first, children on the stack are sorted with branches, which the
  /// processor predicts to go on before the nearest child is known.
  template <Order order, class Soon = Ignore>
  bool each_leaf_along(const BoxRay& ray, Reach reach, const auto& visit, const Soon& soon = {}) const {
    if (tree_.order.empty()) return false;
    const Slabs slabs = tree_.root.is_leaf() ? Slabs() : Slabs(ray);
    struct Entry {
      Child child;
      float near;
    };
    Entry stack[most_levels * node_width];
    int top = 0;
    Child next = tree_.root;
    const auto take_next = [&] {
      do {
        if (top == 0) return false;
        --top;
      } while (stack[top].near > reach.until);
      next = stack[top].child;
      return true;
    };
    for (;;) {
      while (!next.is_leaf()) {
        const Node& node = tree_.nodes[next.node()];
        Floats nears;
        Bits met = met_children(node, slabs, reach, nears);
        alignas(64) float near[node_width];
        nears.store(near);
        if (met == 0) {
          if (!take_next()) return false;
          continue;
        }
        const auto take_one = [&] {
          const int k = std::countr_zero(met);
          met &= met - 1;
          return Entry{node.child(k), near[k]};
        };
        Entry nearest = take_one();
        const int below = top;
        while (met != 0) {
          Entry other = take_one();
          if (order == Order::near_first && other.near < nearest.near) std::swap(other, nearest);
          if (other.child.is_leaf())
            soon(other.child.leaf());
          else
            fetch<Read::soon>(tree_.nodes[other.child.node()]);
          int place = top++;
          if constexpr (order == Order::near_first)
            for (; place > below && stack[place - 1].near < other.near; --place)
              stack[place] = stack[place - 1];
          stack[place] = other;
        }
        next = nearest.child;
      }
      if (visit(next.leaf(), reach)) return true;
      if (!take_next()) return false;
    }
  }

  /// Calls visit(leaf) for every leaf that may be seen from an eye, near ones mostly before far ones, unless
  /// is_hidden(entry) returns true for it or a node around it by then. look(node) returns the view of a node:
  /// its entry [k] is the view of child k, with a `nearest` that is larger for nearer ones, `seen` has the
  /// bits of children that may be seen, and `in_front` of those surely in front of the eye. Unless all
  /// children seen are in front, only those whose boxes may reach into every one of the half-spaces are
  /// visited. soon(leaf) is called before for leaves that are likely to be visited.
  void each_leaf_ahead(std::span<const BoxHalfSpace> half_spaces, const auto& look, const auto& is_hidden,
                       const auto& visit, const auto& soon) const {
    if (tree_.order.empty()) return;
    if (tree_.root.is_leaf()) return visit(tree_.root.leaf());
    struct Entry {
      Child child;
      std::remove_cvref_t<decltype(look(tree_.nodes[0])[0])> seen;
    };
    Entry stack[most_levels * node_width];
    int top = 0;
    const auto open = [&](const Node& node) {
      const auto children = look(node);
      Bits left = children.seen;
      if ((left & ~children.in_front) != 0) left &= children_in(node, half_spaces);
      for (const int below = top; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        if (node.child(k).is_leaf())
          soon(node.child(k).leaf());
        else
          fetch<Read::later>(tree_.nodes[node.child(k).node()]);
        const Entry entry{node.child(k), children[k]};
        int place = top++;
        for (; place > below && stack[place - 1].seen.nearest > entry.seen.nearest; --place)
          stack[place] = stack[place - 1];
        stack[place] = entry;
      }
    };
    open(tree_.nodes[tree_.root.node()]);
    while (top > 0) {
      const auto [child, seen] = stack[--top];
      if (is_hidden(seen)) continue;
      if (child.is_leaf())
        visit(child.leaf());
      else
        open(tree_.nodes[child.node()]);
    }
  }

  /// Calls visit(leaf) for every leaf whose box may reach into every one of the half-spaces, and soon(leaf)
  /// before that.
  template <class Soon = Ignore>
  void each_leaf_in(std::span<const BoxHalfSpace> half_spaces, const auto& visit,
                    const Soon& soon = {}) const {
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
      for (Bits within = children_in(node, half_spaces); within != 0; within &= within - 1) {
        const Child child = node.child(std::countr_zero(within));
        if (child.is_leaf())
          soon(child.leaf());
        else
          prefetch(&tree_.nodes[child.node()]);
        stack[top++] = child;
      }
    }
  }

 private:
  /// Prefetches a node that is likely to be visited.
  template <Read read>
  static void fetch(const Node& node) {
    for (const auto& ends : node.end)
      for (const auto& of_axis : ends) prefetch<read>(of_axis);
    prefetch<read>(node.children);
  }

  /// Returns the children whose boxes may reach into every half-space, decided by the corner farthest along
  /// the normal.
  static Bits children_in(const Node& node, std::span<const BoxHalfSpace> half_spaces) {
    auto within = Floats::load(node.end[0][0]) <= Floats::load(node.end[1][0]);  // children that are used
    for (const auto& [normal, from] : half_spaces) {
      Floats reach = 0.0f;
      for (int axis = 0; axis < 3; ++axis)
        reach += Floats::load(node.end[normal[axis] > 0][axis]) * Floats(normal[axis]);
      within = within && !(reach < Floats(from));
    }
    return bits(within);
  }

  /// Returns the children whose boxes the ray may meet, and in `near` the distances at which it enters them,
  /// to within the errors that Slabs has.
  static Bits met_children(const Node& node, const Slabs& slabs, Reach reach, Floats& near) {
    near = reach.from;
    Floats far = reach.until;
    for (int axis = 0; axis < 3; ++axis) {
      const int nearer = slabs.nearer[axis];
      const Floats from = Floats::load(node.end[nearer][axis]), to = Floats::load(node.end[1 - nearer][axis]);
      near = max((from - Floats(slabs.near_origin[axis])) * Floats(slabs.inverse[axis]), near);
      far = min((to - Floats(slabs.far_origin[axis])) * Floats(slabs.far_inverse[axis]), far);
    }
    return bits(near <= far);
  }

  BoxSpace space_;
  Tree tree_;
  std::vector<std::uint32_t> unbounded_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

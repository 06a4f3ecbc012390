// BVH over primitives with finite bounds: construction, and access to nodes and leaves. traversal.hpp
// searches it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "../bounds.hpp"
#include "../interval.hpp"
#include "../parallel.hpp"
#include "../plain_vector.hpp"
#include "../render_options.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "../vec3.hpp"
#include "box_space.hpp"
#include "build.hpp"
#include "node.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A BVH: primitives with bounds, in leaves of a few. It knows nothing of the primitives but their bounds.
/// Traversals visit leaves: positions first, first + 1, ... in order().
class Bvh {
 public:
  /// Builds the tree of `count` primitives, the i-th of which has bounds_of(i); one without finite bounds is
  /// in unbounded(), not in a leaf. bounds_of must be free of side effects: it is called from several threads
  /// and up to three times for each i. Only options.threads is used, not progress or stop, and the tree does
  /// not depend on it. Throws std::length_error if there are more than largest_tree.
  Bvh(std::size_t count, const auto& bounds_of, LeafSize leaf_size, const RenderOptions& options) {
    if (count > largest_tree) throw std::length_error("accelerate: more than 2^27 surfaces of one type");
    const auto each_bounded = [&](std::size_t first, std::size_t last, const auto& visit) {
      for (std::size_t i = first; i < last; ++i)
        if (const Bounds bounds = bounds_of(i); is_finite(bounds)) visit(i, bounds);
    };
    const protostar::detail::Parts parts{0, count};
    struct Part {
      Bounds bounds{Point{infinity}, Point{-infinity}};
      std::size_t count = 0;  ///< number of primitives with finite bounds
    };
    PlainVector<Part> of_parts(static_cast<std::size_t>(parts.count()));
    parts.each(options, [&](std::size_t k, std::size_t first, std::size_t last) {
      Part part;
      each_bounded(first, last, [&](std::size_t, const Bounds& bounds) {
        part.bounds = {glm::min(part.bounds.min, bounds.min), glm::max(part.bounds.max, bounds.max)};
        ++part.count;
      });
      of_parts[k] = part;
    });
    Part all;
    for (Part& part : of_parts) {
      all.bounds = {glm::min(all.bounds.min, part.bounds.min), glm::max(all.bounds.max, part.bounds.max)};
      all.count += std::exchange(part.count, all.count);  // from now on the number before the part
    }
    if (all.count < count)
      for (std::size_t i = 0; i < count; ++i)
        if (!is_finite(bounds_of(i))) unbounded_.push_back(static_cast<std::uint32_t>(i));
    if (all.count == 0) return;
    space_ = BoxSpace(all.bounds);
    PlainVector<Box> boxes(all.count);
    PlainVector<std::uint32_t> order(all.count);
    parts.each(options, [&](std::size_t k, std::size_t first, std::size_t last) {
      std::size_t place = of_parts[k].count;
      each_bounded(first, last, [&](std::size_t i, const Bounds& bounds) {
        boxes[place] = space_(bounds);
        order[place++] = static_cast<std::uint32_t>(i);
      });
    });
    tree_ = TreeBuilder(std::move(boxes), std::move(order), leaf_size, options).build();
  }

  /// Returns the index of the primitive at each position.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return tree_.order; }
  [[nodiscard]] std::span<const std::uint32_t> unbounded() const { return unbounded_; }
  [[nodiscard]] const BoxSpace& space() const { return space_; }
  [[nodiscard]] Child root() const { return tree_.root; }
  [[nodiscard]] std::span<const Node> nodes() const { return tree_.nodes; }

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

 private:
  BoxSpace space_;
  Tree tree_;
  PlainVector<std::uint32_t> unbounded_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Traversal of a BVH: from node to node, and to the leaves that a search wants.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include "../platform.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../simd/store_lanes.hpp"
#include "../simd/vectors.hpp"
#include "box_space.hpp"
#include "bvh.hpp"
#include "node.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Numbers, one for each child of a node.
using NodeFloats = Lanes<float, node_width>;

/// Order of visits: near_first takes the children of each node by their entry distance, so that leaves come
/// mostly, not strictly, near to far; any does not sort them.
enum class Order { near_first, any };

/// Prefetching of children, or of leaves, that does nothing.
struct Ignore {
  void operator()(const auto&) const {}
};

/// Prefetches children of nodes that are likely to be visited; fetch_leaf(leaf) does so for a leaf.
template <Read read, class FetchLeaf>
struct FetchChild {
  const Bvh& bvh;
  const FetchLeaf& fetch_leaf;

  void operator()(Child child) const {
    if (child.is_leaf()) return fetch_leaf(child.leaf());
    const Node& node = bvh.nodes()[child.node()];
    for (const auto& ends : node.end)
      for (const auto& of_axis : ends) prefetch<read>(of_axis);
    prefetch<read>(node.children);
  }
};

/// Key of children that are visited in any order, and the children that are wanted.
struct NoKey {};
struct Met {
  Bits met;
};

/// Capacity of the stack of waiting children: node_width − 1 for each level, and room for store_chosen, which
/// may write node_width places.
inline constexpr int most_waiting = most_levels * node_width;

/// Children that wait in a traversal, with their keys. It is apart from the rest of a Traversal, which the
/// compiler then keeps in registers.
template <class Search>
struct Waiting {
  std::uint32_t children[most_waiting];  ///< Child::bits()
  typename Search::Key keys[most_waiting];
};

/// Traversal of one BVH by one search, step by step, so that several searches can take turns.
///
/// A search has a type Key, by which children are ordered, or NoKey for any order. Its look(node) returns the
/// children of a node that are wanted: the set `met`, and with keys the key of child k as operator[](k). With
/// keys, precedes(a, b) returns true if the child of key a is visited before that of key b, and
/// is_hidden(key) if the child of that key is not wanted any more, by what was found meanwhile.
template <class Search>
class Traversal {
 public:
  /// Begins at the root of a tree that is not empty.
  Traversal(const Bvh& bvh, Waiting<Search>& waiting)
      : nodes_(bvh.nodes().data()), waiting_(&waiting), next_(bvh.root()) {}

  /// Returns what the next step opens or visits.
  [[nodiscard]] Child next() const { return next_; }

  /// Opens a node, or calls visit(leaf), which returns true to end the traversal. Calls fetch(child) for
  /// children that have to wait. Returns false if the traversal has ended.
  template <class Fetch = Ignore>
  [[gnu::always_inline]] bool step(const Search& search, const auto& visit, const Fetch& fetch = {}) {
    if (!next_.is_leaf()) return open(search, fetch);
    return !visit(next_.leaf()) && go_on(search);
  }

 private:
  using Children = decltype(std::declval<const Search&>().look(std::declval<const Node&>()));

  using Key = typename Search::Key;
  static constexpr bool has_keys = !std::is_same_v<Key, NoKey>;

  /// Goes on to a child of a node that is wanted, the nearest if there are keys, and has the others wait.
  template <class Fetch>
  [[gnu::always_inline]] bool open(const Search& search, const Fetch& fetch) {
    const Node& node = nodes_[next_.node()];
    const Children children = search.look(node);
    if (children.met == 0) return go_on(search);
    int next = std::countr_zero(children.met);
    const Bits others = children.met & (children.met - 1);
    const int below = top_;
    if constexpr (has_keys) {
      // The branches that sort children are predicted: the processor goes on before it knows the nearest.
      Key nearest = children[next];
      for (int other : lanes_in(others)) {
        Key key = children[other];
        if (search.precedes(key, nearest)) std::swap(key, nearest), std::swap(other, next);
        fetch(node.child(other));
        int place = top_++;
        for (; place > below && search.precedes(waiting_->keys[place - 1], key); --place) {
          waiting_->keys[place] = waiting_->keys[place - 1];
          waiting_->children[place] = waiting_->children[place - 1];
        }
        waiting_->keys[place] = key, waiting_->children[place] = node.children[other];
      }
      next_ = node.child(next);
      return !search.is_hidden(nearest) || go_on(search);
    } else {
      // How many children wait is as good as random, and therefore no branch.
      top_ += store_chosen(waiting_->children + top_, others,
                           Lanes<std::uint32_t, node_width>::load(node.children));
      if constexpr (!std::is_same_v<Fetch, Ignore>)
        for (int i = below; i < top_; ++i) fetch(Child(waiting_->children[i]));
      next_ = node.child(next);
      return true;
    }
  }

  /// Goes on to the next child that waits and is still wanted; returns false if there is none.
  [[gnu::always_inline]] bool go_on([[maybe_unused]] const Search& search) {
    do {
      if (top_ == 0) return false;
      --top_;
    } while (is_hidden(search, top_));
    next_ = Child(waiting_->children[top_]);
    return true;
  }

  [[nodiscard]] bool is_hidden([[maybe_unused]] const Search& search, [[maybe_unused]] int i) const {
    if constexpr (has_keys)
      return search.is_hidden(waiting_->keys[i]);
    else
      return false;
  }

  const Node* nodes_;
  Waiting<Search>* waiting_;
  Child next_;
  int top_ = 0;  ///< number of children that wait
};

/// Visits the leaves that a search wants, until visit(leaf) returns true; returns true if one did. Calls
/// fetch(child) for children that have to wait.
template <class Search, class Fetch = Ignore>
[[gnu::always_inline]] inline bool traverse(const Bvh& bvh, const Search& search, const auto& visit,
                                            const Fetch& fetch = {}) {
  if (bvh.order().empty()) return false;
  bool has_ended = false;
  Waiting<Search> waiting;
  Traversal<Search> traversal(bvh, waiting);
  while (traversal.step(
      search, [&](Leaf leaf) { return has_ended = visit(leaf); }, fetch)) {
  }
  return has_ended;
}

/// Search for the leaves whose boxes a ray may meet within a reach, which may be shortened on the way if near
/// ones come first.
template <Order order>
struct AlongRay {
  using Key = std::conditional_t<order == Order::near_first, float, NoKey>;

  Slabs slabs;
  Reach reach;

  /// Makes the search of a non-empty tree. If the root is a leaf, it is visited without a box test, and slabs
  /// stays unset.
  AlongRay(const Bvh& bvh, const BoxRay& ray, Reach within)
      : slabs(bvh.root().is_leaf() ? Slabs() : Slabs(ray, node_width)), reach(within) {}

  /// Distances at which a ray enters boxes, to within the errors that Slabs has.
  struct Distances {
    Bits met;
    alignas(64) float near[node_width];

    Distances(Bits some, const NodeFloats& distances) : met(some) { distances.store(near); }
    float operator[](int k) const { return near[k]; }
  };

  [[nodiscard]] auto look(const Node& node) const {
    const float* const ends = node.end[0][0];
    const auto distance = [&](const std::int32_t* end, const Float4& shift, int axis) {
      return fused_or_not(NodeFloats::load(ends + end[axis]), NodeFloats(slabs.inverse[axis]),
                          NodeFloats(shift[axis]));
    };
    const auto nearer = [&](int axis) { return distance(slabs.near_end, slabs.near_shift, axis); };
    const auto farther = [&](int axis) { return distance(slabs.far_end, slabs.far_shift, axis); };
    const NodeFloats near = max(max(nearer(0), nearer(1)), max(nearer(2), NodeFloats(reach.from)));
    const NodeFloats far = min(min(farther(0), farther(1)), min(farther(2), NodeFloats(reach.until)));
    const Bits met = bits(near <= far);
    if constexpr (order == Order::any)
      return Met{met};
    else
      return Distances(met, near);
  }
  [[nodiscard]] bool precedes(float near, float other) const { return near < other; }
  [[nodiscard]] bool is_hidden(float near) const { return near > reach.until; }
};

/// Search for the leaves whose boxes may reach into every one of some half-spaces.
struct InHalfSpaces {
  using Key = NoKey;

  std::span<const BoxHalfSpace> half_spaces;

  /// Decides by the corner of each box that is farthest along the normal.
  [[nodiscard]] Met look(const Node& node) const {
    auto within =
        NodeFloats::load(node.end[0][0]) <= NodeFloats::load(node.end[1][0]);  // children that are used
    for (const auto& [normal, from] : half_spaces) {
      NodeFloats reach = 0.0f;
      for (int axis = 0; axis < 3; ++axis)
        reach += NodeFloats::load(node.end[normal[axis] > 0][axis]) * NodeFloats(normal[axis]);
      within = within && !(reach < NodeFloats(from));
    }
    return {bits(within)};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

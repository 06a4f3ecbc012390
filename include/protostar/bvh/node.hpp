// Nodes of a BVH: boxes of children, each of which is another node or a leaf of primitives.
#pragma once

#include <cstdint>

#include "../plain_vector.hpp"
#include "../platform.hpp"
#include "../simd/vector_registers.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Number of children of a node.
inline constexpr int node_width = float_lanes < 4 ? 4 : float_lanes;

/// Largest number of primitives in a leaf, and in a tree.
inline constexpr std::uint32_t largest_leaf = 16, largest_tree = 1u << 27;

/// Primitives at consecutive positions.
struct Leaf {
  std::uint32_t first, count;
};

/// Content of one box of a node: another node, or a leaf.
class Child {
 public:
  Child() = default;
  static Child node(std::uint32_t index) { return Child(index); }
  static Child leaf(Leaf leaf) { return Child(leaf_bit | leaf.first << 4 | (leaf.count - 1)); }

  [[nodiscard]] bool is_leaf() const { return (bits_ & leaf_bit) != 0; }
  [[nodiscard]] std::uint32_t node() const { return bits_; }
  [[nodiscard]] Leaf leaf() const { return {(bits_ & ~leaf_bit) >> 4, (bits_ & 15) + 1}; }

  /// Returns a number from which Child(bits) makes the same child.
  [[nodiscard]] std::uint32_t bits() const { return bits_; }
  explicit Child(std::uint32_t bits) : bits_(bits) {}

 private:
  static constexpr std::uint32_t leaf_bit = 1u << 31;
  std::uint32_t bits_;
};

/// Boxes of up to node_width children, axis by axis. An unused box contains nothing, and no ray meets it.
struct alignas(64) Node {
  float end[2][3][node_width];  ///< 0 is min, 1 max
  std::uint32_t children[node_width];

  [[nodiscard]] Child child(int k) const { return Child(children[k]); }

  [[nodiscard]] bool has(int k) const { return end[0][0][k] <= end[1][0][k]; }
};

/// A BVH over boxes; primitives are stored in the order of the leaves.
struct Tree {
  Child root = Child(0);  ///< any value if the tree is empty
  PlainVector<Node> nodes;
  PlainVector<std::uint32_t> order;  ///< index of the primitive at each position
};

/// Number of levels that are cut by cost; below them, ranges are cut into halves. All levels are then at most
/// these and log(largest_tree) to the base node_width, which a tree of very unequal boxes could otherwise
/// exceed.
inline constexpr int levels_by_cost = 16;
inline constexpr int most_levels = levels_by_cost + (node_width < 8 ? 14 : 10);

}  // namespace protostar::inline PROTOSTAR_ABI::simd

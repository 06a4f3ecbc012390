// How a tree of boxes is built: where a cut makes the boxes that a ray has to look into smallest.
//
// Rays that meet a box meet a box inside it with a likelihood of the ratio of their surfaces. So a cut costs
//   area(left) · count(left) + area(right) · count(right),
// and the best of the cuts between 16 slices on each of the three axes is taken (the surface area heuristic,
// binned). A node has as many children as a vector has lanes; it is cut until it has them.
//
// The nodes of a level do not depend on each other, and are made in parallel; their places follow from their
// order. So the tree is the same for any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "../parallel.hpp"
#include "box_space.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// How many children a node has.
inline constexpr int node_width = float_lanes < 4 ? 4 : float_lanes;

/// The most things that a leaf can have, and the most in a tree.
inline constexpr std::uint32_t largest_leaf = 16, largest_tree = 1u << 27;

/// Things in a row.
struct Leaf {
  std::uint32_t first, count;
};

/// What is inside a box of a node: another node, or a leaf.
class Child {
 public:
  Child() = default;
  static Child node(std::uint32_t index) { return Child(index); }
  static Child leaf(Leaf leaf) { return Child(leaf_bit | leaf.first << 4 | (leaf.count - 1)); }

  [[nodiscard]] bool is_leaf() const { return (bits_ & leaf_bit) != 0; }
  [[nodiscard]] std::uint32_t node() const { return bits_; }
  [[nodiscard]] Leaf leaf() const { return {(bits_ & ~leaf_bit) >> 4, (bits_ & 15) + 1}; }

 private:
  static constexpr std::uint32_t leaf_bit = 1u << 31;
  explicit Child(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t bits_;
};

/// The boxes of up to node_width children, axis by axis. A box that is not used contains nothing, and no ray
/// meets it.
struct alignas(64) Node {
  float end[2][3][node_width];  ///< 0 is min, 1 max
  Child child[node_width];

  [[nodiscard]] bool has(int k) const { return end[0][0][k] <= end[1][0][k]; }
};

/// A tree over boxes; the things in it are numbered in the order of the leaves.
struct Tree {
  Child root;
  std::vector<Node> nodes;
  std::vector<std::uint32_t> order;  ///< which thing stands at each place
};

/// Levels below this one are cut into halves, whatever that costs. Their number is then at most this and
/// log(largest_tree) to the base node_width: what a tree of very unlike boxes could otherwise exceed.
inline constexpr int levels_by_cost = 16;
inline constexpr int most_levels = levels_by_cost + (node_width < 8 ? 14 : 10);

class TreeBuilder {
 public:
  /// Of the boxes of things, in the order in which they are numbered.
  TreeBuilder(std::vector<Box> boxes, std::vector<std::uint32_t> order, int leaf_size,
              const RenderOptions& options)
      : boxes_(std::move(boxes)),
        leaf_size_(static_cast<std::uint32_t>(leaf_size)),
        options_{.threads = options.threads} {
    tree_.order = std::move(order);
  }

  [[nodiscard]] Tree build() {
    std::vector<Range> level{range_of(0, static_cast<std::uint32_t>(boxes_.size()))};
    if (level[0].count() <= leaf_size_) {
      tree_.root = Child::leaf({0, level[0].count()});
      return std::move(tree_);
    }
    tree_.root = Child::node(0);
    for (int depth = 0; !level.empty(); ++depth) level = nodes_of(level, depth);
    return std::move(tree_);
  }

 private:
  /// Things that stand next to each other, with the box around them and the one around their middles.
  struct Range {
    Box box, middles;
    std::uint32_t first, last;

    [[nodiscard]] std::uint32_t count() const { return last - first; }
  };

  [[nodiscard]] static Range empty_range(std::uint32_t first, std::uint32_t last) {
    return {.box = Box::nothing(), .middles = Box::nothing(), .first = first, .last = last};
  }
  [[nodiscard]] Range range_of(std::uint32_t first, std::uint32_t last) const {
    Range range = empty_range(first, last);
    for (std::uint32_t i = first; i < last; ++i) {
      range.box.add(boxes_[i]);
      range.middles.add(boxes_[i].middle());
    }
    return range;
  }

  /// Makes a node of each range, and returns the ranges of their children that are nodes too.
  [[nodiscard]] std::vector<Range> nodes_of(const std::vector<Range>& level, int depth) {
    const std::size_t first = tree_.nodes.size();
    tree_.nodes.resize(first + level.size());
    const auto inner = std::make_unique_for_overwrite<Range[]>(level.size() * node_width);
    std::vector<int> counts(level.size());
    std::uint32_t things = 0;
    for (const Range& range : level) things += range.count();
    const RenderOptions alone{.threads = 1};
    protostar::detail::for_each_in_parallel(
        static_cast<int>(level.size()), things < 8192 ? alone : options_, [&](int i) {
          const auto at = static_cast<std::size_t>(i);
          counts[at] = make_node(tree_.nodes[first + at], level[at], depth, &inner[at * node_width]);
        });

    std::vector<Range> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      Node& node = tree_.nodes[first + i];
      for (int k = 0; k < counts[i]; ++k) {
        node.child[k] = Child::node(static_cast<std::uint32_t>(tree_.nodes.size() + next.size()));
        next.push_back(inner[i * node_width + static_cast<std::size_t>(k)]);
      }
    }
    return next;
  }

  /// Fills a node; children that are to be nodes come first, and their ranges are given back.
  int make_node(Node& node, const Range& range, int depth, Range* inner) {
    Range parts[node_width];
    int count = 1;
    parts[0] = range;
    const auto size_of = [&](const Range& part) {
      return depth < levels_by_cost ? part.box.area() : static_cast<float>(part.count());
    };
    std::uint32_t enough = leaf_size_;
    while (count < node_width) {
      Range* largest = nullptr;
      for (Range* part = parts; part != parts + count; ++part)
        if (part->count() > enough && (!largest || size_of(*part) > size_of(*largest))) largest = part;
      if (!largest && enough > 2) {
        enough = 2;  // all parts are leaves; places that are left over make smaller ones of them
        continue;
      }
      if (!largest) break;
      const auto [left, right] = depth < levels_by_cost ? cut_by_cost(*largest) : halves(*largest);
      *largest = left;
      parts[count++] = right;
    }

    int nodes = 0;
    for (int k = 0; k < count; ++k)
      if (parts[k].count() > leaf_size_) {
        inner[nodes] = parts[k];
        put(node, nodes++, parts[k].box);
      }
    int place = nodes;
    for (int k = 0; k < count; ++k)
      if (parts[k].count() <= leaf_size_) {
        node.child[place] = Child::leaf({parts[k].first, parts[k].count()});
        put(node, place++, parts[k].box);
      }
    for (; place < node_width; ++place) put(node, place, Box::nothing());
    return nodes;
  }

  static void put(Node& node, int k, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      node.end[0][axis][k] = box.min[axis];
      node.end[1][axis][k] = box.max[axis];
    }
  }

  struct Slice {
    Box box = Box::nothing();
    std::uint32_t count = 0;
  };
  static constexpr int most_slices = 16;

  /// Where middles are farther apart than 2^-100, their place among the slices is a finite number.
  struct Slicing {
    Float4 start, step;

    Slicing(const Box& middles, int slices) : start(middles.min) {
      const Float4 size = middles.max - middles.min;
      // A little less than the number of slices, so that the last middle too is in the last one.
      const Float4 most = static_cast<float>(slices) * (1 - 0x1p-20f);
      step = select(size > Float4(0x1p-100f), most / size, Float4(0));
    }
    [[nodiscard]] Float4 place(const Box& box) const { return (box.middle() - start) * step; }
  };

  [[nodiscard]] std::pair<Range, Range> cut_by_cost(const Range& range) {
    const int slices = range.count() < 16 ? 4 : range.count() < 64 ? 8 : most_slices;
    const Slicing slicing(range.middles, slices);
    Slice slice[3][most_slices];
    for (std::uint32_t i = range.first; i < range.last; ++i) {
      const Float4 place = slicing.place(boxes_[i]);
      for (int axis = 0; axis < 3; ++axis) {
        Slice& at = slice[axis][static_cast<int>(place[axis])];
        at.box.add(boxes_[i]);
        ++at.count;
      }
    }

    float lowest = std::numeric_limits<float>::infinity();
    int best_axis = -1, best_cut = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (slicing.step[axis] == 0) continue;
      float right_cost[most_slices];
      Slice part;
      for (int cut = slices - 1; cut > 0; --cut) {
        part.box.add(slice[axis][cut].box);
        part.count += slice[axis][cut].count;
        right_cost[cut] = part.count == 0 ? 0 : part.box.area() * static_cast<float>(part.count);
      }
      part = {};
      for (int cut = 1; cut < slices; ++cut) {
        part.box.add(slice[axis][cut - 1].box);
        part.count += slice[axis][cut - 1].count;
        const float cost = part.box.area() * static_cast<float>(part.count) + right_cost[cut];
        if (cost < lowest) lowest = cost, best_axis = axis, best_cut = cut;
      }
    }
    if (best_axis < 0) return halves(range);

    Range left = empty_range(range.first, range.last), right = left;
    for (int k = 0; k < slices; ++k) (k < best_cut ? left : right).box.add(slice[best_axis][k].box);
    // What stands between `middle` and i belongs to the right, so that swapping does no harm to it: there is
    // no branch that could be mispredicted.
    Box middles[2] = {Box::nothing(), Box::nothing()};
    std::uint32_t middle = range.first;
    for (std::uint32_t i = range.first; i < range.last; ++i) {
      const bool is_right = static_cast<int>(slicing.place(boxes_[i])[best_axis]) >= best_cut;
      middles[is_right].add(boxes_[i].middle());
      std::swap(boxes_[i], boxes_[middle]);
      std::swap(tree_.order[i], tree_.order[middle]);
      middle += !is_right;
    }
    left.middles = middles[0];
    right.middles = middles[1];
    left.last = right.first = middle;
    return {left, right};
  }

  [[nodiscard]] std::pair<Range, Range> halves(const Range& range) const {
    const std::uint32_t middle = range.first + range.count() / 2;
    return {range_of(range.first, middle), range_of(middle, range.last)};
  }

  std::vector<Box> boxes_;
  std::uint32_t leaf_size_;
  RenderOptions options_;
  Tree tree_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

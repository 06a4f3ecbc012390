// Builds a BVH by the surface area heuristic, binned: cuts are chosen for the least expected work of a ray.
//
// A ray that meets a box meets a box inside it with a probability of the ratio of their surface areas. Hence
// a cut costs
//   area(left) · count(left) + area(right) · count(right),
// and the cheapest of the cuts between up to 16 slices on each of the three axes is taken. A node has
// node_width children, or fewer if no remaining part fits into its free places as leaves.
//
// Ranges of many primitives are cut before nodes are made of them: the largest by all threads together, each
// cutting a part of it, and then as many ranges at a time as there are threads. The nodes of a level do not
// depend on each other and are made in parallel; their places follow from their order. Therefore the tree is
// the same for any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "../parallel.hpp"
#include "../plain_vector.hpp"
#include "../render_options.hpp"
#include "../simd/simd.hpp"
#include "box_slices.hpp"
#include "box_space.hpp"
#include "node.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Numbers of primitives in leaves: at most `most`; if a node has free places, its leaves of more than
/// `enough` are cut further. For triangles `enough` is the number tested at once.
struct LeafSize {
  std::uint32_t most, enough = 2;
};

class TreeBuilder {
 public:
  /// Takes the boxes of primitives; order[i] is the index of the one in boxes[i].
  TreeBuilder(PlainVector<Box> boxes, PlainVector<std::uint32_t> order, LeafSize leaf_size,
              const RenderOptions& options)
      : boxes_(std::move(boxes)), leaf_size_(leaf_size), options_{.threads = options.threads} {
    tree_.order = std::move(order);
  }

  [[nodiscard]] Tree build() {
    const auto count = static_cast<std::uint32_t>(tree_.order.size());
    if (count <= leaf_size_.most) {
      tree_.root = Child::leaf({0, count});
      return std::move(tree_);
    }
    tree_.root = Child::node(0);
    PlainVector<Range> level(1, cut_beforehand(all_of(count)));
    for (int depth = 0; !level.empty(); ++depth) level = nodes_of(level, depth);
    return std::move(tree_);
  }

 private:
  using Parts = protostar::detail::Parts;
  static inline const RenderOptions alone{.threads = 1};
  struct Halves;
  static constexpr int most_rounds = 16;  ///< limits cuts that leave nearly all on one side

  /// Primitives at consecutive positions, with the box around them and the box around twice their
  /// centers.
  struct Range {
    Box box, centers;
    std::uint32_t first, last;
    const Halves* halves = nullptr;  ///< the halves, if it has been cut already

    [[nodiscard]] std::uint32_t count() const { return last - first; }
  };
  struct Halves {
    Range left, right;
  };

  [[nodiscard]] static Range empty_range(std::uint32_t first, std::uint32_t last) {
    return {.box = Box::nothing(), .centers = Box::nothing(), .first = first, .last = last};
  }
  [[nodiscard]] Range range_of(std::uint32_t first, std::uint32_t last) const {
    Range range = empty_range(first, last);
    for (std::uint32_t i = first; i < last; ++i) {
      range.box.add(boxes_[i]);
      range.centers.add(boxes_[i].twice_center());
    }
    return range;
  }

  [[nodiscard]] Range all_of(std::uint32_t count) const {
    const Parts parts{0, count};
    PlainVector<Range> of_parts(static_cast<std::size_t>(parts.count()));
    parts.each(options_, [&](std::size_t part, std::size_t first, std::size_t last) {
      of_parts[part] = range_of(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last));
    });
    Range all = empty_range(0, count);
    for (const Range& part : of_parts) {
      all.box.add(part.box);
      all.centers.add(part.centers);
    }
    return all;
  }

  /// Cuts a range, its halves, and so on while they have many primitives; returns it with its halves. Ranges
  /// of more than for_all_threads are cut by all threads together, the others by one thread each.
  [[nodiscard]] Range cut_beforehand(Range all) {
    constexpr std::uint32_t many = 4096, for_all_threads = 1u << 16;
    PlainVector<Range*> ranges;
    if (all.count() > many) ranges.push_back(&all);
    for (int round = 0; round < most_rounds && !ranges.empty(); ++round) {
      PlainVector<Halves>& cuts = cuts_[round];
      cuts.resize(ranges.size());
      for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i]->halves = &cuts[i];
      const auto is_for_all = [&](std::size_t i) { return ranges[i]->count() > for_all_threads; };
      for (std::size_t i = 0; i < ranges.size(); ++i)
        if (is_for_all(i)) cuts[i] = cut_by_cost(*ranges[i], options_);
      protostar::detail::for_each_in_parallel(static_cast<int>(ranges.size()), options_, [&](int k) {
        const auto i = static_cast<std::size_t>(k);
        if (!is_for_all(i)) cuts[i] = cut_by_cost(*ranges[i], alone);
      });
      ranges.clear();
      for (Halves& both : cuts) {
        if (both.left.count() > many) ranges.push_back(&both.left);
        if (both.right.count() > many) ranges.push_back(&both.right);
      }
    }
    return all;
  }

  /// Makes a node of each range; returns the ranges of their children that are nodes too.
  [[nodiscard]] PlainVector<Range> nodes_of(const PlainVector<Range>& level, int depth) {
    const std::size_t first = tree_.nodes.size();
    tree_.nodes.resize(first + level.size());
    PlainVector<Range> inner(level.size() * node_width);
    PlainVector<int> counts(level.size());
    std::uint32_t things = 0;
    for (const Range& range : level) things += range.count();
    protostar::detail::for_each_in_parallel(
        static_cast<int>(level.size()), protostar::detail::threads_for(things, options_), [&](int i) {
          const auto at = static_cast<std::size_t>(i);
          counts[at] = make_node(tree_.nodes[first + at], level[at], depth, &inner[at * node_width]);
        });

    PlainVector<Range> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      Node& node = tree_.nodes[first + i];
      for (int k = 0; k < counts[i]; ++k) {
        node.children[k] = Child::node(static_cast<std::uint32_t>(tree_.nodes.size() + next.size())).bits();
        next.push_back(inner[i * node_width + static_cast<std::size_t>(k)]);
      }
    }
    return next;
  }

  /// Fills a node; children that are nodes come first. Stores their ranges in `inner` and returns their
  /// number.
  int make_node(Node& node, const Range& range, int depth, Range* inner) {
    Range parts[node_width]{range};
    const int count = cut_into_children(parts, depth);
    int nodes = 0;
    for (int k = 0; k < count; ++k)
      if (parts[k].count() > leaf_size_.most) {
        inner[nodes] = parts[k];
        put(node, nodes++, parts[k].box);
      }
    int place = nodes;
    for (int k = 0; k < count; ++k)
      if (parts[k].count() <= leaf_size_.most) {
        node.children[place] = Child::leaf({parts[k].first, parts[k].count()}).bits();
        put(node, place++, parts[k].box);
      }
    for (; place < node_width; ++place) {
      node.children[place] = 0;
      put(node, place, Box::nothing());
    }
    return nodes;
  }

  /// Cuts the first of node_width parts into the children of a node; returns the number of children.
  ///
  /// Leaves are assumed to be half full, as cuts seldom fill them. First, parts that would not fit into one
  /// node are cut. Then the largest part whose leaves fit into its own place and the free ones is cut into
  /// leaves, and so on: nodes at the bottom have few empty places, and hence there are few of them. A part
  /// that is left over, or whose cuts need more places than assumed, becomes a node. Last, leaves are cut
  /// into smaller ones while there are free places.
  int cut_into_children(Range* parts, int depth) {
    int count = 1;
    const std::uint32_t all = parts[0].count();
    const bool by_cost = depth < levels_by_cost;
    const auto size_of = [&](const Range& part) {
      return by_cost ? part.box.half_area() : static_cast<float>(part.count());
    };
    // Returns the largest part, from index `from` on, that has more than `more_than` and at most `at_most`
    // primitives.
    const auto largest = [&](int from, std::uint32_t more_than, std::uint32_t at_most) {
      Range* found = nullptr;
      for (Range* part = parts + from; part != parts + count; ++part)
        if (part->count() > more_than && part->count() <= at_most &&
            (!found || size_of(*part) > size_of(*found)))
          found = part;
      return found;
    };
    // Cuts the largest such part until there is none, or no free place.
    const auto cut = [&](int from, std::uint32_t more_than, std::uint32_t at_most) {
      while (count < node_width) {
        Range* const part = largest(from, more_than, at_most);
        if (!part) return;
        const Halves both = !by_cost       ? halves(*part)
                            : part->halves ? *part->halves
                                           : cut_by_cost(*part, alone);
        *part = both.left;
        parts[count++] = both.right;
      }
    };

    const auto things_in = [&](int places) {
      return static_cast<std::uint32_t>(places) * ((leaf_size_.most + 1) / 2);
    };
    // Below the levels by cost everything is cut that can be, so that these levels are few; no part is then
    // left to fit.
    cut(0, by_cost ? things_in(node_width) : leaf_size_.most, all);
    // Each turn takes at least one place; without a free place, no part fits but leaves.
    while (Range* const part = largest(0, leaf_size_.most, things_in(node_width - count + 1))) {
      std::swap(*part, parts[count - 1]);  // to the end, where the parts that it is cut into are added
      cut(count - 1, leaf_size_.most, all);
    }
    cut(0, leaf_size_.enough, leaf_size_.most);
    return count;
  }

  static void put(Node& node, int k, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      node.end[0][axis][k] = box.min[axis];
      node.end[1][axis][k] = box.max[axis];
    }
  }

  /// Returns the sums of the primitives in each slice.
  [[nodiscard, gnu::noinline]] Slices sliced(const Slicing& slicing, std::size_t first,
                                             std::size_t last) const {
    Slices slices(slicing.count);
    const auto add = [&](std::size_t i, Slices& to) {
      const Float4 place = slicing.place(boxes_[i]);
      for (int axis = 0; axis < 3; ++axis) to.on[axis][static_cast<int>(place[axis])].add({boxes_[i], 1});
    };
    // Two sums, since neighbors are often in one slice and each addition would wait for the one before; for
    // few primitives, merging the second sum costs more than it saves.
    if (last - first > 256) {
      Slices others(slicing.count);
      for (; first + 1 < last; first += 2) add(first, slices), add(first + 1, others);
      slices.add(others);
    }
    for (; first < last; ++first) add(first, slices);
    return slices;
  }
  [[nodiscard]] Slices sliced(const Slicing& slicing, const Parts& parts,
                              const RenderOptions& threads) const {
    if (parts.count() == 1) return sliced(slicing, parts.first, parts.last);
    PlainVector<Slices> of_parts(static_cast<std::size_t>(parts.count()));
    parts.each(threads, [&](std::size_t part, std::size_t first, std::size_t last) {
      of_parts[part] = sliced(slicing, first, last);
    });
    for (std::size_t part = 1; part < of_parts.size(); ++part) of_parts[0].add(of_parts[part]);
    return of_parts[0];
  }

  /// Cuts a range where that costs least, and brings the primitives of either side together; cuts it into
  /// halves if all centers are in one place.
  [[nodiscard]] Halves cut_by_cost(const Range& range, const RenderOptions& threads) {
    const int slices = range.count() < 16 ? 4 : range.count() < 64 ? 8 : most_slices;
    const Slicing slicing(range.centers, slices);
    const Parts parts{range.first, range.last};
    const Slices sums = sliced(slicing, parts, threads);
    const auto& slice = sums.on;

    float lowest = std::numeric_limits<float>::infinity();
    int best_axis = -1, best_cut = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (slicing.step[axis] == 0) continue;
      // No side of a cut is empty: the least center is in the first slice, the largest in the last (Slicing).
      float right_cost[most_slices];
      Slice part = Slice::nothing();
      for (int cut = slices - 1; cut > 0; --cut) {
        part.add(slice[axis][cut]);
        right_cost[cut] = part.box.half_area() * static_cast<float>(part.count);
      }
      part = Slice::nothing();
      for (int cut = 1; cut < slices; ++cut) {
        part.add(slice[axis][cut - 1]);
        const float cost = part.box.half_area() * static_cast<float>(part.count) + right_cost[cut];
        if (cost < lowest) lowest = cost, best_axis = axis, best_cut = cut;
      }
    }
    if (best_axis < 0) return halves(range);

    Range left = empty_range(range.first, range.last), right = left;
    for (int k = 0; k < slices; ++k) (k < best_cut ? left : right).box.add(slice[best_axis][k].box);
    const Divided things = divided(parts, threads, [&](const Box& box) {
      return static_cast<int>(slicing.place(box)[best_axis]) >= best_cut;
    });
    left.centers = things.centers[0];
    right.centers = things.centers[1];
    left.last = right.first = things.middle;
    return {left, right};
  }

  /// Primitives after a cut, the left ones before `middle`; `centers` are the boxes around twice the
  /// centers of either side.
  struct Divided {
    std::uint32_t first, middle, last;
    Box centers[2];
  };

  /// Brings the primitives for which is_right(box) is false to the front of a range, and the others behind
  /// them.
  [[nodiscard, gnu::noinline]] Divided divided(std::uint32_t first, std::uint32_t last,
                                               const auto& is_right) {
    // The primitives between `middle` and i belong to the right, so that swapping does no harm: there is no
    // branch that could be mispredicted.
    Box left = Box::nothing(), right = Box::nothing();
    std::uint32_t middle = first;
    for (std::uint32_t i = first; i < last; ++i) {
      const bool is_one_right = is_right(boxes_[i]);
      const Float4 place = boxes_[i].twice_center();
      const Mask<float, 4> to_right = is_one_right, to_left = !is_one_right;
      left.add(Box{select(to_left, place, left.min), select(to_left, place, left.max)});
      right.add(Box{select(to_right, place, right.min), select(to_right, place, right.max)});
      swap(i, middle);
      middle += !is_one_right;
    }
    return {first, middle, last, {left, right}};
  }

  [[nodiscard]] Divided divided(const Parts& parts, const RenderOptions& threads, const auto& is_right) {
    const auto of_one = [&](std::size_t first, std::size_t last) {
      return divided(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last), is_right);
    };
    if (parts.count() == 1) return of_one(parts.first, parts.last);
    PlainVector<Divided> of_parts(static_cast<std::size_t>(parts.count()));
    parts.each(threads, [&](std::size_t part, std::size_t first, std::size_t last) {
      of_parts[part] = of_one(first, last);
    });
    Divided all = of_parts[0];
    all.last = of_parts.back().last;
    for (std::size_t part = 1; part < of_parts.size(); ++part) {
      all.middle += of_parts[part].middle - of_parts[part].first;
      for (int side = 0; side < 2; ++side) all.centers[side].add(of_parts[part].centers[side]);
    }
    bring_together(of_parts, all.middle);
    return all;
  }

  /// Swaps the primitives of the right side that stand before the overall middle with those of the left side
  /// behind it.
  void bring_together(const PlainVector<Divided>& parts, std::uint32_t middle) {
    auto other = parts.begin();
    std::uint32_t left = middle;
    for (const Divided& part : parts)
      for (std::uint32_t right = part.middle; right < std::min(part.last, middle); ++right, ++left) {
        while (left >= other->middle) ++other, left = std::max(other->first, middle);
        swap(left, right);
      }
  }

  void swap(std::uint32_t i, std::uint32_t j) {
    std::swap(boxes_[i], boxes_[j]);
    std::swap(tree_.order[i], tree_.order[j]);
  }

  /// Returns the halves of a range, in the order that its primitives have.
  [[nodiscard]] Halves halves(const Range& range) const {
    const std::uint32_t middle = range.first + range.count() / 2;
    return {range_of(range.first, middle), range_of(middle, range.last)};
  }

  PlainVector<Box> boxes_;
  LeafSize leaf_size_;
  RenderOptions options_;
  PlainVector<Halves> cuts_[most_rounds];  ///< made before the nodes
  Tree tree_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// A BVH over triangles, which answers queries about rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "../bvh/bvh.hpp"
#include "../bvh/node.hpp"
#include "../bvh/ray_in_bvh.hpp"
#include "../bvh/traversal.hpp"
#include "../simd/prefetch.hpp"
#include "mesh_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A BVH over triangles that others hold. The argument `triangle` of its functions is the one of the
/// constructor.
///
/// A query asks which triangles a ray crosses inside a range. It has the members
///
///   ray, range            the query may shorten the range on the way, if near_first is true
///   distance()            upper bound of how far the ray starts from its origin, on each axis, as it may
///                         leave a triangle
///   line                  its line in doubles, with their errors (RoundedLine)
///   near_first            true if near triangles are to come mostly before far ones
///   found(t, i)           tells that the i-th triangle is crossed at t
///   maybe(triangle, i)    tells that it may be crossed, which double does not decide
///
/// The last two return true if nothing more is asked for.
class TriangleTree {
 public:
  /// Builds the tree of `count` triangles; triangle(i) returns the i-th.
  TriangleTree(std::size_t count, const auto& triangle, const RenderOptions& options)
      : bvh_(
            count, [&](std::size_t i) { return triangle(i).bounds(); }, leaf_size, options),
        leaves_(bvh_, triangle, options) {}

  /// Tells a query which triangles its ray crosses, until it asks for nothing more.
  template <class Query>
  void answer(Query& query, const auto& triangle) const {
    constexpr Order order = order_for<Query>;
    each_along<order>(
        bvh_, BoxRay(query.ray, bvh_.space(), widening(query, bvh_.space())), query.range,
        [&](std::uint32_t i) { return query.maybe(triangle(i), i); },
        [&](const BoxRay& line, Leaf leaf, Reach& reach) { return show<order>(query, line, leaf, reach); },
        [&](Leaf leaf) { leaves_.fetch<Read::soon>(leaf); });
  }

  /// Answers `count` queries, the k-th of which make(k) makes, and calls done(k, query) for each, in any
  /// order. While the ray of one waits for memory, others go on.
  void answer_each(std::size_t count, const auto& make, const auto& done, const auto& triangle) const {
    constexpr Order order = order_for<decltype(make(std::size_t{0}))>;
    each_along_interleaved<order>(
        bvh_, count, make, done, [&](auto& query, std::uint32_t i) { return query.maybe(triangle(i), i); },
        [&](auto& query, const BoxRay& line, Leaf leaf, Reach& reach) {
          return show<order>(query, line, leaf, reach);
        },
        [&](Leaf leaf) { leaves_.fetch<Read::later>(leaf); });
  }

  /// Calls visit(leaf) for the leaves that a search wants (Traversal).
  void each_leaf(const auto& search, const auto& visit) const {
    const auto fetch_leaf = [&](Leaf leaf) { leaves_.fetch<Read::later>(leaf); };
    traverse(
        bvh_, search,
        [&](Leaf leaf) {
          visit(leaf);
          return false;
        },
        FetchChild<Read::later, decltype(fetch_leaf)>{bvh_, fetch_leaf});
  }

  [[nodiscard]] const Bvh& bvh() const { return bvh_; }
  [[nodiscard]] const TriangleLeaves& leaves() const { return leaves_; }

 private:
  template <class Query>
  static constexpr Order order_for = Query::near_first ? Order::near_first : Order::any;

  /// Tells a query about the triangles of a leaf; returns true if it asks for nothing more.
  template <Order order>
  [[gnu::always_inline]] bool show(auto& query, const BoxRay& line, Leaf leaf, Reach& reach) const {
    bool any = false;
    for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
      const auto [crossed, in_doubt, t] = leaves_.tried(leaf, i, query.ray, query.line, query.range);
      if ((crossed | in_doubt) == 0) continue;
      any = true;
      const auto place = [&](int k) { return leaves_.place(leaf, i + static_cast<std::uint32_t>(k)); };
      for (const int k : lanes_in(crossed))
        if (query.found(t[k], leaves_.number(place(k)))) return true;
      for (const int k : lanes_in(in_doubt))
        if (query.maybe(leaves_.triangle(place(k)), leaves_.number(place(k)))) return true;
    }
    if constexpr (order == Order::near_first)
      if (any) reach.until = line.at_most(query.range.max);
    return false;
  }

  /// Sizes of leaves: triangles that are tested at once take the time of one.
  static constexpr LeafSize leaf_size{.most = node_width, .enough = double_lanes < 2 ? 2 : double_lanes};

  Bvh bvh_;
  TriangleLeaves leaves_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

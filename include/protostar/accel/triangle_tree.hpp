// Triangles in a tree of boxes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh.hpp"
#include "in_turns.hpp"
#include "triangle_leaves.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A tree over triangles that others hold. What the functions take as `triangle` is what the constructor got.
///
/// A query asks what a ray crosses inside a range. It has the members
///
///   ray, range            it may shorten the range on the way, if
///   distance()            how far at most the ray starts from its origin, on each axis, as it may leave a
///                         triangle
///   error()               what the numbers of its line are off by
///   near_first            says that what is near comes mostly before what is far
///   found(t, i)           the i-th triangle is crossed at t
///   maybe(triangle, i)    it may be crossed: double does not tell
///
/// The last two return whether nothing more is asked for.
class TriangleTree {
 public:
  static constexpr std::size_t most = largest_tree;  ///< triangles

  /// Of `count` triangles; triangle(i) is one of them.
  TriangleTree(std::size_t count, const auto& triangle, const RenderOptions& options)
      : bvh_(
            count, [&](std::size_t i) { return triangle(i).bounds(); }, leaf_size, options),
        leaves_(bvh_, triangle, options) {}

  /// Tells a query what its ray crosses, until it is content.
  template <class Query>
  void answer(Query& query, const auto& triangle) const {
    constexpr Order order = order_for<Query>;
    each_along<order>(
        bvh_, BoxRay(query.ray, space(), widening(query, space())), query.range,
        [&](std::uint32_t i) { return query.maybe(triangle(i), i); },
        [&](const BoxRay& line, Leaf leaf, Reach& left) { return show<order>(query, line, leaf, left); },
        [&](Leaf leaf) { leaves_.fetch<Read::soon>(leaf); });
  }

  /// The same for `count` queries that make(k) makes; done(k, query) is called for each, in any order. While
  /// the ray of one waits for memory, others go on.
  void answer_each(std::size_t count, const auto& make, const auto& done, const auto& triangle) const {
    constexpr Order order = order_for<decltype(make(std::size_t{0}))>;
    each_along_in_turns<order>(
        bvh_, count, make, done, [&](auto& query, std::uint32_t i) { return query.maybe(triangle(i), i); },
        [&](auto& query, const BoxRay& line, Leaf leaf, Reach& left) {
          return show<order>(query, line, leaf, left);
        },
        [&](Leaf leaf) { leaves_.fetch<Read::later>(leaf); });
  }

  [[nodiscard]] const BoxSpace& space() const { return bvh_.space(); }

  /// Bvh::each_leaf_ahead.
  void each_leaf_ahead(std::span<const HalfSpace> half_spaces, const auto& look, const auto& is_hidden,
                       const auto& visit) const {
    std::vector<BoxHalfSpace> seen;
    for (const HalfSpace& half_space : half_spaces) seen.emplace_back(half_space, space());
    bvh_.each_leaf_ahead(seen, look, is_hidden, visit, [&](Leaf leaf) { leaves_.fetch<Read::later>(leaf); });
  }

  [[nodiscard]] const TriangleLeaves& leaves() const { return leaves_; }

  /// Which triangles stand in the leaves, one after another.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return bvh_.order(); }

  /// How many triangles stand in leaves.
  [[nodiscard]] std::size_t size() const { return bvh_.order().size(); }

  /// Whether all triangles do.
  [[nodiscard]] bool has_all() const { return bvh_.unbounded().empty(); }

 private:
  template <class Query>
  static constexpr Order order_for = Query::near_first ? Order::near_first : Order::any;

  /// Tells a query about the triangles of a leaf; returns whether it is content.
  template <Order order>
  [[gnu::always_inline]] bool show(auto& query, const BoxRay& line, Leaf leaf, Reach& left) const {
    bool any = false;
    for (std::uint32_t i = 0; i < leaf.count; i += double_lanes) {
      const auto [crossed, in_doubt, t] = leaves_.tried(leaf, i, query.ray, query.range, query.error());
      if ((crossed | in_doubt) == 0) continue;
      any = true;
      const auto place = [&](int k) { return leaves_.place(leaf, i + static_cast<std::uint32_t>(k)); };
      for (Bits some = crossed; some != 0; some &= some - 1) {
        const int k = std::countr_zero(some);
        if (query.found(t[k], leaves_.number(place(k)))) return true;
      }
      for (Bits some = in_doubt; some != 0; some &= some - 1) {
        const TriangleLeaves::Place one = place(std::countr_zero(some));
        if (query.maybe(leaves_.triangle(one), leaves_.number(one))) return true;
      }
    }
    if constexpr (order == Order::near_first)
      if (any) left.until = line.at_most(query.range.max);
    return false;
  }

  /// A leaf takes the same time for all triangles that are tried at once.
  static constexpr LeafSize leaf_size{.most = node_width, .enough = double_lanes < 2 ? 2 : double_lanes};

  Bvh bvh_;
  TriangleLeaves leaves_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

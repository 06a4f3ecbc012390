// Solids made of solids: unions, intersections and differences.
//
// Constructive solid geometry needs no surface of its own. Along a ray, each solid is a few intervals between
// the crossings that lead in and out. The crossings of all solids are sorted exactly; each toggles the inside
// of one solid, and the whole is crossed where its own inside changes with it.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../numeric/scale.hpp"
#include "../surface.hpp"
#include "../surface_concepts.hpp"
#include "any_surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A tree of operations on solids, as a value. Made by union_of, intersection_of and difference_of; any Solid
/// is a tree by itself.
///
/// The order of the crossings, exact for solids that can refine their roots, decides which parts of a line
/// are inside. Crossings at equal t are taken together: at points where solids touch or their faces coincide,
/// nothing is crossed unless the whole begins or ends there. So what has no thickness is not crossed, such
/// as the face that two boxes share, which is all of their intersection. Only a ray that lies in this face
/// crosses it: it is in both boxes, as their outline belongs to them.
class Csg {
 public:
  /// Union, intersection and difference; none stands for a solid by itself in descriptions of trees.
  enum class Operation : std::uint8_t { none, either, all, first_alone };

  /// Largest number of operations nested in each other.
  static constexpr int most_depth = 1000;

  /// Largest number of solids: each ray intersects all of them and sorts the crossings, which takes tens of
  /// milliseconds for as many as this.
  static constexpr std::size_t most_solids = std::size_t{1} << 16;

  /// A solid of the tree.
  struct Leaf {
    AnySurface solid;
    int node;                    ///< index among the nodes
    int first_primitive = 0;     ///< number of primitives of all leaves before it
    bool is_taken_away = false;  ///< true if subtracted an odd number of times
  };

  /// A leaf or an operation. Operands come before their operation, and the whole comes last. An operation is
  /// inside where the sum of the weights of its operands that are inside is at least `least`: 1 for a union,
  /// the number of operands for an intersection, and 1 for a difference, whose first operand alone has a
  /// weight above 0.
  struct Node {
    int parent = -1;
    int weight = 1;  ///< 1, or −1 if it is subtracted by its parent
    int least = 0;
  };

  /// Makes a tree of one solid. Throws std::invalid_argument if it is not closed, which its type alone may
  /// not tell.
  template <class S>
  requires(!std::same_as<S, Csg> && Solid<S>) Csg(S solid) : primitives_(protostar::primitive_count(solid)) {
    if (!protostar::is_solid(solid)) throw std::invalid_argument("Csg: an operand must be a closed solid");
    leaves_.push_back({.solid = std::move(solid), .node = 0});
    nodes_.push_back({});
    bounds_ = leaves_[0].solid.bounds();
  }

  /// Combines trees by an operation. Throws std::invalid_argument if there are no trees, if the operation is
  /// none, if the new tree is too deep, or if it has too many solids, or more primitives than an int counts.
  Csg(Operation operation, std::vector<Csg> operands) {
    if (operands.empty()) throw std::invalid_argument("Csg: an operation needs a solid");
    if (operation == Operation::none)
      throw std::invalid_argument("Csg: solids are combined by either, all or first_alone, and not by none");
    for (Csg& operand : operands) append(std::move(operand), operation);
    for (Node& node : nodes_)
      if (node.parent < 0) node.parent = static_cast<int>(nodes_.size());
    nodes_.push_back({.least = operation == Operation::all ? static_cast<int>(operands.size()) : 1});
    if (++depth_ > most_depth)
      throw std::invalid_argument("Csg: operations may be " + std::to_string(most_depth) +
                                  " deep inside each other, and these are " + std::to_string(depth_));
  }

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal out of the whole, which on a subtracted solid points into that solid.
  [[nodiscard]] Vec3 normal_at(const Point& point, int primitive) const {
    const Leaf& leaf = leaf_of(primitive);
    const Vec3 normal = leaf.solid.normal_at(point, inner_primitive(primitive));
    return leaf.is_taken_away ? -normal : normal;
  }
  [[nodiscard]] bool has_uv() const {
    return std::all_of(leaves_.begin(), leaves_.end(), [](const Leaf& leaf) { return leaf.solid.has_uv(); });
  }
  [[nodiscard]] Uv uv_at(const Point& point, int primitive) const {
    return leaf_of(primitive).solid.uv_at(point, inner_primitive(primitive));
  }
  [[nodiscard]] bool has_tangents() const {
    return std::all_of(leaves_.begin(), leaves_.end(),
                       [](const Leaf& leaf) { return leaf.solid.has_tangents(); });
  }
  [[nodiscard]] Tangents tangents_at(const Point& point, int primitive) const {
    return leaf_of(primitive).solid.tangents_at(point, inner_primitive(primitive));
  }
  [[nodiscard]] Departure departure(int primitive) const {
    return leaf_of(primitive).solid.departure(inner_primitive(primitive));
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    std::optional<Crossing> first;
    walk(ray, [&](const Crossing& crossing) {
      if (lies_inside(*this, ray, crossing, range)) first = crossing;
      return first.has_value();
    });
    return first;
  }
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    walk(ray, [&](const Crossing& crossing) {
      if (lies_inside(*this, ray, crossing, range)) visit(crossing);
      return false;
    });
  }
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return leaf_of(crossing.primitive).solid.exact_root(ray, inner(crossing));
  }

  [[nodiscard]] bool ends_inside(const Ray& ray) const {
    Insides insides(*this);
    for (int i = 0; i < count(); ++i)
      if (leaf(i).solid.ends_inside(ray)) insides.turn_over(i);
    return insides.whole();
  }
  [[nodiscard]] int primitive_count() const { return primitives_; }
  [[nodiscard]] Bounds bounds() const { return bounds_; }
  [[nodiscard]] const std::vector<Leaf>& leaves() const { return leaves_; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

  /// Throws std::invalid_argument if a solid is not valid.
  void validate() const {
    for (const Leaf& leaf : leaves_) leaf.solid.validate();
  }

 private:
  /// A crossing of a leaf.
  struct Hit {
    Crossing crossing;
    int leaf;
  };

  /// Inside or outside of every node, at a point of a line.
  class Insides {
   public:
    /// Starts outside of all leaves, and hence of all nodes.
    explicit Insides(const Csg& tree) : tree_(tree), at_(tree.nodes_.size()) {}

    [[nodiscard]] bool whole() const { return at_.back().is_inside; }

    /// Goes into or out of a leaf; returns true if that changes the whole. It stops at the first operation
    /// that does not change.
    bool turn_over(int leaf) {
      auto i = static_cast<std::size_t>(tree_.leaf(leaf).node);
      for (;;) {
        at_[i].is_inside = !at_[i].is_inside;
        const Node& node = tree_.nodes_[i];
        if (node.parent < 0) return true;
        const int weight = at_[i].is_inside ? node.weight : -node.weight;
        i = static_cast<std::size_t>(node.parent);
        at_[i].weights += weight;
        if ((at_[i].weights >= tree_.nodes_[i].least) == at_[i].is_inside) return false;
      }
    }

   private:
    struct At {
      bool is_inside = false;
      int weights = 0;  ///< sum of the weights of the operands that are inside
    };

    const Csg& tree_;
    std::vector<At> at_;
  };

  /// Crossings of a line with all leaves, and the facts that they do not tell.
  struct Hits {
    std::vector<Hit> all;
    std::vector<int> begun;     ///< leaves whose inside the line comes from
    std::vector<int> departed;  ///< leaves that the ray departs from
  };

  [[nodiscard]] int count() const { return static_cast<int>(leaves_.size()); }
  [[nodiscard]] const Leaf& leaf(int i) const { return leaves_[static_cast<std::size_t>(i)]; }

  /// Returns the leaf that has a primitive: the last one that begins at it or before.
  [[nodiscard]] const Leaf& leaf_of(int primitive) const {
    return std::upper_bound(leaves_.begin(), leaves_.end(), primitive,
                            [](int p, const Leaf& leaf) { return p < leaf.first_primitive; })[-1];
  }
  [[nodiscard]] int inner_primitive(int primitive) const {
    return primitive - leaf_of(primitive).first_primitive;
  }
  [[nodiscard]] Crossing inner(Crossing crossing) const {
    crossing.primitive = inner_primitive(crossing.primitive);
    return crossing;
  }

  void append(Csg&& other, Operation operation) {
    const int shift = static_cast<int>(nodes_.size());
    const bool is_first = leaves_.empty(), is_taken_away = operation == Operation::first_alone && !is_first;
    if (leaves_.size() + other.leaves_.size() > most_solids)
      throw std::invalid_argument("Csg: at most " + std::to_string(most_solids) + " solids are allowed");
    if (other.primitives_ > std::numeric_limits<int>::max() - primitives_)
      throw std::invalid_argument("Csg: the solids have more than 2^31 - 1 primitives");
    if (is_taken_away) other.nodes_.back().weight = -1;
    for (Leaf& leaf : other.leaves_) {
      leaf.node += shift;
      leaf.first_primitive += primitives_;
      leaf.is_taken_away = leaf.is_taken_away != is_taken_away;
      leaves_.push_back(std::move(leaf));
    }
    for (Node& node : other.nodes_) {
      if (node.parent >= 0) node.parent += shift;
      nodes_.push_back(node);
    }
    depth_ = std::max(depth_, other.depth_);
    primitives_ += other.primitives_;
    const auto [low, high] = other.bounds_;
    if (is_first) bounds_ = other.bounds_;
    if (operation == Operation::either) bounds_ = {min(bounds_.min, low), max(bounds_.max, high)};
    if (operation == Operation::all) {
      // Nothing is left of disjoint solids, and any box will do.
      bounds_.min = max(bounds_.min, low);
      bounds_.max = max(bounds_.min, min(bounds_.max, high));
    }
  }

  /// Returns the crossing as one of its leaf, with the type erased.
  [[nodiscard]] SurfaceCrossing on_leaf(const Hit& hit) const {
    return {.crossing = hit.crossing,
            .surface = &leaf(hit.leaf).solid,
            .functions = &functions_of<AnySurface>,
            .material = nullptr};
  }

  [[nodiscard]] Hits hits_along(const Ray& ray) const {
    Hits hits;
    const Ray back = ray.reversed();
    for (int i = 0; i < count(); ++i) {
      const AnySurface& solid = leaf(i).solid;
      const std::size_t before = hits.all.size();
      solid.each_crossing(ray, {-infinity, infinity}, [&](const Crossing& crossing) {
        hits.all.push_back({crossing, i});
      });
      const bool begins = solid.ends_inside(back), ends = solid.ends_inside(ray);
      if (begins) hits.begun.push_back(i);
      // Each crossing toggles the inside. If one is missing, it was at t = 0, and the ray departs from it.
      if ((hits.all.size() - before) % 2 != (begins != ends ? 1 : 0)) hits.departed.push_back(i);
    }
    std::stable_sort(hits.all.begin(), hits.all.end(),
                     [&](const Hit& a, const Hit& b) { return precedes(ray, on_leaf(a), on_leaf(b)); });
    return hits;
  }

  /// Calls visit(const Crossing&) for all crossings of the ray's line with the whole, near to far, until it
  /// returns true. A crossing at t = 0 is left out if the ray departs from a leaf.
  ///
  /// Along a very short direction t may be beyond the range of double, and a crossing that is missing for
  /// that would turn its leaf inside out. Hence a direction shorter than 2^-100 is multiplied by a power of
  /// two, without rounding, and is about 2^-100 long: if it were longer, t next to a surface might be below
  /// the range of double (docs/derivations.md, Solids made of solids).
  void walk(const Ray& ray, const auto& visit) const {
    const int lift = ray.transform == nullptr ? std::max(0, -99 - exponent_of({ray.direction})) : 0;
    if (lift == 0) return walk_along(ray, 0, visit);
    Ray lifted = ray;
    lifted.direction = scaled(ray.direction, lift);
    walk_along(lifted, lift, visit);
  }

  /// Does what walk does, for the ray whose direction is 2^-lift times that of this one.
  void walk_along(const Ray& ray, int lift, const auto& visit) const {
    const Hits hits = hits_along(ray);
    if (hits.all.empty()) return;
    Insides insides(*this);
    for (const int i : hits.begun) insides.turn_over(i);
    bool is_before_origin = true;
    for (auto hit = hits.all.begin(); hit != hits.all.end();) {
      const bool starts_here = is_before_origin && hit->crossing.t >= 0;
      const bool is_departure = starts_here && hit->crossing.t == 0 && !hits.departed.empty();
      if (starts_here) {
        for (const int i : hits.departed) insides.turn_over(i);
        is_before_origin = false;
      }
      const auto end = std::find_if(hit + 1, hits.all.end(), [&](const Hit& next) {
        return precedes(ray, on_leaf(*hit), on_leaf(next));
      });
      const bool was_inside = insides.whole();
      const Hit* turning = turn_over_together(insides, hit, end);
      if (insides.whole() != was_inside && !is_departure) {
        Crossing crossing = turning->crossing;
        if (lift > 0) crossing.t = scaled(crossing.t, lift);
        crossing.primitive += leaf(turning->leaf).first_primitive;
        if (visit(crossing)) return;
      }
      hit = end;
    }
  }

  /// Toggles each leaf that is crossed an odd number of times at one t; returns the last hit that changed the
  /// whole, or null.
  static const Hit* turn_over_together(Insides& insides, auto hit, auto end) {
    const Hit* turning = nullptr;
    while (hit != end) {
      const auto next = std::find_if(hit, end, [&](const Hit& other) { return other.leaf != hit->leaf; });
      if ((next - hit) % 2 != 0 && insides.turn_over(hit->leaf)) turning = &*hit;
      hit = next;
    }
    return turning;
  }

  std::vector<Leaf> leaves_;
  std::vector<Node> nodes_;
  Bounds bounds_;
  int depth_ = 0;
  int primitives_ = 0;
};

namespace detail {

/// An operand of an operation. It takes any type, so that the compiler can say what the type lacks to be a
/// Solid.
struct CsgOperand {
  Csg tree;

  template <class S>
  requires(std::convertible_to<S, Csg>) CsgOperand(S solid) : tree(std::move(solid)) {}

  template <class S>
  CsgOperand(S) : tree(NoSurface{}) {
    static_assert(SolidRequirements<S>::hold);
  }
};

/// Operands of an operation: solids of several types in braces, or a vector of trees.
struct CsgOperands {
  std::vector<Csg> trees;

  CsgOperands(std::vector<Csg> solids) : trees(std::move(solids)) {}
  CsgOperands(std::initializer_list<CsgOperand> solids) {
    for (const CsgOperand& solid : solids) trees.push_back(solid.tree);
  }
};

}  // namespace detail

/// Returns the union of solids: all points inside any of them.
[[nodiscard]] inline Csg union_of(detail::CsgOperands solids) {
  return {Csg::Operation::either, std::move(solids.trees)};
}

/// Returns the intersection of solids: all points inside every one of them.
[[nodiscard]] inline Csg intersection_of(detail::CsgOperands solids) {
  return {Csg::Operation::all, std::move(solids.trees)};
}

/// Returns the difference of solids: all points inside the first and none of the others.
[[nodiscard]] inline Csg difference_of(detail::CsgOperands solids) {
  return {Csg::Operation::first_alone, std::move(solids.trees)};
}

static_assert(CompositeSurface<Csg> && is_made_of_primitives<Csg> && SurfaceWithBounds<Csg> && Solid<Csg>);

}  // namespace protostar::inline PROTOSTAR_ABI

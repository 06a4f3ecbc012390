// Solids of a tree that a line is inside of, from one of its crossings to the next.
#pragma once

#include <cstddef>
#include <optional>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <vector>

#include "equations.hpp"
#include "stress/made_of.hpp"

namespace exact {

/// Crossings of all solids of a tree, in places of equal t from near to far: the number of crossings of each
/// solid in each place, and for each solid whether a ray ends inside.
struct SolidsAlong {
  std::vector<std::vector<int>> times;
  std::vector<bool> ends_inside;

  /// Returns true if a line is inside a tree behind a place; −1 is before all.
  [[nodiscard]] bool is_inside(const SolidTree& tree, int place) const {
    std::size_t next = 0;
    return is_inside(tree, place, next);
  }

 private:
  /// Returns true if a line is inside a tree behind a place. next is the number of the tree's first solid,
  /// and afterwards of the first solid behind the tree.
  [[nodiscard]] bool is_inside(const SolidTree& tree, int place, std::size_t& next) const {
    using Operation = protostar::Csg::Operation;
    if (tree.operation == Operation::none) return is_inside_solid(next++, place);
    int count = 0;
    bool is_in_first = false;
    for (std::size_t i = 0; i < tree.operands.size(); ++i) {
      const bool is_in = is_inside(tree.operands[i], place, next);
      count += is_in;
      if (i == 0) is_in_first = is_in;
    }
    if (tree.operation == Operation::either) return count > 0;
    if (tree.operation == Operation::all) return count == static_cast<int>(tree.operands.size());
    return is_in_first && count == 1;
  }
  [[nodiscard]] bool is_inside_solid(std::size_t solid, int place) const {
    int ahead = 0;
    for (std::size_t i = static_cast<std::size_t>(place + 1); i < times.size(); ++i) ahead += times[i][solid];
    return ends_inside[solid] != (ahead % 2 != 0);
  }
};

/// Returns true if a ray ends inside a solid, by the first sign of A, −b and c that is not 0; nothing if 128
/// digits do not decide. Bounded solids: false.
template <class T>
std::optional<bool> ends_inside(const Line<T>&, const auto&) {
  return false;
}
template <class T>
std::optional<bool> ends_inside(const Line<T>& line, const protostar::Quadric& quadric) {
  const QuadricEquation<T> e(line, quadric.form);
  for (const T& x : {e.A, -e.b, e.c}) {
    if constexpr (requires { x.is_known(); })
      if (!x.is_known()) return std::nullopt;
    if (x.sign() != 0) return x.sign() < 0;
  }
  return false;
}

}  // namespace exact

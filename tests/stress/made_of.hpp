// Surfaces that are made of others, and keep their components for the reference computations.
#pragma once

#include <protostar/numeric/affine.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <utility>
#include <variant>
#include <vector>

/// Instance of a surface that keeps the surface and its map.
template <class S>
struct Placed : protostar::Instance<S> {
  S own;
  protostar::Affine placement;

  explicit Placed(const S& surface = {}, const protostar::Affine& map = {})
      : protostar::Instance<S>(surface, map), own(surface), placement(map) {}
};

/// Solid, or an operation on several.
struct SolidTree {
  using Solid = std::variant<protostar::Sphere, protostar::Box, protostar::Quadric, Placed<protostar::Sphere>,
                             Placed<protostar::Box>>;

  Solid solid = {};
  protostar::Csg::Operation operation = protostar::Csg::Operation::none;  ///< none: the solid itself
  std::vector<SolidTree> operands = {};

  [[nodiscard]] protostar::Csg made() const {
    if (operation == protostar::Csg::Operation::none)
      return std::visit([](const auto& s) { return protostar::Csg(s); }, solid);
    std::vector<protostar::Csg> parts;
    for (const SolidTree& operand : operands) parts.push_back(operand.made());
    return {operation, std::move(parts)};
  }

  /// Calls visit(solid) for all solids, from the first operand on.
  void each_solid(const auto& visit) const {
    if (operation == protostar::Csg::Operation::none) visit(solid);
    for (const SolidTree& operand : operands) operand.each_solid(visit);
  }
};

/// Solid that is made by a tree, and keeps it.
struct Made : protostar::Csg {
  SolidTree tree;

  explicit Made(SolidTree t = {}) : protostar::Csg(t.made()), tree(std::move(t)) {}
};

// Surfaces that are made of others, with what they are made of at hand for a judge.
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

/// An instance of a surface.
template <class S>
struct Placed : protostar::Instance<S> {
  S own;
  protostar::Affine placement;

  explicit Placed(const S& surface = {}, const protostar::Affine& map = {})
      : protostar::Instance<S>(surface, map), own(surface), placement(map) {}
};

/// A solid, or an operation on some.
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

/// The solid that a tree makes.
struct Made : protostar::Csg {
  SolidTree tree;

  explicit Made(SolidTree t = {}) : protostar::Csg(t.made()), tree(std::move(t)) {}
};

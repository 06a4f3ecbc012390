// Corpora of rays and solids made of solids that are hard cases.
#pragma once

#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "boxes.hpp"
#include "corpus.hpp"
#include "draws.hpp"
#include "stress/made_of.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Box, protostar::Csg, protostar::Point, protostar::Quadric, protostar::QuadricForm,
    protostar::Ray, protostar::Sphere, protostar::Vec3;
using MadeCase = Case<Made>;

/// Returns an operation on count solids, or on one and another operation.
template <class NextSolid>
SolidTree tree_of(Random& random, const NextSolid& next, int count) {
  using Operation = Csg::Operation;
  static constexpr Operation operations[] = {Operation::either, Operation::all, Operation::first_alone};
  SolidTree tree{.operation = operations[whole(random, 0, 2)]};
  const auto add_one = [&] { tree.operands.push_back({.solid = next(random)}); };
  if (count == 2 || coin(random)) {
    for (int i = 0; i < count; ++i) add_one();
    return tree;
  }
  const bool is_first = coin(random);
  if (is_first) add_one();
  tree.operands.push_back(tree_of(random, next, count - 1));
  if (!is_first) add_one();
  return tree;
}

inline QuadricForm half_space(const Vec3& normal, double distance) {
  return {.squares = Vec3{0}, .linear = 0.5 * normal, .constant = -distance};
}

inline SolidTree::Solid any_solid(Random& random) {
  const Point center = random.point(1), other = random.point(1);
  const double radius = random.real(0.5, 1.5);
  switch (whole(random, 0, 7)) {
    case 0:
    case 1:
      return box_around(center, other);
    case 2:
      return Quadric{half_space(random.direction(), random.real(-1, 1))};
    default:
      return Sphere{center, radius};
  }
}

inline MadeCase solids(Random& random) {
  const int count = whole(random, 2, 4);
  SolidTree tree = tree_of(random, any_solid, count);
  const Point origin = random.point(4), target = random.point(1);
  return {{origin, size(random, -3, 3) * (target - origin)}, Made(std::move(tree))};
}

/// Returns a solid of small whole numbers, so that solids touch and have faces in common.
inline SolidTree::Solid whole_solid(Random& random) {
  const Point center = whole_vector(random, -2, 2), other = whole_vector(random, -2, 2);
  switch (whole(random, 0, 7)) {
    case 0:
    case 1:
    case 2:
      return Sphere{center, static_cast<double>(whole(random, 1, 3))};
    case 3:
      return Quadric{
          half_space(turned({2, 0, 2 * whole(random, 0, 1)}, whole(random, 0, 2)), 2 * whole(random, -2, 2))};
    default:
      return box_around(center, other);
  }
}

/// Returns a tree and a ray, which often leaves the plane of a box's face, from the face or from beside it.
inline MadeCase solids_whole(Random& random) {
  const int count = whole(random, 2, 4);
  SolidTree tree = tree_of(random, whole_solid, count);
  const Point origin = whole_vector(random, -4, 4), target = whole_vector(random, -2, 2);
  Ray ray{origin, target - origin};
  if (coin(random))
    tree.each_solid([&](const SolidTree::Solid& solid) {
      const Box* const box = std::get_if<Box>(&solid);
      if (!box || ray.departure.kind != protostar::Departure::Kind::none) return;
      const int face = whole(random, 0, 5);
      ray.origin[face / 2] = face % 2 == 0 ? box->min[face / 2] : box->max[face / 2];
      ray.departure = box->departure(face);
      ray.departure.object = nullptr;
    });
  return {ray, Made(std::move(tree))};
}

inline const std::vector<Corpus<Made>> of_trees{{"csg", solids}, {"csg whole", solids_whole}};

}  // namespace corpora

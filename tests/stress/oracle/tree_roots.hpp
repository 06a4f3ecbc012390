// Exact crossings of a ray with boxes, solids and trees of solids, one primitive of which it may leave.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <protostar/ray.hpp>
#include <protostar/surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <type_traits>
#include <variant>
#include <vector>

#include "box_faces.hpp"
#include "departures.hpp"
#include "equations.hpp"
#include "solids_along.hpp"
#include "stress/exact.hpp"
#include "stress/made_of.hpp"
#include "surface_roots.hpp"

namespace exact {

/// Primitive of the surface that a ray leaves, −1 if none.
struct Left {
  int primitive = -1;
};

/// Returns the crossings of a ray's line with a solid, of which the ray leaves a primitive, −1 for none; it
/// may leave another surface that coincides with it.
inline Roots roots(const protostar::Ray& ray, const protostar::Sphere& sphere, const Left& left) {
  return roots(Line<Number>(ray), sphere, left.primitive >= 0 || departs_from(ray.departure, sphere));
}
inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Sphere>& placed, const Left& left) {
  return roots(Line<Number>(Line<Number>(ray), placed.placement), placed.own,
               left.primitive >= 0 || departs_from(ray.departure, placed));
}
inline LeftOfBox left_of(const protostar::Ray& ray, const auto& box, const Left& left) {
  return left.primitive >= 0 ? LeftOfBox{left.primitive, true}
                             : LeftOfBox{face_left(ray.departure, box), false};
}
inline Roots roots(const protostar::Ray& ray, const protostar::Box& box, const Left& left) {
  return roots(Line<Number>(ray), box, left_of(ray, box, left));
}
inline Roots roots(const protostar::Ray& ray, const Placed<protostar::Box>& placed, const Left& left) {
  return roots(Line<Number>(Line<Number>(ray), placed.placement), placed.own, left_of(ray, placed, left));
}
/// Returns the crossings with a quadric of a tree, which no ray here leaves.
inline Roots roots(const protostar::Ray& ray, const protostar::Quadric& quadric, const Left&) {
  return roots(Line<Number>(ray), quadric, false);
}

inline int primitives_of(const protostar::Box&) { return 6; }
inline int primitives_of(const protostar::Sphere&) { return 1; }
inline int primitives_of(const protostar::Quadric&) { return 1; }
template <class S>
int primitives_of(const Placed<S>& placed) {
  return primitives_of(placed.own);
}

/// Returns true if a ray ends inside a solid.
inline bool ends_inside_of(const protostar::Ray&, const auto&) { return false; }
inline bool ends_inside_of(const protostar::Ray& ray, const protostar::Quadric& quadric) {
  return ends_inside<Number>(Line<Number>(ray), quadric).value();
}

/// Returns the crossings at which a ray enters or leaves a tree, whose solids each_solid(visit) visits. If
/// the number of a solid's crossings does not fit its two ends, the solid is left and lacks the crossing at
/// t = 0; then the tree is not crossed at t = 0.
inline Roots roots_of_tree(const protostar::Ray& ray, const SolidTree& tree, const Left& left,
                           const auto& each_solid) {
  struct OfSolid {
    Root root;
    std::size_t solid;
  };
  std::vector<OfSolid> all;
  SolidsAlong along;
  bool is_any_left = false;
  int first_primitive = 0;
  each_solid([&](const auto& solid) {
    const int inner = left.primitive - first_primitive;
    const bool is_own = left.primitive >= 0 && 0 <= inner && inner < primitives_of(solid);
    first_primitive += primitives_of(solid);
    const std::size_t number = along.ends_inside.size();
    Roots crossed = roots(ray, solid, Left{is_own ? inner : -1});
    const bool ends = ends_inside_of(ray, solid);
    const bool begins = ends_inside_of({ray.origin, -ray.direction}, solid);
    if ((crossed.size() % 2 != 0) != (begins != ends)) crossed.push_back(root_at(0)), is_any_left = true;
    for (const Root& root : crossed) all.push_back({root, number});
    along.ends_inside.push_back(ends);
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const OfSolid& a, const OfSolid& b) { return compare(a.root, b.root) < 0; });
  Roots places;
  for (const OfSolid& one : all) {
    if (places.empty() || compare(places.back(), one.root) != 0) {
      places.push_back(one.root);
      along.times.emplace_back(along.ends_inside.size());
    }
    ++along.times.back()[one.solid];
  }
  Roots crossings;
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    const Root& root = places[static_cast<std::size_t>(i)];
    if (is_any_left && compare(root, root_at(0)) == 0) continue;
    if (along.is_inside(tree, i - 1) != along.is_inside(tree, i)) crossings.push_back(root);
  }
  return crossings;
}
inline Roots roots(const protostar::Ray& ray, const Made& made, const Left& left) {
  return roots_of_tree(ray, made.tree, left, [&](const auto& visit) {
    made.tree.each_solid([&](const SolidTree::Solid& held) { std::visit(visit, held); });
  });
}
/// Solid of the image of a tree. It coincides with the primitive that a ray leaves also if both do before
/// they are mapped.
template <class S>
struct PlacedInTree : Placed<S> {
  protostar::Departure left_inside;
};
inline Roots roots(const protostar::Ray& ray, const PlacedInTree<protostar::Sphere>& solid,
                   const Left& left) {
  const bool leaves =
      left.primitive >= 0 || departs_from(ray.departure, solid) || departs_from(solid.left_inside, solid.own);
  return roots(Line<Number>(Line<Number>(ray), solid.placement), solid.own, leaves);
}
inline Roots roots(const protostar::Ray& ray, const PlacedInTree<protostar::Box>& solid, const Left& left) {
  LeftOfBox face = left_of(ray, static_cast<const Placed<protostar::Box>&>(solid), left);
  if (face.face < 0) face.face = face_left(solid.left_inside, solid.own);
  return roots(Line<Number>(Line<Number>(ray), solid.placement), solid.own, face);
}

/// Returns the crossings of the image of a tree, which is a tree of images.
inline Roots roots(const protostar::Ray& ray, const Placed<Made>& placed, const Left& left) {
  const auto each_image = [&](const auto& visit) {
    placed.own.tree.each_solid([&](const SolidTree::Solid& held) {
      std::visit(
          [&](const auto& solid) {
            using S = std::remove_cvref_t<decltype(solid)>;
            if constexpr (std::same_as<S, protostar::Sphere> || std::same_as<S, protostar::Box>)
              visit(PlacedInTree<S>{Placed<S>(solid, placed.placement), {}});
            else
              throw std::logic_error("exact: no images of such a solid are judged");
          },
          held);
    });
  };
  // Departure from the primitive that the ray leaves, before it is mapped.
  protostar::Departure left_inside;
  int first_primitive = 0;
  each_image([&](const auto& image) {
    const int inner = left.primitive - first_primitive;
    if (left.primitive >= 0 && 0 <= inner && inner < primitives_of(image.own))
      left_inside = protostar::departure_of(image.own, inner);
    first_primitive += primitives_of(image.own);
  });
  return roots_of_tree(ray, placed.own.tree, left, [&](const auto& visit) {
    each_image([&](auto image) {
      image.left_inside = left_inside;
      visit(image);
    });
  });
}

/// Returns the primitive of a tree that has the departure of a ray, −1 if none.
inline int own_primitive(const Made& made, const protostar::Departure& left) {
  for (int primitive = 0; primitive < made.primitive_count(); ++primitive) {
    const protostar::Departure of_primitive = made.departure(primitive);
    if (of_primitive == left && of_primitive.object == left.object &&
        of_primitive.primitive == left.primitive)
      return primitive;
  }
  return -1;
}

/// Returns the crossings of a ray whose departure names the box, or the tree's primitive, that it leaves, or
/// only a plane.
inline Roots roots(const protostar::Ray& ray, const protostar::Box& box, bool) {
  return roots(ray, box, Left{ray.departure.object != nullptr ? ray.departure.primitive : -1});
}
inline Roots roots(const protostar::Ray& ray, const Made& made, bool) {
  return roots(ray, made, Left{own_primitive(made, ray.departure)});
}

}  // namespace exact

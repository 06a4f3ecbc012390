// Three solids made of solids, over a floor: a rounded cube with holes, a bowl and a lens.
#pragma once

#include <protostar/scene.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>

/// A cylinder of infinite length around an axis: x² + y² + z² less the square along the axis, less r².
inline protostar::Quadric cylinder(const protostar::Vec3& axis, double radius) {
  return {{.squares = protostar::Vec3{1} - axis, .constant = -radius * radius}};
}

inline protostar::Csg rounded_cube_with_holes() {
  using namespace protostar;
  return difference_of({intersection_of({Box{}, Sphere{.radius = 1.375}}), cylinder({1, 0, 0}, 0.625),
                        cylinder({0, 1, 0}, 0.625), cylinder({0, 0, 1}, 0.625)});
}

inline protostar::Csg bowl() {
  using namespace protostar;
  return difference_of({Sphere{}, Sphere{.radius = 0.875}, Box{{-1, 0.25, -1}, {1, 1, 1}}});
}

inline protostar::Csg lens() {
  using namespace protostar;
  return intersection_of(
      {Sphere{.center = {0, 0, -1}, .radius = 1.375}, Sphere{.center = {0, 0, 1}, .radius = 1.375}});
}

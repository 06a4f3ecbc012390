// Three solids made of boxes, spheres and quadrics.
#include "carved_solids.hpp"

#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>

protostar::Csg rounded_cube_with_holes() {
  using namespace protostar;
  const double square = 0.625 * 0.625;  // of the cylinders' radius: y² + z² − r² = 0, and so on
  return difference_of({intersection_of({Box{}, Sphere{.radius = 1.375}}),
                        Quadric{{.squares = {0, 1, 1}, .constant = -square}},
                        Quadric{{.squares = {1, 0, 1}, .constant = -square}},
                        Box{{-0.5, -0.5, -1}, {0.5, 0.5, 1}}});
}

protostar::Csg bowl() {
  using namespace protostar;
  return difference_of({Sphere{}, Sphere{.radius = 0.875}, Box{{-1, 0.25, -1}, {1, 1, 1}}});
}

protostar::Csg lens() {
  using namespace protostar;
  return intersection_of(
      {Sphere{.center = {0, 0, -1}, .radius = 1.375}, Sphere{.center = {0, 0, 1}, .radius = 1.375}});
}

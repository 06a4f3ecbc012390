// A scene type for surfaces of any kind, and the three spheres as such a scene.
#pragma once

#include <protostar/any_scene.hpp>

#include "scenes/three_spheres.hpp"

/// Scene type of nearly all tests of tiles, since every integrator is compiled anew for each type.
using Everything = protostar::AnyScene;

inline Everything three_spheres_and_nothing_else() {
  Everything scene;
  for (const auto& [sphere, color] : the_three_spheres) scene.add(sphere, color);
  scene.add(light_of_the_three_spheres);
  return scene;
}

#include "marched_spheres.hpp"

#include <protostar/surfaces/distance_field.hpp>

protostar::AnyScene marched_spheres() {
  protostar::AnyScene scene;
  for (const auto& [sphere, color] : the_three_spheres) {
    const protostar::Vec3 half(sphere.radius);
    scene.add(protostar::Marched{DistanceFromSphere{sphere},
                                 protostar::Bounds{sphere.center - half, sphere.center + half}},
              color);
  }
  scene.add(light_of_the_three_spheres);
  return scene;
}

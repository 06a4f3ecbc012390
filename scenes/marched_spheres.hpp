// The tutorial's scene of three spheres (three_spheres.hpp), as fields that are marched.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/surfaces/distance_field.hpp>

#include "three_spheres.hpp"

/// Distance from a sphere: |p − center| − radius.
struct DistanceFromSphere {
  protostar::Sphere sphere;

  auto operator()(const auto& p) const { return length(p - sphere.center) - sphere.radius; }
};

inline protostar::AnyScene marched_spheres() {
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

// The tutorial's scene of three spheres (three_spheres.hpp), as fields that are marched.
#pragma once

#include <protostar/any_scene.hpp>

#include "three_spheres.hpp"

/// Distance from a sphere: |p − center| − radius.
struct DistanceFromSphere {
  protostar::Sphere sphere;

  auto operator()(const auto& p) const { return length(p - sphere.center) - sphere.radius; }
};

protostar::AnyScene marched_spheres();

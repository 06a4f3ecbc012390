// Lists of spheres that a tile may see.
#pragma once

#include <cstddef>
#include <protostar/accel/candidates.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

inline protostar::simd::Candidates candidates_of(const std::vector<protostar::Sphere>& spheres,
                                                 const protostar::simd::Viewpoint& viewpoint) {
  protostar::simd::Candidates candidates;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    candidates.add(static_cast<int>(i), viewpoint, protostar::simd::sphere_around(spheres[i]));
  return candidates;
}

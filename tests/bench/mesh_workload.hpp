// Meshes of many triangles, and a camera that looks at them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/camera.hpp>
#include <protostar/surfaces/mesh.hpp>

#include "support/meshes.hpp"

namespace bench {

/// Returns a mesh with its vertices rounded to float.
inline protostar::MeshData in_floats(protostar::MeshData mesh) {
  for (protostar::Point& p : mesh.vertices) p = protostar::Point(glm::vec3(p));
  return mesh;
}

/// Returns a torus of about count triangles, with vertices that are floats, as scenes/make_mesh writes it. It
/// lies in the cube of ±1.5.
inline protostar::MeshData torus(std::size_t count) {
  const auto across = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count) / 10));
  return in_floats(meshes::torus(5 * across, across));
}

inline protostar::Camera camera_of_torus() {
  return protostar::Camera::perspective({0, -2, 1.5}, {0, 0.8, -0.6}, {0, 0.6, 0.8}, 60);
}

}  // namespace bench

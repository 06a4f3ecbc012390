// Closed meshes, for whose triangles a, b, c the vector (b − a) × (c − a) points outwards.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <protostar/surfaces/mesh.hpp>
#include <utility>

namespace meshes {

using protostar::MeshData, protostar::Point, protostar::Vec3;

/// Returns a cube from −n to n, its faces cut into 2n × 2n squares of whole numbers, and these into two
/// triangles.
inline MeshData box(int n) {
  MeshData mesh;
  std::map<std::array<int, 3>, std::uint32_t> places;
  const auto vertex = [&](std::array<int, 3> p) {
    const auto [place, is_new] = places.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(Point{p[0], p[1], p[2]});
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1})
      for (int y = -n; y < n; ++y)
        for (int x = -n; x < n; ++x) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> p{};
            const auto at = [&](int i) -> int& { return p[static_cast<std::size_t>((axis + i) % 3)]; };
            at(0) = side * n, at(1) = x + u, at(2) = y + v;
            return vertex(p);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side > 0)
            mesh.triangles.push_back({a, b, c}), mesh.triangles.push_back({a, c, d});
          else
            mesh.triangles.push_back({a, c, b}), mesh.triangles.push_back({a, d, c});
        }
  return mesh;
}

/// Returns the unit sphere: an icosahedron, each of whose triangles is cut into four that many times.
inline MeshData icosphere(int times) {
  const double g = std::numbers::phi;
  MeshData mesh;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-g, g})
      for (const Vec3& p : {Vec3{0, x, y}, Vec3{x, y, 0}, Vec3{y, 0, x}})
        mesh.vertices.push_back(normalize(p));
  // The edge length of an icosahedron of radius 1, and a little more: edges of 2 belong to radius √(2 + φ).
  const double edge = 2 / std::sqrt(2 + g) * 1.001;
  const auto is_edge = [&](std::uint32_t a, std::uint32_t b) {
    return length(mesh.vertices[a] - mesh.vertices[b]) < edge;
  };
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c)
        if (is_edge(a, b) && is_edge(b, c) && is_edge(c, a)) {
          const auto& v = mesh.vertices;
          if (dot(v[a], cross(v[b], v[c])) > 0)
            mesh.triangles.push_back({a, b, c});
          else
            mesh.triangles.push_back({a, c, b});
        }
  for (; times > 0; --times) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(normalize(mesh.vertices[a] + mesh.vertices[b]));
      return place->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(part);
    }
    mesh.triangles = finer;
  }
  return mesh;
}

/// Returns a torus around the z axis, of radius 1 and thickness 0.8, cut into n × m pairs of triangles.
inline MeshData torus(std::uint32_t n, std::uint32_t m) {
  MeshData mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < m; ++k) {
      const double along = 2 * std::numbers::pi * i / n, across = 2 * std::numbers::pi * k / m;
      const double r = 1 + 0.4 * std::cos(across);
      mesh.vertices.push_back({r * std::cos(along), r * std::sin(along), 0.4 * std::sin(across)});
      const auto at = [&](std::uint32_t x, std::uint32_t y) { return x % n * m + y % m; };
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return mesh;
}

/// Returns a mesh scaled and moved.
inline MeshData moved(MeshData mesh, double scale, const Vec3& offset) {
  for (Point& p : mesh.vertices) p = scale * p + offset;
  return mesh;
}

}  // namespace meshes

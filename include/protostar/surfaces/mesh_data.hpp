// Vertices and triangles of a mesh, with the checks that make them one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "../bvh/node.hpp"
#include "../magnitude.hpp"
#include "../vec3.hpp"
#include "triangle.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Vertices and triangles of a mesh.
struct MeshData {
  std::vector<Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< by the indices of their vertices

  /// Normals of the vertices, of any length; if empty, each triangle has its own.
  std::vector<Vec3> normals = {};
  /// Texture coordinates of the vertices; if empty, each triangle has its barycentric coordinates.
  std::vector<Uv> uvs = {};

  [[nodiscard]] Triangle triangle(std::size_t i) const {
    const auto& [a, b, c] = triangles[i];
    return {vertices[a], vertices[b], vertices[c]};
  }

  /// Returns a function that returns triangle(i).
  [[nodiscard]] auto triangle_of() const {
    return [this](std::size_t i) { return triangle(i); };
  }

  /// Returns true if the triangles bound a solid: each edge occurs as often in one direction as in the other.
  /// Vertices at one position count as one.
  [[nodiscard]] bool is_closed() const {
    const std::vector<std::uint32_t> number = numbers_of_places();
    using Edge = std::array<std::uint32_t, 2>;
    std::vector<Edge> up, down;  // from the lower index to the higher, and back
    for (const auto& triangle : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = number[triangle[i]], to = number[triangle[(i + 1) % 3]];
        if (from < to) up.push_back({from, to});
        if (to < from) down.push_back({to, from});
      }
    std::sort(up.begin(), up.end());
    std::sort(down.begin(), down.end());
    return up == down;
  }

  /// Throws std::invalid_argument if there is no triangle or too many, if a triangle has a vertex index out
  /// of range, if a vertex or a uv is not made of coordinates (magnitude.hpp), if a normal is not finite, or
  /// if there are normals or uvs, but not as many as vertices. Triangles without area are allowed; no ray
  /// hits them.
  void validate() const {
    const auto check = [](bool holds, const auto& rule) {
      if (!holds) throw std::invalid_argument("Mesh: " + std::string(rule));
    };
    check(!triangles.empty(), "there is no triangle");
    check(triangles.size() <= simd::largest_tree, "there are more than 2^27 triangles");
    const auto check_each = [&](const auto& all, const auto& holds, const std::string& name,
                                const std::string& rule) {
      for (std::size_t i = 0; i < all.size(); ++i)
        if (!holds(all[i])) check(false, name + " " + std::to_string(i) + " must " + rule);
    };
    const auto is_place = [](const auto& place) { return is_coordinate(place); };
    check_each(vertices, is_place, "vertex", std::string("have numbers ").append(coordinate_rule));
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (const std::uint32_t vertex : triangles[i])
        if (vertex >= vertices.size())
          check(false, "triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) +
                           ", and there are " + std::to_string(vertices.size()));
    const auto check_count = [&](const auto& all, const std::string& name) {
      if (!all.empty() && all.size() != vertices.size())
        check(false, "there must be as many " + name + "s as vertices, or none; there are " +
                         std::to_string(all.size()) + " and " + std::to_string(vertices.size()));
    };
    check_count(normals, "normal");
    check_each(
        normals, [](const Vec3& n) { return is_finite(n); }, "normal", "be finite");
    check_count(uvs, "uv");
    check_each(uvs, is_place, "uv", std::string("have numbers ").append(coordinate_rule));
  }

 private:
  /// Returns an index for each vertex, equal for vertices at one position.
  [[nodiscard]] std::vector<std::uint32_t> numbers_of_places() const {
    const auto place = [&](std::uint32_t i) {
      return std::array{vertices[i].x, vertices[i].y, vertices[i].z};
    };
    std::vector<std::uint32_t> in_order(vertices.size()), numbers(vertices.size());
    std::iota(in_order.begin(), in_order.end(), 0u);
    std::sort(in_order.begin(), in_order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    for (std::size_t i = 0; i < in_order.size(); ++i) {
      const bool is_new = i == 0 || place(in_order[i - 1]) != place(in_order[i]);
      numbers[in_order[i]] = is_new ? in_order[i] : numbers[in_order[i - 1]];
    }
    return numbers;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

// Many triangles as one light: a triangle is chosen by chance, then a direction to it by solid angle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "shares.hpp"
#include "triangle_view.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Corners of a triangle, in either order.
using TriangleCorners = std::array<Point, 3>;

/// Direction to a triangle of a mesh. light.density is the probability of the triangle's choice times the
/// density of the direction within the triangle. Triangles do not hide each other: a direction that meets
/// several may be drawn for each of them, each time with the density for that triangle.
struct MeshSample {
  LightSample light;
  std::size_t triangle = 0;  ///< index of the triangle that was chosen
};

/// The triangles of a light, chosen by their areas: for meshes of any size, since a choice takes the
/// logarithm of their number. Takes any triangles; those without area are never chosen.
class MeshLight {
 public:
  explicit MeshLight(std::vector<TriangleCorners> triangles)
      : triangles_(std::move(triangles)), by_area_(triangles_.size()) {
    int exponent = -2000;  // the areas are scaled alike
    for (const auto& [a, b, c] : triangles_) exponent = std::max(exponent, exponent_of({b - a, c - a}));
    for (const auto& [a, b, c] : triangles_)
      by_area_.add(length(cross(scaled(b - a, -exponent), scaled(c - a, -exponent))));
  }

  /// Returns the triangles in the order in which they were given.
  [[nodiscard]] std::span<const TriangleCorners> triangles() const { return triangles_; }

  /// Draws a direction from a point with two numbers from [0, 1); of infinite density if no triangle has an
  /// area. Near the mesh a triangle may fill more of the view than its share of the area: estimates vary more
  /// there, and are right.
  [[nodiscard]] MeshSample sample(const Point& from, double u, double v) const {
    if (!(by_area_.whole() > 0)) return {};
    const auto [i, probability, rest] = by_area_.choose(u);
    MeshSample sample{
        TriangleView(from, triangles_[i][0], triangles_[i][1], triangles_[i][2]).sample(rest, v), i};
    sample.light.density *= probability;
    return sample;
  }

  /// Returns the density, in 1/steradian, with which sample draws a direction from the point to triangle i.
  [[nodiscard]] double density(const Point& from, std::size_t i) const {
    return by_area_.probability(i) /
           TriangleView(from, triangles_[i][0], triangles_[i][1], triangles_[i][2]).solid_angle();
  }

 private:
  std::vector<TriangleCorners> triangles_;
  Shares by_area_;
};

/// Some triangles as seen from a point, chosen by their solid angles: for small meshes, since a view of each
/// triangle is made. The density of a direction is one over the sum of the solid angles.
class MeshView {
 public:
  MeshView(const Point& from, std::span<const TriangleCorners> triangles) : by_angle_(triangles.size()) {
    views_.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
      views_.emplace_back(from, a, b, c);
      by_angle_.add(views_.back().solid_angle());
    }
  }

  /// Returns the sum of the solid angles of the triangles, also of those that others hide.
  [[nodiscard]] double solid_angle() const { return by_angle_.whole(); }

  /// Draws a direction.
  [[nodiscard]] MeshSample sample(double u, double v) const {
    if (!(solid_angle() > 0)) return {};
    const auto [i, probability, rest] = by_angle_.choose(u);
    MeshSample sample{views_[i].sample(rest, v), i};
    sample.light.density = 1 / solid_angle();
    return sample;
  }

 private:
  std::vector<TriangleView> views_;
  Shares by_angle_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

// Reference for the picture of stage 17, from the formulas, in long double and sharing nothing with the
// library.
//
// The file is read as scenes/make_mesh writes it. Visible triangles and shadows are decided by numbers that
// are off by less than 1e-15, and not exactly: hence a pixel at an edge, or at the edge of a shadow, might
// differ.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "../compare_images/picture.hpp"
#include "geometry.hpp"
#include "pictures.hpp"

namespace reference {

/// Scene of a knot above a floor, y = −1.75, in the light of one lamp and a little ambient light.
class Knot {
 public:
  explicit Knot(const std::string& path) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string kind;
      words >> kind;
      double x = 0, y = 0, z = 0;
      if (kind == "v" || kind == "vn") words >> x >> y >> z;
      // Vertices are doubles in the library, hence these doubles here.
      if (kind == "v") places_.push_back({0.5 * x, 0.5 * y + 0.25, 0.5 * z + 2.75});
      if (kind == "vn") normals_.push_back({x, y, z});
      if (kind != "f") continue;
      std::vector<std::size_t> corners;  // n//n, from 1
      for (std::string corner; words >> corner;) corners.push_back(std::stoul(corner) - 1);
      for (std::size_t i = 2; i < corners.size(); ++i)
        triangles_.push_back({corners[0], corners[i - 1], corners[i]});
    }
    // Encloses each few triangles, which are neighbors in the file, in a sphere.
    for (std::size_t first = 0; first < triangles_.size(); first += few) {
      Group group{places_.at(triangles_[first][0]), 0};
      for (std::size_t i = first; i < std::min(first + few, triangles_.size()); ++i)
        for (const std::size_t corner : triangles_[i])
          group.radius = std::max(group.radius, length(places_[corner] - group.center));
      groups_.push_back(group);
    }
  }

  [[nodiscard]] Picture picture(int width, int height) const {
    // Each triangle is intersected with the rays of the pixels around its projection.
    std::vector<Met> met(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const auto pixel = [&](Real along, int size, int sign) {
        return (static_cast<Real>(height) * along * sign + static_cast<Real>(size) - 1) / 2;
      };
      std::array<Real, 3> x{}, y{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector p = places_[triangles_[i][k]];
        x[k] = pixel(p.x / p.z, width, 1), y[k] = pixel(p.y / p.z, height, -1);
      }
      const auto [left, right] = std::minmax_element(x.begin(), x.end());
      const auto [top, bottom] = std::minmax_element(y.begin(), y.end());
      for (int row = static_cast<int>(*top) - 1; row <= static_cast<int>(*bottom) + 1; ++row)
        for (int column = static_cast<int>(*left) - 1; column <= static_cast<int>(*right) + 1; ++column) {
          if (row < 0 || row >= height || column < 0 || column >= width) continue;
          Met& first = met[static_cast<std::size_t>(row * width + column)];
          const Met here = crossing(i, {}, through_pixel(column, row, width, height).real());
          if (here.t > 0 && here.t < first.t) first = here;
        }
    }
    Picture result{width, height, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Met& first = met[static_cast<std::size_t>(y * width + x)];
        const Vector seen = light_along(through_pixel(x, y, width, height).real(), first);
        result.pixels.push_back({encode(seen.x, 2.2L), encode(seen.y, 2.2L), encode(seen.z, 2.2L)});
      }
    return result;
  }

 private:
  static constexpr std::size_t few = 32, nothing = std::numeric_limits<std::size_t>::max();

  /// Hit of a triangle at a (1 − u − v) + b u + c v.
  struct Met {
    std::size_t triangle = nothing;
    Real t = std::numeric_limits<Real>::infinity(), u = 0, v = 0;
  };

  struct Group {
    Vector center;
    Real radius;
  };

  /// Returns the crossing of a line with a triangle by Cramer's rule, from o + t d = a + u (b − a) + v
  /// (c − a).
  [[nodiscard]] Met crossing(std::size_t i, Vector o, Vector d) const {
    const auto& [a, b, c] = triangles_[i];
    const Vector e = places_[b] - places_[a], f = places_[c] - places_[a], s = o - places_[a];
    const Vector p = cross(d, f), q = cross(s, e);
    const Real determinant = dot(e, p);
    const Real u = dot(s, p) / determinant, v = dot(d, q) / determinant;
    if (determinant == 0 || u < 0 || v < 0 || u + v > 1) return {};
    return {i, dot(f, q) / determinant, u, v};
  }

  /// Returns true if a triangle, other than the one that is left, is between two points.
  [[nodiscard]] bool is_hidden(Vector from, Vector to, std::size_t left) const {
    const Vector d = to - from;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const Vector l = groups_[g].center - from;
      const Vector off = l - std::clamp<Real>(dot(l, d) / dot(d, d), 0, 1) * d;
      if (length(off) > groups_[g].radius * 1.001L) continue;
      for (std::size_t i = few * g; i < std::min(few * (g + 1), triangles_.size()); ++i) {
        if (i == left) continue;
        if (const Real t = crossing(i, from, d).t; t > 0 && t < 1) return true;
      }
    }
    return false;
  }

  [[nodiscard]] Vector light_along(Vector d, const Met& met) const {
    const bool on_knot = met.triangle != nothing;
    const Real floor = -1.75L / d.y, t = floor > 0 && floor < met.t ? floor : met.t;
    if (!(t < std::numeric_limits<Real>::infinity())) return {0.05f, 0.1f, 0.2f};
    const Vector p = t * d;
    Vector n{0, 1, 0}, color{0.3f, 0.35f, 0.4f};
    if (on_knot && t == met.t) {
      const auto& [a, b, c] = triangles_[met.triangle];
      n = (1 - met.u - met.v) * normals_[a] + met.u * normals_[b] + met.v * normals_[c];
      n = 1 / length(n) * n;
      if (dot(n, d) > 0) n = Real{-1} * n;
      color = {0.9f, 0.5f, 0.1f};
    }
    const Vector lamp{-1.2L, 0.5L, -1.5L}, way = lamp - p;
    const Real cosine = dot(n, way) / length(way);
    Real irradiance = 0.08f;
    if (cosine > 0 && !is_hidden(p, lamp, t == met.t ? met.triangle : nothing))
      irradiance += cosine / dot(way, way) * 250 / (4 * pi);
    return irradiance * color;
  }

  std::vector<Vector> places_, normals_;
  std::vector<std::array<std::size_t, 3>> triangles_;
  std::vector<Group> groups_;
};

}  // namespace reference

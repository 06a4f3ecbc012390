// A parallelogram as seen from a point: a rectangle, or two triangles.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "rectangle_view.hpp"
#include "triangle_view.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Parallelogram, prepared once for its views from all points. It is treated as a rectangle if the cosine of
/// the angle between its edges is at most 2^-50: the edges of a rectangle that was turned have components
/// with errors of u, which is up to 4u in the cosine, and twice that for edges that are differences.
struct ParallelogramLight {
  Point position;
  Vec3 edge_u, edge_v;
  std::optional<RectangleLight> rectangle;  ///< empty if it is treated as two triangles

  ParallelogramLight(const Point& corner, const Vec3& along, const Vec3& up)
      : position(corner), edge_u(along), edge_v(up) {
    const Vec3 u = of_moderate_size(along), v = of_moderate_size(up);
    if (std::abs(dot(u, v)) <= 0x1p-50 * length(u) * length(v)) rectangle.emplace(corner, along, up);
  }
};

/// Directions from a point to a parallelogram. If it is no rectangle, one of its two triangles is chosen with
/// a probability in proportion to its solid angle, so that directions are uniform in solid angle all the
/// same.
class ParallelogramView {
 public:
  ParallelogramView(const Point& from, const Point& position, const Vec3& edge_u, const Vec3& edge_v)
      : ParallelogramView(from, ParallelogramLight(position, edge_u, edge_v)) {}
  ParallelogramView(const Point& from, const ParallelogramLight& p) : parts_(parts(from, p)) {}

  /// Returns the solid angle in steradians; 0 for a point in the plane.
  [[nodiscard]] double solid_angle() const {
    if (const auto* rectangle = std::get_if<RectangleView>(&parts_)) return rectangle->solid_angle();
    const auto& [first, second] = std::get<Triangles>(parts_);
    return first.solid_angle() + second.solid_angle();
  }

  /// Draws a direction with two numbers from [0, 1).
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (const auto* rectangle = std::get_if<RectangleView>(&parts_)) return rectangle->sample(u, v);
    const auto& [first, second] = std::get<Triangles>(parts_);
    const double whole = solid_angle();
    if (!(whole > 0)) return {};
    // u chooses a triangle, and its place within that triangle's share is a number from [0, 1) again.
    const double place = u * whole, share = first.solid_angle();
    LightSample sample = place < share ? first.sample(place / share, v)
                                       : second.sample((place - share) / second.solid_angle(), v);
    sample.density = 1 / whole;
    return sample;
  }

 private:
  using Triangles = std::pair<TriangleView, TriangleView>;
  using Parts = std::variant<RectangleView, Triangles>;

  static Parts parts(const Point& from, const ParallelogramLight& light) {
    if (light.rectangle) return Parts(std::in_place_type<RectangleView>, from, *light.rectangle);
    const Point p = light.position + light.edge_u, q = light.position + light.edge_v;
    return Triangles{TriangleView(from, light.position, p, q), TriangleView(from, p + light.edge_v, q, p)};
  }

  Parts parts_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

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

/// A parallelogram, with what its views have in common. It is treated as a rectangle if the cosine of the
/// angle between its edges is at most 2^-50: the edges of a rectangle that was turned have components with
/// errors of u, which is up to 4u in the cosine, and twice that for edges that are differences.
struct ParallelogramLight {
  Point position;
  Vec3 edge_u, edge_v;
  std::optional<RectangleLight> rectangle;

  ParallelogramLight(const Point& corner, const Vec3& along, const Vec3& up)
      : position(corner), edge_u(along), edge_v(up) {
    const Vec3 u = of_moderate_size(along), v = of_moderate_size(up);
    if (std::abs(dot(u, v)) <= 0x1p-50 * length(u) * length(v)) rectangle.emplace(corner, along, up);
  }
};

/// The directions from a point to a parallelogram. One that is no rectangle is two triangles, chosen by their
/// solid angles, which is uniform too.
class ParallelogramView {
 public:
  ParallelogramView(const Point& from, const Point& position, const Vec3& edge_u, const Vec3& edge_v)
      : ParallelogramView(from, ParallelogramLight(position, edge_u, edge_v)) {}
  ParallelogramView(const Point& from, const ParallelogramLight& p) : parts_(parts(from, p)) {}

  [[nodiscard]] double solid_angle() const {
    if (const auto* rectangle = std::get_if<RectangleView>(&parts_)) return rectangle->solid_angle();
    const auto& [first, second] = std::get<Triangles>(parts_);
    return first.solid_angle() + second.solid_angle();
  }

  /// Draws a direction.
  [[nodiscard]] LightSample sample(double u, double v) const {
    if (const auto* rectangle = std::get_if<RectangleView>(&parts_)) return rectangle->sample(u, v);
    const auto& [first, second] = std::get<Triangles>(parts_);
    const double whole = solid_angle();
    if (!(whole > 0)) return {};
    // The half square left of the share of the first triangle is stretched over all of it.
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

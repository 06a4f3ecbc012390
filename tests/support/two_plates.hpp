// A user-defined surface with primitives: two plates, each a disk.
#pragma once

#include <array>
#include <optional>
#include <protostar/surface.hpp>

/// The points with z = 0 (primitive 0) or z = height (primitive 1) inside the cylinder of radius 1 around the
/// z axis.
struct TwoPlates {
  double height = 1;

  std::optional<protostar::Crossing> first_crossing(const protostar::Ray& ray,
                                                    protostar::Interval range) const {
    std::optional<protostar::Crossing> first;
    each_crossing(ray, range, [&](const protostar::Crossing& crossing) {
      if (!first) first = crossing;
    });
    return first;
  }
  void each_crossing(const protostar::Ray& ray, protostar::Interval range, auto&& visit) const {
    const bool is_upward = ray.direction.z > 0;
    for (const int primitive : is_upward ? std::array{0, 1} : std::array{1, 0}) {
      if (ray.departure == departure(primitive) || ray.direction.z == 0) continue;
      const double t = (primitive * height - ray.origin.z) / ray.direction.z;
      const protostar::Point p = ray.at(t);
      if (p.x * p.x + p.y * p.y <= 1 && range.contains(t)) visit(protostar::Crossing{t, 0, primitive});
    }
  }
  protostar::ExactRoot exact_root(const protostar::Ray&, const protostar::Crossing& crossing) const {
    return protostar::exact_root_of(crossing.t);
  }
  std::optional<double> intersect(const protostar::Ray& ray, protostar::Interval range) const {
    const auto crossing = first_crossing(ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
  }
  protostar::Vec3 normal_at(const protostar::Point&, int primitive) const {
    return {0, 0, primitive == 0 ? -1 : 1};
  }
  protostar::Uv uv_at(const protostar::Point& point, int primitive) const {
    return {point.x + 10 * primitive, point.y};
  }
  protostar::Departure departure(int primitive) const {
    return {.kind = protostar::Departure::Kind::object,
            .object = this,
            .geometry = {static_cast<double>(primitive)}};
  }
  protostar::Bounds bounds() const { return {{-1, -1, 0}, {1, 1, height}}; }
};
static_assert(protostar::is_made_of_primitives<TwoPlates> && protostar::CompositeSurface<TwoPlates>);

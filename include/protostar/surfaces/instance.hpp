// A surface that is scaled, rotated, sheared or moved from where it was made.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "../numeric/affine.hpp"
#include "../surface.hpp"
#include "any_surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The image of a surface under an affine map. A ray is carried back into the surface's own space, where it
/// is answered; its direction is not normalized, so that t is the same in both. What is exact for the surface
/// is exact for the ray that is carried, whose numbers are rounded (docs/numerics.md, Instances).
///
/// Outside stays outside, in a mirror image as well, and u and v go with the points.
template <Surface S = AnySurface>
class Instance {
 public:
  Instance(S surface, const Affine& placement)
      : surface_(std::move(surface)), inverse_(placement), bounds_(bounds_of(surface_, placement)) {}

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    const auto crossing = first_crossing(ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
  }

  /// The unit normal on the side that is the surface's outside.
  [[nodiscard]] Vec3 normal_at(const Point& point, int part = 0) const {
    const Vec3 normal = protostar::normal_at(surface_, inverse_.point(point), part);
    return normalize(of_moderate_size(inverse_.mapped_normal(normal)));
  }

  [[nodiscard]] Uv uv_at(const Point& point, int part = 0) const {
    return protostar::uv_at(surface_, inverse_.point(point), part);
  }

  /// This instance, recognized by its address, and the part of it.
  [[nodiscard]] Departure departure(int part = 0) const {
    return {.kind = Departure::Kind::object, .object = this, .geometry = {static_cast<double>(part)}};
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    const auto first = protostar::first_crossing(surface_, carried(ray), range);
    if (!first || is_within_bounds(ray, first->t)) return first;
    std::optional<Crossing> within;
    each_crossing(ray, range, [&](const Crossing& crossing) {
      if (!within) within = crossing;
    });
    return within;
  }

  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    protostar::each_crossing(surface_, carried(ray), range, [&](const Crossing& crossing) {
      if (is_within_bounds(ray, crossing.t)) visit(crossing);
    });
  }

  [[nodiscard]] RefinedCrossing refine(const Ray& ray, const Crossing& crossing, Precision precision) const {
    return protostar::refine(surface_, carried(ray), crossing, precision);
  }
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return protostar::exact_root(surface_, carried(ray), crossing);
  }

  [[nodiscard]] bool has_parts() const { return protostar::has_parts(surface_); }
  [[nodiscard]] int part_count() const { return protostar::part_count(surface_); }
  [[nodiscard]] bool has_uv() const { return protostar::has_uv(surface_); }
  [[nodiscard]] bool is_solid() const { return protostar::is_solid(surface_); }
  [[nodiscard]] bool ends_inside(const Ray& ray) const {
    return protostar::ends_inside(surface_, carried(ray));
  }

  [[nodiscard]] Bounds bounds() const { return bounds_; }

  /// Throws std::invalid_argument if the surface is not valid or the map has no way back.
  void validate() const {
    if constexpr (SurfaceWithValidation<S>) surface_.validate();
    if (!inverse_.exists())
      throw std::invalid_argument("Instance: the map must be finite, and not take space to a plane or less");
  }

 private:
  /// The ray in the surface's own space.
  [[nodiscard]] Ray carried(const Ray& ray) const {
    Ray inner{inverse_.point(ray.origin), inverse_.vector(ray.direction)};
    if (ray.departure.kind == Departure::Kind::object && ray.departure.object == this)
      inner.departure = departure_of(surface_, static_cast<int>(ray.departure.geometry[0]));
    return inner;
  }

  /// The box around the images of the eight corners, and a thousandth more: the ray that is carried is a
  /// little off.
  [[nodiscard]] static Bounds bounds_of(const S& surface, const Affine& placement) {
    const Bounds everywhere{.min = Point{-infinity}, .max = Point{infinity}};
    if constexpr (!SurfaceWithBounds<S>) {
      return everywhere;
    } else {
      const Bounds inner = surface.bounds();
      if (!is_finite(inner.min) || !is_finite(inner.max)) return everywhere;
      Bounds box{placement.translation, placement.translation};
      for (int k = 0; k < 3; ++k) {
        const Vec3& column = k == 0 ? placement.x : k == 1 ? placement.y : placement.z;
        const Vec3 a = inner.min[k] * column, b = inner.max[k] * column;
        box.min += min(a, b);
        box.max += max(a, b);
      }
      const Vec3 size = box.max - box.min, far = max(abs(box.min), abs(box.max));
      const Vec3 margin =
          Vec3(0x1p-10 * std::max({size.x, size.y, size.z}) + 0x1p-40 * std::max({far.x, far.y, far.z}));
      box = {box.min - margin, box.max + margin};
      return is_finite(box.min) && is_finite(box.max) ? box : everywhere;
    }
  }

  /// Whether a point of a ray surely lies in the bounds. Only what does counts: whoever looks for the
  /// instance by way of its bounds finds the same.
  [[nodiscard]] bool is_within_bounds(const Ray& ray, double t) const {
    // A product and a sum, each rounded by u of what it is at most, and the sums below once more: 3u.
    const Vec3 way = t * ray.direction, point = ray.origin + way;
    const Vec3 error = 0x1p-51 * (abs(ray.origin) + abs(way));
    const Vec3 least = point - error, most = point + error;
    return bounds_.min.x <= least.x && most.x <= bounds_.max.x && bounds_.min.y <= least.y &&
           most.y <= bounds_.max.y && bounds_.min.z <= least.z && most.z <= bounds_.max.z;
  }

  S surface_;
  AffineInverse inverse_;
  Bounds bounds_;
};

static_assert(CompositeSurface<Instance<>> && SurfaceWithParts<Instance<>> && Solid<Instance<>>);

}  // namespace protostar::inline PROTOSTAR_ABI

// Where a ray crosses a surface, and what can be asked there.
#pragma once

#include "ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A surface in a scene, whatever its type: what an Intersection needs in order to answer. surface.hpp makes
/// one.
struct SurfaceView {
  const void* surface;
  Vec3 (*normal_at)(const void* surface, const Point& point);
  Departure (*departure)(const void* surface);
  const Color* color;
};

/// A crossing of a ray with a surface. It holds t and works out the rest when it is asked, so that an
/// integrator pays only for what it uses. It is valid as long as the scene that it comes from lives and gets
/// no further surfaces.
class Intersection {
 public:
  /// The ray's parameter here. A distance in scene units where the ray's direction is a unit vector.
  double t;

  Intersection(const Ray& ray, double t_, const SurfaceView& view) : t(t_), ray_(ray), view_(view) {}

  /// Where it is.
  [[nodiscard]] Point point() const { return ray_.at(t); }

  /// The surface's unit normal, on the side that the surface calls its outside (§2.3.1).
  [[nodiscard]] Vec3 normal() const { return view_.normal_at(view_.surface, point()); }

  /// The unit normal on the side that the ray comes from: surfaces are two-sided (§2.3.2).
  [[nodiscard]] Vec3 facing_normal() const {
    const Vec3 n = normal();
    return dot(n, ray_.direction) <= 0 ? n : -n;
  }

  /// The color that the surface was added with.
  [[nodiscard]] Color color() const { return *view_.color; }

  /// The ray from here in a direction of any length. It knows what it departs from and does not meet it again
  /// at its origin; there is no offset.
  [[nodiscard]] Ray leave(const Vec3& direction) const {
    return {point(), direction, view_.departure(view_.surface)};
  }

 private:
  Ray ray_;
  SurfaceView view_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

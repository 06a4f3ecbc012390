// A surface that is scaled, rotated, sheared or moved from the place in which it was made.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "../magnitude.hpp"
#include "../numeric/affine.hpp"
#include "../surface.hpp"
#include "../surface_concepts.hpp"
#include "../transformed_ray.hpp"
#include "any_surface.hpp"
#include "coordinates.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template <class S = AnySurface>
class Instance;

/// The image of a surface under an affine map. A ray is mapped into the surface's own space (object space)
/// and traced there; its direction is not normalized, so t is the same in both spaces. The mapped ray is
/// rounded, but knows the exact one (RayTransform): exact answers of the surface are exact for its image. A
/// surface of your own that has only intersect and normal_at is given the rounded ray.
///
/// The outside stays outside, in a mirror image as well, and u and v go with the points. A ray that leaves a
/// face of the image also leaves all surfaces in the plane of that face, if doubles hold the face's equation
/// in object space, as they do if it is perpendicular to an axis there; a ray that leaves a sphere that stays
/// a sphere also leaves equal spheres.
template <Surface S>
class Instance<S> {
  static_assert(detail::SurfaceOffers<S>::hold);

 public:
  Instance(S surface, const Affine& placement)
      : surface_(std::move(surface)),
        inverse_(placement),
        bounds_(bounds_of_image(bounds_of(surface_), placement)) {
    if (!inverse_.exists()) return;  // validate() throws
    for (int primitive = 0; primitive < protostar::primitive_count(surface_); ++primitive) {
      const Departure own = departure_of(surface_, primitive);
      if (own.kind != Departure::Kind::plane && own.kind != Departure::Kind::sphere) continue;
      const auto [image, is_new] = images_.try_emplace({own.kind, own.geometry});
      if (is_new) image->second = image_of(own);
      if (image->second.kind != Departure::Kind::object)
        primitives_.try_emplace(geometry_of(image->second), primitive);
    }
  }

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal on the surface's outside.
  [[nodiscard]] Vec3 normal_at(const Point& point, int primitive = 0) const {
    return unit_along(inverse_.mapped_normal(protostar::normal_at(surface_, carried(point), primitive)));
  }

  [[nodiscard]] Uv uv_at(const Point& point, int primitive = 0) const {
    return protostar::uv_at(surface_, carried(point), primitive);
  }

  /// Returns the images of the surface's own tangents, as directions.
  [[nodiscard]] Tangents tangents_at(const Point& point, int primitive = 0) const {
    const Tangents own = protostar::tangents_at(surface_, carried(point), primitive);
    return {inverse_.map().vector(of_moderate_size(own.u)), inverse_.map().vector(of_moderate_size(own.v))};
  }

  /// Returns the plane or the sphere of a primitive, if other surfaces may have the same; and this instance,
  /// recognized by its address.
  [[nodiscard]] Departure departure(int primitive = 0) const {
    Departure departure{.kind = Departure::Kind::object};
    if (!images_.empty()) {
      const Departure own = departure_of(surface_, primitive);
      if (const auto image = images_.find({own.kind, own.geometry}); image != images_.end())
        departure = image->second;
    }
    departure.primitive = primitive, departure.object = this;
    return departure;
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    if (is_missed_by(ray)) return std::nullopt;
    const RayTransform transform(ray, inverse_);
    return protostar::first_crossing(surface_, in_object_space(transform), range);
  }

  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    if (is_missed_by(ray)) return;
    const RayTransform transform(ray, inverse_);
    protostar::each_crossing(surface_, in_object_space(transform), range, visit);
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    const RayTransform transform(ray, inverse_);
    return protostar::exact_root(surface_, in_object_space(transform), crossing);
  }

  [[nodiscard]] bool has_primitives() const { return protostar::has_primitives(surface_); }
  [[nodiscard]] int primitive_count() const { return protostar::primitive_count(surface_); }
  [[nodiscard]] bool has_uv() const { return protostar::has_uv(surface_); }
  [[nodiscard]] bool has_tangents() const { return protostar::has_tangents(surface_); }
  [[nodiscard]] bool is_solid() const { return protostar::is_solid(surface_); }
  [[nodiscard]] bool ends_inside(const Ray& ray) const {
    const RayTransform transform(ray, inverse_);
    return protostar::ends_inside(surface_, in_object_space(transform));
  }

  [[nodiscard]] Bounds bounds() const { return bounds_; }

  /// Returns the surface in its own space, and the map from there.
  [[nodiscard]] const S& surface() const { return surface_; }
  [[nodiscard]] const Affine& placement() const { return inverse_.map(); }

  /// Throws std::invalid_argument if the surface is not valid or moves, the map has no inverse, or a number
  /// of the map or of the inverse is not a coordinate (magnitude.hpp).
  void validate() const {
    if constexpr (requires { surface_.validate(); }) surface_.validate();
    if (protostar::is_moving(surface_))
      throw std::invalid_argument("Instance: the surface must not be moving; an instance may be");
    if (!inverse_.exists())
      throw std::invalid_argument("Instance: the map must be finite, and not take space to a plane or less");
    const Affine& map = inverse_.map();
    for (const Vec3& column : {map.x, map.y, map.z, map.translation})
      require_rule(is_coordinate(column), "Instance: the numbers of the map must be", coordinate_rule);
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      require_rule(is_coordinate(inverse_.vector(axis)),
                   "Instance: the numbers of the inverse of the map must be", coordinate_rule);
  }

 private:
  /// Maps a point into object space. Nested instances may take it beyond the range of double, so each number
  /// is clamped to ±2^500, which the next inverse map leaves finite.
  [[nodiscard]] Point carried(const Point& point) const { return within(inverse_.point(point), 0x1p500); }

  /// Returns true if a ray that starts beside the surface surely crosses nothing, as its line misses the
  /// bounds. The digits of a ray that leaves the surface may be off the bounds.
  [[nodiscard]] bool is_missed_by(const Ray& ray) const {
    return !inverse_.exists() || (ray.transform == nullptr && surely_misses(ray, bounds_) &&
                                  departure_inside(ray.departure).kind == Departure::Kind::none);
  }

  /// Returns the ray in object space, with its departure there.
  [[nodiscard]] Ray in_object_space(const RayTransform& transform) const {
    Ray ray = transform.ray();
    ray.departure = departure_inside(transform.outer.departure);
    return ray;
  }

  /// Returns the departure in object space of a ray with a given departure outside.
  [[nodiscard]] Departure departure_inside(const Departure& departed) const {
    if (departed.kind == Departure::Kind::none) return {};
    if (departed.object == this) return departure_of(surface_, departed.primitive);
    const auto primitive = primitive_with(departed);
    if (!primitive) return {};
    Departure departure = departure_of(surface_, *primitive);
    departure.object = nullptr;  // the ray left another surface
    return departure;
  }

  using Geometry = std::pair<Departure::Kind, std::array<double, 4>>;

  /// Returns the geometry of a plane or a sphere, rounded for a plane.
  [[nodiscard]] static Geometry geometry_of(const Departure& departure) {
    if (!departure.is_planar()) return {departure.kind, departure.geometry};
    return {Departure::Kind::rounded_plane, departure.rounded()};
  }

  /// Returns a primitive whose plane or sphere is the one that the ray leaves on another surface.
  [[nodiscard]] std::optional<int> primitive_with(const Departure& departed) const {
    if (primitives_.empty() || departed.kind == Departure::Kind::object) return std::nullopt;
    const auto found = primitives_.find(geometry_of(departed));
    return found == primitives_.end() ? std::nullopt : std::optional(found->second);
  }

  /// Returns the image of the plane or sphere of a primitive, whose equation doubles hold. The kind is object
  /// if the image of a sphere is not a sphere, or doubles do not hold it.
  [[nodiscard]] Departure image_of(const Departure& own) const {
    const auto& [a, b, c, d] = own.geometry;
    if (own.is_planar())
      return {.kind = Departure::Kind::rounded_plane, .geometry = inverse_.mapped_plane({a, b, c}, d)};
    const auto sphere = image_of_sphere(inverse_.map(), {a, b, c}, d);
    return sphere ? Departure{.kind = Departure::Kind::sphere, .geometry = *sphere}
                  : Departure{.kind = Departure::Kind::object};
  }

  /// Returns the box around the images of the eight corners. One product and up to three sums are each
  /// rounded by u = 2^-53 of the sizes of the terms, and the sum of these sizes is rounded, too: 2^-50 = 8u
  /// of it are more than all errors.
  [[nodiscard]] static Bounds bounds_of_image(const Bounds& inner, const Affine& placement) {
    const Bounds everywhere{.min = Point{-infinity}, .max = Point{infinity}};
    if (!is_finite(inner)) return everywhere;
    Bounds box{placement.translation, placement.translation};
    Vec3 sizes = abs(placement.translation);
    for (int k = 0; k < 3; ++k) {
      const Vec3& column = k == 0 ? placement.x : k == 1 ? placement.y : placement.z;
      const Vec3 a = inner.min[k] * column, b = inner.max[k] * column;
      box.min += min(a, b);
      box.max += max(a, b);
      sizes += max(abs(a), abs(b));
    }
    const Vec3 margin = 0x1p-50 * sizes + Vec3(0x1p-1070);  // the constant for underflow
    box = {box.min - margin, box.max + margin};
    return is_finite(box) ? box : everywhere;
  }

  S surface_;
  AffineInverse inverse_;
  Bounds bounds_;
  std::map<Geometry, Departure> images_;  ///< images of the planes and spheres of primitives
  std::map<Geometry, int> primitives_;    ///< first primitives with these images
};

template <class S>
Instance(S surface, const Affine& placement) -> Instance<S>;

/// Stands in for the instance of a type that is not a surface: the compiler stops and says what the type
/// lacks.
template <class S>
class Instance : public detail::NoSurface {
  static_assert(detail::SurfaceRequirements<S>::hold);

 public:
  Instance(const S&, const Affine&) {}
};

static_assert(CompositeSurface<Instance<>> && is_made_of_primitives<Instance<>> && Solid<Instance<>>);

}  // namespace protostar::inline PROTOSTAR_ABI

// A surface that is scaled, rotated, sheared or moved from the place in which it was made.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "../magnitude.hpp"
#include "../numeric/affine.hpp"
#include "../surface.hpp"
#include "../surface_requirements.hpp"
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
      : surface_(std::move(surface)), inverse_(placement), bounds_(bounds_of(surface_, placement)) {
    if (!inverse_.exists()) return;                       // validate() throws
    std::map<Geometry, std::optional<Departure>> images;  // parts in one plane have one image
    for (int part = 0; part < protostar::part_count(surface_); ++part) {
      const Departure own = departure_of(surface_, part);
      if (own.kind != Departure::Kind::plane && own.kind != Departure::Kind::sphere) continue;
      const auto [image, is_new] = images.try_emplace({own.is_planar(), own.geometry});
      if (is_new) image->second = image_of(own);
      if (!image->second) continue;
      shared_.push_back(*image->second);
      shared_.back().part = part;
    }
    by_geometry_.resize(shared_.size());
    std::iota(by_geometry_.begin(), by_geometry_.end(), std::size_t{0});
    std::stable_sort(by_geometry_.begin(), by_geometry_.end(), [&](std::size_t a, std::size_t b) {
      return geometry_of(shared_[a]) < geometry_of(shared_[b]);
    });
  }

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal on the surface's outside.
  [[nodiscard]] Vec3 normal_at(const Point& point, int part = 0) const {
    return unit_along(inverse_.mapped_normal(protostar::normal_at(surface_, carried(point), part)));
  }

  [[nodiscard]] Uv uv_at(const Point& point, int part = 0) const {
    return protostar::uv_at(surface_, carried(point), part);
  }

  /// Returns the plane or the sphere of a part, if other surfaces may have the same; and this instance,
  /// recognized by its address.
  [[nodiscard]] Departure departure(int part = 0) const {
    const auto found = std::lower_bound(shared_.begin(), shared_.end(), part,
                                        [](const Departure& one, int other) { return one.part < other; });
    Departure departure{.kind = Departure::Kind::object};
    if (found != shared_.end() && found->part == part) departure = *found;
    departure.part = part, departure.object = this;
    return departure;
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    if (!inverse_.exists()) return std::nullopt;
    const RayTransform transform(ray, inverse_);
    return protostar::first_crossing(surface_, in_object_space(transform), range);
  }

  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    if (!inverse_.exists()) return;
    const RayTransform transform(ray, inverse_);
    protostar::each_crossing(surface_, in_object_space(transform), range, visit);
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    const RayTransform transform(ray, inverse_);
    return protostar::exact_root(surface_, in_object_space(transform), crossing);
  }

  [[nodiscard]] bool has_parts() const { return protostar::has_parts(surface_); }
  [[nodiscard]] int part_count() const { return protostar::part_count(surface_); }
  [[nodiscard]] bool has_uv() const { return protostar::has_uv(surface_); }
  [[nodiscard]] bool is_solid() const { return protostar::is_solid(surface_); }
  [[nodiscard]] bool ends_inside(const Ray& ray) const {
    const RayTransform transform(ray, inverse_);
    return protostar::ends_inside(surface_, in_object_space(transform));
  }

  [[nodiscard]] Bounds bounds() const { return bounds_; }

  /// Throws std::invalid_argument if the surface is not valid, the map has no inverse, or a number of the
  /// inverse is not a coordinate (magnitude.hpp).
  void validate() const {
    if constexpr (requires { surface_.validate(); }) surface_.validate();
    if (!inverse_.exists())
      throw std::invalid_argument("Instance: the map must be finite, and not take space to a plane or less");
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      require_rule(is_coordinate(inverse_.vector(axis)),
                   "Instance: the numbers of the inverse of the map must be", coordinate_rule);
  }

 private:
  /// Maps a point into object space. Nested instances may take it beyond the range of double, so each number
  /// is clamped to ±2^500, which the next inverse map leaves finite.
  [[nodiscard]] Point carried(const Point& point) const { return within(inverse_.point(point), 0x1p500); }

  /// Returns the ray in object space, with its departure there.
  [[nodiscard]] Ray in_object_space(const RayTransform& transform) const {
    Ray ray = transform.ray();
    const Departure& left = transform.outer.departure;
    if (left.kind == Departure::Kind::none) return ray;
    if (left.object == this) {
      ray.departure = departure_of(surface_, left.part);
    } else if (const auto part = part_with(left)) {
      ray.departure = departure_of(surface_, *part);
      ray.departure.object = nullptr;  // the ray left another surface
    }
    return ray;
  }

  using Geometry = std::pair<bool, std::array<double, 4>>;  ///< first is true for a plane, false for a sphere

  [[nodiscard]] static Geometry geometry_of(const Departure& departure) {
    return {departure.is_planar(), departure.is_planar() ? departure.rounded() : departure.geometry};
  }

  /// Returns a part whose plane or sphere is the one that the ray leaves on another surface.
  [[nodiscard]] std::optional<int> part_with(const Departure& left) const {
    if (shared_.empty() || left.kind == Departure::Kind::object) return std::nullopt;
    const Geometry geometry = geometry_of(left);
    const auto found = std::lower_bound(
        by_geometry_.begin(), by_geometry_.end(), geometry,
        [&](std::size_t i, const Geometry& other) { return geometry_of(shared_[i]) < other; });
    if (found == by_geometry_.end() || geometry_of(shared_[*found]) != geometry) return std::nullopt;
    return shared_[*found].part;
  }

  /// Returns the image of the plane or sphere of a part, if doubles hold the plane's equation, or the sphere
  /// stays a sphere.
  [[nodiscard]] std::optional<Departure> image_of(const Departure& own) const {
    const auto& [a, b, c, d] = own.geometry;
    if (own.kind == Departure::Kind::plane)
      return Departure{.kind = Departure::Kind::rounded_plane,
                       .geometry = inverse_.mapped_plane({a, b, c}, d)};
    if (own.kind != Departure::Kind::sphere) return std::nullopt;
    const auto sphere = image_of_sphere(inverse_.map(), {a, b, c}, d);
    if (!sphere) return std::nullopt;
    return Departure{.kind = Departure::Kind::sphere,
                     .geometry = {sphere->center.x, sphere->center.y, sphere->center.z, sphere->radius}};
  }

  /// Returns the box around the images of the eight corners. One product and up to three sums are each
  /// rounded by u = 2^-53 of the sizes of the terms, and the sum of these sizes is rounded, too: 2^-50 = 8u
  /// of it are more than all errors.
  [[nodiscard]] static Bounds bounds_of(const S& surface, const Affine& placement) {
    const Bounds everywhere{.min = Point{-infinity}, .max = Point{infinity}};
    if constexpr (!SurfaceWithBounds<S>) {
      return everywhere;
    } else {
      const Bounds inner = surface.bounds();
      if (!is_finite(inner.min) || !is_finite(inner.max)) return everywhere;
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
      return is_finite(box.min) && is_finite(box.max) ? box : everywhere;
    }
  }

  S surface_;
  AffineInverse inverse_;
  Bounds bounds_;
  std::vector<Departure> shared_;         ///< departures of the parts that share one, by part
  std::vector<std::size_t> by_geometry_;  ///< indices into shared_, in the order of geometry_of
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

static_assert(CompositeSurface<Instance<>> && is_made_of_parts<Instance<>> && Solid<Instance<>>);

}  // namespace protostar::inline PROTOSTAR_ABI

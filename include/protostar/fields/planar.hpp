// Fields in a plane, and the solids that they make: extrusions along z, and revolutions around y. A bound is
// a field whose value is nowhere larger in magnitude than the distance (shapes.hpp). bounds(level) and
// validate() are those of shapes.hpp, with rectangles for planar fields.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "../bounds.hpp"
#include "../exact/field_point.hpp"
#include "../interval.hpp"
#include "../magnitude.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI::fields {

/// Rectangle along the axes that contains a planar shape; infinite if there is none.
struct PlanarBounds {
  Uv min, max;
};

/// Distance from a circle around the origin: |p| − radius.
struct Circle {
  double radius = 1;

  template <class T>
  [[nodiscard]] T operator()(const Vec2<T>& p) const {
    return length(p) - radius;
  }
  [[nodiscard]] PlanarBounds bounds(double level = 0) const {
    return {Uv(-radius - level), Uv(radius + level)};
  }
  void validate() const { require_size(radius, "fields::Circle: radius must be"); }
};

/// Distance from a rectangle around the origin: the signed length of |p| − size/2.
struct Rectangle {
  Uv size{1, 1};

  template <class T>
  [[nodiscard]] T operator()(const Vec2<T>& p) const {
    return signed_length(abs(p) - 0.5 * size);
  }
  [[nodiscard]] PlanarBounds bounds(double level = 0) const {
    return {-0.5 * size - Uv(level), 0.5 * size + Uv(level)};
  }
  void validate() const {
    require_rule(is_size(size.x) && is_size(size.y), "fields::Rectangle: each number of size must be",
                 size_rule);
  }
};

/// Bound of the distance from a convex polygon: the largest of the distances from the lines of its sides,
/// which is the distance wherever a side is nearest.
class Polygon {
 public:
  /// Takes the corners, counterclockwise where y is up. Throws std::invalid_argument if they are fewer than
  /// three, not the corners of a convex polygon in that order, or no coordinates.
  explicit Polygon(std::vector<Uv> corners) : corners_(std::move(corners)) {
    const std::size_t n = corners_.size();
    const char* const allowed =
        "fields::Polygon: corners must be three or more of a convex polygon, counterclockwise";
    if (n < 3) throw std::invalid_argument(allowed);
    double turned = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Uv a = corners_[i], b = corners_[(i + 1) % n], c = corners_[(i + 2) % n];
      require_rule(is_coordinate(a), "fields::Polygon: each number of a corner must be", coordinate_rule);
      const Uv along = b - a, next = c - b;
      const double size = std::sqrt(along.x * along.x + along.y * along.y);
      if (!(is_size(size) && along.x * next.y - along.y * next.x > 0)) throw std::invalid_argument(allowed);
      // A turn past the direction of x; a convex polygon has one of these.
      if (along.y < 0 && next.y >= 0) turned += 1;
      const Uv normal{along.y / size, -along.x / size};
      sides_.push_back({normal, normal.x * a.x + normal.y * a.y});
    }
    if (turned != 1) throw std::invalid_argument(allowed);
  }

  template <class T>
  [[nodiscard]] T operator()(const Vec2<T>& p) const {
    T value = from_side(sides_.front(), p);
    for (std::size_t i = 1; i < sides_.size(); ++i) value = max(value, from_side(sides_[i], p));
    return value;
  }

  /// Returns the rectangle of the points where the field is at most `level`, in units of length. Beside the
  /// corner c between sides with the unit normals n and m, the field is `level` at c + 2 level s/|s|² with
  /// s = n + m, since n · s = m · s = |s|²/2. Normals are rounded, by which |s|² is off by 2^-51. The
  /// rectangle is infinite if |s|² is below 2^-30, at an angle below 2^-15, and the level is above 0.
  [[nodiscard]] PlanarBounds bounds(double level = 0) const {
    PlanarBounds all{Uv(infinity), Uv(-infinity)};
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const Uv s = sides_[i].normal + sides_[(i + 1) % sides_.size()].normal;
      const double square = s.x * s.x + s.y * s.y;
      if (level > 0 && square < 0x1p-30) return {Uv(-infinity), Uv(infinity)};
      const Uv corner = corners_[(i + 1) % sides_.size()] + (level > 0 ? (2 * level / square) * s : Uv(0));
      all.min = {std::min(all.min.x, corner.x), std::min(all.min.y, corner.y)};
      all.max = {std::max(all.max.x, corner.x), std::max(all.max.y, corner.y)};
    }
    return all;
  }

  [[nodiscard]] const std::vector<Uv>& corners() const { return corners_; }

 private:
  struct Side {
    Uv normal;  ///< outward, a unit vector
    double distance = 0;
  };

  template <class T>
  [[nodiscard]] static T from_side(const Side& side, const Vec2<T>& p) {
    return dot(p, side.normal) - side.distance;
  }

  std::vector<Uv> corners_;
  std::vector<Side> sides_;
};

/// Planar field drawn out along z, with flat ends: the signed length of (value, |z| − height/2). It is a
/// distance if the planar field is, and a bound if that is a bound.
template <class F>
struct Extruded {
  F field;
  double height = 1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return signed_length(Vec2<T>{field(Vec2<T>{p.x, p.y}), abs(p.z) - 0.5 * height});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const PlanarBounds flat = field.bounds(level);
    const double end = 0.5 * height + level;
    return {Point(flat.min.x, flat.min.y, -end), Point(flat.max.x, flat.max.y, end)};
  }
  void validate() const { validate_each(field), require_size(height, "fields::Extruded: height must be"); }
};
template <class F>
Extruded(F, double) -> Extruded<F>;

/// Planar field turned around the y axis: its value at (|(x, z)| − radius, y). It is a distance if the planar
/// field is, and a bound if that is a bound. Parts of the planar shape beyond the axis do not count; if there
/// are any, the field of a distance is a bound.
template <class F>
struct Revolved {
  F field;
  double radius = 0;  ///< distance of the planar origin from the axis; of any sign

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return field(Vec2<T>{length(Vec2<T>{p.x, p.z}) - radius, p.y});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const PlanarBounds flat = field.bounds(level);
    const double widest = std::max(0.0, radius + flat.max.x);
    return {Point(-widest, flat.min.y, -widest), Point(widest, flat.max.y, widest)};
  }
  void validate() const {
    validate_each(field), require_coordinate(radius, "fields::Revolved: radius must be");
  }
};
template <class F>
Revolved(F, double) -> Revolved<F>;

}  // namespace protostar::inline PROTOSTAR_ABI::fields

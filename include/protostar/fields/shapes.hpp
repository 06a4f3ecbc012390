// Shapes as fields: functions of a point that are below 0 inside of the shape, 0 on it and above 0 outside.
//
// Each is around the origin, with y upward; operations.hpp places it elsewhere. A field is one of three
// kinds:
//
// - a distance: its value is the distance to the surface, with the sign of the side;
// - a bound: nowhere larger in magnitude than the distance, so that a step of its length is safe;
// - implicit: only its sign and its zeros count.
//
// Marched needs no kind: it derives how fast a field changes. A bound or an implicit field takes more steps.
// The formulas without another source are those of https://iquilezles.org/articles/distfunctions.
//
// Each shape has three functions: its value at a point, with any number type; bounds(level), a box that
// contains all points where the field is at most `level` ≥ 0, but for roundings; and validate(), which throws
// std::invalid_argument unless each size is from 2^-400 to 2^400 scene units and each coordinate within
// ±2^400 (magnitude.hpp), or for the reasons that its members tell.
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

/// Returns the box around the origin with the half sides `half`.
[[nodiscard]] inline Bounds box_around_origin(const Vec3& half) { return {-half, half}; }

/// Distance from a sphere: |p| − radius.
struct Sphere {
  double radius = 1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return length(p) - radius;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return box_around_origin(Vec3(radius + level)); }
  void validate() const { require_size(radius, "fields::Sphere: radius must be"); }
};

/// Distance from a plane, below 0 behind it: n · p − distance, for the unit vector n along normal. Doubles
/// seldom hold a unit vector; the length of one that validate() accepts, and so the field, is off by a share
/// of less than 2^-50.
struct Plane {
  Vec3 normal{0, 1, 0};  ///< a unit vector
  double distance = 0;   ///< of the plane from the origin, along the normal; of any sign

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return dot(p, normal) - distance;
  }
  [[nodiscard]] Bounds bounds(double = 0) const { return {Point(-infinity), Point(infinity)}; }
  void validate() const {
    if (!(std::abs(dot(normal, normal) - 1) <= 0x1p-50))
      detail::refuse_found("fields::Plane: normal must be a unit vector, to within 2^-50", normal);
    require_coordinate(distance, "fields::Plane: distance must be");
  }
};

/// Distance from a box with these sides: the signed length of |p| − size/2.
struct Box {
  Vec3 size{1, 1, 1};

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return signed_length(abs(p) - 0.5 * size);
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return box_around_origin(0.5 * size + Vec3(level)); }
  void validate() const {
    for (const double side : {size.x, size.y, size.z})
      require_size(side, "fields::Box: each number of size must be");
  }
};

/// Distance from a box whose edges and corners are rounded by spheres of a radius: the distance from a
/// box that is smaller by the radius on each side, less the radius.
struct RoundedBox {
  Vec3 size{1, 1, 1};
  double radius = 0.1;  ///< at most half the shortest side

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return signed_length(abs(p) - (0.5 * size - Vec3(radius))) - radius;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return Box{size}.bounds(level); }
  void validate() const {
    Box{size}.validate();
    require_size(radius, "fields::RoundedBox: radius must be");
    if (!(2 * radius <= size.x && 2 * radius <= size.y && 2 * radius <= size.z))
      detail::refuse_found("fields::RoundedBox: radius must be at most half the shortest side", radius);
  }
};

/// Distance from a torus around the y axis: the distance of (|(x, z)| − radius, y) from a circle of the
/// tube's radius. If the tube is wider than the radius, it is only a bound inside.
struct Torus {
  double radius = 1;   ///< radius of the circle in the middle of the tube
  double tube = 0.25;  ///< radius of the tube

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return length(Vec2<T>{length(Vec2<T>{p.x, p.z}) - radius, p.y}) - tube;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const double across = radius + tube + level;
    return box_around_origin({across, tube + level, across});
  }
  void validate() const {
    require_size(radius, "fields::Torus: radius must be");
    require_size(tube, "fields::Torus: tube must be");
  }
};

/// Distance from a cylinder around the y axis with flat ends: the signed length of (|(x, z)| − radius,
/// |y| − height/2).
struct Cylinder {
  double radius = 1, height = 1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return signed_length(Vec2<T>{length(Vec2<T>{p.x, p.z}) - radius, abs(p.y) - 0.5 * height});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    return box_around_origin({radius + level, 0.5 * height + level, radius + level});
  }
  void validate() const {
    require_size(radius, "fields::Cylinder: radius must be");
    require_size(height, "fields::Cylinder: height must be");
  }
};

/// Bound of the distance from a cone around the y axis: its base, of the given radius, is at y = −height/2,
/// and its tip at y = height/2. The larger of two distances: from the plane of the base, and from the line of
/// the side in the plane of the axis and the point. It is a distance wherever a face is nearest.
struct Cone {
  double radius = 1, height = 1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    const auto [across, up] = normal();
    return max(length(Vec2<T>{p.x, p.z}) * across + (p.y - 0.5 * height) * up, -p.y - 0.5 * height);
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const auto [across, up] = normal();
    const double widest = (level + up * (height + level)) / across;
    return {Point(-widest, -0.5 * height - level, -widest), Point(widest, 0.5 * height + level / up, widest)};
  }
  void validate() const {
    require_size(radius, "fields::Cone: radius must be");
    require_size(height, "fields::Cone: height must be");
  }

 private:
  /// Returns the parts of the side's unit normal away from the axis and along it.
  [[nodiscard]] std::pair<double, double> normal() const {
    const double side = std::sqrt(radius * radius + height * height);
    return {height / side, radius / side};
  }
};

/// Distance from a capsule: the points within a radius of a segment on the y axis. |(x, max(|y| − height/2,
/// 0), z)| − radius.
struct Capsule {
  double radius = 0.5;
  double height = 1;  ///< length of the segment

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return length(FieldPoint<T>{p.x, max(abs(p.y) - 0.5 * height, 0.0), p.z}) - radius;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    return box_around_origin(Vec3(radius + level) + Vec3(0, 0.5 * height, 0));
  }
  void validate() const {
    require_size(radius, "fields::Capsule: radius must be");
    require_size(height, "fields::Capsule: height must be");
  }
};

/// Bound of the distance from an ellipsoid: s (|p/radii| − 1), where s is the smallest radius. |p/radii|
/// changes by at most 1/s for each unit of length.
struct Ellipsoid {
  Vec3 radii{1, 1, 1};

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return (length(p * (1.0 / radii)) - 1.0) * smallest();
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    return box_around_origin((1 + level / smallest()) * radii);
  }
  void validate() const {
    for (const double radius : {radii.x, radii.y, radii.z})
      require_size(radius, "fields::Ellipsoid: each of radii must be");
  }

 private:
  [[nodiscard]] double smallest() const { return std::fmin(radii.x, std::fmin(radii.y, radii.z)); }
};

/// Bound of the distance from a regular octahedron with corners on the axes: (|x| + |y| + |z| − radius)/√3,
/// the distance wherever a face is nearest.
struct Octahedron {
  double radius = 1;  ///< distance of the corners from the origin

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return (abs(p.x) + abs(p.y) + abs(p.z) - radius) * 0x1.279a74590331cp-1;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    return box_around_origin(Vec3(radius + 1.7321 * level));  // √3 is less
  }
  void validate() const { require_size(radius, "fields::Octahedron: radius must be"); }
};

/// Bound of the distance from the wall of Gabriel's Horn, the surface |(y, z)| = 1/x, from its mouth at x = 1
/// to x = `end`; the whole horn is infinitely long, with a finite volume and an infinite surface (Torricelli
/// 1643). |(y, z)| − 1/x changes by at most √(1 + 1/x⁴) ≤ √2 for each unit of length, by which it is divided.
struct GabrielsHorn {
  double end = 8;           ///< above 1
  double thickness = 0.05;  ///< thickness of the wall, measured across the axis

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    const T from_wall = abs(length(Vec2<T>{p.y, p.z}) - 1.0 / max(p.x, 1.0)) - 0.5 * thickness;
    return max(from_wall * 0x1.6a09e667f3bccp-1, abs(p.x - 0.5 * (end + 1)) - 0.5 * (end - 1));
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const double widest = 1 + 0.5 * thickness + 1.4143 * level;  // √2 is less
    return {Point(1 - level, -widest, -widest), Point(end + level, widest, widest)};
  }
  void validate() const {
    require_size(end, "fields::GabrielsHorn: end must be");
    if (!(end > 1))
      detail::refuse_found("fields::GabrielsHorn: end must be above 1, where the mouth is", end);
    require_size(thickness, "fields::GabrielsHorn: thickness must be");
  }
};

/// Bound of the distance from a wall around the gyroid (Schoen 1970), g = 0 with g = sin x cos y + sin y cos
/// z + sin z cos x, in cubes with a side of `cell`; it fills all of space. (|g| − thickness) cell/(2π √3).
///
/// |∇g| ≤ √3: by Cauchy's inequality ∂g/∂x = (cos x, sin x) · (cos y, −sin z) is at most √(cos² y + sin² z)
/// in magnitude, and the squares of all three add up to 3.
struct Gyroid {
  double cell = 1;
  double thickness = 0.3;  ///< the wall is where |g| is less; 1.5 or more fills everything

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    constexpr double two_pi = 0x1.921fb54442d18p+2;
    const double wave = two_pi / cell;
    const T x = p.x * wave, y = p.y * wave, z = p.z * wave;
    const T g = sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
    return (abs(g) - thickness) * (0x1.279a74590331cp-1 / wave);
  }
  [[nodiscard]] Bounds bounds(double = 0) const { return {Point(-infinity), Point(infinity)}; }
  void validate() const {
    require_size(cell, "fields::Gyroid: cell must be");
    require_size(thickness, "fields::Gyroid: thickness must be");
  }
};

/// Bound of the distance from a Menger sponge (Menger 1926): a cube from which crosses are cut, 3^i across a
/// side at level i. For each level and axis, fold is 1 in the middle of a cell and 0 at its border, and a
/// cross is where two of three exceed 2/3.
struct MengerSponge {
  double size = 2;  ///< side of the cube
  int levels = 3;   ///< from 0, a cube, to most_levels

  static constexpr int most_levels = 12;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    T value = max(abs(p.x), max(abs(p.y), abs(p.z))) - 0.5 * size;
    double cells = 2 / size;
    for (int i = 0; i < levels; ++i, cells *= 3) {
      const FieldPoint<T> q = fold(p * Vec3(cells) + Vec3(1));
      const T cross = max(min(q.x, q.y), max(min(q.y, q.z), min(q.z, q.x))) - 2.0 / 3.0;
      value = max(value, cross * (1 / cells));
    }
    return value;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return box_around_origin(Vec3(0.5 * size + level)); }
  void validate() const {
    require_size(size, "fields::MengerSponge: size must be");
    if (!(0 <= levels && levels <= most_levels))
      detail::refuse_found("fields::MengerSponge: levels must be from 0 to 12", levels);
  }
};

/// Implicit field of balls that blend into each other where they are near (Blinn 1982): 1 − Σ exp(b (1 − |p −
/// center|²/radius²)), with the sharpness b; exponents below −500 count as −500. It is times r/2b, where r is
/// the smallest radius, so that the slope at a ball of that radius alone is 1. A ball alone has its own
/// radius.
struct Metaballs {
  struct Ball {
    Point center{0};
    double radius = 1;
  };
  std::vector<Ball> balls;
  double sharpness = 2;  ///< at most most_sharpness

  static constexpr double most_sharpness = 100;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    T rest(1.0);
    for (const Ball& ball : balls) {
      const FieldPoint<T> q = p - ball.center;
      const T squares = square(q.x) + square(q.y) + square(q.z);
      const T exponent = squares * (-sharpness / (ball.radius * ball.radius)) + sharpness;
      rest = rest - exp(max(exponent, -500.0));
    }
    return rest * (smallest_radius() / (2 * sharpness));
  }
  /// Returns the box. If the field is at most level, the sum is at least m = 1 − 2b level/r, and one of n
  /// balls adds at least m/n of it: |p − center|² ≤ radius² (1 + ln(n/m)/b). A logarithm is less than 0.7
  /// times the exponent of 2 above its number.
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const double least = 1 - 2 * sharpness * level / smallest_radius();
    if (!(least > 0)) return {Point(-infinity), Point(infinity)};
    const double logarithm = 0.7 * (std::ilogb(static_cast<double>(balls.size()) / least) + 1);
    const double reach = std::sqrt(1 + logarithm / sharpness);
    Bounds all{Point(infinity), Point(-infinity)};
    for (const Ball& ball : balls) {
      all.min = glm::min(all.min, ball.center - Vec3(reach * ball.radius));
      all.max = glm::max(all.max, ball.center + Vec3(reach * ball.radius));
    }
    return all;
  }
  void validate() const {
    if (balls.empty()) throw std::invalid_argument("fields::Metaballs: balls must not be empty");
    for (const Ball& ball : balls) {
      require_coordinate(ball.center, "fields::Metaballs: each number of a center must be");
      require_size(ball.radius, "fields::Metaballs: each radius must be");
    }
    require_size(sharpness, "fields::Metaballs: sharpness must be");
    if (!(sharpness <= most_sharpness))
      detail::refuse_found("fields::Metaballs: sharpness must be at most 100", sharpness);
  }

 private:
  [[nodiscard]] double smallest_radius() const {
    double smallest = infinity;
    for (const Ball& ball : balls) smallest = std::min(smallest, ball.radius);
    return smallest;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::fields

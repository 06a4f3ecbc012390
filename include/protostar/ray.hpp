// A ray, and what it knows about the surface that it leaves.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "numeric/double_double.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The geometry that a ray departs from.
///
/// A ray that starts on a surface meets it at t = 0. That crossing is the one it comes from and must not
/// count, but t is computed and comes out as a little more or less than 0. No small constant tells it from a
/// true crossing at every scale. So the ray carries, by value, the geometry that it leaves; a surface that
/// recognizes itself divides the root t = 0 out of its equation, and what remains is the other root. Geometry
/// that coincides exactly, the same sphere twice or a board that lies on a floor, has equal departures and is
/// left together.
struct Departure {
  enum class Kind : std::uint8_t { none, object, sphere, plane, rounded_plane };

  Kind kind = Kind::none;
  int part = 0;  ///< of a surface with parts that recognizes itself by object: the part that is left
  /// Kind object: the surface itself, recognized by its address. Of a face of a box or an instance, or a
  /// triangle of a mesh: that, by which it recognizes itself; the plane alone is what others recognize. Else
  /// null.
  const void* object = nullptr;

  /// The surface of the scene that is left; trees visit it whatever its bounds say, as the digits of the
  /// origin may lie outside of them. Null: any or none.
  const void* in_scene = nullptr;

  /// kind sphere: center and |radius|; kind plane: normal and distance; kind rounded_plane: the same of a
  /// plane that doubles may not hold, as PlaneEquation has them (numeric/plane_through.hpp)
  std::array<double, 4> geometry{};

  [[nodiscard]] bool is_planar() const { return kind == Kind::plane || kind == Kind::rounded_plane; }

  /// Whether both are of one geometry; of planes and spheres neither object nor part counts. For planes that
  /// is exact where both equations are, and these may be multiples of each other. Where one is rounded, equal
  /// planes are always found to be equal, and two others only if their equations are rounded to the same
  /// numbers: to the digits that a point has, they are one.
  bool operator==(const Departure& other) const {
    if (kind == other.kind && geometry == other.geometry &&
        (kind != Kind::object || (object == other.object && part == other.part)))
      return true;
    return is_planar() && other.is_planar() && is_one_plane_with(other);
  }

  /// The equation of a plane as a rounded_plane has it. A quotient of two doubles is rounded as any number
  /// is.
  [[nodiscard]] std::array<double, 4> rounded() const {
    if (kind == Kind::rounded_plane) return geometry;
    const double largest = geometry[largest_component(geometry)];
    return {geometry[0] / largest, geometry[1] / largest, geometry[2] / largest, geometry[3] / largest};
  }

 private:
  [[nodiscard, gnu::noinline]] bool is_one_plane_with(const Departure& other) const {
    if (kind == Kind::plane && other.kind == Kind::plane) return are_proportional(geometry, other.geometry);
    return rounded() == other.rounded();
  }

  /// Whether all a_i b_k = a_k b_i, with k the place of the largest component of the normal a. The products
  /// are exact; powers of two keep them in the range of double.
  static bool are_proportional(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    const std::size_t k = largest_component(a);
    if (b[k] == 0) return false;
    const int a_exponent = std::ilogb(a[k]), b_exponent = std::ilogb(b[k]);
    const double a_k = std::ldexp(a[k], -a_exponent), b_k = std::ldexp(b[k], -b_exponent);
    for (std::size_t i = 0; i < 4; ++i) {
      const DoubleDouble left = two_product(std::ldexp(a[i], -a_exponent), b_k);
      const DoubleDouble right = two_product(a_k, std::ldexp(b[i], -b_exponent));
      if (left.hi != right.hi || left.lo != right.lo) return false;
    }
    return true;
  }

  /// The place of the normal's largest component, the first of equals.
  static std::size_t largest_component(const std::array<double, 4>& a) {
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (std::abs(a[i]) > std::abs(a[k])) k = i;
    return k;
  }
};

struct RayTransform;

/// The points origin + t · direction (§2.2.3). The direction may have any length other than 0; where it is a
/// unit vector, as for camera rays, t is a distance in scene units. A ray whose direction is 0 or whose
/// numbers are not finite crosses nothing.
struct Ray {
  using Light = Color;  ///< what it brings

  Point origin{0};
  Vec3 direction{0, 0, 1};
  Departure departure{};  ///< what the ray leaves; nothing for a ray that starts in free space

  /// Of a ray in the space of an instance's surface, whose numbers are rounded: what they are rounded from
  /// (transformed_ray.hpp). Null: the numbers are the ray.
  const RayTransform* transform = nullptr;
  bool is_reversed = false;  ///< whether it leads the opposite way of what it is rounded from

  [[nodiscard]] Point at(double t) const { return origin + t * direction; }

  /// The ray from the same place in another direction.
  [[nodiscard]] Ray turned(const Vec3& towards) const { return {origin, towards, departure}; }

  /// The ray from the same place in the opposite direction.
  [[nodiscard]] Ray reversed() const { return {origin, -direction, departure, transform, !is_reversed}; }

  /// The ray, where it is asked for: of a packet of rays, the word takes those that are.
  friend const Ray& only(bool, const Ray& ray) { return ray; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

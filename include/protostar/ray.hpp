// Rays, and their departures: the geometry that they leave.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "numeric/double_double.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Geometry that a ray departs from.
///
/// A ray that starts on a surface crosses it at t = 0. This crossing must not count, but t is computed and
/// comes out as a little more or less than 0. No small constant tells it from a true crossing at every scale.
/// Therefore the ray carries, by value, the geometry that it leaves; a surface that recognizes itself divides
/// the root t = 0 out of its equation, and the other root remains. Surfaces that coincide exactly, the same
/// sphere twice or a board that lies on a floor, have equal departures and are left together.
struct Departure {
  enum class Kind : std::uint8_t { none, object, sphere, plane, rounded_plane };

  Kind kind = Kind::none;
  int primitive = 0;  ///< index of the primitive that is left, for a surface that recognizes itself by object
  /// Kind object: address of the surface itself. Otherwise the address of the box, instance or mesh that is
  /// left, by which it recognizes itself, while other surfaces recognize the geometry alone; null for all
  /// others.
  const void* object = nullptr;

  /// Surface that is left, by its address: in a scene, or in the instance or moving surface that holds it and
  /// for which the ray is mapped; null: any or none. An accelerated scene tests it apart from its trees,
  /// since the digits of the origin may lie outside of its bounds.
  const void* surface = nullptr;

  /// Kind sphere: center and |radius|; kind plane: normal and distance; kind rounded_plane: normal and
  /// distance of a plane that doubles may not hold, as in PlaneEquation (numeric/plane_through.hpp).
  std::array<double, 4> geometry{};

  [[nodiscard]] bool is_planar() const { return kind == Kind::plane || kind == Kind::rounded_plane; }

  /// Returns true if a surface that recognizes itself by its address is left.
  [[nodiscard]] bool is_from(const void* address) const { return kind == Kind::object && object == address; }

  /// Returns true if both are of one geometry; for planes and spheres neither object nor primitive counts.
  /// For planes the answer is exact if both equations are, which may be multiples of each other. If one is
  /// rounded, equal planes are always found to be equal, and two others only if their equations are rounded
  /// to the same numbers: within the digits of a point, they are one.
  bool operator==(const Departure& other) const {
    if (kind == other.kind && geometry == other.geometry &&
        (kind != Kind::object || (object == other.object && primitive == other.primitive)))
      return true;
    return is_planar() && other.is_planar() && is_one_plane_with(other);
  }

  /// Returns the equation of a plane as a rounded_plane has it. Quotients of doubles are rounded to nearest,
  /// as there.
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

  /// Returns true if all a_i b_k = a_k b_i, with k the index of the largest component of the normal a.
  static bool are_proportional(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    const std::size_t k = largest_component(a);
    if (b[k] == 0) return false;
    for (std::size_t i = 0; i < 4; ++i)
      if (a[i] == 0 || b[i] == 0 ? a[i] != b[i] : !are_products_equal(a[i], b[k], a[k], b[i])) return false;
    return true;
  }

  /// Returns true if a b = c d, for numbers that are not 0. Far from the ends of the range of double, the
  /// products are exact as two doubles. If they are not, each number is first scaled to [1/2, 1), which
  /// brings products to [1/4, 1); if the powers of two that are left out differ by 2^3 or more, the products
  /// are not equal.
  static bool are_products_equal(double a, double b, double c, double d) {
    const auto is_exact = [](double product) {
      return 0x1p-900 < std::abs(product) && std::abs(product) < 0x1p900;
    };
    const auto are_equal = [](DoubleDouble x, DoubleDouble y) { return x.hi == y.hi && x.lo == y.lo; };
    const DoubleDouble left = two_product(a, b), right = two_product(c, d);
    if (is_exact(left.hi) && is_exact(right.hi)) return are_equal(left, right);
    int of_a = 0, of_b = 0, of_c = 0, of_d = 0;
    const DoubleDouble first = two_product(std::frexp(a, &of_a), std::frexp(b, &of_b)),
                       second = two_product(std::frexp(c, &of_c), std::frexp(d, &of_d));
    const double shift = std::ldexp(1, std::clamp(of_a + of_b - of_c - of_d, -3, 3));
    return are_equal({first.hi * shift, first.lo * shift}, second);
  }

  /// Returns the index of the normal's component of largest magnitude, the first of equals.
  static std::size_t largest_component(const std::array<double, 4>& a) {
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (std::abs(a[i]) > std::abs(a[k])) k = i;
    return k;
  }
};

struct RayTransform;

/// Points origin + t · direction (§2.2.3). The direction may have any length other than 0; if it is a unit
/// vector, as for camera rays, t is a distance in scene units. A ray whose direction is 0 or whose numbers
/// are not finite crosses nothing. Crossings are right for any length. An integrator needs one from 2^-400 to
/// 2^500: it normalizes the direction, of which the square has to be in the range of double, and the t of
/// points is limited (most_t).
struct Ray {
  using Light = Color;  ///< type of radiance (Color, or Colors for packets), not a light source

  Point origin{0};
  Vec3 direction{0, 0, 1};
  Departure departure{};  ///< geometry that the ray leaves; none for a ray that starts in free space

  /// Source of the rounded numbers of a ray in the space of an instance's surface (transformed_ray.hpp).
  /// Null: the numbers are the ray.
  const RayTransform* transform = nullptr;
  bool is_reversed = false;  ///< true if it leads the opposite way of the ray that it is rounded from
  double time = 0;           ///< time at which it meets moving surfaces (surfaces/moving.hpp)

  [[nodiscard]] Point at(double t) const { return origin + t * direction; }

  /// Returns the ray from the same origin in another direction.
  [[nodiscard]] Ray with_direction(const Vec3& towards) const {
    return {.origin = origin, .direction = towards, .departure = departure, .time = time};
  }

  /// Returns the ray from the same origin in the opposite direction.
  [[nodiscard]] Ray reversed() const {
    return {origin, -direction, departure, transform, !is_reversed, time};
  }

  /// Returns the ray as it is; the overload for a packet restricts its active lanes (accel/packet.hpp).
  friend const Ray& masked(bool, const Ray& ray) { return ray; }
};

/// Returns a copy of a departure or of a ray, made number by number (copied, vec3.hpp).
[[nodiscard]] inline Departure copied(const Departure& departure) {
  const auto& [kind, primitive, object, surface, g] = departure;
  return {kind, primitive, object, surface, {g[0], g[1], g[2], g[3]}};
}
[[nodiscard]] inline Ray copied(const Ray& ray) {
  return {copied(ray.origin), copied(ray.direction), copied(ray.departure),
          ray.transform,      ray.is_reversed,       ray.time};
}

namespace detail {

/// Line of a ray, copied, so that a loop over surfaces computes once what their equations have in common.
struct CopiedLine {
  Point origin;
  Vec3 direction;
};

/// Tests whether the square of a direction neither underflows nor takes products with it out of the range of
/// double. It has no branch, so that a loop over surfaces computes it once for a ray.
template <class T>
[[nodiscard, gnu::always_inline]] inline auto is_moderate_square(const T& A) {
  const auto is_large = 0x1p-150 < A, is_small = A < 0x1p150;
  return is_large && is_small;
}

}  // namespace detail

/// Tests whether a direction d surely leads away from a center, with l the vector to it from the origin, A =
/// d·d, b = d·l and w ≥ l·l. With u = 2^-53, b is off by at most 4u √(A w) (docs/derivations.md, Dot
/// products), and 2^-50 = 8u. For w > 2^-900, underflow affects no comparison.
template <class T>
[[nodiscard, gnu::always_inline]] inline auto surely_leads_away(const T& A, const T& b, const T& w) {
  return detail::is_moderate_square(A) && b < 0.0 && b * b > 0x1p-100 * (A * w) && w > 0x1p-900;
}

/// Returns true if a ray departs from a sphere and surely leads away from its center. Its other root, 2b/A,
/// is then below 0: it hits neither that sphere nor one that coincides in t > 0.
[[nodiscard, gnu::always_inline]] inline bool leaves_outward(const Ray& ray) {
  if (ray.departure.kind != Departure::Kind::sphere || ray.transform != nullptr) return false;
  const auto& [x, y, z, r] = ray.departure.geometry;
  const Vec3 l = Point{x, y, z} - ray.origin;
  return surely_leads_away(dot(ray.direction, ray.direction), dot(ray.direction, l), dot(l, l));
}

}  // namespace protostar::inline PROTOSTAR_ABI

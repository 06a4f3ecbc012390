// Reference for rays through pixel centers and their crossings with spheres, computed from the definitions
// and sharing nothing with the library.
//
// Decisions about a pixel, hit or miss, in front or behind, lit or in shadow, are made exactly or not at all:
//   - Rays from the camera are whole numbers and the spheres are whole in parts of a unit, so that their
//     discriminants are whole. Nothing is rounded before the sign is known, and a point of tangency is D = 0.
//   - The rest is long double, of 64 bits or more: a rounding is at most u = 2^-64 = 5.4e-20 of the value. A
//     comparison of numbers that differ by less than 1e-13 throws Undecided; their errors are shown below to
//     be a hundred times smaller. It is thrown for no pixel of the pictures.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>

namespace reference {

using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64, "the reference needs more bits than double has");

/// Thrown for a pixel that the precision at hand cannot decide.
struct Undecided : std::runtime_error {
  Undecided() : std::runtime_error("reference: long double cannot decide this pixel") {}
};

/// Returns true if a < b, for numbers whose errors are below 1e-15 of scale. Throws Undecided if they are too
/// close to each other.
inline bool is_less(Real a, Real b, Real scale) {
  if (!(std::abs(a - b) > 1e-13L * scale)) throw Undecided();
  return a < b;
}

struct Vector {
  Real x = 0, y = 0, z = 0;
};

inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(Vector a, Vector b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vector operator*(Real s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
inline Real dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real length(Vector a) { return std::sqrt(dot(a, a)); }

/// Vector of whole numbers. The products below stay under 2^63 for the tutorial's spheres in pictures of up
/// to 2^15 pixels a side, and of up to 640 for spheres whose centers have fewer than 2^20 parts.
struct Whole {
  std::int64_t x = 0, y = 0, z = 0;

  [[nodiscard]] Vector real() const {
    return {static_cast<Real>(x), static_cast<Real>(y), static_cast<Real>(z)};
  }
};

inline std::int64_t dot(Whole a, Whole b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Returns the direction from the camera, at the origin, through the center of pixel (x, y): the tutorial's,
///   ((2x + 1 − w)/h, (h − 1 − 2y)/h, 1),
/// times h, which makes it whole.
inline Whole through_pixel(int x, int y, int width, int height) {
  return {2 * x + 1 - width, height - 1 - 2 * y, height};
}

/// Sphere whose numbers are whole in parts of the scene's unit; the tutorial's three are in halves.
struct Sphere {
  Whole center_parts;
  std::int64_t radius_parts = 0;
  Vector color;
  std::int64_t parts = 2;  ///< number of parts in a unit

  [[nodiscard]] Vector center() const { return 1 / static_cast<Real>(parts) * center_parts.real(); }
  [[nodiscard]] Real radius() const { return static_cast<Real>(radius_parts) / static_cast<Real>(parts); }
};

/// Values of t at which a ray enters and leaves a sphere; equal for a tangent ray.
struct Crossings {
  Real near = 0, far = 0;
};

/// Returns the crossings ahead of a ray from the origin. It is outside of the sphere, so both or none are
/// ahead.
///   |t d − C|² = R²   is   A t² − 2 b t + c = 0   with   A = d·d,  b = d·C,  c = C·C − R²,
/// where n b and n² c, for n parts, and hence n² D = (n b)² − A · n² c, are whole. The far root is
/// (b + √D)/A; the near one is c/(b + √D), since their product is c/A, which avoids the cancellation of
/// b − √D. Either has an error of at most 4u.
inline std::optional<Crossings> crossings(Whole d, const Sphere& sphere) {
  const std::int64_t R2 = sphere.radius_parts * sphere.radius_parts;
  const std::int64_t A = dot(d, d), b = dot(d, sphere.center_parts);
  const std::int64_t c = dot(sphere.center_parts, sphere.center_parts) - R2;
  if (c <= 0) throw std::logic_error("reference: the camera has to be outside of every sphere");
  const std::int64_t D = b * b - A * c;
  if (D < 0 || b <= 0) return std::nullopt;
  const Real sum = static_cast<Real>(b) + std::sqrt(static_cast<Real>(D));  // n (b + √D)
  const Real n = static_cast<Real>(sphere.parts);
  return Crossings{.near = static_cast<Real>(c) / (n * sum), .far = sum / (n * static_cast<Real>(A))};
}

/// Returns true if a sphere that contains neither of two points is between them: the point of their line that
/// is nearest to the center lies inside the sphere, and between the two.
///
/// Errors: a visible point p is known to 5u of its distance from the camera, its difference d to the light,
/// of at least a sixth of that length, to 30u, and h, the vector from the line to the center, to 200u
/// (|p| + |l|). Hence h² has an error of 400u (|p| + |l|) |h|, which is 2.2e-17 of (|p| + |l|) |h|.
inline bool is_between(const Sphere& sphere, Vector from, Vector to) {
  const Vector d = to - from, l = sphere.center() - from;
  const Real nearest = dot(d, l) / dot(d, d);
  const Vector h = l - nearest * d;
  const Real h2 = dot(h, h), R2 = sphere.radius() * sphere.radius();
  const Real scale = (length(from) + length(l)) * length(h) + R2;
  return is_less(h2, R2, scale) && is_less(0, nearest, 1) && is_less(nearest, 1, 1);
}

/// Returns true if a sphere is between a point on it and another point. The root t = 0 is the point itself
/// and does not count. With it c = 0, and the other root is 2b/A with b = d·(C − from): the sphere is hit
/// again if this lies in (0, 1).
inline bool is_between_from_surface(const Sphere& sphere, Vector from, Vector to) {
  const Vector d = to - from;
  const Real other = 2 * dot(d, sphere.center() - from) / dot(d, d);
  return is_less(0, other, 1) && is_less(other, 1, 1);
}

}  // namespace reference

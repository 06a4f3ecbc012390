// Affine maps (scaling, rotation, shear, translation) and their inverses.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "../vec3.hpp"
#include "equation.hpp"
#include "plane_through.hpp"
#include "rounded_equation.hpp"
#include "scale.hpp"
#include "trigonometry.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Affine map p → p.x · x + p.y · y + p.z · z + translation.
struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< images of the axes' unit vectors
  Vec3 translation{0};                      ///< image of the coordinate origin

  /// Returns the image of a direction, which the translation does not change, or of a point.
  [[nodiscard]] Vec3 vector(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  [[nodiscard]] Point point(const Point& p) const { return vector(p) + translation; }

  /// Returns this map followed by a scaling along the axes, whose factors may be negative. Calls are chained
  /// in the order of the maps: Affine{}.scaled_by({2, 1, 1}).rotated_about({0, 1, 0}, 30).
  [[nodiscard]] Affine scaled_by(const Vec3& factors) const {
    return {factors * x, factors * y, factors * z, factors * translation};
  }

  /// Returns this map followed by a rotation about an axis through the coordinate origin, of any length but
  /// 0; by 90 degrees about z, x goes to y.
  [[nodiscard]] Affine rotated_about(const Vec3& axis, double degrees) const {
    // The part of v along the unit vector a stays, and the rest turns in its plane:
    //   a (a·v) + (v − a (a·v)) cos + (a × v) sin.
    const Vec3 a = normalize(of_moderate_size(axis));
    const double cosine = cosine_of_degrees(degrees), sine = sine_of_degrees(degrees);
    const auto turned = [&](const Vec3& v) {
      return cosine * v + sine * cross(a, v) + (1 - cosine) * dot(a, v) * a;
    };
    return {turned(x), turned(y), turned(z), turned(translation)};
  }

  /// Returns this map followed by a translation.
  [[nodiscard]] Affine moved_by(const Vec3& way) const { return {x, y, z, translation + way}; }
};

/// Returns center and radius of the image of a sphere under a map if it is exactly a sphere whose numbers are
/// doubles; else nothing.
[[nodiscard, gnu::cold, gnu::noinline]] inline std::optional<std::array<double, 4>> image_of_sphere(
    const Affine& map, const Point& center, double radius) {
  const ExactVector x = exact_vector(map.x), y = exact_vector(map.y), z = exact_vector(map.z);
  const ExactNumber square = dot(x, x), nothing(0);
  const bool is_similarity = dot(y, y) == square && dot(z, z) == square && dot(x, y) == nothing &&
                             dot(y, z) == nothing && dot(z, x) == nothing;
  if (!is_similarity) return std::nullopt;
  const double scale = static_cast<double>(sqrt(DoubleDouble(square)));
  if (!(ExactNumber(scale) * scale == square)) return std::nullopt;
  const ExactVector to = center.x * x + center.y * y + center.z * z + exact_vector(map.translation);
  const ExactNumber exact[] = {to[0], to[1], to[2], ExactNumber(scale) * radius};
  std::array<double, 4> image{};
  for (std::size_t i = 0; i < 4; ++i) {
    image[i] = static_cast<double>(DoubleDouble(exact[i]));
    if (!(ExactNumber(image[i]) == exact[i])) return std::nullopt;
  }
  return image;
}

/// Inverse of an affine map. The nine numbers of its linear part are rounded to the nearest doubles, and are
/// infinite for a singular map. Lines can also be mapped without rounding.
class AffineInverse {
 public:
  AffineInverse() = default;

  explicit AffineInverse(const Affine& map) : map_(map) {
    const Cofactors cofactors(map);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(k);
        rows_[i][k] = cofactors.determinant.sign() == 0
                          ? infinity
                          : detail::nearest_quotient(cofactors.rows[row][column], cofactors.determinant);
      }
    exists_ = is_finite(map.x) && is_finite(map.y) && is_finite(map.z) && is_finite(map.translation) &&
              is_finite(rows_[0]) && is_finite(rows_[1]) && is_finite(rows_[2]);
  }

  /// Returns true if the map has an inverse, and all numbers of both are finite: a precondition of all
  /// functions below but map().
  [[nodiscard]] bool exists() const { return exists_; }

  /// Returns the map that this is the inverse of.
  [[nodiscard]] const Affine& map() const { return map_; }

  /// Returns the preimage of a direction or of a point. Each component has an error of at most 4u or 5u,
  /// respectively, of the sum of the magnitudes of its terms (u = 2^-53).
  [[nodiscard]] Vec3 vector(const Vec3& v) const {
    return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)};
  }
  [[nodiscard]] Point point(const Point& p) const { return vector(p - map_.translation); }

  /// Maps a line by the inverse, in doubles.
  ///
  /// With u = 2^-53, an entry of the inverse has an error of u of itself, or of u · 2^-1022 if it is smaller
  /// than 2^-1022. The difference from the translation and each product add u each, and the sum 2u: together
  /// 5u of the magnitudes of the terms of the origin, and 4u of those of the direction. Errors of the given
  /// line are mapped as well. 5u and 4u of a number may underflow, by less than 2^-1022, before an entry
  /// multiplies them; 2^-1065 exceeds all other underflow, and the sums below are rounded by less than 2^-40.
  [[nodiscard]] RoundedLine line(const RoundedLine& from) const {
    const Vec3 away = from.origin - map_.translation;
    const Vec3 lost(0x1p-1022),
        origin_errors = 5 * 0x1p-53 * abs(away) + lost + from.origin_error,
        direction_errors = 4 * 0x1p-53 * abs(from.direction) + lost + from.direction_error;
    RoundedLine line{.origin = vector(away), .direction = vector(from.direction)};
    for (int i = 0; i < 3; ++i) {
      const Vec3 sizes = abs(rows_[i]) + Vec3(0x1p-1022);
      line.origin_error[i] = (1 + 0x1p-40) * dot(sizes, origin_errors) + 0x1p-1065;
      line.direction_error[i] = (1 + 0x1p-40) * dot(sizes, direction_errors) + 0x1p-1065;
    }
    return line;
  }

  /// Maps a line by the inverse without rounding. The cofactors are the inverse times the determinant, and
  /// the determinant goes into the weight.
  [[nodiscard, gnu::cold, gnu::noinline]] ExactLine line(const ExactLine& line) const {
    const Cofactors cofactors(map_);
    const ExactNumber sign = cofactors.determinant.sign();
    const auto mapped = [&](const ExactVector& v) {
      return sign *
             ExactVector{dot(cofactors.rows[0], v), dot(cofactors.rows[1], v), dot(cofactors.rows[2], v)};
    };
    return {.origin = mapped(line.origin - line.weight * exact_vector(map_.translation)),
            .direction = mapped(line.direction),
            .weight = line.weight * sign * cofactors.determinant};
  }

  /// Returns the normal of a surface's image, not of unit length. As n · p = n · inverse(q), it is the sum of
  /// the rows times the components of n.
  [[nodiscard]] Vec3 mapped_normal(const Vec3& n) const {
    return n.x * rows_[0] + n.y * rows_[1] + n.z * rows_[2];
  }

  /// Returns the equation of the image of the plane n · p = distance, rounded to nearest.
  [[nodiscard, gnu::cold, gnu::noinline]] PlaneEquation mapped_plane(const Vec3& n, double distance) const {
    // The equation n · inverse(q) = distance, times the determinant.
    const Cofactors cofactors(map_);
    const ExactVector normal = n.x * cofactors.rows[0] + n.y * cofactors.rows[1] + n.z * cofactors.rows[2];
    return detail::nearest_plane(
        normal, distance * cofactors.determinant + dot(normal, exact_vector(map_.translation)));
  }

 private:
  /// Rows of the inverse of the matrix (x y z) times its determinant: y × z, z × x and x × y.
  struct Cofactors {
    std::array<ExactVector, 3> rows;
    ExactNumber determinant;

    explicit Cofactors(const Affine& map) {
      const ExactVector x = exact_vector(map.x), y = exact_vector(map.y), z = exact_vector(map.z);
      rows = {cross(y, z), cross(z, x), cross(x, y)};
      determinant = dot(x, rows[0]);
    }
  };

  Affine map_;
  bool exists_ = true;
  Vec3 rows_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

}  // namespace protostar::inline PROTOSTAR_ABI

// Affine maps, which scale, rotate, shear and move, and their inverses.
#pragma once

#include <cmath>

#include "../vec3.hpp"
#include "plane_through.hpp"
#include "scale.hpp"
#include "trigonometry.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The map p → p.x · x + p.y · y + p.z · z + translation.
struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< where the unit vectors of the axes go
  Vec3 translation{0};                      ///< where the coordinate origin goes

  [[nodiscard]] Vec3 vector(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  [[nodiscard]] Point point(const Point& p) const { return vector(p) + translation; }

  // The same, and then one thing more: Affine{}.scaled_by({2, 1, 1}).rotated_about({0, 1, 0}, 30).

  [[nodiscard]] Affine scaled_by(const Vec3& factors) const {
    return {factors * x, factors * y, factors * z, factors * translation};
  }

  /// About an axis through the coordinate origin, of any length but 0: by 90 degrees about z, x goes to y.
  [[nodiscard]] Affine rotated_about(const Vec3& axis, double degrees) const {
    // Of v, the part along the unit vector a stays, and the rest turns in its plane:
    //   a (a·v) + (v − a (a·v)) cos + (a × v) sin.
    const Vec3 a = normalize(of_moderate_size(axis));
    const double cosine = cosine_of_degrees(degrees), sine = sine_of_degrees(degrees);
    const auto turned = [&](const Vec3& v) {
      return cosine * v + sine * cross(a, v) + (1 - cosine) * dot(a, v) * a;
    };
    return {turned(x), turned(y), turned(z), turned(translation)};
  }

  [[nodiscard]] Affine moved_by(const Vec3& way) const { return {x, y, z, translation + way}; }
};

/// The way back of an affine map, whose linear part is the three rows. Their nine numbers are the nearest
/// doubles, as long as the numbers of each of x, y and z differ by less than 2^300; they are infinite or NaN
/// for a map that has no way back.
class AffineInverse {
 public:
  AffineInverse() = default;

  explicit AffineInverse(const Affine& map) : translation_(map.translation) {
    // The rows of the inverse of the matrix (x y z) are y × z, z × x and x × y over its determinant. Powers
    // of two bring each column to about 1 before, and divide its row after.
    const int exponents[] = {exponent_of({map.x}), exponent_of({map.y}), exponent_of({map.z})};
    const ExactVector x = exact_vector(scaled(map.x, -exponents[0])),
                      y = exact_vector(scaled(map.y, -exponents[1])),
                      z = exact_vector(scaled(map.z, -exponents[2]));
    const ExactVector rows[] = {exact_cross(y, z), exact_cross(z, x), exact_cross(x, y)};
    const Expansion determinant = exact_dot(x, rows[0]);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const Expansion& cofactor = rows[i][static_cast<std::size_t>(k)];
        const double entry =
            determinant.sign() == 0 ? infinity : detail::nearest_quotient(cofactor, determinant);
        rows_[i][k] = std::ldexp(entry, -exponents[i]);
      }
  }

  [[nodiscard]] bool exists() const {
    return is_finite(rows_[0]) && is_finite(rows_[1]) && is_finite(rows_[2]) && is_finite(translation_);
  }

  /// Where a direction or a point came from: each component with an error of at most 4u, and 5u, of the sum
  /// of its terms' sizes.
  [[nodiscard]] Vec3 vector(const Vec3& v) const {
    return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)};
  }
  [[nodiscard]] Point point(const Point& p) const { return vector(p - translation_); }

  /// What the normals of a surface become when the surface is mapped: n · p = n · inverse(q), the rows' sum
  /// with the components of n. Not of unit length.
  [[nodiscard]] Vec3 mapped_normal(const Vec3& n) const {
    return n.x * rows_[0] + n.y * rows_[1] + n.z * rows_[2];
  }

 private:
  Vec3 rows_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 translation_{0};
};

}  // namespace protostar::inline PROTOSTAR_ABI

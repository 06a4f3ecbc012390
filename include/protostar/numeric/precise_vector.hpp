// Vectors of double-double numbers, for differences and products in which doubles would cancel. u = 2^-53.
#pragma once

#include <cmath>

#include "../vec3.hpp"
#include "double_double.hpp"
#include "scale.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Vector with components in double-double.
struct PreciseVector {
  DoubleDouble x, y, z;

  PreciseVector() = default;
  PreciseVector(DoubleDouble first, DoubleDouble second, DoubleDouble third)
      : x(first), y(second), z(third) {}
  explicit PreciseVector(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}

  /// Returns the component on axis i: 0 is x, 1 is y, 2 is z.
  [[nodiscard]] const DoubleDouble& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

  /// Returns the vector with each component rounded to double.
  [[nodiscard]] Vec3 rounded() const {
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
};

/// Returns (a − b) · 2^exponent without rounding, unless digits fall below 2^-1074.
[[nodiscard]] inline PreciseVector scaled_difference(const Point& a, const Point& b, int exponent) {
  const Point p = scaled(a, exponent), q = scaled(b, exponent);
  return {two_sum(p.x, -q.x), two_sum(p.y, -q.y), two_sum(p.z, -q.z)};
}

/// Vector times 2^exponent, where the vector is of moderate size, or 0.
struct ModerateVector {
  PreciseVector vector;
  int exponent = 0;

  ModerateVector() = default;
  explicit ModerateVector(const PreciseVector& v) : vector(v) {
    const Vec3 hi{v.x.hi, v.y.hi, v.z.hi};
    exponent = immoderate_exponent(hi);
    if (exponent == 0) return;
    const Vec3 high = scaled(hi, -exponent), low = scaled(Vec3{v.x.lo, v.y.lo, v.z.lo}, -exponent);
    vector = {{high.x, low.x}, {high.y, low.y}, {high.z, low.z}};
  }
};

[[nodiscard]] inline PreciseVector operator+(const PreciseVector& a, const PreciseVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] inline PreciseVector operator*(DoubleDouble a, const PreciseVector& b) {
  return {a * b.x, a * b.y, a * b.z};
}
[[nodiscard]] inline PreciseVector operator-(const PreciseVector& a) { return {-a.x, -a.y, -a.z}; }

/// Returns a · b with an error below 14u² |a| |b|.
[[nodiscard]] inline DoubleDouble dot(const PreciseVector& a, const PreciseVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Returns a · b with an error below 40u² |a| |b|, in a third of the time of dot: the sums of the products'
/// upper halves are exact as two doubles, and the rest is summed in double (Ogita, Rump and Oishi 2005). Of a
/// product, lo · lo is left out, and two terms of at most u |a_i b_i| are rounded thrice: 5u² |a_i b_i|. The
/// rest has eight terms with a sum below 8u |a| |b|, and its four sums add less than 32u² |a| |b|. The vector
/// a may be one in each lane.
[[nodiscard]] inline auto compensated_dot(const auto& a, const PreciseVector& b) {
  const auto x = two_product(a.x.hi, b.x.hi), y = two_product(a.y.hi, b.y.hi),
             z = two_product(a.z.hi, b.z.hi);
  const auto xy = two_sum(x.hi, y.hi), xyz = two_sum(xy.hi, z.hi);
  const auto rest = [](const auto& p, const DoubleDouble& q, const auto& lo) {
    using std::fma;
    return fma(p.hi, q.lo, fma(p.lo, q.hi, lo));
  };
  return two_sum(xyz.hi,
                 rest(a.x, b.x, x.lo) + rest(a.y, b.y, y.lo) + rest(a.z, b.z, z.lo) + (xy.lo + xyz.lo));
}

/// Returns a × b with an error below 14u² |a| |b|.
[[nodiscard]] inline PreciseVector cross(const PreciseVector& a, const PreciseVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

[[nodiscard]] inline DoubleDouble length(const PreciseVector& a) { return sqrt(dot(a, a)); }

}  // namespace protostar::inline PROTOSTAR_ABI

// Where light comes from.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A light that shines from one point alike in all directions (§2.3.2, A.1.4).
struct PointLight {
  Point position{0};
  Color power{0};  ///< Φ, the flux per channel, in watts; not negative. The tutorial calls it intensity.

  /// The irradiance that the light, unhindered, brings to a point with this unit normal:
  ///   E = Φ/(4π) · cos θ / r² = Φ/(4π) · n·l / |l|³   with l = position − point;
  /// 0 where the light is behind the surface, and where it lies in it. Very near the light it grows beyond
  /// all bounds; the factor of the power is held at the largest float.
  template <class V = Vec3>
  [[nodiscard]] auto irradiance(const V& point, const V& normal) const {
    using std::min, std::sqrt;
    const V l = position - point;
    const auto height = dot(normal, l);
    const auto r2 = dot(l, l);
    const auto factor = height / (4 * std::numbers::pi * r2 * sqrt(r2));
    const double largest = std::numeric_limits<float>::max();
    return power * to_float(select(height > 0.0, min(factor, largest), 0.0));
  }

  /// Throws std::invalid_argument if the position is not finite, or the power is negative or not finite.
  void validate() const {
    if (!is_finite(position)) throw std::invalid_argument("PointLight: position must be finite");
    if (!is_light(power)) throw std::invalid_argument("PointLight: power must be finite and not negative");
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

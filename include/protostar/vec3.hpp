// Points, directions and colors: the tutorial's vec3 (§2.2.1), which here is GLM's.
//
// Geometry is double, color is float. GLM brings the operators of §2.2.1, componentwise and with a scalar,
// and dot(u, v), cross(u, v), length(v) and normalize(v), which are found without a prefix.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A direction or a difference of points, in scene units.
using Vec3 = glm::dvec3;

/// A place, in scene units.
using Point = Vec3;

/// Red, green and blue: linear light, or the share of light that a surface reflects. 0 is black; there is no
/// upper limit.
using Color = glm::vec3;

/// A place on a surface, in the surface's own coordinates u and v, which are x and y of this.
using Uv = glm::dvec2;

/// Whether no component is infinite or not a number.
inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline bool is_finite(const Uv& uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); }

/// Whether every channel is a finite number and none is negative: what a power or a surface's color has to
/// be.
inline bool is_light(const Color& c) {
  return c.r >= 0 && c.g >= 0 && c.b >= 0 && std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

/// Light with each channel held at the largest float: products and sums of finite light may be infinite.
[[nodiscard]] inline Color held(const Color& light) {
  constexpr float most = std::numeric_limits<float>::max();
  return {std::min(light.r, most), std::min(light.g, most), std::min(light.b, most)};
}

// What is written for one ray is written for several at once as well, with a number, a vector or an answer
// for each of them (accel/packet.hpp). Where a number is converted or a choice is made, both say it in these
// words.

/// a if so, otherwise b.
template <class T>
[[nodiscard]] constexpr T select(bool so, const T& a, const T& b) {
  return so ? a : b;
}

/// Whether any answer is yes: here, the only one.
[[nodiscard]] constexpr bool any(bool answer) { return answer; }

/// Whether a color is black, and adds nothing.
[[nodiscard]] inline bool is_black(const Color& c) { return c == Color{0}; }

/// f of each number: here, of the only one.
[[nodiscard]] double of_each(double x, const auto& f) { return f(x); }

/// A place on a surface; 0 for a coordinate that is not a number or beyond 2^500, as the digits of a point on
/// a very thin triangle may give it.
[[nodiscard]] inline Uv uv_of(double u, double v) {
  return {std::abs(u) < 0x1p500 ? u : 0, std::abs(v) < 0x1p500 ? v : 0};
}

/// The nearest float.
[[nodiscard]] constexpr float to_float(double x) { return static_cast<float>(x); }

}  // namespace protostar::inline PROTOSTAR_ABI

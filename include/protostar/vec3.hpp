// Points, directions and colors: the tutorial's vec3 (§2.2.1), here GLM's.
//
// Geometry is double, color is float. GLM provides the operators of §2.2.1, componentwise and with a scalar,
// and dot(u, v), cross(u, v), length(v) and normalize(v), which are found without a prefix.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <type_traits>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Direction or difference of points, in scene units.
using Vec3 = glm::dvec3;

/// Point, in scene units.
using Point = Vec3;

/// Red, green and blue: linear light, or the share of light that a surface reflects. 0 is black; there is no
/// upper limit.
using Color = glm::vec3;

// Options of GLM, which a program may set, change its vectors.
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Color) == 3 * sizeof(float),
              "protostar needs vectors of three numbers: GLM_FORCE_DEFAULT_ALIGNED_GENTYPES gives them room "
              "for four");
static_assert(
    std::is_trivially_copyable_v<Vec3> && std::is_trivially_copyable_v<Color>,
    "protostar copies vectors byte by byte: with GLM_FORCE_CTOR_INIT they have copy constructors of "
    "their own");

/// Point of a surface in its own coordinates: x holds u, and y holds v.
using Uv = glm::dvec2;

/// Returns the magnitudes of the components, each by one instruction; glm::abs compares and chooses.
[[nodiscard, gnu::always_inline]] inline Vec3 abs(const Vec3& v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

/// Returns true if no component is infinite or NaN.
inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline bool is_finite(const Uv& uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); }

/// Returns a copy of a vector, made number by number. g++ copies vectors by 16 bytes, and a processor waits
/// some 15 cycles for bytes that it has just stored as two numbers; this is for vectors that have just been
/// computed.
[[nodiscard]] inline Vec3 copied(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Returns a vector with each component clamped to [-most, most].
[[nodiscard]] inline Vec3 within(const Vec3& v, double most) {
  return {std::clamp(v.x, -most, most), std::clamp(v.y, -most, most), std::clamp(v.z, -most, most)};
}

/// Returns true if every channel is finite and not negative, as a power or a surface's color has to be.
inline bool is_light(const Color& c) {
  return c.r >= 0 && c.g >= 0 && c.b >= 0 && std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

/// Returns light with each channel clamped to the largest float: products and sums of finite light may be
/// infinite. It is inlined, as a call returns numbers that have just been stored (copied).
[[nodiscard, gnu::always_inline]] inline Color clamped(const Color& light) {
  constexpr float most = std::numeric_limits<float>::max();
  return {std::min(light.r, most), std::min(light.g, most), std::min(light.b, most)};
}

// Code that is written for one ray is compiled for packets as well, with a number, a vector or a truth value
// in each lane (accel/packet.hpp). The functions below convert and choose in both.

/// Returns a if so, otherwise b.
template <class T>
[[nodiscard]] constexpr T select(bool so, const T& a, const T& b) {
  return so ? a : b;
}

/// Returns true if the answer is true; for a packet, if that of any lane is.
[[nodiscard]] constexpr bool any(bool answer) { return answer; }

/// Returns true if a color is black, and adds nothing.
[[nodiscard]] inline bool is_black(const Color& c) { return c == Color{0}; }

/// Returns f(x); for a packet, f of each lane.
[[nodiscard]] double of_each(double x, const auto& f) { return f(x); }

/// Returns a point in surface coordinates; a coordinate that is NaN or not within 2^500, as the digits of a
/// point on a very thin triangle may give it, becomes 0.
[[nodiscard]] inline Uv uv_of(double u, double v) {
  return {std::abs(u) < 0x1p500 ? u : 0, std::abs(v) < 0x1p500 ? v : 0};
}

/// Returns the nearest float.
[[nodiscard]] constexpr float to_float(double x) { return static_cast<float>(x); }

}  // namespace protostar::inline PROTOSTAR_ABI

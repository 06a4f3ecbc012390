// How large and how small the numbers of a scene may be.
//
// One rule holds for all numbers that place or measure something in a scene, and with it no formula of a
// picture leaves the range of double, which ends near 2^±1024 (docs/numerics.md, Range). What is made for a
// scene is refused by its validate() where it breaks the rule.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The largest magnitude of a coordinate, about 2.6e120 scene units: in metres, the universe is 2^90 wide.
inline constexpr double most_coordinate = 0x1p400;

/// The smallest of what has to be above 0, as a radius, about 3.9e-121 scene units. Squares of it and of
/// quotients with it are still double numbers.
inline constexpr double least_size = 0x1p-400;

/// Points farther along a ray than this t, about 2.8e132 for a unit direction, are taken to be at it. So the
/// points that a path of 1000 rays leads to have coordinates below 2^451, and the largest that is made of
/// them, products with coordinates, quotients with sizes, and squares of distances, is below 2^907.
inline constexpr double farthest_point = 0x1p440;

/// The rule in the words of error messages.
inline constexpr const char* coordinate_rule = "at most 2^400 (2.6e120) in magnitude";
inline constexpr const char* size_rule = "from 2^-400 (3.9e-121) to 2^400 (2.6e120)";

namespace detail {

[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_by_rule(const char* what, const char* rule) {
  throw std::invalid_argument(std::string(what).append(" ").append(rule));
}

}  // namespace detail

/// Tests that a number, or each component of a vector, is within ±most_coordinate.
[[nodiscard]] inline bool is_coordinate(double x) { return std::abs(x) <= most_coordinate; }
[[nodiscard]] inline bool is_coordinate(const Vec3& v) {
  return is_coordinate(v.x) && is_coordinate(v.y) && is_coordinate(v.z);
}
[[nodiscard]] inline bool is_coordinate(const Uv& uv) { return is_coordinate(uv.x) && is_coordinate(uv.y); }

/// Whether a number may be a size, which is above 0.
[[nodiscard]] inline bool is_size(double x) { return least_size <= x && x <= most_coordinate; }

/// Throws std::invalid_argument, which says what must be as a rule says, unless it holds.
inline void require_rule(bool holds, const char* what, const char* rule) {
  if (!holds) [[unlikely]]
    detail::refuse_by_rule(what, rule);
}

/// A vector with each component held between -most and most.
[[nodiscard]] inline Vec3 within(const Vec3& v, double most) {
  return {std::clamp(v.x, -most, most), std::clamp(v.y, -most, most), std::clamp(v.z, -most, most)};
}

}  // namespace protostar::inline PROTOSTAR_ABI

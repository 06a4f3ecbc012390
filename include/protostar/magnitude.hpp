// Limits for the magnitudes of the numbers of a scene.
//
// One rule holds for all numbers that place or measure something in a scene, and with it no formula of a
// picture leaves the range of double, which ends near 2^±1024 (docs/derivations.md, Range). The validate() of
// each type made for a scene refuses numbers that break the rule.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "shown.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Largest magnitude of a coordinate, about 2.6e120 scene units: in meters, the universe is 2^90 wide.
inline constexpr double most_coordinate = 0x1p400;

/// Smallest number that must be above 0, such as a radius, about 3.9e-121 scene units. Its square, and
/// quotients with it, are still in the range of double.
inline constexpr double least_size = 0x1p-400;

/// Largest t of a point on a ray, about 2.8e132 for a unit direction: points farther along it are taken to be
/// there. Hence the points of a path of 1000 rays have coordinates below 2^451, and the largest numbers made
/// of them, products with coordinates, quotients with sizes, and squares of distances, are below 2^907.
inline constexpr double most_t = 0x1p440;

/// Wording of the rule for error messages.
inline constexpr const char* coordinate_rule = "at most 2^400 (2.6e120) in magnitude";
inline constexpr const char* size_rule = "from 2^-400 (3.9e-121) to 2^400 (2.6e120)";

namespace detail {

[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_by_rule(const char* what, const char* rule) {
  throw std::invalid_argument(std::string(what).append(" ").append(rule));
}

/// Throws std::invalid_argument with the text "rule; it is found", where found is a number or three.
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_found(std::string rule, double found) {
  throw std::invalid_argument(rule.append("; it is ").append(shown(found)));
}
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_found(std::string rule, const Vec3& found) {
  throw std::invalid_argument(rule + "; it is (" + shown(found.x) + ", " + shown(found.y) + ", " +
                              shown(found.z) + ")");
}

}  // namespace detail

/// Tests whether a number, or each component of a vector, is within ±most_coordinate.
[[nodiscard]] inline bool is_coordinate(double x) { return std::abs(x) <= most_coordinate; }
[[nodiscard]] inline bool is_coordinate(const Vec3& v) {
  return is_coordinate(v.x) && is_coordinate(v.y) && is_coordinate(v.z);
}
[[nodiscard]] inline bool is_coordinate(const Uv& uv) { return is_coordinate(uv.x) && is_coordinate(uv.y); }

/// Tests whether a number may be a size: from least_size to most_coordinate.
[[nodiscard]] inline bool is_size(double x) { return least_size <= x && x <= most_coordinate; }

/// Throws std::invalid_argument with the text "what rule" unless holds is true.
inline void require_rule(bool holds, const char* what, const char* rule) {
  if (!holds) [[unlikely]]
    detail::refuse_by_rule(what, rule);
}

/// Throws std::invalid_argument with the text "what rule; it is found" unless a number is a size, or a
/// number or a vector is within the coordinates.
inline void require_size(double found, const char* what) {
  if (!is_size(found)) [[unlikely]]
    detail::refuse_found(std::string(what).append(" ").append(size_rule), found);
}
void require_coordinate(const auto& found, const char* what) {
  if (!is_coordinate(found)) [[unlikely]]
    detail::refuse_found(std::string(what).append(" ").append(coordinate_rule), found);
}

/// Calls validate() of each part that has one, as of the fields and the rule of an operation.
void validate_each(const auto&... parts) {
  const auto validate = [](const auto& part) {
    if constexpr (requires { part.validate(); }) part.validate();
  };
  (validate(parts), ...);
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Environments: the radiance from all directions, as a function of the direction.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
#include <numbers>
#include <type_traits>
#include <utility>
#include <vector>

#include "image.hpp"
#include "material.hpp"
#include "numeric/radians.hpp"
#include "surfaces/coordinates.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns u and v of a unit direction for an environment (direction_uv). Straight down v is 1, where a
/// texture that repeats begins anew: it is the v just before.
[[nodiscard]] inline Uv environment_uv(const Vec3& direction) {
  const Uv uv = direction_uv(direction);
  return {uv.x, std::min(uv.y, 1 - 0x1p-53)};
}

/// Radiance of rays that hit nothing: any function of the unit direction, or of its u and v (environment_uv),
/// as images are. A function of the direction needs no angles, and takes a tenth of the time. It is called
/// from several threads at once.
class Environment {
 public:
  Environment() = default;

  template <std::invocable<const Vec3&> F>
  requires(!std::same_as<F, Environment>) Environment(F function) : by_direction_(std::move(function)) {}

  template <std::invocable<double, double> F>
  Environment(F function) : by_uv_(std::move(function)) {}

  /// Returns true if there is a function.
  [[nodiscard]] explicit operator bool() const { return by_direction_ || by_uv_; }

  /// Returns the radiance from a unit direction. Precondition: there is a function.
  [[nodiscard]] Color operator()(const Vec3& direction) const {
    if (by_direction_) return by_direction_(direction);
    const Uv uv = environment_uv(direction);
    return by_uv_(uv.x, uv.y);
  }

  /// Returns an image of the radiance in the middle of each cell of a grid over u and v. Precondition: there
  /// is a function. Sine and cosine of an angle are computed once for a column or row.
  [[nodiscard]] Image image(int columns, int rows) const {
    const auto middle = [](int cell, int cells) { return (cell + 0.5) / cells; };
    std::vector<SineCosine> longitudes;
    for (int x = 0; x < columns; ++x)
      longitudes.push_back(sine_and_cosine(2 * std::numbers::pi * (middle(x, columns) - 0.5)));
    Image image(columns, rows);
    for (int y = 0; y < rows; ++y) {
      const double v = middle(y, rows);
      const auto [side, up] = sine_and_cosine(std::numbers::pi * v);
      for (int x = 0; x < columns; ++x) {
        const auto& [around_x, around_z] = longitudes[static_cast<std::size_t>(x)];
        image(x, y) = by_uv_ ? by_uv_(middle(x, columns), v)
                             : by_direction_(Vec3{side * around_x, up, side * around_z});
      }
    }
    return image;
  }

  /// Returns the function of u and v; empty if it is one of the direction.
  [[nodiscard]] const Texture& by_uv() const { return by_uv_; }

  /// Returns the function of the direction; empty if it is one of u and v.
  [[nodiscard]] const std::function<Color(const Vec3& direction)>& by_direction() const {
    return by_direction_;
  }

 private:
  std::function<Color(const Vec3& direction)> by_direction_;
  Texture by_uv_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

// The light of the environment, prepared for drawing directions to where it is bright.
//
// A small sun in an image is a light like any other, but no surface: directions that surfaces draw by
// themselves hardly ever lead to it. Here each pixel of the image is a cell of directions, chosen with a
// probability in proportion to the light that comes from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "environment.hpp"
#include "environment_image.hpp"
#include "light.hpp"
#include "numeric/radians.hpp"
#include "numeric/trigonometry.hpp"
#include "sampling/shares.hpp"
#include "sampling/warp.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Density of directions by the light that a scene's environment or sky sends from there. It is made once for
/// a picture, and valid as long as the scene has no other environment. Threads may share it.
///
/// The density of an EnvironmentImage is uniform by solid angle in the cell of a pixel, and the cell's
/// probability is in proportion to the integral over its u and v of the mixed colors, times its solid angle.
/// A pixel counts ¾ along each axis in its own cell and ⅛ in each neighbor, so that no direction from which
/// light comes is left out. A pixel with a channel that is negative or not finite counts as black. Any other
/// function is looked at in the middle of each cell of a grid; it may be bright between, so an eighth of all
/// directions are drawn as if it were the same everywhere.
///
/// A sky, and an environment that is nearly even, has no place that is better than others: a surface draws
/// directions by the cosine to its normal as well. Let L be the light by direction and ⟨⟩ a mean over the
/// sphere. An estimate of the irradiance over π has the mean square ∫ cos⁺ L²/π by the cosine, and 4⟨L⟩ ∫
/// (cos⁺)² L/π by the light, with the density L/(4π⟨L⟩). Over all normals, cos⁺ is ¼ and its square 1/6 on
/// average: that makes ⟨L²⟩ and 8/3 ⟨L⟩². The cosine is as good up to ⟨L²⟩ = 8/3 ⟨L⟩², and paths then need no
/// ray for the environment alone.
class EnvironmentLight {
 public:
  /// Cells of the grid for a function that is no image.
  static constexpr int columns_of_function = 256, rows_of_function = 128;

  /// Prepares the environment of a scene, or of a view of one. Directions are not drawn to a sky, nor without
  /// an environment.
  template <class S>
  explicit EnvironmentLight(const S& scene);

  /// Throws std::logic_error if a scene has been given another environment than it had when this was made. A
  /// view of a scene that does not tell, by environment_version(), is taken for the one that it had. A sky
  /// may change: no direction is better than others, before or after.
  void require(const auto& scene) const {
    if constexpr (requires { scene.environment_version(); })
      if (scene.environment_version() != environment_version_) [[unlikely]]
        throw std::logic_error(
            "EnvironmentLight: the scene has been given another environment since it was made; make it "
            "again");
  }

  /// Returns true if some directions are better than others; only then they are drawn, and have a density.
  [[nodiscard]] bool has_places() const { return !heights_.empty(); }

  /// Draws a direction with two numbers from [0, 1). Precondition: has_places().
  [[nodiscard]] DirectionAndDensity sample(double u, double v) const {
    const auto [column, row, probability, x, y] = cells_.choose(u, v);
    const double height = heights_[row] + y * (heights_[row + 1] - heights_[row]);
    const double turn = (static_cast<double>(column) + x) / columns_ - 0.5;
    const auto [sine, cosine] = sine_and_cosine(2 * std::numbers::pi * turn);
    const double r = std::sqrt(height * (2 - height));
    return {{r * sine, 1 - height, r * cosine}, probability / solid_angle(row)};
  }

  /// Returns the density, in 1/steradian, with which sample draws a unit direction. Precondition:
  /// has_places().
  [[nodiscard]] double density(const Vec3& direction) const {
    const double height = 1 - direction.y,
                 turn = polar_angle(direction.x, direction.z) / (2 * std::numbers::pi);
    const auto end = std::upper_bound(heights_.begin() + 1, heights_.end() - 1, height);
    const auto row = static_cast<std::size_t>(end - heights_.begin()) - 1;
    const auto column = std::clamp(static_cast<int>((turn + 0.5) * columns_), 0, columns_ - 1);
    return cells_.probability(static_cast<std::size_t>(column), row) / solid_angle(row);
  }

 private:
  /// Returns the light of a pixel, the sum of its channels; 0 if one of them is negative or not finite.
  static double light_of(const Color& c) { return is_light(c) ? double{c.r} + c.g + c.b : 0; }

  /// Makes the cells of an image. `even` is the light that is added everywhere, as a share of the mean.
  void use(const Image& image, double even) {
    const int w = image.width(), h = image.height();
    columns_ = w;
    heights_.resize(static_cast<std::size_t>(h) + 1);
    for (int y = 0; y <= h; ++y) {
      const double sine = sine_of_degrees(90.0 * y / h);  // 1 − cos θ = 2 sin² θ/2
      heights_[static_cast<std::size_t>(y)] = 2 * sine * sine;
    }
    double mean_light = 0, mean_square = 0;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const double light = light_of(image(x, y)),
                     share = solid_angle(static_cast<std::size_t>(y)) / (4 * std::numbers::pi);
        mean_light += share * light, mean_square += share * light * light;
      }
    const bool may_hide_light = even != 0 && !(mean_light > 0);  // a function may be bright elsewhere
    if (mean_square <= 8 / 3.0 * mean_light * mean_light && !may_hide_light) {
      heights_.clear();
      return;
    }
    const auto light = [&](int x, int y) {
      const auto across = [&](int row) {
        const auto at = [&](int column) {
          return light_of(image((column + w) % w, std::clamp(row, 0, h - 1)));
        };
        return 0.125 * at(x - 1) + 0.75 * at(x) + 0.125 * at(x + 1);
      };
      return (0.125 * across(y - 1) + 0.75 * across(y) + 0.125 * across(y + 1)) *
             solid_angle(static_cast<std::size_t>(y));
    };
    cells_ = GridShares(w, h, light);
    if (even == 0) return;
    const double mean = cells_.whole() > 0 ? cells_.whole() / (4 * std::numbers::pi) * even : 1;
    cells_ = GridShares(
        w, h, [&](int x, int y) { return light(x, y) + mean * solid_angle(static_cast<std::size_t>(y)); });
  }

  /// Returns the solid angle of each cell of a row, in steradians.
  [[nodiscard]] double solid_angle(std::size_t row) const {
    return 2 * std::numbers::pi / columns_ * (heights_[row + 1] - heights_[row]);
  }

  std::size_t environment_version_ = 0;
  int columns_ = 1;
  std::vector<double> heights_;  ///< 1 − cos θ at the edges of rows, θ from straight up; empty without cells
  GridShares cells_;
};

// Not inline, so that programs may compile it once for a scene type: `extern template`.
template <class S>
EnvironmentLight::EnvironmentLight(const S& scene) {
  if constexpr (requires { scene.environment_version(); }) environment_version_ = scene.environment_version();
  if constexpr (requires { scene.environment(); }) {
    const Environment& environment = scene.environment();
    if (!environment) return;
    if (const auto* shown = environment.by_uv().template target<EnvironmentImage>())
      use(*shown->image, 0);
    else
      use(environment.image(columns_of_function, rows_of_function), 1 / 7.0);
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI

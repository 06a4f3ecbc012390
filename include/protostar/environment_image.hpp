// An image as an environment: the radiance from all directions, by longitude and latitude.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "shared_image.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Texture that shows an image of all directions, which its copies share: an environment. u goes around the
/// image, v from the top row to the bottom row. Between the centers of four pixels, their colors are mixed.
struct EnvironmentImage {
  SharedImage image;
  std::string file = {};  ///< path of the image's file, which explanations name; empty if unknown

  [[nodiscard]] Color operator()(double u, double v) const {
    const auto across = between((u - std::floor(u)) * image->width() - 0.5);
    const auto down = between(std::clamp(v, 0.0, 1.0) * image->height() - 0.5);
    const auto row = [&](int y) {
      const int left = (across.first + image->width()) % image->width(), right = (left + 1) % image->width();
      const int inside = std::clamp(y, 0, image->height() - 1);
      return mixed((*image)(left, inside), (*image)(right, inside), across.share);
    };
    return Color{mixed(row(down.first), row(down.first + 1), down.share)};
  }

 private:
  /// Two neighboring pixels, the first by its index, and the share of the second.
  struct Neighbors {
    int first;
    double share;
  };

  /// Returns the neighbors between whose centers a place is, in pixels from the first center; the first pixel
  /// for NaN.
  static Neighbors between(double place) {
    if (std::isnan(place)) return {0, 0};
    const double first = std::floor(place);
    return {static_cast<int>(first), place - first};
  }

  static Vec3 mixed(const auto& a, const auto& b, double share) {
    return (1 - share) * Vec3(a) + share * Vec3(b);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

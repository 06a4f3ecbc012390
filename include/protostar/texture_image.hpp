// Images as textures and as normal maps, by the coordinates u and v of a surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "shared_image.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Texture that shows an image, which its copies share. The image lies on 0 ≤ u < size_u and 0 ≤ v < size_v,
/// with its left edge at u = 0 and its top row at v = 0, and repeats in both directions. A point has the
/// color of the pixel that contains it, without interpolation.
struct ImageTexture {
  SharedImage image;
  double size_u = 1, size_v = 1;  ///< in units of u and v; sizes (magnitude.hpp)
  std::string file = {};          ///< path of the image's file, which explanations name; empty if unknown

  [[nodiscard]] Color operator()(double u, double v) const { return (*image)(column_at(u), row_at(v)); }

  /// Returns the column of the pixel at u, or the row of the one at v.
  [[nodiscard]] int column_at(double u) const { return pixel(u / size_u, image->width()); }
  [[nodiscard]] int row_at(double v) const { return pixel(v / size_v, image->height()); }

 private:
  /// Returns the index of the pixel that contains x, if `count` pixels fill 0 to 1 and repeat; 0 for NaN.
  static int pixel(double x, int count) {
    const double place = (x - std::floor(x)) * count;
    // For x a little below 0, x − floor(x) may be rounded to 1, past the last pixel.
    return place > 0 ? std::min(static_cast<int>(place), count - 1) : 0;
  }
};

/// Normal map that takes its directions from an image, which its copies share, and which lies on the surface
/// as that of an ImageTexture does. A pixel's red, green and blue, from 0 to 1, stand for the direction
/// (2r − 1, 2g − 1, 2b − 1). Hence ½ is no tilt, and no number of 8 bits is ½: 127/255 and 128/255 tilt by
/// 0.2 degrees to either side.
struct ImageNormalMap {
  ImageTexture colors;

  [[nodiscard]] Vec3 operator()(double u, double v) const { return 2.0 * Vec3(colors(u, v)) - 1.0; }
};

}  // namespace protostar::inline PROTOSTAR_ABI

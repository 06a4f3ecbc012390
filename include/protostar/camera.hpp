// The camera: which ray leads through which point of the film (§2.2.3).
#pragma once

#include <cmath>
#include <stdexcept>

#include "ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A pinhole at position. The film stands at forward's tip, spanned by right and up, so that forward's length
/// is the focal length. The default is the tutorial's camera: at the origin, x to the right, y up, looking
/// along z.
struct Camera {
  Point position{0};
  Vec3 right{1, 0, 0};
  Vec3 up{0, 1, 0};
  Vec3 forward{0, 0, 1};

  /// The ray through the film at u · right + v · up, its direction of unit length.
  [[nodiscard]] Ray operator()(double u, double v) const {
    return {position, normalize(u * right + v * up + forward)};
  }

  /// The ray through the center of pixel (x, y), with (0, 0) at the top left, of an image of width × height
  /// pixels: u runs over [−width/height, width/height] from left to right, v over [1, −1] from top to bottom.
  [[nodiscard]] Ray through_pixel(int x, int y, int width, int height) const {
    const double aspect = static_cast<double>(width) / height;
    return (*this)(aspect * (2 * (x + 0.5) / width - 1), 1 - 2 * (y + 0.5) / height);
  }

  /// Throws std::invalid_argument if a number is not finite, or if the three directions do not span space:
  /// one is 0, two are parallel, or all lie in a plane.
  void validate() const {
    if (!is_finite(position) || !is_finite(right) || !is_finite(up) || !is_finite(forward))
      throw std::invalid_argument("Camera: position, right, up and forward must be finite");
    // The volume that the directions span is a sum of six products. Each passes at most five roundings, of
    // 2^-53 of its size, so a volume above 2^-50 of the sum of the sizes is truly not 0. Products that leave
    // the range of double make the comparison false and are refused as well.
    const double volume = dot(cross(right, up), forward);
    const Vec3 r = abs(right), u = abs(up), f = abs(forward);
    const double sizes = dot(Vec3{r.y * u.z + r.z * u.y, r.z * u.x + r.x * u.z, r.x * u.y + r.y * u.x}, f);
    if (!(std::abs(volume) > 0x1p-50 * sizes && std::isfinite(sizes)))
      throw std::invalid_argument("Camera: right, up and forward must not be zero, parallel or in one plane");
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

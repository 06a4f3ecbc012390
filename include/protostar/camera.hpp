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
  [[nodiscard]] Ray operator()(double u, double v) const { return {position, direction(u * right, v * up)}; }

  /// The ray through the center of pixel (x, y), with (0, 0) at the top left, of an image of width × height
  /// pixels.
  [[nodiscard]] Ray through_pixel(int x, int y, int width, int height) const {
    return (*this)(u_at(x + 0.5, width, height), v_at(y + 0.5, height));
  }

  /// Where a place on an image is on the film, x and y in pixels from the top left: u runs over
  /// [−width/height, width/height] from left to right, v over [1, −1] from top to bottom.
  [[nodiscard]] static double u_at(double x, int width, int height) {
    return static_cast<double>(width) / height * (2 * x / width - 1);
  }
  [[nodiscard]] static double v_at(double y, int height) { return 1 - 2 * y / height; }

  /// The unit direction to the film at u · right + v · up, given these; a vector, or several at once.
  template <class V>
  [[nodiscard]] V direction(const V& u_right, const V& v_up) const {
    using std::sqrt;
    const V towards = u_right + v_up + forward;
    return towards * (1 / sqrt(dot(towards, towards)));
  }

  /// Throws std::invalid_argument if a number is not finite, if the length of a direction is not between
  /// 2^-400 and 2^400 (about 10^±120), or if the three directions do not span space: two are parallel, or all
  /// lie in a plane.
  void validate() const {
    if (!is_finite(position) || !is_finite(right) || !is_finite(up) || !is_finite(forward))
      throw std::invalid_argument("Camera: position, right, up and forward must be finite");
    // Within these lengths no product of three leaves the range of double, nor does the square of a ray's
    // direction.
    const auto has_length = [](const Vec3& v) { return 0x1p-800 < dot(v, v) && dot(v, v) < 0x1p800; };
    if (!has_length(right) || !has_length(up) || !has_length(forward))
      throw std::invalid_argument(
          "Camera: right, up and forward must not be zero, nor shorter than 2^-400 or longer "
          "than 2^400");
    // Of unit length, the directions span a volume that is a sum of six products. Each passes at most
    // fourteen roundings, of 2^-53 of its size, so that a volume above 2^-49 of the sum of the sizes is truly
    // not 0.
    const Vec3 r = normalize(right), u = normalize(up), f = normalize(forward);
    const Vec3 a = abs(r), b = abs(u), c = abs(f);
    const double volume = dot(cross(r, u), f);
    const double sizes = dot(Vec3{a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x}, c);
    if (!(std::abs(volume) > 0x1p-49 * sizes))
      throw std::invalid_argument("Camera: right, up and forward must not be parallel or in one plane");
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI

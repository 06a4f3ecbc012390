// The point from which culling looks at surfaces, for cameras whose rays start at one point, on a film or on
// a lens, at rest or in motion.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "../camera.hpp"
#include "../pixel_grid.hpp"
#include "../simd/simd.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Origin of the rays of a picture, as culling uses it.
struct Viewpoint {
  /// Point from which centers are measured. Each ray, shifted by at most drift, is a part of a ray from here,
  /// unless rays are parallel.
  Point apex;
  double drift = 0;
  bool is_pinhole = false;  ///< true if all rays start at the apex

  /// Radius of a lens around the apex, in the plane of the film, and the distance of the plane in focus from
  /// it. The part of a ray at another distance is shifted by up to drift_of_lens besides.
  double lens_radius = 0, focus_depth = 1;

  /// Point and unit normal of the plane on which all rays start, up to drift; they lead to the side of the
  /// normal. A normal that is not certain is 0.
  Point film{0};
  Vec3 ahead{0};

  /// Returns how far the ray through the center of a lens may be from a ray through another point l of it,
  /// for the same point of the film, wherever that meets a sphere of a given radius whose center is at a
  /// depth before the film and a distance from the apex.
  ///
  /// At t, the rays are at position + t d and position + l + t (d − l/s), which differ by l (1 − t/s) and are
  /// at the same depth z. With the depth in focus, t/s = z/focus, and among the depths of a sphere |1 −
  /// z/focus| is largest at an end. z and focus are accurate to 2^-26 of the distance and 2^-20 of itself,
  /// for which 2^-19 of the distances over focus are added. Without a certain depth the rays may be anywhere.
  [[nodiscard]] Doubles drift_of_lens(const Doubles& depth, const Doubles& distance,
                                      const Doubles& radius) const {
    if (ahead == Vec3{0}) return std::numeric_limits<double>::infinity();
    const auto blur = [&](const Doubles& z) { return abs(1.0 - z / focus_depth); };
    return lens_radius * (max(blur(max(depth - radius, Doubles(0.0))), blur(depth + radius)) +
                          0x1p-19 * (1.0 + (distance + radius) / focus_depth));
  }
};

namespace detail {

/// Returns the unit vector along the normal of the film, or 0 if rays between the corners, which are the sums
/// of forward and of ±across and ±upwards, are not certain to lead to its side. Rounding turns rays by less
/// than 2^-25, well below 2^-20.
[[nodiscard, gnu::cold]] inline Vec3 ahead_of(const Vec3& forward, const Vec3& across, const Vec3& upwards,
                                              const Vec3& normal) {
  double least = 1;  // smallest product of normal and a ray's unit direction
  for (const Vec3& a : {across, -across})
    for (const Vec3& b : {upwards, -upwards}) {
      const Vec3 d = forward + a + b;
      least = std::min(least, dot(normal, d) / length(d));
    }
  return length(normal) > 0x1p-24 && least > 0x1p-20 * length(normal) ? normalize(normal) : Vec3{0};
}

/// Returns the viewpoint of a camera with a lens, or of a pinhole as a lens of radius 0. Points of the unit
/// disk may be rounded to outside of it, and origins are off by less than 2^-50 of the sizes of their terms.
///
/// The normal is accurate to 2^-26 (viewpoint_of_film), so that its product with forward is accurate to 2^-20
/// of itself if that is above 2^-6 of forward's length; otherwise ahead is not certain.
[[nodiscard, gnu::cold]] inline Viewpoint viewpoint_of_lens(const Camera& camera, const PixelGrid& pixels,
                                                            double orientation) {
  const Camera::Lens lens = camera.lens();
  const Vec3 right = normalize(camera.right), up = normalize(camera.up);
  const double radius = camera.aperture * std::sqrt(1 + std::abs(dot(right, up)));
  Viewpoint viewpoint{.apex = camera.position,
                      .drift = 0x1p-20 * radius + 0x1p-49 * length(camera.position),
                      .lens_radius = radius,
                      .film = camera.position};
  const Vec3 ahead =
      ahead_of(camera.forward, (pixels.largest_u() + lens.u_shift) * camera.right,
               (pixels.largest_v() + lens.v_shift) * camera.up, orientation * cross(right, up));
  const double height = dot(ahead, camera.forward);
  if (height > 0x1p-6 * length(camera.forward))
    viewpoint.ahead = ahead, viewpoint.focus_depth = camera.focus * height;
  return viewpoint;
}

/// Returns the viewpoint of a camera whose rays start on a film. With position P, film vectors F, G and
/// directions d = f + u a + v b, a ray starts at
///   P + u F + v G = A + k d + e   with   A = P − k f,   e = u (F − k a) + v (G − k b),
/// for any k ≥ 0. Shifted by −e, it is a part of the ray from A along d. The k that is used
/// minimizes |F − k a|² + |G − k b|² among k ≥ 0: for a sensor, it is the sensor's k, and e is 0 but for
/// rounding. |e| is largest in the corners of the image.
///
/// The corners of the film are at most R = |u F| + |v G| from P. Origins and A are rounded by less than
/// 2^-50 of the sizes of their terms, (|P| + |A| + R). The normal of the film, from vectors at an angle of
/// 2^-24 or more, is accurate to 2^-26, and its product with a vector in the film, truly 0, to 2^-26 R; in
/// float, a half-space through the film's edge is off by 2^-23 R. Adding 2^-20 R + 2^-49 (|P| + |A|) to the
/// bound of |e| covers all of it.
[[nodiscard, gnu::cold]] inline Viewpoint viewpoint_of_film(const Camera& camera, const PixelGrid& pixels,
                                                            double orientation) {
  const Vec3 &right = camera.right, &up = camera.up;
  const Vec3 &film_right = camera.film_right, &film_up = camera.film_up;
  const double u = pixels.largest_u(), v = pixels.largest_v();
  const double film = u * length(film_right) + v * length(film_up);
  Viewpoint viewpoint{.apex = camera.position, .film = camera.position};
  if (!camera.is_orthographic()) {
    const double k =
        std::max(0.0, (dot(film_right, right) + dot(film_up, up)) / (dot(right, right) + dot(up, up)));
    viewpoint.apex = camera.position - k * camera.forward;
    viewpoint.drift = u * length(film_right - k * right) + v * length(film_up - k * up);
  }
  viewpoint.drift += 0x1p-20 * film + 0x1p-49 * (length(camera.position) + length(viewpoint.apex));
  viewpoint.ahead = ahead_of(camera.forward, u * right, v * up,
                             orientation * cross(normalize(film_right), normalize(film_up)));
  return viewpoint;
}

/// Moves the viewpoint of a camera from where it is at time 0 to the middle of its way while the shutter is
/// open. All rays start at most half of the way from where they would start then.
///
/// With u = 2^-53 and w the farther end of the way from where the camera is at time 0: times are off by 4u of
/// the later end, so a ray is moved by way of 5u|w| too much or too little, and its origin is rounded by u
/// (|o| + |w|), of which the viewpoint's drift has the share of |o|. The ends are off by u|w|, their middle
/// and half of their distance by 3u|w| each, and the moved apex by u (|apex| + |w|). 2^-48 = 32u of both ends
/// covers all of |w|.
[[gnu::cold]] inline void move_with(const Camera& camera, Viewpoint& viewpoint) {
  const Vec3 from = camera.shutter.opens * camera.velocity, to = camera.shutter.closes * camera.velocity;
  const Vec3 middle = 0.5 * (from + to);
  viewpoint.apex += middle, viewpoint.film += middle;
  viewpoint.drift += 0.5 * length(to - from) + 0x1p-48 * (length(from) + length(to));
}

}  // namespace detail

/// Returns the viewpoint of a camera, whose orientation is given (PixelRays::orientation).
[[nodiscard, gnu::cold]] inline Viewpoint viewpoint_of(const Camera& camera, const PixelGrid& pixels,
                                                       double orientation) {
  if (camera.is_pinhole()) return {.apex = camera.position, .is_pinhole = true};
  Viewpoint viewpoint = camera.has_film() ? detail::viewpoint_of_film(camera, pixels, orientation)
                                          : detail::viewpoint_of_lens(camera, pixels, orientation);
  if (camera.is_moving()) detail::move_with(camera, viewpoint);
  return viewpoint;
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Camera rays through the pixels of an image, several at once, and what culling needs of them: their origin
// and the planes between columns and between rows.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <vector>

#include "../camera.hpp"
#include "../image.hpp"
#include "../pixels.hpp"
#include "../simd/simd.hpp"
#include "packet.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Origin of the rays of a picture, as culling uses it.
struct Viewpoint {
  /// Point from which centers are measured. Each ray, shifted by at most drift, is a part of a ray from here,
  /// and begins there at a t of at most start. Parallel rays have no common point, and start is infinite.
  Point apex;
  double drift = 0, start = 0;

  /// Point and unit normal of the plane on which all rays start, up to drift; they lead to the side of the
  /// normal. A normal that is not certain is 0.
  Point film{0};
  Vec3 ahead{0};
};

/// Rays of a camera through the pixels of an image: PixelGrid::ray, with the terms that the pixels of a
/// column or a row share computed once.
class PixelRays {
 public:
  PixelRays(const Camera& camera, const PixelGrid& pixels, int width, int height)
      : camera_(camera),
        pixels_(pixels),
        is_pinhole_(camera.is_pinhole()),
        hand_(hand_of(camera)),
        viewpoint_(is_pinhole_ ? Viewpoint{.apex = camera.position} : viewpoint_of_film()) {
    for (int i = 0; i < pixels.samples(); ++i) samples_.push_back(tables(pixels.sample(i), width, height));
    for (int x = 0; x <= width; x += edge_step) right_of_.push_back(computed_right_of(x));
    for (int y = 0; y <= height; y += edge_step) below_.push_back(computed_below(y));
  }

  /// Returns the directions of the rays through the i-th samples of the pixels from (x, y) on to the right.
  [[nodiscard]] Vectors directions(int x, int y, int i = 0) const {
    const Tables& sample = samples_[static_cast<std::size_t>(i)];
    return camera_.direction(sample.along.some(x), Vectors(sample.up[y]));
  }

  /// Returns the packet of these rays, of which rays in the tile are active. Rays of a pinhole have one Point
  /// as origin, and rays of any other camera have Vectors.
  template <class Origin = Point>
  [[nodiscard]] CameraPacket<Origin> packet(const Tile& tile, int x, int y, const Vectors& directions,
                                            int i = 0) const {
    return {origin<Origin>(samples_[static_cast<std::size_t>(i)], x, y), directions, active(tile, x)};
  }
  /// Returns the active lanes of a packet that begins in column x: the pixels in the tile.
  [[nodiscard]] static LaneMask active(const Tile& tile, int x) {
    return x + double_lanes <= tile.x1 ? LaneMask(true)
                                       : mask_of<double, double_lanes>(first_bits(tile.x1 - x));
  }
  template <class Origin = Point>
  [[nodiscard]] CameraPacket<Origin> packet(const Tile& tile, int x, int y, int i = 0) const {
    return packet<Origin>(tile, x, y, directions(x, y, i), i);
  }

  /// Returns the unit normal, to the right, of the plane through the left edge of column x; below(y) returns
  /// the downward one of the plane through the upper edge of row y. The planes pass through the camera's
  /// apex, unless rays are parallel. A normal that is not certain is 0.
  [[nodiscard]] Vec3 right_of(int x) const {
    return x % edge_step == 0 ? right_of_[static_cast<std::size_t>(x / edge_step)] : computed_right_of(x);
  }
  [[nodiscard]] Vec3 below(int y) const {
    return y % edge_step == 0 ? below_[static_cast<std::size_t>(y / edge_step)] : computed_below(y);
  }

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] const PixelGrid& pixels() const { return pixels_; }
  [[nodiscard]] bool is_pinhole() const { return is_pinhole_; }
  [[nodiscard]] const Viewpoint& viewpoint() const { return viewpoint_; }

  /// Returns the orientation of right, up and forward, or of film_right, film_up and forward if rays are
  /// parallel: 1, or −1 if the camera is mirrored; 0 if the directions almost lie in a plane.
  ///
  /// Let V be the volume of the unit directions. A sum of multiples of the directions is at least V times as
  /// long as the longest of these, and as much is left of the vector product of such a sum with a direction
  /// that is not in it. Rounding turns rays and products by a few 2^-52 of their terms, hence by less than
  /// 2^-49 / V, which has to be below 2^-25.
  [[nodiscard]] double hand() const { return hand_; }

 private:
  static constexpr int edge_step = 8;  ///< most tiles begin and end at multiples of this

  /// Returns the normal of a plane that contains the directions forward + u · right + v · up with u, or v,
  /// fixed; if these are all forward, of the plane that contains forward and the edge of the film.
  [[nodiscard]] Vec3 computed_right_of(int x) const {
    const Vec3& upwards = camera_.is_orthographic() ? camera_.film_up : camera_.up;
    return unit(hand_ * cross(upwards, camera_.forward + pixels_.u(x, 0) * camera_.right));
  }
  [[nodiscard]] Vec3 computed_below(int y) const {
    const Vec3& across = camera_.is_orthographic() ? camera_.film_right : camera_.right;
    return unit(hand_ * cross(across, camera_.forward + pixels_.v(y, 0) * camera_.up));
  }
  static Vec3 unit(const Vec3& v) {
    const double size = length(v);  // within these bounds, squares neither overflow nor vanish
    return 0x1p-500 < size && size < 0x1p500 ? v / size : Vec3{0};
  }

  /// Vectors, stored as one row for each component.
  class Table {
   public:
    explicit Table(int size) : x_(index(size)), y_(index(size)), z_(index(size)) {}

    void set(int i, const Vec3& v) { x_[index(i)] = v.x, y_[index(i)] = v.y, z_[index(i)] = v.z; }
    [[nodiscard]] Vec3 operator[](int i) const { return {x_[index(i)], y_[index(i)], z_[index(i)]}; }
    [[nodiscard]] Vectors some(int first) const {
      return {Doubles::load(&x_[index(first)]), Doubles::load(&y_[index(first)]),
              Doubles::load(&z_[index(first)])};
    }

   private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    std::vector<double> x_, y_, z_;
  };

  /// Terms that the rays through one sample of all pixels share.
  struct Tables {
    Table along, up;            ///< u · right of each column and v · up of each row
    Table film_along, film_up;  ///< u · film_right and v · film_up; empty for a pinhole
  };

  static double hand_of(const Camera& camera) {
    const bool parallel = camera.is_orthographic();
    const Vec3 &right = parallel ? camera.film_right : camera.right,
               &up = parallel ? camera.film_up : camera.up;
    const double volume = dot(cross(normalize(right), normalize(up)), normalize(camera.forward));
    return std::abs(volume) > 0x1p-24 ? std::copysign(1, volume) : 0;
  }

  template <class Origin>
  [[nodiscard]] Origin origin(const Tables& sample, int x, int y) const {
    if constexpr (std::same_as<Origin, Point>)
      return camera_.position;
    else
      return camera_.origin(sample.film_along.some(x), Vectors(sample.film_up[y]));
  }

  /// Returns the viewpoint of a camera whose rays start on a film. With position P, film vectors F, G and
  /// directions d = f + u a + v b, a ray starts at
  ///   P + u F + v G = A + k d + e   with   A = P − k f,   e = u (F − k a) + v (G − k b),
  /// for any k ≥ 0. Shifted by −e, it is a part of the ray from A along d, from k |d| on. The k that is used
  /// minimizes |F − k a|² + |G − k b|² among k ≥ 0: for a sensor, it is the sensor's k, and e is 0 but for
  /// rounding. |e| and |d| are largest in the corners of the image.
  ///
  /// The corners of the film are at most R = |u F| + |v G| from P. Origins and A are rounded by less than
  /// 2^-50 of the sizes of their terms, (|P| + |A| + R). The normal of the film, from vectors at an angle of
  /// 2^-24 or more, is accurate to 2^-26, and its product with a vector in the film, truly 0, to 2^-26 R; in
  /// float, a half-space through the film's edge is off by 2^-23 R. Adding 2^-20 R + 2^-49 (|P| + |A|) to the
  /// bound of |e| covers all of it.
  [[nodiscard]] Viewpoint viewpoint_of_film() const {
    const auto& [position, right, up, forward, film_right, film_up] = camera_;
    const double u = pixels_.largest_u();
    const double film = u * length(film_right) + length(film_up);
    Viewpoint viewpoint{.apex = position, .film = position};
    double least = 1;  // smallest product of normal and a ray's unit direction
    const Vec3 normal = hand_ * cross(normalize(film_right), normalize(film_up));
    if (camera_.is_orthographic()) {
      viewpoint.start = std::numeric_limits<double>::infinity();
    } else {
      const double k =
          std::max(0.0, (dot(film_right, right) + dot(film_up, up)) / (dot(right, right) + dot(up, up)));
      viewpoint.apex = position - k * forward;
      viewpoint.drift = u * length(film_right - k * right) + length(film_up - k * up);
      for (const Vec3& across : {u * right, -u * right})
        for (const Vec3& upwards : {up, -up}) {
          const Vec3 d = forward + across + upwards;
          viewpoint.start = std::max(viewpoint.start, (1 + 0x1p-40) * k * length(d));
          least = std::min(least, dot(normal, d) / length(d));
        }
    }
    viewpoint.drift += 0x1p-20 * film + 0x1p-49 * (length(position) + length(viewpoint.apex));
    // Rounding turns rays by less than 2^-25, well below 2^-20.
    if (length(normal) > 0x1p-24 && least > 0x1p-20 * length(normal)) viewpoint.ahead = normalize(normal);
    return viewpoint;
  }

  [[nodiscard]] Tables tables(const PixelSample& sample, int width, int height) const {
    const bool is_film = !is_pinhole_;
    Tables tables{.along = Table(width + double_lanes),
                  .up = Table(height),
                  .film_along = Table(is_film ? width + double_lanes : 0),
                  .film_up = Table(is_film ? height : 0)};
    for (int x = 0; x < width; ++x) {
      const double u = pixels_.u(x, sample.x);
      tables.along.set(x, u * camera_.right);
      if (is_film) tables.film_along.set(x, u * camera_.film_right);
    }
    for (int y = 0; y < height; ++y) {
      const double v = pixels_.v(y, sample.y);
      tables.up.set(y, v * camera_.up);
      if (is_film) tables.film_up.set(y, v * camera_.film_up);
    }
    return tables;
  }

  Camera camera_;
  PixelGrid pixels_;
  bool is_pinhole_;
  double hand_;
  Viewpoint viewpoint_;
  std::vector<Tables> samples_;
  std::vector<Vec3> right_of_, below_;  ///< normals at each edge_step-th column and row
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Camera rays through the pixels of an image, several at once, and what culling needs of them: their origin
// and the planes between columns and between rows.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "../camera.hpp"
#include "../image.hpp"
#include "../pixel_grid.hpp"
#include "../plain_vector.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "packet.hpp"
#include "viewpoint.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Block of as many pixels as a vector has floats. It begins at a multiple of its width and of its height.
struct RayBlock {
  static constexpr int width = std::min(8, float_lanes), height = float_lanes / width;
};

/// Numbers from which a packet of camera rays is made (PixelRays::packet).
struct PacketRays {
  Vectors directions;  ///< unit vectors
  Doubles x, y;    ///< film coordinates u, v, or points of a lens in the unit disk; set only without tables
                   ///< of columns and rows
  Floats weights;  ///< weights of the samples by the filter; set as x and y are
  Doubles time;    ///< set only if the shutter is open
};

/// Rays of a camera through the pixels of an image: PixelGrid::ray. If places in pixels are the same in all
/// of them, the terms that the pixels of a column or a row share are computed once, unless there are so many
/// samples that these tables would take about half a gigabyte or more.
class PixelRays {
 public:
  /// Computes the tables. It is called once for a picture, so that it is compiled for size (gnu::cold), which
  /// takes less of a compiler's time.
  [[gnu::cold]] PixelRays(const Camera& camera, const PixelGrid& pixels, int width, int height)
      : camera_(pixels.has_only_centers() ? camera.without_lens() : camera),
        pixels_(pixels),
        is_pinhole_(camera_.is_pinhole()),
        has_tables_(pixels.has_common_places() && !camera_.has_lens() &&
                    fits_tables(pixels.drawn(), width, height)),
        lens_(camera_.has_lens() ? camera_.lens() : Camera::Lens{camera.film_right, camera.film_up, 0, 0}),
        orientation_(orientation_of(camera)),
        has_float_sums_(has_tables_ && allows_float_sums(camera_, pixels)),
        viewpoint_(viewpoint_of(camera_, pixels, orientation_)) {
    if (has_tables_) compute_tables(width, height);
    for (int x = 0; x <= width; x += RayBlock::width) {
      edges_.left.push_back(column_edge_at(x, -margin()));
      if (margin() > 0) edges_.right.push_back(column_edge_at(x, margin()));
    }
    for (int y = 0; y <= height; y += RayBlock::height) {
      edges_.upper.push_back(row_edge_at(y, -margin()));
      if (margin() > 0) edges_.lower.push_back(row_edge_at(y, margin()));
    }
  }

  /// Returns the directions of the rays through the i-th samples of the pixels from (x, y) on to the right.
  /// Requires tables: places that are the same in all pixels, no lens, and not too many samples.
  [[nodiscard]] Vectors directions(int x, int y, int i = 0) const {
    const int sample = i - pixels_.first();
    return normalize(tables_.along.load<Vectors>(sample, x) + Vectors(tables_.up.at(sample, y)) +
                     camera_.forward);
  }

  /// Returns approximate directions of a pinhole's rays through the i-th samples of the block that begins at
  /// (x, y). With u = 2^-24 and d the direction of a ray, they are (1 + δ) d + ε with |δ| ≤ 11u, |ε| ≤ 8u.
  ///
  /// A direction before it is normalized, D, is the sum of a column's and a row's vector. If the unit vectors
  /// of the camera span a volume above 1/2, the column's is at most 2|D| long and the row's, a sum of two, at
  /// most 4|D| (orientation()). Rounding these and their sum makes an error of 7u|D|. The length, from its
  /// square with an error of 3u of it, is off by 1.5u, its reciprocal by 8u, and products by u, which also
  /// turns d by at most u. Other cameras get directions that are computed in double and rounded once.
  [[nodiscard, gnu::always_inline]] WideVectors block_directions(int x, int y, int i = 0) const {
    if (!has_float_sums_) return rounded_directions(x, y, i);
    const int sample = i - pixels_.first();
    const auto along = tables_.block_along.load<WideVectors>(sample, x * RayBlock::height),
               row = tables_.block_row.load<WideVectors>(sample, y * RayBlock::width);
    const auto dx = along.x + row.x, dy = along.y + row.y, dz = along.z + row.z;
    const auto scale = reciprocal_sqrt(dx * dx + dy * dy + dz * dz);
    return {dx * scale, dy * scale, dz * scale};
  }

  /// Computes the rays through the i-th samples of the pixels from (x, y) on to the right.
  void compute_rays(int x, int y, int i, PacketRays& rays) const {
    compute_directions(x, y, i, rays);
    if (camera_.shutter.is_open()) rays.time = pixels_.times(camera_.shutter, x, y, i);
  }

  /// Returns the filter's weights of the i-th samples of a packet.
  [[nodiscard]] Floats weights(int i, const PacketRays& rays) const {
    if (!pixels_.has_common_places()) return rays.weights;
    return static_cast<float>(pixels_.common_place(i).weight);
  }

  /// Returns the packet of the i-th camera rays through the pixels from (x, y) on to the right; lanes beyond
  /// the tile's right edge are inactive.
  [[nodiscard]] CameraPacket packet(const Tile& tile, int x, int y, int i, const PacketRays& rays) const {
    const Doubles time = camera_.shutter.is_open() ? rays.time : Doubles(camera_.shutter.opens);
    CameraPacket packet(is_pinhole_ ? Vectors(camera_.position) : origins(x, y, i, rays, time),
                        rays.directions, active(tile, x));
    packet.time = time;
    packet.start_together = is_pinhole_;
    return packet;
  }
  [[nodiscard]] CameraPacket packet(const Tile& tile, int x, int y, int i = 0) const {
    PacketRays rays;
    compute_rays(x, y, i, rays);
    return packet(tile, x, y, i, rays);
  }

  /// Returns the active lanes of a packet that begins in column x: the pixels in the tile.
  [[nodiscard]] static LaneMask active(const Tile& tile, int x) {
    return x + double_lanes <= tile.x1 ? LaneMask(true)
                                       : mask_of<double, double_lanes>(first_bits(tile.x1 - x));
  }

  /// Vector of three floats, each rounded once.
  using FloatNormal = std::array<float, 3>;
  static FloatNormal rounded(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }

  /// Edge of the columns, or of the rows, of a tile, moved out by as much as places of samples may be outside
  /// of their pixel.
  struct Edge {
    Vec3 term;    ///< term of the directions that is fixed along the edge: u · right, or v · up
    Vec3 normal;  ///< unit normal, to the right or downward, of the plane through the edge; 0 if not certain
    FloatNormal inwards = rounded(normal), outwards = rounded(-normal);  ///< the same in float
  };

  /// left_edge(x) and upper_edge(y) return a member of the edge of tiles that start at column x or row y;
  /// right_edge(x) and lower_edge(y), of tiles that end before it. The edges' planes pass through the
  /// camera's apex, unless rays are parallel. An edge is not returned as a whole, since a copy that was just
  /// written in parts of another size would wait until all of them are written.
  template <class M>
  [[nodiscard]] M left_edge(int x, M Edge::*member) const {
    return x % RayBlock::width == 0 ? edges_.left[column_of_blocks(x)].*member
                                    : column_edge_at(x, -margin()).*member;
  }
  template <class M>
  [[nodiscard]] M right_edge(int x, M Edge::*member) const {
    if (margin() == 0) return left_edge(x, member);
    return x % RayBlock::width == 0 ? edges_.right[column_of_blocks(x)].*member
                                    : column_edge_at(x, margin()).*member;
  }
  template <class M>
  [[nodiscard]] M upper_edge(int y, M Edge::*member) const {
    return y % RayBlock::height == 0 ? edges_.upper[row_of_blocks(y)].*member
                                     : row_edge_at(y, -margin()).*member;
  }
  template <class M>
  [[nodiscard]] M lower_edge(int y, M Edge::*member) const {
    if (margin() == 0) return upper_edge(y, member);
    return y % RayBlock::height == 0 ? edges_.lower[row_of_blocks(y)].*member
                                     : row_edge_at(y, margin()).*member;
  }

  /// Returns the edge at `position` pixels from the left side of column x, or from the upper side of row y,
  /// moved by u_shift or v_shift in film coordinates. Its plane contains all directions forward + u · right +
  /// v · up with that u, or v; if these are all forward, it contains forward and the edge of the film.
  [[nodiscard]] Edge column_edge_at(int x, double position, double u_shift = 0) const {
    const Vec3& upwards = camera_.is_orthographic() ? camera_.film_up : camera_.up;
    const Vec3 term = (pixels_.u(x, position) + u_shift) * camera_.right;
    return Edge{.term = term, .normal = unit(orientation_ * cross(upwards, camera_.forward + term))};
  }
  [[nodiscard]] Edge row_edge_at(int y, double position, double v_shift = 0) const {
    const Vec3& across = camera_.is_orthographic() ? camera_.film_right : camera_.right;
    const Vec3 term = (pixels_.v(y, position) + v_shift) * camera_.up;
    return Edge{.term = term, .normal = unit(orientation_ * cross(across, camera_.forward + term))};
  }
  /// Returns how far places of samples may be outside of their pixel, in pixels.
  [[nodiscard]] double margin() const { return pixels_.margin(); }

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] const PixelGrid& pixels() const { return pixels_; }
  [[nodiscard]] bool is_pinhole() const { return is_pinhole_; }
  [[nodiscard]] const Viewpoint& viewpoint() const { return viewpoint_; }
  [[nodiscard]] const Camera::Lens& lens() const { return lens_; }

  /// Returns the orientation of right, up and forward, or of film_right, film_up and forward if rays are
  /// parallel: 1 for left-handed directions, as Camera's functions make them, −1 for mirrored ones; 0 if they
  /// lie almost in a plane, so that no plane of an edge is certain.
  ///
  /// Let V be the volume of the unit directions. A sum of multiples of the directions is at least V times as
  /// long as the longest of these, and as much is left of the vector product of such a sum with a direction
  /// that is not in it. Rounding turns rays and products by a few 2^-52 of their terms, hence by less than
  /// 2^-49 / V, which has to be below 2^-25.
  [[nodiscard]] double orientation() const { return orientation_; }

 private:
  static std::size_t column_of_blocks(int x) { return static_cast<std::size_t>(x / RayBlock::width); }
  static std::size_t row_of_blocks(int y) { return static_cast<std::size_t>(y / RayBlock::height); }

  static Vec3 unit(const Vec3& v) {
    const double size = length(v);  // within these bounds, squares neither overflow nor vanish
    return 0x1p-500 < size && size < 0x1p500 ? v / size : Vec3{0};
  }

  /// Vectors of numbers of type T, as many for each sample, stored as one row for each component.
  template <class T>
  class Table {
   public:
    void resize(int samples, int size) {
      size_ = index(size);
      numbers_.resize(3 * size_ * index(samples));
    }
    void set(int sample, int i, const Vec3& v) {
      T* const to = &numbers_[offset(sample, i)];
      to[0] = v.x, to[size_] = v.y, to[2 * size_] = v.z;
    }
    /// Sets the vectors from `first` on to those in some lanes.
    template <int N>
    void store(int sample, int first, const Lanes<T, N>& x, const Lanes<T, N>& y, const Lanes<T, N>& z) {
      T* const to = &numbers_[offset(sample, first)];
      x.store(to), y.store(to + size_), z.store(to + 2 * size_);
    }
    [[nodiscard]] Vec3 at(int sample, int i) const {
      const T* const from = &numbers_[offset(sample, i)];
      return {from[0], from[size_], from[2 * size_]};
    }

    /// Returns V{x, y, z} with the components of the vectors from `first` on in the lanes.
    template <class V>
    [[nodiscard]] V load(int sample, int first) const {
      using L = decltype(V::x);
      const T* const from = &numbers_[offset(sample, first)];
      return {L::load(from), L::load(from + size_), L::load(from + 2 * size_)};
    }

   private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    [[nodiscard]] std::size_t offset(int sample, int i) const { return 3 * size_ * index(sample) + index(i); }

    std::size_t size_ = 0;  ///< number of vectors of a sample
    PlainVector<T> numbers_;
  };

  /// Terms that the rays through a sample of all pixels share.
  struct Tables {
    Table<double> along, up;            ///< u · right of each column and v · up of each row
    Table<double> film_along, film_up;  ///< u · film_right and v · film_up; empty for a pinhole

    /// For a pinhole, u · right and forward + v · up of each pixel of a block: of the first row of blocks,
    /// and of the first column (block_directions).
    Table<float> block_along, block_row;
  };

  /// Returns the volume that the unit directions of a camera span, with the sign of its orientation.
  static double volume_of(const Camera& camera) {
    const bool parallel = camera.is_orthographic();
    const Vec3 &right = parallel ? camera.film_right : camera.right,
               &up = parallel ? camera.film_up : camera.up;
    return dot(cross(normalize(right), normalize(up)), normalize(camera.forward));
  }
  static double orientation_of(const Camera& camera) {
    const double volume = volume_of(camera);
    return std::abs(volume) > 0x1p-24 ? std::copysign(1, volume) : 0;
  }

  /// Returns true if the directions of a camera may be added up in float (block_directions). Before they are
  /// normalized, they are at least half as long as forward and no longer than the sum of all three vectors,
  /// so that squares stay between 2^-100 and 2^100.
  [[gnu::cold]] static bool allows_float_sums(const Camera& camera, const PixelGrid& pixels) {
    const double longest = length(camera.forward) + pixels.largest_u() * length(camera.right) +
                           pixels.largest_v() * length(camera.up);
    return camera.is_pinhole() && std::abs(volume_of(camera)) > 0.5 + 0x1p-20 &&
           length(camera.forward) > 0x1p-40 && longest < 0x1p40;
  }
  [[nodiscard, gnu::noinline]] WideVectors rounded_directions(int x, int y, int i) const {
    static_assert(RayBlock::width % double_lanes == 0);
    float numbers[3][float_lanes];
    for (int k = 0; k < float_lanes; k += double_lanes) {
      PacketRays rays;
      compute_directions(x + k % RayBlock::width, y + k / RayBlock::width, i, rays);
      const Vectors& d = rays.directions;
      to_float(d.x).store(numbers[0] + k), to_float(d.y).store(numbers[1] + k);
      to_float(d.z).store(numbers[2] + k);
    }
    const auto lanes = [&](int axis) { return WideFloats::load(numbers[axis]); };
    return {lanes(0), lanes(1), lanes(2)};
  }

  /// Returns where the rays through the i-th samples of some pixels start at given times, on the film or the
  /// lens of a camera that is no pinhole at rest.
  [[nodiscard, gnu::noinline]] Vectors origins(int x, int y, int i, const PacketRays& rays,
                                               const Doubles& time) const {
    const Vectors at_0 = origins_at_0(x, y, i, rays);
    return camera_.is_moving() ? camera_.origin_at(time, at_0) : at_0;
  }
  [[nodiscard]] Vectors origins_at_0(int x, int y, int i, const PacketRays& rays) const {
    if (!camera_.has_film() && !camera_.has_lens()) return Vectors(camera_.position);
    if (!has_tables_) return rays.x * lens_.right + rays.y * lens_.up + camera_.position;
    const int sample = i - pixels_.first();
    return tables_.film_along.load<Vectors>(sample, x) + Vectors(tables_.film_up.at(sample, y)) +
           camera_.position;
  }

  /// Computes rays, but for their times.
  void compute_directions(int x, int y, int i, PacketRays& rays) const {
    if (has_tables_)
      rays.directions = directions(x, y, i);
    else
      compute_own_rays(x, y, i, rays);
  }

  /// Computes rays without tables: through places, or points of the lens, that each pixel has of its own, or
  /// through those of too many samples.
  [[gnu::noinline]] void compute_own_rays(int x, int y, int i, PacketRays& rays) const {
    SampleSet<Doubles> numbers;
    if (camera_.has_lens() || !pixels_.has_common_places()) numbers = pixels_.samplers(x, y, i)(0);
    const FilteredPlace<Doubles> places = pixels_.places(i, numbers);
    Doubles u = pixels_.u(x, places.x), v = pixels_.v(y, places.y);
    rays.x = u, rays.y = v;
    rays.weights = to_float(places.weight);
    if (camera_.has_lens()) {
      const auto [lens_x, lens_y] = PixelGrid::lens_points(numbers);
      u = u - lens_x * lens_.u_shift, v = v - lens_y * lens_.v_shift;
      rays.x = lens_x, rays.y = lens_y;
    }
    rays.directions = normalize(u * camera_.right + v * camera_.up + camera_.forward);
  }

  /// Returns the number of columns, or rows, in tables: packets and blocks are read whole, also where only
  /// their first pixels are in the image.
  static int columns_in_tables(int width) { return (width / RayBlock::width + 2) * RayBlock::width; }
  static int rows_in_tables(int height) { return height + RayBlock::height; }

  /// Returns true if the tables of so many samples are small enough. A column or a row of a sample takes at
  /// most 120 bytes: two vectors of doubles, or one of doubles and one of floats for each of 8 columns of a
  /// block.
  [[gnu::cold]] static bool fits_tables(std::uint64_t samples, int width, int height) {
    constexpr double most = 1 << 22;
    return static_cast<double>(samples) * (1.0 * columns_in_tables(width) + rows_in_tables(height)) <= most;
  }
  [[gnu::cold]] void compute_tables(int width, int height) {
    const int columns = columns_in_tables(width), rows = rows_in_tables(height);
    const int film_columns = is_pinhole_ ? 0 : columns, film_rows = is_pinhole_ ? 0 : rows;
    const int samples = pixels_.last() - pixels_.first();
    tables_.along.resize(samples, columns), tables_.up.resize(samples, rows);
    tables_.film_along.resize(samples, film_columns), tables_.film_up.resize(samples, film_rows);
    tables_.block_along.resize(samples, is_pinhole_ ? columns * RayBlock::height : 0);
    tables_.block_row.resize(samples, is_pinhole_ ? rows * RayBlock::width : 0);
    for (int i = 0; i < samples; ++i)
      compute_tables(i, pixels_.common_place(pixels_.first() + i), columns, rows);
  }
  [[gnu::cold]] void compute_tables(int i, const FilteredPlace<double>& sample, int columns, int rows) {
    for (int x = 0; x < columns; x += double_lanes) {
      const Doubles u = pixels_.u(x, Doubles(sample.x));
      const Vectors along = u * camera_.right, film_along = u * camera_.film_right;
      tables_.along.store(i, x, along.x, along.y, along.z);
      if (!is_pinhole_) {
        tables_.film_along.store(i, x, film_along.x, film_along.y, film_along.z);
        continue;
      }
      for (int k = 0; k < RayBlock::height; ++k)
        tables_.block_along.store(
            i, x / RayBlock::width * float_lanes + k * RayBlock::width + x % RayBlock::width,
            to_float(along.x), to_float(along.y), to_float(along.z));
    }
    for (int y = 0; y < rows; ++y) {
      const double v = pixels_.v(y, sample.y);
      tables_.up.set(i, y, v * camera_.up);
      if (!is_pinhole_) {
        tables_.film_up.set(i, y, v * camera_.film_up);
        continue;
      }
      const Vec3 row = camera_.forward + v * camera_.up;
      const auto all = [](double number) {
        return Lanes<float, RayBlock::width>(static_cast<float>(number));
      };
      tables_.block_row.store(i, y * RayBlock::width, all(row.x), all(row.y), all(row.z));
    }
  }

  Camera camera_;
  PixelGrid pixels_;
  bool is_pinhole_, has_tables_;
  Camera::Lens lens_;  ///< vectors that x and y of PacketRays multiply: of the lens, else of the film
  double orientation_;
  bool has_float_sums_;
  Viewpoint viewpoint_;
  Tables tables_;  ///< of the samples of the grid's range

  /// Edges of the columns and rows of blocks, at which most tiles and parts begin and end. Without a margin,
  /// those on the right are those on the left, and the lower ones the upper ones.
  struct {
    PlainVector<Edge> left, right, upper, lower;
  } edges_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

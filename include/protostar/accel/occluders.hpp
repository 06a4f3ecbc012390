// Lists of surfaces that may stand between a light and the points that a part of a picture shows.
//
// The shadow rays of neighboring pixels lead to a light through almost the same space. A cone with its apex
// at the light contains those of a packet and of others near it, and is searched for surfaces once. Each
// packet then gets those of them that reach into a narrower cone of its own.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "../bvh/bvh.hpp"
#include "../plain_vector.hpp"
#include "packet.hpp"
#include "sphere_around.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Chosen rays of a packet as seen from an apex, a point at which they may end.
struct SeenFrom {
  Point apex;
  Vectors to_origin;  ///< from the apex to the rays' origins
  Doubles squares;    ///< squares of the distances of the origins
  Doubles off_apex;   ///< squares of the distances at which the rays end beside the apex
  LaneMask which;     ///< chosen rays: one at least

  SeenFrom(const Point& from, const RayPacket& rays, LaneMask chosen)
      : apex(from),
        to_origin(rays.origin - Vectors(from)),
        squares(dot(to_origin, to_origin)),
        which(chosen) {
    const Vectors end = rays.origin + rays.direction - Vectors(from);
    off_apex = dot(end, end);
  }
};

/// Round cone up to a distance from its apex, together with the points that are no farther than drift from
/// it. A segment from a point of the cone to the apex lies in it; one that ends beside the apex is at most as
/// far beside that segment.
///
/// drift is 2^-44 of the size of points, |apex| + length. Origins and ends of rays are accurate to 2^-51 of
/// this; the tolerance of holds(), drift/4, is well inside.
///
/// Angles are compared by the squares of their cosines, without roots and quotients, for which a packet would
/// wait. With u = 2^-53, these are off by less than 32u: a dot product by 3u of the lengths' product, which
/// counts twice in its square, the square of a length by 3u, the axis by 3u of its length, which counts
/// twice, and products and quotients by 6u.
class ConeToLight {
 public:
  ConeToLight() = default;  ///< holds nothing

  /// Makes a cone for rays in 0 < t < 1 that end together, and similar ones: the sine of its half-angle is
  /// `wide` · (that of theirs + 2^-9), and it is a quarter longer. It holds nothing if the half-angle is 30°
  /// or more, or if lengths are extreme; holds() is false for rays that do not end together.
  explicit ConeToLight(const SeenFrom& rays, double wide = 4) : apex_(rays.apex) {
    set(rays);
    drift_ = 0x1p-44 * (glm::length(apex_) + 1.25 * length_);
    sine_ = wide * (sine_ + 0x1p-9);
    cosine_ = std::sqrt(1 - sine_ * sine_);
    length_ *= 1.25;
    if (!(sine_ < 0.5 && 0x1p-90 < length_ && length_ < 0x1p90 && glm::length(apex_) < 0x1p400)) close();
  }

  /// Returns true if all of the rays, which the cone's apex sees, lie inside in 0 < t < 1 and end there. The
  /// cosine that they need is raised by 2^-46, and so its square by more than the roundings of both sides.
  /// Rays that begin within 2^-200 of the apex, where squares may underflow, are outside.
  [[nodiscard]] bool holds(const SeenFrom& rays) const {
    const Doubles along = dot(rays.to_origin, Vectors(axis_));
    const double least = cosine_ + 0x1p-46;
    const LaneMask inside = rays.off_apex < 0.0625 * drift_ * drift_ && Doubles(0x1p-400) < rays.squares &&
                            rays.squares < length_ * length_ && along > Doubles(0.0) &&
                            along * along > least * least * rays.squares;
    return !any(rays.which && !inside);
  }

  /// Returns true if the cone holds anything.
  [[nodiscard]] bool is_cone() const { return length_ > 0; }

  /// Makes the cone hold nothing.
  void close() { length_ = 0; }

  /// Returns half-spaces that contain the cone, moved out by drift. Four are at its side, to which a normal e
  /// that is orthogonal to the axis a becomes orthogonal if it is turned towards a by the half-angle φ:
  /// e cos φ + a sin φ. The last is at the cone's end.
  [[nodiscard]] std::array<HalfSpace, 5> half_spaces() const {
    const Vec3 size = abs(axis_);
    const Vec3 other = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                       : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                            : Vec3{0, 0, 1};
    const Vec3 e1 = normalize(cross(axis_, other)), e2 = cross(axis_, e1), tilt = sine_ * axis_;
    const auto moved_out = [&](const Point& on, const Vec3& normal) {
      return HalfSpace{on - drift_ * normal, normal};
    };
    return {moved_out(apex_, tilt + cosine_ * e1), moved_out(apex_, tilt - cosine_ * e1),
            moved_out(apex_, tilt + cosine_ * e2), moved_out(apex_, tilt - cosine_ * e2),
            moved_out(apex_ + length_ * axis_, -axis_)};
  }

  /// Sphere as seen from the apex: its center, measured from there, the center's distance, its radius, larger
  /// by the drift of rays and by rounding, and the length of a tangent from the apex. A sphere that contains
  /// the apex, or is at a distance that float does not hold well, is in every direction, at no distance.
  struct Seen {
    Vec3 center{0};
    double distance = 0, radius = 0, horizon = -infinity;
  };
  [[nodiscard]] Seen seen(const SphereAround& around) const {
    const Vec3 l = around.center - apex_;
    const double distance = glm::length(l);
    const double radius = around.radius + drift_ + 0x1p-40 * (distance + around.radius);
    if (!(distance > radius && 0x1p-100 < distance && distance < 0x1p100)) return {};
    return {l, distance, radius, std::sqrt((distance - radius) * (distance + radius))};
  }

  /// Returns true if a sphere may reach into the cone, as derived in Candidates::add; here in double, where
  /// 2^-40 of all lengths covers the rounding.
  [[nodiscard]] bool may_hold(const Seen& sphere) const {
    const auto& [l, distance, radius, horizon] = sphere;
    return !(distance - radius > length_) &&
           !(dot(axis_, l) < cosine_ * horizon - sine_ * radius - 0x1p-40 * distance);
  }

  /// Returns the part of the cone around some of the rays that it holds: with the same apex, and as narrow
  /// and as long as they are.
  [[nodiscard]] ConeToLight around(const SeenFrom& rays) const {
    ConeToLight narrow = *this;
    narrow.set(rays);
    return narrow;
  }

  [[nodiscard]] const Vec3& axis() const { return axis_; }
  [[nodiscard]] double cosine() const { return cosine_; }
  [[nodiscard]] double sine() const { return sine_; }
  [[nodiscard]] double length() const { return length_; }

 private:
  /// Makes the cone as narrow and as long as some rays, but for 2^-39 of the squared cosine and 2^-40 of the
  /// length, which cover roundings. The axis is between the first and the last. It is always inlined, so that
  /// what the apex sees of the rays stays in registers.
  [[gnu::always_inline]] void set(const SeenFrom& rays) {
    const Bits which = bits(rays.which);
    const int first = std::countr_zero(which), last = static_cast<int>(std::bit_width(which)) - 1;
    const Vec3 axis = rays.to_origin[first] + rays.to_origin[last];
    const double square = dot(axis, axis);
    axis_ = axis / std::sqrt(square);
    const Doubles along = dot(rays.to_origin, Vectors(axis));
    const Doubles squared_cosines = along * abs(along) / (rays.squares * square);
    const double least = std::max(0.0, smallest(select(rays.which, squared_cosines, Doubles(1))) - 0x1p-39);
    cosine_ = std::sqrt(least);
    sine_ = std::sqrt(1 - least);
    length_ = std::sqrt(largest(select(rays.which, rays.squares, Doubles(0)))) * (1 + 0x1p-40);
  }

  Point apex_{0};
  Vec3 axis_{0};
  double cosine_ = 1, sine_ = 0;   ///< cosine and sine of the half-angle
  double drift_ = 0, length_ = 0;  ///< in scene units; a length of 0 holds nothing
};

/// Spheres that reach into a cone, in float, so that many are tested at once.
///
/// A sphere reaches into a cone with a half-angle φ and the apex at 0 if a·l ≥ h cos φ − r sin φ, and its
/// nearest point |l| − r is not beyond the cone's end. In float, with u = 2^-24, each term has an error of at
/// most 5u |l|, and the difference 2u |l|, if h and r are at most |l|. For cos φ ≥ ½ it is enough to reduce h
/// and |l| − r by 2^-18 |l| = 64u |l|.
class InCone {
 public:
  void clear() {
    indices_.clear();
    rows_.clear();
  }
  [[nodiscard]] std::size_t size() const { return indices_.size(); }

  /// Adds the surface with this index in the scene's order, by the sphere around it.
  void add(int index, const ConeToLight::Seen& sphere) {
    constexpr std::size_t n = float_lanes;
    const std::size_t i = indices_.size(), at = i / n * rows * n + i % n;
    if (i % n == 0) rows_.resize(rows_.size() + rows * n, nowhere);
    indices_.push_back(index);
    const double less = 0x1p-18 * sphere.distance;
    const double row[rows] = {sphere.center.x, sphere.center.y,       sphere.center.z,
                              sphere.radius,   sphere.horizon - less, sphere.distance - sphere.radius - less};
    for (std::size_t k = 0; k < rows; ++k) rows_[at + k * n] = static_cast<float>(row[k]);
  }

  /// Calls visit(index) for those of the surfaces that may reach into a cone with the same apex.
  void each_within(const ConeToLight& cone, const auto& visit) const {
    const auto in_float = [](double x) { return Row(static_cast<float>(x)); };
    const Row x = in_float(cone.axis().x), y = in_float(cone.axis().y), z = in_float(cone.axis().z);
    const Row cosine = in_float(cone.cosine()), sine = in_float(cone.sine());
    const Row end = in_float(cone.length() * (1 + 0x1p-22));
    for (std::size_t i = 0; i < indices_.size(); i += float_lanes) {
      const auto row = [&](std::size_t k) { return Row::load(&rows_[rows * i + k * float_lanes]); };
      const Row along = x * row(0) + y * row(1) + z * row(2);
      for (const int k : lanes_in(along >= cosine * row(4) - sine * row(3) && row(5) <= end))
        visit(indices_[i + static_cast<std::size_t>(k)]);
    }
  }

 private:
  using Row = Lanes<float, float_lanes>;
  static constexpr std::size_t rows = 6;

  /// Value of unused lanes: as a nearest point, it is beyond the end of all cones.
  static constexpr float nowhere = std::numeric_limits<float>::infinity();

  PlainVector<int> indices_;
  PlainVector<float> rows_;  ///< one row for each number, of as many spheres as a vector holds
};

/// Lists of occluders of a tile, a few for each light, which rays of several packets use.
class Occluders {
 public:
  void clear() { count_ = next_ = 0; }

  /// Returns the indices, in any order, of the surfaces that the chosen rays may hit in 0 < t < 1, valid
  /// until the next call; null if each ray is better traced alone. search(half_spaces, visit) calls
  /// visit(SurfacesAround) for the surfaces that may reach into all of the half-spaces. Precondition: a ray
  /// is chosen.
  [[nodiscard]] const PlainVector<int>* between(const RayPacket& rays, LaneMask which, const auto& search) {
    ToLight& to_light = lists_for(rays, std::countr_zero(bits(which)));
    const SeenFrom from_light(to_light.light, rays, which);
    List* list = to_light.list_of(from_light);
    if (list == nullptr) list = to_light.new_list(from_light, search);
    if (list == nullptr) return nullptr;
    to_light.served += std::popcount(bits(which));
    indices_.clear();
    list->in_cone.each_within(list->cone.around(from_light), [&](int index) { indices_.push_back(index); });
    return &indices_;
  }

 private:
  /// Longest list that saves more than it costs.
  static constexpr std::size_t most = 256;

  /// List length below which cones become wider; above twice as much, they become narrower.
  static constexpr std::size_t handy = 32;

  static constexpr std::size_t most_lights = 16, lists_each = 4;

  /// Number of surfaces that are looked at in about the time of one ray traced alone, and number that take
  /// the time of the search itself.
  static constexpr int worth = 4, least = 32;

  struct List {
    ConeToLight cone;
    InCone in_cone;
  };

  /// Lists for one light: several, since rays of neighboring pixels may start on surfaces that are far apart.
  struct ToLight {
    Point light{0};           ///< where the first of its rays ends: the apex of all cones
    double near_squared = 0;  ///< square of the distance from the light within which its rays end
    List lists[lists_each];
    std::size_t next = 0;
    double wide = 4;  ///< width of a cone, as a multiple of that of a packet's rays

    std::int64_t served = 256;  ///< number of rays that lists have served since the last search

    /// Number of packets without a list that are still to be traced alone, and how many they were after the
    /// last search.
    int waits = 0, pause = 0;

    /// Returns a list whose cone holds the rays; null if there is none.
    List* list_of(const SeenFrom& rays) {
      for (List& list : lists)
        if (list.cone.is_cone() && list.cone.holds(rays)) return &list;
      return nullptr;
    }

    /// Returns a new list, in place of the oldest, for a cone around the rays; null if each ray is better
    /// traced alone: during a pause, if the rays do not end together, or if the list would be too long.
    List* new_list(const SeenFrom& rays, const auto& search) {
      if (waits > 0) {
        --waits;
        return nullptr;
      }
      const ConeToLight cone(rays, wide);
      if (!cone.is_cone() || !cone.holds(rays)) return nullptr;
      List& list = lists[next++ % lists_each];
      list.cone = cone;
      list.in_cone.clear();
      int looked_at = least;
      search(list.cone.half_spaces(), [&](const SurfacesAround& surfaces) {
        const auto& [indices, lanes, around] = surfaces;
        looked_at += std::popcount(lanes);
        for (const int lane : lanes_in(lanes)) {
          if (list.in_cone.size() > most) break;
          const auto seen = list.cone.seen(around[lane]);
          if (list.cone.may_hold(seen)) list.in_cone.add(static_cast<int>(indices[lane]), seen);
        }
      });
      adapt(list.in_cone.size(), looked_at);
      if (list.in_cone.size() <= most) return &list;
      list.cone.close();
      return nullptr;
    }

   private:
    /// Adapts the width of the next cone to the length of this list, and the pause before its search to what
    /// this search took and the last list saved.
    void adapt(std::size_t length, int looked_at) {
      if (length > 2 * handy)
        wide = std::max(1.5, 0.5 * wide);
      else if (length < handy)
        wide = std::min(8.0, 1.25 * wide);
      // If the last list served few rays for the surfaces looked at, searching does not pay; each time in a
      // row is followed by a longer pause.
      pause = looked_at > worth * served ? std::min(4 * pause + 8, 1 << 12) : 0;
      waits = pause;
      served = 0;
    }
  };

  /// Returns the lists for the light at which the ray in a lane ends: new ones, in place of the oldest if
  /// there are most_lights, for a light that has none.
  ToLight& lists_for(const RayPacket& rays, int lane) {
    const Point end = rays.origin[lane] + rays.direction[lane];
    for (std::size_t i = 0; i < count_; ++i)
      if (const Vec3 apart = end - lights_[i].light; dot(apart, apart) < lights_[i].near_squared)
        return lights_[i];
    const double near = 0x1p-46 * (glm::length(end) + glm::length(rays.direction[lane]));
    if (count_ < most_lights) ++count_;
    ToLight& to_light = lights_[next_++ % most_lights];
    to_light = {.light = end, .near_squared = near * near, .lists = {}};
    return to_light;
  }

  ToLight lights_[most_lights];
  PlainVector<int> indices_;  ///< list for the last packet
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// What may stand between a light and the points that a part of a picture shows.
//
// The shadow rays of neighboring pixels lead to a light through almost the same space. A cone with its apex
// at the light holds those of a packet and of others near it, and what reaches into the cone is looked for
// once.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "bvh.hpp"
#include "packet.hpp"
#include "sphere_around.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// The points of a round cone up to a distance from its apex, and whatever is no farther than drift from
/// them. A segment from a point of a cone to the apex lies in it; one that ends beside the apex lies as far
/// beside that segment at most.
///
/// drift is 2^-44 of the numbers that points are made of, |apex| + length. Where rays start and end is good
/// to 2^-51 of these, and so are comparisons of lengths: what holds() grants, 2^-46, is well inside.
class ConeToLight {
 public:
  ConeToLight() = default;  ///< holds nothing

  /// A cone for some rays in 0 < t < 1 that end together, wide enough for more like them: about five times
  /// their angle and half a degree, and a quarter longer. Where that is above 30° it holds nothing, and rays
  /// that do not end together are not all held.
  ConeToLight(const Rays<Vectors>& rays, Chosen which) {
    const int first = std::countr_zero(bits(which));
    apex_ = rays.origin[first] + rays.direction[first];
    double farthest = 0;
    for (Bits left = bits(which); left != 0; left &= left - 1) {
      const Vec3 w = rays.origin[std::countr_zero(left)] - apex_;
      farthest = std::max(farthest, length(w));
      axis_ += w / length(w);
    }
    axis_ = axis_ / length(axis_);
    double least = 1;
    for (Bits left = bits(which); left != 0; left &= left - 1) {
      const Vec3 w = rays.origin[std::countr_zero(left)] - apex_;
      least = std::min(least, dot(axis_, w) / length(w));
    }
    sine_ = 5 * std::sqrt(1 - least * least) + 0x1p-7;
    if (!(sine_ < 0.5) || !(farthest < 0x1p400) || !(length(apex_) < 0x1p400)) return;
    cosine_ = std::sqrt(1 - sine_ * sine_);
    drift_ = 0x1p-44 * (length(apex_) + 1.25 * farthest);
    length_ = 1.25 * farthest;
  }

  /// Whether rays, in 0 < t < 1, lie inside.
  [[nodiscard]] bool holds(const Rays<Vectors>& rays, Chosen which) const {
    const Vectors end = rays.origin + rays.direction - Vectors(apex_), w = rays.origin - Vectors(apex_);
    const Doubles distance = sqrt(dot(w, w));
    const Chosen inside = dot(end, end) < 0.0625 * drift_ * drift_ && distance < length_ &&
                          dot(w, Vectors(axis_)) > cosine_ * distance;
    return !any(which && !inside);
  }

  /// Whether rays end where these do.
  [[nodiscard]] bool is_to_light_of(const Rays<Vectors>& rays, int lane) const {
    return length(rays.origin[lane] + rays.direction[lane] - apex_) < 0.25 * drift_;
  }

  /// Whether the cone holds anything.
  [[nodiscard]] bool is_cone() const { return length_ > 0; }

  /// Half-spaces that contain the cone: a normal e that is orthogonal to the axis a, turned towards a by the
  /// half-angle φ, e cos φ + a sin φ, is orthogonal to the cone's side; and the plane at the cone's end.
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

  /// Whether a sphere may reach into the cone, as Candidates::add derives it; here in double, where 2^-40 of
  /// all lengths is more than what rounds.
  [[nodiscard]] bool may_hold(const SphereAround& around) const {
    const Vec3 l = around.center - apex_;
    const double distance = length(l), error = 0x1p-40 * (distance + around.radius);
    const double radius = around.radius + drift_ + error;
    if (!(distance > radius)) return true;
    if (distance > length_ + radius) return false;
    const double horizon = std::sqrt((distance - radius) * (distance + radius));
    return !(dot(axis_, l) < cosine_ * horizon - sine_ * radius - error);
  }

 private:
  Point apex_{0};
  Vec3 axis_{0};
  double cosine_ = 1, sine_ = 0;  ///< of the half-angle
  double drift_ = 0, length_ = 0;
};

/// The lists of occluders of a tile, one for each light.
class Occluders {
 public:
  /// What rays in 0 < t < 1 may meet, as places in the scene's order; nothing if each is sooner looked at by
  /// itself. search(half_spaces, visit) calls visit(place, SphereAround) for all that may be in half-spaces.
  [[nodiscard]] const std::vector<int>* between(const Rays<Vectors>& rays, Chosen which, const auto& search) {
    List& list = list_for(rays, std::countr_zero(bits(which)));
    if (!list.cone.holds(rays, which)) {
      if (list.waits > 0) {
        --list.waits;
        return nullptr;
      }
      // A list that served few packets, or is long, did not pay; each in a row is followed by a longer pause.
      list.pause =
          list.served < enough || list.places.size() > most ? std::min(2 * list.pause + 8, 1 << 10) : 0;
      list.waits = list.pause;
      list.cone = ConeToLight(rays, which);
      list.served = 0;
      list.places.clear();
      if (!list.cone.holds(rays, which)) return nullptr;  // they need not end together
      search(list.cone.half_spaces(), [&](int place, const SphereAround& around) {
        if (list.cone.may_hold(around)) list.places.push_back(place);
      });
    }
    ++list.served;
    return list.places.size() <= most ? &list.places : nullptr;
  }

 private:
  /// So many surfaces are tried one after the other; more are sooner looked for by each ray.
  static constexpr std::size_t most = 64;
  static constexpr std::size_t most_lights = 16;
  static constexpr int enough = 4;

  struct List {
    ConeToLight cone;
    std::vector<int> places;
    int served = enough, waits = 0, pause = 0;
  };

  List& list_for(const Rays<Vectors>& rays, int lane) {
    for (List& list : lists_)
      if (list.cone.is_to_light_of(rays, lane)) return list;
    if (lists_.size() < most_lights) return lists_.emplace_back();
    next_ = (next_ + 1) % most_lights;
    return lists_[next_] = List{};
  }

  std::vector<List> lists_;
  std::size_t next_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

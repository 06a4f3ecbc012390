// Several rays at once, with a lane for each, and their crossings with a surface.
//
// An integrator that is written for one ray reads the same for a packet: `light.position - hit.point()` is
// one vector or one in each lane. Every lane is computed as a single ray is, so that it gets the same bytes.
#pragma once

#include <cstddef>
#include <limits>
#include <utility>

#include "../ray_lanes.hpp"
#include "../scene.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Largest number of surfaces for which testing all of them with rays in lanes is mostly faster than a
/// traversal of the BVH for each ray. With more surfaces shadow rays become slower first, then reflections,
/// and paths last. It is at most 32, as many as a set of surfaces (Bits) holds.
inline constexpr std::size_t few_surfaces = double_lanes >= 8 ? 32 : double_lanes == 4 ? 24 : 16;

/// Surface coordinates u and v, in each lane.
struct Uvs {
  Doubles x, y;
};

/// Returns surface coordinates; one that is NaN or not within 2^500 becomes 0.
[[nodiscard]] inline Uvs uv_of(Doubles u, Doubles v) {
  return {select(abs(u) < 0x1p500, u, Doubles(0.0)), select(abs(v) < 0x1p500, v, Doubles(0.0))};
}

/// A color in each lane.
struct Colors {
  Floats r, g, b;

  Colors(Floats red, Floats green, Floats blue) : r(red), g(green), b(blue) {}
  Colors(const Color& c) : r(c.r), g(c.g), b(c.b) {}
  explicit Colors(Floats gray) : r(gray), g(gray), b(gray) {}
  explicit Colors(float gray) : Colors(Floats(gray)) {}
  explicit Colors(const Vectors& v) : r(to_float(v.x)), g(to_float(v.y)), b(to_float(v.z)) {}

  friend Colors operator+(const Colors& p, const Colors& q) { return {p.r + q.r, p.g + q.g, p.b + q.b}; }
  friend Colors operator*(const Colors& p, const Colors& q) { return {p.r * q.r, p.g * q.g, p.b * q.b}; }
  friend Colors operator*(const Colors& p, Floats share) { return {p.r * share, p.g * share, p.b * share}; }
  friend Colors operator*(float share, const Colors& p) { return p * Floats(share); }
  void set(int lane, const Color& c) { r.set(lane, c.r), g.set(lane, c.g), b.set(lane, c.b); }
  Colors& operator*=(const Colors& other) { return *this = *this * other; }
  Colors& operator+=(const Colors& other) { return *this = *this + other; }
  friend LaneMask is_black(const Colors& c) {
    return mask_for<double>(c.r == 0.0f && c.g == 0.0f && c.b == 0.0f);
  }
  template <class M>
  friend Colors select(Mask<M, double_lanes> which, const Colors& p, const Colors& q) {
    return {select(which, p.r, q.r), select(which, p.g, q.g), select(which, p.b, q.b)};
  }
};

/// Returns light with each channel clamped to the largest float.
[[nodiscard]] inline Colors clamped(const Colors& light) {
  const auto one = [](Floats x) { return min(x, Floats(std::numeric_limits<float>::max())); };
  return {one(light.r), one(light.g), one(light.b)};
}

inline Colors operator*(const Color& color, Floats share) { return Colors(color) * share; }
inline Colors select(LaneMask which, const Color& a, const Color& b) {
  return select(which, Colors(a), Colors(b));
}
inline Doubles select(LaneMask which, double a, double b) { return select(which, Doubles(a), Doubles(b)); }

/// Rays of a packet. They depart from the same geometry, or each from its own primitive of one surface.
struct RayPacket {
  using Light = Colors;  ///< type of their radiance

  Vectors origin, direction;
  LaneMask active = true;          ///< active lanes; results in the others do not matter
  Departure departure;             ///< geometry that all rays leave; none if `departed` is a surface
  const void* departed = nullptr;  ///< surface of which each ray leaves a primitive; null for other rays
  const SurfaceFunctions* functions = nullptr;  ///< functions of that surface
  Indices departed_primitives = 0;              ///< indices of those primitives; 0 for other rays
  Doubles time = 0.0;                           ///< Ray::time

  /// Sets the members; constructors, since g++ clears an aggregate as a whole before it fills it.
  RayPacket(const Vectors& from, const Vectors& along, LaneMask lanes = true)
      : origin(from.x, from.y, from.z), direction(along.x, along.y, along.z), active(lanes) {}
  RayPacket(const Vectors& from, const Vectors& along, LaneMask lanes, const Departure& leaves)
      : origin(from.x, from.y, from.z),
        direction(along.x, along.y, along.z),
        active(lanes),
        departure(leaves) {}
  RayPacket(const Vectors& from, const Vectors& along, LaneMask lanes, const void* surface,
            const SurfaceFunctions& functions_of_surface, const Indices& primitives)
      : origin(from.x, from.y, from.z),
        direction(along.x, along.y, along.z),
        active(lanes),
        departed(surface),
        functions(&functions_of_surface),
        departed_primitives(primitives) {}

  /// Copies each member, so that a packet in registers stays there: memcpy, which g++ would call, has to wait
  /// until the packet is written.
  RayPacket(const RayPacket& rays)
      : origin(rays.origin.x, rays.origin.y, rays.origin.z),
        direction(rays.direction.x, rays.direction.y, rays.direction.z),
        active(rays.active),
        departure(rays.departure),
        departed(rays.departed),
        functions(rays.functions),
        departed_primitives(rays.departed_primitives),
        time(rays.time) {}
  RayPacket& operator=(const RayPacket&) = default;

  [[nodiscard]] Vectors at(Doubles t) const { return origin + t * direction; }

  /// Returns rays that differ in their directions alone.
  [[nodiscard]] RayPacket with_direction(const Vectors& towards) const {
    RayPacket rays = *this;
    rays.direction = towards;
    return rays;
  }

  /// Returns true if each ray may depart from another primitive, so that the rays are traced one by one.
  [[nodiscard]] bool leave_primitives() const { return departed != nullptr; }

  /// Returns the ray in a lane.
  [[nodiscard]] Ray operator[](int lane) const {
    Ray ray{.origin = origin[lane], .direction = direction[lane], .departure = departure, .time = time[lane]};
    if (leave_primitives())
      ray.departure = functions->departure(departed, static_cast<int>(departed_primitives[lane]));
    return ray;
  }

  /// Restricts the active lanes to the chosen ones.
  friend RayPacket&& masked(LaneMask chosen, RayPacket&& rays) {
    rays.active = rays.active && chosen;
    return std::move(rays);
  }
};

/// Rays of a camera through some pixels. They have a type of their own, since they meet only what has been
/// listed for their tile (accel/tile_scene.hpp).
struct CameraPacket : RayPacket {
  bool start_together = false;  ///< true if all of them start at one point, as those of a pinhole do

  using RayPacket::RayPacket;
};

/// Rays that start at one point, which is not stored in lanes: the terms of a surface's equation that depend
/// on that point alone are computed once for all rays. The rays depart from no surface.
struct RaysFromPoint {
  Point origin;
  const Vectors& direction;
  static constexpr Departure departure{};

  /// Precondition: rays.start_together.
  explicit RaysFromPoint(const CameraPacket& rays) : origin(rays.origin[0]), direction(rays.direction) {}
};

/// Returns the radiance that rays bring from an environment, which is asked ray by ray. It takes a copy, so
/// that the packet itself stays in registers.
[[nodiscard, gnu::noinline]] inline Colors environment_radiance(const Environment& environment,
                                                                RayPacket rays) {
  Colors colors(Color{0});
  for (const int lane : lanes_in(rays.active))
    colors.set(lane, environment_radiance(environment, rays[lane]));
  return colors;
}

/// Closest hit of each ray of a packet with a surface inside a range.
struct ClosestCrossings {
  Doubles t;                ///< parameter of the hit where `met` is true
  LaneMask met, in_doubt;   ///< a ray in doubt has to be traced alone
  LaneMask is_far = false;  ///< true if it is the second root of its line, for a surface that takes packets
};

/// True for a surface with an equation, but no roots of its own, whose equation, is_left_by and normal_at
/// take packets.
template <class S>
inline constexpr bool takes_packets =
    SurfaceWithEquation<S> && !SurfaceWithRoots<S> && requires(const S& surface, const RayPacket& rays) {
  surface.equation(rays);
  surface.is_left_by(rays);
  Vectors(surface.normal_at(rays.origin));
};

/// Lanes whose t lies inside a range, surely or maybe, as lies_inside decides. Roots have the sign of the
/// true ones, so that at 0 nothing is in doubt; a root beyond the range of double is infinity and lies inside
/// no range.
struct Inside {
  LaneMask surely, maybe;
};
[[nodiscard]] inline Inside lies_inside(Doubles t, Interval range) {
  if (range.min == 0 && range.max == infinity) {
    const LaneMask inside = t > 0.0 && t < infinity;
    return {.surely = inside, .maybe = inside};
  }
  const Doubles margin = 2 * Roots::relative_error * abs(t);
  return {.surely = range.min < t - margin && t + margin < range.max,
          .maybe = range.min < t + margin && t - margin < range.max};
}

/// Returns root and primitive of a crossing as one number, which is below 0 since roots are counted from 0;
/// crossing_at takes it apart.
[[nodiscard]] inline std::int64_t number_of(const Crossing& crossing) {
  return ~(std::int64_t{crossing.root} << 32 | static_cast<std::uint32_t>(crossing.primitive));
}
[[nodiscard]] inline Crossing crossing_at(double t, std::int64_t number) {
  return {
      .t = t, .root = static_cast<int>(~number >> 32), .primitive = static_cast<int>(~number & 0xffffffff)};
}

/// Returns first_crossing of the active rays of a packet, one by one, and sets `numbers` of the rays that
/// have one to number_of it.
template <Surface S>
[[nodiscard, gnu::noinline]] ClosestCrossings first_crossings_one_by_one(const S& surface,
                                                                         const RayPacket& rays,
                                                                         LaneMask active, Interval range,
                                                                         Indices& numbers) {
  ClosestCrossings first{.t = infinity, .met = false, .in_doubt = false};
  for (const int lane : lanes_in(active))
    if (const auto crossing = first_crossing(surface, rays[lane], range)) {
      first.t.set(lane, crossing->t);
      numbers.set(lane, number_of(*crossing));
      first.met = first.met || mask_of<double, double_lanes>(Bits{1} << lane);
    }
  return first;
}

/// Returns first_crossing of the active rays of a packet. If the surface takes packets and the range does not
/// start at 0, all of them are in doubt.
template <Surface S>
[[nodiscard]] ClosestCrossings first_crossings(const S& surface, const RayPacket& rays, LaneMask active,
                                               Interval range = {}) {
  if constexpr (SurfaceOfLanes<S>) {
    const auto ray = [&rays](int lane) { return rays[lane]; };
    const bool may_depart = rays.departure.kind != Departure::Kind::none || rays.leave_primitives();
    const FirstOfLanes first =
        surface.first_of_lanes(RayLanes{rays.origin, rays.direction, active, may_depart, ray}, range);
    return {.t = first.t, .met = first.is_there, .in_doubt = first.in_doubt};
  } else if constexpr (!takes_packets<S>) {
    Indices numbers = -1;
    return first_crossings_one_by_one(surface, rays, active, range, numbers);
  } else {
    if (range.min != 0) return {.t = infinity, .met = false, .in_doubt = active};
    const FirstRootOfEach<Doubles, LaneMask> root = first_root_of_each(surface, rays, active);
    if (range.max == infinity)
      return {.t = root.t, .met = root.is_there, .in_doubt = root.in_doubt, .is_far = root.is_far};
    const Inside inside = lies_inside(root.t, range);
    return {.t = root.t,
            .met = root.is_there && inside.surely,
            .in_doubt = root.in_doubt || (root.is_there && inside.maybe && !inside.surely),
            .is_far = root.is_far};
  }
}

/// Returns first_crossing in t > 0 of the active rays of a camera.
template <Surface S>
[[nodiscard]] ClosestCrossings first_crossings(const S& surface, const CameraPacket& rays, LaneMask active) {
  if constexpr (takes_packets<S> && !SurfaceOfLanes<S>)
    if (rays.start_together) {
      const FirstRootOfEach<Doubles, LaneMask> root =
          first_root_of_each(surface, RaysFromPoint(rays), active);
      return {.t = root.t, .met = root.is_there, .in_doubt = root.in_doubt, .is_far = root.is_far};
    }
  return first_crossings(surface, static_cast<const RayPacket&>(rays), active);
}

/// Returns which of the active rays of a packet cross a surface inside a range.
template <Surface S>
[[nodiscard]] CrossedByEach<LaneMask> crossed_in(const S& surface, const RayPacket& rays, LaneMask active,
                                                 Interval range) {
  if constexpr (takes_packets<S>)
    if (range.min == 0 && (range.max == 1 || range.max == infinity))
      return crossed_by_each(surface, rays, active, range.max == 1);
  const ClosestCrossings first = first_crossings(surface, rays, active, range);
  return {.crossed = first.met, .in_doubt = first.in_doubt};
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Hits of several rays on one surface: Intersection with a lane for each ray.
#pragma once

#include <concepts>
#include <utility>

#include "../intersection.hpp"
#include "../magnitude.hpp"
#include "../material.hpp"
#include "../normals.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../surface.hpp"
#include "packet.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Primitives of a surface without primitives: always 0.
struct NoPrimitives {
  int operator[](int) const { return 0; }
};

/// Hits of some rays of a packet on one surface, each possibly on its own primitive of it.
template <Surface S, class Primitives = NoPrimitives>
class HitPacket {
 public:
  using Light = Colors;

  Doubles t;  ///< parameter of each ray at its hit

  /// Takes the constants of the surface; without them (null) the normal of a flat surface is computed for
  /// each packet.
  HitPacket(const RayPacket& rays, Doubles at, LaneMask which, const S& surface, const Material& material,
            const Primitives& primitives = {}, const SurfaceConstants* constants = nullptr)
      : t(at),
        rays_(rays),
        which_(which),
        surface_(surface),
        material_(material),
        primitives_(primitives),
        constants_(constants) {}

  /// Returns the points of the rays at t, with t limited to 2^440 (most_t).
  [[nodiscard]] Vectors point() const { return rays_.at(min(t, most_t)); }

  /// Returns the directions of the rays.
  [[nodiscard]] const Vectors& direction() const { return rays_.direction; }

  /// Returns the surface's own unit normals. No normal map tilts them: hits on a surface that has one are
  /// shaded one by one (TileHits).
  [[nodiscard]] Vectors surface_normal() const {
    if constexpr (is_flat<S>)
      if (constants_ != nullptr) return *constants_->normal;
    if constexpr (takes_packets<S>)
      return surface_.normal_at(point());
    else
      return normals_one_by_one();
  }
  [[nodiscard]] Normals<Vectors> normals() const {
    const Vectors n = surface_normal();
    return {n, n};
  }
  [[nodiscard]] Normals<Vectors> facing_normals() const { return normals().facing(rays_.direction); }
  [[nodiscard]] Doubles height(const Vectors& to_light) const { return facing_normals().height(to_light); }
  [[nodiscard]] Vectors normal() const { return surface_normal(); }
  [[nodiscard]] Vectors facing_normal() const { return facing_normals().shading; }

  [[nodiscard]] const Material& material() const { return material_; }

  [[nodiscard]] Uvs uv() const {
    const Vectors points = point();
    if constexpr (requires {
                    { surface_.uv_at(points) } -> std::same_as<Uvs>;
                  }) {
      return surface_.uv_at(points);
    } else {
      Uvs uvs{0.0, 0.0};
      for (const int lane : lanes_in(which_)) {
        const Uv one = uv_at(surface_, points[lane], primitives_[lane]);
        uvs.x.set(lane, one.x), uvs.y.set(lane, one.y);
      }
      return uvs;
    }
  }

  [[nodiscard]] Colors color() const {
    if (!material_.texture) return material_.diffuse;
    // Copies, so that the packet itself stays in registers.
    return HitPacket(RayPacket(rays_), t, which_, surface_, material_, primitives_, constants_).texture();
  }

  /// Returns the rays in these directions that leave the surface at the hits, at the times of the hits.
  [[nodiscard]] RayPacket leave(const Vectors& direction) const {
    RayPacket rays = leaving(direction);
    rays.time = rays_.time;
    return rays;
  }

 private:
  [[nodiscard]] RayPacket leaving(const Vectors& direction) const {
    if constexpr (std::same_as<Primitives, NoPrimitives>)
      return {point(), direction, which_, departure_of(surface_)};
    else
      return {point(), direction, which_, &surface_, functions_of<S>, primitives()};
  }

  [[nodiscard]] Indices primitives() const {
    Indices numbers = 0;
    for (const int lane : lanes_in(which_)) numbers.set(lane, primitives_[lane]);
    return numbers;
  }

  [[nodiscard, gnu::noinline]] Vectors normals_one_by_one() const {
    // Neighbors often hit the same primitive, and a flat primitive has one normal.
    const bool are_flat = has_flat_primitives(surface_);
    const Vectors points = point();
    Vectors normals(Vec3{0});
    Vec3 n{0};
    int primitive = -1;
    for (const int lane : lanes_in(which_)) {
      const int before = std::exchange(primitive, primitives_[lane]);
      if (!are_flat || primitive != before) n = protostar::normal_at(surface_, points[lane], primitive);
      normals.x.set(lane, n.x), normals.y.set(lane, n.y), normals.z.set(lane, n.z);
    }
    return normals;
  }

  [[nodiscard, gnu::noinline, gnu::cold]] Colors texture() const {
    const Uvs uvs = uv();
    Colors colors(Color{0});
    for (const int lane : lanes_in(which_)) colors.set(lane, material_.texture(uvs.x[lane], uvs.y[lane]));
    return colors;
  }

  const RayPacket& rays_;
  LaneMask which_;
  const S& surface_;
  const Material& material_;
  [[no_unique_address]] Primitives primitives_;
  const SurfaceConstants* constants_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

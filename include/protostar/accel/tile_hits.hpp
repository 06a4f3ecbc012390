// Closest hits of packets of rays among the surfaces of a tile, and their shading.
#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>

#include "../render_options.hpp"
#include "../scene.hpp"
#include "../simd/prefetch.hpp"
#include "accelerate.hpp"
#include "candidates.hpp"
#include "drawn.hpp"
#include "hit_packet.hpp"
#include "packet.hpp"
#include "spheres_in_lanes.hpp"
#include "tile_state.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Closest hits of packets among a tile's surfaces: of all rays of a packet at once, then of each in doubt.
template <Surface... S>
class TileHits {
 public:
  using State = TileState<S...>;
  static constexpr bool rasterizes = (RasterizedSurface<S> || ...);  ///< any type can be rasterized
  static constexpr bool may_have_primitives = (is_made_of_primitives<S> || ...);  ///< a type may have them

  /// In scenes of more than two types, the code that shades hits and tests shadow rays is inlined for the
  /// first type alone, and called for the others: scenes of any type are drawn faster then.
  using First = std::tuple_element_t<0, std::tuple<S...>>;
  static constexpr bool calls_others = sizeof...(S) > 2;

  /// Type of Closest::primitive if no surface has primitives.
  struct Nothing {
    Nothing(int) {}
  };
  /// Closest hit of each ray. It is copied member by member, so that it stays in registers (RayPacket).
  struct Closest {
    Doubles t = infinity;              ///< infinity if the ray misses
    Indices index = no_surface_index;  ///< surface's index in the scene's order, or no_surface_index
    LaneMask is_far = false;           ///< true at the second root of a surface that takes packets

    /// Primitive that is hit: entry ≥ 0 of a visibility buffer, or number_of(Crossing), which is below 0.
    [[no_unique_address]] std::conditional_t<may_have_primitives, Indices, Nothing> primitive = -1;

    Closest() = default;
    Closest(const Closest& hits)
        : t(hits.t), index(hits.index), is_far(hits.is_far), primitive(hits.primitive) {}
    Closest& operator=(const Closest& hits) {
      t = hits.t, index = hits.index, is_far = hits.is_far, primitive = hits.primitive;
      return *this;
    }
  };

  TileHits(const Accelerated<Scene<S...>>& accelerated, const Candidates& candidates, State& state)
      : accelerated_(accelerated), scene_(accelerated.scene()), candidates_(candidates), state_(state) {}

  /// Sets the first pixel of the camera's next packet and the index of its sample; called before each query
  /// with a CameraPacket, since visibility buffers are read there.
  void set_packet_position(int x, int y, int sample) const { first_x_ = x, first_y_ = y, sample_ = sample; }

  /// Calls visit(surface, material) for the surface with an index in the scene's order,
  /// 0 ≤ index < scene.size().
  void visit(std::int64_t index, const auto& visit) const {
    auto i = static_cast<std::size_t>(index);
    const auto is_of = [&](const auto& surfaces, const auto& materials) {
      if (i < surfaces.size()) {
        visit(surfaces[i], materials[i]);
        return true;
      }
      i -= surfaces.size();
      return false;
    };
    static_cast<void>((is_of(scene_.template surfaces<S>(), scene_.template materials<S>()) || ...));
  }

  /// Returns true if any surface has a texture.
  [[nodiscard]] bool has_textures() const { return (scene_.template has_textures<S>() || ...); }
  /// Returns true if the surface with this index has a texture; reads its material only if there is any.
  [[nodiscard]] bool has_texture(std::int64_t index) const {
    bool has = false;
    visit(index, [&]<class T>(const T&, const Material& material) {
      has = scene_.template has_textures<T>() && material.texture;
    });
    return has;
  }

  /// Calls f(buffer) and returns true if there is a single candidate, and it has a visibility buffer.
  bool with_only_buffer(const auto& f) const {
    bool is_rasterized = false;
    if constexpr (rasterizes)
      if (candidates_.size() == 1)
        visit(candidates_.index(0), [&]<class T>(const T&, const Material&) {
          if constexpr (RasterizedSurface<T>)
            if (const auto* const drawn = buffer_at<T>(candidates_.index(0))) f(*drawn), is_rasterized = true;
        });
    return is_rasterized;
  }

  /// Returns the closest hits of camera rays, by tests of all candidates.
  [[nodiscard]] Closest closest(const CameraPacket& rays) const {
    return search(rays, rays.active, candidates_);
  }

  /// Returns the closest hits of camera rays by what float found: tests each ray with its one or two surfaces
  /// only, and rays with doubtful_index with all candidates. It is not inlined, so that the search among all
  /// candidates has the registers for itself.
  [[nodiscard, gnu::noinline]] Closest closest(const CameraPacket& rays, const SeenByPacket& seen) const {
    const LaneMask open = rays.active && mask_for<double>(seen.indices == Indices(doubtful_index));
    Closest closest;
    LaneMask in_doubt = false;
    test_seen(seen.indices, rays, closest, in_doubt);
    test_seen(seen.others, rays, closest, in_doubt);
    if (!any(open || in_doubt)) return closest;
    return search(rays, open, candidates_, closest, in_doubt);
  }

  /// Returns the closest hits of other rays, by tests of all surfaces of a scene of at most few_surfaces.
  [[nodiscard]] Closest closest(const RayPacket& rays) const {
    return search(rays, rays.active, AllOfFew{scene_.size()});
  }

  /// Returns the radiance of rays with these closest hits: shade_hits(hits) for one surface after the other,
  /// so that nothing has to be gathered from different surfaces, or shade_hits(hit, lane) for each hit of a
  /// surface whose hits are shaded one by one; background() for rays that miss.
  [[nodiscard]] Colors shade(const RayPacket& rays, const Closest& closest, const auto& background,
                             const auto& shade_hits) const {
    const LaneMask met = rays.active && closest.t < infinity;
    Colors result(Color{0});
    for (LaneMask remaining = met; any(remaining);) {
      const Group group = take_group(closest.index, remaining);
      Colors colors(Color{0});
      visit(group.number, [&]<class T>(const T& surface, const Material& material) {
        if constexpr (calls_others && !std::same_as<T, First>)
          colors = called_shade_on(surface, material, RayPacket(rays), Closest(closest), group, shade_hits);
        else
          colors = shade_on(surface, material, rays, closest, group, shade_hits);
      });
      if (!any(rays.active && !group.lanes)) return colors;  // the usual case: all rays hit one surface
      result = select(group.lanes, colors, result);
    }
    return any(rays.active && !met) ? select(met, result, Colors(background())) : result;
  }

  /// Returns the radiance of pixels that surely see these surfaces, or nothing, without a point of them.
  [[nodiscard]] Colors shade_without_point(const Indices& seen, const auto& background,
                                           const auto& shade_hits) const {
    const RayPacket no_rays(Vectors(Vec3{0}), Vectors(Vec3{0}));
    const LaneMask met = !mask_for<double>(seen == Indices(no_surface_index));
    Colors result = any(!met) ? Colors(background()) : Colors(Color{0});
    for (LaneMask remaining = met; any(remaining);) {
      const Group group = take_group(seen, remaining);
      visit(group.number, [&](const auto& surface, const Material& material) {
        const HitPacket hits(no_rays, 0.0, group.lanes, surface, material);
        result = select(group.lanes, Colors(shade_hits(hits)), result);
      });
    }
    return result;
  }

  /// Prefetches the surfaces of all candidates.
  void prefetch_candidates() const {
    for (const std::uint32_t index : candidates_.indices())
      visit(index, [](const auto& surface, const Material&) { prefetch_start(surface); });
  }
  /// Prefetches the surfaces that pixels see, and their materials, in all lanes: surface 0 for a negative
  /// index, since a branch on what is as good as random would take longer.
  void prefetch_seen(const Indices& seen) const {
    for (int lane = 0; lane < double_lanes; ++lane)
      visit(std::max(seen[lane], std::int64_t{0}), [](const auto& surface, const Material& material) {
        prefetch_start(surface), prefetch_start(material);
      });
  }

 protected:
  /// Returns the radiance of a single hit: shade(hit, lane), or shade(hit) if it takes no lane.
  [[nodiscard]] static Color shade_in_lane(const auto& shade, const Intersection& hit, int lane) {
    if constexpr (requires { shade(hit, lane); })
      return shade(hit, lane);
    else
      return shade(hit);
  }

  static LaneMask only_lane(int lane) { return mask_of<double, double_lanes>(Bits{1} << lane); }

  /// Counts a test with a surface, in double or by its visibility buffer, for each of these rays.
  void count_tests(LaneMask which) const {
    state_.counts.surface_tests += static_cast<std::uint64_t>(std::popcount(bits(which)));
  }

  /// Returns the visibility buffer of the surface with this index; null if it has none.
  template <RasterizedSurface T>
  [[nodiscard]] const typename T::Drawn* buffer_at(std::int64_t index) const {
    const VisibilityBuffers<T>& buffers = state_.buffers;
    return buffers.at(static_cast<int>(index), sample_);
  }

  /// Returns the crossing of the closest hit in a lane: from its number (number_of), or for a type that takes
  /// packets from t and is_far. For all other types, and hits from a visibility buffer, it is searched again.
  template <Surface T>
  [[nodiscard]] static Crossing crossing_of(const T& surface, const Ray& ray, const Closest& closest,
                                            int lane) {
    if constexpr (is_made_of_primitives<T>)
      if (has_primitives(surface) && closest.primitive[lane] < 0)
        return crossing_at(closest.t[lane], closest.primitive[lane]);
    if constexpr (takes_packets<T> && !SurfaceOfLanes<T>)
      return {.t = closest.t[lane], .root = static_cast<int>(bits(closest.is_far) >> lane & 1)};
    else
      return *first_crossing(surface, ray, Interval{});
  }

  /// Closest hit of one ray among some surfaces, and the index of its surface; no_surface_index if it misses.
  struct IndexedCrossing {
    int index = no_surface_index;
    SurfaceCrossing crossing;
  };
  /// Returns the closest hit in t > 0 of a ray among the surfaces with these indices, which may have any
  /// order; if hits are equal, the one of the smallest index.
  [[nodiscard, gnu::noinline, gnu::cold]] IndexedCrossing closest_of_one_ray(
      const Ray& ray, std::span<const std::uint32_t> indices) const {
    IndexedCrossing first;
    for (const std::uint32_t index : indices)
      visit(index, [&, index = static_cast<int>(index)](const auto& surface, const Material& material) {
        const auto crossing = first_crossing(surface, ray, Interval{});
        if (!crossing) return;
        const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
        if (first.index < 0 || precedes(ray, candidate, index, first.crossing, first.index))
          first = {index, candidate};
      });
    return first;
  }

  /// Replaces the closest hits of the rays for which `first` is surely closer, and returns these rays. Adds
  /// to in_doubt the rays that `first` leaves in doubt and those for which the order is not certain.
  static LaneMask keep_closer(const ClosestCrossings& first, const Indices& indices, Closest& closest,
                              LaneMask& in_doubt) {
    // The order is certified if the errors of both t, 2^-30 of each, do not overlap, for which a factor of 1
    // ± 2.1 · 2^-30 would do; 8 leaves room for the rounding of the products.
    const LaneMask sooner = first.met && first.t < (1 - 8 * Roots::relative_error) * closest.t;
    const LaneMask later = first.t > (1 + 8 * Roots::relative_error) * closest.t;
    in_doubt = in_doubt || first.in_doubt || (first.met && !sooner && !later);
    closest.t = select(sooner, first.t, closest.t);
    closest.index = select(sooner, indices, closest.index);
    closest.is_far = (sooner && first.is_far) || (!sooner && closest.is_far);
    return sooner;
  }

  const Accelerated<Scene<S...>>& accelerated_;
  const Scene<S...>& scene_;
  const Candidates& candidates_;
  State& state_;
  mutable int first_x_ = 0, first_y_ = 0, sample_ = 0;

 private:
  /// Tests the rays of some lanes with surfaces, Candidates or AllOfFew, in their order, until none can be
  /// hit sooner than `closest`. Returns the closest hits of all lanes; rays in doubt, by these tests or
  /// in_doubt, are traced alone among all of the surfaces. Only camera rays may be tested by visibility
  /// buffers.
  [[nodiscard, gnu::always_inline]] Closest search(const auto& rays, LaneMask lanes, const auto& surfaces,
                                                   Closest closest = {}, LaneMask in_doubt = false) const {
    if (any(lanes))
      for (int i = 0; i < surfaces.size(); ++i) {
        // If no ray can reach a surface before its closest hit, none can reach those that follow.
        if (!any(lanes && closest.t >= Doubles(surfaces.nearest(i)))) break;
        const std::int64_t index = surfaces.index(i);
        count_tests(lanes);
        visit(index, [&](const auto& surface, const Material&) {
          test(surface, index, rays, lanes, closest, in_doubt);
        });
      }
    if (any(in_doubt)) return with_doubts_resolved(RayPacket(rays), in_doubt, closest, surfaces.indices());
    return closest;
  }

  /// Tests each active camera ray with the surface in its lane of `seen`, and updates closest and in_doubt;
  /// lanes with a negative index are left out. Spheres of different lanes are tested together, since a packet
  /// sees several if they are small.
  [[gnu::always_inline]] void test_seen(const Indices& seen, const CameraPacket& rays, Closest& closest,
                                        LaneMask& in_doubt) const {
    LaneMask remaining = rays.active && mask_for<double>(seen >= Indices(0));
    if (!any(remaining)) return;
    if constexpr ((std::same_as<S, Sphere> || ...)) {
      const auto& spheres = scene_.template surfaces<Sphere>();
      const Indices at = seen - Indices(first_sphere(scene_));
      const LaneMask here =
          remaining &&
          mask_for<double>(at >= Indices(0) && at < Indices(static_cast<std::int64_t>(spheres.size())));
      if (any(here)) {
        count_tests(here);
        const SpheresInLanes gathered(spheres.data(), select(here, at, Indices(0)));
        const auto first = first_root_of_each(gathered.equation(rays), here);
        keep_closer({first.t, first.is_there, first.in_doubt, first.is_far}, seen, closest, in_doubt);
        remaining = remaining && !here;
      }
    }
    while (any(remaining)) {
      const Group group = take_group(seen, remaining);
      count_tests(group.lanes);
      visit(group.number, [&](const auto& surface, const Material&) {
        test(surface, group.number, rays, group.lanes, closest, in_doubt);
      });
    }
  }

  /// Updates the closest hits with those of one surface, and in_doubt with the rays that it leaves in doubt.
  template <Surface T>
  [[gnu::always_inline]] void test(const T& surface, std::int64_t index, const auto& rays, LaneMask lanes,
                                   Closest& closest, LaneMask& in_doubt) const {
    if constexpr (RasterizedSurface<T> && std::same_as<decltype(rays), const CameraPacket&>)
      if (const auto* const drawn = buffer_at<T>(index)) {
        const auto seen = drawn->seen(lanes, first_x_, first_y_);
        ClosestCrossings first{.t = infinity, .met = seen.met, .in_doubt = seen.in_doubt};
        if (any(seen.met))
          first.t = select(seen.met, drawn->t(seen.which, seen.met, rays.direction), first.t);
        const LaneMask sooner = keep_closer(first, index, closest, in_doubt);
        closest.primitive = select(sooner, seen.which, closest.primitive);
        return;
      }
    if constexpr (is_made_of_primitives<T>)
      if (has_primitives(surface)) {
        Indices numbers = -1;
        const ClosestCrossings first = first_crossings_one_by_one(surface, rays, lanes, Interval{}, numbers);
        const LaneMask sooner = keep_closer(first, index, closest, in_doubt);
        closest.primitive = select(sooner, numbers, closest.primitive);
        return;
      }
    keep_closer(first_crossings(surface, rays, lanes), index, closest, in_doubt);
  }

  /// Returns the radiance of rays that hit one surface, though perhaps different primitives of it. They are
  /// shaded one by one if shade_hits takes single hits only, if the material has a normal map, or if
  /// primitives are hit that are in no visibility buffer.
  template <Surface T>
  [[nodiscard]] Colors shade_on(const T& surface, const Material& material, const RayPacket& rays,
                                const Closest& closest, const Group& group, const auto& shade_hits) const {
    if constexpr (std::is_invocable_v<decltype(shade_hits), HitPacket<T>>) {
      const bool is_mapped = scene_.template has_normal_maps<T>() && material.normal_map;
      if constexpr (RasterizedSurface<T>)
        if (!is_mapped && !any(group.lanes && mask_for<double>(closest.primitive < Indices(0))))
          return Colors(shade_hits(
              HitPacket(rays, closest.t, group.lanes, surface, material,
                        PrimitivesSeen<typename T::Drawn>{*buffer_at<T>(group.number), closest.primitive})));
      if (!is_mapped && !has_primitives(surface)) [[likely]]
        return Colors(shade_hits(HitPacket(rays, closest.t, group.lanes, surface, material, NoPrimitives{},
                                           accelerated_.constants(static_cast<std::size_t>(group.number)))));
    }
    return shade_one_by_one(surface, material, RayPacket(rays), closest, group.lanes, shade_hits);
  }

  /// Returns shade_on for a type whose code is not inlined (calls_others).
  template <Surface T>
  [[nodiscard, gnu::noinline]] Colors called_shade_on(const T& surface, const Material& material,
                                                      const RayPacket& rays, const Closest& closest,
                                                      const Group& group, const auto& shade_hits) const {
    return shade_on(surface, material, rays, closest, group, shade_hits);
  }

  /// Returns the radiance of rays that hit one surface, of one hit after the other.
  template <Surface T>
  [[nodiscard, gnu::noinline]] Colors shade_one_by_one(const T& surface, const Material& material,
                                                       const RayPacket& rays, const Closest& closest,
                                                       LaneMask lanes, const auto& shade_hits) const {
    Colors result(Color{0});
    for (const int lane : lanes_in(lanes)) {
      const Ray ray = rays[lane];
      const Intersection hit(ray,
                             crossing_on(surface, crossing_of<T>(surface, ray, closest, lane), material));
      result.set(lane, shade_in_lane(shade_hits, hit, lane));
    }
    return result;
  }

  /// Returns the closest hits, with each ray in doubt traced alone. `closest` is passed by value, so that
  /// what double decides can stay in registers.
  [[nodiscard, gnu::noinline, gnu::cold]] Closest with_doubts_resolved(
      const RayPacket& rays, LaneMask in_doubt, Closest closest,
      std::span<const std::uint32_t> indices) const {
    for (const int lane : lanes_in(in_doubt)) {
      ++state_.counts.in_doubt;
      const auto [index, crossing] = closest_of_one_ray(rays[lane], indices);
      closest.t = select(only_lane(lane), Doubles(index < 0 ? infinity : crossing.crossing.t), closest.t);
      closest.index = select(only_lane(lane), Indices(index), closest.index);
      const LaneMask others = closest.is_far && !only_lane(lane);
      closest.is_far = crossing.crossing.root == 0 ? others : others || only_lane(lane);
      if constexpr (may_have_primitives)
        closest.primitive = select(only_lane(lane), Indices(number_of(crossing.crossing)), closest.primitive);
    }
    return closest;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

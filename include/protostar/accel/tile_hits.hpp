// Closest hits of packets of rays among the surfaces of a tile, and their shading.
#pragma once

#include <bit>
#include <type_traits>

#include "../simd/prefetch.hpp"
#include "packet.hpp"
#include "tile_surfaces.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Closest hits of packets among the surfaces of a tile. A surface is tested with all rays of a packet at
/// once, and a ray that is left in doubt is then traced alone.
template <Surface... S>
class TileHits : public TileSurfaces<S...> {
  using Base = TileSurfaces<S...>;

 public:
  using Base::Base;
  using Base::fetch, Base::has_crossings, Base::surfaces, Base::sees_one_buffer, Base::visit;

  /// Type of Closest::which if no surface has primitives.
  struct Nothing {
    Nothing(int) {}
  };
  /// Closest hit of each ray.
  struct Closest {
    Doubles t;      ///< infinity if the ray misses
    Indices place;  ///< surface's index in the scene's order; −1 if the ray misses

    /// Primitive that is hit: entry ≥ 0 of a visibility buffer, or number_of(Crossing) < 0.
    [[no_unique_address]] std::conditional_t<has_crossings, Indices, Nothing> which = -1;
  };

  /// Returns the closest hits of camera rays among the candidates and the surfaces without bounds. It stops
  /// at the first candidate whose nearest() is behind all hits: candidates are ordered by distance, or their
  /// nearest() is 0.
  template <class Origin>
  [[nodiscard]] Closest closest(const CameraPacket<Origin>& rays) const {
    Closest closest{.t = infinity, .place = -1};
    LaneMask in_doubt = false;
    for (int i = -unbounded(); i < candidates_.size(); ++i) {
      // If no ray can reach a candidate before its closest hit, none can reach those that follow.
      if (i > 0 && !any(rays.active && closest.t >= Doubles(candidates_.nearest(i)))) break;
      const int place = place_of(i);
      count_tests(rays.active);
      visit(place,
            [&](const auto& surface, const Material&) { consider(surface, place, rays, closest, in_doubt); });
    }
    if (any(in_doubt))
      return decided(rays, in_doubt, closest,
                     [&](const auto& visit_place) { this->each_candidate(visit_place); });
    return closest;
  }

  /// Returns the closest hits of camera rays, given what they see: t of a surface that is surely seen is that
  /// of its own first hit, compared with no other.
  [[nodiscard]] Closest closest(const CameraPacket<Point>& rays, const Visibility::Places& seen) const {
    const auto sees = [&](std::int32_t place) {
      return rays.active && mask_for<double>(seen == Visibility::Places(place));
    };
    LaneMask open = sees(is_in_doubt);
    Closest closest{.t = infinity, .place = -1};
    if (any(open)) {
      CameraPacket<Point> some = rays;
      some.active = open;
      closest = this->closest(some);
    }
    LaneMask left = rays.active && mask_for<double>(seen >= Visibility::Places(0)), in_doubt = false;
    for (Bits some = bits(left); some != 0; some = bits(left)) {
      const std::int32_t place = seen[std::countr_zero(some)];
      const LaneMask here = sees(place);
      count_tests(here);
      visit(place, [&](const auto& surface, const Material&) {
        const ClosestCrossings first = first_crossings(surface, rays, here, Interval{});
        closest.t = select(here, first.t, closest.t);
        in_doubt = in_doubt || (here && !first.met);
      });
      closest.place = select(here, Indices(place), closest.place);
      left = left && !here;
    }
    if (any(in_doubt))
      return decided(rays, in_doubt, closest,
                     [&](const auto& visit_place) { this->each_candidate(visit_place); });
    return closest;
  }

  /// Returns the closest hits of camera rays, given what the only visibility buffer tells of them
  /// (sees_one_buffer). t is 0 for a certain hit, which is compared with no other, until shade computes it;
  /// rays in doubt have their own.
  [[nodiscard]] Closest closest(const CameraPacket<Point>& rays, const auto& seen) const {
    count_tests(seen.met || seen.in_doubt);
    const Closest closest{.t = select(seen.met, Doubles(0.0), infinity),
                          .place = select(seen.met, Indices(only_buffer_), -1),
                          .which = select(seen.met, seen.which, -1)};
    if (!any(seen.in_doubt)) return closest;
    return decided(rays, seen.in_doubt, closest,
                   [&](const auto& visit_place) { this->each_candidate(visit_place); });
  }

  /// Returns the closest hits of other rays, by tests of all surfaces of the scene: for few surfaces.
  template <class Origin>
  [[nodiscard]] Closest closest(const RayPacket<Origin>& rays) const {
    Closest closest{.t = infinity, .place = -1};
    LaneMask in_doubt = false;
    int count = 0;
    const auto look_at_all = [&](const auto& surfaces_of_type) {
      for (const auto& surface : surfaces_of_type) {
        count_tests(rays.active);
        consider(surface, count++, rays, closest, in_doubt);
      }
    };
    (look_at_all(this->template surfaces<S>()), ...);
    if (any(in_doubt))
      return decided(rays, in_doubt, closest, [&](const auto& visit_place) {
        for (int place = 0; place < count; ++place) visit_place(place);
      });
    return closest;
  }

  /// Prefetches the materials of these hits.
  void fetch(const Closest& closest) const {
    for (Bits met = bits(closest.t < infinity); met != 0; met &= met - 1)
      visit(static_cast<int>(closest.place[std::countr_zero(met)]),
            [](const auto&, const Material& material) { prefetch_whole(material); });
  }

  /// Returns the radiance of rays with these closest hits: shade_hits(hits) for one surface after the other,
  /// so that nothing has to be gathered from different surfaces; background() for rays that miss.
  [[nodiscard]] Colors shade(const auto& rays, const Closest& closest, const auto& background,
                             const auto& shade_hits) const {
    const std::int64_t place = closest.place[wanted_lane(rays)];
    if (any(rays.active && !mask_for<double>(closest.place == Indices(place))))
      return shade_each(rays, closest, background, shade_hits);
    if (place < 0) return Colors(background());
    Colors result(Color{0});
    visit(static_cast<int>(place), [&](const auto& surface, const Material& material) {
      result = shade_on(surface, material, rays, closest, rays.active, shade_hits);
    });
    return result;
  }

 protected:
  using Base::candidates_, Base::first_x_, Base::first_y_, Base::only_buffer_, Base::statistics_;
  using Base::closest_by_itself, Base::count_tests, Base::each_candidate, Base::one, Base::place_of;
  using Base::unbounded;
  template <class R>
  static constexpr bool are_of_pinhole = Base::template are_of_pinhole<R>;

 private:
  /// Returns the lane of an active ray; a camera packet begins with one.
  template <class Origin>
  static int wanted_lane(const CameraPacket<Origin>&) {
    return 0;
  }
  template <class Origin>
  static int wanted_lane(const RayPacket<Origin>& rays) {
    return std::countr_zero(bits(rays.active)) % double_lanes;  // % tells g++ that the lane exists
  }

  /// Updates the closest hits with those of one surface, and in_doubt with the rays that it leaves in doubt.
  template <Surface T>
  void consider(const T& surface, int place, const auto& rays, Closest& closest, LaneMask& in_doubt) const {
    if constexpr (RasterizedSurface<T> && are_of_pinhole<decltype(rays)>)
      if (const auto* const drawn = this->template buffer_at<T>(place)) {
        const auto seen = drawn->seen(rays.active, first_x_, first_y_);
        ClosestCrossings first{.t = infinity, .met = seen.met, .in_doubt = seen.in_doubt};
        if (any(seen.met))
          first.t = select(seen.met, drawn->t(seen.which, seen.met, rays.direction), first.t);
        const LaneMask sooner = take(first, place, closest, in_doubt);
        closest.which = select(sooner, seen.which, closest.which);
        return;
      }
    if constexpr (is_made_of_parts<T>)
      if (has_parts(surface)) {
        Indices numbers = -1;
        const ClosestCrossings first =
            first_crossings_by_itself(surface, rays, rays.active, Interval{}, numbers);
        const LaneMask sooner = take(first, place, closest, in_doubt);
        closest.which = select(sooner, numbers, closest.which);
        return;
      }
    take(first_crossings(surface, rays, rays.active, Interval{}), place, closest, in_doubt);
  }

  /// Replaces closest hits by those that surely precede them, and returns their rays; rays with hits in an
  /// uncertain order become in_doubt.
  LaneMask take(const ClosestCrossings& first, int place, Closest& closest, LaneMask& in_doubt) const {
    // The order is certified if the errors of both t, 2^-30 of each, do not overlap.
    const LaneMask sooner = first.met && first.t < (1 - 8 * Roots::relative_error) * closest.t;
    const LaneMask later = first.t > (1 + 8 * Roots::relative_error) * closest.t;
    in_doubt = in_doubt || first.in_doubt || (first.met && !sooner && !later);
    if (!any(sooner)) return sooner;
    closest.t = select(sooner, first.t, closest.t);
    closest.place = select(sooner, Indices(place), closest.place);
    return sooner;
  }

  /// Returns the radiance of rays that hit one surface, though perhaps different primitives of it.
  template <Surface T>
  [[nodiscard]] Colors shade_on(const T& surface, const Material& material, const auto& rays,
                                const Closest& closest, LaneMask which, const auto& shade_hits) const {
    if constexpr (RasterizedSurface<T>)
      if (!any(which && mask_for<double>(closest.which < Indices(0)))) {
        const auto& drawn =
            *this->template buffer_at<T>(static_cast<int>(closest.place[std::countr_zero(bits(which))]));
        const Doubles t = sees_one_buffer() ? drawn.t(closest.which, which, rays.direction) : closest.t;
        return Colors(shade_hits(HitPacket(rays, t, which, surface, material,
                                           PrimitivesSeen<typename T::Drawn>{drawn, closest.which})));
      }
    if constexpr (is_made_of_parts<T>)
      if (has_parts(surface)) return shade_by_itself(surface, material, rays, closest, which, shade_hits);
    return Colors(shade_hits(HitPacket(rays, closest.t, which, surface, material)));
  }
  template <Surface T>
  [[nodiscard, gnu::noinline]] Colors shade_by_itself(const T& surface, const Material& material,
                                                      const auto& rays, const Closest& closest,
                                                      LaneMask which, const auto& shade_hits) const {
    Colors result(Color{0});
    for (Bits left = bits(which); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const Ray ray = rays[lane];
      // A hit from a visibility buffer, in a packet with rays that were traced alone, has no Crossing yet.
      const Crossing crossing = closest.which[lane] < 0 ? crossing_at(closest.t[lane], closest.which[lane])
                                                        : *first_crossing(surface, ray, Interval{});
      result.set(lane, shade_hits(Intersection(ray, crossing_on(surface, crossing, material))));
    }
    return result;
  }

  /// Returns the radiance of rays that hit different surfaces, or of which some miss.
  [[nodiscard, gnu::noinline]] Colors shade_each(const auto& rays, const Closest& closest,
                                                 const auto& background, const auto& shade_hits) const {
    Colors result(background());
    LaneMask left = rays.active && closest.t < infinity;
    for (Bits some = bits(left); some != 0; some = bits(left)) {
      const std::int64_t place = closest.place[std::countr_zero(some)];
      const LaneMask here = left && mask_for<double>(closest.place == Indices(place));
      visit(static_cast<int>(place), [&](const auto& surface, const Material& material) {
        result = select(here, shade_on(surface, material, rays, closest, here, shade_hits), result);
      });
      left = left && !here;
    }
    return result;
  }

  /// Returns the closest hits, with each ray in doubt traced alone. `closest` is passed by value, so that
  /// what double decides can stay in registers.
  [[nodiscard, gnu::noinline, gnu::cold]] Closest decided(const auto& rays, LaneMask in_doubt,
                                                          Closest closest, const auto& each_place) const {
    for (Bits alone = bits(in_doubt); alone != 0; alone &= alone - 1) {
      const int lane = std::countr_zero(alone);
      ++statistics_.in_doubt;
      const auto [place, crossing] = closest_by_itself(rays[lane], each_place);
      closest.t = select(one(lane), Doubles(place < 0 ? infinity : crossing.crossing.t), closest.t);
      closest.place = select(one(lane), Indices(place), closest.place);
      if constexpr (has_crossings)
        closest.which = select(one(lane), Indices(number_of(crossing.crossing)), closest.which);
    }
    return closest;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// A scene as one tile of a picture sees it: the rays of a camera can hit only the tile's candidates.
#pragma once

#include <bit>
#include <optional>
#include <vector>

#include "accelerate.hpp"
#include "crossing_packet.hpp"
#include "occluders.hpp"
#include "packet.hpp"
#include "tile_hits.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// View of a scene from one tile of a camera. Camera rays, as packets of CameraPacket or as the pixel's
/// single ray, can hit only the candidates and surfaces without bounds; all other rays query the whole scene.
/// It is Traceable, for packets too.
template <Surface... S>
class TileScene : public TileHits<S...> {
  using Base = TileHits<S...>;

 public:
  using Base::closest, Base::shade, Base::visit;
  using typename Base::Drawn;

  TileScene(const Accelerated<Scene<S...>>& everything, const Candidates& candidates,
            const std::vector<int>& surfaces_without_bounds, const Skips& skips, Occluders& occluders,
            const Drawn& drawn, RenderStatistics& statistics)
      : Base(everything.scene(), candidates, surfaces_without_bounds, drawn, statistics),
        everything_(everything),
        skips_(skips),
        occluders_(occluders) {}

  // ---- Single rays.

  /// Sets the camera ray of the current pixel.
  void set_pixel(const Ray& ray) { pixel_ = ray; }

  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range = {}) const {
    const bool is_pixel = ray.origin == pixel_.origin && ray.direction == pixel_.direction &&
                          ray.departure.kind == Departure::Kind::none;
    if (!is_pixel || range.min != 0 || range.max != infinity) {
      count_alone();
      return everything_.intersect(ray, range);
    }
    const auto [place, crossing] =
        closest_by_itself(ray, [&](const auto& visit_place) { this->each_candidate(visit_place); });
    return place < 0 ? std::nullopt : std::optional(Intersection(ray, crossing));
  }

  [[nodiscard]] bool occluded(const Ray& ray, Interval range = {}) const {
    count_alone();
    return everything_.occluded(ray, range);
  }

  void crossings(const Ray& ray, Interval range, auto&& report) const {
    count_alone();
    everything_.crossings(ray, range, report);
  }

  // ---- Packets.

  /// Traces camera rays; returns shade_hits(hits), or background() for rays that miss.
  template <class Origin>
  [[nodiscard]] Colors follow(const CameraPacket<Origin>& rays, const auto& background,
                              const auto& shade_hits) const {
    return shade(rays, closest(rays), background, shade_hits);
  }

  /// Traces other rays; in a scene of many surfaces, each ray alone.
  template <class Origin>
  [[nodiscard]] Colors follow(const RayPacket<Origin>& rays, const auto& background,
                              const auto& shade_hits) const {
    if (scene_.size() > few) return follow_each(rays, background, shade_hits);
    statistics_.other_rays += static_cast<std::uint64_t>(std::popcount(bits(rays.active)));
    return shade(rays, closest(rays), background, shade_hits);
  }

  /// Traces rays that leave different primitives, each ray alone.
  [[nodiscard]] Colors follow(const PacketFromPrimitives& rays, const auto& background,
                              const auto& shade_hits) const {
    return follow_each(rays, background, shade_hits);
  }

  /// Traces each active ray alone; returns shade_hits(hit), or background() for rays that miss.
  template <class R>
  requires requires(R rays) { rays.active; }
  [[nodiscard, gnu::noinline]] Colors follow_each(const R& rays, const auto& background,
                                                  const auto& shade_hits) const {
    Colors result(background());
    for (Bits alone = bits(rays.active); alone != 0; alone &= alone - 1) {
      const int lane = std::countr_zero(alone);
      count_alone();
      if (const auto hit = everything_.intersect(rays[lane], Interval{})) {
        result.set(lane, shade_hits(*hit));
      }
    }
    return result;
  }

  /// Returns which camera rays have any hit in the range.
  template <class Origin>
  [[nodiscard]] LaneMask occluded(const CameraPacket<Origin>& rays, Interval range) const {
    LaneMask found = false, left = rays.active;
    for (int i = -unbounded(); i < candidates_.size() && any(left); ++i)
      test(place_of(i), rays, range, found, left);
    return found;
  }

  /// Returns which other rays have any hit in the range. In a scene of many surfaces, those tested are the
  /// ones in a cone to the light, or each ray is traced alone.
  template <class Origin>
  [[nodiscard]] LaneMask occluded(const RayPacket<Origin>& rays, Interval range) const {
    LaneMask found = false, left = rays.active;
    statistics_.other_rays += static_cast<std::uint64_t>(std::popcount(bits(left)));
    if (!any(left)) return found;
    if (scene_.size() > few) {
      look_for_occluders(rays, range, found, left);
      return found;
    }
    for (int place = 0; place < static_cast<int>(scene_.size()) && any(left); ++place)
      test(place, rays, range, found, left);
    return found;
  }

  [[nodiscard]] LaneMask occluded(const PacketFromPrimitives& rays, Interval range) const {
    statistics_.other_rays += static_cast<std::uint64_t>(std::popcount(bits(rays.active)));
    return occluded_each_by_itself(rays, rays.active, range);
  }

  /// Calls visit_crossing for all hits of camera rays, as Scene::crossings does. Its argument has a color()
  /// for each ray: the surface's, or white, which leaves a product as it is, for rays that do not cross the
  /// surface.
  template <class Origin>
  void crossings(const CameraPacket<Origin>& rays, Interval range, auto&& visit_crossing) const {
    // Surfaces without bounds are in the scene's order, and so are candidates unless the integrator shades
    // closest hits; hence so are the visits.
    for (int k = -unbounded(), i = 0; k < 0 || i < candidates_.size();) {
      const bool is_candidate = k == 0 || (i < candidates_.size() && place_of(i) < place_of(k));
      const int next = is_candidate ? i++ : k++;
      visit(place_of(next), [&](const auto& surface, const Material& material) {
        const LaneMask maybe = may_cross(surface, place_of(next), rays, range);
        count_tests(maybe);
        if (material.texture)
          return each_textured_crossing(surface, material, rays, maybe, range, visit_crossing);
        each_crossing_of(surface, rays, maybe, range, [&](LaneMask which, Doubles) {
          if (any(which)) visit_crossing(SomeCross{which, material.diffuse});
        });
      });
    }
  }

  void crossings(const CrossingPacket& rays, Interval, auto&& visit_crossing) const {
    for (const CrossingPacket::Crossed& crossed : rays.crossed)
      visit(crossed.place, [&](const auto&, const Material& material) {
        const auto which = mask_of<double, double_lanes>(crossed.lanes >> rays.first_lane);
        visit_crossing(SomeCross{which, material.diffuse});  // on the way in,
        visit_crossing(SomeCross{which, material.diffuse});  // and out
      });
  }

 private:
  using Base::candidates_, Base::scene_, Base::statistics_, Base::unbounded_, Base::first_x_, Base::first_y_;
  using Base::closest_by_itself, Base::count_tests, Base::each_candidate, Base::one, Base::place_of;
  using Base::unbounded;
  template <class R>
  static constexpr bool are_of_pinhole = Base::template are_of_pinhole<R>;

  /// Largest number of surfaces for which testing all of them is faster than a traversal.
  static constexpr std::size_t few = 16;

  struct SomeCross {
    LaneMask which;
    Colors surface_color;
    [[nodiscard]] Colors color() const { return select(which, surface_color, Color{1}); }
  };

  void count_alone() const { ++statistics_.other_rays, ++statistics_.rays_alone; }

  /// Returns those of the rays in doubt that cross a surface inside the range.
  template <Surface T>
  [[gnu::noinline, gnu::cold]] LaneMask decide(const T& surface, const auto& rays, LaneMask in_doubt,
                                               Interval range) const {
    LaneMask crossed = false;
    for (Bits alone = bits(in_doubt); alone != 0; alone &= alone - 1) {
      const int lane = std::countr_zero(alone);
      ++statistics_.in_doubt;
      if (any_hit(surface, rays[lane], range)) crossed = crossed || one(lane);
    }
    return crossed;
  }

  [[gnu::noinline]] void look_for_occluders(const RayPacket<Vectors>& rays, Interval range, LaneMask& found,
                                            LaneMask left) const {
    const std::vector<int>* places = nullptr;
    if (skips_.occluder_lists && range.min == 0 && range.max == 1)
      places = occluders_.between(rays, left, [&](const auto& half_spaces, const auto& visit_place) {
        int first = 0;
        (search<S>(half_spaces, first, visit_place), ...);
        for (const int place : unbounded_) visit_place(place, SphereAround{Point{0}, infinity});
      });
    if (places == nullptr) {
      found = found || occluded_each_by_itself(rays, left, range);
      return;
    }
    for (const int place : *places) {
      test(place, rays, range, found, left);
      if (!any(left)) return;
    }
  }

  /// Calls visit_place(index, sphere) for the surfaces of one type that may reach into half-spaces; `first`
  /// is the index of the type's first surface, and becomes that of the next type's.
  template <Surface T>
  void search(const auto& half_spaces, int& first, const auto& visit_place) const {
    everything_.template frustum_query<T>(
        half_spaces, [&](const Numbers& numbers, Bits some, const SpheresAround& around) {
          for (; some != 0; some &= some - 1) {
            const int lane = std::countr_zero(some);
            visit_place(first + static_cast<int>(numbers[lane]), around[lane]);
          }
        });
    first += static_cast<int>(scene_.template surfaces<T>().size());
  }

  [[nodiscard, gnu::noinline]] LaneMask occluded_each_by_itself(const auto& rays, LaneMask active,
                                                                Interval range) const {
    LaneMask found = false;
    for (Bits alone = bits(active); alone != 0; alone &= alone - 1) {
      const int lane = std::countr_zero(alone);
      ++statistics_.rays_alone;
      if (everything_.occluded(rays[lane], range)) found = found || one(lane);
    }
    return found;
  }

  /// Moves the rays that cross a surface inside the range from left to found.
  void test(int place, const auto& rays, Interval range, LaneMask& found, LaneMask& left) const {
    count_tests(left);
    visit(place, [&](const auto& surface, const Material&) {
      const CrossedByEach<LaneMask> tested = crossed(surface, place, rays, left, range);
      LaneMask crossed = tested.crossed;
      if (any(tested.in_doubt)) crossed = crossed || decide(surface, rays, tested.in_doubt, range);
      if (!any(crossed)) return;
      found = found || crossed;
      left = left && !crossed;
    });
  }

  /// Returns which of the remaining rays cross a surface inside the range.
  template <Surface T>
  [[nodiscard]] CrossedByEach<LaneMask> crossed(const T& surface, [[maybe_unused]] int place,
                                                const auto& rays, LaneMask left, Interval range) const {
    if constexpr (RasterizedSurface<T> && are_of_pinhole<decltype(rays)>)
      if (const auto* const drawn = this->template buffer_at<T>(place);
          drawn && range.min == 0 && range.max == infinity) {
        const auto seen = drawn->seen(left, first_x_, first_y_);
        return {.crossed = seen.met, .in_doubt = seen.in_doubt};
      }
    return crossed_in(surface, rays, left, range);
  }

  /// Returns which rays may cross a surface inside the range, as far as its visibility buffer tells.
  template <Surface T>
  [[nodiscard]] LaneMask may_cross(const T&, [[maybe_unused]] int place, const auto& rays,
                                   [[maybe_unused]] Interval range) const {
    if constexpr (RasterizedSurface<T> && are_of_pinhole<decltype(rays)>)
      if (const auto* const drawn = this->template buffer_at<T>(place); drawn && range.min >= 0) {
        count_tests(rays.active);
        const auto seen = drawn->seen(rays.active, first_x_, first_y_);
        return seen.met || seen.in_doubt;
      }
    return rays.active;
  }

  /// Calls tell(mask, t) for the crossings of some rays with one surface, near before far, with the mask of
  /// the rays that have one.
  template <Surface T>
  void each_crossing_of(const T& surface, const auto& rays, LaneMask some, Interval range,
                        const auto& tell) const {
    LaneMask alone = some;
    if constexpr (takes_packets<T>) {
      const RootsOfEach<Doubles, LaneMask> roots = roots_of_each(surface, rays, some);
      const Inside near = lies_inside(roots.near(), range), far = lies_inside(roots.far(), range);
      alone = roots.in_doubt || (roots.meets && ((near.maybe && !near.surely) || (far.maybe && !far.surely)));
      const LaneMask sure = roots.meets && !alone;
      tell(sure && near.surely, roots.near());
      if (roots.count > 1) tell(sure && far.surely, roots.far());
      statistics_.in_doubt += static_cast<std::uint64_t>(std::popcount(bits(alone)));
    }
    if (any(alone))
      each_crossing_by_itself(surface, rays, alone, range,
                              [&](int lane, const Crossing& crossing) { tell(one(lane), crossing.t); });
  }

  /// Visits the crossings of some rays with a textured surface, each with its color.
  template <Surface T>
  [[gnu::noinline]] void each_textured_crossing(const T& surface, const Material& material, const auto& rays,
                                                LaneMask some, Interval range,
                                                const auto& visit_crossing) const {
    if (has_parts(surface))
      each_crossing_by_itself(surface, rays, some, range, [&](int lane, const Crossing& crossing) {
        const Intersection hit(rays[lane], crossing_on(surface, crossing, material));
        visit_crossing(SomeCross{one(lane), hit.color()});
      });
    else
      each_crossing_of(surface, rays, some, range, [&](LaneMask which, Doubles t) {
        const HitPacket crossings(rays, t, which, surface, material);
        if (any(which)) visit_crossing(SomeCross{which, crossings.color()});
      });
  }

  [[gnu::noinline, gnu::cold]] void each_crossing_by_itself(const auto& surface, const auto& rays,
                                                            LaneMask alone, Interval range,
                                                            const auto& tell) const {
    for (Bits left = bits(alone); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      each_crossing(surface, rays[lane], range, [&](const Crossing& crossing) { tell(lane, crossing); });
    }
  }

  const Accelerated<Scene<S...>>& everything_;
  const Skips& skips_;
  Occluders& occluders_;
  Ray pixel_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

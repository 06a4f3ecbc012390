// A scene as one tile of a picture sees it: the rays of a camera can hit only the tile's candidates.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <type_traits>
#include <vector>

#include "../plain_vector.hpp"
#include "accelerate.hpp"
#include "hits_among_few.hpp"
#include "occluders.hpp"
#include "packet.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// View of a scene from one tile of a camera. Packets of camera rays are tested with the candidates alone,
/// and so is intersect() of the pixel's single ray in the default range; every other query asks the whole
/// scene. It is Traceable, for packets too.
template <Surface... S>
class TileScene : public HitsAmongFew<S...> {
  using Base = HitsAmongFew<S...>;

 public:
  using Base::closest, Base::shade, Base::visit;
  using typename Base::First, typename Base::State;

  TileScene(const Accelerated<Scene<S...>>& accelerated, const Candidates& candidates, const Skips& skips,
            State& state)
      : Base(accelerated, candidates, state), skips_(skips) {}

  [[nodiscard]] const std::vector<Light>& lights() const { return scene_.lights(); }
  [[nodiscard]] const Color& ambient() const { return scene_.ambient(); }
  [[nodiscard]] const std::optional<Color>& sky() const { return scene_.sky(); }
  [[nodiscard]] const Environment& environment() const { return scene_.environment(); }

  // Members of Scene beyond those of Traceable.
  [[nodiscard]] std::size_t size() const { return scene_.size(); }
  [[nodiscard]] std::size_t environment_version() const { return scene_.environment_version(); }
  template <class T>
  [[nodiscard]] const SceneVector<T>& surfaces() const {
    return scene_.template surfaces<T>();
  }
  template <class T>
  [[nodiscard]] const SceneVector<Material>& materials() const {
    return scene_.template materials<T>();
  }

  // ---- Single rays.

  /// Sets the camera ray of the current sample, which intersect() tests with the tile's candidates alone.
  void set_camera_ray(const Ray& ray) { camera_ray_ = ray; }

  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range = {}) const {
    const bool is_camera_ray = camera_ray_ && ray.origin == camera_ray_->origin &&
                               ray.direction == camera_ray_->direction &&
                               ray.departure.kind == Departure::Kind::none;
    if (!is_camera_ray || range.min != 0 || range.max != infinity) {
      count_alone();
      return accelerated_.intersect(ray, range);
    }
    const auto [index, crossing] = this->closest_of_one_ray(ray, candidates_.indices());
    if (index < 0) return std::nullopt;
    return std::optional<Intersection>(std::in_place, ray, crossing);
  }

  [[nodiscard]] bool occluded(const Ray& ray, Interval range = {}) const {
    count_alone();
    return accelerated_.occluded(ray, range);
  }

  void crossings(const Ray& ray, Interval range, auto&& report) const {
    count_alone();
    accelerated_.crossings(ray, range, report);
  }

  /// Traces rays that may depart from different surfaces, as many as there are lanes or fewer: ray(k) is the
  /// k-th, and its closest hit becomes *result(k), which is not initialized, as by make_hit.
  void intersect_each(std::size_t count, const auto& ray, const auto& result) const {
    if constexpr (Base::tests_in_lanes)
      if (count > 0 && scene_.size() <= few_surfaces && this->tested_in_lanes() > 0)
        return this->intersect_in_lanes(count, ray, result);
    for (std::size_t k = 0; k < count; ++k) {
      count_alone();
      Base::make_hit(result(k), ray(k), accelerated_.closest_crossing(ray(k), Interval{}));
    }
  }

  // ---- Packets.

  /// Traces camera rays; returns shade_hits(hits), or background() for rays that miss.
  [[nodiscard]] Colors follow(const CameraPacket& rays, const auto& background,
                              const auto& shade_hits) const {
    return shade(rays, closest(rays), background, shade_hits);
  }

  /// Traces other rays; each ray alone in a scene of many surfaces, or if they leave primitives.
  [[nodiscard]] Colors follow(const RayPacket& rays, const auto& background, const auto& shade_hits) const {
    if (scene_.size() > few_surfaces || rays.leave_primitives())
      return follow_each(rays, background, shade_hits);
    state_.counts.other_rays += static_cast<std::uint64_t>(std::popcount(bits(rays.active)));
    return shade(rays, closest(rays), background, shade_hits);
  }

  /// Traces each active ray alone; returns shade_hits(hit, lane), or shade_hits(hit) if it takes no lane;
  /// background() for rays that miss.
  [[nodiscard, gnu::noinline]] Colors follow_each(const RayPacket& rays, const auto& background,
                                                  const auto& shade_hits) const {
    Colors result(background());
    for (const int lane : lanes_in(rays.active)) {
      count_alone();
      if (const auto hit = accelerated_.intersect(rays[lane], Interval{}))
        result.set(lane, this->shade_in_lane(shade_hits, *hit, lane));
    }
    return result;
  }

  /// Returns which camera rays have any hit in the range.
  [[nodiscard]] LaneMask occluded(const CameraPacket& rays, Interval range) const {
    LaneMask found = false, remaining = rays.active;
    for (const std::uint32_t index : candidates_.indices()) {
      if (!any(remaining)) break;
      test_any(index, rays, range, true, found, remaining);
    }
    return found;
  }

  /// Returns which other rays have any hit in the range. In a scene of many surfaces, rays to a light are
  /// tested with the surfaces in a cone around them; if there is no such list, each ray is traced alone.
  ///
  /// It is inlined where a surface is shaded, for each type of surface, with the tests of the first type.
  /// Scenes of more than two types call one copy of the tests of all others (TileHits::calls_others).
  [[nodiscard]] LaneMask occluded(const RayPacket& rays, Interval range) const {
    state_.counts.other_rays += static_cast<std::uint64_t>(std::popcount(bits(rays.active)));
    if (!any(rays.active)) return false;
    // Copies, here and below, let the packet itself stay in registers.
    if (rays.leave_primitives()) return occluded_one_by_one(RayPacket(rays), range);
    if (scene_.size() > few_surfaces) return occluded_among_many(RayPacket(rays), range);
    const LaneMask found = occluded_by<First>(rays, rays.active, range);
    const LaneMask remaining = rays.active && !found;
    if (scene_.size() == scene_.template surfaces<First>().size() || !any(remaining)) return found;
    if constexpr (Base::calls_others)
      return found || called_occluded_by_others(RayPacket(rays), remaining, range);
    else
      return found || occluded_by_others(rays, remaining, range);
  }

  /// Stores the surfaces that camera rays with these directions may cross (set_crossed). Returns true if
  /// float decides every ray of each of them and none has a texture, so that the packets need no real rays.
  [[nodiscard]] bool list_crossed(const WideVectors& directions) const {
    state_.crossed.clear();
    bool is_sure = true;
    state_.counts.float_tests += static_cast<std::uint64_t>(candidates_.size() * float_lanes);
    for (int k = 0; k < candidates_.size(); ++k) {
      const SpherePass passed = pass(candidates_.sphere(k), directions);
      const Bits maybe = bits(passed.maybe());
      if (maybe == 0) continue;
      const Bits surely = bits(passed.surely()) & maybe;
      state_.crossed.push_back({candidates_.index(k), maybe, surely});
      is_sure = is_sure && surely == maybe && !this->has_texture(candidates_.index(k));
    }
    return is_sure;
  }

  /// Sets the surfaces that a block of camera rays may cross; the next packet's first ray is ray
  /// `first_lane` of the block, and crossings are asked for in t > 0. Null: no block has been tested in
  /// float.
  void set_crossed(const PlainVector<CrossedByBlock>* crossed, int first_lane = 0) const {
    crossed_ = crossed, first_lane_ = first_lane;
  }

  /// Calls visit_crossing for all hits of camera rays, as Scene::crossings does. Its argument has a color()
  /// for each ray: the surface's, or white, which leaves a product as it is, for rays that do not cross the
  /// surface. The candidates are in the scene's order unless the integrator shades closest hits.
  void crossings(const CameraPacket& rays, Interval range, auto&& visit_crossing) const {
    if (crossed_ == nullptr) {
      for (const std::uint32_t index : candidates_.indices())
        visit_crossings(index, rays, rays.active, range, visit_crossing);
      return;
    }
    for (const CrossedByBlock& crossed : *crossed_) {
      const auto lanes = mask_of<double, double_lanes>(crossed.maybe >> first_lane_);
      if (crossed.maybe != crossed.surely || this->has_texture(crossed.index)) {
        visit_crossings(crossed.index, rays, rays.active && lanes, range, visit_crossing);
        continue;
      }
      visit(crossed.index, [&](const auto&, const Material& material) {
        visit_crossing(MaskedCrossing{lanes, material.diffuse});  // on the way in,
        visit_crossing(MaskedCrossing{lanes, material.diffuse});  // and out
      });
    }
  }

 private:
  using Base::accelerated_, Base::candidates_, Base::scene_, Base::state_, Base::first_x_, Base::first_y_;
  using Base::count_tests, Base::only_lane;

  struct MaskedCrossing {
    LaneMask which;
    Colors surface_color;
    [[nodiscard]] Colors color() const { return select(which, surface_color, Color{1}); }
  };

  void count_alone() const { ++state_.counts.other_rays, ++state_.counts.rays_alone; }

  /// Returns which of some rays have any hit in the range on surfaces of type T.
  template <Surface T>
  [[nodiscard]] LaneMask occluded_by(const RayPacket& rays, LaneMask remaining, Interval range) const {
    LaneMask found = false;
    for (const T& surface : scene_.template surfaces<T>()) {
      if (!any(remaining)) break;
      count_tests(remaining);
      take_crossed(surface, rays, crossed_in(surface, rays, remaining, range), range, found, remaining);
    }
    return found;
  }

  /// Returns which of some rays have any hit in the range on surfaces of other types than the first.
  [[nodiscard]] LaneMask occluded_by_others(const RayPacket& rays, LaneMask remaining, Interval range) const {
    LaneMask found = false;
    const auto look_at = [&]<class T>(std::type_identity<T>) {
      if constexpr (!std::same_as<T, First>)
        found = found || occluded_by<T>(rays, remaining && !found, range);
    };
    (look_at(std::type_identity<S>{}), ...);
    return found;
  }
  [[nodiscard, gnu::noinline]] LaneMask called_occluded_by_others(const RayPacket& rays, LaneMask remaining,
                                                                  Interval range) const {
    return occluded_by_others(rays, remaining, range);
  }

  [[nodiscard, gnu::noinline]] LaneMask occluded_among_many(const RayPacket& rays, Interval range) const {
    const PlainVector<int>* indices = nullptr;
    if (skips_.occluder_lists && range.min == 0 && range.max == 1)
      indices = state_.occluders.between(rays, rays.active,
                                         [&](const auto& half_spaces, const VisitSurfaces& visit_some) {
                                           accelerated_.frustum_query(half_spaces, visit_some);
                                         });
    if (indices == nullptr) return occluded_one_by_one(rays, range);
    LaneMask found = false, remaining = rays.active;
    for (const int index : *indices) {
      test_any(index, rays, range, false, found, remaining);
      if (!any(remaining)) break;
    }
    return found;
  }

  [[nodiscard, gnu::noinline]] LaneMask occluded_one_by_one(const RayPacket& rays, Interval range) const {
    LaneMask found = false;
    for (const int lane : lanes_in(rays.active)) {
      ++state_.counts.rays_alone;
      if (accelerated_.occluded(rays[lane], range)) found = found || only_lane(lane);
    }
    return found;
  }

  /// Moves the rays that cross a surface inside the range from `remaining` to `found`.
  void test_any(std::int64_t index, const RayPacket& rays, Interval range,
                [[maybe_unused]] bool are_of_camera, LaneMask& found, LaneMask& remaining) const {
    count_tests(remaining);
    visit(index, [&]<class T>(const T& surface, const Material&) {
      CrossedByEach<LaneMask> tested{.crossed = false, .in_doubt = false};
      bool is_drawn = false;
      if constexpr (RasterizedSurface<T>)
        if (are_of_camera && range.min == 0 && range.max == infinity)
          if (const auto* const drawn = this->template buffer_at<T>(index)) {
            const auto seen = drawn->seen(remaining, this->first_x_, this->first_y_);
            tested = {.crossed = seen.met, .in_doubt = seen.in_doubt};
            is_drawn = true;
          }
      if (!is_drawn) tested = crossed_in(surface, rays, remaining, range);
      take_crossed(surface, rays, tested, range, found, remaining);
    });
  }

  /// Moves the rays that cross a surface inside the range, as a test of all tells, from `remaining` to
  /// `found`.
  template <Surface T>
  void take_crossed(const T& surface, const RayPacket& rays, const CrossedByEach<LaneMask>& tested,
                    Interval range, LaneMask& found, LaneMask& remaining) const {
    LaneMask crossed = tested.crossed;
    if (any(tested.in_doubt)) crossed = crossed || decide(surface, RayPacket(rays), tested.in_doubt, range);
    if (!any(crossed)) return;
    found = found || crossed;
    remaining = remaining && !crossed;
  }

  /// Returns those of the rays in doubt that cross a surface inside the range.
  template <Surface T>
  [[gnu::noinline, gnu::cold]] LaneMask decide(const T& surface, const RayPacket& rays, LaneMask in_doubt,
                                               Interval range) const {
    LaneMask crossed = false;
    for (const int lane : lanes_in(in_doubt)) {
      ++state_.counts.in_doubt;
      if (any_hit(surface, rays[lane], range)) crossed = crossed || only_lane(lane);
    }
    return crossed;
  }

  /// Visits the crossings of camera rays, those of `lanes`, with one surface, near before far.
  void visit_crossings(std::int64_t index, const CameraPacket& rays, LaneMask lanes, Interval range,
                       const auto& visit_crossing) const {
    visit(index, [&](const auto& surface, const Material& material) {
      const LaneMask maybe = may_cross(surface, index, lanes, range);
      count_tests(maybe);
      if (material.texture)
        return each_textured_crossing(surface, material, rays, maybe, range, visit_crossing);
      each_crossing_of(surface, rays, maybe, range, [&](LaneMask which, Doubles) {
        if (any(which)) visit_crossing(MaskedCrossing{which, material.diffuse});
      });
    });
  }

  /// Returns which rays may cross a surface inside the range, as far as its visibility buffer tells.
  template <Surface T>
  [[nodiscard]] LaneMask may_cross(const T&, [[maybe_unused]] std::int64_t index, LaneMask lanes,
                                   [[maybe_unused]] Interval range) const {
    if constexpr (RasterizedSurface<T>)
      if (const auto* const drawn = this->template buffer_at<T>(index); drawn && range.min >= 0) {
        count_tests(lanes);
        const auto seen = drawn->seen(lanes, first_x_, first_y_);
        return seen.met || seen.in_doubt;
      }
    return lanes;
  }

  /// Calls tell(mask, t) for the crossings of some rays with one surface, near before far, with the mask of
  /// the rays that have one.
  template <Surface T>
  void each_crossing_of(const T& surface, const CameraPacket& rays, LaneMask some, Interval range,
                        const auto& tell) const {
    LaneMask alone = some;
    if constexpr (takes_packets<T>) {
      const RootsOfEach<Doubles, LaneMask> roots = roots_of_each(surface, rays, some);
      const Inside near = lies_inside(roots.near(), range), far = lies_inside(roots.far(), range);
      alone = roots.in_doubt || (roots.meets && ((near.maybe && !near.surely) || (far.maybe && !far.surely)));
      const LaneMask sure = roots.meets && !alone;
      tell(sure && near.surely, roots.near());
      if (roots.count > 1) tell(sure && far.surely, roots.far());
      state_.counts.in_doubt += static_cast<std::uint64_t>(std::popcount(bits(alone)));
    }
    if (any(alone))
      each_crossing_one_by_one(surface, rays, alone, range, [&](int lane, const Crossing& crossing) {
        tell(only_lane(lane), crossing.t);
      });
  }

  /// Visits the crossings of some rays with a textured surface, each with its color.
  template <Surface T>
  [[gnu::noinline]] void each_textured_crossing(const T& surface, const Material& material,
                                                const CameraPacket& rays, LaneMask some, Interval range,
                                                const auto& visit_crossing) const {
    if (has_primitives(surface))
      each_crossing_one_by_one(surface, rays, some, range, [&](int lane, const Crossing& crossing) {
        const Intersection hit(rays[lane], crossing_on(surface, crossing, material));
        visit_crossing(MaskedCrossing{only_lane(lane), hit.color()});
      });
    else
      each_crossing_of(surface, rays, some, range, [&](LaneMask which, Doubles t) {
        const HitPacket crossings(rays, t, which, surface, material);
        if (any(which)) visit_crossing(MaskedCrossing{which, crossings.color()});
      });
  }

  [[gnu::noinline, gnu::cold]] void each_crossing_one_by_one(const auto& surface, const CameraPacket& rays,
                                                             LaneMask alone, Interval range,
                                                             const auto& tell) const {
    for (const int lane : lanes_in(alone))
      each_crossing(surface, rays[lane], range, [&](const Crossing& crossing) { tell(lane, crossing); });
  }

  const Skips& skips_;
  std::optional<Ray> camera_ray_;
  mutable const PlainVector<CrossedByBlock>* crossed_ = nullptr;
  mutable int first_lane_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

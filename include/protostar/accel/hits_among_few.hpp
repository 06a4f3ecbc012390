// Closest hits of rays that depart from different surfaces, among the surfaces of a scene of few.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <type_traits>
#include <utility>

#include "../large_pages.hpp"
#include "accelerate.hpp"
#include "packet.hpp"
#include "tile_hits.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Hits of a tile, and those of other rays in lanes. A packet's rays depart from one geometry; here each has
/// its own.
template <Surface... S>
class HitsAmongFew : public TileHits<S...> {
  using Base = TileHits<S...>;

 public:
  using Base::visit;
  using typename Base::Closest, typename Base::State;

  HitsAmongFew(const Accelerated<Scene<S...>>& accelerated, const Candidates& candidates, State& state)
      : Base(accelerated, candidates, state) {}

  /// Calls tell(ray, crossing, lane) for each of these closest hits, and returns which rays have one.
  LaneMask each_hit(const RayPacket& rays, const Closest& closest, const auto& tell) const {
    const LaneMask met = rays.active && closest.t < infinity;
    for (const int lane : lanes_in(met)) {
      const Ray ray = rays[lane];
      const std::int64_t index = closest.index[lane];
      visit(index, [&](const auto& surface, const Material& material) {
        const Crossing crossing = Base::crossing_of(surface, ray, closest, lane);
        tell(ray, crossing_with_constants(index, surface, crossing, material), lane);
      });
    }
    return met;
  }

  /// Makes the closest hit of a ray at a place that is not initialized: an Intersection, which has the ray,
  /// or its crossing alone. A crossing with no surface means that there is no hit.
  static void make_hit(std::optional<Intersection>* place, const Ray& ray, const SurfaceCrossing& first) {
    if (first.surface == nullptr)
      new (place) std::optional<Intersection>();
    else
      new (place) std::optional<Intersection>(std::in_place, ray, first);
  }
  static void make_hit(SurfaceCrossing* place, const Ray&, const SurfaceCrossing& first) {
    new (place) SurfaceCrossing(first);
  }

 protected:
  using Base::accelerated_, Base::count_tests, Base::scene_, Base::state_;

  /// True for a type whose equation takes packets, without primitives.
  template <class T>
  static constexpr bool is_tested_in_lanes =
      takes_packets<T> && !SurfaceOfLanes<T> && !is_made_of_primitives<T>;

  /// True if there are such types, all others come behind them in the scene's order, and there are lanes for
  /// three rays or more: two are traced as fast one after the other.
  static constexpr bool tests_in_lanes = [] {
    bool any = false, any_other = false, in_order = true;
    ((is_tested_in_lanes<S> ? (any = true, in_order = in_order && !any_other) : (any_other = true)), ...);
    return double_lanes > 2 && any && in_order;
  }();

  /// Returns the number of surfaces of these types.
  [[nodiscard]] std::size_t tested_in_lanes() const {
    return ((is_tested_in_lanes<S> ? scene_.template surfaces<S>().size() : 0) + ...);
  }

  /// Finds the closest hits of 1 to double_lanes rays in a scene of at most few_surfaces surfaces: ray(k) is
  /// the k-th, and its hit becomes *place(k), which is not initialized, as by make_hit. All surfaces of types
  /// that are tested in lanes are tested, and then the accelerated scene looks for closer hits on others. The
  /// surface that a ray leaves is tested with that ray alone, which knows its departure, and so is each
  /// surface that coincides with it: far from the scene's origin, the rounded origin of the ray is certainly
  /// off that surface, and a test in lanes would be sure of a wrong hit. Planes are not crossed again. The
  /// accelerated scene answers for rays in doubt.
  void intersect_in_lanes(std::size_t count, const auto& ray, const auto& place) const {
    constexpr auto lanes = static_cast<std::size_t>(double_lanes);
    std::array<double, lanes> numbers[7];
    Bits leaving[few_surfaces] = {};
    for (std::size_t k = 0; k < lanes; ++k) {
      const Ray& one = ray(std::min(k, count - 1));
      const double of_ray[7] = {one.origin.x,    one.origin.y,    one.origin.z, one.direction.x,
                                one.direction.y, one.direction.z, one.time};
      for (std::size_t i = 0; i < 7; ++i) numbers[i][k] = of_ray[i];
      if (k >= count) continue;
      for (const int surface : lanes_in(accelerated_.departed_together(one)))
        leaving[surface] |= Bits{1} << k;
    }
    const auto load = [&](std::size_t i) { return Doubles::load(numbers[i].data()); };
    RayPacket rays({load(0), load(1), load(2)}, {load(3), load(4), load(5)},
                   mask_of<double, double_lanes>(first_bits(static_cast<int>(count))));
    rays.time = load(6);

    Closest found;
    LaneMask in_doubt = false;
    std::int64_t index = 0;
    const auto test_all = [&]<class T>(const SceneVector<T>& surfaces) {
      const auto& equations = accelerated_.template equations<T>();
      for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const Bits alone = leaving[index] & bits(rays.active);
        const LaneMask others = rays.active && !mask_of<double, double_lanes>(alone);
        count_tests(rays.active);
        const FirstRootOfEach<Doubles, LaneMask> root =
            first_root_of_each(equations[i].equation(rays), others);
        ClosestCrossings first{
            .t = root.t, .met = root.is_there, .in_doubt = root.in_doubt, .is_far = root.is_far && others};
        if constexpr (is_quadratic<T>)
          for (const int lane : lanes_in(alone))
            if (const auto crossing =
                    first_crossing(surfaces[i], ray(static_cast<std::size_t>(lane)), Interval{})) {
              first.t.set(lane, crossing->t);
              first.met = first.met || Base::only_lane(lane);
              if (crossing->root == 1) first.is_far = first.is_far || Base::only_lane(lane);
            }
        Base::keep_closer(first, index++, found, in_doubt);
      }
    };
    const auto test_if_in_lanes = [&]<class T>(std::type_identity<T>) {
      if constexpr (is_tested_in_lanes<T>) test_all(this->scene_.template surfaces<T>());
    };
    (test_if_in_lanes(std::type_identity<S>{}), ...);

    state_.counts.other_rays += count;
    for (std::size_t k = 0; k < count; ++k) {
      const int lane = static_cast<int>(k);
      const Ray& one = ray(k);
      if ((bits(in_doubt) >> k & 1) != 0) {
        ++state_.counts.in_doubt;
        make_hit(place(k), one, accelerated_.closest_crossing(one, Interval{}));
        continue;
      }
      const auto place_closest = [&](SurfaceCrossing first) {
        Interval range;
        if (first.surface != nullptr) range.max = upper_bound_of(first.crossing.t);
        const auto look_if_other = [&]<class T>(std::type_identity<T>) {
          if constexpr (!is_tested_in_lanes<T>)
            this->accelerated_.template look_for_first<T>(one, range, first);
        };
        (look_if_other(std::type_identity<S>{}), ...);
        make_hit(place(k), one, first);
      };
      if (found.index[lane] < 0)
        place_closest({});
      else
        visit(found.index[lane], [&](const auto& surface, const Material& material) {
          const Crossing crossing{found.t[lane], static_cast<int>(bits(found.is_far) >> k & 1)};
          place_closest(crossing_with_constants(found.index[lane], surface, crossing, material));
        });
    }
  }

 private:
  /// Returns a crossing with the surface with an index in the scene's order, and with its constants.
  [[nodiscard]] SurfaceCrossing crossing_with_constants(std::int64_t index, const auto& surface,
                                                        const Crossing& crossing,
                                                        const Material& material) const {
    SurfaceCrossing on = crossing_on(surface, crossing, material);
    on.constants = accelerated_.constants(static_cast<std::size_t>(index));
    return on;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

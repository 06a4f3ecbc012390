// A scene as one tile of a picture sees it: the rays of a camera can hit only the tile's candidates.
#pragma once

#include <bit>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "../simd/prefetch.hpp"
#include "accelerate.hpp"
#include "drawn.hpp"
#include "finder.hpp"
#include "occluders.hpp"
#include "packet.hpp"
#include "tile.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Float test of which of many candidates a packet of a pinhole may hit; the others are not tested in double.
/// For other cameras, or few candidates, it rules out nothing.
template <class Origin>
class CandidateFilter {
 public:
  /// Borrows the candidates.
  CandidateFilter(const Candidates& candidates, const CameraPacket<Origin>& rays, const Skips& skips)
      : candidates_(candidates),
        is_useful_(std::same_as<Origin, Point> && candidates.size() > untried && skips.passed_surfaces) {
    if (is_useful_) directions_ = FloatDirections(rays.direction), wanted_ = mask_for<float>(rays.active);
  }

  [[nodiscard]] bool is_useful() const { return is_useful_; }

  /// Returns true if surely no active ray hits the i-th candidate at a t of at most `until`. Surfaces without
  /// bounds, i < 0, are never ruled out.
  [[nodiscard, gnu::always_inline]] bool excludes(int i, const Doubles& until = infinity) const {
    return is_useful_ && i >= 0 && !any(wanted_ && candidates_.may_be_hit(i, directions_, until));
  }

 private:
  /// Largest number of candidates for which a test in double is as fast.
  static constexpr int untried = 4;

  const Candidates& candidates_;
  bool is_useful_;
  FloatDirections directions_;
  Mask<float, double_lanes> wanted_;
};

/// View of a scene from one tile of a camera. Camera rays, as packets of CameraPacket or as the pixel's
/// single ray, can hit only the candidates and surfaces without bounds; all other rays query the whole scene.
/// It is Traceable, for packets too: a surface is tested with all rays of a packet at once, and a ray that is
/// left in doubt is then traced alone.
template <Surface... S>
class TileScene {
 public:
  using Drawn = std::tuple<VisibilityBuffers<S>...>;
  static constexpr bool draws = (RasterizedSurface<S> || ...);         ///< true if any type can be rasterized
  static constexpr bool has_crossings = (SurfaceWithParts<S> || ...);  ///< true if any type has primitives

  TileScene(const Accelerated<Scene<S...>>& everything, const Candidates& candidates,
            const std::vector<int>& unbounded, const Skips& skips, Occluders& occluders, const Drawn& drawn,
            RenderStatistics& statistics)
      : everything_(everything),
        scene_(everything.scene()),
        candidates_(candidates),
        unbounded_(unbounded),
        skips_(skips),
        occluders_(occluders),
        drawn_(drawn),
        statistics_(statistics) {
    if constexpr (draws)
      if (candidates.size() == 1 && unbounded.empty()) {
        const int place = candidates.place(0);
        visit(place, [&]<class T>(const T&, const Material&) {
          if constexpr (RasterizedSurface<T>)
            if (buffer_at<T>(place)) only_buffer_ = place;
        });
      }
  }

  [[nodiscard]] const std::vector<Light>& lights() const { return scene_.lights(); }
  [[nodiscard]] const Color& ambient() const { return scene_.ambient(); }
  [[nodiscard]] const std::optional<Color>& sky() const { return scene_.sky(); }
  [[nodiscard]] const Texture& environment() const { return scene_.environment(); }

  // Members of Scene beyond those of Traceable.
  [[nodiscard]] std::size_t size() const { return scene_.size(); }
  template <class T>
  [[nodiscard]] const std::vector<T>& surfaces() const {
    return scene_.template surfaces<T>();
  }
  template <class T>
  [[nodiscard]] const std::vector<Material>& materials() const {
    return scene_.template materials<T>();
  }

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
        closest_by_itself(ray, [&](const auto& visit_place) { each_candidate(visit_place); });
    return place < 0 ? std::nullopt : std::optional(Intersection(ray, crossing));
  }

  [[nodiscard]] bool occluded(const Ray& ray, Interval range = {}) const {
    count_alone();
    return everything_.occluded(ray, range);
  }

  void crossings(const Ray& ray, Interval range, auto&& visit) const {
    count_alone();
    everything_.crossings(ray, range, visit);
  }

  // ---- Packets.

  /// Sets the pixel at which the camera's next packet begins, and the index of its sample.
  void set_first_pixel(int x, int y, int sample = 0) const {
    if constexpr (draws) first_x_ = x, first_y_ = y, sample_ = sample;
  }

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

  /// Returns the closest hits of camera rays among the candidates.
  template <class Origin>
  [[nodiscard]] Closest closest(const CameraPacket<Origin>& rays) const {
    if constexpr (are_of_pinhole<decltype(rays)>)
      if (const CandidateFilter trial(candidates_, rays, skips_); trial.is_useful())
        return closest_after(trial, rays);
    return closest_of_candidates(rays, [](int, const Doubles&) { return false; });
  }

  /// Returns true if only one surface can be hit, and that is rasterized; with_buffer(f) then calls
  /// f(visibility buffer, material).
  [[nodiscard]] bool sees_one_buffer() const { return only_buffer_ >= 0; }
  void with_buffer(const auto& f) const {
    visit(only_buffer_, [&]<class T>(const T&, const Material& material) {
      if constexpr (RasterizedSurface<T>) f(*buffer_at<T>(only_buffer_), material);
    });
  }

  /// Returns the closest hits of camera rays, given what the only visibility buffer tells of them. A certain
  /// hit gets t = 0, since it is compared with no other.
  [[nodiscard]] Closest closest(const CameraPacket<Point>& rays, const auto& seen) const {
    count_tests(seen.met || seen.in_doubt);
    const Closest closest{.t = select(seen.met, Doubles(0.0), infinity),
                          .place = select(seen.met, Indices(only_buffer_), -1),
                          .which = select(seen.met, seen.which, -1)};
    if (!any(seen.in_doubt)) return closest;
    return decided(rays, seen.in_doubt, closest,
                   [&](const auto& visit_place) { each_candidate(visit_place); });
  }

  /// Returns the closest hits of other rays among all surfaces.
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
    (look_at_all(surfaces<S>()), ...);
    if (any(in_doubt))
      return decided(rays, in_doubt, closest, [&](const auto& visit_place) {
        for (int place = 0; place < count; ++place) visit_place(place);
      });
    return closest;
  }

  /// Prefetches these candidates.
  void fetch(const Candidates& candidates) const {
    for (int i = 0; i < candidates.size(); ++i)
      visit(candidates.place(i), [](const auto& surface, const Material&) { prefetch(&surface); });
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
    const CandidateFilter trial(candidates_, rays, skips_);
    LaneMask found = false, left = rays.active;
    for (int i = -unbounded(); i < candidates_.size() && any(left); ++i)
      if (!trial.excludes(i)) test(place_of(i), rays, range, found, left);
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
    const CandidateFilter trial(candidates_, rays, skips_);
    // Surfaces without bounds are in the scene's order, and so are candidates unless the integrator shades
    // closest hits; hence so are the visits.
    for (int k = -unbounded(), i = 0; k < 0 || i < candidates_.size();) {
      const bool is_candidate = k == 0 || (i < candidates_.size() && place_of(i) < place_of(k));
      const int next = is_candidate ? i++ : k++;
      if (trial.excludes(next)) continue;
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

  /// Calls visit(surface, material) for the surface with this index in the scene's order.
  void visit(int place, const auto& visit) const {
    auto i = static_cast<std::size_t>(place);
    static_cast<void>((visit_group<S>(i, visit) || ...));
  }

 private:
  /// Largest number of surfaces for which testing all of them is faster than a traversal.
  static constexpr std::size_t few = 16;

  struct SomeCross {
    LaneMask which;
    Colors surface_color;
    [[nodiscard]] Colors color() const { return select(which, surface_color, Color{1}); }
  };

  /// Returns the lane of an active ray; a camera packet begins with one.
  template <class Origin>
  static int wanted_lane(const CameraPacket<Origin>&) {
    return 0;
  }
  template <class Origin>
  static int wanted_lane(const RayPacket<Origin>& rays) {
    return std::countr_zero(bits(rays.active)) % double_lanes;  // % tells g++ that the lane exists
  }

  /// Returns the index, in the scene's order, of the i-th candidate, or for i < 0 of a surface without
  /// bounds.
  [[nodiscard]] int place_of(int i) const {
    return i >= 0 ? candidates_.place(i) : unbounded_[static_cast<std::size_t>(i + unbounded())];
  }
  [[nodiscard]] int unbounded() const { return static_cast<int>(unbounded_.size()); }

  static LaneMask one(int lane) { return mask_of<double, double_lanes>(Bits{1} << lane); }

  void count_alone() const { ++statistics_.other_rays, ++statistics_.rays_alone; }

  void count_tests(LaneMask which) const {
    statistics_.surface_tests += static_cast<std::uint64_t>(std::popcount(bits(which)));
  }

  /// Visits the i-th surface of one type and returns true; if there is none, subtracts their number from i.
  template <Surface T>
  bool visit_group(std::size_t& i, const auto& visit) const {
    const auto& surfaces = scene_.template surfaces<T>();
    if (i < surfaces.size()) {
      visit(surfaces[i], scene_.template materials<T>()[i]);
      return true;
    }
    i -= surfaces.size();
    return false;
  }

  /// Updates the closest hits with those of one surface, and in_doubt with the rays that it leaves in doubt.
  template <Surface T>
  void consider(const T& surface, int place, const auto& rays, Closest& closest, LaneMask& in_doubt) const {
    if constexpr (RasterizedSurface<T> && are_of_pinhole<decltype(rays)>)
      if (const auto* const drawn = buffer_at<T>(place)) {
        const auto seen = drawn->seen(rays.active, first_x_, first_y_);
        ClosestCrossings first{.t = infinity, .met = seen.met, .in_doubt = seen.in_doubt};
        if (any(seen.met))
          first.t = select(seen.met, drawn->t(seen.which, seen.met, rays.direction), first.t);
        const LaneMask sooner = take(first, place, closest, in_doubt);
        closest.which = select(sooner, seen.which, closest.which);
        return;
      }
    if constexpr (SurfaceWithParts<T>)
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

  template <class R>
  static constexpr bool are_of_pinhole = std::same_as<std::remove_cvref_t<R>, CameraPacket<Point>>;

  /// Returns the visibility buffer of the surface with this index; null if it has none.
  template <RasterizedSurface T>
  [[nodiscard]] const typename T::Drawn* buffer_at(int place) const {
    return std::get<VisibilityBuffers<T>>(drawn_).at(place, sample_);
  }

  /// Returns the radiance of rays that hit one surface, though perhaps different primitives of it.
  template <Surface T>
  [[nodiscard]] Colors shade_on(const T& surface, const Material& material, const auto& rays,
                                const Closest& closest, LaneMask which, const auto& shade_hits) const {
    if constexpr (RasterizedSurface<T>)
      if (!any(which && mask_for<double>(closest.which < Indices(0)))) {
        const auto& drawn = *buffer_at<T>(static_cast<int>(closest.place[std::countr_zero(bits(which))]));
        const Doubles t = sees_one_buffer() ? drawn.t(closest.which, which, rays.direction) : closest.t;
        return Colors(shade_hits(HitPacket(rays, t, which, surface, material,
                                           PrimitivesSeen<typename T::Drawn>{drawn, closest.which})));
      }
    if constexpr (SurfaceWithParts<T>)
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

  /// Returns the closest hits of camera rays among the candidates, but for those that excludes(i, t).
  [[nodiscard]] Closest closest_of_candidates(const auto& rays, const auto& excludes) const {
    Closest closest{.t = infinity, .place = -1};
    LaneMask in_doubt = false;
    for (int i = -unbounded(); i < candidates_.size(); ++i) {
      // If no ray can reach a candidate before its closest hit, none can reach those that follow.
      if (i > 0 && !any(rays.active && closest.t >= Doubles(candidates_.nearest(i)))) break;
      if (excludes(i, closest.t)) continue;
      const int place = place_of(i);
      count_tests(rays.active);
      visit(place,
            [&](const auto& surface, const Material&) { consider(surface, place, rays, closest, in_doubt); });
    }
    if (any(in_doubt))
      return decided(rays, in_doubt, closest, [&](const auto& visit_place) { each_candidate(visit_place); });
    return closest;
  }
  [[nodiscard, gnu::noinline]] Closest closest_after(const CandidateFilter<Point>& trial,
                                                     const CameraPacket<Point>& rays) const {
    const bool leaves_out_farther = skips_.farther_surfaces;
    return closest_of_candidates(rays, [&](int i, const Doubles& t) {
      return trial.excludes(i, leaves_out_farther ? t : Doubles(infinity));
    });
  }

  /// Calls visit_place(index) for all surfaces that camera rays may hit.
  void each_candidate(const auto& visit_place) const {
    for (int i = -unbounded(); i < candidates_.size(); ++i) visit_place(place_of(i));
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

  /// Closest hit of one ray among some surfaces, and the index of its surface; −1 if it misses.
  struct PlacedCrossing {
    int place = -1;
    SurfaceCrossing crossing;
  };
  [[nodiscard, gnu::noinline]] PlacedCrossing closest_by_itself(const Ray& ray,
                                                                const auto& each_place) const {
    PlacedCrossing first;
    each_place([&](int place) {
      visit(place, [&](const auto& surface, const Material& material) {
        const auto crossing = first_crossing(surface, ray, Interval{});
        if (!crossing) return;
        const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
        if (first.place < 0 || precedes(ray, candidate, place, first.crossing, first.place))
          first = {place, candidate};
      });
    });
    return first;
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
      if (const auto* const drawn = buffer_at<T>(place); drawn && range.min == 0 && range.max == infinity) {
        const auto seen = drawn->seen(left, first_x_, first_y_);
        return {.crossed = seen.met, .in_doubt = seen.in_doubt};
      }
    return crossed_by_each(surface, rays, left, range);
  }

  /// Returns which rays may cross a surface inside the range, as far as its visibility buffer tells.
  template <Surface T>
  [[nodiscard]] LaneMask may_cross(const T&, [[maybe_unused]] int place, const auto& rays,
                                   [[maybe_unused]] Interval range) const {
    if constexpr (RasterizedSurface<T> && are_of_pinhole<decltype(rays)>)
      if (const auto* const drawn = buffer_at<T>(place); drawn && range.min >= 0) {
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
    if constexpr (SurfaceForPackets<T>) {
      const RootsOfEach<Doubles, LaneMask> roots = surface.roots_of_each(rays, some);
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
  const Scene<S...>& scene_;
  const Candidates& candidates_;
  const std::vector<int>& unbounded_;
  const Skips& skips_;
  Occluders& occluders_;
  const Drawn& drawn_;
  RenderStatistics& statistics_;
  Ray pixel_;
  int only_buffer_ = -1;  ///< index of the only surface that can be hit, if it is rasterized; or −1
  mutable int first_x_ = 0, first_y_ = 0, sample_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

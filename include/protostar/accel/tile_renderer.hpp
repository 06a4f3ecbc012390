// Renderer of the tiles of a picture: culls the surfaces that a tile cannot see, finds in float what its
// pixels see, and traces packets only through pixels that float leaves in doubt, or whose color needs the hit
// point. An integrator that declares nothing of packets gets one ray after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <new>

#include "../render.hpp"
#include "../render_options.hpp"
#include "../sampling/sample_target.hpp"
#include "../uninitialized.hpp"
#include "accelerate.hpp"
#include "candidates.hpp"
#include "drawn.hpp"
#include "frustum.hpp"
#include "packet.hpp"
#include "packet_integrator.hpp"
#include "packet_pixels.hpp"
#include "path_wave.hpp"
#include "picture_candidates.hpp"
#include "pixel_rays.hpp"
#include "tile_scene.hpp"
#include "tile_work.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Renderer of the tiles of one picture, with the data that they share. It cannot be moved.
template <class I, Surface... S>
class TileRenderer {
 public:
  using Target = protostar::detail::SampleTarget;

  /// Keeps references to the scene, the integrator, the statistics, and the image or film of the target;
  /// copies the camera. Throws std::invalid_argument for options that make no sense together or with the
  /// target (SampleTarget::grid).
  [[gnu::cold]] TileRenderer(const Target& target, const Camera& camera,
                             const Accelerated<Scene<S...>>& scene, const I& integrator,
                             const RenderOptions& options)
      : target_(target),
        scene_(scene),
        integrator_(integrator),
        rays_(camera, target.grid(options, protostar::detail::default_sampler<I, View>(camera)),
              target.width(), target.height()),
        keeps_light_(target.image() && rays_.pixels().keeps_light()),
        candidates_(scene, rays_, order),
        skips_(skips_that_pay(options, target.tile(), scene.scene().size())),
        statistics_(options.statistics) {}

  /// Fills a tile of the image or the film, which begins at multiples of 16 pixels and is at most 64 pixels
  /// wide and high. Several threads may fill one each: fallbacks are counted by thread.
  void operator()(const Tile& tile) const {
    const Fallbacks before = fallbacks;
    Work& work = works_.take();
    const Frustum frustum(rays_, tile);
    Candidates& in_tile = work.lists[0];
    candidates_.find(tile, frustum, in_tile);
    if constexpr (by_packets && View::rasterizes)
      if (have_common_start_and_places()) rasterize(in_tile, tile, work);
    fill_part(tile, in_tile, frustum, 0, work);
    work.state.counts.exact = fallbacks.exact - before.exact;
    work.state.counts.undecided = fallbacks.undecided - before.undecided;
    works_.give_back(work, statistics_);
  }

 private:
  using View = TileScene<S...>;
  using Closest = typename View::Closest;
  using Order = Candidates::Order;
  using Work = TileWork<S...>;

  /// Ways to ask the integrator: by packets or by single rays; to shade closest hits, or for the radiance of
  /// rays; with a sampler or without; without a point of the hit, or with one.
  static constexpr bool by_packets = PacketIntegrator<I> || FollowsPaths<I> || ShadesEachHit<I>;
  static constexpr bool shades = ShadingIntegrator<I, View>;
  static constexpr bool takes_sampler =
      shades ? ShadesBySampler<I, View> : protostar::detail::takes_sampler<I, View>;
  static constexpr bool shades_without_point = shades && ShadesWithoutPoint<I> && !takes_sampler;

  /// Order of the candidates: the scene's if packets ask for radiance, since they may ask for all crossings,
  /// which have that order. Single rays take crossings from the whole scene, whatever the candidates.
  static constexpr Order order = shades || !by_packets ? Order::near_to_far : Order::of_scene;

  /// Step of the division of a tile: a rectangle with more than `most` candidates is split into parts of
  /// width × height pixels, and one with `most` or fewer goes on to the next step. −1 splits all, so that
  /// parts are 16 × 16 or smaller.
  struct Division {
    int width, height, most;
  };
  static constexpr Division divisions[Work::most_divisions] = {{32, 32, 64}, {16, 16, -1}, {8, 8, 3}};

  /// Parts of a division narrower than that, in pixels, get a frustum without a cone.
  static constexpr int least_width_with_cone = 16;

  /// Largest number of candidates for which tests in float do not pay if every hit needs its t.
  static constexpr int most_tested_in_double = 3;

  /// Largest number of candidates that a block tests without culling them by its own frustum.
  static constexpr int most_without_block_culling = 16;

  [[nodiscard]] View view_of(const Candidates& candidates, Work& work) const {
    return View(scene_, candidates, skips_, work.state);
  }

  /// Fills visibility buffers of the candidates of types that rasterize, one a sample, while they last.
  void rasterize(const Candidates& candidates, const Tile& tile, Work& work) const {
    const View view = view_of(candidates, work);
    const TileHalfSpaces half_spaces(rays_, tile);
    for (const std::uint32_t index : candidates.indices())
      view.visit(index, [&]<class T>(const T& surface, const Material&) {
        if constexpr (RasterizedSurface<T>)
          for (int i = rays_.pixels().first(); i < rays_.pixels().last(); ++i) {
            VisibilityBuffers<T>& buffers = work.state.buffers;
            if (auto* const drawn = buffers.add(static_cast<int>(index), i))
              surface.draw(*drawn, rays_, i, half_spaces, tile);
          }
      });
  }

  /// Fills a tile, or a part of one: with one color, or else by the divisions from `next` on. The first whose
  /// `most` its candidates exceed splits it. Small parts have no cone, which takes long and serves few parts.
  void fill_part(const Tile& tile, const Candidates& candidates, const Frustum& frustum, std::size_t next,
                 Work& work) const {
    if (try_fill_uniform(tile, candidates, frustum, work)) return;
    while (next < std::size(divisions) && candidates.size() <= divisions[next].most) ++next;
    if (next == std::size(divisions)) return fill(tile, candidates, work);
    const auto [width, height, most] = divisions[next];
    Candidates& in_part = work.lists[next + 1];
    for (int y = tile.y0; y < tile.y1; y += height)
      for (int x = tile.x0; x < tile.x1; x += width) {
        const Tile part{x, y, std::min(x + width, tile.x1), std::min(y + height, tile.y1)};
        const Frustum in_front(rays_, part, width >= least_width_with_cone);
        in_part.clear();
        in_part.add(candidates, in_front);
        fill_part(part, in_part, in_front, next + 1, work);
      }
  }

  /// Fills a tile, or a part of one, with one color and returns true, if it is certain that all its samples
  /// have it; otherwise changes nothing and returns false. It is certain without candidates, which all rays
  /// then miss; if the only candidate fills the frustum, for an integrator that shades without a point; and
  /// if all candidates fill it, for one that asks for crossings. A texture makes it uncertain.
  [[nodiscard]] bool try_fill_uniform(const Tile& tile, const Candidates& candidates, const Frustum& frustum,
                                      Work& work) const {
    if constexpr (by_packets && (shades || !takes_sampler)) {
      const PixelGrid& pixels = rays_.pixels();
      if (!may_skip_rays() || (pixels.has_weights() && !pixels.has_common_places())) return false;
      const View view = view_of(candidates, work);
      if (candidates.size() > 0) {
        if constexpr (shades ? !shades_without_point : !AsksForCrossings<I>) return false;
        if (!rays_.is_pinhole() || !skips_.sure_in_float || (shades && candidates.size() > 1)) return false;
        for (int i = 0; i < candidates.size(); ++i)
          if (!candidates.fills(i, frustum) || view.has_texture(candidates.index(i))) return false;
      }
      give_tile(target_, pixels, tile, uniform_light(tile, candidates, view, work));
      work.state.counts.pixels_skipped += tile.pixel_count() * pixels.drawn();
      return true;
    }
    return false;
  }

  /// Returns true if the option allows samples without rays, and no environment colors the rays that miss.
  [[nodiscard]] bool may_skip_rays() const { return skips_.empty_tiles && !scene_.scene().environment(); }

  /// Returns the light that all samples of a tile have (try_fill_uniform): that of rays that miss, if there
  /// are no candidates; of rays that hit the only one; or of rays that cross all.
  [[nodiscard, gnu::noinline]] Color uniform_light(const Tile& tile, const Candidates& candidates,
                                                   const View& view, Work& work) const {
    const CameraPacket rays =
        rays_.packet({tile.x0, tile.y0, tile.x0 + 1, tile.y0 + 1}, tile.x0, tile.y0, rays_.pixels().first());
    Colors colors(Color{0});
    if constexpr (shades) {
      colors =
          shade_seen(Indices(candidates.size() == 0 ? no_surface_index : candidates.index(0)), rays, view);
    } else {
      work.state.crossed.clear();
      for (int i = 0; i < candidates.size(); ++i)
        work.state.crossed.push_back({candidates.index(i), ~Bits{0}, ~Bits{0}});
      view.set_crossed(&work.state.crossed);
      colors = integrator_.radiance(rays, view);
    }
    return {colors.r[0], colors.g[0], colors.b[0]};
  }

  /// Returns the radiance of pixels that surely see these surfaces, which have no texture, or nothing. If the
  /// integrator needs the point of a hit, all of them see nothing. Rays that miss all have the radiance of
  /// any_rays.
  [[nodiscard]] Colors shade_seen(const Indices& seen, const CameraPacket& any_rays, const View& view) const {
    const auto background = [&] { return integrator_.background(any_rays, view); };
    if constexpr (shades_without_point)
      return view.shade_without_point(seen, background,
                                      [&](const auto& hits) { return integrator_.shade(hits, view); });
    else
      return Colors(background());
  }

  /// Fills a part of at most 16 × 16 pixels with the radiance of each pixel's rays. A pixel has one sum in an
  /// image and `scramblings` in a film, filled one by one. Sample i belongs to sum i mod their number.
  void fill(const Tile& part, const Candidates& candidates, Work& work) const {
    View view = view_of(candidates, work);
    const PixelGrid& pixels = rays_.pixels();
    work.state.counts.camera_rays += part.pixel_count() * pixels.drawn();
    if constexpr (!by_packets) {
      for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x)
          target_.draw(pixels, x, y, [&](int i, const auto& place) {
            const Ray ray = pixels.ray(rays_.camera(), x, y, i, place);
            view.set_camera_ray(ray);
            return protostar::detail::radiance_of_sample(protostar::detail::radiance_in(view, integrator_),
                                                         ray, pixels.sampler(x, y, i));
          });
    } else {
      const int sums = target_.sums_of_pixel();
      for (int which = 0; which < sums; ++which) {
        if (!keeps_light_) each_packet(part, [&](std::size_t k, int, int) { work.sums[k] = {}; });
        std::uint32_t count = 0;
        // The least sample of the range that belongs to this sum.
        const int first = pixels.first() + (which + sums - pixels.first() % sums) % sums;
        for (int i = first; i < pixels.last(); i += sums, ++count)
          if constexpr (shades)
            fill_hits(part, candidates, view, i, work);
          else
            fill_radiance(part, view, i, work);
        if (keeps_light_) return;
        each_packet(part, [&](std::size_t k, int x, int y) {
          give_packet(target_, part, x, y, work.sums[k], which, count);
        });
      }
    }
  }

  /// Adds colors, times the filter's weights of sample i, to the sums of the pixels of a packet, which begins
  /// at pixel (x, y) of a part; or sets the pixels to them, if each has one sample of weight 1.
  void add(const Tile& part, int x, int y, int i, const PacketRays& rays, const Colors& colors,
           Work& work) const {
    const Colors light = rays_.pixels().bounded(colors);
    if (keeps_light_) return set_packet(*target_.image(), part, x, y, light);
    work.sums[PacketSums::index(part, x, y)].add(light * rays_.weights(i, rays));
  }

  /// Returns true if all camera rays start at one point, and sample i has the same place in every pixel, as
  /// tests in float and rasterization need it.
  [[nodiscard]] bool have_common_start_and_places() const {
    return rays_.is_pinhole() && rays_.pixels().has_common_places();
  }

  /// Adds the i-th sample of a part, for an integrator that shades closest hits. All packets go through one
  /// step after the other, directions, closest hits, colors, so that the latencies of their square roots and
  /// divisions overlap.
  [[gnu::flatten]] void fill_hits(const Tile& part, const Candidates& candidates, const View& view, int i,
                                  Work& work) const {
    const bool is_known = find_visibility(part, candidates, view, i, work);
    if (candidates_.are_from_bvh() && !is_known) view.prefetch_candidates();
    const auto seen_from = [&](int x, int y) { return is_known ? work.visibility(x, y) : SeenByPacket{}; };
    // Rays that stand for all that miss; they are used only if visibility is known.
    const CameraPacket any_rays =
        is_known ? rays_.packet(part, part.x0, part.y0, i) : CameraPacket(Vectors(Vec3{0}), Vectors(Vec3{0}));
    PacketStart starts[most_packets];
    PacketRays ray_numbers[most_packets];
    Uninitialized<Closest, most_packets> closest;
    std::size_t count = 0;
    std::uint64_t skipped = 0;
    each_packet(part, [&](std::size_t, int x, int y) {
      const SeenByPacket by_packet = seen_from(x, y);
      if (const Indices seen = by_packet.surely(); is_known && !needs_rays(seen, view)) {
        skipped += static_cast<std::uint64_t>(std::min(double_lanes, part.x1 - x));
        // The places of pixels, and so the weights, are common here: ray_numbers[count] is not read.
        return add(part, x, y, i, ray_numbers[count], shade_seen(seen, any_rays, view), work);
      }
      if (candidates_.are_from_bvh() && is_known) view.prefetch_seen(by_packet.indices);
      if (keeps_light_) prefetch_packet(*target_.image(), part, x, y);
      rays_.compute_rays(x, y, i, ray_numbers[count]);
      starts[count++] = {x, y};
    });
    for (std::size_t k = 0; k < count; ++k) {
      const auto [x, y] = starts[k];
      view.set_packet_position(x, y, i);
      const CameraPacket rays = rays_.packet(part, x, y, i, ray_numbers[k]);
      new (&closest[k])
          Closest(is_known ? view.closest(CameraPacket(rays), work.visibility(x, y)) : view.closest(rays));
      if (candidates_.are_from_bvh() && !is_known) view.prefetch_seen(closest[k].index);
    }
    if constexpr (FollowsPaths<I>)
      follow_paths(integrator_, view, rays_, part, i, {starts, count}, ray_numbers, &closest[0],
                   [&](std::size_t k, const Colors& light) {
                     add(part, starts[k].x, starts[k].y, i, ray_numbers[k], light, work);
                   });
    else
      for (std::size_t k = 0; k < count; ++k) {
        const int x = starts[k].x, y = starts[k].y;
        view.set_packet_position(x, y, i);
        const CameraPacket rays = rays_.packet(part, x, y, i, ray_numbers[k]);
        const auto shade = [&](const auto& hits, auto... lane) {
          if constexpr (takes_sampler)
            return integrator_.shade(hits, view, sampler_in(rays_.pixels().samplers(x, y, i), lane...));
          else
            return integrator_.shade(hits, view);
        };
        const auto shade_one = [&](const Intersection& hit, int lane) { return shade(hit, lane); };
        const auto shade_by = [&](const auto& shade_hits) {
          return view.shade(
              rays, closest[k], [&] { return integrator_.background(rays, view); }, shade_hits);
        };
        if constexpr (ShadesEachHit<I>)
          add(part, x, y, i, ray_numbers[k], shade_by(shade_one), work);
        else
          add(part, x, y, i, ray_numbers[k], shade_by(shade), work);
      }
    work.state.counts.pixels_skipped += skipped, work.state.counts.camera_rays -= skipped;
  }

  /// Adds the i-th sample of a part, for an integrator that is asked for the radiance of rays.
  void fill_radiance(const Tile& part, const View& view, int i, Work& work) const {
    const bool is_tested = AsksForCrossings<I> && have_common_start_and_places() && skips_.sure_in_float;
    std::uint64_t skipped = 0;
    each_block(part, [&](const Tile& block) {
      const bool is_certain = is_tested && view.list_crossed(rays_.block_directions(block.x0, block.y0, i));
      const bool computes_rays = !is_certain || !may_skip_rays();
      if (!computes_rays) skipped += block.pixel_count();
      each_packet(block, [&](std::size_t, int x, int y) {
        view.set_packet_position(x, y, i);
        view.set_crossed(is_tested ? &work.state.crossed : nullptr,
                         (y - block.y0) * RayBlock::width + (x - block.x0));
        PacketRays ray_numbers;
        if (computes_rays)
          rays_.compute_rays(x, y, i, ray_numbers);
        else
          ray_numbers.directions = Vec3{0}, ray_numbers.time = 0.0;
        const CameraPacket rays = rays_.packet(part, x, y, i, ray_numbers);
        const auto radiance = [&] {
          if constexpr (takes_sampler)
            return integrator_.radiance(rays, view, rays_.pixels().samplers(x, y, i));
          else
            return integrator_.radiance(rays, view);
        };
        add(part, x, y, i, ray_numbers, radiance(), work);
      });
    });
    work.state.counts.pixels_skipped += skipped, work.state.counts.camera_rays -= skipped;
  }

  /// Finds what the pixels of a part see first, and sets work.visibility: from the visibility buffer of the
  /// only candidate, if that is rasterized; or as far as float tells. Returns false, without a result, if the
  /// option is off, the camera is no pinhole, each pixel has places of its own, a candidate is everywhere, or
  /// there are too few candidates for tests in float to pay.
  [[nodiscard]] bool find_visibility(const Tile& part, const Candidates& candidates, const View& view, int i,
                                     Work& work) const {
    if (!have_common_start_and_places() || !skips_.sure_in_float) return false;
    view.set_packet_position(part.x0, part.y0, i);
    const bool is_in_buffer = view.with_only_buffer([&](const auto& drawn) {
      each_packet(part, [&](std::size_t, int x, int y) {
        const auto seen = drawn.seen(true, x, y);
        const Indices unmet = select(seen.in_doubt, Indices(doubtful_index), Indices(no_surface_index));
        work.visibility.set_packet(x, y, select(seen.met, Indices(candidates.index(0)), unmet));
      });
    });
    if (is_in_buffer) return true;
    if (!shades_without_point && candidates.size() <= most_tested_in_double) return false;
    for (int k = 0; k < candidates.size(); ++k)
      if (candidates.is_everywhere(k)) return false;
    const bool are_many = candidates.size() > most_without_block_culling;
    work.seen_by_block.clear();
    if (!are_many) work.seen_by_block.add_first(candidates.size());
    each_block(part, [&](const Tile& block) {
      if (are_many) candidates.find(Frustum(rays_, block, false), work.seen_by_block);
      const SeenByBlock seen = seen_by(rays_.block_directions(block.x0, block.y0, i), candidates,
                                       work.seen_by_block, !shades_without_point);
      work.state.counts.float_tests += static_cast<std::uint64_t>(seen.ray_tests);
      work.visibility.set_block(block.x0, block.y0, seen);
    });
    return true;
  }

  /// Returns true if the radiance of rays that see these surfaces, or nothing, depends on the rays.
  [[nodiscard]] bool needs_rays(const Indices& seen, const View& view) const {
    if (!may_skip_rays()) return true;
    LaneMask remaining = !mask_for<double>(seen == Indices(no_surface_index));
    if constexpr (!shades_without_point) return any(remaining);
    if (any(seen == Indices(doubtful_index))) return true;
    while (view.has_textures() && any(remaining))
      if (view.has_texture(take_group(seen, remaining).number)) return true;
    return false;
  }

  Target target_;
  const Accelerated<Scene<S...>>& scene_;
  const I& integrator_;
  PixelRays rays_;
  bool keeps_light_;  ///< true if pixels of an image get the light of their only sample, of weight 1
  PictureCandidates<S...> candidates_;
  Skips skips_;
  RenderStatistics* statistics_;
  mutable TileWorks<S...> works_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// Renderer of the tiles of a picture: finds the surfaces that a tile may see, then traces its packets.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include "../integrator.hpp"
#include "../render_options.hpp"
#include "accelerate.hpp"
#include "drawn.hpp"
#include "occluders.hpp"
#include "packet.hpp"
#include "packet_integrator.hpp"
#include "packet_pixels.hpp"
#include "pixel_rays.hpp"
#include "sphere_around.hpp"
#include "tile.hpp"
#include "tile_scene.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Renderer of the tiles of one picture, with the data that they share.
template <class I, Surface... S>
class TileRenderer {
 public:
  /// Borrows the image, the scene, the integrator and the statistics.
  TileRenderer(Image& image, const Camera& camera, const Accelerated<Scene<S...>>& scene, const I& integrator,
               const RenderOptions& options)
      : image_(image),
        scene_(scene),
        integrator_(integrator),
        rays_(camera, PixelGrid(image.width(), image.height(), options), image.width(), image.height()),
        skips_(options.skips),
        statistics_(options.statistics) {
    int place = 0;
    (add_group<S>(place), ...);
    if constexpr (nearest_first) put_nearest_first(candidates_);
  }

  /// Fills a tile.
  void operator()(const Tile& tile) const {
    const Fallbacks before = fallbacks;
    Work work;
    if constexpr (View::draws) work.drawn = take_room();
    Candidates in_tile;
    const Frustum frustum(rays_, tile);
    if (is_large()) {
      Candidates found;
      int first = 0;
      (add_found<S>(frustum, first, found), ...);
      if constexpr (nearest_first)
        put_nearest_first(found);
      else
        found.order_by_place();
      in_tile.add(found, frustum);
    } else {
      in_tile.add(candidates_, frustum);
    }
    if constexpr (by_packets && View::draws)
      if (rays_.is_pinhole()) draw(in_tile, frustum, tile, work);
    if (sees_background_only(in_tile))
      fill_with_background(tile, work);
    else if (!fill_from_buffer(tile, in_tile, work))
      fill_parts(tile, in_tile, 0, work);
    if constexpr (View::draws) give_back(std::move(work.drawn));
    if (statistics_) {
      work.taken.exact = fallbacks.exact - before.exact;
      const std::lock_guard lock(sharing_);
      *statistics_ += work.taken;
    }
  }

 private:
  using View = TileScene<S...>;

  static constexpr bool by_packets = PacketIntegrator<I>;
  static constexpr bool nearest_first = ShadingIntegrator<I, View> || !by_packets;

  /// Size of the parts that a tile is divided into. A part with more than `most` candidates is divided
  /// further, by the next size; in the last size, each row of such a part has its own list of candidates.
  struct Division {
    int width, height, most;
  };
  static constexpr Division divisions[] = {{16, 16, 3}, {8, 8, 16}};

  /// Buffers that the parts of a tile use one after the other.
  struct Work {
    Candidates lists[std::size(divisions)], of_row;
    Occluders occluders;
    typename View::Drawn drawn;
    RenderStatistics taken;
  };

  /// Returns true if there are so many surfaces that each tile traverses the BVH for its own, instead of
  /// testing all.
  [[nodiscard]] bool is_large() const { return scene_.scene().size() > 2048; }

  /// Adds the candidates that any tile may see, and the surfaces without bounds.
  template <Surface T>
  void add_group(int& place) {
    const auto& surfaces = scene_.scene().template surfaces<T>();
    scene_.template each_unbounded<T>(
        [&](std::uint32_t i) { unbounded_.push_back(place + static_cast<int>(i)); });
    if (!is_large())
      for (std::size_t i = 0; i < surfaces.size(); ++i)
        if (has_bounds(surfaces[i]))
          candidates_.add(place + static_cast<int>(i), rays_.viewpoint(), sphere_around(surfaces[i]));
    place += static_cast<int>(surfaces.size());
  }

  /// Adds the surfaces of one type that the BVH has for a frustum; `first` is the index of the type's first
  /// surface, and becomes that of the next type's.
  template <Surface T>
  void add_found(const Frustum& frustum, int& first, Candidates& found) const {
    scene_.template frustum_query<T>(
        frustum.side, [&](const Numbers& numbers, Bits some, const SpheresAround& around) {
          found.add(numbers + Numbers(static_cast<std::uint32_t>(first)), some, rays_.viewpoint(), around);
        });
    first += static_cast<int>(scene_.scene().template surfaces<T>().size());
  }

  /// Returns visibility buffers, which are large, of an earlier tile, or new ones.
  [[nodiscard]] typename View::Drawn take_room() const {
    const std::lock_guard lock(sharing_);
    if (room_.empty()) return {};
    typename View::Drawn room = std::move(room_.back());
    room_.pop_back();
    (std::get<VisibilityBuffers<S>>(room).clear(), ...);
    return room;
  }
  void give_back(typename View::Drawn&& room) const {
    const std::lock_guard lock(sharing_);
    room_.push_back(std::move(room));
  }

  /// Returns true if all rays that miss have the same radiance, and may be skipped.
  [[nodiscard]] bool nothing_is_alike() const { return skips_.empty_tiles && !scene_.scene().environment(); }
  /// Returns true if all rays that miss have one radiance, and all that hit this material have one, so that
  /// no hit point is needed.
  [[nodiscard]] bool is_alike(const Material& material) const {
    return ShadingIntegrator<I, View> && ShadesAnywhere<I> && nothing_is_alike() && !material.texture;
  }

  /// Rasterizes the candidates that can be.
  void draw(const Candidates& candidates, const Frustum& frustum, const Tile& tile, Work& work) const {
    const int samples = rays_.pixels().samples();
    const auto visit = [&]<class T>(const VisibilityBuffers<T>&, const T& surface, int place) {
      if constexpr (RasterizedSurface<T>)
        for (int i = 0; i < samples; ++i)
          if (auto* const drawn = std::get<VisibilityBuffers<T>>(work.drawn).add(place, i))
            surface.draw(*drawn, rays_, i, frustum, tile);
    };
    for (int i = 0; i < candidates.size(); ++i) {
      auto at = static_cast<std::size_t>(candidates.place(i));
      const auto visit_group = [&]<class T>(const VisibilityBuffers<T>& group) {
        const auto& surfaces = scene_.scene().template surfaces<T>();
        if (at < surfaces.size()) return visit(group, surfaces[at], candidates.place(i)), true;
        return at -= surfaces.size(), false;
      };
      static_cast<void>((visit_group(VisibilityBuffers<S>{}) || ...));
    }
  }

  void put_nearest_first(Candidates& candidates) const {
    candidates.order_by_distance();
    if (!skips_.farther_surfaces) candidates.bring_near();
  }

  /// Returns true if a tile with these candidates sees nothing, and the same background everywhere, so that
  /// one packet stands for all of its rays.
  [[nodiscard]] bool sees_background_only(const Candidates& candidates) const {
    return by_packets && skips_.empty_tiles && candidates.size() == 0 && unbounded_.empty() &&
           !scene_.scene().environment();
  }

  void fill_parts(const Tile& tile, const Candidates& candidates, std::size_t division, Work& work) const {
    const auto [width, height, most] = divisions[division];
    Candidates& in_part = work.lists[division];
    for (int y = tile.y0; y < tile.y1; y += height)
      for (int x = tile.x0; x < tile.x1; x += width) {
        const Tile part{x, y, std::min(x + width, tile.x1), std::min(y + height, tile.y1)};
        in_part.clear();
        in_part.add(candidates, Frustum(rays_, part));
        if (sees_background_only(in_part))
          fill_with_background(part, work);
        else if (in_part.size() <= most || division + 1 == std::size(divisions))
          fill(part, in_part, work);
        else
          fill_parts(part, in_part, division + 1, work);
      }
  }

  void fill_with_background(const Tile& tile, Work& work) const {
    if constexpr (by_packets) {
      work.taken.pixels_skipped +=
          static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height());
      // All rays that miss have the same radiance, that of a ray without candidates.
      const Candidates none;
      const View view(scene_, none, unbounded_, skips_, work.occluders, work.drawn, work.taken);
      const Colors colors = radiance(rays_.packet(tile, tile.x0, tile.y0), view);
      const Color color = rays_.pixels().mean([&](int) {
        return Color{colors.r[0], colors.g[0], colors.b[0]};
      });
      const auto row = [&](int y) { return &image_(tile.x0, y); };
      std::fill_n(row(tile.y0), tile.width(), color);
      for (int y = tile.y0 + 1; y < tile.y1; ++y) std::copy_n(row(tile.y0), tile.width(), row(y));
    }
  }

  /// Fills a tile that can see only one surface, if that is rasterized and pixels have one sample; returns
  /// false if not. Packets of rays are made only if a ray is in doubt, or colors vary from point to point.
  bool fill_from_buffer(const Tile& tile, const Candidates& candidates, Work& work) const {
    if constexpr (by_packets && View::draws && ShadingIntegrator<I, View>) {
      const View view(scene_, candidates, unbounded_, skips_, work.occluders, work.drawn, work.taken);
      if (!view.sees_one_buffer() || rays_.pixels().samples() > 1) return false;
      view.with_buffer([&](const auto& drawn, const Material& material) {
        const bool all_is_alike = is_alike(material), has_background = nothing_is_alike();
        Colors surface(Color{0}), background(Color{0});
        view.set_first_pixel(tile.x0, tile.y0);
        if (has_background)
          background = Colors(integrator_.background(rays_.packet(tile, tile.x0, tile.y0), view));
        if constexpr (ShadesAnywhere<I>)
          if (all_is_alike) surface = Colors(integrator_.shade_anywhere(material));
        // Most packets have one of these two colors, and are sooner copied than put together.
        const PacketOfColors of_surface = pixels_of(surface), of_background = pixels_of(background);
        std::uint64_t skipped = 0;
        each_packet(tile, [&](std::size_t, int x, int y) {
          prefetch_below(image_, tile, x, y);
          const LaneMask active = rays_.active(tile, x);
          const auto seen = drawn.seen(active, x, y);
          if (!any(seen.in_doubt) && (all_is_alike || (has_background && !any(seen.met)))) {
            skipped += static_cast<std::uint64_t>(std::popcount(bits(active)));
            if (!any(seen.met)) return write_packet(image_, tile, x, y, of_background);
            if (!any(!seen.met)) return write_packet(image_, tile, x, y, of_surface);
            return write_packet(image_, tile, x, y, select(seen.met, surface, background));
          }
          view.set_first_pixel(x, y);
          const CameraPacket<Point> rays = rays_.packet(tile, x, y);
          const auto closest = view.closest(rays, seen);
          write_packet(
              image_, tile, x, y,
              all_is_alike ? select(closest.t < infinity, surface, background) : shaded(rays, closest, view));
        });
        work.taken.pixels_skipped += skipped;
        work.taken.camera_rays +=
            static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height()) - skipped;
      });
      return true;
    }
    return false;
  }

  void fill(const Tile& tile, const Candidates& candidates, Work& work) const {
    if constexpr (!by_packets)  // ray by ray, with any origin
      fill_from<Point>(tile, candidates, work);
    else if (rays_.is_pinhole())
      fill_from_point(tile, candidates, work);
    else
      fill_from<Vectors>(tile, candidates, work);
  }

  /// Computes the packets of a pinhole, the most frequent camera, with all calls inlined. Other cameras share
  /// the functions as they are, which keeps the code small.
  [[gnu::flatten]] void fill_from_point(const Tile& tile, const Candidates& candidates, Work& work) const {
    fill_from<Point>(tile, candidates, work);
  }

  template <class Origin>
  void fill_from(const Tile& tile, const Candidates& candidates, Work& work) const {
    if constexpr (std::same_as<Origin, Point>)
      if (fill_from_buffer(tile, candidates, work)) return;
    const PixelGrid& pixels = rays_.pixels();
    work.taken.camera_rays += static_cast<std::uint64_t>(tile.width()) *
                              static_cast<std::uint64_t>(tile.height()) *
                              static_cast<std::uint64_t>(pixels.samples());
    const bool by_rows = candidates.size() > divisions[std::size(divisions) - 1].most;
    work.of_row.clear();
    View view(scene_, by_rows ? work.of_row : candidates, unbounded_, skips_, work.occluders, work.drawn,
              work.taken);
    if (is_large()) view.fetch(candidates);
    const auto begin_packet = [&](int x, int y) {
      if (!by_rows || x != tile.x0) return;
      work.of_row.clear();
      work.of_row.add(candidates, Frustum(rays_, {tile.x0, y, tile.x1, y + 1}));
    };
    if constexpr (!by_packets) {
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
          begin_packet(x, y);
          image_(x, y) = pixels.mean([&](int i) {
            const Ray ray = pixels.ray(rays_.camera(), x, y, i);
            view.set_pixel(ray);
            return protostar::detail::radiance_of(integrator_, ray, view);
          });
        }
    } else if (pixels.samples() > 1) {
      each_packet(tile, [&](std::size_t, int x, int y) {
        begin_packet(x, y);
        write_packet(image_, tile, x, y, mean_radiance<Origin>(tile, x, y, view));
      });
    } else {
      fill_in_steps<Origin>(tile, view, begin_packet);
    }
  }

  /// Takes all packets of a tile through one step after the other: directions, closest hits, colors. Each
  /// step waits for a square root and a division; these waits of many packets overlap.
  template <class Origin>
  void fill_in_steps(const Tile& tile, const View& view, const auto& begin_packet) const {
    constexpr std::size_t most_packets = 16 * ((16 + double_lanes - 1) / double_lanes);
    static_assert(divisions[0].width == 16 && divisions[0].height == 16);
    std::array<Vectors, most_packets> directions;
    each_packet(tile, [&](std::size_t i, int x, int y) { directions[i] = rays_.directions(x, y); });
    const auto rays = [&](std::size_t i, int x, int y) {
      return rays_.template packet<Origin>(tile, x, y, directions[i]);
    };
    if constexpr (ShadingIntegrator<I, View>) {
      std::array<typename View::Closest, most_packets> closest;
      each_packet(tile, [&](std::size_t i, int x, int y) {
        begin_packet(x, y);
        view.set_first_pixel(x, y);
        closest[i] = view.closest(rays(i, x, y));
        if (is_large()) view.fetch(closest[i]);
      });
      each_packet(tile, [&](std::size_t i, int x, int y) {
        view.set_first_pixel(x, y);
        write_packet(image_, tile, x, y, shaded(rays(i, x, y), closest[i], view));
      });
    } else {
      each_packet(tile, [&](std::size_t i, int x, int y) {
        begin_packet(x, y);
        view.set_first_pixel(x, y);
        write_packet(image_, tile, x, y, integrator_.radiance(rays(i, x, y), view));
      });
    }
  }

  template <class Origin>
  [[nodiscard, gnu::noinline]] Colors mean_radiance(const Tile& tile, int x, int y, const View& view) const {
    return rays_.pixels().mean([&](int i) {
      view.set_first_pixel(x, y, i);
      const CameraPacket<Origin> rays = rays_.template packet<Origin>(tile, x, y, i);
      return radiance(rays, view);
    });
  }

  [[nodiscard]] Colors radiance(const auto& rays, const View& view) const {
    if constexpr (ShadingIntegrator<I, View>)
      return shaded(rays, view.closest(rays), view);
    else
      return integrator_.radiance(rays, view);
  }

  [[nodiscard]] Colors shaded(const auto& rays, const typename View::Closest& closest,
                              const View& view) const {
    return view.shade(
        rays, closest, [&] { return integrator_.background(rays, view); },
        [&](const auto& hits) { return integrator_.shade(hits, view); });
  }

  Image& image_;
  const Accelerated<Scene<S...>>& scene_;
  const I& integrator_;
  PixelRays rays_;
  Skips skips_;
  RenderStatistics* statistics_;
  mutable std::mutex sharing_;                      ///< guards *statistics_ and room_
  mutable std::vector<typename View::Drawn> room_;  ///< visibility buffers that no tile uses
  Candidates candidates_;       ///< in the scene's order, or near to far if only closest hits are needed
  std::vector<int> unbounded_;  ///< indices of surfaces without bounds, which any tile may see
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

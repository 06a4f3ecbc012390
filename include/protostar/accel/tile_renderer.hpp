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
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "../integrator.hpp"
#include "../render_options.hpp"
#include "accelerate.hpp"
#include "candidates.hpp"
#include "drawn.hpp"
#include "frustum.hpp"
#include "occluders.hpp"
#include "packet.hpp"
#include "packet_integrator.hpp"
#include "packet_pixels.hpp"
#include "pixel_rays.hpp"
#include "sphere_around.hpp"
#include "tile_filler.hpp"
#include "tile_scene.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Renderer of the tiles of one picture, with the data that they share. It stays where it is made.
template <class I, Surface... S>
class TileRenderer {
 public:
  /// Borrows the image, the scene, the integrator and the statistics.
  TileRenderer(Image& image, const Camera& camera, const Accelerated<Scene<S...>>& scene, const I& integrator,
               const RenderOptions& options)
      : scene_(scene),
        rays_(camera, PixelGrid(image.width(), image.height(), options), image.width(), image.height()),
        skips_(worthwhile(options, image, scene.scene().size())),
        statistics_(options.statistics),
        filler_(image, scene, integrator, rays_, unbounded_, skips_) {
    int place = 0;
    (add_group<S>(place), ...);
    put_in_order(candidates_);
  }

  /// Fills a tile.
  void operator()(const Tile& tile) const {
    const Fallbacks before = fallbacks;
    Work work;
    if constexpr (View::draws) work.drawn = take_buffers();
    Candidates in_tile;
    const Frustum frustum(rays_, tile);
    if (is_large()) {
      Candidates found;
      int first = 0;
      const TileHalfSpaces half_spaces(rays_, tile);
      (add_found<S>(half_spaces, first, found), ...);
      if constexpr (!nearest_first) found.order_by_place();
      put_in_order(found);
      in_tile.add(found, frustum);
    } else {
      in_tile.add(candidates_, frustum);
    }
    if constexpr (by_packets && View::draws)
      if (rays_.is_pinhole()) draw(in_tile, tile, work);
    if (!filler_.fill_at_once(tile, in_tile, frustum, work) && !filler_.fill_from_buffer(tile, in_tile, work))
      fill_parts(tile, in_tile, 0, work);
    if constexpr (View::draws) return_buffers(std::move(work.drawn));
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
  static constexpr Division divisions[] = {{16, 16, 3}, {8, 8, TileFiller<I, S...>::most_for_all_rows}};

  /// Buffers of a tile: those of its parts, and the candidates of parts of each size.
  struct Work : TileWork<View> {
    Candidates lists[std::size(divisions)];
  };

  /// Returns the skips of the options, without lists of occluders in a picture of fewer than 64 pixels for
  /// each surface: there a list serves so few rays that its search costs more than it saves.
  static Skips worthwhile(const RenderOptions& options, const Image& image, std::size_t surfaces) {
    const Crop& crop = options.crop;
    const auto pixels =
        crop.width > 0 ? 1.0 * crop.width * crop.height : 1.0 * image.width() * image.height();
    Skips skips = options.skips;
    skips.occluder_lists = skips.occluder_lists && pixels >= 64.0 * static_cast<double>(surfaces);
    return skips;
  }

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
  void add_found(const TileHalfSpaces& half_spaces, int& first, Candidates& found) const {
    scene_.template frustum_query<T>(
        half_spaces.side, [&](const Numbers& numbers, Bits some, const SpheresAround& around) {
          found.add(numbers + Numbers(static_cast<std::uint32_t>(first)), some, rays_.viewpoint(), around);
        });
    first += static_cast<int>(scene_.scene().template surfaces<T>().size());
  }

  /// Returns empty visibility buffers: those of an earlier tile, or new ones. They are large.
  [[nodiscard]] typename View::Drawn take_buffers() const {
    const std::lock_guard lock(sharing_);
    if (spare_buffers_.empty()) return {};
    typename View::Drawn buffers = std::move(spare_buffers_.back());
    spare_buffers_.pop_back();
    (std::get<VisibilityBuffers<S>>(buffers).clear(), ...);
    return buffers;
  }
  void return_buffers(typename View::Drawn&& buffers) const {
    const std::lock_guard lock(sharing_);
    spare_buffers_.push_back(std::move(buffers));
  }

  /// Rasterizes the candidates that can be.
  void draw(const Candidates& candidates, const Tile& tile, Work& work) const {
    const TileHalfSpaces half_spaces(rays_, tile);
    const int samples = rays_.pixels().samples();
    const auto visit = [&]<class T>(const VisibilityBuffers<T>&, const T& surface, int place) {
      if constexpr (RasterizedSurface<T>)
        for (int i = 0; i < samples; ++i)
          if (auto* const drawn = std::get<VisibilityBuffers<T>>(work.drawn).add(place, i))
            surface.draw(*drawn, rays_, i, half_spaces, tile);
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

  /// Orders candidates near to far for integrators that shade closest hits. For others, which may ask for
  /// crossings in the scene's order, they keep that order, and none is left out for its distance.
  void put_in_order(Candidates& candidates) const {
    if constexpr (nearest_first) candidates.order_by_distance();
    if (!nearest_first || !skips_.farther_surfaces) candidates.bring_near();
  }

  /// Divides a tile into parts, culls its candidates for each, and fills it or divides it further.
  void fill_parts(const Tile& tile, const Candidates& candidates, std::size_t division, Work& work) const {
    const auto [width, height, most] = divisions[division];
    Candidates& in_part = work.lists[division];
    for (int y = tile.y0; y < tile.y1; y += height)
      for (int x = tile.x0; x < tile.x1; x += width) {
        const Tile part{x, y, std::min(x + width, tile.x1), std::min(y + height, tile.y1)};
        const Frustum frustum(rays_, part);
        in_part.clear();
        in_part.add(candidates, frustum);
        if (filler_.fill_at_once(part, in_part, frustum, work)) continue;
        if (in_part.size() <= most || division + 1 == std::size(divisions))
          filler_.fill(part, in_part, work);
        else
          fill_parts(part, in_part, division + 1, work);
      }
  }

  const Accelerated<Scene<S...>>& scene_;
  PixelRays rays_;
  Skips skips_;
  RenderStatistics* statistics_;
  mutable std::mutex sharing_;                               ///< guards *statistics_ and spare_buffers_
  mutable std::vector<typename View::Drawn> spare_buffers_;  ///< visibility buffers that no tile uses
  Candidates candidates_;       ///< in the scene's order, or near to far if only closest hits are needed
  std::vector<int> unbounded_;  ///< indices of surfaces without bounds, which any tile may see
  TileFiller<I, S...> filler_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

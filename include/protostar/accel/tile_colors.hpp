// Colors of pixels that see the same, nothing or one surface, and of the hits of packets.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "../integrator.hpp"
#include "../render_options.hpp"
#include "accelerate.hpp"
#include "candidates.hpp"
#include "crossing_packet.hpp"
#include "frustum.hpp"
#include "occluders.hpp"
#include "packet_integrator.hpp"
#include "packet_pixels.hpp"
#include "pixel_rays.hpp"
#include "tile_scene.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Buffers that the parts of a tile use one after the other.
template <class View>
struct TileWork {
  Candidates of_row;  ///< candidates of a row of blocks
  Visibility visibility;
  std::vector<CrossingPacket::Crossed> crossed;
  std::optional<RowOfColors> background;  ///< radiance of rays that miss, once it is known and if it is one
  Occluders occluders;
  typename View::Drawn drawn;
  RenderStatistics taken;
};

/// Colors of the pixels of a picture, as an integrator computes them.
template <class I, Surface... S>
class TileColors {
 public:
  using View = TileScene<S...>;
  using Work = TileWork<View>;

  static constexpr bool by_packets = PacketIntegrator<I>;

  /// Borrows all but the skips. `unbounded` are the indices of surfaces without bounds.
  TileColors(Image& image, const Accelerated<Scene<S...>>& scene, const I& integrator, const PixelRays& rays,
             const std::vector<int>& unbounded, const Skips& skips)
      : image_(image),
        scene_(scene),
        integrator_(integrator),
        rays_(rays),
        unbounded_(unbounded),
        skips_(skips) {}

  /// Fills a tile, or a part of one, if all of its rays surely see the same and have one radiance; returns
  /// false if not. All rays of a frustum without candidates miss; all rays of one that a candidate fills meet
  /// that candidate.
  [[nodiscard, gnu::noinline]] bool fill_at_once(const Tile& tile, const Candidates& candidates,
                                                 const Frustum& frustum, Work& work) const {
    if constexpr (by_packets) {
      if (!has_one_background() || !unbounded_.empty()) return false;
      const std::optional<Color> color = color_of_all(candidates, frustum, work);
      if (!color) return false;
      const Color mean = rays_.pixels().mean([&](int) { return *color; });
      const auto row = [&](int y) { return &image_(tile.x0, y); };
      std::fill_n(row(tile.y0), tile.width(), mean);
      for (int y = tile.y0 + 1; y < tile.y1; ++y) std::copy_n(row(tile.y0), tile.width(), row(y));
      work.taken.pixels_skipped +=
          static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height());
      return true;
    }
    return false;
  }

 protected:
  /// Returns true if all rays that miss have the same radiance, as there is no environment, and may be
  /// skipped.
  [[nodiscard]] bool has_one_background() const {
    return skips_.empty_tiles && !scene_.scene().environment();
  }
  /// Returns true if all rays that miss have one radiance, and all that hit this material have one, so that
  /// no hit point is needed.
  [[nodiscard]] bool has_one_color(const Material& material) const {
    return ShadingIntegrator<I, View> && ShadesAnywhere<I> && has_one_background() && !material.texture;
  }

  /// Color of all pixels that see one surface, the last that was looked for.
  struct ColorSeen {
    std::int32_t place = is_in_doubt;
    bool is_known = false;  ///< true if there is such a color
    RowOfColors row{};      ///< that color, for a row of a block
  };

  /// Sets the color of pixels that surely see a surface, if there is one for all.
  [[gnu::noinline]] void find_color(std::int32_t place, const View& view, ColorSeen& seen) const {
    seen.place = place, seen.is_known = false;
    if constexpr (ShadesAnywhere<I>)
      if (place >= 0)
        view.visit(place, [&](const auto&, const Material& material) {
          if (has_one_color(material))
            seen.row.fill(integrator_.shade_anywhere(material)), seen.is_known = true;
        });
  }

  /// Returns the color of pixels that see nothing, for a row of a block; null if they are not alike. No
  /// surface may be without bounds. The color is computed once for a tile.
  [[nodiscard]] const RowOfColors* background_color(Work& work) const {
    if (!has_one_background()) return nullptr;
    if (!work.background) {
      // All rays that miss have the same radiance, that of a ray without candidates.
      const Candidates none;
      const View empty(scene_, none, unbounded_, skips_, work.occluders, work.drawn, work.taken);
      const Colors colors = radiance(rays_.packet({0, 0, 1, 1}, 0, 0), empty);
      work.background.emplace().fill({colors.r[0], colors.g[0], colors.b[0]});
    }
    return &*work.background;
  }

  /// Returns the radiance of camera rays, of which nothing is known yet.
  [[nodiscard]] Colors radiance(const auto& rays, const View& view) const {
    if constexpr (ShadingIntegrator<I, View>)
      return shaded(rays, view.closest(rays), view);
    else
      return integrator_.radiance(rays, view);
  }

  /// Returns the radiance of rays whose closest hits are known.
  [[nodiscard]] Colors shaded(const auto& rays, const typename View::Closest& closest,
                              const View& view) const {
    return view.shade(
        rays, closest, [&] { return integrator_.background(rays, view); },
        [&](const auto& hits) { return integrator_.shade(hits, view); });
  }

  Image& image_;
  const Accelerated<Scene<S...>>& scene_;
  const I& integrator_;
  const PixelRays& rays_;
  const std::vector<int>& unbounded_;
  Skips skips_;

 private:
  /// True if the surfaces that a ray meets may tell its radiance, without its hits.
  static constexpr bool is_told_by_surface =
      AsksForCrossings<I> || (ShadingIntegrator<I, View> && ShadesAnywhere<I>);

  /// Returns the radiance of all rays in a frustum, if these candidates tell it.
  [[nodiscard]] std::optional<Color> color_of_all(const Candidates& candidates, const Frustum& frustum,
                                                  Work& work) const {
    if (candidates.size() == 0) return background_color(work)->front();
    if constexpr (!is_told_by_surface) return std::nullopt;
    if (!rays_.is_pinhole() || !skips_.sure_in_float) return std::nullopt;
    const View view(scene_, candidates, unbounded_, skips_, work.occluders, work.drawn, work.taken);
    if constexpr (ShadingIntegrator<I, View> && ShadesAnywhere<I>)
      if (candidates.size() == 1 && candidates.fills(0, frustum)) {
        ColorSeen seen;
        find_color(candidates.place(0), view, seen);
        if (seen.is_known) return seen.row.front();
      }
    if constexpr (AsksForCrossings<I>) {
      work.crossed.clear();
      for (int i = 0; i < candidates.size(); ++i) {
        if (!candidates.fills(i, frustum) || view.has_texture(candidates.place(i))) return std::nullopt;
        work.crossed.push_back({candidates.place(i), first_bits(float_lanes)});
      }
      const Colors colors = integrator_.radiance(CrossingPacket{work.crossed, 0, rays_, 0, 0}, view);
      return Color{colors.r[0], colors.g[0], colors.b[0]};
    }
    return std::nullopt;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

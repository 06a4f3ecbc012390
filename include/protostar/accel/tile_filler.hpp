// Filler of the parts of a picture's tiles, given the surfaces that they may see: by packets of rays, or,
// where float tells what pixels see, with less.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
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
#include "packet.hpp"
#include "packet_integrator.hpp"
#include "packet_pixels.hpp"
#include "pixel_rays.hpp"
#include "tile_colors.hpp"
#include "tile_scene.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Filler of parts of tiles with the radiance that an integrator computes. A part has at most 16 × 16 pixels.
template <class I, Surface... S>
class TileFiller : public TileColors<I, S...> {
  using Base = TileColors<I, S...>;

 public:
  using Base::by_packets;
  using typename Base::View, typename Base::Work;

  /// Largest number of candidates that all rows of a part share; of more, each row of blocks has its own.
  static constexpr int most_for_all_rows = 16;

  using Base::Base;

  /// Fills a tile, of any size, that can see only one surface, if that is rasterized and pixels have one
  /// sample; returns false, and writes nothing, if not. Packets of rays are made only if a ray is in doubt,
  /// or colors vary from point to point.
  bool fill_from_buffer(const Tile& tile, const Candidates& candidates, Work& work) const {
    if constexpr (by_packets && View::draws && ShadingIntegrator<I, View>) {
      const View view(scene_, candidates, unbounded_, skips_, work.occluders, work.drawn, work.taken);
      if (!view.sees_one_buffer() || rays_.pixels().samples() > 1) return false;
      view.with_buffer([&](const auto& drawn, const Material& material) {
        const bool all_have_one_color = has_one_color(material);
        const RowOfColors* const row = background_color(work);
        Colors surface(Color{0}), background(row ? row->front() : Color{0});
        if constexpr (ShadesAnywhere<I>)
          if (all_have_one_color) surface = Colors(integrator_.shade_anywhere(material));
        // Most packets have one of these two colors, and are sooner copied than put together.
        const PacketOfColors of_surface = pixels_of(surface), of_background = pixels_of(background);
        std::uint64_t skipped = 0;
        each_packet(tile, [&](std::size_t, int x, int y) {
          prefetch_below(image_, tile, x, y);
          const LaneMask active = rays_.active(tile, x);
          const auto seen = drawn.seen(active, x, y);
          if (!any(seen.in_doubt) && (all_have_one_color || (row && !any(seen.met)))) {
            skipped += static_cast<std::uint64_t>(std::popcount(bits(active)));
            if (!any(seen.met)) return write_packet(image_, tile, x, y, of_background);
            if (!any(!seen.met)) return write_packet(image_, tile, x, y, of_surface);
            return write_packet(image_, tile, x, y, select(seen.met, surface, background));
          }
          view.set_first_pixel(x, y);
          const CameraPacket<Point> rays = rays_.packet(tile, x, y);
          const auto closest = view.closest(rays, seen);
          write_packet(image_, tile, x, y,
                       all_have_one_color ? select(closest.t < infinity, surface, background)
                                          : shaded(rays, closest, view));
        });
        work.taken.pixels_skipped += skipped;
        work.taken.camera_rays +=
            static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height()) - skipped;
      });
      return true;
    }
    return false;
  }

  /// Fills a part with the candidates that it may see.
  void fill(const Tile& tile, const Candidates& candidates, Work& work) const {
    if constexpr (!by_packets)  // ray by ray, with any origin
      fill_from<Point>(tile, candidates, work);
    else if (rays_.is_pinhole())
      fill_from_point(tile, candidates, work);
    else
      fill_from<Vectors>(tile, candidates, work);
  }

 private:
  using Base::background_color, Base::find_color, Base::has_one_color, Base::radiance, Base::shaded;
  using Base::image_, Base::integrator_, Base::rays_, Base::scene_, Base::skips_, Base::unbounded_;
  using typename Base::ColorSeen;

  /// Returns true if there are so many surfaces that their numbers are not in a cache.
  [[nodiscard]] bool is_large() const { return scene_.scene().size() > 2048; }

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
    work.taken.camera_rays += static_cast<std::uint64_t>(tile.width() * tile.height()) *
                              static_cast<std::uint64_t>(pixels.samples());
    const bool by_rows = candidates.size() > most_for_all_rows;
    work.of_row.clear();
    View view(scene_, by_rows ? work.of_row : candidates, unbounded_, skips_, work.occluders, work.drawn,
              work.taken);
    if (is_large()) view.fetch(candidates);
    int row = -1;  // the row of blocks that of_row is for
    // Lists the candidates of the row of blocks at y, if the part has too many for one list.
    const auto use_row = [&](int y) {
      if (!by_rows || y / RayBlock::height == row) return;
      row = y / RayBlock::height;
      const int first = row * RayBlock::height, last = std::min(first + RayBlock::height, tile.y1);
      work.of_row.clear();
      work.of_row.add(candidates, Frustum(rays_, {tile.x0, first, tile.x1, last}));
    };
    if constexpr (!by_packets) {
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
          use_row(y);
          image_(x, y) = pixels.mean([&](int i) {
            const Ray ray = pixels.ray(rays_.camera(), x, y, i);
            view.set_pixel(ray);
            return protostar::detail::radiance_of(integrator_, ray, view);
          });
        }
    } else if (pixels.samples() > 1) {
      each_packet(tile, [&](std::size_t, int x, int y) {
        use_row(y);
        write_packet(image_, tile, x, y, mean_radiance<Origin>(tile, x, y, view));
      });
    } else {
      if constexpr (std::same_as<Origin, Point> && ShadingIntegrator<I, View>)
        if (skips_.sure_in_float && unbounded_.empty() &&
            (ShadesAnywhere<I> || candidates.size() > as_fast_in_double))
          return fill_visible(tile, view, by_rows ? work.of_row : candidates, use_row, work);
      if constexpr (std::same_as<Origin, Point> && AsksForCrossings<I>)
        if (skips_.sure_in_float && unbounded_.empty())
          return fill_crossed(tile, view, by_rows ? work.of_row : candidates, use_row, work);
      fill_in_steps<Origin>(tile, view, use_row);
    }
  }

  /// Fills a part of a tile of a pinhole, for an integrator that asks for crossings alone. Packets in which
  /// float does not tell which there are, or of which colors differ from point to point, are made of rays.
  void fill_crossed(const Tile& part, const View& view, const Candidates& candidates, const auto& use_row,
                    Work& work) const {
    const RowOfColors* const background = background_color(work);
    const auto has_texture = [&](int place) { return view.has_texture(place); };
    std::uint64_t float_tests = 0, skipped = 0;
    each_block(part, [&](const Tile& block) {
      use_row(block.y0);
      float_tests += static_cast<std::uint64_t>(candidates.size() * float_lanes);
      const bool is_sure = background && find_crossed(rays_.block_directions(block.x0, block.y0), candidates,
                                                      has_texture, work.crossed);
      if (is_sure) skipped += static_cast<std::uint64_t>(block.width() * block.height());
      if (is_sure && work.crossed.empty()) return write_rows(image_, block, *background);
      each_packet(block, [&](std::size_t, int x, int y) {
        const int lane = (y - block.y0) * RayBlock::width + (x - block.x0);
        const auto write = [&](const auto& rays) {
          write_packet(image_, block, x, y, integrator_.radiance(rays, view));
        };
        view.set_first_pixel(x, y);
        if (is_sure)
          write(CrossingPacket{work.crossed, lane, rays_, x, y});
        else
          write(rays_.packet(block, x, y));
      });
    });
    work.taken.float_tests += float_tests;
    work.taken.pixels_skipped += skipped, work.taken.camera_rays -= skipped;
  }

  /// Largest number of candidates that are tested in double as fast as in float, for colors that need t.
  static constexpr int as_fast_in_double = 3;

  /// Start of a packet in the image.
  struct PacketStart {
    int x, y;
  };
  static constexpr std::size_t most_packets = 16 * ((16 + double_lanes - 1) / double_lanes);

  /// Fills a part of a tile of a pinhole. Float tells what blocks of pixels see. Where that does not tell
  /// their colors, packets of rays go through one step after the other, as in fill_in_steps.
  void fill_visible(const Tile& part, const View& view, const Candidates& candidates, const auto& use_row,
                    Work& work) const {
    std::array<PacketStart, most_packets> open;
    std::size_t count = 0;
    const RowOfColors* const background = background_color(work);
    ColorSeen last;
    std::uint64_t float_tests = 0, skipped = 0;
    each_block(part, [&](const Tile& block) {
      use_row(block.y0);
      const auto [places, tested] = seen_by(rays_.block_directions(block.x0, block.y0), candidates);
      float_tests += static_cast<std::uint64_t>(tested);
      if (write_what_is_seen(block, places, view, background, last)) {
        skipped += static_cast<std::uint64_t>(block.width() * block.height());
      } else {
        work.visibility.set_block(block.x0, block.y0, places);
        each_packet(block, [&](std::size_t, int x, int y) { open[count++] = {x, y}; });
      }
    });
    work.taken.float_tests += float_tests;
    work.taken.pixels_skipped += skipped, work.taken.camera_rays -= skipped;
    std::array<Vectors, most_packets> directions;
    std::array<typename View::Closest, most_packets> closest;
    for (std::size_t i = 0; i < count; ++i) directions[i] = rays_.directions(open[i].x, open[i].y);
    for (std::size_t i = 0; i < count; ++i) {
      const auto [x, y] = open[i];
      use_row(y);
      view.set_first_pixel(x, y);
      closest[i] = view.closest(rays_.packet(part, x, y, directions[i]), work.visibility(x, y));
      if (is_large()) view.fetch(closest[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto [x, y] = open[i];
      view.set_first_pixel(x, y);
      write_packet(image_, part, x, y, shaded(rays_.packet(part, x, y, directions[i]), closest[i], view));
    }
  }

  /// Writes the pixels of a block if what they see tells their colors; returns false if not. `last` is the
  /// surface that was seen last.
  [[nodiscard, gnu::always_inline]] bool write_what_is_seen(const Tile& block, const WideIndices& places,
                                                            const View& view, const RowOfColors* background,
                                                            ColorSeen& last) const {
    constexpr Bits all = first_bits(float_lanes);
    WideFloats r = 0.0f, g = 0.0f, b = 0.0f;
    for (Bits left = all; left != 0;) {
      const std::int32_t place = places[std::countr_zero(left)];
      if (place != sees_nothing && place != last.place) find_color(place, view, last);
      const RowOfColors* const row = place == sees_nothing ? background : last.is_known ? &last.row : nullptr;
      if (!row) return false;
      const auto here = places == WideIndices(place);
      if (bits(here) == all) {
        write_rows(image_, block, *row);
        break;
      }
      const Color& color = row->front();
      r = select(here, WideFloats(color.r), r), g = select(here, WideFloats(color.g), g);
      b = select(here, WideFloats(color.b), b);
      left &= ~bits(here);
      if (left == 0) write_block(image_, block, r, g, b);
    }
    return true;
  }

  /// Takes all packets of a tile through one step after the other: directions, closest hits, colors. Each
  /// step waits for a square root and a division; these waits of many packets overlap.
  template <class Origin>
  void fill_in_steps(const Tile& tile, const View& view, const auto& use_row) const {
    std::array<Vectors, most_packets> directions;
    each_packet(tile, [&](std::size_t i, int x, int y) { directions[i] = rays_.directions(x, y); });
    const auto rays = [&](std::size_t i, int x, int y) {
      return rays_.template packet<Origin>(tile, x, y, directions[i]);
    };
    if constexpr (ShadingIntegrator<I, View>) {
      std::array<typename View::Closest, most_packets> closest;
      each_packet(tile, [&](std::size_t i, int x, int y) {
        use_row(y);
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
        use_row(y);
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
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

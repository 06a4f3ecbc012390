// Visibility buffers of surfaces with many primitives, which are rasterized into a tile: for each pixel the
// primitive that its ray hits first. Those of visibility.hpp have surfaces instead.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "frustum.hpp"
#include "packet.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Surface with many primitives that is rasterized into a tile. It has a type Drawn, a visibility buffer, and
/// draw(drawn, rays, sample, half_spaces, tile) fills one, for one ray of each pixel. If is_drawn() is true
/// then, seen(active, x, y) returns which of the rays from pixel (x, y) on hit the surface, and which are in
/// doubt; `which` is the entry ≥ 0 of the buffer that each ray hits first: crossing 0 of the primitive
/// primitive(which). If some rays hit, t(which, met, directions) returns their t, bit for bit that of
/// first_crossing.
template <class S>
concept RasterizedSurface = is_made_of_primitives<S> &&
    requires(const S& surface, typename S::Drawn& drawn, const PixelRays& rays,
             const TileHalfSpaces& half_spaces, const Tile& tile, const LaneMask& chosen,
             const Indices& which, const Vectors& directions) {
  surface.draw(drawn, rays, 0, half_spaces, tile);
  { drawn.is_drawn() } -> std::same_as<bool>;
  { drawn.seen(chosen, 0, 0).met } -> std::same_as<LaneMask&&>;
  { drawn.seen(chosen, 0, 0).in_doubt } -> std::same_as<LaneMask&&>;
  { drawn.seen(chosen, 0, 0).which } -> std::same_as<Indices&&>;
  { drawn.t(which, chosen, directions) } -> std::same_as<Doubles>;
  { drawn.primitive(std::int64_t{0}) } -> std::same_as<int>;
};

/// Visibility buffers of all surfaces of one type in a tile; empty if the type is not rasterized.
template <class S>
struct VisibilityBuffers {
  void clear() {}
};
template <RasterizedSurface S>
struct VisibilityBuffers<S> {
  /// Largest number of buffers of a tile: one for each surface and sample. What has none is traced ray by
  /// ray.
  static constexpr std::size_t most = 32;

  struct Entry {
    int index, sample;
    typename S::Drawn drawn;
  };
  std::array<std::unique_ptr<Entry>, most> entries;  ///< made when they are needed first, and kept
  std::size_t count = 0;                             ///< number of entries that belong to this tile

  /// Returns a buffer for a surface, by its index in the scene's order, and a sample; null if there are
  /// enough.
  typename S::Drawn* add(int index, int sample) {
    if (count == most) return nullptr;
    std::unique_ptr<Entry>& next = entries[count];
    if (!next) next.reset(new Entry);  // not initialized
    Entry& entry = *next;
    ++count;
    entry.index = index, entry.sample = sample;
    return &entry.drawn;
  }
  void clear() { count = 0; }
  /// Returns the buffer for a surface and a sample; null if there is none, or it is not drawn.
  [[nodiscard]] const typename S::Drawn* at(int index, int sample) const {
    for (std::size_t i = 0; i < count; ++i)
      if (const Entry& entry = *entries[i]; entry.index == index && entry.sample == sample)
        return entry.drawn.is_drawn() ? &entry.drawn : nullptr;
    return nullptr;
  }
};

/// Index of the primitive that each ray hits, from a visibility buffer.
template <class Drawn>
struct PrimitivesSeen {
  const Drawn& drawn;
  const Indices& which;

  int operator[](int lane) const { return drawn.primitive(which[lane]); }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

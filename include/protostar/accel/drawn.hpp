// Surfaces of many parts, which are drawn into a tile as a whole.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "packet.hpp"
#include "tile.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A surface that is drawn into a tile as a whole, since it has many parts. It has a type Drawn, and
/// draw(drawn, rays, sample, frustum, tile, asked) fills one, for one ray of each pixel. If is_drawn() then,
/// seen(wanted, x, y) tells of the rays from pixel (x, y) on which meet it, and which are in doubt. If it
/// tells_where(), as asked, `which` is the entry ≥ 0 of the drawing that each meets first: that is crossing 0
/// of part(which), and if some are met, t(which, met, directions) are the t of these, with the bits of
/// first_crossing's.
template <class S>
concept SurfaceForTiles = SurfaceWithParts<S> &&
    requires(const S& surface, typename S::Drawn& drawn, const PixelRays& rays, const Frustum& frustum,
             const Tile& tile, const Chosen& chosen, const Indices& which, const Vectors& directions) {
  surface.draw(drawn, rays, 0, frustum, tile, Asked::where);
  { drawn.is_drawn() } -> std::same_as<bool>;
  { drawn.tells_where() } -> std::same_as<bool>;
  { drawn.seen(chosen, 0, 0).met } -> std::same_as<Chosen&&>;
  { drawn.seen(chosen, 0, 0).in_doubt } -> std::same_as<Chosen&&>;
  { drawn.seen(chosen, 0, 0).which } -> std::same_as<Indices&&>;
  { drawn.t(which, chosen, directions) } -> std::same_as<Doubles>;
  { drawn.part(std::int64_t{0}) } -> std::same_as<int>;
};

/// The surfaces of one type that are drawn into a tile, if any type is.
template <class S>
struct DrawnOf {
  void clear() {}
};
template <SurfaceForTiles S>
struct DrawnOf<S> {
  /// Beyond this, surfaces of one tile are looked at ray by ray.
  static constexpr std::size_t most = 32;

  struct Entry {
    int place, sample;
    typename S::Drawn drawn;
  };
  std::vector<std::unique_ptr<Entry>> entries;
  std::size_t count = 0;  ///< how many of the entries belong to this tile

  /// One for the surface at a place and the i-th samples of pixels; null if there are enough.
  typename S::Drawn* add(int place, int sample) {
    if (count == most) return nullptr;
    if (count == entries.size()) entries.emplace_back(new Entry);  // not initialized
    Entry& entry = *entries[count++];
    entry.place = place, entry.sample = sample;
    return &entry.drawn;
  }
  void clear() { count = 0; }
  [[nodiscard]] const typename S::Drawn* at(int place, int sample) const {
    for (std::size_t i = 0; i < count; ++i)
      if (const Entry& entry = *entries[i]; entry.place == place && entry.sample == sample)
        return entry.drawn.is_drawn() ? &entry.drawn : nullptr;
    return nullptr;
  }
};

/// The parts of a surface that is drawn.
template <class Drawn>
struct PartsSeen {
  const Drawn& drawn;
  const Indices& which;

  int operator[](int lane) const { return drawn.part(which[lane]); }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

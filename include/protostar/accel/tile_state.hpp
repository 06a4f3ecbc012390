// State that the parts of a tile share, and the list of all surfaces of a small scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../plain_vector.hpp"
#include "../render_options.hpp"
#include "../simd/simd.hpp"
#include "../surface.hpp"
#include "drawn.hpp"
#include "occluders.hpp"
#include "packet.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Surface that rays of a block may cross, by its index in the scene's order, as float tells.
struct CrossedByBlock {
  std::int32_t index;
  Bits maybe, surely;  ///< rays that may cross it; those of them that surely do, on their way in and out
};

/// State that the parts of a tile share.
template <Surface... S>
struct TileState {
  struct Buffers : VisibilityBuffers<S>... {};

  Occluders occluders;
  Buffers buffers;                      ///< of surfaces that are rasterized
  PlainVector<CrossedByBlock> crossed;  ///< surfaces that a block of camera rays may cross
  RenderStatistics counts;
};

/// All surfaces of a scene of few, as a list like Candidates.
struct AllOfFew {
  std::size_t count;

  [[nodiscard]] int size() const { return static_cast<int>(count); }
  [[nodiscard]] int index(int i) const { return i; }
  [[nodiscard]] float nearest(int) const { return 0; }
  [[nodiscard]] std::span<const std::uint32_t> indices() const {
    static constexpr auto all = [] {
      std::array<std::uint32_t, few_surfaces> indices{};
      for (std::uint32_t i = 0; i < few_surfaces; ++i) indices[i] = i;
      return indices;
    }();
    return {all.data(), count};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

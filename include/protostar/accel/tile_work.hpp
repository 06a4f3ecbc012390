// Buffers that the work on a tile fills and later tiles use again, and the skips that pay.
#pragma once

#include <cstddef>
#include <mutex>

#include "../image.hpp"
#include "../render_options.hpp"
#include "../surface.hpp"
#include "candidates.hpp"
#include "drawn.hpp"
#include "packet_pixels.hpp"
#include "tile_hits.hpp"
#include "visibility.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Returns the skips of the options, but no lists of occluders in a picture of fewer than 64 pixels for each
/// surface: a list would serve so few rays that its search costs more than it saves. The picture has the size
/// of options.crop, or without one that of the target's area.
[[nodiscard]] inline Skips skips_that_pay(const RenderOptions& options, const Tile& area,
                                          std::size_t surfaces) {
  const Crop picture = options.crop.or_whole(area.width(), area.height());
  const double pixels = 1.0 * picture.width * picture.height;
  Skips skips = options.skips;
  skips.occluder_lists = skips.occluder_lists && pixels >= 64.0 * static_cast<double>(surfaces);
  return skips;
}

/// Buffers of a tile and of its parts.
template <Surface... S>
struct TileWork {
  static constexpr int most_divisions = 3;  ///< how often a tile is divided into smaller parts

  Candidates lists[most_divisions + 1];  ///< candidates of the tile, and of a part after each division
  CandidatePositions seen_by_block;      ///< in the list of a part: candidates that a block of rays may see
  Visibility visibility;                 ///< first surface of each pixel of a part
  TileState<S...> state;
  PacketSums sums[most_packets];  ///< sums of the samples so far of a part, unless pixels keep a single one
  TileWork* next;                 ///< in the list of all buffers of a picture
  bool is_taken;                  ///< true while a tile uses them
};

/// Buffers of the tiles of a picture. They are large, so that a tile takes those of an earlier one.
template <Surface... S>
class TileWorks {
 public:
  using Work = TileWork<S...>;

  TileWorks() = default;
  TileWorks(const TileWorks&) = delete;
  TileWorks& operator=(const TileWorks&) = delete;
  ~TileWorks() {
    while (Work* const work = first_) {
      first_ = work->next;
      delete work;
    }
  }

  /// Returns buffers that no other tile uses, with counts of 0, and without visibility buffers or occluders;
  /// all else in them is undefined. May be called by several threads at once, as may give_back.
  [[nodiscard]] Work& take() {
    const std::lock_guard lock(sharing_);
    Work* work = first_;
    while (work && work->is_taken) work = work->next;
    if (work) {
      (work->state.buffers.VisibilityBuffers<S>::clear(), ...);
      work->state.occluders.clear(), work->state.counts = {};
    } else {
      work = new Work;  // not initialized
      work->next = first_;
      first_ = work;
    }
    work->is_taken = true;
    return *work;
  }

  /// Takes back buffers that take() returned, and adds their counts to the statistics, unless these are null.
  void give_back(Work& work, RenderStatistics* statistics) {
    const std::lock_guard lock(sharing_);
    if (statistics) *statistics += work.state.counts;
    work.is_taken = false;
  }

 private:
  std::mutex sharing_;     ///< guards the statistics and the list
  Work* first_ = nullptr;  ///< of all buffers, as many as threads have used at once
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

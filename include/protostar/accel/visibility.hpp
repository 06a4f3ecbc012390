// Visibility buffer: the surface that each pixel of a part of a tile surely sees first, decided in float.
//
// A candidate is a sphere around the apex of a pinhole: center l, radius r. The ray of a pixel, of unit
// direction d, passes the center at b = d·l from the apex, and at p = l − b d from the center. It meets the
// sphere if |p| ≤ r, from b − h to b + h with h = √(r² − |p|²). In float, with u = 2^-24, these are off by at
// most
//
//   l   one rounding: u|l|
//   d   (1 + δ) d + ε with |δ| ≤ 11u and |ε| ≤ 8u (PixelRays::block_directions)
//   b   the errors of l and d, and 3u|l| for products and sums: 23.1u|l|
//   p   across d, u|l| for l, 8u|l| for ε, 2u|l| for the product and the difference: 12u|l|; along d, δ
//   twice,
//       the rest of the error of b, and as much again as across: 46u|l|
//
// so that |p| − 12u|l| ≤ |p'| and |p'|² ≤ (|p| + 12u|l|)² + (46u|l|)² for p' as computed, and |p'|² is off by
// 3u of itself. Let e = 16u (|l| + r), the reach R = √((r + e)² + (48u|l|)²), the inner radius i = r − e and
// the margin m = 2e: e leaves 4u|l| + 16u r, and 48u|l| leaves 2u|l|, for the rounding of radii, squares and
// their differences.
//
// Missed: with |p'| > R, or b < −R − m, the ray does not meet the sphere.
//
// Met: with |p'| < i and b > m, the line passes the center nearer than r, ahead of the apex. If the apex is
// outside, the ray enters the sphere.
//
// First hit: R² − |p'|² is at least (r + e)² − (|p| + 12u|l|)², hence at least h². i² − |p'|² is at most h²:
// for |p| > 12u|l| it is (r − e)² − (|p| − 12u|l|)², and else i² itself. So the first hit is at
// t ≥ b − √(R² − |p'|²) − m, and if the sphere is surely met, at t ≤ b − √(i² − |p'|²) + m: b, roots and sums
// are off by less than 30u (|l| + r). Bounds that need no root are b − R − m and b + m.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "../image.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "candidates.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// A sphere as the rays of a block pass it.
struct PassedBy {
  const CandidateSphere& sphere;
  BlockFloats along, squared;  ///< b and |p|², as at the top of this file

  PassedBy(const CandidateSphere& passed, const BlockDirections& d) : sphere(passed) {
    const BlockFloats x(passed.x), y(passed.y), z(passed.z);
    along = d.x * x + d.y * y + d.z * z;
    const BlockFloats px = x - along * d.x, py = y - along * d.y, pz = z - along * d.z;
    squared = px * px + py * py + pz * pz;
  }

  /// Returns the rays that may meet the sphere; 2^-120 covers underflow of squares.
  [[nodiscard]] BlockMask maybe() const {
    return squared <= BlockFloats(sphere.reach * sphere.reach + 0x1p-120f) &&
           along >= BlockFloats(-sphere.reach - sphere.margin);
  }
  /// Returns the rays that surely enter the surface, and leave the sphere.
  [[nodiscard]] BlockMask surely() const {
    if (!(sphere.inner > 0)) return BlockMask(false);
    return squared < BlockFloats(sphere.inner * sphere.inner) && along > BlockFloats(sphere.margin);
  }

  /// Bounds of t at the first hit: a lower one if there may be a hit, an upper one if there surely is.
  struct Entry {
    BlockFloats from, until;
  };
  [[nodiscard]] Entry entry_roughly() const {
    return {along - BlockFloats(sphere.reach + sphere.margin), along + BlockFloats(sphere.margin)};
  }
  [[nodiscard]] Entry entry() const {
    if (!(0x1p-40f < sphere.reach && sphere.reach < 0x1p60f))
      return entry_roughly();  // squares might underflow, or be infinite
    const auto half_chord = [&](float radius) {
      return sqrt(max(BlockFloats(radius * radius) - squared, BlockFloats(0.0f)));
    };
    return {along - half_chord(sphere.reach) - BlockFloats(sphere.margin),
            along - half_chord(sphere.inner) + BlockFloats(sphere.margin)};
  }
};

/// What a pixel sees, instead of a surface by its index in the scene's order.
inline constexpr std::int32_t sees_nothing = -1, is_in_doubt = -2;

namespace detail {

/// Surfaces that rays of a block surely meet, the rays that may meet another one before, and how many
/// candidates were tested.
struct FirstSeen {
  BlockIndices places;
  BlockMask in_doubt;
  int tested;
};

template <bool with_roots>
[[nodiscard, gnu::always_inline]] inline FirstSeen first_seen(const Candidates& candidates,
                                                              const BlockDirections& directions) {
  constexpr float never = std::numeric_limits<float>::infinity();
  // Bounds of the first hit of the surface that is surely met soonest, and where the others begin.
  BlockFloats until = never, from = never, others_from = never;
  BlockIndices places = sees_nothing;
  int k = 0;
  for (; k < candidates.size(); ++k) {
    // If no ray can reach a candidate before its first hit, none can reach those that follow.
    if (k > 0 && !any(until >= BlockFloats(candidates.nearest(k)))) break;
    const CandidateSphere sphere = candidates.sphere(k);
    const PassedBy passed(sphere, directions);
    const auto maybe = passed.maybe();
    if (!any(maybe)) continue;
    const auto entry = with_roots ? passed.entry() : passed.entry_roughly();
    const auto is_first = maybe && passed.surely() && entry.until < until;
    others_from = select(maybe, min(select(is_first, from, entry.from), others_from), others_from);
    until = select(is_first, entry.until, until);
    from = select(is_first, entry.from, from);
    places = select(is_first, BlockIndices(candidates.place(k)), places);
  }
  return {places, others_from < never && others_from <= until, k};
}

}  // namespace detail

/// What the rays of a block see first: sees_nothing, is_in_doubt or a surface's index in the scene's order.
struct SeenByBlock {
  BlockIndices places;
  int tested;  ///< number of tests of a ray with a candidate
};

/// Finds what the rays of a block see first among candidates, which may be sorted near to far.
[[nodiscard, gnu::always_inline]] inline SeenByBlock seen_by(const BlockDirections& directions,
                                                             const Candidates& candidates) {
  detail::FirstSeen seen = detail::first_seen<false>(candidates, directions);
  int tested = seen.tested;
  if (any(seen.in_doubt)) {
    seen = detail::first_seen<true>(candidates, directions);
    tested += seen.tested;
  }
  return {select(seen.in_doubt, BlockIndices(is_in_doubt), seen.places), tested * float_lanes};
}

/// What the pixels of a part of a tile see. A part begins at a multiple of the size of a block.
class Visibility {
 public:
  using Places = Lanes<std::int32_t, double_lanes>;

  static constexpr int width = 16, height = 16;  ///< largest size of a part

  void set_block(int x, int y, const BlockIndices& places) { places.store(&places_[index(x, y)]); }

  /// Returns what the pixels of a packet from (x, y) on see.
  [[nodiscard]] Places operator()(int x, int y) const { return Places::load(&places_[index(x, y)]); }

 private:
  /// Returns where a pixel is stored: block by block.
  static std::size_t index(int x, int y) {
    constexpr int w = RayBlock::width, h = RayBlock::height;
    const int block = y % height / h * (width / w) + x % width / w;
    return static_cast<std::size_t>(block * float_lanes + y % h * w + x % w);
  }

  alignas(64) std::int32_t places_[width * height];
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

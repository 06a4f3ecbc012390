// Visibility buffer of a part of a tile. As far as float tells, each pixel sees nothing, one surface, one
// unless one other comes before it, or is in doubt.
//
// A candidate is a sphere that contains a surface: radius r, center l measured from the apex of the pinhole.
// With u = 2^-24, what sphere_filter.hpp computes of it is off by at most
//
//   l   one rounding: u|l|
//   d   (1 + δ) d + ε with |δ| ≤ 11u and |ε| ≤ 8u (PixelRays::block_directions)
//   b   the errors of l and d, and 3u|l| for products and sums: 23.1u|l|
//   p   across d, u|l| for l, 8u|l| for ε, 2u|l| for the product and the difference: 12u|l|; along d, where p
//       is 0, twice δ, the rest of the error of b, and as much again as across: 46u|l|
//
// so that |p| − 12u|l| ≤ |p'| and |p'|² ≤ (|p| + 12u|l|)² + (46u|l|)² for p' as computed, and |p'|² is off by
// 3u of itself. With e = 16u (|l| + r), the reach is R = √((r + e)² + (48u|l|)²), the inner radius i = r − e,
// and the margin m = 2e: e leaves 4u|l| + 16u r, and 48u|l| leaves 2u|l|, for the rounding of radii, squares
// and their differences. b, roots and sums are off by less than 30u (|l| + r) = 0.94 m.
// (docs/derivations.md, tests/proofs/visibility.gappa, visibility_radii.gappa)
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "../image.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "candidates.hpp"
#include "pixel_rays.hpp"
#include "sphere_filter.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Returns how the rays of a block, which start at the apex, pass a candidate.
[[nodiscard, gnu::always_inline]] inline SpherePass pass(const CandidateSphere& sphere,
                                                         const WideVectors& directions) {
  return {LinePass(directions, {sphere.x, sphere.y, sphere.z}), sphere.reach, sphere.inner, sphere.margin};
}

/// Values in place of the index ≥ 0 of a surface in the scene's order: none, or doubt which it is.
inline constexpr std::int32_t no_surface_index = -1, doubtful_index = -2;

namespace detail {

/// Surfaces that the rays of a block surely hit first, or no_surface_index, unless they hit one of some
/// others before. `others` is the one of these that may begin first, if have_other is true; if have_several
/// is true, there are more. `tested` counts candidates.
struct FirstSeen {
  WideIndices indices, others;
  WideMask have_other, have_several;
  int tested;
};

/// Returns true if the squares of a sphere's radii neither underflow nor overflow in float.
inline bool squares_fit_float(const CandidateSphere& sphere) {
  return 0x1p-40f < sphere.reach && sphere.reach < 0x1p60f;
}

/// Finds the first of the candidates at `positions`, by bounds of t with square roots or without. It stops
/// where no candidate can be hit sooner, as a list that is sorted near to far tells.
template <bool with_roots>
[[nodiscard, gnu::always_inline]] inline FirstSeen first_seen(const Candidates& candidates,
                                                              const CandidatePositions& positions,
                                                              const WideVectors& directions) {
  constexpr float never = std::numeric_limits<float>::infinity();
  // Bounds of the first hit of the surface that is surely met soonest, and where the first and the second of
  // the others begin.
  WideFloats until = never, from = never, other_from = never, next_from = never;
  WideIndices indices = no_surface_index, others = no_surface_index;
  int tested = 0;
  for (; tested < positions.size(); ++tested) {
    const int k = positions[tested];
    // If no ray can reach a candidate before its first hit, none can reach those that follow.
    if (tested > 0 && !any(until >= WideFloats(candidates.nearest(k)))) break;
    const CandidateSphere sphere = candidates.sphere(k);
    const SpherePass passed = pass(sphere, directions);
    const WideMask maybe = passed.maybe();
    // It is as good as random if any ray may meet it, and therefore no branch, unless it saves roots.
    if (with_roots && !any(maybe)) continue;
    const WideIndices index = candidates.index(k);
    const auto entry = with_roots && squares_fit_float(sphere) ? passed.entry() : passed.entry_roughly();
    const auto is_first = maybe && passed.surely() && entry.until < until;
    // One of both, this surface and the first so far, is first now, and the other begins here.
    const WideFloats begins = select(maybe, select(is_first, from, entry.from), never);
    others = select(begins < other_from, select(is_first, indices, index), others);
    next_from = min(next_from, max(other_from, begins));
    other_from = min(other_from, begins);
    until = select(is_first, entry.until, until);
    from = select(is_first, entry.from, from);
    indices = select(is_first, index, indices);
  }
  const auto may_precede = [&](const WideFloats& begins) { return begins < never && begins <= until; };
  return {indices, others, may_precede(other_from), may_precede(next_from), tested};
}

}  // namespace detail

/// First surface on each ray of a block, as far as float tells. `indices` holds the index of the first that
/// the ray surely hits, no_surface_index if there is none, or doubtful_index. `others` holds the one other
/// surface that the ray may hit earlier; if it is no_surface_index, `indices` is certain.
struct SeenByBlock {
  WideIndices indices, others;
  int ray_tests;  ///< number of tests of a ray with a candidate
};

/// Finds the first surface on each ray of a block among the candidates at `positions`. Bounds of t without
/// square roots come first. The search is repeated with square roots if these bounds leave any ray with more
/// than one other surface; or with any other, if rays are not traced anyway and a certain pixel needs none.
[[nodiscard, gnu::always_inline]] inline SeenByBlock seen_by(const WideVectors& directions,
                                                             const Candidates& candidates,
                                                             const CandidatePositions& positions,
                                                             bool are_traced_anyway) {
  detail::FirstSeen seen = detail::first_seen<false>(candidates, positions, directions);
  int tested = seen.tested;
  if (any(are_traced_anyway ? seen.have_several : seen.have_other)) {
    seen = detail::first_seen<true>(candidates, positions, directions);
    tested += seen.tested;
  }
  return {select(seen.have_several, WideIndices(doubtful_index), seen.indices),
          select(seen.have_other && !seen.have_several, seen.others, WideIndices(no_surface_index)),
          tested * float_lanes};
}

/// First surface on each ray of a packet, as SeenByBlock tells those of a block; in doubt unless set.
struct SeenByPacket {
  Indices indices = doubtful_index, others = no_surface_index;

  /// Returns indices where they are certain, else doubtful_index.
  [[nodiscard]] Indices surely() const {
    return select(others == Indices(no_surface_index), indices, Indices(doubtful_index));
  }
};

/// First surface of each pixel of a part of a tile (SeenByBlock). A part has at most 16 × 16 pixels, and
/// begins at a multiple of the size of a block.
class Visibility {
 public:
  static constexpr int width = 16, height = 16;  ///< largest size of a part

  /// Sets the surfaces of the block that begins at pixel (x, y).
  void set_block(int x, int y, const SeenByBlock& seen) {
    seen.indices.store(&indices_[slot(x, y)]), seen.others.store(&others_[slot(x, y)]);
  }

  /// Sets the surfaces of the packet that begins at pixel (x, y), each of them certain or doubtful_index.
  void set_packet(int x, int y, const Indices& indices) {
    for (int i = 0; i < double_lanes; ++i) {
      indices_[slot(x, y) + static_cast<std::size_t>(i)] = static_cast<std::int32_t>(indices[i]);
      others_[slot(x, y) + static_cast<std::size_t>(i)] = no_surface_index;
    }
  }

  /// Returns the surfaces of the packet that begins at pixel (x, y).
  [[nodiscard]] SeenByPacket operator()(int x, int y) const {
    return {in_packet(indices_, x, y), in_packet(others_, x, y)};
  }

 private:
  /// Returns where a pixel is stored: block by block.
  static std::size_t slot(int x, int y) {
    constexpr int w = RayBlock::width, h = RayBlock::height;
    const int block = y % height / h * (width / w) + x % width / w;
    return static_cast<std::size_t>(block * float_lanes + y % h * w + x % w);
  }
  [[nodiscard]] static Indices in_packet(const std::int32_t* of_pixels, int x, int y) {
    return widened(Lanes<std::int32_t, double_lanes>::load(&of_pixels[slot(x, y)]));
  }

  alignas(64) std::int32_t indices_[width * height], others_[width * height];
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

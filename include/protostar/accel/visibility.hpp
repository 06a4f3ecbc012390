// Visibility buffer: the index of the surface that each pixel of a part of a tile surely sees first, decided
// in float.
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

/// Returns how the rays of a block pass a candidate.
[[nodiscard, gnu::always_inline]] inline SpherePass pass(const CandidateSphere& sphere,
                                                         const WideVectors& directions) {
  return {LinePass(directions, {sphere.x, sphere.y, sphere.z}), sphere.reach, sphere.inner, sphere.margin};
}

/// What a pixel sees, instead of a surface by its index in the scene's order.
inline constexpr std::int32_t sees_nothing = -1, is_in_doubt = -2;

namespace detail {

/// Surfaces that rays of a block surely meet, the rays that may meet another one before, and how many
/// candidates were tested.
struct FirstSeen {
  WideIndices indices;
  WideMask in_doubt;
  int tested;
};

/// Returns true if the squares of a sphere's radii neither underflow nor overflow in float.
inline bool squares_fit_float(const CandidateSphere& sphere) {
  return 0x1p-40f < sphere.reach && sphere.reach < 0x1p60f;
}

template <bool with_roots>
[[nodiscard, gnu::always_inline]] inline FirstSeen first_seen(const Candidates& candidates,
                                                              const WideVectors& directions) {
  constexpr float never = std::numeric_limits<float>::infinity();
  // Bounds of the first hit of the surface that is surely met soonest, and where the others begin.
  WideFloats until = never, from = never, others_from = never;
  WideIndices indices = sees_nothing;
  int k = 0;
  for (; k < candidates.size(); ++k) {
    // If no ray can reach a candidate before its first hit, none can reach those that follow.
    if (k > 0 && !any(until >= WideFloats(candidates.nearest(k)))) break;
    const CandidateSphere sphere = candidates.sphere(k);
    const SpherePass passed = pass(sphere, directions);
    const WideMask maybe = passed.maybe();
    if (!any(maybe)) continue;
    const auto entry = with_roots && squares_fit_float(sphere) ? passed.entry() : passed.entry_roughly();
    const auto is_first = maybe && passed.surely() && entry.until < until;
    others_from = select(maybe, min(select(is_first, from, entry.from), others_from), others_from);
    until = select(is_first, entry.until, until);
    from = select(is_first, entry.from, from);
    indices = select(is_first, WideIndices(candidates.index(k)), indices);
  }
  return {indices, others_from < never && others_from <= until, k};
}

}  // namespace detail

/// What the rays of a block see first: sees_nothing, is_in_doubt or a surface's index in the scene's order.
struct SeenByBlock {
  WideIndices indices;
  int tested;  ///< number of tests of a ray with a candidate
};

/// Finds what the rays of a block see first, as far as float tells.
[[nodiscard, gnu::always_inline]] inline SeenByBlock seen_by(const WideVectors& directions,
                                                             const Candidates& candidates) {
  detail::FirstSeen seen = detail::first_seen<false>(candidates, directions);
  int tested = seen.tested;
  if (any(seen.in_doubt)) {
    seen = detail::first_seen<true>(candidates, directions);
    tested += seen.tested;
  }
  return {select(seen.in_doubt, WideIndices(is_in_doubt), seen.indices), tested * float_lanes};
}

/// What each pixel of a part of a tile sees first: the index of a surface, sees_nothing or is_in_doubt. A
/// part has at most 16 × 16 pixels, and begins at a multiple of the size of a block.
class Visibility {
 public:
  using SurfaceIndices = Lanes<std::int32_t, double_lanes>;

  static constexpr int width = 16, height = 16;  ///< largest size of a part

  void set_block(int x, int y, const WideIndices& indices) { indices.store(&indices_[index(x, y)]); }

  void set_packet(int x, int y, const Indices& indices) {
    for (int i = 0; i < double_lanes; ++i)
      indices_[index(x, y) + static_cast<std::size_t>(i)] = static_cast<std::int32_t>(indices[i]);
  }

  /// Returns what the pixels of a packet from (x, y) on see.
  [[nodiscard]] SurfaceIndices operator()(int x, int y) const {
    return SurfaceIndices::load(&indices_[index(x, y)]);
  }

 private:
  /// Returns where a pixel is stored: block by block.
  static std::size_t index(int x, int y) {
    constexpr int w = RayBlock::width, h = RayBlock::height;
    const int block = y % height / h * (width / w) + x % width / w;
    return static_cast<std::size_t>(block * float_lanes + y % h * w + x % w);
  }

  alignas(64) std::int32_t indices_[width * height];
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

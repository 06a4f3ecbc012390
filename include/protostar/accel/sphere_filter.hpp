// Filter of spheres in float: which lines surely miss a sphere, which surely meet it, and from where to
// where.
//
// Let l be the vector from a ray's origin to the center, r the radius, and d the direction, of length 1. The
// line passes the center at b = d·l from the origin, and at p = l − b d from the center. It meets the sphere
// if |p| ≤ r, from b − h to b + h with h = √(r² − |p|²).
//
// In float, p and b are off by some errors (at the top of visibility.hpp and of sphere_leaves.hpp). Three
// numbers that cover these are enough for all that is said here:
//
//   reach R   a line that meets the sphere has |p| ≤ R as computed, and R² − |p|² ≥ h²
//   inner i   a line with |p| < i as computed passes the center nearer than r, and i² − |p|² ≤ h²
//   margin m  is more than the errors of b, of roots and of sums
//
// Missed: with |p| > R, or b < −R − m, the ray does not meet the sphere.
//
// Met: with |p| < i and b > m, the line meets the sphere, whose center is ahead. A ray that starts outside
// enters the sphere.
//
// First hit: it is at t ≥ b − √(R² − |p|²) − m, and if the sphere is surely met by a ray that starts outside,
// at t ≤ b − √(i² − |p|²) + m. Bounds that need no root are b − R − m and b + m.
//
// Within a part of the ray, from t = f to t = g: a ray that meets the sphere there has f − b ≤ h and
// b − g ≤ h. Let a be the larger of f − b − m and b − g − m, or 0 if both are below it. Then a ≤ h, hence
// a² + |p|² ≤ R²: the center is not farther than R from the part. And a ray with b − m − f > 0 and
// (b − m − f)² + |p|² > R² starts the part outside and before the center; if the line surely meets the
// sphere, the ray enters it behind f. It does so before g, if the center or a point inside is before g: for
// b + m ≤ g, or (b + m − g)² + |p|² < i². No root is needed. In float the squares and their sums
// are off by 4u, u = 2^-24, which is less than an eighth of what R² and i² leave (tests/proofs).
//
// Each product may be rounded or not before it is added (fused_or_not): the bounds are for both.
#pragma once

#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Lines of directions d that pass centers l.
struct LinePass {
  WideFloats along, squared;  ///< b and |p|², as at the top of this file

  LinePass(const WideVectors& d, const WideVectors& l) {
    along = dot(d, l);
    const WideVectors p{fused_or_not(-along, d.x, l.x), fused_or_not(-along, d.y, l.y),
                        fused_or_not(-along, d.z, l.z)};
    squared = dot(p, p);
  }
};

/// Lines that pass spheres: lines in lanes and one sphere, or one line and spheres in lanes.
struct SpherePass : LinePass {
  WideFloats reach, inner, margin;  ///< R, i and m

  /// Returns where a ray may meet a sphere; 2^-120 covers underflow of squares.
  [[nodiscard]] WideMask maybe() const {
    return squared <= fused_or_not(reach, reach, WideFloats(0x1p-120f)) && along >= -reach - margin;
  }
  /// Returns where a line surely meets a sphere whose center is ahead.
  [[nodiscard]] WideMask surely() const {
    return inner > WideFloats(0.0f) && squared < inner * inner && along > margin;
  }

  /// Returns where a ray may meet a sphere within a part of it.
  [[nodiscard]] WideMask maybe_within(float from, float until) const {
    const WideFloats apart =
        max(max(WideFloats(from) - along, along - WideFloats(until)) - margin, WideFloats(0.0f));
    return fused_or_not(apart, apart, squared) <= fused_or_not(reach, reach, WideFloats(0x1p-120f));
  }
  /// Returns where a ray surely enters a sphere within a part of it.
  [[nodiscard]] WideMask surely_within(float from, float until) const {
    const WideFloats before = along - margin - WideFloats(from),
                     behind = max(along + margin - WideFloats(until), WideFloats(0.0f));
    return inner > WideFloats(0.0f) && before > WideFloats(0.0f) &&
           fused_or_not(before, before, squared) > fused_or_not(reach, reach, WideFloats(0x1p-120f)) &&
           fused_or_not(behind, behind, squared) < inner * inner;
  }

  /// Bounds of t at the first hit: a lower one if there may be a hit, an upper one if there surely is.
  struct Entry {
    WideFloats from, until;
  };
  [[nodiscard]] Entry entry() const {
    return {along - half_chord(reach) - margin, along - half_chord(inner) + margin};
  }
  [[nodiscard]] Entry entry_roughly() const { return {along - reach - margin, along + margin}; }

 private:
  [[nodiscard]] WideFloats half_chord(const WideFloats& radius) const {
    return sqrt(max(radius * radius - squared, WideFloats(0.0f)));
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd

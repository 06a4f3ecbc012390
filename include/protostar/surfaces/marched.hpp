// Surfaces that are marched: the points where a field is 0, as a distance field is on a surface (§3.2). Their
// marches are in distance_field.hpp, with a proof, and in plain_field.hpp, without one.
#pragma once

#include <utility>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Surface of a field: the points inside the bounds where the field is 0. The inside is the points where it
/// is below 0. It is made of the field and the bounds: `Marched{field, Bounds{...}}`. Points in the bounds
/// surely count, also in a face of them. Points outside may count as well, up to a distance of 2^-10 of the
/// largest side and two last places of t.
///
/// A DistanceField is a generic function of a point, as [](const auto& p) { return length(p) - 1.0; }. From
/// it the library derives how fast it changes, and how much it is rounded, and each hit is proven: t is
/// enclosed to 2^-30 of itself, nothing lies before it, and a miss is a miss. Where a ray comes nearer to the
/// surface than double-double tells, about 2^-95, it hits, and fallbacks.undecided counts it. A ray that
/// leaves at a grazing angle, or starts next to the surface and comes to it at such an angle, may cross it
/// so near that t is enclosed only to 2^-30 of the size of the bounds; its order among crossings of other
/// surfaces as near is not proven.
///
/// A field has to be continuous: one made with wrap jumps at the borders of its cells unless it looks at the
/// neighbors too, and proofs of a field that jumps do not hold. Most jumps are found and refused, but a small
/// one may not be found (field_jumps.hpp).
///
/// A plain function of a Point takes a Lipschitz constant besides, and nothing is proven then.
template <class F>
class Marched;

/// Surface of a field whose type is const, as decltype names that of `const auto field = ...`:
/// Scene<Marched<decltype(field)>> takes Marched{field, ...}.
template <class F>
class Marched<const F> : public Marched<F> {
 public:
  using Marched<F>::Marched;
  Marched(Marched<F> surface) : Marched<F>(std::move(surface)) {}
};

}  // namespace protostar::inline PROTOSTAR_ABI

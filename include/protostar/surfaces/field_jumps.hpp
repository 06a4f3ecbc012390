// A search for jumps of a field, whose march would prove what is wrong.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "../bounds.hpp"
#include "../exact/distance_field.hpp"
#include "../exact/lipschitz.hpp"
#include "../shown.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Throws std::invalid_argument if a field of a box changes, between two of some points that are tried, by
/// more than a continuous field can with its Lipschitz constant and its rounding. Such a field jumps, as one
/// made with wrap does that does not look at the neighboring cells, and no bound of it holds. A continuous
/// field always passes; one with jumps may, if none of the tried pairs is on both sides of one.
///
/// Pairs lie along the axes. Their distances are the sides of the box, divided by 2, 4, … 2^12: those longer
/// than a jump divided by the Lipschitz constant do not tell it, and shorter ones are seldom on both sides of
/// one. The first points of pairs are 16 for each distance and axis, spread evenly: multiples of irrational
/// numbers, of which no combination by small whole numbers is near to a whole number.
void refuse_jumps(const auto& field, const Bounds& box, const FieldBound& bound) {
  const auto share = [](double x) { return x - std::floor(x); };
  int i = 0;
  for (double way = 0.5; way >= 0x1p-12; way /= 2)
    for (int axis = 0; axis < 3; ++axis)
      for (int n = 0; n < 16; ++n) {
        ++i;
        const double at[3] = {share(i * 0.8191725133961645), share(i * 0.6710436067037893),
                              share(i * 0.5497004779019703)};
        Point a, b;
        for (int k = 0; k < 3; ++k) {
          const double side = box.max[k] - box.min[k], from = k == axis ? at[k] * (1 - way) : at[k];
          a[k] = box.min[k] + from * side;
          b[k] = k == axis ? box.min[k] + (from + way) * side : a[k];
        }
        const double distance = std::abs(b[axis] - a[axis]);
        const double change = std::abs(plain_value(field, b) - plain_value(field, a));
        const double most = bound.lipschitz * distance + 2 * bound.error;
        if (!(change > most * (1 + 0x1p-40))) continue;
        throw std::invalid_argument(
            "Marched: the field jumps, so that proofs about it would not hold: from (" + shown(a.x) + ", " +
            shown(a.y) + ", " + shown(a.z) + ") to (" + shown(b.x) + ", " + shown(b.y) + ", " + shown(b.z) +
            ") it changes by " + shown(change) + ", and a continuous field with its slopes by at most " +
            shown(most) + "; a field made with wrap must be that of the neighboring cells as well");
      }
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

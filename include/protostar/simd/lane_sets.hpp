// Sets of lanes, as the bits of a number, and the loop over the lanes of one.
#pragma once

#include <bit>
#include <cstdint>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Set of lanes; the lowest bit is lane 0.
using Bits = std::uint32_t;

/// Returns the set of the first `count` lanes.
[[nodiscard]] constexpr Bits first_bits(int count) { return count >= 32 ? ~Bits{0} : (Bits{1} << count) - 1; }

/// Range of the lanes in a set, from the first on, and its own iterator.
struct LanesIn {
  Bits remaining;

  [[nodiscard]] constexpr LanesIn begin() const { return *this; }
  [[nodiscard]] constexpr LanesIn end() const { return {0}; }
  constexpr int operator*() const { return std::countr_zero(remaining); }
  constexpr void operator++() { remaining &= remaining - 1; }
  constexpr bool operator==(const LanesIn&) const = default;
};

/// Returns the lanes in a set, for a loop: `for (const int lane : lanes_in(set))`. The loop may change the
/// set.
[[nodiscard]] constexpr LanesIn lanes_in(Bits lanes) { return {lanes}; }

}  // namespace protostar::inline PROTOSTAR_ABI::simd

// The time in which a camera's shutter is open.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "platform.hpp"
#include "shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Times from `opens` to `closes`. At the default, of no length, everything is seen at time 0.
struct Shutter {
  double opens = 0, closes = 0;

  /// Returns true if rays are at different times.
  [[nodiscard]] bool is_open() const { return closes > opens; }

  /// Returns the time at a share of the opening, from 0 to 1; shares may be numbers in lanes.
  [[nodiscard]] auto at(const auto& share) const { return opens + share * (closes - opens); }

  /// Returns the time in which it is open that is nearest to another.
  [[nodiscard]] double nearest(double time) const { return std::clamp(time, opens, closes); }

  /// Throws std::invalid_argument if it closes before it opens, or a time is not between ±2^400.
  [[gnu::cold]] void validate(const std::string& of) const {
    if (std::abs(opens) <= 0x1p400 && std::abs(closes) <= 0x1p400 && opens <= closes) return;
    throw std::invalid_argument(of +
                                ": the shutter must close when it opens or later, both at times between "
                                "-2^400 and 2^400; it opens at " +
                                shown(opens) + " and closes at " + shown(closes));
  }

  friend bool operator==(const Shutter&, const Shutter&) = default;
};

}  // namespace protostar::inline PROTOSTAR_ABI

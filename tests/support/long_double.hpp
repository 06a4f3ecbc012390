// Whether long double is a reference for double.
#pragma once

#include <limits>

#include "catch.hpp"

/// Returns true if long double has enough digits to judge double, as on x86; warns if not that the test is
/// not done.
inline bool long_double_judges() {
  if (std::numeric_limits<long double>::digits >= 64) return true;
  WARN("not tested: long double has no more digits than double");
  return false;
}

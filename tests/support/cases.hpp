// Numbers of cases of tests that have a short and a long form.
#pragma once

#include "support/sanitizers.hpp"

/// Returns how many cases a test looks at, or pictures it draws: some, or all of them in its long form
/// (PROTOSTAR_LONG_FORMS), or few under AddressSanitizer, where each takes about ten times as long.
constexpr int cases([[maybe_unused]] int few, [[maybe_unused]] int some, int all) {
  if (PROTOSTAR_LONG_FORMS) return all;
#if defined(ADDRESS_SANITIZER)
  return few;
#else
  return some;
#endif
}

/// Returns how many cases a test looks at that is quick enough under sanitizers, too: some, or all in its
/// long form.
constexpr int cases(int some, int all) { return cases(some, some, all); }

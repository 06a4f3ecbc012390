// Numbers of cases of tests that have a short and a long form.
#pragma once

/// Returns how many cases a test looks at, or pictures it draws: some, or all of them in its long form
/// (PROTOSTAR_LONG_FORMS).
constexpr int cases(int some, int all) { return PROTOSTAR_LONG_FORMS ? all : some; }

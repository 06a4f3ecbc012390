// Numbers of cases of tests that have a short and a long form.
#pragma once

/// Returns how many cases a test looks at: some, or all of them where long tests are asked for
/// (PROTOSTAR_LONG_TESTS).
constexpr int cases(int some, int all) { return PROTOSTAR_LONG_FORMS ? all : some; }

/// Returns how many pictures a test draws: some, or all of them where that is asked for
/// (PROTOSTAR_PICTURE_TESTS).
constexpr int pictures(int some, int all) { return PROTOSTAR_ALL_PICTURES ? all : some; }

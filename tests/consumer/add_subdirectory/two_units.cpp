// Checks that two units of one program, compiled for different instruction sets, share no code, or one would
// run the other's instructions, and that they draw the same picture.
#include <cstdio>
#include <cstring>

#include "unit.hpp"

DECLARE_UNIT(baseline)
DECLARE_UNIT(avx2)

namespace {

int fail(const char* reason) {
  std::fprintf(stderr, "two_units: %s\n", reason);
  return 1;
}

}  // namespace

int main() {
  std::printf("baseline: %s\navx2:     %s\n", baseline::scene_type(), avx2::scene_type());
  if (std::strcmp(baseline::scene_type(), avx2::scene_type()) == 0)
    return fail("both units name their scene's type alike");
  if (baseline::inline_function() == avx2::inline_function())
    return fail("the linker has merged a function of the two units");

  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) {
    std::puts("skipped: the comparison of the pictures, since this processor has no AVX2 and FMA");
    return 0;
  }
  if (baseline::picture() != avx2::picture()) return fail("the units draw different pictures");
  return 0;
}

// A number that a compiler cannot look through, alone or in the lanes of a vector.
#pragma once

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Returns x, a double or a vector of them, in a form that a compiler cannot look through. Error-free
/// transforms need each operation rounded as it is written. A compiler that may contract (g++ does unless
/// told -ffp-contract=off) would fuse a product with the addition that takes it, and the transform's error
/// term would belong to another sum.
template <class T>
[[nodiscard]] inline T opaque(T x) {
#if defined(__GNUC__) && defined(__SSE2__) && defined(__AVX512F__)
  __asm__("" : "+v"(x));  // any of 32 registers
  return x;
#elif defined(__GNUC__) && defined(__SSE2__)
  __asm__("" : "+x"(x));
  return x;
#elif defined(__wasm__)
  return x;  // WebAssembly fuses them only with -mrelaxed-simd, which nothing here asks for
#else
  volatile T hidden = x;
  return hidden;
#endif
}

}  // namespace protostar::inline PROTOSTAR_ABI

// Double-double numbers, one in each lane: the operations of numeric/double_double.hpp, to the last bit.
#pragma once

#include "../numeric/double_double.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// DoubleDouble in each lane.
struct DoubleDoubles {
  Doubles hi, lo;

  explicit operator Doubles() const { return hi + lo; }
};

/// Returns x in a form that a compiler cannot look through.
[[nodiscard]] inline Doubles opaque(Doubles x) {
#if defined(PROTOSTAR_VECTORS) && defined(__AVX512F__)
  __asm__("" : "+v"(x.v));
  return x;
#elif defined(PROTOSTAR_VECTORS) && defined(__SSE2__)
  __asm__("" : "+x"(x.v));
  return x;
#else
  return of_each(x, [](double number) { return protostar::opaque(number); });
#endif
}

[[nodiscard]] inline DoubleDoubles two_sum(Doubles a, Doubles b) {
  a = opaque(a), b = opaque(b);
  const Doubles sum = a + b;
  const Doubles b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

[[nodiscard]] inline DoubleDoubles fast_two_sum(Doubles a, Doubles b) {
  a = opaque(a), b = opaque(b);
  const Doubles sum = a + b;
  return {sum, b - (sum - a)};
}

[[nodiscard]] inline DoubleDoubles two_product(Doubles a, Doubles b) {
  const Doubles product = opaque(a * b);
  return {product, fma(a, b, -product)};
}

[[nodiscard]] inline DoubleDoubles operator+(const DoubleDoubles& a, const DoubleDoubles& b) {
  const DoubleDoubles high = two_sum(a.hi, b.hi), low = two_sum(a.lo, b.lo);
  const DoubleDoubles sum = fast_two_sum(high.hi, high.lo + low.hi);
  return fast_two_sum(sum.hi, sum.lo + low.lo);
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd

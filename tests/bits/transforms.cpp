// Checks that the error-free transforms are exact however they are compiled: with products fused into sums,
// at any level of optimization, inlined, also in lanes. All numbers are whole and at most 2^124, which 128
// bits hold.

#include <cstdint>
#include <cstdio>
#include <protostar/numeric/double_double.hpp>
#include <protostar/simd/vectors.hpp>
#include <random>

using namespace protostar;
using simd::Doubles;

__extension__ using Whole = __int128;

namespace {

Whole whole(double x) { return static_cast<Whole>(x); }
Whole whole(DoubleDouble x) { return whole(x.hi) + whole(x.lo); }

/// Returns the rounded product, whatever the compiler makes of the operation. It does not know these
/// operands, so it cannot take this product for the one under test, which it would then not fuse.
double rounded_product(double a, double b) {
  const volatile double x = a, y = b, product = x * y;
  return product;
}
double rounded_sum(double a, double b) {
  const volatile double x = a, y = b, sum = x + y;
  return sum;
}

}  // namespace

int main() {
  std::mt19937_64 engine(3);
  const auto random = [&] {
    const double digits = static_cast<double>(static_cast<std::int64_t>(engine()) >> 11);
    return digits / static_cast<double>(std::uint64_t{1} << engine() % 53);  // from 1 to 53 bits
  };
  const auto random_whole = [&] { return static_cast<double>(static_cast<std::int64_t>(random())); };
  long wrong = 0;
  for (int i = 0; i < 1000000; ++i) {
    const double a = random_whole(), b = random_whole(), c = random_whole(), d = random_whole();

    const DoubleDouble sum = two_sum(a, b);
    wrong += whole(sum) != whole(a) + whole(b) || sum.hi != rounded_sum(a, b);

    const DoubleDouble product = two_product(a, b);
    wrong += whole(product) != whole(a) * whole(b) || product.hi != rounded_product(a, b);

    // The product is an argument and hence rounded: no part of it may go into the sum unrounded.
    const double ab = rounded_product(a, b), cd = rounded_product(c, d);
    const DoubleDouble one = two_sum(a * b, c), other = two_sum(c, a * b), both = two_sum(a * b, c * d);
    wrong += whole(one) != whole(ab) + whole(c) || one.hi != rounded_sum(ab, c);
    wrong += whole(other) != whole(ab) + whole(c) || other.hi != one.hi;
    wrong += whole(both) != whole(ab) + whole(cd) || both.hi != rounded_sum(ab, cd);

    const DoubleDouble fast =
        (ab < 0 ? -ab : ab) >= (c < 0 ? -c : c) ? fast_two_sum(a * b, c) : fast_two_sum(c, a * b);
    wrong += whole(fast) != whole(ab) + whole(c);

    // Each lane has numbers of its own, and so have both transforms: a product that two of them share is
    // computed and not fused.
    const auto any = [&] { return Doubles::of_each([&](int) { return random_whole(); }); };
    const Doubles p = any(), q = any(), r = any(), s = any(), t = any();
    const DoubleDoubleOf<Doubles> products = two_product(p, q), sums = two_sum(r * s, t);
    for (int k = 0; k < simd::double_lanes; ++k) {
      wrong += whole({products.hi[k], products.lo[k]}) != whole(p[k]) * whole(q[k]);
      wrong += whole({sums.hi[k], sums.lo[k]}) != whole(rounded_product(r[k], s[k])) + whole(t[k]);
    }
  }
  std::printf("%ld transforms of 1000000 cases are not exact\n", wrong);
  return wrong == 0 ? 0 : 1;
}

// Sines and polar angles of a few numbers at once, in lanes: the numbers of radians.hpp, to the last bit.
//
// A polynomial waits for each of its products, and quadrants and octants are branches that no processor
// foresees. In lanes several polynomials take the time of one, and both answers to each question are computed
// and one is taken.
#pragma once

#include <array>
#include <cstddef>

#include "../numeric/double_double.hpp"
#include "../numeric/radians.hpp"
#include "../numeric/trigonometry.hpp"
#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A few numbers, as many as the widest vectors hold; unused ones are 0.
using FewNumbers = std::array<double, 8>;
static_assert(simd::double_lanes <= 8);

namespace detail {

/// Returns the nearest whole number in each lane, the even one of two, for magnitudes below 2^50: the digits
/// after the point do not fit into the sum.
[[nodiscard]] inline simd::Doubles nearest_whole(simd::Doubles x) {
  constexpr double shift = 0x1.8p52;
  return (x + shift) - shift;
}

}  // namespace detail

/// Sine and cosine in each lane.
struct SinesCosines {
  simd::Doubles sine, cosine;
};

/// Returns sine and cosine of each angle, |angle| ≤ 7 and not −0, with the bits of sine_and_cosine.
[[nodiscard]] inline SinesCosines sine_and_cosine_of_each(simd::Doubles angle) {
  using simd::Doubles;
  const Doubles quarters = detail::nearest_whole(angle * Doubles(2 / detail::pi.hi));
  const Doubles rest = fma(-quarters, detail::pi.lo / 2, fma(-quarters, detail::pi.hi / 2, angle));
  const Doubles s = rest * rest;
  const Doubles sine = fma(rest * s, detail::polynomial(detail::sine_terms, s), rest);
  const Doubles cosine = fma(s, detail::polynomial(detail::cosine_terms, s), 1.0);
  // Whole turns taken off, the quarters are from −2 to 2.
  const Doubles left = quarters - 4.0 * detail::nearest_whole(0.25 * quarters);
  const auto is_odd = abs(left) == Doubles(1.0), is_half = abs(left) == Doubles(2.0);
  const Doubles first = select(is_odd, cosine, sine), second = select(is_odd, sine, cosine);
  return {select(is_half || left == Doubles(-1.0), -first, first),
          select(is_half || left == Doubles(1.0), -second, second)};
}

/// Returns the sines of the first `count` angles, from 0 to less than 3π/4, with the bits of
/// sine_and_cosine: at 3π/4 the number of quarter turns, 1 below, becomes 2, and the sign would change.
[[nodiscard]] inline FewNumbers sines_of_each(const FewNumbers& angles, int count) {
  using simd::Doubles;
  FewNumbers sines{};
  for (int i = 0; i < count; i += simd::double_lanes) {
    const Doubles angle = Doubles::load(&angles[static_cast<std::size_t>(i)]);
    const Doubles quarters = detail::nearest_whole(angle * Doubles(2 / detail::pi.hi));
    const Doubles rest = fma(-quarters, detail::pi.lo / 2, fma(-quarters, detail::pi.hi / 2, angle));
    const Doubles s = rest * rest;
    const Doubles sine = fma(rest * s, detail::polynomial(detail::sine_terms, s), rest);
    const Doubles cosine = fma(s, detail::polynomial(detail::cosine_terms, s), 1.0);
    select(quarters == Doubles(1.0), cosine, sine).store(&sines[static_cast<std::size_t>(i)]);
  }
  return sines;
}

/// Returns the angles of the first `count` pairs y ≥ 0 and x, with the bits of polar_angle.
[[nodiscard]] inline FewNumbers polar_angles_of_each(const FewNumbers& y, const FewNumbers& x, int count) {
  using simd::Doubles, detail::pi;
  FewNumbers angles{};
  const DoubleDouble* const table = &detail::arc_tangent_of_eighths(0);
  for (int i = 0; i < count; i += simd::double_lanes) {
    const Doubles above = Doubles::load(&y[static_cast<std::size_t>(i)]),
                  along = Doubles::load(&x[static_cast<std::size_t>(i)]);
    const auto is_steep = above > abs(along);
    const Doubles low = select(is_steep, abs(along), above), high = select(is_steep, above, abs(along));
    const Doubles ratio = low / high;
    const auto is_number = ratio <= Doubles(1.0);
    const Doubles eighths = select(is_number, detail::nearest_whole(8.0 * ratio), Doubles(0.0));
    const Doubles part = eighths / 8.0;
    const Doubles z = fma(-high, part, low) / fma(low, part, high), s = z * z;
    const Doubles series = fma(z * s, detail::polynomial(detail::arc_tangent_terms, s), z);
    const Doubles at_eighths =
        Doubles::of_each([&](int lane) { return table[static_cast<int>(eighths[lane])].hi; });
    Doubles angle = at_eighths + series;
    angle = select(is_steep, (Doubles(pi.hi / 2) - angle) + Doubles(pi.lo / 2), angle);
    angle = select(along < Doubles(0.0), (Doubles(pi.hi) - angle) + Doubles(pi.lo), angle);
    angle = select(is_number, angle, select(high == Doubles(0.0), Doubles(0.0), ratio));
    angle.store(&angles[static_cast<std::size_t>(i)]);
  }
  return angles;
}

}  // namespace protostar::inline PROTOSTAR_ABI

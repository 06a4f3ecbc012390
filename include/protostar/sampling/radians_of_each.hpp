// Sines, cosines and polar angles of a few numbers at once, in lanes: the numbers of radians.hpp, to the last
// bit.
//
// A polynomial waits for each of its products, and quadrants and octants are branches that no processor
// foresees. In lanes several polynomials take the time of one, and both answers to each question are computed
// and one is taken.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "../numeric/double_double.hpp"
#include "../numeric/radians.hpp"
#include "../numeric/trigonometry.hpp"
#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A few numbers, as many as the widest vectors hold; unused ones are 0. Or a few in each lane.
template <class T>
using Few = std::array<T, 8>;
using FewNumbers = Few<double>;
static_assert(simd::double_lanes <= 8);

namespace simd {

/// Returns the nearest whole number in each lane, the even one of two, for magnitudes below 2^50: the digits
/// after the point do not fit into the sum.
[[nodiscard]] inline Doubles nearest_whole(Doubles x) {
  constexpr double shift = 0x1.8p52;
  return (x + shift) - shift;
}

}  // namespace simd

/// Sine and cosine in each lane.
struct SinesCosines {
  simd::Doubles sine, cosine;
};

/// Returns sine and cosine of each angle, |angle| ≤ 7 and not −0, with the bits of sine_and_cosine.
[[nodiscard]] inline SinesCosines sine_and_cosine_of_each(simd::Doubles angle) {
  using simd::Doubles;
  const auto [quarters, sine, cosine] = detail::ReducedAngle(angle);
  // Whole turns taken off, the quarters are from −2 to 2.
  const Doubles remaining = quarters - 4.0 * nearest_whole(0.25 * quarters);
  const auto is_odd = abs(remaining) == Doubles(1.0), is_half = abs(remaining) == Doubles(2.0);
  const Doubles first = select(is_odd, cosine, sine), second = select(is_odd, sine, cosine);
  return {select(is_half || remaining == Doubles(-1.0), -first, first),
          select(is_half || remaining == Doubles(1.0), -second, second)};
}

/// Returns the angle in each lane of y ≥ 0 and x, with the bits of polar_angle.
[[nodiscard]] inline simd::Doubles polar_angle_of_each(simd::Doubles y, simd::Doubles x) {
  using simd::Doubles, detail::pi;
  const DoubleDouble* const table = &detail::arc_tangent_of_eighths(0);
  const auto is_steep = y > abs(x);
  const Doubles low = select(is_steep, abs(x), y), high = select(is_steep, y, abs(x));
  const Doubles ratio = low / high;
  const auto is_number = ratio <= Doubles(1.0);
  const Doubles eighths = select(is_number, nearest_whole(8.0 * ratio), Doubles(0.0));
  const Doubles series = detail::arc_tangent_beyond(Doubles(eighths / 8.0), low, high);
  const Doubles at_eighths =
      Doubles::of_each([&](int lane) { return table[static_cast<int>(eighths[lane])].hi; });
  Doubles angle = at_eighths + series;
  angle = select(is_steep, (Doubles(pi.hi / 2) - angle) + Doubles(pi.lo / 2), angle);
  angle = select(x < Doubles(0.0), (Doubles(pi.hi) - angle) + Doubles(pi.lo), angle);
  return select(is_number, angle, select(high == Doubles(0.0), low, ratio));
}

/// Returns the sines and the cosines of the first `count` angles (sine_and_cosine_of_each).
[[nodiscard]] inline std::pair<FewNumbers, FewNumbers> sines_and_cosines_of_each(const FewNumbers& angles,
                                                                                 std::size_t count) {
  FewNumbers sines{}, cosines{};
  for (std::size_t i = 0; i < count; i += simd::double_lanes) {
    const auto [sine, cosine] = sine_and_cosine_of_each(simd::Doubles::load(&angles[i]));
    sine.store(&sines[i]), cosine.store(&cosines[i]);
  }
  return {sines, cosines};
}
[[nodiscard]] inline std::pair<Few<simd::Doubles>, Few<simd::Doubles>> sines_and_cosines_of_each(
    const Few<simd::Doubles>& angles, std::size_t count) {
  Few<simd::Doubles> sines, cosines;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [sine, cosine] = sine_and_cosine_of_each(angles[i]);
    sines[i] = sine, cosines[i] = cosine;
  }
  return {sines, cosines};
}

/// Returns polar_angle_of_each of the first `count` pairs.
[[nodiscard]] inline FewNumbers polar_angles_of_each(const FewNumbers& y, const FewNumbers& x,
                                                     std::size_t count) {
  FewNumbers angles{};
  for (std::size_t i = 0; i < count; i += simd::double_lanes)
    polar_angle_of_each(simd::Doubles::load(&y[i]), simd::Doubles::load(&x[i])).store(&angles[i]);
  return angles;
}
[[nodiscard]] inline Few<simd::Doubles> polar_angles_of_each(const Few<simd::Doubles>& y,
                                                             const Few<simd::Doubles>& x, std::size_t count) {
  Few<simd::Doubles> angles;
  for (std::size_t i = 0; i < count; ++i) angles[i] = polar_angle_of_each(y[i], x[i]);
  return angles;
}

}  // namespace protostar::inline PROTOSTAR_ABI

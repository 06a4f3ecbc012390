// From linear light to the whole numbers that a file holds (§2.3.2: gamma).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <variant>
#include <vector>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The piecewise curve of sRGB (IEC 61966-2-1): 12.92 x up to 0.0031308, then 1.055 x^(1/2.4) − 0.055.
struct Srgb {};

/// Light as it is.
struct Linear {};

/// x^(1/exponent); the tutorial's is 2.2. The exponent is finite and greater than 0.
struct Gamma {
  double exponent = 2.2;
};

/// How linear light becomes the numbers in a file.
using Transfer = std::variant<Srgb, Linear, Gamma>;

namespace detail {

/// What a transfer encodes as one value in [0, 1]: light with light^root = (p/q)^power, all four exact.
struct DecodedLight {
  double p, q;
  double power = 1, root = 1;

  /// With a relative error below 2^-56 where it is between 2^-150 and 1; less than that is too little as well.
  explicit operator DoubleDouble() const {
    const DoubleDouble quotient = DoubleDouble(p) / q;
    return power == root ? quotient : pow(quotient, DoubleDouble(power) / root);
  }

  /// Exactly. Only powers of two can be equal; see Encoder.
  [[nodiscard]] bool exceeds(float light) const {
    return power_exceeds(p, q, power, static_cast<double>(light), root);
  }
};

// What the transfers encode as n/d. The constants of sRGB are decimal, so they go into p and q as fractions.
[[nodiscard]] inline DecodedLight decoded(Srgb, double n, double d) {
  if (n * 1e9 <= d * 40449936) return {.p = 25 * n, .q = 323 * d};  // n/d ≤ 12.92 · 0.0031308
  return {.p = 1000 * n + 55 * d, .q = 1055 * d, .power = 12, .root = 5};
}
[[nodiscard]] inline DecodedLight decoded(Linear, double n, double d) { return {.p = n, .q = d}; }
[[nodiscard]] inline DecodedLight decoded(Gamma gamma, double n, double d) {
  return {.p = n, .q = d, .power = gamma.exponent};
}

}  // namespace detail

/// Encodes light in whole codes from 0 to max_code: max_code · transfer(light), rounded to the nearest. Less
/// than 0 and NaN give 0, more than 1 gives max_code. This is exact, for every float.
///
/// No curve is evaluated per value. Code k begins at light threshold(k), the smallest float whose encoded
/// value is k − ½ or more, and the code of a value is the number of thresholds up to it. They are in a sorted
/// table, entered through the leading bits of the float, which leave no more than one threshold of most 8-bit
/// transfers to compare with.
class Encoder {
 public:
  /// max_code is 255 or 65535. Throws std::invalid_argument for a gamma that is not finite and greater than
  /// 0.
  Encoder(const Transfer& transfer, int max_code) : max_code_(static_cast<std::uint16_t>(max_code)) {
    if (const auto* gamma = std::get_if<Gamma>(&transfer))
      if (!(gamma->exponent > 0 && std::isfinite(gamma->exponent)))
        throw std::invalid_argument("Gamma: exponent must be finite and greater than 0");
    thresholds_.reserve(max_code_);
    for (int code = 1; code <= max_code; ++code)
      thresholds_.push_back(smallest_float_from(std::visit(
          [&](auto curve) { return detail::decoded(curve, 2 * code - 1, 2 * max_code); }, transfer)));
    make_bins();
  }

  [[nodiscard]] std::uint16_t operator()(float light) const {
    const float x = light > darkest_ ? (light < 1 ? light : 1) : darkest_;  // NaN is dark
    std::size_t code = bin_codes_[bin_of(x) - first_bin_];
    // The thresholds behind those of the bin are greater than x, so that a search may take them in.
    for (std::size_t step = first_step_; step > 0; step /= 2)
      code += thresholds_[code + step - 1] <= x ? step : 0;
    return static_cast<std::uint16_t>(code);
  }

  [[nodiscard]] std::uint16_t max_code() const { return max_code_; }

  /// The smallest float that is encoded as this code, of 1 to max_code, or more.
  [[nodiscard]] float threshold(int code) const { return thresholds_[static_cast<std::size_t>(code) - 1]; }

 private:
  // The bits of floats above 0 are in the order of the floats. A bin is all that share the first 16: a sign,
  // eight bits of exponent and seven of the fraction, so that it spans less than 1/128 of its lower end.
  static std::size_t bin_of(float light) { return std::bit_cast<std::uint32_t>(light) >> 16; }
  static float lower_end(std::size_t bin) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bin) << 16);
  }

  /// The smallest float in (0, 1] that is not less than light, which is less than 1.
  ///
  /// Light is a float itself for the value ½ alone, and then a power of two: of other values the denominator
  /// is not one, since max_code is odd, and so light^(root · m) is not a fraction of that kind for any whole m,
  /// which it would have to be for a float and an exponent that is a double (a whole number times a power of
  /// two).
  static float smallest_float_from(const detail::DecodedLight& light) {
    const DoubleDouble approximate(light);
    const DoubleDouble error = approximate * 0x1p-56;
    const float low = smallest_float_from(approximate - error), high = smallest_float_from(approximate + error);
    return low == high || light.exceeds(low) ? high : low;
  }
  static float smallest_float_from(DoubleDouble x) {
    constexpr float smallest = std::numeric_limits<float>::denorm_min();
    if (!(x.hi > static_cast<double>(smallest))) return smallest;
    if (x.hi >= 1) return 1;
    const float nearest = static_cast<float>(x.hi);
    return (DoubleDouble(static_cast<double>(nearest)) - x).sign() < 0 ? std::nextafter(nearest, 2.0f) : nearest;
  }

  void make_bins() {
    darkest_ = std::nextafter(thresholds_.front(), 0.0f);
    first_bin_ = bin_of(darkest_);
    darkest_ = lower_end(first_bin_);
    // How many thresholds are up to the lower end of each bin: the search begins there.
    std::size_t most = 0;
    for (std::size_t bin = first_bin_; bin <= bin_of(1.0f); ++bin) {
    }
  }

  std::uint16_t max_code_;
  std::vector<float> thresholds_;
  float darkest_;
  std::size_t first_bin_;
  std::size_t first_step_;
  std::vector<std::uint16_t> bin_codes_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

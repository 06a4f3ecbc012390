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

/// The linear light in [0, 1] that a transfer encodes as the given value in [0, 1].
[[nodiscard]] inline double decode(Srgb, double value) {
  return value <= 12.92 * 0.0031308 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}
[[nodiscard]] inline double decode(Linear, double value) { return value; }
[[nodiscard]] inline double decode(Gamma gamma, double value) { return std::pow(value, gamma.exponent); }

/// Encodes light in whole codes from 0 to max_code: max_code · transfer(light), rounded to the nearest. Less
/// than 0 and NaN give 0, more than 1 gives max_code.
///
/// No curve is evaluated per value. Code k begins at light threshold(k), the smallest float whose encoded
/// value is k − ½ or more, and the code of a value is the number of thresholds up to it. They are in a sorted
/// table, entered through the leading bits of the float, which leave an 8-bit search one or two thresholds.
class Encoder {
 public:
  /// max_code is 255 or 65535. Throws std::invalid_argument for a gamma that is not finite and greater than
  /// 0.
  Encoder(const Transfer& transfer, int max_code) : max_code_(static_cast<std::uint16_t>(max_code)) {
    if (const auto* gamma = std::get_if<Gamma>(&transfer))
      if (!(gamma->exponent > 0 && std::isfinite(gamma->exponent)))
        throw std::invalid_argument("Gamma: exponent must be finite and greater than 0");
    thresholds_.reserve(max_code_);
    for (int code = 1; code <= max_code; ++code) {
      const double value = (code - 0.5) / max_code;
      thresholds_.push_back(
          float_from(std::visit([&](auto curve) { return decode(curve, value); }, transfer)));
    }
    first_bin_ = bin_of(thresholds_.front());
    const std::size_t bins = bin_of(thresholds_.back()) - first_bin_ + 1;
    for (std::size_t bin = 0; bin <= bins; ++bin)
      bin_codes_.push_back(codes_below(lower_end(first_bin_ + bin)));
  }

  [[nodiscard]] std::uint16_t operator()(float light) const {
    if (!(light >= thresholds_.front())) return 0;
    if (light >= thresholds_.back()) return max_code_;
    const std::size_t bin = bin_of(light) - first_bin_;
    const auto begin = thresholds_.begin() + bin_codes_[bin], end = thresholds_.begin() + bin_codes_[bin + 1];
    return static_cast<std::uint16_t>(std::upper_bound(begin, end, light) - thresholds_.begin());
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

  /// The smallest float that is greater than 0 and not less than a number.
  static float float_from(double x) {
    constexpr float smallest = std::numeric_limits<float>::denorm_min();
    if (!(x > static_cast<double>(smallest))) return smallest;
    const float nearest = static_cast<float>(x);
    return static_cast<double>(nearest) < x ? std::nextafter(nearest, 2.0f) : nearest;
  }

  /// How many thresholds are less than a value: where the search of the bin that begins there has to start.
  [[nodiscard]] std::uint16_t codes_below(float light) const {
    return static_cast<std::uint16_t>(std::lower_bound(thresholds_.begin(), thresholds_.end(), light) -
                                      thresholds_.begin());
  }

  std::uint16_t max_code_;
  std::vector<float> thresholds_;
  std::size_t first_bin_;
  std::vector<std::uint16_t> bin_codes_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

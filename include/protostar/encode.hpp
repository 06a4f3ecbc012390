// Encoding of linear light as the whole numbers that a file holds (§2.3.2: gamma).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <variant>

#include "bit_cast.hpp"
#include "numeric/power.hpp"
#include "plain_vector.hpp"
#include "shown.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Piecewise curve of sRGB (IEC 61966-2-1): 12.92 x up to 0.0031308, then 1.055 x^(1/2.4) − 0.055.
struct Srgb {};

/// Identity: codes proportional to light.
struct Linear {};

/// Power curve x^(1/exponent); the tutorial's exponent is 2.2. The exponent is finite and greater than 0.
struct Gamma {
  double exponent = 2.2;
};

/// Transfer curve from linear light to the numbers in a file.
using Transfer = std::variant<Srgb, Linear, Gamma>;

namespace detail {

/// Throws std::invalid_argument, which names the caller, if a transfer is a gamma that is not finite and
/// greater than 0.
inline void require_exponent(const std::string& caller, const Transfer& transfer) {
  if (const auto* gamma = std::get_if<Gamma>(&transfer);
      gamma && !(gamma->exponent > 0 && std::isfinite(gamma->exponent)))
    throw std::invalid_argument(caller + ": gamma must be finite and greater than 0; it is " +
                                shown(gamma->exponent));
}

}  // namespace detail

/// Light that a transfer encodes as one value in [0, 1]: the number whose root-th power is (p/q)^power, all
/// of them exact.
struct DecodedLight {
  double p, q;
  double power = 1, root = 1;

  /// Returns the light with a relative error below 2^-57; 2^-150 and less may be given as anything down to 0.
  explicit operator DoubleDouble() const {
    const DoubleDouble fraction = quotient(p, q);
    return p == 0 || power == root ? fraction : pow(fraction, quotient(power, root));
  }

  /// Returns true if this exceeds `light`, decided exactly; see power_exceeds for when they may be equal.
  [[nodiscard]] bool operator>(float light) const {
    return power_exceeds(p, q, power, static_cast<double>(light), root);
  }
};

/// Returns the linear light that a transfer encodes as n/d, exact for whole n and d up to 2^18. The constants
/// of sRGB are decimals, which double does not hold, so they enter as fractions.
[[nodiscard]] inline DecodedLight decode(Srgb, double n, double d) {
  if (n * 1e9 <= d * 40449936) return {.p = 25 * n, .q = 323 * d};  // n/d ≤ 12.92 · 0.0031308
  return {.p = 200 * n + 11 * d, .q = 211 * d, .power = 12, .root = 5};
}
[[nodiscard]] inline DecodedLight decode(Linear, double n, double d) { return {.p = n, .q = d}; }
[[nodiscard]] inline DecodedLight decode(Gamma gamma, double n, double d) {
  return {.p = n, .q = d, .power = gamma.exponent};
}

[[nodiscard]] inline DecodedLight decode(const Transfer& transfer, double n, double d) {
  if (const auto* gamma = std::get_if<Gamma>(&transfer)) return decode(*gamma, n, d);
  return std::holds_alternative<Srgb>(transfer) ? decode(Srgb{}, n, d) : decode(Linear{}, n, d);
}

/// Returns the linear light in [0, 1] that a transfer encodes as the given value in [0, 1].
template <class Curve>
[[nodiscard]] double decode(Curve curve, double value) {
  return static_cast<double>(DoubleDouble(decode(curve, value, 1)));
}

/// Encoder of light as whole codes from 0 to max_code: max_code · transfer(light), rounded to the nearest,
/// exactly so for every float. Light below 0 and NaN give 0, light above 1 gives max_code.
///
/// No curve is evaluated per value. Code k begins at light threshold(k), the smallest float whose encoded
/// value is k − ½ or more, and the code of a value is the number of thresholds up to it. The leading bits of
/// the float select a bin, which holds the number of thresholds below it and the first one inside it. For
/// 8-bit sRGB no bin has another; in a bin with several, they are searched.
class Encoder {
 public:
  /// Computes the thresholds for a max_code of 255, 65535, or another odd number from 1 to 65535. Throws
  /// std::invalid_argument for any other, and for a gamma that is not finite and greater than 0.
  Encoder(const Transfer& transfer, int max_code) {
    if (max_code < 1 || max_code > 65535 || max_code % 2 == 0)  // see smallest_float_from
      throw std::invalid_argument("Encoder: max_code must be an odd number from 1 to 65535");
    detail::require_exponent("Encoder", transfer);
    for (int code = 1; code <= max_code; ++code)
      thresholds_.push_back(smallest_float_from(decode(transfer, 2 * code - 1, 2 * max_code)));

    darkest_ = std::nextafter(thresholds_[0], 0.0f);
    first_bin_ = bin_of(darkest_);
    bins_.resize(bin_of(1) - first_bin_ + 1);
    for (std::size_t i = 0, k = 0; k < bins_.size(); ++k) {
      const std::size_t begin = i;
      while (i < thresholds_.size() && bin_of(thresholds_[i]) == first_bin_ + k) ++i;
      bins_[k] = {.first = begin < i ? thresholds_[begin] : std::numeric_limits<float>::infinity(),
                  .below = static_cast<std::uint16_t>(begin),
                  .inside = static_cast<std::uint16_t>(i - begin)};
      is_searched_ |= i - begin > 1;
    }
  }

  [[nodiscard]] std::uint16_t operator()(float light) const {
    const float x = bounded(light);
    const Bin& bin = bins_[bin_of(x) - first_bin_];
    return bin.inside > 1 ? searched(bin, x) : bin.code(x);
  }

  /// Returns the codes of red, green and blue.
  [[nodiscard]] std::array<std::uint16_t, 3> operator()(const Color& light) const {
    return {(*this)(light.r), (*this)(light.g), (*this)(light.b)};
  }

  /// Writes the codes of `count` colors to `codes`, three for each: red, green and blue. The loop has no test
  /// for bins with several thresholds if there are none.
  void operator()(const Color* light, int count, std::uint16_t* codes) const {
    const auto write = [&](const auto& code) {
      for (int i = 0; i < count; ++i, codes += 3)
        codes[0] = code(light[i].r), codes[1] = code(light[i].g), codes[2] = code(light[i].b);
    };
    if (is_searched_) return write(*this);
    const Bin* const bins = bins_.data();
    write([&, first = first_bin_](float value) {
      const float x = bounded(value);
      return bins[bin_of(x) - first].code(x);
    });
  }

  [[nodiscard]] std::uint16_t max_code() const { return static_cast<std::uint16_t>(thresholds_.size()); }

  /// Returns the smallest float whose code is at least this one, which is from 1 to max_code.
  [[nodiscard]] float threshold(int code) const { return thresholds_[static_cast<std::size_t>(code) - 1]; }

 private:
  /// Floats that share the first 16 bits: a sign, eight bits of exponent and seven of the fraction, so that
  /// they span less than 1/128 of the least. The bits of floats from 0 on are in the order of the floats.
  struct Bin {
    float first;           ///< first threshold inside the bin; infinity if there is none
    std::uint16_t below;   ///< number of thresholds below the bin
    std::uint16_t inside;  ///< number of thresholds inside the bin

    /// Returns the code of a float in a bin with at most one threshold.
    [[nodiscard]] std::uint16_t code(float light) const {
      return static_cast<std::uint16_t>(below + (first <= light));
    }
  };
  [[nodiscard]] float bounded(float light) const {  // darkest for NaN
    return std::min(std::max(darkest_, light), brightest_);
  }
  static std::size_t bin_of(float light) { return detail::bit_cast<std::uint32_t>(light) >> 16; }

  /// Returns the code of a float in a bin by bisection, with conditional additions: a branch would be
  /// mispredicted half of the time.
  [[nodiscard]] std::uint16_t searched(const Bin& bin, float light) const {
    std::size_t begin = bin.below;
    for (std::size_t remaining = bin.inside; remaining > 0; remaining /= 2) {
      const std::size_t half = (remaining + 1) / 2;
      begin += thresholds_[begin + half - 1] <= light ? half : 0;
    }
    return static_cast<std::uint16_t>(begin);
  }

  /// Returns the smallest float in (0, 1] that is not less than the light at the lower end of a code, which
  /// is less than 1.
  ///
  /// The exact comparison ends, as its sides do not coincide unless p/q is a power of two. If the light at
  /// (2k − 1)/(2 max_code) is a float, then p/q is a fraction whose denominator is a power of two, since a
  /// power of it is. As max_code is odd, Linear and Gamma have that at ½ alone, where p/q is a power of two.
  /// sRGB has it nowhere: if p/q = m/2^e, then n/d = 323 m/(25 · 2^e) or (211 m − 11 · 2^e)/(25 · 2^(e+3)),
  /// and neither is a fraction below 1 that has in lowest terms exactly one factor 2 in its denominator, as
  /// (2k − 1)/(2 max_code) has.
  static float smallest_float_from(const DecodedLight& light) {
    const DoubleDouble about(light);
    // NaN comes from an exponent near the largest double, and stands for a power far below the least float.
    if (!(about.hi > 0x1p-150)) return std::numeric_limits<float>::denorm_min();
    const float nearest = static_cast<float>(about.hi);
    if (nearest == 1) return nearest;
    const double excess = (about.hi - static_cast<double>(nearest)) + about.lo;
    const bool is_less = std::abs(excess) > 0x1p-57 * about.hi ? excess > 0 : light > nearest;
    return is_less ? std::nextafter(nearest, 1.0f) : nearest;
  }

  // Not constants, since g++ turns the minimum and maximum with known values into branches, which light
  // mispredicts.
  float darkest_ = 0, brightest_ = 1;  ///< the largest float whose code is 0; light above 1 is as 1
  std::size_t first_bin_ = 0;          ///< that of darkest_
  bool is_searched_ = false;           ///< true if a bin has several thresholds
  PlainVector<float> thresholds_;      ///< thresholds of the codes from 1 on
  PlainVector<Bin> bins_;              ///< bins from first_bin_ up to the one of light 1
};

}  // namespace protostar::inline PROTOSTAR_ABI

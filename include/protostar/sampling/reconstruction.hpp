// Reconstruction filters: how much the light at a place counts for the pixels around it.
//
// A pixel's color is the mean of the light around its center, weighted by a filter. The filter is used by
// importance: places are drawn as often as the filter weighs them, so that all have weights of equal size. A
// pixel depends on its own samples only. (The other way is to add each sample to all pixels near it.)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

#include "../numeric/double_double.hpp"
#include "../numeric/power.hpp"
#include "../numeric/trigonometry.hpp"
#include "../plain_vector.hpp"
#include "../platform.hpp"
#include "../shown.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Place of a sample, in pixels from the pixel's upper left corner, so that (½, ½) is its center; and the
/// factor of its light. Numbers are doubles, or a double in each lane.
template <class Number>
struct FilteredPlace {
  Number x, y;
  Number weight;
};

/// Filter f(x) f(y), for distances x and y from the pixel's center.
///
/// The function f is a polygon through points of the curve that the name says; 256 pieces differ from a curve
/// of the usual proportions by less than 2 · 10^-4 of its height, and by more from one that is narrow in a
/// wide filter. A polygon can be drawn from exactly: the place for a number u is where the area under |f| up
/// to it is u of the whole area.
///
/// The mean of light is ∫ f light / ∫ f. With places drawn by |f|, it is the mean of
///   sign(f) · (∫ |f| / ∫ f) · light.
/// For filters without negative values the weight is 1, and a constant picture stays as it is, exactly. For
/// mitchell, which has negative values, weights are ±1.145 for the plane; they are 1 on average, and a
/// constant picture stays so on average. Dividing by the sum of the weights instead would make it exact, and
/// everything else biased.
class ReconstructionFilter {
 public:
  /// Makes the filter of box(): each place of the pixel counts alike. It has no polygon, as the place for
  /// numbers (u, v) is (u, v).
  ReconstructionFilter() = default;

  /// Returns the filter that weighs all places alike within a width. The default is the pixel itself, and the
  /// place for numbers (u, v) is (u, v).
  [[nodiscard]] static ReconstructionFilter box(double width = 1) {
    require_length("width of box", width);
    return {width / 2, {-width / 2, width / 2}, {1}, [](double) { return 1.0; }};
  }

  /// Returns the filter that falls linearly from the center to 0 at a radius.
  [[nodiscard]] static ReconstructionFilter tent(double radius = 1) {
    require_length("radius of tent", radius);
    return {radius, {-radius, 0, radius}, {1, 1}, [=](double x) { return 1 - x / radius; }};
  }

  /// Returns the filter e^(−x²/(2 deviation²)), less its value at a radius, where it ends.
  [[nodiscard]] static ReconstructionFilter gaussian(double radius = 1.5, double deviation = 0.5) {
    require_length("radius of gaussian", radius);
    require_length("deviation of gaussian", deviation);
    const auto bell = [=](double x) {
      const double ratio = std::min(x / deviation, 0x1p500);  // of which the square is finite
      return static_cast<double>(exp2(DoubleDouble(-ratio * ratio / 2) * detail::log2_e));
    };
    return {radius, {-radius, radius}, {256}, [=](double x) { return bell(x) - bell(radius); }};
  }

  /// Returns the filter of Mitchell and Netravali (1988) with B = C = 1/3: for z = 2x/radius,
  ///   (7z³ − 12z² + 16/3)/6 up to 1,   (8/7 − z)(2 − z)² · 7/18 up to 2.
  /// It is negative from z = 8/7 on, which sharpens edges.
  [[nodiscard]] static ReconstructionFilter mitchell(double radius = 2) {
    require_length("radius of mitchell", radius);
    const double crossing = radius * 4 / 7;
    return {radius, {-radius, -crossing, crossing, radius}, {48, 160, 48}, [=](double x) {
              const double z = 2 * x / radius;
              if (z < 1) return ((7 * z - 12) * z * z + 16 / 3.0) / 6;
              return (8 - 7 * z) * (2 - z) * (2 - z) / 18;
            }};
  }

  /// Returns the window of Blackman and Harris (1978) with four terms, which shows hardly any moiré:
  ///   0.35875 + 0.48829 cos(πx/radius) + 0.14128 cos(2πx/radius) + 0.01168 cos(3πx/radius).
  [[nodiscard]] static ReconstructionFilter blackman_harris(double radius = 1.5) {
    require_length("radius of blackman-harris", radius);
    return {radius, {-radius, radius}, {256}, [=](double x) {
              const double degrees = 180 * (x / radius);
              return 0.35875 + 0.48829 * cosine_of_degrees(degrees) +
                     0.14128 * cosine_of_degrees(2 * degrees) + 0.01168 * cosine_of_degrees(3 * degrees);
            }};
  }

  /// Names of filters, as the option --filter has them.
  static constexpr std::array<std::string_view, 5> names = {"box", "tent", "gaussian", "mitchell",
                                                            "blackman-harris"};

  /// Returns the filter with a name, with its usual size. Throws std::invalid_argument for another name.
  [[nodiscard, gnu::cold]] static ReconstructionFilter named(std::string_view name) {
    if (name == names[0]) return box();
    if (name == names[1]) return tent();
    if (name == names[2]) return gaussian();
    if (name == names[3]) return mitchell();
    if (name == names[4]) return blackman_harris();
    throw std::invalid_argument("filter must be box, tent, gaussian, mitchell or blackman-harris; it is " +
                                std::string(name));
  }

  /// Returns the largest distance of a place from the center, along x or y.
  [[nodiscard]] double radius() const { return radius_; }

  /// Returns true if weights may differ from 1.
  [[nodiscard]] bool has_weights() const { return has_weights_; }

  /// Returns the place for two numbers between 0 and 1. Each coordinate grows with its number, so that
  /// numbers that are spread evenly give places that are.
  template <class Number>
  [[nodiscard]] FilteredPlace<Number> operator()(Number u, Number v) const {
    if (pieces_.empty()) return {u, v, Number(1.0)};
    if (pieces_.size() == 1) return {place_on(pieces_[0], u), place_on(pieces_[0], v), Number(1.0)};
    const auto place = [&](Number number) {
      return of_each(number, [&](double one) { return place_on(piece_of(one), one); });
    };
    const auto weight = [&](Number number) {
      return of_each(number, [&](double one) { return piece_of(one).weight; });
    };
    return {place(u), place(v), has_weights_ ? weight(u) * weight(v) : Number(1.0)};
  }

 private:
  static constexpr int parts = 256;  ///< of the interval of numbers, for which the first piece is known

  /// Part of the polygon |f| between two points.
  struct Piece {
    double left, width;          ///< left is in pixels from the pixel's left edge
    double height, twice_slope;  ///< height at the left end
    double area_before;
    double weight;
  };

  /// Makes the polygon through points of a curve: some parts of equal width between any two of several
  /// places, where the curve's sign may change. The curve is asked for x ≥ 0, and is the same for −x.
  [[gnu::cold]] ReconstructionFilter(double radius, std::initializer_list<double> places,
                                     std::initializer_list<int> counts, const auto& curve)
      : radius_(radius) {
    double signed_area = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double from = places.begin()[i], to = places.begin()[i + 1];
      const int count = counts.begin()[i];
      const auto at = [&](int k) { return k == count ? to : from + (to - from) * k / count; };
      for (int k = 0; k < count; ++k) {
        const double left = at(k), width = at(k + 1) - left;
        const double sign = curve(std::abs(left + width / 2)) < 0 ? -1 : 1;
        const double a = std::max(0.0, sign * curve(std::abs(left)));
        const double b = std::max(0.0, sign * curve(std::abs(left + width)));
        pieces_.push_back({0.5 + left, width, a, 2 * (b - a) / width, area_, sign});
        area_ += (a + b) / 2 * width;
        signed_area += sign * ((a + b) / 2 * width);
      }
    }
    has_weights_ = area_ != signed_area;
    for (Piece& piece : pieces_) piece.weight *= area_ / signed_area;
    std::size_t piece = 0;
    for (std::size_t part = 0; part < parts; ++part) {
      const double before = static_cast<double>(part) / parts * area_;
      while (piece + 1 < pieces_.size() && pieces_[piece + 1].area_before <= before) ++piece;
      first_pieces_[part] = static_cast<std::uint16_t>(piece);
    }
  }

  [[gnu::cold]] static void require_length(const char* name, double length) {
    if (length > 0 && length <= 100) return;
    throw std::invalid_argument(std::string("ReconstructionFilter: the ") + name +
                                " must be greater than 0 and at most 100 pixels; it is " + shown(length));
  }

  /// Returns the piece in which the area up to it is u of the whole: from the first piece of u's 256th part
  /// on.
  [[nodiscard]] const Piece& piece_of(double u) const {
    std::size_t piece = first_pieces_[static_cast<std::size_t>(u * parts)];
    while (piece + 1 < pieces_.size() && pieces_[piece + 1].area_before <= u * area_) ++piece;
    return pieces_[piece];
  }

  /// Returns the place on a piece up to which the area is u of the whole. With s for the area that is left
  /// for the piece, height · y + slope · y²/2 = s, of which the root is
  ///   y = 2s / (height + √(height² + 2 slope · s)).
  /// For a box of width 1 this is 2u/(1 + 1) = u exactly.
  template <class Number>
  [[nodiscard]] Number place_on(const Piece& piece, Number u) const {
    using std::sqrt, std::max, std::min;
    const Number s = max(u * area_ - piece.area_before, Number(0x1p-1000));  // not 0, nor 0/0 below
    const Number root = sqrt(max(piece.height * piece.height + piece.twice_slope * s, Number(0.0)));
    return piece.left + min(2 * s / (piece.height + root), Number(piece.width));
  }

  double radius_ = 0.5, area_ = 0;  ///< area_ is that under |f|
  bool has_weights_ = false;        ///< other weights than 1
  PlainVector<Piece> pieces_;
  std::uint16_t first_pieces_[parts]{};
};

}  // namespace protostar::inline PROTOSTAR_ABI

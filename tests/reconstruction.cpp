#include <protostar/sampling/disk_view.hpp>
#include <protostar/sampling/reconstruction.hpp>
#include <protostar/sampling/sobol_sampler.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// A filter and its curve, as functions of the C library give it; and the places and numbers of pieces
/// between them of which its polygon is made.
struct Row {
  std::string name;
  double radius;
  std::function<double(double)> curve;
  std::vector<double> places;
  std::vector<int> counts;
};

std::vector<Row> filters() {
  return {
      {"box", 0.5, [](double) { return 1.0; }, {-0.5, 0.5}, {1}},
      {"tent", 1, [](double x) { return 1 - std::abs(x); }, {-1, 0, 1}, {1, 1}},
      {"gaussian", 1.5, [](double x) { return std::exp(-2 * x * x) - std::exp(-4.5); }, {-1.5, 1.5}, {256}},
      {"mitchell",
       2,
       [](double x) {
         // The cubics of the paper.
         const double b = 1 / 3.0, c = 1 / 3.0, z = std::abs(x);
         if (z < 1)
           return ((12 - 9 * b - 6 * c) * z * z * z + (-18 + 12 * b + 6 * c) * z * z + 6 - 2 * b) / 6;
         return ((-b - 6 * c) * z * z * z + (6 * b + 30 * c) * z * z + (-12 * b - 48 * c) * z + 8 * b +
                 24 * c) /
                6;
       },
       {-2, -8 / 7.0, 8 / 7.0, 2},
       {48, 160, 48}},
      {"blackman-harris",
       1.5,
       [](double x) {
         const double angle = 2 * std::numbers::pi * (x / 3 + 0.5);
         return 0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) -
                0.01168 * std::cos(3 * angle);
       },
       {-1.5, 1.5},
       {256}}};
}

/// The polygon through points of a filter's curve.
class Polygon {
 public:
  explicit Polygon(const Row& row) {
    for (std::size_t i = 0; i < row.counts.size(); ++i)
      for (int k = 0; k < row.counts[i]; ++k)
        add(row, row.places[i] + (row.places[i + 1] - row.places[i]) * k / row.counts[i]);
    add(row, row.places.back());
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
      const double part = (y_[i] + y_[i + 1]) / 2 * (x_[i + 1] - x_[i]);
      area_.push_back(area_.back() + std::abs(part)), signed_area_ += part;
    }
  }

  [[nodiscard]] double operator()(double x) const {
    const std::size_t i = piece_at(x);
    return y_[i] + (y_[i + 1] - y_[i]) * (x - x_[i]) / (x_[i + 1] - x_[i]);
  }

  /// Returns the area between the polygon and the axis up to a place.
  [[nodiscard]] double area_up_to(double x) const {
    const std::size_t i = piece_at(x);
    return area_[i] + std::abs((y_[i] + (*this)(x)) / 2 * (x - x_[i]));
  }

  [[nodiscard]] double area() const { return area_.back(); }

  /// Returns the area between the polygon and the axis over that where areas below the axis count negative.
  [[nodiscard]] double weight() const { return area() / signed_area_; }

  /// Returns the mean of a smooth function, weighted by the polygon.
  [[nodiscard]] double mean(const auto& f) const {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < x_.size(); ++i)
      sum += detail::gauss_legendre([&](double x) { return (*this)(x)*f(x); }, x_[i], x_[i + 1] - x_[i]);
    return sum / signed_area_;
  }

 private:
  void add(const Row& row, double x) {
    // Values of curves are rounded by at most 60u; at places where they are 0, too.
    const bool is_0 = std::abs(row.curve(x)) <= 60 * 0x1p-53;
    x_.push_back(x), y_.push_back(is_0 ? 0 : row.curve(x));
  }

  [[nodiscard]] std::size_t piece_at(double x) const {
    const auto next = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
    return static_cast<std::size_t>(next - x_.begin()) - 1;
  }

  std::vector<double> x_, y_, area_{0};
  double signed_area_ = 0;
};

/// Sums of independent numbers. The mean of 16 is more than 8 standard errors off in one of 10^6 cases
/// (Student's t with 15 degrees of freedom).
struct Sums {
  double sum = 0, squares = 0;
  int count = 0;

  void add(double x) { sum += x, squares += x * x, ++count; }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double standard_error() const {
    return std::sqrt(std::max(squares / count - mean() * mean(), 0.0) / (count - 1));
  }
};

// With u = 2^-53, sums of 256 areas are off by 256u of the whole: for a filter and for its polygon here.
constexpr double sums_error = 2 * 256 * 0x1p-53;

}  // namespace

TEST_CASE("the box of the pixel gives its numbers as they are") {
  const ReconstructionFilter filter;
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const double u = i == 0   ? 0x1p-33
                     : i == 1 ? 1 - 0x1p-33
                              : std::exp2(-random.real(0, 40)),
                 v = random.real(0, 1);
    const auto place = filter(u, v);
    CHECK(place.x == u);
    CHECK(place.y == v);
    CHECK(place.weight == 1);
    const auto lanes = filter(simd::Doubles(u), simd::Doubles(v));
    CHECK(lanes.x[0] == u);
    CHECK(lanes.weight[0] == 1);
  }
}

TEST_CASE("places are within the filter's radius, grow with their numbers, and have weights of one size") {
  for (const Row& row : filters()) {
    CAPTURE(row.name);
    const auto filter = ReconstructionFilter::named(row.name);
    CHECK(filter.radius() == row.radius);
    double before = 0.5 - row.radius;
    WrongCases wrong;
    for (int i = 0; i <= 20000; ++i) {
      const double u = std::clamp(i / 20000.0, 0x1p-33, 1 - 0x1p-33);
      const auto place = filter(u, 0.5);
      wrong.add(!(before <= place.x && place.x <= 0.5 + row.radius), u, place.x);
      // Half of the area, which is at most 1.3 of the height there.
      wrong.add(std::abs(place.y - 0.5) > 1.3 * sums_error, u, place.y);
      // The crossing of 8/7 is off by 5u.
      const double beyond = std::abs(place.x - 0.5) - 8 / 7.0;
      if (row.name != "mitchell")
        wrong.add(place.weight != 1, u);
      else if (std::abs(beyond) > 5 * 0x1p-53)
        wrong.add((place.weight < 0) != (beyond > 0), u, place.x);
      before = place.x;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a filter is a polygon, which differs from its curve by less than 2e-4 of its height") {
  for (const Row& row : filters()) {
    CAPTURE(row.name);
    const Polygon polygon(row);
    double most = 0;
    for (int i = 0; i <= 20000; ++i) {
      const double x = row.radius * (i / 10000.0 - 1);
      most = std::max(most, std::abs(polygon(x) - row.curve(x)) / row.curve(0));
    }
    CHECK(most < 2e-4);
  }
}

TEST_CASE("the area of a filter up to a place is the number's share, and weights are of one mean") {
  for (const Row& row : filters()) {
    CAPTURE(row.name);
    const auto filter = ReconstructionFilter::named(row.name);
    const Polygon polygon(row);
    Random random(3);
    WrongCases wrong(random);
    for (int i = 0; i < 20000; ++i) {
      const double u = random.interior(), v = random.interior();
      const auto place = filter(u, v);
      // Values of curves are off by 4u, of polynomials with terms that cancel by 60u of their height, which
      // is at most the area; a place by 6u of 2, and its area by 4u of itself.
      const double most = (sums_error + (60 + 12 + 4) * 0x1p-53) * polygon.area();
      wrong.add(!(std::abs(polygon.area_up_to(place.x - 0.5) - u * polygon.area()) <= most), u, place.x);
      wrong.add(!(std::abs(polygon.area_up_to(place.y - 0.5) - v * polygon.area()) <= most), v, place.y);
      // Two sums each for the factors of x and of y.
      const double weight = polygon.weight() * polygon.weight();
      wrong.add(!(std::abs(std::abs(place.weight) - weight) <= (4 * sums_error + 240 * 0x1p-53) * weight), u,
                v, place.weight);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("filters of other sizes are the usual ones, stretched") {
  CHECK(ReconstructionFilter::box(3)(0.25, 0.5).x == 0.5 + 3 * -0.25);
  // Pieces are twice as wide but for the roundings of the two ends, of 2 and 4 pixels, and of the sums.
  CHECK(std::abs(ReconstructionFilter::tent(2)(0.1, 0.5).x - 0.5 -
                 2 * (ReconstructionFilter::tent()(0.1, 0.5).x - 0.5)) <= (2 + 2) * 0x1p-53);
  const auto wide = ReconstructionFilter::mitchell(4)(0.1, 0.2),
             usual = ReconstructionFilter::mitchell()(0.1, 0.2);
  CHECK(std::abs(wide.x - 0.5 - 2 * (usual.x - 0.5)) <= (4 + 2 * 2 + 4) * 0x1p-53);
  CHECK(wide.weight == usual.weight);
}

TEST_CASE("lanes have the bits of single places, which are the same on every machine") {
  std::uint64_t sum = 0;
  for (const Row& row : filters()) {
    const auto filter = ReconstructionFilter::named(row.name);
    Random random(2);
    WrongCases wrong;
    for (int i = 0; i < 2000; ++i) {
      simd::Doubles u, v;
      for (int lane = 0; lane < simd::double_lanes; ++lane)
        u.set(lane, random.real(0x1p-33, 1)), v.set(lane, 0.3);
      const auto places = filter(u, v);
      for (int lane = 0; lane < simd::double_lanes; ++lane) {
        const auto place = filter(u[lane], v[lane]);
        wrong.add(
            places.x[lane] != place.x || places.y[lane] != place.y || places.weight[lane] != place.weight,
            u[lane]);
      }
    }
    CHECK(wrong == 0);
    for (int i = 0; i < 1000; ++i) {
      const auto place = filter((i + 0.5) / 1000, 0.001 * i);
      for (const double number : {place.x, place.y, place.weight})
        sum = sampling::mix(sum ^ std::bit_cast<std::uint64_t>(number));
    }
  }
  INFO("0x" << std::hex << sum);
  CHECK(sum == 0x1a91a1c12c3c55c4);
}

TEST_CASE("means over samples are those of the filter: of a constant, and of a wave") {
  for (const Row& row : filters()) {
    CAPTURE(row.name);
    const auto filter = ReconstructionFilter::named(row.name);
    const Polygon polygon(row);
    const double wave = polygon.mean([](double x) { return std::cos(2 * x); }) *
                        polygon.mean([](double x) { return std::cos(x); });
    const std::uint32_t samples = 1024, pixels = 16;
    Sums constants, waves;
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
      double sum = 0, constant = 0;
      for (std::uint32_t i = 0; i < samples; ++i) {
        const auto numbers = SobolSampler(SampleIndex{.x = pixel, .sample = i, .samples = samples})(0);
        const auto place = filter(numbers[0], numbers[1]);
        constant += place.weight;
        sum += place.weight * std::cos(2 * (place.x - 0.5)) * std::cos(place.y - 0.5);
      }
      constants.add(constant / samples), waves.add(sum / samples);
    }
    if (row.name != "mitchell")
      CHECK((constants.mean() == 1 && constants.standard_error() == 0));
    else
      CHECK(std::abs(constants.mean() - 1) < 8 * constants.standard_error());
    CHECK(std::abs(waves.mean() - wave) < 8 * waves.standard_error());
    CHECK(waves.standard_error() < 0x1p-10);  // a bias of 8 times that is found
  }
}

TEST_CASE("a gaussian filter of any deviation has its places around the center") {
  for (const double deviation : {1e-320, 1e-200, 1e-154, 1e-100, 1e-3}) {
    const auto place = ReconstructionFilter::gaussian(1.5, deviation)(0.5, 0.5);
    // All of the area is in few pieces in the middle, and of less than 2^-6: sums and the place in a piece
    // are off by 260u of that, and the place by u/2.
    CHECK(std::abs(place.x - 0.5) <= (260 * 0x1p-6 + 0.5) * 0x1p-53);
    CHECK(std::abs(place.y - 0.5) <= (260 * 0x1p-6 + 0.5) * 0x1p-53);
  }
}

TEST_CASE("filters without a size or name are refused with a message that says what is allowed") {
  CHECK_THROWS_WITH(ReconstructionFilter::box(0),
                    ContainsSubstring("width of box must be greater than 0") && ContainsSubstring("it is 0"));
  CHECK_THROWS_WITH(ReconstructionFilter::gaussian(1, std::numeric_limits<double>::quiet_NaN()),
                    ContainsSubstring("deviation of gaussian"));
  CHECK_THROWS_WITH(ReconstructionFilter::mitchell(-1), ContainsSubstring("it is -1"));
  CHECK_THROWS_WITH(ReconstructionFilter::tent(1000), ContainsSubstring("at most 100"));
  CHECK_THROWS_WITH(ReconstructionFilter::blackman_harris(std::numeric_limits<double>::infinity()),
                    ContainsSubstring("it is inf"));
  CHECK_THROWS_WITH(ReconstructionFilter::named("lanczos"),
                    ContainsSubstring("box, tent, gaussian, mitchell or blackman-harris") &&
                        ContainsSubstring("it is lanczos"));
}

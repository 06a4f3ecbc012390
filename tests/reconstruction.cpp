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

/// A filter and its curve, as functions of the C library give it.
struct Row {
  std::string name;
  double radius;
  std::function<double(double)> curve;
};

std::vector<Row> filters() {
  return {{"box", 0.5, [](double) { return 1.0; }},
          {"tent", 1, [](double x) { return 1 - std::abs(x); }},
          {"gaussian", 1.5, [](double x) { return std::exp(-2 * x * x) - std::exp(-4.5); }},
          {"mitchell", 2,
           [](double x) {
             // The cubics of the paper.
             const double b = 1 / 3.0, c = 1 / 3.0, z = std::abs(x);
             if (z < 1)
               return ((12 - 9 * b - 6 * c) * z * z * z + (-18 + 12 * b + 6 * c) * z * z + 6 - 2 * b) / 6;
             return ((-b - 6 * c) * z * z * z + (6 * b + 30 * c) * z * z + (-12 * b - 48 * c) * z + 8 * b +
                     24 * c) /
                    6;
           }},
          {"blackman-harris", 1.5, [](double x) {
             const double angle = 2 * std::numbers::pi * (x / 3 + 0.5);
             return 0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) -
                    0.01168 * std::cos(3 * angle);
           }}};
}

/// Returns ∫ f from a to b by the midpoint rule.
double integral(double a, double b, const auto& f) {
  const int count = 20000;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += f(a + (b - a) * (i + 0.5) / count);
  return sum * (b - a) / count;
}

/// Returns the number of which the coordinate's place is a distance from the center.
double number_for(const ReconstructionFilter& filter, double distance) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (filter(middle, 0.5).x - 0.5 < distance ? low : high) = middle;
  }
  return low;
}

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
      wrong.add(std::abs(place.y - 0.5) > 1e-12, u, place.y);
      const bool is_negative = row.curve(place.x - 0.5) < 0 && row.name == "mitchell";
      if (std::abs(std::abs(place.x - 0.5) - 8 / 7.0) > 1e-9)
        wrong.add((place.weight < 0) != is_negative, u, place.x);
      if (row.name != "mitchell") wrong.add(place.weight != 1, u);
      before = place.x;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("moments of places are those of the filter's curve, by quadrature") {
  for (const Row& row : filters()) {
    CAPTURE(row.name);
    const auto filter = ReconstructionFilter::named(row.name);
    const double whole = integral(-row.radius, row.radius, row.curve);
    // The weight of the other coordinate, which is not negative at the center.
    const double weight_of_y = std::sqrt(filter(0.5, 0.5).weight);
    const std::function<double(double)> functions[] = {[](double) { return 1.0; },
                                                       [](double x) { return x; },
                                                       [](double x) { return x * x; },
                                                       [](double x) { return x * x * x * x; },
                                                       [](double x) { return std::cos(3 * x); },
                                                       [](double x) { return std::exp(x); }};
    for (const auto& function : functions) {
      const double expected =
          integral(-row.radius, row.radius, [&](double x) { return row.curve(x) * function(x); }) / whole;
      const double found = integral(0, 1, [&](double u) {
        const auto place = filter(u, 0.5);
        return place.weight / weight_of_y * function(place.x - 0.5);
      });
      // The polygon is off the curve by less than 2e-4 of its height, over a width of at most 4.
      CHECK(std::abs(found - expected) < 4e-4);
    }
    CHECK(std::abs(integral(0, 1, [&](double u) { return filter(u, 0.5).weight; }) / weight_of_y - 1) < 1e-4);
  }
}

TEST_CASE("as many places are within a distance as the filter has area there") {
  for (const Row& row : filters()) {
    const auto filter = ReconstructionFilter::named(row.name);
    const auto size = [&](double x) { return std::abs(row.curve(x)); };
    const double whole = integral(-row.radius, row.radius, size);
    for (const double share : {-0.99, -0.7, -0.3, 0.0, 0.1, 0.5, 0.8, 0.95}) {
      CAPTURE(row.name, share);
      const double expected = integral(-row.radius, share * row.radius, size) / whole;
      CHECK(std::abs(number_for(filter, share * row.radius) - expected) < 2e-4);
    }
  }
}

TEST_CASE("filters of other sizes are the usual ones, stretched") {
  CHECK(ReconstructionFilter::box(3)(0.25, 0.5).x == 0.5 + 3 * -0.25);
  CHECK(std::abs(ReconstructionFilter::tent(2)(0.1, 0.5).x - 0.5 -
                 2 * (ReconstructionFilter::tent()(0.1, 0.5).x - 0.5)) < 1e-14);
  const auto wide = ReconstructionFilter::mitchell(4)(0.1, 0.2),
             usual = ReconstructionFilter::mitchell()(0.1, 0.2);
  CHECK(std::abs(wide.x - 0.5 - 2 * (usual.x - 0.5)) < 1e-13);
  CHECK(std::abs(wide.weight - usual.weight) < 1e-13);
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
    double sum = 0, constant = 0;
    const std::uint32_t samples = 1024, pixels = 16;
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
      for (std::uint32_t i = 0; i < samples; ++i) {
        const auto numbers = SobolSampler(SampleIndex{.x = pixel, .sample = i, .samples = samples})(0);
        const auto place = filter(numbers[0], numbers[1]);
        constant += place.weight;
        sum += place.weight * std::cos(2 * (place.x - 0.5)) * std::cos(place.y - 0.5);
      }
    const auto mean = [&](double frequency) {
      return integral(-row.radius, row.radius,
                      [&](double x) { return row.curve(x) * std::cos(frequency * x); }) /
             integral(-row.radius, row.radius, row.curve);
    };
    CHECK(std::abs(constant / samples / pixels - 1) < (row.name == "mitchell" ? 5e-3 : 1e-15));
    CHECK(std::abs(sum / samples / pixels - mean(2) * mean(1)) < 1e-3);
  }
}

TEST_CASE("a gaussian filter of any deviation has its places around the center") {
  for (const double deviation : {1e-320, 1e-200, 1e-154, 1e-100, 1e-3}) {
    const auto place = ReconstructionFilter::gaussian(1.5, deviation)(0.5, 0.5);
    CHECK(std::abs(place.x - 0.5) < 1e-12);
    CHECK(std::abs(place.y - 0.5) < 1e-12);
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

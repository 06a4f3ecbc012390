// Measures samplers: how long two numbers take, and how fast the error of four integrals falls.
//
//   bench_sampling [--runs N] [--csv FILE] [--quick]
#include <protostar/sampling/halton_sampler.hpp>
#include <protostar/sampling/hammersley_sampler.hpp>
#include <protostar/sampling/independent_sampler.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/stratified_sampler.hpp>
#include <protostar/simd/vectors.hpp>
#include <protostar/simd/words.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "support.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Calls f(name, sampler type in a box) for each sampler.
template <class S>
struct Kind {
  using type = S;
};
void for_each_sampler(const auto& f) {
  f("independent", Kind<IndependentSampler>());
  f("stratified", Kind<StratifiedSampler>());
  f("halton", Kind<HaltonSampler>());
  f("sobol", Kind<SobolSampler>());
  f("hammersley", Kind<HammersleySampler>());
}

// ---- Time

/// Returns the sum of products of the numbers of many samples: of 64 samples of each pixel in turn, which is
/// made a sampler each time.
template <class S>
double single(std::uint32_t pixels, std::uint32_t samples) {
  double sum = 0;
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
    for (std::uint32_t i = 0; i < samples; ++i) {
      const auto [a, b, c, d] =
          S(SampleIndex{.seed = 1, .x = pixel, .y = 7, .sample = i, .samples = samples})(3);
      sum += a * b + c * d;
    }
  return sum;
}

template <class S>
simd::Doubles in_lanes(std::uint32_t pixels, std::uint32_t samples) {
  simd::Doubles sum(0.0);
  const auto lanes = simd::iota<std::uint32_t, simd::double_lanes>();
  for (std::uint32_t pixel = 0; pixel < pixels; pixel += simd::double_lanes)
    for (std::uint32_t i = 0; i < samples; ++i) {
      const SampleIndices at{.seed = 1, .x = lanes + pixel, .y = 7u, .sample = i, .samples = samples};
      const auto [a, b, c, d] = SamplerInLanes<S>(at)(3);
      sum += a * b + c * d;
    }
  return sum;
}

void times(const bench::Options& options) {
  const std::uint32_t pixels = options.quick ? 64 : 4096, samples = 64;
  const double pairs = 2.0 * pixels * samples;
  Table table(options, {"ns for two numbers", "single", "in lanes"});
  for_each_sampler([&]<class S>(const std::string& name, Kind<S>) {
    const std::vector<Work> works = {[&] { bench::keep(single<S>(pixels, samples)); },
                                     [&] { bench::keep(in_lanes<S>(pixels, samples)); }};
    const Times taken(options, works);
    table.row({name, number(1e9 * taken.shortest(0) / pairs), number(1e9 * taken.shortest(1) / pairs)});
  });
}

// ---- Errors

using Point4 = SampleSet<double>;

/// Returns the light that a point of a floor gets from a point of a ceiling light at height 1, both squares,
/// times the light's size.
double light(double x, double y, const Point4& p) {
  const double dx = 0.25 + 0.5 * p[2] - x, dy = 0.25 + 0.5 * p[3] - y, square = dx * dx + dy * dy + 1;
  return 0.25 / (pi * square * square);
}

/// Coordinates on the floor, of which a pixel sees a fiftieth.
double floor_x(const Point4& p) { return 0.3 + 0.02 * p[0]; }
double floor_y(const Point4& p) { return 0.6 + 0.02 * p[1]; }

/// Tests whether a disk halfway between floor and light is in the way.
bool is_blocked(const Point4& p) {
  const double x = 0.5 * (floor_x(p) + 0.25 + 0.5 * p[2]) - 0.5,
               y = 0.5 * (floor_y(p) + 0.25 + 0.5 * p[3]) - 0.45;
  return x * x + y * y < 0.015;
}

struct Integral {
  const char* name;
  double (*f)(const Point4&);
  double truth;
};

/// Returns the mean over all points of a function, by Gauss's rule with eight places in each dimension. For
/// the light, which is smooth over a fiftieth of the floor and half of the ceiling, it is exact to 10^-10.
double mean(double (*f)(const Point4&)) {
  static constexpr std::array<double, 4> roots = {0.18343464249564980494, 0.52553240991632898582,
                                                  0.79666647741362673959, 0.96028985649753623168};
  static constexpr std::array<double, 4> weights = {0.36268378337836198297, 0.31370664587788728734,
                                                    0.22238103445337447054, 0.10122853629037625915};
  double sum = 0;
  for (std::size_t i = 0; i < 4096; ++i) {
    Point4 point;
    double weight = 1;
    for (std::size_t d = 0, rest = i; d < 4; ++d, rest /= 8) {
      const std::size_t k = rest % 8;
      point[d] = 0.5 + (k < 4 ? 0.5 : -0.5) * roots[k % 4];
      weight *= weights[k % 4] / 2;
    }
    sum += weight * f(point);
  }
  return sum;
}

std::vector<Integral> integrals(bool quick) {
  const auto edge = [](const Point4& p) { return p[0] * p[0] + p[1] * p[1] < 2 / pi ? 1.0 : 0.0; };
  const auto smooth = [](const Point4& p) { return std::exp(p[0] + p[1]); };
  const auto smooth_4 = [](const Point4& p) { return light(floor_x(p), floor_y(p), p); };
  const auto shadow = [](const Point4& p) { return is_blocked(p) ? 0.0 : light(floor_x(p), floor_y(p), p); };
  const double e = std::exp(1.0);
  // The shadow's truth is a mean over 16 pixels of 2^20 samples, whose error is 20 times below the least
  // here.
  double sum = 0;
  const std::uint32_t samples = quick ? 1 << 8 : 1 << 20;
  for (std::uint32_t pixel = 0; pixel < 16; ++pixel)
    for (std::uint32_t i = 0; i < samples; ++i)
      sum += shadow(SobolSampler(SampleIndex{.seed = 777, .x = pixel, .sample = i})(1));
  return {{"edge", edge, 0.5},
          {"smooth, 2-D", smooth, (e - 1) * (e - 1)},
          {"smooth, 4-D", smooth_4, mean(smooth_4)},
          {"shadow's edge, 4-D", shadow, sum / samples / 16}};
}

constexpr int first_power = 4, last_power = 14, power_step = 2;

/// Squared errors of an integral's estimates, of each number of samples by many pixels.
using Errors = std::vector<std::vector<double>>;

template <class S>
Errors errors_of(const Integral& integral, std::uint32_t pixels, int last) {
  Errors errors;
  for (int power = first_power; power <= last; power += power_step) {
    const std::uint32_t samples = std::uint32_t{1} << power;
    errors.emplace_back();
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
      double sum = 0;
      for (std::uint32_t i = 0; i < samples; ++i)
        sum += integral.f(
            S(SampleIndex{.seed = 5, .x = pixel, .y = samples, .sample = i, .samples = samples})(1));
      const double error = sum / samples - integral.truth;
      errors.back().push_back(error * error);
    }
  }
  return errors;
}

/// Returns the root of the mean squared error over pixels, which chosen(pixel) picks.
double rmse(const std::vector<double>& squares, const auto& chosen) {
  double sum = 0;
  for (std::size_t i = 0; i < squares.size(); ++i) sum += squares[chosen(i)];
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

/// Returns the slope of the line through the logarithms of samples and errors, from 2^6 samples on.
double slope(const Errors& errors, const auto& chosen) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0, n = 0;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    const double x = power_step * static_cast<double>(i) * std::log(2.0),
                 y = std::log(rmse(errors[i], chosen));
    sx += x, sy += y, sxx += x * x, sxy += x * y, ++n;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void errors(const bench::Options& options) {
  const std::uint32_t pixels = options.quick ? 4 : 200;
  const int last = options.quick ? 8 : last_power;
  Table::Cells columns = {"integral, sampler"};
  for (int power = first_power; power <= last; power += power_step)
    columns.push_back("2^" + std::to_string(power));
  columns.insert(columns.end(), {"slope", "+-"});
  Table table(options, columns);
  for (const Integral& integral : integrals(options.quick))
    for_each_sampler([&]<class S>(const std::string& name, Kind<S>) {
      if (name == "hammersley") return;  // no scramblings
      const Errors found = errors_of<S>(integral, pixels, last);
      const auto all = [](std::size_t i) { return i; };
      Table::Cells cells = {std::string(integral.name) + ", " + name};
      for (const auto& squares : found) cells.push_back(number(rmse(squares, all), 2));
      // Its 95 % interval, from the slopes of 200 choices of as many pixels with repetition (bootstrap).
      const double measured = slope(found, all);
      double variance = 0;
      for (std::uint64_t choice = 0; choice < 200; ++choice) {
        std::uint64_t drawn = 0;
        const double other = slope(found, [&](std::size_t) {
          return static_cast<std::size_t>(sampling::mix(choice << 32 | ++drawn) % pixels);
        });
        variance += (other - measured) * (other - measured) / 200;
      }
      cells.push_back(number(measured));
      cells.push_back(number(1.96 * std::sqrt(variance), 2));
      table.row(cells);
    });
}

void sampling_benchmark(const bench::Options& options) {
  times(options);
  errors(options);
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, sampling_benchmark); }

// Measures sums of radiance: exact ones against sums in float and double, and the work of a film.
//
//   bench_sums [--runs N] [--csv FILE] [--quick]
//
// Colors are added one after the other, as an integrator returns them: to sums that the compiler holds in
// registers over all samples of a pixel, and by a call for each sample, to sums in memory.
#include <array>
#include <cstddef>
#include <cstdint>
#include <protostar/sampling/exact_lanes.hpp>
#include <protostar/sampling/film.hpp>
#include <protostar/simd/vectors.hpp>
#include <protostar/vec3.hpp>
#include <string>
#include <vector>

#include "../support/random.hpp"
#include "support.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;

namespace {

/// Sum of colors with rounding.
template <class Number>
struct RoundedColorSum {
  Number r = 0, g = 0, b = 0;

  void add(const Color& color) { r += color.r, g += color.g, b += color.b; }
};

/// Sums of a pixel as PixelSums holds them, with rounding.
struct RoundedPixelSums {
  RoundedColorSum<double> sums[2];
  std::uint32_t counts[2] = {};

  void add(std::uint32_t i, const Color& color) {
    sums[i % 2].add(color);
    ++counts[i % 2];
  }
};

template <class Sum>
[[gnu::noinline]] void add_one(Sum& sum, const Color& color) {
  sum.add(color);
}

constexpr std::size_t samples = 1024;  // in a pixel

template <class Sum>
Work held(const std::vector<Color>& colors) {
  return [&colors] {
    for (std::size_t i = 0; i < colors.size(); i += samples) {
      Sum sum;
      for (std::size_t k = i; k < i + samples; ++k) sum.add(colors[k]);
      bench::keep(sum);
    }
  };
}

template <class Sum>
Work called(const std::vector<Color>& colors) {
  return [&colors] {
    for (std::size_t i = 0; i < colors.size(); i += samples) {
      Sum sum;
      for (std::size_t k = i; k < i + samples; ++k) add_one(sum, colors[k]);
      bench::keep(sum);
    }
  };
}

/// Sums of colors in lanes, one for each of several pixels.
template <class Sum>
Work in_lanes(const std::vector<std::array<simd::Floats, 3>>& colors) {
  return [&colors] {
    for (std::size_t i = 0; i < colors.size(); i += samples) {
      std::array<Sum, 3> sums;
      for (std::size_t k = i; k < i + samples; ++k)
        for (std::size_t c = 0; c < 3; ++c) sums[c].add(colors[k][c]);
      bench::keep(sums);
    }
  };
}

struct DoubleLanes {
  simd::Doubles sum = 0.0;

  void add(simd::Floats x) { sum += simd::to_double(x); }
};

/// Adds to sums of pixels in memory, as many samples to each as a unit of work has.
template <class Sums>
Work of_pixels(std::vector<Sums>& pixels, const std::vector<Color>& colors) {
  return [&] {
    constexpr std::size_t in_unit = 16;
    for (std::size_t i = 0; i < colors.size(); i += in_unit)
      for (std::size_t k = 0; k < in_unit; ++k)
        pixels[i / in_unit].add(static_cast<std::uint32_t>(k), colors[i + k]);
    bench::keep(pixels);
  };
}

void measure(const bench::Options& options) {
  Random random(1);
  std::vector<Color> colors;
  for (std::size_t i = 0; i < (options.quick ? 4 : 256) * samples; ++i) colors.push_back(random.color());
  const Times times(options, {held<RoundedColorSum<float>>(colors), held<RoundedColorSum<double>>(colors),
                              held<ExactColorSum>(colors), called<RoundedColorSum<float>>(colors),
                              called<RoundedColorSum<double>>(colors), called<ExactColorSum>(colors)});
  const std::vector<std::string> names{"float",         "double",         "exact",
                                       "float, called", "double, called", "exact, called"};
  const std::vector<std::size_t> bytes{12, 24, sizeof(ExactColorSum), 12, 24, sizeof(ExactColorSum)};
  Table table(options, {"sum of a color", "ns", "of double", "bytes"});
  for (std::size_t i = 0; i < names.size(); ++i)
    table.row({names[i], number(1e9 * times.seconds(i) / static_cast<double>(colors.size())),
               number(times.ratio(i, i / 3 * 3 + 1)), std::to_string(bytes[i])});

  Film film(Tile{0, 0, 64, options.quick ? 4 : 256});
  std::vector<PixelSums> exact(colors.size() / 16);
  std::vector<RoundedPixelSums> rounded(exact.size());
  const Times adding(options, {of_pixels(rounded, colors), of_pixels(exact, colors)});
  Table pixel_table(options, {"sums of pixels, both scramblings", "ns", "of double", "bytes"});
  pixel_table.row({"double", number(1e9 * adding.seconds(0) / static_cast<double>(colors.size())), "1",
                   std::to_string(sizeof(RoundedPixelSums))});
  pixel_table.row({"exact", number(1e9 * adding.seconds(1) / static_cast<double>(colors.size())),
                   number(adding.ratio(1, 0)), std::to_string(sizeof(PixelSums))});

  constexpr std::size_t lanes = simd::double_lanes;
  std::vector<std::array<simd::Floats, 3>> of_lanes((options.quick ? 1 : 32) * samples);
  for (auto& channels : of_lanes)
    for (simd::Floats& channel : channels)
      channel = simd::Floats::of_each([&](int) { return static_cast<float>(random.real(0, 1)); });
  const Times by_lanes(options, {in_lanes<DoubleLanes>(of_lanes), in_lanes<ExactLanes<lanes>>(of_lanes)});
  const auto per_color = static_cast<double>(of_lanes.size() * lanes);
  Table lanes_table(options, {std::to_string(lanes) + " pixels in lanes", "ns a color", "of double"});
  lanes_table.row({"double", number(1e9 * by_lanes.seconds(0) / per_color), "1"});
  lanes_table.row({"exact", number(1e9 * by_lanes.seconds(1) / per_color), number(by_lanes.ratio(1, 0))});

  const double pixels = film.tile().width() * film.tile().height();
  for (int y = 0; y < film.tile().height(); ++y)
    for (int x = 0; x < film.tile().width(); ++x)
      for (std::uint32_t i = 0; i < 4; ++i) film(x, y).add(i, random.color());
  const Times of_film(options, {[&] { bench::keep(film.mean()); }, [&] { bench::keep(film.error()); }});
  Table film_table(options, {"work of a film", "ns a pixel"});
  film_table.row({"mean picture", number(1e9 * of_film.seconds(0) / pixels)});
  film_table.row({"estimate of the error", number(1e9 * of_film.seconds(1) / pixels)});
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, measure); }

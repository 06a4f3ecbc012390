// Figures of stage 18: places in a pixel, edges, waves, scramblings and filters.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/numeric/trigonometry.hpp>
#include <protostar/pixel_grid.hpp>
#include <protostar/sampling/halton_sampler.hpp>
#include <protostar/sampling/hammersley_sampler.hpp>
#include <protostar/sampling/independent_sampler.hpp>
#include <protostar/sampling/reconstruction.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/stratified_sampler.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Numbers of a sample, of which the first two are its place in a pixel.
using Numbers = SampleSet<double>;

/// Returns the first n samples of set 0 of a pixel.
template <class S>
std::vector<Numbers> samples_of(std::uint32_t n, std::uint32_t x = 3, std::uint32_t y = 1) {
  std::vector<Numbers> samples;
  for (std::uint32_t i = 0; i < n; ++i)
    samples.push_back(S(SampleIndex{.seed = 1, .x = x, .y = y, .sample = i, .samples = n})(0));
  return samples;
}

/// A square of the drawing that shows a pixel.
struct Square {
  Place corner;
  double side;

  [[nodiscard]] Place at(double x, double y) const { return {corner.x + side * x, corner.y + side * y}; }

  void grid(Drawing& drawing, int columns, int rows) const {
    for (int i = 1; i < columns; ++i) {
      const double x = static_cast<double>(i) / columns;
      drawing.line(at(x, 0), at(x, 1), Paint::gray, Stroke::dashed);
    }
    for (int i = 1; i < rows; ++i) {
      const double y = static_cast<double>(i) / rows;
      drawing.line(at(0, y), at(1, y), Paint::gray, Stroke::dashed);
    }
  }
  void outline(Drawing& drawing) const { drawing.rectangle(corner, side, side, Paint::ink, Fill::none); }
  void points(Drawing& drawing, const auto& samples, double radius = 4) const {
    for (const auto& [x, y, z, w] : samples) drawing.circle(at(x, y), radius, Paint::blue, Fill::full);
  }
};

/// Returns true if each cell of a grid has one of the samples.
bool has_one_in_each(const std::vector<Numbers>& samples, int columns, int rows) {
  std::set<std::pair<int, int>> cells;
  for (const Numbers& sample : samples)
    cells.insert({static_cast<int>(sample[0] * columns), static_cast<int>(sample[1] * rows)});
  return samples.size() == cells.size() && cells.size() == static_cast<std::size_t>(columns * rows);
}

/// Returns Hammersley's places of so many samples.
std::vector<FilteredPlace<double>> places_of(int samples) {
  const PixelGrid pixels(1, 1, {.samples = samples});
  std::vector<FilteredPlace<double>> places;
  for (int i = 0; i < samples; ++i) places.push_back(pixels.place(0, 0, i));
  return places;
}

// ---- Idea

void share_of_pixel(Drawing& drawing) {
  // Below the edge y = 1.1 + 0.35 x, in pixels, the surface is dark; above it is the light.
  constexpr int columns = 5, rows = 4;
  constexpr double side = 54;
  const auto is_dark = [](double x, double y) { return y > 1.1 + 0.35 * x; };
  const auto centers = places_of(1), many = places_of(16);
  const auto draw = [&](const Place& corner, const std::vector<FilteredPlace<double>>& places,
                        double radius) {
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const auto dark = std::count_if(
            places.begin(), places.end(),
            [&](const FilteredPlace<double>& place) { return is_dark(x + place.x, y + place.y); });
        const float share = static_cast<float>(dark) / static_cast<float>(places.size());
        drawing.swatch({corner.x + side * x, corner.y + side * y}, side, side,
                       shown_color(Color{0.75f - 0.67f * share}));
      }
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        drawing.rectangle({corner.x + side * x, corner.y + side * y}, side, side, Paint::gray, Fill::none);
        for (const FilteredPlace<double>& place : places)
          drawing.circle({corner.x + side * (x + place.x), corner.y + side * (y + place.y)}, radius,
                         Paint::blue, Fill::full);
      }
    const auto at = [&](double x) { return Place{corner.x + side * x, corner.y + side * (1.1 + 0.35 * x)}; };
    drawing.line(at(0), at(columns), Paint::orange, Stroke::bold);
  };
  draw({30, 46}, centers, 4);
  draw({340, 46}, many, 2.2);
  drawing.words({165, 28}, "one place: dark or light", Anchor::middle, Paint::ink, true);
  drawing.words({475, 28}, "16 places: their mean", Anchor::middle, Paint::ink, true);
}

// ---- Waves

void false_waves(Drawing& drawing) {
  // Waves of light by their length in pixels; the pixel's center, and the mean over it.
  constexpr int pixels = 20;
  constexpr double wide = 28, left = 40;
  struct Row {
    double length, y;
    const char* words;
  };
  for (const auto& [length, y, words] :
       {Row{8, 70, "8 pixels long"}, Row{10.0 / 9, 210, "1.11 pixels long"}}) {
    const auto wave = [period = length](double x) { return cosine_of_degrees(360 * x / period); };
    // The mean over a pixel, of Hammersley's many places
    const auto places = places_of(256);
    const auto mean = [&](int pixel) {
      double sum = 0;
      for (const FilteredPlace<double>& place : places) sum += wave(pixel + place.x);
      return sum / static_cast<double>(places.size());
    };
    const auto at = [&, zero = y](double x, double value) {
      return Place{left + wide * x, zero - 26 * value};
    };
    std::vector<Place> true_wave, centers, means;
    for (int i = 0; i <= 24 * pixels; ++i) true_wave.push_back(at(i / 24.0, wave(i / 24.0)));
    for (int i = 0; i < pixels; ++i) {
      centers.push_back(at(i + 0.5, wave(i + 0.5)));
      means.push_back(at(i + 0.5, mean(i)));
    }
    for (int i = 0; i <= pixels; ++i) drawing.line(at(i, -1.15), at(i, 1.15), Paint::gray, Stroke::dashed);
    drawing.polyline(true_wave, Paint::gray);
    drawing.polyline(centers, Paint::red, Stroke::bold);
    for (const Place& place : centers) drawing.circle(place, 4, Paint::red, Fill::full);
    drawing.polyline(means, Paint::green, Stroke::bold);
    drawing.words({320, y - 42}, words, Anchor::middle, Paint::ink, true);
    // A wave of 10/9 pixels looks like one of 10: the values at the centers are those of cos(2π x/10).
    if (length < 2) {
      for (int i = 0; i < pixels; ++i) {
        expect(std::abs(wave(i + 0.5) + cosine_of_degrees(36 * (i + 0.5))) < 1e-9, "false_waves");
        expect(std::abs(mean(i)) < 0.12, "false_waves");
      }
    }
  }
  drawing.words({40, 284}, "gray: the light", Anchor::start);
  drawing.words({210, 284}, "red: at the centers", Anchor::start, Paint::red);
  drawing.words({410, 284}, "green: means of pixels", Anchor::start, Paint::green);
}

// ---- Samplers

void points_in_pixel(Drawing& drawing) {
  constexpr double side = 176;
  const auto draw = [&](int i, const char* name, const std::vector<Numbers>& samples) {
    const Square square{{26 + 206.0 * (i % 3), 36 + 226.0 * (i / 3)}, side};
    square.grid(drawing, 4, 4);
    square.outline(drawing);
    square.points(drawing, samples);
    drawing.words({square.corner.x + side / 2, square.corner.y - 12}, name, Anchor::middle, Paint::ink, true);
  };
  std::vector<Numbers> grid;
  for (int i = 0; i < 16; ++i) grid.push_back({(i % 4 + 0.5) / 4, (i / 4 + 0.5) / 4, 0, 0});
  // Sobol's and Halton's samples are dealt out to two scramblings in turn, which know nothing of each other;
  // the figure shows 16 of the first one.
  const auto of_first = [](const std::vector<Numbers>& samples) {
    std::vector<Numbers> first;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (scrambling_of(static_cast<std::uint32_t>(i)) == 0) first.push_back(samples[i]);
    return first;
  };
  const auto stratified = samples_of<StratifiedSampler>(16), hammersley = samples_of<HammersleySampler>(16),
             sobol = of_first(samples_of<SobolSampler>(32));
  expect(has_one_in_each(stratified, 4, 4), "points_in_pixel");
  for (const auto& [columns, rows] : {std::pair{16, 1}, {8, 2}, {4, 4}, {2, 8}, {1, 16}}) {
    expect(has_one_in_each(sobol, columns, rows), "points_in_pixel");
    expect(has_one_in_each(hammersley, columns, rows), "points_in_pixel");
  }
  draw(0, "a grid", grid);
  draw(1, "independent", samples_of<IndependentSampler>(16));
  draw(2, "stratified", stratified);
  draw(3, "Hammersley", hammersley);
  draw(4, "Halton", of_first(samples_of<HaltonSampler>(32)));
  draw(5, "Sobol'", sobol);
}

/// Returns Sobol's first n points, without a scrambling.
std::vector<Numbers> unscrambled(std::uint32_t n) {
  std::vector<Numbers> points;
  for (std::uint32_t i = 0; i < n; ++i)
    points.push_back(
        {simd::to_unit(simd::reversed(i)), simd::to_unit(simd::reversed(sampling::pascal(i))), 0, 0});
  return points;
}

void scrambling(Drawing& drawing) {
  constexpr double side = 140;
  constexpr std::uint32_t n = 16;
  const std::vector<Numbers> points = unscrambled(n);
  // Scramblings of the first digit of x, then of the second: halves change places, then halves of halves.
  auto halves = points, quarters = points;
  for (Numbers& p : halves) p[0] += p[0] < 0.5 ? 0.5 : -0.5;
  for (std::size_t i = 0; i < n; ++i) {
    const double x =
        halves[i][0];  // of the left half, the halves change places; those of the right half stay
    quarters[i][0] = x < 0.25 ? x + 0.25 : x < 0.5 ? x - 0.25 : x;
  }
  auto all = points;
  for (std::uint32_t i = 0; i < n; ++i) {
    all[i][0] =
        simd::to_unit(sampling::scrambled(i, 7u, 0x5eed1234u, sampling::factors[1], sampling::factors[5]));
    all[i][1] = simd::to_unit(sampling::scrambled(sampling::pascal(i), 7u, 0x5eed1234u, sampling::factors[2],
                                                  sampling::factors[6]));
  }
  int place = 0;
  for (const auto& [words, samples] : {std::pair{"Sobol's points", &points},
                                       {"halves", &halves},
                                       {"and quarters", &quarters},
                                       {"to the last digit", &all}}) {
    const Square square{{12 + 158.0 * place++, 40}, side};
    square.grid(drawing, 4, 4);
    square.outline(drawing);
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_left = points[i][0] < 0.5;
      drawing.circle(square.at((*samples)[i][0], (*samples)[i][1]), 4.5,
                     is_left ? Paint::orange : Paint::blue, Fill::full);
    }
    drawing.words({square.corner.x + side / 2, 26}, words, Anchor::middle, Paint::ink, true);
    for (const auto& [columns, rows] : {std::pair{16, 1}, {8, 2}, {4, 4}, {2, 8}, {1, 16}})
      expect(has_one_in_each(*samples, columns, rows), "scrambling");
  }
}

// ---- Error at an edge

void edge_through_cells(Drawing& drawing) {
  constexpr int columns = 8;
  constexpr std::uint32_t n = columns * columns;
  const Square square{{40, 30}, 288};
  const auto edge = [](double x) { return 0.73 - 0.41 * x; };
  const auto is_below = [&](double x, double y) { return y > edge(x); };
  int crossed = 0;
  for (int row = 0; row < columns; ++row)
    for (int column = 0; column < columns; ++column) {
      const double x0 = static_cast<double>(column) / columns, x1 = x0 + 1.0 / columns,
                   y0 = static_cast<double>(row) / columns, y1 = y0 + 1.0 / columns;
      const bool upper = is_below(x0, y0) || is_below(x1, y0), lower = is_below(x0, y1) || is_below(x1, y1);
      const bool all = is_below(x0, y0) && is_below(x1, y0);
      const Place corner = square.at(x0, y0);
      if ((upper || lower) && !all) {
        ++crossed;
        drawing.rectangle(corner, square.side / columns, square.side / columns, Paint::orange, Fill::soft);
      } else if (all) {
        drawing.rectangle(corner, square.side / columns, square.side / columns, Paint::gray, Fill::soft);
      }
    }
  square.grid(drawing, columns, columns);
  square.outline(drawing);
  const auto samples = samples_of<StratifiedSampler>(n);
  expect(has_one_in_each(samples, columns, columns), "edge_through_cells");
  square.points(drawing, samples, 3.2);
  drawing.line(square.at(0, edge(0)), square.at(1, edge(1)), Paint::red, Stroke::bold);
  expect(crossed < 2 * columns, "edge_through_cells");
  const auto line = [&](double y, const std::string& words, Paint paint = Paint::ink) {
    drawing.words({350, y}, words, Anchor::start, paint);
  };
  line(64, joined({std::to_string(n), " cells, one place in each"}));
  line(124, joined({std::to_string(crossed), " cells are crossed:"}), Paint::orange);
  line(148, "chance decides in these", Paint::orange);
  line(208, joined({std::to_string(n - static_cast<std::uint32_t>(crossed)), " cells are on one side:"}));
  line(232, "no place there can be wrong");
}

// ---- Filters

/// Point of a filter's curve along x, by the places that it gives: their number for each length is |f|.
struct CurvePoint {
  double x, height;
};
std::vector<CurvePoint> curve_of(const ReconstructionFilter& filter) {
  constexpr int steps = 400;
  std::vector<CurvePoint> points;
  double area = 0;
  for (int i = 0; i < steps; ++i) {
    const double from = (i + 0.02) / steps, to = (i + 0.98) / steps;
    const auto a = filter(from, 0.5), b = filter(to, 0.5);
    // The weight of a place is the product of one for x and one for y, which is positive at the center.
    const double sign = a.weight < 0 ? -1 : 1, weight = sign * std::sqrt(std::abs(a.weight));
    points.push_back({(a.x + b.x) / 2 - 0.5, weight * (to - from) / (b.x - a.x)});
    area += weight / steps;
  }
  expect(std::abs(area - 1) < 0.01, "filter_curves");
  return points;
}

void filter_curves(Drawing& drawing) {
  constexpr double wide = 118, high = 150, base = 240;
  const auto at = [&](double x, double y) { return Place{320 + wide * x, base - high * y}; };
  for (int x = -2; x <= 2; ++x) {
    drawing.line(at(x - 0.5, -0.2), at(x - 0.5, 1.3), Paint::gray, Stroke::dashed);
    drawing.words({at(x, 0).x, base + 56}, x == 0 ? "the pixel" : text_of(x, 0), Anchor::middle,
                  x == 0 ? Paint::ink : Paint::gray);
  }
  drawing.line(at(2.5, -0.2), at(2.5, 1.3), Paint::gray, Stroke::dashed);
  drawing.line(at(-2.6, 0), at(2.6, 0), Paint::ink);
  struct Row {
    const char *name, *words;
    Paint paint;
  };
  const std::array<Row, 5> rows{{{"box", "box", Paint::ink},
                                 {"tent", "tent", Paint::green},
                                 {"gaussian", "Gaussian", Paint::blue},
                                 {"mitchell", "Mitchell", Paint::red},
                                 {"blackman-harris", "Blackman-Harris", Paint::orange}}};
  double y = 44;
  for (const auto& [name, words, paint] : rows) {
    const ReconstructionFilter filter = ReconstructionFilter::named(name);
    std::vector<Place> places{at(-filter.radius(), 0)};
    for (const CurvePoint& point : curve_of(filter)) places.push_back(at(point.x, point.height));
    places.push_back(at(filter.radius(), 0));
    drawing.polyline(places, paint, Stroke::bold);
    drawing.words({28, y}, words, Anchor::start, paint);
    y += 23;
  }
  drawing.words({320, base + 82}, "distance from the pixel's center, in pixels", Anchor::middle);
}

}  // namespace

std::vector<StageFigure> antialiasing_figures() {
  return {
      {"share_of_pixel", "18_antialiasing",
       "An edge through pixels: by one place each in steps, by 16 places each in shades", 276,
       share_of_pixel},
      {"false_waves", "18_antialiasing",
       "Waves at the centers of pixels: long ones are seen, short ones look long", 300, false_waves},
      {"points_in_pixel", "18_antialiasing",
       "Sixteen places in a pixel: a grid, independent, stratified, Hammersley, Halton, Sobol'", 456,
       points_in_pixel},
      {"edge_through_cells", "18_antialiasing",
       "An edge through a pixel of 64 cells, of which it crosses few", 336, edge_through_cells},
      {"scrambling", "18_antialiasing",
       "Sobol's points; with the halves exchanged, with quarters exchanged, with all digits scrambled", 196,
       scrambling},
      {"filter_curves", "18_antialiasing",
       "Curves of five filters: box, tent, Gaussian, Mitchell, Blackman-Harris", 336, filter_curves},
  };
}

}  // namespace figures

// Plots of the tables in docs/figures.
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "charts.hpp"
#include "csv.hpp"
#include "figures.hpp"

namespace figures {

std::string wrong_decisions(const std::string& folder) {
  const CsvTable table = read_csv(folder + "/stress_numerics.csv").at(0);
  // Corpora for which the usual formula is meant; for spheres it assumes directions of unit length.
  const std::vector<std::pair<const char*, const char*>> shown{
      {"tutorial", "sphere, tutorial's"},    {"scales", "sphere, any size"},
      {"grazing", "sphere, grazed"},         {"origins", "sphere, from near it"},
      {"far", "sphere, far away"},           {"planes grazing", "plane, grazed"},
      {"p. outline", "parallelogram, edge"}, {"t. edges", "triangle, edge"},
      {"disks outline", "disk, edge"},       {"boxes edges", "box, edge"},
      {"q. tangent", "quadric, grazed"}};
  BarChart chart{.title = "Wrong answers of the usual formulas in float",
                 .axis = "% of the cases of each kind",
                 .ticks = {0, 10, 20, 30},
                 .bars = {}};
  const auto wrong = [&](std::size_t row) {
    double sum = 0;
    for (const char* kind : {"false hits", "false misses", "wrong roots"}) sum += table.number(row, kind);
    return sum;
  };
  const auto text = [](double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.3g", value);
    return std::string(digits);
  };
  double of_library = 0;
  for (const auto& [corpus, label] : shown)
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (table.name(i) != corpus) continue;
      const double share = 100 * wrong(i) / table.number(i, "tests");
      if (table.text(i, "kernel") == "library") of_library += wrong(i);
      if (table.text(i, "kernel") == "tutorial")
        chart.bars.push_back({label, share, text(share), Paint::red});
    }
  chart.bars.push_back({"the library", of_library, text(of_library) + " in all of these", Paint::blue});
  return chart.drawn();
}

std::string stages(const std::string& folder) {
  BarChart chart{.title = "Stages: times faster than the tutorial's way",
                 .axis = "times; orange: against the naive stages",
                 .ticks = {0, 10, 20, 30},
                 .bars = {}};
  Paint paint = Paint::blue;
  for (const CsvTable& table : read_csv(folder + "/stages.csv")) {
    for (std::size_t i = 0; i < table.size(); ++i)
      chart.bars.push_back(
          {table.name(i), table.number(i, "times faster"), table.text(i, "times faster"), paint});
    paint = Paint::orange;
  }
  return chart.drawn();
}

namespace {

/// Draws the times that rays are faster than Embree's best; those that are slower in another color.
std::string against_embree(const std::string& path, const std::string& title) {
  BarChart chart{.title = title,
                 .axis = "times faster than Embree's best mode; orange: slower",
                 .base = 1,
                 .ticks = {0.5, 1, 2, 5, 10},
                 .bars = {}};
  const CsvTable table = read_csv(path).at(0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.text(i, "times faster") == "-") continue;  // measured without Embree
    const double times = table.number(i, "times faster");
    chart.bars.push_back(
        {table.name(i), times, table.text(i, "times faster"), times < 1 ? Paint::orange : Paint::blue});
  }
  return chart.drawn();
}

}  // namespace

std::string spheres(const std::string& folder) {
  return against_embree(folder + "/spheres.csv", "Rays and spheres");
}
std::string meshes(const std::string& folder) {
  return against_embree(folder + "/meshes.csv", "Rays and triangles of a mesh");
}

namespace {

/// Returns the points than which none is both further left and lower, from left to right.
std::vector<Place> front_of(std::vector<Place> points) {
  std::sort(points.begin(), points.end(), [](const Place& a, const Place& b) { return a.x < b.x; });
  std::vector<Place> front;
  for (const Place& point : points)
    if (front.empty() || point.y < front.back().y) front.push_back(point);
  return front;
}

}  // namespace

std::string growth(const std::string& folder) {
  const CsvTable table = read_csv(folder + "/scaling.csv").at(0);
  const std::vector<Series> shown{{"pixels, 09_shadow", {}, Paint::blue},
                                  {"surfaces, color", {}, Paint::green},
                                  {"lights, shadow", {}, Paint::orange},
                                  {"threads, 09_shadow, shortest turn", {}, Paint::red}};
  LineChart chart{.title = "Growth of the time of a picture",
                  .to_the_right = "times as many",
                  .upwards = "times as long",
                  .ticks_right = {1, 10, 100, 1000, 10000, 100000},
                  .ticks_up = {0.5, 1, 10, 100},
                  .series = {{"as n", {{1, 1}, {70, 70}}, Paint::gray}}};
  for (Series series : shown) {
    double first = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (table.name(i) != series.words) continue;
      if (first == 0) first = table.number(i, "n");
      series.points.push_back({table.number(i, "n") / first, table.number(i, "to the first")});
    }
    series.words.resize(series.words.find(','));
    chart.series.push_back(series);
  }
  return chart.drawn();
}

std::string error(const std::string& folder) {
  LineChart chart{.title = "Error of a picture against its time",
                  .to_the_right = "ms for a picture; each point has more pixels or samples",
                  .upwards = "error of light, RMS",
                  .ticks_right = {0.01, 0.1, 1, 10, 100, 1000, 10000},
                  .ticks_up = {0.0001, 0.001, 0.01, 0.1},
                  .series = {},
                  .has_legend = true};
  const std::vector<CsvTable> tables = read_csv(folder + "/error.csv");
  const auto add = [&](const CsvTable& table, const std::string& way, const std::string& words, Paint paint) {
    std::vector<Place> points;
    for (std::size_t i = 0; i < table.size(); ++i)
      points.push_back({table.number(i, way + " ms"), table.number(i, way + " error")});
    chart.series.push_back({words, front_of(std::move(points)), paint});
  };
  add(tables.at(1), "naive", "transparency, usual way", Paint::orange);
  add(tables.at(1), "exact", "transparency", Paint::blue);
  add(tables.at(2), "naive", "shadow, usual way", Paint::red);
  add(tables.at(2), "exact", "shadow", Paint::green);
  return chart.drawn();
}

std::string samplers(const std::string& folder) {
  const CsvTable table = read_csv(folder + "/sampling.csv").at(1);
  LineChart chart{.title = "Error of a pixel's mean against its samples",
                  .to_the_right = "samples",
                  .upwards = "error, RMS over 200 pixels",
                  .ticks_right = {},
                  .ticks_up = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1},
                  .series = {},
                  .has_legend = true};
  const std::vector<std::pair<const char*, Paint>> shown{{"edge, independent", Paint::gray},
                                                         {"edge, stratified", Paint::orange},
                                                         {"edge, sobol", Paint::red},
                                                         {"smooth, 2-D, independent", Paint::ink},
                                                         {"smooth, 2-D, stratified", Paint::green},
                                                         {"smooth, 2-D, sobol", Paint::blue}};
  for (const auto& [name, paint] : shown)
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (table.name(i) != name) continue;
      std::vector<Place> points;
      for (int power = 4; power <= 14; power += 2)
        points.push_back({static_cast<double>(1 << power), table.number(i, "2^" + std::to_string(power))});
      chart.series.push_back({name, points, paint});
    }
  for (const Place& point : chart.series.at(0).points) chart.ticks_right.push_back(point.x);
  return chart.drawn();
}

std::string paths(const std::string& folder) {
  const CsvTable table = read_csv(folder + "/paths.csv").at(0);
  LineChart chart{.title = "Error of the balls of stage 26 against the time of a pixel",
                  .to_the_right = "time of a pixel, microseconds",
                  .upwards = "error, RMS of light",
                  .ticks_right = {0.1, 1, 10, 100, 1000},
                  .ticks_up = {0.001, 0.01, 0.1, 1},
                  .series = {},
                  .has_legend = true};
  const std::vector<std::pair<const char*, Paint>> shown{{"sobol", Paint::blue},
                                                         {"independent", Paint::green},
                                                         {"book 1", Paint::red},
                                                         {"book 1 with the tree of book 2", Paint::orange}};
  for (const auto& [name, paint] : shown)
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (table.name(i) != name) continue;
      std::vector<Place> points;
      for (int samples = 1; samples <= 64; samples *= 4)
        points.push_back({1e-3 * samples * table.number(i, "ns/sample"),
                          table.number(i, "RMSE " + std::to_string(samples))});
      chart.series.push_back({name, points, paint});
    }
  return chart.drawn();
}

std::string marches(const std::string& folder) {
  const CsvTable table = read_csv(folder + "/marching.csv").at(0);
  LineChart chart{.title = "Error of hits of a torus against the time of a ray",
                  .to_the_right = "time of a ray, nanoseconds",
                  .upwards = "error of t, RMS",
                  .ticks_right = {100, 1000},
                  .ticks_up = {1e-16, 1e-12, 1e-8, 1e-4, 1},
                  .series = {},
                  .has_legend = true};
  struct Way {
    std::string name;
    std::vector<std::string> settings;
    Paint paint;
  };
  const std::vector<Way> ways{{"sphere tracing", {" 0.001", " 0.0001", " 1e-05", " 1e-06"}, Paint::orange},
                              {"fixed step", {" 0.1", " 0.01"}, Paint::red},
                              {"certified", {""}, Paint::blue}};
  for (const Way& way : ways) {
    std::vector<Place> points;
    for (const std::string& setting : way.settings)
      for (std::size_t i = 0; i < table.size(); ++i)
        if (table.name(i) == "torus, " + way.name + setting)
          points.push_back({table.number(i, "ns/ray"), table.number(i, "error of t")});
    chart.series.push_back({way.name, points, way.paint});
  }
  return chart.drawn();
}

std::string kernels(const std::string& folder) {
  BarChart chart{.title = "Ray and sphere: wrong decisions in a million hard cases",
                 .axis = "wrong decisions; beside the name, ns for a test",
                 .ticks = {0, 50000, 100000, 150000},
                 .bars = {}};
  const CsvTable table = read_csv(folder + "/error.csv").at(0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string& wrong = table.text(i, "hard: wrong/M");
    chart.bars.push_back({table.name(i) + ", " + table.text(i, "half: ns/test") + " ns", std::stod(wrong),
                          wrong, wrong == "0" ? Paint::blue : Paint::red});
  }
  return chart.drawn();
}

std::string shaders(const std::string& folder) {
  BarChart chart{.title = "Pixels of shaders that are wrong by more than a level",
                 .axis = "pixels, of 307200",
                 .base = 1,
                 .ticks = {1, 10, 100, 1000, 10000, 100000},
                 .bars = {}};
  const CsvTable table = read_csv(folder + "/shaders.csv").at(0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string shader = table.name(i), numbers = table.text(i, "numbers");
    const bool is_naive = shader.ends_with("_naive");
    if (shader < "02" || shader > "40") continue;                 // no rays; solutions of exercises
    if (is_naive && shader == table.text(i, "golden")) continue;  // compared with a picture in float
    const double count = table.number(i, "above_one");
    const std::string label = shader.substr(0, shader.find('_', 3)) + (numbers.empty() ? "" : ", offset 0");
    chart.bars.push_back(
        {label, std::max(count, 1.0), table.text(i, "above_one"), is_naive ? Paint::red : Paint::blue});
  }
  return chart.drawn();
}

}  // namespace figures

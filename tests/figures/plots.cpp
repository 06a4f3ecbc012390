// Plots of the tables in docs/figures.
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
                 .labels = 190,
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

}  // namespace figures

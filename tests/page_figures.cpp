// Figures that pages state: they are in the tables that programs have written, or computed here anew.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <protostar/refraction.hpp>
#include <protostar/vec3.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "compare_images/read_image.hpp"
#include "figures/csv.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/pages.hpp"

using namespace protostar;

namespace {

namespace fs = std::filesystem;

const fs::path docs_folder = fs::path(PROTOSTAR_SOURCE_DIR) / "docs";

/// Returns the absolute values of all cells of a file in docs/figures that are numbers.
std::vector<double> numbers_of_table(const std::string& csv) {
  std::vector<double> numbers;
  std::istringstream lines(bytes_of(docs_folder / "figures" / csv));
  for (std::string line; std::getline(lines, line);)
    for (const std::string& cell : figures::cells_of(line)) {
      const char* begin = cell.c_str();
      char* end = nullptr;
      const double value = std::strtod(begin, &end);
      if (end != begin && *end == '\0') numbers.push_back(std::abs(value));
    }
  return numbers;
}

/// Returns the numbers with a decimal point in lines of a page, as they are written. Left out are fenced
/// blocks, the targets of links, and the columns of a table whose heading is `goal`.
std::vector<std::string> decimals_in(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  std::size_t goal = std::string::npos;
  bool in_block = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) in_block = !in_block;
    if (in_block) continue;
    line = std::regex_replace(line, std::regex(R"(\]\([^)]*\))"), "]");
    if (!line.starts_with("|")) goal = std::string::npos;
    std::string measured = line;
    if (line.starts_with("|")) {
      std::istringstream cells(line);
      std::vector<std::string> row;
      for (std::string cell; std::getline(cells, cell, '|');) row.push_back(cell);
      const auto heading = std::find(row.begin(), row.end(), " goal ");
      if (heading != row.end()) goal = static_cast<std::size_t>(heading - row.begin());
      if (goal < row.size()) row[goal].clear();
      measured.clear();
      for (const std::string& cell : row) measured += cell + " ";
    }
    const std::regex decimal(R"((^|[^\w.])(\d+\.\d+)(?![\w.]*\d))");
    for (std::sregex_iterator at(measured.begin(), measured.end(), decimal), last; at != last; ++at)
      found.push_back((*at)[2]);
  }
  return found;
}

/// Tells whether a number is one of a table, rounded to as many digits behind the point as it is written
/// with.
bool is_among(const std::vector<double>& table, const std::string& written) {
  const double half = 0.5 * std::pow(10, -static_cast<double>(written.size() - written.find('.') - 1));
  const double value = std::stod(written);
  // Cells have three digits and more, so that the error of subtracting them is far below a hundredth of half.
  return std::any_of(table.begin(), table.end(),
                     [&](double cell) { return std::abs(cell - value) <= 1.01 * half; });
}

/// Returns the sum of a column of the tables in docs/figures, over the rows in whose column `where` stands
/// `is`.
double column_sum(const std::string& csv, const std::string& column, const std::string& where,
                  const std::string& is) {
  double sum = 0;
  for (const figures::CsvTable& table : figures::read_csv((docs_folder / "figures" / csv).string()))
    for (std::size_t row = 0; row < table.size(); ++row)
      if (where.empty() || table.text(row, where) == is) sum += table.number(row, column);
  return sum;
}

}  // namespace

TEST_CASE("each number between marks of figures is in the table that the mark names") {
  int parts = 0;
  for (const auto& entry : fs::recursive_directory_iterator(docs_folder)) {
    if (entry.path().extension() != ".md") continue;
    const std::string page = bytes_of(entry.path()), open = "\n<!-- figures: ", close = "\n<!-- /figures -->";
    std::size_t at = page.find(open);
    for (; at != std::string::npos; at = page.find(open, at)) {
      ++parts;
      const std::size_t begin = page.find(" -->\n", at), end = page.find(close, at);
      CAPTURE(entry.path(), page.substr(at, begin - at));
      REQUIRE(begin < end);
      REQUIRE(end < page.size());
      REQUIRE(page.find(open, at + 1) > end);
      std::istringstream names(page.substr(at + open.size(), begin - at - open.size()));
      std::vector<double> table;
      for (std::string name; names >> name;) {
        REQUIRE(fs::is_regular_file(docs_folder / "figures" / name));
        const std::vector<double> more = numbers_of_table(name);
        table.insert(table.end(), more.begin(), more.end());
      }
      const std::vector<std::string> written = decimals_in(page.substr(begin + 5, end - begin - 5));
      CHECK_FALSE(written.empty());
      for (const std::string& number : written) {
        CAPTURE(number);
        CHECK(is_among(table, number));
      }
      at = end;
    }
  }
  CHECK(parts >= 12);
}

TEST_CASE("numbers with a decimal point are found in prose and tables, but not in links, code and goals") {
  CHECK(decimals_in("It takes 1.5 of 3, or −0.25 (2.0).\n```sh\nrun 4.5\n```\nSee [5.5](a1.5.csv), v1.2 and "
                    "1.2.3.\n") == std::vector<std::string>{"1.5", "0.25", "2.0", "5.5"});
  CHECK(decimals_in(
            "| a | goal | b |\n| --- | --- | --- |\n| 1.5 | 2.5 | 3.5 |\n\n| c | d |\n| 4.5 | 6.5 |\n") ==
        std::vector<std::string>{"1.5", "3.5", "4.5", "6.5"});
  CHECK(is_among({0.1251, 7}, "0.13"));
  CHECK(is_among({0.125}, "0.13"));
  CHECK_FALSE(is_among({0.1239}, "0.13"));
  CHECK_FALSE(is_among({}, "0.13"));
}

TEST_CASE("docs/numerics.md states as many cases as the tables of the stress tests have") {
  struct Row {
    std::string csv, column, where, is, written;
    double count;
  };
  const std::string page = page_in_one_line("numerics");
  for (const auto& [csv, column, where, is, written, count] :
       {Row{"stress_numerics.csv", "tests", "kernel", "library", "2,000,052 cases", 2000052},
        Row{"stress_scenes.csv", "rays", "", "", "20,007 rays", 20007},
        Row{"stress_mesh_long.csv", "rays", "", "", "10^8 rays", 100000002},  // six equal parts
        Row{"stress_marching_long.csv", "rays", "", "", "10^8 rays", 100000000},
        Row{"stress_pictures_long.csv", "segments", "scale", "all", "12,025,854 shadow segments",
            12025854}}) {
    CAPTURE(csv);
    CHECK(column_sum(csv, column, where, is) == count);
    CHECK_THAT(page, ContainsSubstring("[" + written + "](figures/" + csv + ")"));
  }
}

TEST_CASE("docs/stages/18_antialiasing.md: how good Sobol's samples are for smooth light and at an edge") {
  const std::vector<figures::CsvTable> tables =
      figures::read_csv((docs_folder / "figures" / "sampling.csv").string());
  const figures::CsvTable& errors = tables.at(1);
  const auto error = [&](const std::string& name, const std::string& samples) {
    for (std::size_t row = 0; row < errors.size(); ++row)
      if (errors.name(row) == name) return errors.number(row, samples);
    FAIL("sampling.csv has no row " << name);
    return 0.0;
  };
  CHECK(error("smooth, 2-D, sobol", "2^12") < error("smooth, 2-D, stratified", "2^14") / 4);
  // Both have errors of their own: slopes agree within the sum of their 95 % intervals.
  CHECK(std::abs(error("edge, sobol", "slope") - error("edge, stratified", "slope")) <
        error("edge, sobol", "+-") + error("edge, stratified", "+-"));
  CHECK_THAT(page_in_one_line("stages/18_antialiasing"),
             ContainsSubstring(
                 "At an edge Sobol's samples are no better than jittered ones. For smooth light 4096 of "
                 "them have less than a quarter of the error of 16384 jittered ones."));
}

TEST_CASE("docs/stages/fresnel.md: how good Schlick's formula is for glass") {
  double largest = 0, largest_to_75 = 0;
  int at = 0;
  for (int i = 0; i < 9000; ++i) {  // hundredths of a degree
    const double angle = i * std::numbers::pi / 18000, cosine = std::cos(angle);
    const double behind = std::sqrt(1 - (1 - cosine * cosine) / (1.5 * 1.5));
    const double schlick = 0.04 + 0.96 * std::pow(1 - cosine, 5);
    const double error = std::abs(schlick - fresnel_reflectance(cosine, behind, 1 / 1.5));
    if (error > largest) largest = error, at = i;
    if (i <= 7500) largest_to_75 = std::max(largest_to_75, error);
  }
  CHECK(std::lround(largest * 1000) == 36);
  CHECK(std::lround(at / 100.0) == 85);
  CHECK(largest_to_75 < 0.02);
  CHECK_THAT(page_in_one_line("stages/fresnel"),
             ContainsSubstring("never wrong by more than 0.036, at 85°, and by less than 0.02 up to 75°"));
}

TEST_CASE("docs/stages/09_shadow.md: the acne of the plain ray tracer, and why it has less of it") {
  // From the ground, rays to the lamp as those of stages/plain/09_shadow.cpp with an epsilon of 0.
  const Vec3 center{0, -1001, 3}, lamp{0, 3, 0};
  int rays = 0, zeros = 0;
  const auto root_near = [&](const Vec3& origin, const Vec3& direction, int sign) {
    const Vec3 v = origin - center;
    const double a = dot(direction, direction), b = 2 * dot(direction, v), c = dot(v, v) - 1e6;
    return (-b + sign * std::sqrt(b * b - 4 * a * c)) / (2 * a);
  };
  for (int i = 0; i < 320 * 240; ++i) {
    const double u = (2 * (i % 320 + 0.5) - 320) / 240, v = (240 - 2 * (i / 320 + 0.5)) / 240;
    const Vec3 direction = normalize(Vec3{u, v, 1});
    if (const double t = root_near(Vec3{0}, direction, -1); t > 0) {  // not a number for a ray that misses
      const Vec3 point = t * direction;
      ++rays;
      zeros += root_near(point, normalize(lamp - point), 1) == 0 ? 1 : 0;
    }
  }
  CHECK(rays > 30000);
  CHECK(zeros > rays / 2);
  const std::string page = page_in_one_line("stages/09_shadow");
  CHECK_THAT(page, ContainsSubstring("On the ground, exactly 0 is what mostly comes out, and 0 is no hit."));
  const std::string acne = page_in_one_line("mistakes"), pixels = "9068 of 76800 pixels";
  CHECK_THAT(acne.substr(acne.find("<!-- mistake: acne -->"), 400), ContainsSubstring(pixels + " differ"));
  CHECK_THAT(page, ContainsSubstring("[" + pixels + "](../mistakes.md#acne) go dark"));

  // In a larger picture, as many of 100 pixels are lit.
  const Picture golden = read_image(std::string(PROTOSTAR_SOURCE_DIR) + "/tests/golden/09_shadow.png");
  const auto lit = std::count_if(golden.pixels.begin(), golden.pixels.end(),
                                 [](const auto& codes) { return codes[0] + codes[1] + codes[2] > 0; });
  const double share = static_cast<double>(lit) / static_cast<double>(golden.pixels.size());
  CHECK_THAT(page,
             ContainsSubstring("which are " + std::to_string(std::lround(100 * 9068.0 / 76800 / share)) +
                               " of 100 lit ones"));
}

TEST_CASE("pages say how long plain ray tracers are") {
  const auto lines = [](const std::string& name) {
    const std::string text = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "stages" / "plain" / (name + ".cpp"));
    return std::count(text.begin(), text.end(), '\n');
  };
  CHECK(std::abs(lines("09_shadow") - 200) < 10);
  CHECK_THAT(page_in_one_line("stages/09_shadow"),
             ContainsSubstring("The whole program has about 200 lines"));
  CHECK(lines("12_glass") < 250);
  CHECK_THAT(page_in_one_line("stages/introduction"),
             ContainsSubstring("a ray tracer that draws mirrors and glass has less than 250 lines"));
}

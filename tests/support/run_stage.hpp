// Runs a stage in a folder, and takes apart what it writes and prints.
#pragma once

#include <cstddef>
#include <functional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "files.hpp"
#include "process.hpp"

inline Outcome run_stage(const std::string& name, const std::string& arguments, const TemporaryFolder& folder,
                         std::function<void()> before = {}) {
  Command command = stage(name, words(arguments), folder / "");
  command.before = std::move(before);
  return run(command);
}

/// Returns the rows whose stages are built: under sanitizers some are left out (tests/CMakeLists.txt).
/// name(row) is a stage.
template <class Row>
std::vector<Row> of_built_stages(std::vector<Row> rows, const auto& name) {
  const std::string left_out = " " PROTOSTAR_STAGES_LEFT_OUT " ";
  std::erase_if(rows, [&](const Row& row) { return left_out.find(" " + name(row) + " ") != left_out.npos; });
  return rows;
}

/// Returns the file that a stage draws into an empty folder, without output, to compare with.
inline std::string stage_picture(const std::string& name, const std::string& arguments,
                                 const std::string& file = "out.ppm") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage(name, arguments + " --quiet -o " + file, folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out + outcome.err == "");
  CHECK(folder.count() == 1);
  return bytes_of(folder / file);
}

/// Returns what a stage prints for --help, with a single blank between words: where its lines end depends on
/// the version of CLI11.
inline std::string stage_help(const std::string& name, const TemporaryFolder& folder) {
  const Outcome help = run_stage(name, "--help", folder);
  CHECK(help.status == 0);
  CHECK(help.err == "");
  std::istringstream words(help.out);
  std::string text, word;
  while (words >> word) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// Returns the line that a stage prints, with every number of its times replaced by 0.
inline std::string without_times(const std::string& line) {
  std::string kept = line.substr(0, line.find("rendered"));
  for (std::size_t i = kept.size(); i < line.size(); ++i) {
    const bool digit = line[i] >= '0' && line[i] <= '9';
    if (!digit) kept += line[i];
    if (digit && kept.back() != '0') kept += '0';
  }
  return kept;
}

inline std::string cannot_write(const std::string& program, const std::string& path, int reason) {
  return program + ": cannot write '" + path + "': " + std::generic_category().message(reason) + "\n";
}

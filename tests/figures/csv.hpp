// Tables of numbers as bench::Table and CsvFile write them: several to a file, with an empty line between.
#pragma once

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace figures {

class CsvTable {
 public:
  explicit CsvTable(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }

  [[nodiscard]] const std::string& text(std::size_t row, const std::string& column) const {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    const auto i = static_cast<std::size_t>(found - columns_.begin());
    if (i >= rows_.at(row).size()) throw std::runtime_error("a table has no column " + column);
    return rows_[row][i];
  }
  [[nodiscard]] double number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
  }
  /// Returns the first cell of a row, its name.
  [[nodiscard]] const std::string& name(std::size_t row) const { return rows_.at(row).front(); }

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Returns the cells of a line; a cell in quotes may hold commas.
inline std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"')
      is_quoted = !is_quoted;
    else if (c == ',' && !is_quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

/// Reads the tables of a file. Throws std::runtime_error if it cannot be read.
inline std::vector<CsvTable> read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::vector<CsvTable> tables;
  bool begins = true;
  for (std::string line; std::getline(file, line);) {
    if (line.empty())
      begins = true;
    else if (begins)
      tables.emplace_back(cells_of(line)), begins = false;
    else
      tables.back().add(cells_of(line));
  }
  return tables;
}

}  // namespace figures

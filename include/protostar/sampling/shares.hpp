// Choice of one of several things by chance, each with a probability in proportion to its share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Shares of a whole by which one of several things is chosen with a number from [0, 1).
class Shares {
 public:
  /// Makes shares of no things yet, with memory for `count` of them.
  explicit Shares(std::size_t count) { ends_.reserve(count); }

  /// Adds the share of the next thing, finite and not negative.
  void add(double share) { ends_.push_back(whole() + share); }

  /// Returns the sum of the shares; 0 for no things.
  [[nodiscard]] double whole() const { return ends_.empty() ? 0 : ends_.back(); }
  [[nodiscard]] std::size_t size() const { return ends_.size(); }

  /// Returns the probability with which thing i is chosen; NaN if the whole is 0.
  [[nodiscard]] double probability(std::size_t i) const { return part(i) / whole(); }

  struct Choice {
    std::size_t index;
    double probability;
    double rest;  ///< place of the number within the share, in [0, 1): a number for the next choice
  };

  /// Chooses a thing. Its probability is exactly the one with which it is chosen, that of the rounded shares.
  /// Precondition: the whole is greater than 0.
  [[nodiscard]] Choice choose(double u) const {
    const double place = u * whole();
    // A thing of share 0 ends where the one before it ends, and is never the first end above the place.
    const auto end = std::min(std::upper_bound(ends_.begin(), ends_.end(), place), ends_.end() - 1);
    const auto i = static_cast<std::size_t>(end - ends_.begin());
    return {i, probability(i), std::min((place - begin(i)) / part(i), 1 - 0x1p-53)};  // not rounded to 1
  }

 private:
  [[nodiscard]] double begin(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }
  [[nodiscard]] double part(std::size_t i) const { return ends_[i] - begin(i); }

  std::vector<double> ends_;
};

/// Shares of the cells of a grid, of which one is chosen with two numbers from [0, 1): its row, then its
/// column.
class GridShares {
 public:
  GridShares() = default;

  /// Takes share(column, row) of all cells. It returns the share of a cell, finite and not negative.
  GridShares(int columns, int rows, const auto& share) : rows_(static_cast<std::size_t>(rows)) {
    cells_.reserve(static_cast<std::size_t>(rows));
    for (int y = 0; y < rows; ++y) {
      Shares row(static_cast<std::size_t>(columns));
      for (int x = 0; x < columns; ++x) row.add(share(x, y));
      rows_.add(row.whole());
      cells_.push_back(std::move(row));
    }
  }

  /// Returns the sum of the shares.
  [[nodiscard]] double whole() const { return rows_.whole(); }

  /// Returns the probability of a cell: that of its row, times that of the cell in the row.
  [[nodiscard]] double probability(std::size_t column, std::size_t row) const {
    const Shares& cells = cells_[row];
    return cells.whole() > 0 ? rows_.probability(row) * cells.probability(column) : 0;
  }

  struct Choice {
    std::size_t column, row;
    double probability;
    double x, y;  ///< place of the numbers within the cell, each in [0, 1)
  };

  /// Chooses a cell: u chooses the column, v the row. Precondition: the whole is greater than 0.
  [[nodiscard]] Choice choose(double u, double v) const {
    const auto [row, row_probability, y] = rows_.choose(v);
    const auto [column, probability, x] = cells_[row].choose(u);
    return {column, row, row_probability * probability, x, y};
  }

 private:
  Shares rows_{0};
  std::vector<Shares> cells_;
};

}  // namespace protostar::inline PROTOSTAR_ABI

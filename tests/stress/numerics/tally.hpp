// Counts of the answers of a kernel, and the sizes of their errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/numeric/roots.hpp>
#include <vector>

namespace numerics {

using protostar::Fallbacks;

/// Histogram of values by size, in steps of 2^(1/8).
class Quantiles {
 public:
  void add(double value) {
    largest_ = std::max(largest_, value), ++total_;
    const double step = value > 0 ? std::floor(8 * std::log2(value)) : -offset;
    ++counts_[static_cast<std::size_t>(std::clamp(step + offset, 0.0, 2 * offset))];
  }
  /// Returns the value that a share of all values do not exceed, to the next step.
  [[nodiscard]] double at(double share) const {
    std::uint64_t left = static_cast<std::uint64_t>(share * static_cast<double>(total_));
    std::size_t i = 0;
    while (i + 1 < counts_.size() && counts_[i] <= left) left -= counts_[i++];
    return i == 0 ? 0 : std::min(largest_, std::exp2((static_cast<double>(i) + 1 - offset) / 8));
  }
  [[nodiscard]] double largest() const { return largest_; }

  void add(const Quantiles& other) {
    largest_ = std::max(largest_, other.largest_), total_ += other.total_;
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  }

 private:
  static constexpr double offset = 8 * 1100;
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(2 * 8 * 1100 + 1);
  std::uint64_t total_ = 0;
  double largest_ = 0;
};

struct Tally {
  std::uint64_t tests = 0, hits = 0, false_hits = 0, false_misses = 0, wrong_roots = 0, broken = 0;
  Quantiles t_error, normal_error;
  double seconds = 0;
  std::uint64_t timed = 0;
  Fallbacks fallbacks;

  [[nodiscard]] std::uint64_t wrong() const { return false_hits + false_misses + wrong_roots + broken; }

  void add(const Tally& other) {
    tests += other.tests, hits += other.hits, false_hits += other.false_hits;
    false_misses += other.false_misses, wrong_roots += other.wrong_roots, broken += other.broken;
    t_error.add(other.t_error), normal_error.add(other.normal_error);
    seconds += other.seconds, timed += other.timed;
    fallbacks.exact += other.fallbacks.exact;
  }
};

}  // namespace numerics
